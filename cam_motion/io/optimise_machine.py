# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A segment of a machine as a movement to optimise, and the law found as YAML to paste."""

from __future__ import annotations

from collections.abc import Mapping
import math
from typing import Any

from cam_motion.drive.inverse import FollowerDrive
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io import axis_parameters
from cam_motion.io.axis import build_axis, CoupledAxis, ONLY_CAM, Values
from cam_motion.io.line_parts import LINE_SHAFT
from cam_motion.io.machine import build_drive
from cam_motion.io.optimise import Movement, Optimised
from cam_motion.io.summary import check_sections
from cam_motion.motion.optimal import End
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.shaped_profile import ShapedProfile
from cam_motion.units import RPM

_AT_REST = (1e-9, 1e-8, 1e-7)  # s', s'', s''' as small as this are rounding of zero


def movement_of(sections: Mapping[str, Values], path: str, speed_cpm: float | None = None,
                ) -> Movement:
    """
    Describe a segment of a machine as a movement.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.
    path : str
        ``AXIS.SEGMENT``, or ``AXIS.CAM.SEGMENT`` for an axis of several cams.
    speed_cpm : float | None
        Shaft speed to take instead of the configured one [cycles/min].

    Returns
    -------
    Movement
        The movement with the limits of its axis; a limit that the machine breaks now is no
        obstacle.

    Raises
    ------
    ConfigurationError
        When there is no such segment, it does not move, or its speed is not set.

    """
    name, cam, segment = _parts(path)
    check = check_sections(sections, speed_cpm)
    if name not in check.axes:
        others = [problem for problem in check.problems if problem.path.startswith(f'{name}.')]
        raise ConfigurationError(others or [Problem(
            'segment', path, 'must begin with an axis of the line',
            'known are: ' + ', '.join(check.axes))])
    axis = build_axis(name, sections[name])
    if axis.values['follows'] != axis_parameters.SHAFT:
        raise ConfigurationError([Problem(
            'segment', path, 'an axis behind another one has no set speed',
            'give --lift, --span-deg and --speed-cpm instead of a file')])
    profile, cam = _cam(axis, cam, path)
    names = [each.name for each in profile.segments]
    if segment not in names:
        raise ConfigurationError([Problem(
            'segment', path, 'must end with a segment of the cam',
            'known are: ' + ', '.join(names))])
    place = names.index(segment)
    lift, part = profile.segments[place].lift, profile.parts[place]
    coupling = axis.layout.couplings[cam]
    omega = (check.speed_cpm or 0.0) * RPM * coupling.ratio
    if not lift or not omega or not coupling.scale:
        raise ConfigurationError([Problem(
            'segment', path, 'moves nothing: lift, scale and speed must not be 0')])
    span = part.end - part.start
    before = part.scaled(0.0, 1.0, 1.0 / lift, -part.end_values(0)[0] / lift)
    ends = (_end(profile.parts[place - 1], 1, lift, span),
            _end(profile.parts[(place + 1) % len(names)], 0, lift, span))
    return Movement(
        path, axis.unit, lift * coupling.scale * math.copysign(1.0, omega), span, abs(omega),
        before, profile.segments[place].law.name, ends, axis.limits, _drive(sections, name), lift)


def _parts(path: str) -> tuple[str, str, str]:
    parts = path.split('.')
    if not 2 <= len(parts) <= 3 or not all(parts):
        raise ConfigurationError([Problem(
            'segment', path, 'must be AXIS.SEGMENT, or AXIS.CAM.SEGMENT')])
    return parts[0], parts[1] if len(parts) == 3 else '', parts[-1]


def _cam(axis: CoupledAxis, cam: str, path: str) -> tuple[CamProfile, str]:
    cams = axis.layout.cams
    if not cam and len(cams) == 1:
        cam = next(iter(cams))
    if cam not in cams or (cam == ONLY_CAM and len(path.split('.')) == 3):
        raise ConfigurationError([Problem(
            'segment', path, 'must name the cam of an axis that has several, and only of such',
            f'write {axis.name}.CAM.SEGMENT; known are: ' + ', '.join(cams))])
    profile = cams[cam]
    return (profile.original if isinstance(profile, ShapedProfile) else profile), cam


def _end(part: Piecewise, end: int, lift: float, span: float) -> End:
    """Read what a neighbour does where it meets the segment, in lifts per span."""
    found = [part.end_values(order)[end] * span ** order / lift for order in (1, 2, 3)]
    return End(*(0.0 if abs(value) < rounding else value
                 for value, rounding in zip(found, _AT_REST)))


def _drive(sections: Mapping[str, Values], axis: str) -> FollowerDrive | None:
    """Find the drive that follows an axis; one that is wrong counts as none."""
    for name, given in sections.items():
        if given.get('axis') == axis and given.get('mode') != LINE_SHAFT:
            try:
                return build_drive(name, given).drive
            except ConfigurationError:
                continue
    return None


def with_law(sections: Mapping[str, Values], found: Optimised) -> tuple[str, dict[str, Any]]:
    """
    Give the section of an axis the law found for one of its segments.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.
    found : Optimised
        The outcome of an optimisation of one of its segments.

    Returns
    -------
    tuple[str, dict[str, Any]]
        Name of the axis, and its parameters by flat name; checked by compiling them.

    Raises
    ------
    ConfigurationError
        When another segment does not go with it.

    """
    axis, _, rest = found.movement.name.partition('.')
    old = {key: value for key, value in sections[axis].items()
           if key.startswith(f'{rest}.')}
    law = found.parameters
    new = {'law': law.pop('law'), 'end_deg': old[f'{rest}.end_deg'],
           'lift': found.movement.given_lift, **law}
    own: dict[str, Any] = {}
    for key, value in sections[axis].items():
        if key not in old:
            own[key] = value
        else:  # in the place where the segment stood
            own |= {f'{rest}.{name}': each for name, each in new.items()}
    build_axis(axis, own)
    return axis, own
