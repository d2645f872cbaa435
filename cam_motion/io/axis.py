# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""An axis as a configuration describes it, every problem at once."""

from __future__ import annotations

from collections.abc import Mapping
import math
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io import parameters
from cam_motion.io.parameters import check_values
from cam_motion.motion.diagram import Axis
from cam_motion.motion.laws import make_law
from cam_motion.motion.limits import Limits, QUANTITIES
from cam_motion.motion.profile import CamProfile, program_problems
from cam_motion.motion.segment import Segment
from cam_motion.units import DEGREE, rate_text, RPM

SHORTEST_DEG = 1e-6
"""Least span of a segment [deg]: with less, nothing is left of an angle but its rounding."""

LARGEST_LIFT = 1e15
"""Largest magnitude of a lift, in the unit of its axis."""

Values = Mapping[str, Any]
"""Parameters of one node by flat name."""


def build_axis(name: str, given: Values) -> Axis:
    """
    Check the parameters of an axis and compile its cam.

    Parameters
    ----------
    name : str
        Name of the axis.
    given : Mapping[str, Any]
        Parameters by flat name (``feed.end_deg``).

    Returns
    -------
    Axis
        The axis.

    Raises
    ------
    ConfigurationError
        With every problem, paths relative to the axis.

    """
    names = given.get('segments')
    names = [n for n in names if isinstance(n, str)] if isinstance(names, (list, tuple)) else []
    own, below = {}, {segment: {} for segment in names}  # type: ignore[var-annotated]
    for key, value in given.items():
        head, _, rest = key.partition('.')
        if rest and head in below:
            below[head][rest] = value
        else:
            own[key] = value
    values, problems = check_values(parameters.CAM_AXIS, own)
    problems += [
        Problem('segments', name, 'every segment has a name of its own')
        for name in dict.fromkeys(names) if names.count(name) > 1
    ]
    if not names and values['segments'] == []:
        problems.append(Problem('segments', [], 'a cam needs at least one segment'))
    segments = []
    for segment in names:
        built, wrong = _build_segment(segment, below[segment])
        segments.append(built)
        problems += [problem.below(segment) for problem in wrong]
    problems += _span_problems(segments)
    accumulate = values['cycle'] == 'accumulate'
    if problems and segments:
        # angles and lifts are looked at although a law or another parameter is wrong
        known = {problem.path for problem in problems}
        problems += [problem for problem in program_problems(tuple(segments), accumulate)
                     if problem.path not in known]
    if problems or not segments:
        raise ConfigurationError(problems)
    limits = Limits(*(values[f'limits.{quantity}'] for quantity in QUANTITIES[1:]))
    return Axis(name, CamProfile(segments, accumulate), values['unit'], limits)


def _span_problems(segments: list[Segment]) -> list[Problem]:
    """Find segments whose numbers no machine has, and with which the cam would overflow."""
    problems = []
    start = 0.0
    for segment in segments:
        if 0.0 < segment.end_deg - start < SHORTEST_DEG:
            problems.append(Problem(
                f'{segment.name}.end_deg', segment.end_deg, 'a segment must span at least '
                f'{SHORTEST_DEG:g} deg', 'leave the segment out'))
        if math.isfinite(segment.lift) and abs(segment.lift) > LARGEST_LIFT:
            problems.append(Problem(
                f'{segment.name}.lift', segment.lift,
                f'a lift must be at most {LARGEST_LIFT:g}', 'take a larger unit'))
        start = segment.end_deg
    return problems


def _build_segment(name: str, given: Values) -> tuple[Segment, list[Problem]]:
    """Build a segment with a stand-in (NaN, any law) for whatever is wrong, and say what is."""
    fixed = {spec.name for spec in parameters.SEGMENT}
    values, problems = check_values(
        parameters.SEGMENT, {k: v for k, v in given.items() if k in fixed})
    law = make_law('cubic')
    try:
        law = make_law(values['law'], **{k: v for k, v in given.items() if k not in fixed})
    except ConfigurationError as error:
        problems += error.problems
    if values['law'] != 'dwell' and 'lift' not in given:
        problems.append(Problem('lift', None, 'a segment with a law needs a lift'))
    wrong = {problem.path for problem in problems}
    end_deg, lift = (
        math.nan if key in wrong else values[key] for key in ('end_deg', 'lift'))
    return Segment(name, law, end_deg, lift), problems


def speed_problems(axis: Axis, omega: float) -> list[Problem]:
    """
    Check whether an axis keeps its limits at a steady shaft speed.

    Parameters
    ----------
    axis : Axis
        The axis.
    omega : float
        Speed of the shaft [rad/s].

    Returns
    -------
    list[Problem]
        One problem per limit that would break, with the figures.

    """
    problems = []
    for order, quantity in enumerate(QUANTITIES[1:], start=1):
        limit = axis.limits.of_order(order)
        if limit is None:
            continue
        bound = Limits(**{quantity: limit}).highest_speed(axis.profile)
        if bound is None or abs(omega) <= bound.omega * (1.0 + 1e-9):
            continue
        unit = rate_text(axis.unit, order)
        where = f'segment {bound.segment} at {bound.at / DEGREE:.4g} deg'
        if bound.omega == 0.0:
            rule = f'the acceleration steps in {where}: no jerk limit can be met'
            hint = 'take a law whose acceleration is continuous, or leave the jerk unlimited'
        else:
            # a product grows to infinity where a power would raise
            needed = limit * math.prod([abs(omega) / bound.omega] * order)
            rule = (f'at {abs(omega) / RPM:g} cycles/min {where} needs {needed:.6g} {unit}')
            # cut, not rounded: the figure given must itself be allowed
            most = math.floor(bound.omega / RPM * 100.0) / 100.0
            hint = (f'run at most {most:.2f} cycles/min, raise the limit, or give '
                    'the segment more angle or another law')
        problems.append(Problem(f'{axis.name}.limits.{quantity}', limit, rule, hint))
    return problems
