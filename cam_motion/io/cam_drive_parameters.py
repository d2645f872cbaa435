# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The parameters of a cam drive and of the parts of its load, as tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from cam_motion.drive.load import GRAVITY
from cam_motion.io.parameters import AUTOSTART, DRIVE_SIM, ParameterSpec, REQUIRED, SHAFT_TICKS
from cam_motion.io.tracks import track_table


def _number(name: str, meaning: str, unit: str, default: Any = REQUIRED,
            above: float | None = None, least: float | None = None, most: float | None = None,
            ) -> ParameterSpec:
    return ParameterSpec(name, 'double', default, meaning, unit, above, least, most)


CAM_DRIVE = (
    replace(DRIVE_SIM[0], default='line_shaft'),
    ParameterSpec('axis', 'string', REQUIRED, 'Name of the axis whose cam loads the shaft.'),
    _number('nominal_rpm', 'Speed the cam shaft is meant for.', 'rpm', above=0.0),
    _number('base_radius', 'Base radius of the cam.', 'm', above=0.0),
    _number('roller_radius', 'Radius of the roller.', 'm', 0.0, least=0.0),
    _number('flywheel', 'Inertia of a flywheel on the motor shaft.', 'kg m²', 0.0, least=0.0),
    _number('gearbox.ratio', 'Turns of the motor per turn of the cam shaft.', '', above=0.0),
    _number('gearbox.efficiency', 'Efficiency of the gearbox.', '', 1.0, above=0.0, most=1.0),
    _number('gearbox.inertia', 'Inertia of the gearbox at the cam shaft.', 'kg m²', 0.0,
            least=0.0),
    _number('gearbox.rated_torque', 'Torque that the gearbox may pass on at the cam shaft; left '
            'out it is not looked at.', 'N m', None, above=0.0),
    _number('gearbox.max_rpm', 'Speed at which its motor side may turn.', 'rpm', None,
            above=0.0),
    _number('motor.synchronous_rpm', 'Synchronous speed.', 'rpm', above=0.0),
    _number('motor.rated_rpm', 'Rated speed.', 'rpm', None, above=0.0),
    _number('motor.rated_torque', 'Rated torque; with rated_rpm it stands for the breakdown slip.',
            'N m', None, above=0.0),
    _number('motor.breakdown_torque', 'Breakdown torque.', 'N m', above=0.0, most=1e6),
    _number('motor.starting_torque', "Torque at rest, to which Kloss' curve is bent; left out it "
            'is that of the curve.', 'N m', None, above=0.0),
    _number('motor.breakdown_slip', 'Slip at breakdown.', '', None, above=0.0, most=1.0),
    _number('motor.a', "Constant of document 004's torque curve; without a and b, Kloss' curve.",
            '', None, above=0.0),
    _number('motor.b', "Constant of document 004's torque curve.", '', None, above=0.0),
    _number('motor.inertia', 'Inertia of the rotor.', 'kg m²', above=0.0),
    _number('brake.torque', 'Torque of the brake on the motor shaft, by which the shaft stops and '
            "stands; left out it is the motor's breakdown torque.", 'N m', None, least=0.0),
    ParameterSpec('load', 'string_list', REQUIRED, 'Names of the parts of the load.'),
    *SHAFT_TICKS,
    _number('substep', 'Step of the integration.', 's', 0.0005, least=1e-5, most=0.01),
    ParameterSpec('machine', 'string', '',
                  'Machine file that holds the section of the axis, where the drive is a process '
                  'of its own; empty takes that of --params-file.'),
    AUTOSTART,
)
"""Parameters of a drive that turns a cam shaft; its parts have theirs below their names."""

KIND = ParameterSpec('type', 'string', REQUIRED, 'Kind of the part.', choices=(
    'inertia', 'mass', 'spring', 'friction', 'process', 'lever'))

_WINDOW = ParameterSpec('window_deg', 'double_list', [0.0, 360.0],
                        'First and last shaft angle at which it acts.', 'deg')

PARTS: dict[str, tuple[ParameterSpec, ...]] = {
    'inertia': (KIND, _number('inertia', 'Inertia on the cam or load shaft.', 'kg m²',
                              least=0.0)),
    'mass': (KIND, _number('mass', 'Mass that moves with the follower.', 'kg', least=0.0),
             _number('gravity', 'Free fall along the follower.', 'm/s²', GRAVITY)),
    'spring': (KIND, _number('stiffness', 'Stiffness.', 'N/m', least=0.0),
               _number('preload', 'Compression at s = 0.', 'm', 0.0)),
    'friction': (KIND, _number('viscous', 'Viscous friction.', 'N s/m', 0.0, least=0.0),
                 _number('coulomb', 'Coulomb friction.', 'N', 0.0, least=0.0)),
    'process': (KIND, _number('force', 'Force against the rise of the follower.', 'N', 0.0),
                _number('moment', 'Moment on the cam or load shaft against turning forwards.',
                        'N m', 0.0), _WINDOW),
    'lever': (KIND, _number('inertia', 'Inertia about the bearing.', 'kg m²', least=0.0),
              _number('arm', 'Length.', 'm', above=0.0),
              _number('height', 'Height of the slider over the bearing at s = 0.', 'm'),
              _number('moment', 'Moment against the lever.', 'N m', 0.0),
              _WINDOW),
}
"""
Parameters of the parts of a load, by their type.

For a drive that follows an axis the load shaft stands for the cam shaft, and the axis for the
follower; windows lie over the angle of the master shaft.
"""


def cam_drive_table(given: Mapping[str, Any]) -> tuple[ParameterSpec, ...]:
    """
    List the parameters of a cam drive with those of its parts.

    Parameters
    ----------
    given : Mapping[str, Any]
        What the drive has been given, by flat name.

    Returns
    -------
    tuple[ParameterSpec, ...]
        `CAM_DRIVE`, and below the names of tracks and parts what these have.

    """
    return (*CAM_DRIVE, *track_table(given, of_axis=False), *part_table(given))


def part_table(given: Mapping[str, Any]) -> tuple[ParameterSpec, ...]:
    """
    List the parameters of the parts of a load.

    Parameters
    ----------
    given : Mapping[str, Any]
        What the drive has been given, by flat name.

    Returns
    -------
    tuple[ParameterSpec, ...]
        The table, each name below that of its part.

    """
    return tuple(
        replace(spec, name=f'{part}.{spec.name}') for part in part_names(given)
        for spec in PARTS.get(str(given.get(f'{part}.type')), (KIND,)))


def part_names(given: Mapping[str, Any]) -> list[str]:
    """
    Read the names of the parts of a load.

    Parameters
    ----------
    given : Mapping[str, Any]
        What the drive has been given, by flat name.

    Returns
    -------
    list[str]
        Those that can be names; what else is wrong with the list its check says.

    """
    names = given.get('load')
    listed = names if isinstance(names, (list, tuple)) else []
    return list(dict.fromkeys(name for name in listed if isinstance(name, str)))
