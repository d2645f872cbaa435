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
from dataclasses import dataclass
from typing import Any

from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.gearbox import Gearbox
from cam_motion.drive.load import (
    Friction,
    GRAVITY,
    Lever,
    Part,
    RotatingInertia,
    Spring,
    TranslatingMass,
)
from cam_motion.drive.motor import InductionMotor, KlossMotor
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.parameters import check_values, ParameterSpec, REQUIRED
from cam_motion.motion.profile import CamProfile
from cam_motion.units import DEGREE, RPM


def _number(name: str, meaning: str, unit: str, default: Any = REQUIRED,
            above: float | None = None, least: float | None = None, most: float | None = None,
            ) -> ParameterSpec:
    return ParameterSpec(name, 'double', default, meaning, unit, above, least, most)


CAM_DRIVE = (
    ParameterSpec('mode', 'string', 'line_shaft', 'What the drive does.', choices=('line_shaft',)),
    ParameterSpec('axis', 'string', REQUIRED, 'Name of the axis whose cam loads the shaft.'),
    _number('nominal_rpm', 'Speed the cam shaft is meant for.', 'rpm', above=0.0),
    _number('base_radius', 'Base radius of the cam.', 'm', above=0.0),
    _number('roller_radius', 'Radius of the roller.', 'm', 0.0, least=0.0),
    _number('flywheel', 'Inertia of a flywheel on the motor shaft.', 'kg m²', 0.0, least=0.0),
    _number('gearbox.ratio', 'Turns of the motor per turn of the cam shaft.', '', above=0.0),
    _number('gearbox.efficiency', 'Efficiency of the gearbox.', '', 1.0, above=0.0, most=1.0),
    _number('gearbox.inertia', 'Inertia of the gearbox at the cam shaft.', 'kg m²', 0.0,
            least=0.0),
    _number('motor.synchronous_rpm', 'Synchronous speed.', 'rpm', above=0.0),
    _number('motor.rated_rpm', 'Rated speed.', 'rpm', None, above=0.0),
    _number('motor.rated_torque', 'Rated torque; with rated_rpm it stands for the breakdown slip.',
            'N m', None, above=0.0),
    _number('motor.breakdown_torque', 'Breakdown torque.', 'N m', above=0.0),
    _number('motor.breakdown_slip', 'Slip at breakdown.', '', None, above=0.0, most=1.0),
    _number('motor.a', "Constant of document 004's torque curve; without a and b, Kloss' curve.",
            '', None, above=0.0),
    _number('motor.b', "Constant of document 004's torque curve.", '', None, above=0.0),
    _number('motor.inertia', 'Inertia of the rotor.', 'kg m²', above=0.0),
    ParameterSpec('load', 'string_list', REQUIRED, 'Names of the parts of the load.'),
    ParameterSpec('autostart', 'bool', True, 'Whether the node starts itself.'),
)

_KIND = ParameterSpec('type', 'string', REQUIRED, 'Kind of the part.', choices=(
    'inertia', 'mass', 'spring', 'friction', 'lever'))

PARTS: dict[str, tuple[ParameterSpec, ...]] = {
    'inertia': (_KIND, _number('inertia', 'Inertia on the cam shaft.', 'kg m²', least=0.0)),
    'mass': (_KIND, _number('mass', 'Mass that moves with the follower.', 'kg', least=0.0),
             _number('gravity', 'Free fall along the follower.', 'm/s²', GRAVITY)),
    'spring': (_KIND, _number('stiffness', 'Stiffness.', 'N/m', least=0.0),
               _number('preload', 'Compression at s = 0.', 'm', 0.0)),
    'friction': (_KIND, _number('viscous', 'Viscous friction.', 'N s/m', 0.0, least=0.0),
                 _number('coulomb', 'Coulomb friction.', 'N', 0.0, least=0.0)),
    'lever': (_KIND, _number('inertia', 'Inertia about the bearing.', 'kg m²', least=0.0),
              _number('arm', 'Length.', 'm', above=0.0),
              _number('height', 'Height of the slider over the bearing at s = 0.', 'm'),
              _number('moment', 'Moment against the lever.', 'N m', 0.0),
              ParameterSpec('window_deg', 'double_list', [0.0, 360.0],
                            'First and last shaft angle of the moment.', 'deg')),
}


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

    """

    name: str
    axis: str
    drive: CamDrive
    rated_speed: float
    base_radius: float
    roller_radius: float

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
    names = given.get('load')
    names = [n for n in names if isinstance(n, str)] if isinstance(names, (list, tuple)) else []
    own: dict[str, Any] = {}
    below: dict[str, dict[str, Any]] = {part: {} for part in names}
    for key, value in given.items():
        head, _, rest = key.partition('.')
        if rest and head in below:
            below[head][rest] = value
        else:
            own[key] = value
    values, problems = check_values(CAM_DRIVE, own)
    parts: list[Part] = []
    for part in names:
        try:
            parts.append(_build_part(below[part]))
        except ConfigurationError as error:
            problems += [problem.below(part) for problem in error.problems]
    profile = profiles.get(values['axis'] or '')
    if not problems and profile is not None:
        problems += _lever_problems(names, parts, profile)
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
    rated = values['motor.rated_rpm']
    return CamDriveSettings(
        name, values['axis'],
        CamDrive(profile, parts, motor, gearbox, values['flywheel'], nominal),
        gearbox.ratio * nominal if rated is None else rated * RPM,
        values['base_radius'], values['roller_radius'])


def _build_part(given: Mapping[str, Any]) -> Part:
    kind = given.get('type')
    if kind not in PARTS:
        raise ConfigurationError(check_values((_KIND,), {'type': kind} if kind else {})[1])
    values, problems = check_values(PARTS[kind], given)
    window = values.get('window_deg')
    if window is not None and not problems and not (
            len(window) == 2 and 0.0 <= window[0] < window[1] <= 360.0):
        problems.append(Problem('window_deg', window, 'must be two rising angles from 0 to 360'))
    if problems:
        raise ConfigurationError(problems)
    if kind == 'inertia':
        return RotatingInertia(values['inertia'])
    if kind == 'mass':
        return TranslatingMass(values['mass'], values['gravity'])
    if kind == 'spring':
        return Spring(values['stiffness'], values['preload'])
    if kind == 'friction':
        return Friction(values['viscous'], values['coulomb'])
    first, last = (angle * DEGREE for angle in values['window_deg'])
    return Lever(values['inertia'], values['arm'], values['height'], values['moment'],
                 (first, last))


def _lever_problems(names: list[str], parts: list[Part], profile: CamProfile) -> list[Problem]:
    """Check that the slider stays within reach of every lever."""
    low, high = (peak.value for peak in profile.curve.extremes(0))
    return [
        Problem(f'{name}.height', part.height,
                f'the slider must stay within the arm of {part.arm:g} m: it would stand at '
                f'{part.height - high:.6g} to {part.height - low:.6g} m',
                'a longer arm, another height or a smaller lift')
        for name, part in zip(names, parts) if isinstance(part, Lever)
        and max(abs(part.height - low), abs(part.height - high)) >= part.arm
    ]


def _motor(values: Mapping[str, Any]) -> InductionMotor | KlossMotor:
    synchronous = values['motor.synchronous_rpm'] * RPM
    torque, slip = values['motor.breakdown_torque'], values['motor.breakdown_slip']
    a, b, inertia = values['motor.a'], values['motor.b'], values['motor.inertia']
    if slip is not None and a is not None and b is not None:
        return InductionMotor(synchronous, torque, slip, a, b, inertia)
    if slip is not None:
        return KlossMotor(synchronous, torque, slip, inertia)
    rated, rated_torque = values['motor.rated_rpm'], values['motor.rated_torque']
    if rated is None or rated_torque is None:
        raise ConfigurationError([Problem(
            'breakdown_slip', None, 'a motor needs its breakdown slip, or rated_rpm and '
            'rated_torque', 'take them from the rating plate')])
    return KlossMotor.from_rated(synchronous, rated * RPM, rated_torque, torque, inertia)


def _gearbox(values: Mapping[str, Any]) -> Gearbox:
    return Gearbox(values['gearbox.ratio'], values['gearbox.efficiency'],
                   values['gearbox.inertia'])
