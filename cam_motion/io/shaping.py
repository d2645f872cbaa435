# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Input shaping of an axis as a configuration describes it, every problem at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.shaping_parameters import NO_FILTER
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.shaped_profile import ShapedProfile
from cam_motion.motion.shaping import CamFilter, make_filter
from cam_motion.motion.shaping_effect import Load
from cam_motion.motion.slosh import Container
from cam_motion.units import RPM, TURN

LONGEST = 10.0
"""Cycles over which a filter may reach at most; the cam would be nothing but its mean."""

_ANGLES = ('rad', 'deg')  # units of axes that turn, on which no container moves along a line
_SOURCES = ('frequency_hz', 'container_width', 'container_radius')

Values = Mapping[str, Any]


@dataclass(frozen=True)
class AxisShaping:
    """
    The filter over the cams of an axis.

    Attributes
    ----------
    made : CamFilter
        The filter.
    speed : float
        Speed of the cams for which they are shaped [rad/s].
    fit : bool
        Whether movements are shortened to end where their segments do.

    """

    made: CamFilter
    speed: float
    fit: bool

    def shaped(self, profiles: Mapping[str, CamProfile], ratios: Mapping[str, float],
               ) -> tuple[dict[str, CamProfile], list[Problem]]:
        """
        Shape the cams of an axis.

        Parameters
        ----------
        profiles : Mapping[str, CamProfile]
            The cams by name.
        ratios : Mapping[str, float]
            Their turns per turn of the shaft.

        Returns
        -------
        tuple[dict[str, CamProfile], list[Problem]]
            The shaped cams, and why some cannot be; paths relative to the axis.

        """
        found: dict[str, CamProfile] = dict(profiles)
        problems: list[Problem] = []
        for name, profile in profiles.items():
            if ratios[name] < 0.0:
                problems.append(Problem(
                    'shaping.kind', None, f'a shaped cam runs forwards, its ratio is '
                    f'{ratios[name]:g}: backwards it would swing before it moves',
                    'turn its segments and lifts round instead'))
                continue
            try:
                found[name] = ShapedProfile(profile, self.made, self.speed, self.fit)
            except ConfigurationError as error:
                problems += [problem for problem in error.problems if problem not in problems]
        return found, problems


def take_shaping(values: Values, follows_shaft: bool) -> tuple[AxisShaping | None, list[Problem]]:
    """
    Build the filter of an axis.

    Parameters
    ----------
    values : Mapping[str, Any]
        Parameters of the axis by flat name, each checked by itself.
    follows_shaft : bool
        Whether the axis follows the shaft itself.

    Returns
    -------
    tuple[AxisShaping | None, list[Problem]]
        The filter, None where there is none, and everything that is wrong.

    """
    kind = values['shaping.kind']
    given = [name for name in (*_SOURCES, 'fill_height', 'speed_cpm')
             if values[f'shaping.{name}'] is not None]
    if kind is None and not given:
        return None, []
    problems = load_problems(values)
    if kind is None:
        problems.append(Problem(
            'shaping.kind', None, 'must say which filter is meant',
            f'write kind: zvd, or kind: {NO_FILTER} for the figures without a filter'))
    if kind in (None, NO_FILTER):
        return None, problems
    speed_cpm = values['shaping.speed_cpm']
    if speed_cpm is None:
        problems.append(Problem('shaping.speed_cpm', None, 'must be given: a filter over the '
                                'shaft angle is exact at one speed only'))
    if not follows_shaft:
        problems.append(Problem('shaping.kind', kind, 'is for an axis that follows the shaft: '
                                'one that follows another axis sees no steady speed',
                                'shape the axis that it follows'))
    load = None if problems else load_of(values)
    if load is None:
        return None, problems
    made = make_filter(kind, load.frequency, load.damping, values['shaping.tolerance'])
    speed = speed_cpm * RPM
    if made.duration * speed > LONGEST * TURN:
        return None, [Problem(
            'shaping.speed_cpm', speed_cpm, f'the filter may take {LONGEST:g} cycles at most: at '
            f'this speed it takes {made.duration * speed / TURN:.4g}',
            'run slower, or take a shorter filter')]
    return AxisShaping(made, speed, values['shaping.fit']), []


def load_problems(values: Values) -> list[Problem]:
    """
    Check that what swings is described once, and completely.

    Parameters
    ----------
    values : Mapping[str, Any]
        Parameters by flat name, each checked by itself.

    Returns
    -------
    list[Problem]
        What is wrong.

    """
    given = [name for name in _SOURCES if values[f'shaping.{name}'] is not None]
    fill = values['shaping.fill_height']
    if not given:
        return [Problem('shaping.frequency_hz', None, 'must be given, or the container that '
                        'makes it',
                        'or container_width (or container_radius) and fill_height')]
    problems = [
        Problem(f'shaping.{name}', values[f'shaping.{name}'],
                f'stands for the same as shaping.{given[0]}', 'leave one of the two out')
        for name in given[1:]]
    if fill is None and given != ['frequency_hz']:
        problems.append(Problem('shaping.fill_height', None, 'must be given with a container'))
    if fill is not None and given == ['frequency_hz']:
        problems.append(Problem('shaping.fill_height', fill, 'goes with a container'))
    if given != ['frequency_hz'] and values.get('unit') in _ANGLES:
        problems.append(Problem(f'shaping.{given[-1]}', values[f'shaping.{given[-1]}'],
                                f'a container moves along a line, the axis turns: its unit is '
                                f'{values["unit"]}', 'give frequency_hz instead'))
    return problems


def container_of(values: Values) -> Container | None:
    """
    Read the container that an axis moves.

    Parameters
    ----------
    values : Mapping[str, Any]
        Parameters of the axis by flat name, checked.

    Returns
    -------
    Container | None
        The container; None where there is none.

    """
    width, radius, fill = (values[f'shaping.{name}'] for name in (
        'container_width', 'container_radius', 'fill_height'))
    return None if fill is None else Container(fill, width, radius)


def load_of(values: Values) -> Load | None:
    """
    Read what swings behind an axis.

    Parameters
    ----------
    values : Mapping[str, Any]
        Parameters of the axis by flat name, checked.

    Returns
    -------
    Load | None
        The load; None where nothing is known to swing. For a container its factor is the height
        of the wave at the wall.

    """
    damping = values['shaping.damping']
    container = container_of(values)
    if container is not None:
        return Load(container.frequency, damping, container.height_factor)
    frequency = values['shaping.frequency_hz']
    return None if frequency is None else Load(frequency * TURN, damping)
