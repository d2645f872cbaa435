# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Which movements of a machine file are asked about, and all that is known of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from cam_motion.drive.inverse import FollowerDrive
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.advice_movement import Question
from cam_motion.io.axis import build_axis, CoupledAxis, ONLY_CAM, Values
from cam_motion.io.axis_parameters import SHAFT
from cam_motion.io.interlocks import line_values
from cam_motion.io.line_parts import guess_line, LINE_SHAFT
from cam_motion.io.machine import build_drive, build_master
from cam_motion.io.shaping import load_of
from cam_motion.motion.shaping_effect import Load
from cam_motion.runtime.layout import Coupling
from cam_motion.units import RPM


def questions(sections: Mapping[str, Values], names: Sequence[str] = (),
              load: Load | None = None) -> list[Question]:
    """
    Find movements of a machine, whether or not it keeps its limits.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.
    names : Sequence[str]
        ``AXIS``, ``AXIS.SEGMENT`` or, where an axis has several cams, ``AXIS.CAM.SEGMENT``;
        none: every movement.
    load : Load | None
        What swings, in the place of what the axes say.

    Returns
    -------
    list[Question]
        The movements, in the order of the machine.

    Raises
    ------
    ConfigurationError
        When an axis or its drive cannot be used, a name means nothing, or the shaft stands.

    """
    line, problems = line_values(sections.get('line', guess_line(sections)))
    problems = [problem.below('line') for problem in problems]
    axes: dict[str, CoupledAxis] = {}
    wanted = {name.partition('.')[0] for name in names}
    for name in line['axes']:
        if not wanted or name in wanted:
            try:
                axes[name] = build_axis(name, sections.get(name, {}))
            except ConfigurationError as error:
                problems += [problem.below(name) for problem in error.problems]
    if problems:
        raise ConfigurationError(problems)
    speed = _speed(sections, line['master'], line['drives'])
    found = [question for axis in axes.values()
             for question in _of_axis(axis, speed, _drive(sections, axis.name, line['drives']),
                                      load or load_of(axis.values))]
    if not names and not found:
        raise ConfigurationError([Problem(
            'line.axes', line['axes'], 'no axis has a movement of its own over the shaft')])
    if not names:
        return found
    chosen = [question for question in found
              if any(question.name == name or question.name.startswith(f'{name}.')
                     for name in names)]
    unknown = [name for name in names if not any(
        question.name == name or question.name.startswith(f'{name}.') for question in found)]
    if unknown:
        raise ConfigurationError([
            Problem(name, None, 'is no axis of the line, nor a segment of one that moves',
                    'known are: ' + ', '.join([*line['axes'], *(q.name for q in found)]))
            for name in unknown])
    return chosen


def _speed(sections: Mapping[str, Values], master: str, drives: Sequence[str]) -> float:
    """Read the set speed of the shaft, nominal where a drive turns it [rad/s]."""
    path, key = master, 'speed_cpm'
    turning = [name for name in drives if sections.get(name, {}).get('mode') == LINE_SHAFT]
    if turning:
        path, key = turning[0], 'nominal_rpm'
        given = sections[path].get(key)
        speed = float(given) * RPM if isinstance(given, (int, float)) else 0.0
    else:
        speed = build_master(master, sections.get(master, {})).speed
    if speed == 0.0:
        raise ConfigurationError([Problem(
            f'{path}.{key}', 0.0, 'there is no movement without a speed', 'give --speed-cpm')])
    return speed


def _drive(sections: Mapping[str, Values], axis: str, drives: Sequence[str],
           ) -> FollowerDrive | None:
    """Find the drive that follows an axis."""
    for name in drives:
        given = sections.get(name, {})
        if given.get('axis') == axis and given.get('mode') != LINE_SHAFT:
            try:
                return build_drive(name, given).drive
            except ConfigurationError as error:
                raise ConfigurationError(
                    problem.below(name) for problem in error.problems) from error
    return None


def _of_axis(axis: CoupledAxis, speed: float, drive: FollowerDrive | None,
             load: Load | None) -> list[Question]:
    found = []
    follows = axis.values['follows'] != SHAFT
    for cam in axis.layout.active:
        profile, coupling = axis.layout.cams[cam], axis.layout.couplings[cam]
        if follows or coupling.scale == 0.0:
            continue  # what it does in time is not its own
        # what never stands has no time at which something could be left
        swings = load if any(each.is_dwell for each in profile.segments) else None
        start_deg = 0.0
        for index, segment in enumerate(profile.segments):
            before = profile.segments[index - 1]
            after = profile.segments[(index + 1) % len(profile.segments)]
            if not segment.is_dwell:
                name = segment.name if cam == ONLY_CAM else f'{cam}.{segment.name}'
                found.append(Question(
                    f'{axis.name}.{name}', axis.unit, segment.lift * coupling.scale, start_deg,
                    segment.end_deg, abs(speed * coupling.ratio),
                    (before.law.ends[1], after.law.ends[0]), profile, abs(speed), index,
                    coupling.scale, axis.limits, swings, drive, segment.law, axis.layout, cam))
            start_deg = segment.end_deg
    # several cams at once: only their sum is what the drive and the limits see; and what the
    # parts of a load take depends on the place too, which a coupling changes
    alone = len(axis.layout.active) == 1 and not (
        drive is not None and drive.parts
        and axis.layout.couplings[axis.layout.active[0]] != Coupling())
    return found if alone else [replace(each, drive=None) for each in found]
