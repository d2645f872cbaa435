# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The parts of a load as a configuration describes them, the same for every mode of a drive."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from cam_motion.drive.load import (
    Friction,
    Lever,
    Part,
    Process,
    RotatingInertia,
    Spring,
    TranslatingMass,
)
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.axis import split_below
from cam_motion.io.cam_drive_parameters import KIND, part_names, PARTS
from cam_motion.io.parameters import check_values, ParameterSpec
from cam_motion.motion.profile import CamProfile
from cam_motion.units import DEGREE


def take_parts(given: Mapping[str, Any], table: Iterable[ParameterSpec],
               ) -> tuple[dict[str, Any], dict[str, Part], list[Problem]]:
    """
    Build the parts of the load of a drive.

    Parameters
    ----------
    given : Mapping[str, Any]
        What the drive has been given, by flat name.
    table : Iterable[ParameterSpec]
        Its other parameters, whose names no part can have.

    Returns
    -------
    tuple[dict[str, Any], dict[str, Part], list[Problem]]
        What has been given beside the parts, those that could be built by name, and everything
        that is wrong with them.

    """
    names = part_names(given)
    taken = {spec.name.partition('.')[0] for spec in table}
    given, problems = _take_unlisted(given, names, taken)
    own, below = split_below(given, names)
    problems += [
        Problem('load', part, 'every part has a name of its own, which is no parameter')
        for part in names if part in taken or list(given['load']).count(part) > 1]
    parts = {}
    for part in names:
        try:
            parts[part] = build_part(below[part])
        except ConfigurationError as error:
            problems += [problem.below(part) for problem in error.problems]
    return own, parts, problems


def _take_unlisted(given: Mapping[str, Any], names: list[str], taken: set[str],
                   ) -> tuple[dict[str, Any], list[Problem]]:
    """Take out what describes a part that the list does not name: one problem for each part."""
    parts = {path.rpartition('.')[0] for path in given if path.endswith('.type')}
    lost = sorted(part for part in parts - {*names} if '.' not in part and part not in taken)
    ghosts = [name for name in names if not any(path.startswith(f'{name}.') for path in given)]
    rest = {path: value for path, value in given.items() if path.partition('.')[0] not in lost}
    return rest, [Problem(
        part, f'a part of type {given[f"{part}.type"]}', 'is described, but load does not name it',
        f'add it to load{f", instead of {ghosts[0]} perhaps" if ghosts else ""}')
        for part in lost]


def build_part(given: Mapping[str, Any]) -> Part:
    """
    Check the parameters of a part of a load and build it.

    Parameters
    ----------
    given : Mapping[str, Any]
        Parameters by name.

    Returns
    -------
    Part
        The part.

    Raises
    ------
    ConfigurationError
        With every problem, paths relative to the part.

    """
    kind = given.get('type')
    if not isinstance(kind, str) or kind not in PARTS:
        raise ConfigurationError(check_values((KIND,), {'type': kind} if kind else {})[1])
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
    if kind == 'process':
        return Process(values['force'], values['moment'], (first, last))
    return Lever(values['inertia'], values['arm'], values['height'], values['moment'],
                 (first, last))


def lever_problems(parts: Mapping[str, Part], profile: CamProfile) -> list[Problem]:
    """
    Check that the slider stays within reach of every lever.

    Parameters
    ----------
    parts : Mapping[str, Part]
        The parts by name.
    profile : CamProfile
        Motion of the follower [m].

    Returns
    -------
    list[Problem]
        One for each lever out of reach.

    """
    low, high = (peak.value for peak in profile.curve.extremes(0))
    return [
        Problem(f'{name}.height', part.height,
                f'the slider must stay within the arm of {part.arm:g} m: it would stand at '
                f'{part.height - high:.6g} to {part.height - low:.6g} m',
                'a longer arm, another height or a smaller lift')
        for name, part in parts.items() if isinstance(part, Lever)
        and max(abs(part.height - low), abs(part.height - high)) >= part.arm
    ]
