# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What the inputs of a linkage do at one moment, in the words of people."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.linkage_settings import LinkageInputs, LinkageSettings
from cam_motion.mechanism.pose import Pose
from cam_motion.units import DEGREE


def read_inputs(settings: LinkageSettings, given: Mapping[str, float]) -> LinkageInputs:
    """
    Read what the inputs do, in the words of people.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.
    given : Mapping[str, float]
        For an input ``h``: ``h`` [m, rad] or ``h_deg`` [deg], ``h_dot``, ``h_ddot``, and where a
        spool winds it ``h_crank``, the angular velocity of its crank [rad/s].

    Returns
    -------
    LinkageInputs
        The same in SI.

    Raises
    ------
    ConfigurationError
        With every name that says nothing, or says it twice.

    """
    known, problems = _keys(settings), []
    found: tuple[dict[str, float], ...] = ({}, {}, {})
    for key, value in given.items():
        if key not in known:
            problems.append(Problem(key, value, 'says nothing about an input',
                                    'known are: ' + ', '.join(known)))
            continue
        name, order, factor = known[key]
        if not math.isfinite(value):
            problems.append(Problem(key, value, 'must be a finite number'))
        if name in found[order]:
            problems.append(Problem(key, value, 'is given in another way too', 'leave one out'))
        found[order][name] = value * factor
    if problems:
        raise ConfigurationError(problems)
    return LinkageInputs(*found)


def place_inputs(settings: LinkageSettings, given: Mapping[str, float],
                 ) -> tuple[LinkageInputs, Pose]:
    """
    Read what the inputs do, and find the position there.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.
    given : Mapping[str, float]
        As for `read_inputs`.

    Returns
    -------
    tuple[LinkageInputs, Pose]
        The same in SI, and the position.

    Raises
    ------
    ConfigurationError
        As `read_inputs`; when an input is out of range, at the key and with the value given.

    """
    inputs = read_inputs(settings, given)
    try:
        return inputs, settings.assembly.at(inputs.values)
    except ConfigurationError as error:
        known = _keys(settings)
        keys = {known[key][0]: key for key in given if known[key][1] == 0}
        raise ConfigurationError(
            _as_given(each, keys, given) for each in error.problems) from error


def _as_given(problem: Problem, keys: Mapping[str, str], given: Mapping[str, float]) -> Problem:
    """Put the keys and values that were written in the place of the inputs."""
    written = [keys[name] for name in problem.path.split(', ')]
    values = tuple(given[key] for key in written)
    return replace(problem, path=', '.join(written), value=values if values[1:] else values[0])


def _keys(settings: LinkageSettings) -> dict[str, tuple[str, int, float]]:
    """Tell for every key that is understood: its input, the derivative, the factor to SI."""
    known: dict[str, tuple[str, int, float]] = {}
    for name in settings.linkage.inputs:
        known |= {name: (name, 0, 1.0), f'{name}_dot': (name, 1, 1.0),
                  f'{name}_ddot': (name, 2, 1.0)}
        if name in settings.linkage.angles:
            known[f'{name}_deg'] = (name, 0, DEGREE)
        if name in settings.spools:
            known[f'{name}_crank'] = (name, 1, settings.spools[name])
    return known
