# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The interlocks of a machine file, checked and judged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cam_motion.errors import Problem
from cam_motion.io import parameters
from cam_motion.io.axis import CoupledAxis, names_in, split_below, Values
from cam_motion.io.axis_limits import CascadedAxis
from cam_motion.io.format_parameters import INTERLOCK
from cam_motion.io.parameters import check_values
from cam_motion.runtime.interlock import (
    common_turns,
    Distance,
    Interlock,
    judge_cycle,
    Out,
    Side,
    Verdict,
    Windows,
)
from cam_motion.runtime.motion_over_angle import Motion

_ENDS = ('first', 'second')


@dataclass(frozen=True)
class JudgedInterlock:
    """
    An interlock and how the machine keeps it in steady running.

    Attributes
    ----------
    interlock : Interlock
        The interlock.
    verdict : Verdict
        By how much it is kept, or broken.

    """

    interlock: Interlock
    verdict: Verdict


def line_values(given: Values) -> tuple[dict[str, Any], list[Problem]]:
    """
    Check the section of the line but for what stands below its interlocks.

    Parameters
    ----------
    given : Mapping[str, Any]
        Parameters by flat name.

    Returns
    -------
    tuple[dict[str, Any], list[Problem]]
        A usable value for every parameter, and everything that is wrong.

    """
    own, _ = split_below(given, names_in(given, 'interlocks'))
    return check_values(parameters.LINE, own)


def build_interlocks(given: Values, axes: Mapping[str, CoupledAxis | None],
                     ) -> tuple[dict[str, Interlock], list[Problem]]:
    """
    Build the interlocks of a line.

    Parameters
    ----------
    given : Mapping[str, Any]
        Parameters of the line by flat name.
    axes : Mapping[str, CoupledAxis | None]
        Its axes; None for one that could not be built.

    Returns
    -------
    tuple[dict[str, Interlock], list[Problem]]
        The interlocks that are sound, by name, and everything that is wrong, paths relative to
        the line.

    """
    names = names_in(given, 'interlocks')
    _, below = split_below(given, names)
    problems = [Problem('interlocks', name, 'every name stands once')
                for name in below if names.count(name) > 1]
    problems += [
        Problem('interlocks', name, 'is the name of a parameter of the line', 'take another one')
        for name in below if name in {spec.name for spec in parameters.LINE}]
    found = {}
    for name, section in below.items():
        built, wrong = _build(name, section, axes)
        problems += [problem.below(name) for problem in wrong]
        if built is not None:
            found[name] = built
    return found, problems


def _build(name: str, given: Values, axes: Mapping[str, CoupledAxis | None],
           ) -> tuple[Interlock | None, list[Problem]]:
    values, problems = check_values(INTERLOCK, given)
    wrong = {problem.path for problem in problems}
    windows = values['kind'] == 'windows'
    out = []
    for end in _ENDS:
        needs_position = True
        if windows:
            found, more = _out(end, values)
            out.append(found)
            needs_position = found.side is not Side.MOVING
            problems += [] if any(path.startswith(f'{end}_') for path in wrong) else more
        if end not in wrong:
            problems += _axis_problems(end, values[end], axes, needs_position)
    foreign = ('offset', 'least', *(f'{end}_factor' for end in _ENDS)) if windows else tuple(
        f'{end}_{side.value}' for end in _ENDS for side in Side)
    problems += [Problem(key, given[key], f'does not belong to kind {values["kind"]}',
                         'leave it out') for key in foreign if key in given]
    if not windows and values['least'] is None and 'least' not in wrong:
        problems.append(Problem('least', None, 'a distance needs the least gap'))
    if not problems and values['first'] == values['second']:
        problems.append(Problem('second', values['second'], 'must be another axis than the first'))
    if problems:
        return None, problems
    pair = (values['first'], values['second'])
    if windows:
        return Windows(name, pair, (out[0], out[1])), []
    units = [axis.unit for end in pair if (axis := axes[end]) is not None]
    if len(set(units)) > 1:
        return None, [Problem('second', pair[1], f'the axes have units {units[0]} and {units[1]}: '
                              'there is no distance between them')]
    return Distance(name, pair, (values['first_factor'], values['second_factor']),
                    values['offset'], values['least']), []


def _out(end: str, values: Values) -> tuple[Out, list[Problem]]:
    """Read when an axis is out of its rest."""
    given = [side for side in Side if values[f'{end}_{side.value}'] not in (None, False)]
    if len(given) != 1:
        keys = [f'{end}_{side.value}' for side in Side]
        return Out(Side.MOVING), [Problem(
            end, values[end], f'exactly one of {", ".join(keys)} says when the axis is out of '
            'its rest', f'{len(given)} are given')]
    value = values[f'{end}_{given[0].value}']
    return Out(given[0], 0.0 if given[0] is Side.MOVING else value), []


def _axis_problems(end: str, name: str, axes: Mapping[str, CoupledAxis | None],
                   needs_position: bool) -> list[Problem]:
    if name not in axes:
        return [Problem(end, name, 'must name an axis of the line',
                        'known are: ' + ', '.join(axes))]
    axis = axes[name]
    if axis is None:
        return []
    if axis.settings.master_relative:
        return [Problem(end, name, 'engages wherever the shaft is: no shaft angle of it is known',
                        f'give {name} engage.master: absolute')]
    if needs_position and (axis.layout.accumulates or axis.settings.slave_relative):
        return [Problem(end, name, 'has no lasting position: it accumulates, or engages where it '
                        'stands', f'watch {end}_moving instead')]
    return []


def motions_of(axes: Mapping[str, CoupledAxis]) -> dict[str, Motion]:
    """
    Give the motion of every axis over the angle of the shaft.

    Parameters
    ----------
    axes : Mapping[str, CoupledAxis]
        The axes, those in cascade joined.

    Returns
    -------
    dict[str, Motion]
        Motions by name.

    """
    return {name: axis.motion if isinstance(axis, CascadedAxis) else axis.layout.motion
            for name, axis in axes.items()}


def judge(interlocks: Mapping[str, Interlock], axes: Mapping[str, CoupledAxis],
          ) -> dict[str, JudgedInterlock]:
    """
    Judge interlocks in steady running.

    Parameters
    ----------
    interlocks : Mapping[str, Interlock]
        The interlocks by name.
    axes : Mapping[str, CoupledAxis]
        The axes by name.

    Returns
    -------
    dict[str, JudgedInterlock]
        What came of it, by name.

    """
    motions = motions_of(axes)
    ratios = {name: [axis.layout.couplings[cam].ratio for cam in axis.layout.active]
              for name, axis in axes.items() if not isinstance(axis, CascadedAxis)}
    return {name: JudgedInterlock(interlock, judge_cycle(interlock, motions, common_turns(
        [ratio for axis in interlock.axes for ratio in ratios.get(axis, [])])))
        for name, interlock in interlocks.items()}
