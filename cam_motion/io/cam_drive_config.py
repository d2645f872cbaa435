# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A cam drive as a configuration describes it: motor, gearbox, flywheel and load."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.gearbox import Gearbox
from cam_motion.drive.motor import InductionMotor, KlossMotor
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.axis import CoupledAxis
from cam_motion.io.cam_drive_parameters import CAM_DRIVE, part_names
from cam_motion.io.induction_motor import FIGURES, induction_motor
from cam_motion.io.load_config import lever_problems, take_parts
from cam_motion.io.parameters import check_values
from cam_motion.io.tracks import take_tracks, TrackSettings
from cam_motion.motion.profile import CamProfile
from cam_motion.runtime.layout import Coupling
from cam_motion.units import RPM


@dataclass(frozen=True)
class CamDriveSettings:
    """
    A cam drive and what belongs to it.

    Attributes
    ----------
    name, axis : str
        Names of the node and of the axis whose cam it turns.
    drive : CamDrive
        The drive.
    rated_speed : float
        Rated speed of the motor [rad/s].
    base : float
        Distance of the roller's centre from the cam shaft at s = 0 [m].
    base_radius, roller_radius : float
        Their two summands [m].
    brake_torque : float
        Torque of the brake on the motor shaft [N m].
    values : Mapping[str, Any]
        Every parameter of the table, checked.
    tracks : Mapping[str, TrackSettings]
        The cam tracks of its shaft by name.

    """

    name: str
    axis: str
    drive: CamDrive
    rated_speed: float
    base_radius: float
    roller_radius: float
    brake_torque: float
    values: Mapping[str, Any]
    tracks: Mapping[str, TrackSettings] = field(default_factory=dict)

    @property
    def base(self) -> float:
        """Sum the distance of the roller's centre from the cam shaft at s = 0 [m]."""
        return self.base_radius + self.roller_radius


def build_cam_drive(name: str, given: Mapping[str, Any],
                    profiles: Mapping[str, CamProfile]) -> CamDriveSettings:
    """
    Check the parameters of a cam drive and assemble it.

    Parameters
    ----------
    name : str
        Name of the node.
    given : Mapping[str, Any]
        Parameters by flat name.
    profiles : Mapping[str, CamProfile]
        Cams of the machine by axis.

    Returns
    -------
    CamDriveSettings
        The drive.

    Raises
    ------
    ConfigurationError
        With every problem, paths relative to the node.

    """
    given, tracks, problems = take_tracks(given, CAM_DRIVE, part_names(given))
    own, parts, in_parts = take_parts(given, CAM_DRIVE)
    values, wrong = check_values(CAM_DRIVE, own)
    problems += wrong + in_parts
    profile = profiles.get(values['axis'] or '')
    if not problems and profile is not None:
        problems += lever_problems(parts, profile)
    if problems or profile is None:
        # an axis that is not there is the machine's own problem
        raise ConfigurationError(problems)
    made: list[Any] = []
    for path, make in (('motor', _motor), ('gearbox', _gearbox)):
        try:
            made.append(make(values))
        except ConfigurationError as error:
            problems += [problem.below(path) for problem in error.problems]
    if problems:
        raise ConfigurationError(problems)
    motor, gearbox = made
    nominal = values['nominal_rpm'] * RPM
    rated, brake = values['motor.rated_rpm'], values['brake.torque']
    return CamDriveSettings(
        name, values['axis'],
        CamDrive(profile, tuple(parts.values()), motor, gearbox, values['flywheel'], nominal),
        gearbox.ratio * nominal if rated is None else rated * RPM,
        values['base_radius'], values['roller_radius'],
        motor.breakdown_torque if brake is None else brake, values, tracks)


def cam_on_shaft(axis: CoupledAxis) -> CamProfile:
    """
    Give the cam by which an axis loads the shaft.

    Parameters
    ----------
    axis : CoupledAxis
        The axis.

    Returns
    -------
    CamProfile
        Its cam.

    Raises
    ------
    ConfigurationError
        When the axis is coupled as no cam on the shaft itself can be.

    """
    layout = axis.layout
    if axis.values['follows'] != 'shaft' or len(layout.active) > 1 or any(
            layout.couplings[cam] != Coupling() for cam in layout.active):
        raise ConfigurationError([Problem(
            'axis', axis.name, 'the cam of this drive sits on its shaft: one cam must follow the '
            'shaft with ratio 1 and scale 1, without phase and offset',
            'put the phase into its segments, or name another axis')])
    return axis.profile


def _motor(values: Mapping[str, Any]) -> InductionMotor | KlossMotor:
    return induction_motor({name: values[f'motor.{name}'] for name in FIGURES})


def _gearbox(values: Mapping[str, Any]) -> Gearbox:
    most = values['gearbox.max_rpm']
    return Gearbox(values['gearbox.ratio'], values['gearbox.efficiency'],
                   values['gearbox.inertia'], values['gearbox.rated_torque'],
                   None if most is None else most * RPM)
