# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Segments with the law ``spline``: their points, their ends, and what their neighbours do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws import MotionLaw
from cam_motion.motion.laws.with_points import END_STATES, lift_of, shares_of, spline_curve
from cam_motion.motion.piece import Array
from cam_motion.motion.segment import Segment
from cam_motion.motion.spline import Ends, EndState, estimate, PERIODIC
from cam_motion.units import DEGREE
import numpy as np

FULL_CIRCLE_DEG = 360.0
_MISS_DEG = 1e-6  # how far the first and last angle may lie from where the segment starts and ends
_MISS = 1e-9  # how far (relative) a stated lift may be from that of the table


def through_points(segments: Sequence[Segment]) -> tuple[Segment, ...]:
    """
    Give every segment with the law ``spline`` its curve.

    Parameters
    ----------
    segments : Sequence[Segment]
        The segments of one turn; their angles rise, and the first follows on the last.

    Returns
    -------
    tuple[Segment, ...]
        The segments; the curves of the splines are in the unit of the axis over a span of 1.

    Raises
    ------
    ConfigurationError
        When angles or lift of a table are not those of its segment.

    Notes
    -----
    A spline that is a whole turn closes on itself in velocity and acceleration. Otherwise what
    is not told of its ends is what its neighbour does there; next to an ``auto`` segment or
    another spline, which do as they are told themselves, it is estimated from the nearest points
    on both sides.

    """
    if not any(segment.is_spline for segment in segments):
        return tuple(segments)
    starts = [0.0, *(segment.end_deg for segment in segments)]
    problems = [problem for segment, start in zip(segments, starts)
                if segment.is_spline for problem in _problems(segment, start)]
    if problems:
        raise ConfigurationError(problems)
    found = []
    for n, (segment, start) in enumerate(zip(segments, starts)):
        if segment.is_spline:
            told = [segment.law.parameters[name] for names in END_STATES for name in names]
            ends: Ends = PERIODIC
            if len(segments) > 1 or any(value is not None for value in told):
                # of a turn that is one spline, the estimates look over its seam
                ends = (_end(segments, starts, n, 0), _end(segments, starts, n, 1))
            span = (segment.end_deg - start) * DEGREE
            segment = replace(segment, law=MotionLaw(
                segment.law.name, segment.law.parameters,
                spline_curve(segment.law.parameters, span, ends, segment.lift)))
        found.append(segment)
    return tuple(found)


def _problems(segment: Segment, start_deg: float) -> list[Problem]:
    parameters, problems = segment.law.parameters, []
    angles = parameters['angles_deg']
    for at, given, wanted in zip(('starts', 'ends'), angles[:1] + angles[-1:],
                                 (start_deg, segment.end_deg)):
        if abs(given - wanted) > _MISS_DEG:
            problems.append(Problem(
                f'{segment.name}.angles_deg', given, f'the table must go from {start_deg:g} to '
                f'{segment.end_deg:g} deg as its segment does: it {at} at {given:g}',
                'the angles are those of the shaft, from the start of the cycle'))
    lift = lift_of(parameters)
    if lift is not None and abs(lift - segment.lift) > _MISS * max(
            map(abs, (*parameters['positions'], segment.lift))):
        problems.append(Problem(
            f'{segment.name}.lift', segment.lift, 'must be what the table rises by, from its '
            f'first to its last position: {lift:.9g}', 'leave it out'))
    return problems


def _end(segments: Sequence[Segment], starts: Sequence[float], n: int, side: int) -> EndState:
    """Tell what a spline does at its start (0) or end (1)."""
    segment = segments[n]
    told = [segment.law.parameters[name] for name in END_STATES[side]]
    if None not in told:
        return EndState(*told)
    place = (n + (1, -1)[side == 0]) % len(segments)
    other = segments[place]
    if other.is_spline or other.is_auto:
        known = _estimated(segments, starts, n, side)
    else:
        span = (other.end_deg - starts[place]) * DEGREE
        known = EndState(*(
            other.gain * other.law.curve.end_values(order)[1 - side] / span**order
            for order in (1, 2)))
    return EndState(*(have if have is not None else value for have, value in zip(told, known)))


def _estimated(segments: Sequence[Segment], starts: Sequence[float], n: int,
               side: int) -> EndState:
    """Estimate from the points on both sides, or on this one beside what has none."""
    x, y = _table(segments, starts, n)
    joint = x[-1] if side else x[0]
    place = (n + (1, -1)[side == 0]) % len(segments)
    if segments[place].is_spline:
        u, w = _table(segments, starts, place)
        if side:
            u, w = u - u[0] + x[-1], w - w[0] + y[-1]
            x, y = np.append(x, u[1:]), np.append(y, w[1:])
        else:
            u, w = u - u[-1] + x[0], w - w[-1] + y[0]
            x, y = np.append(u[:-1], x), np.append(w[:-1], y)
    return estimate(x, y, float(joint))


def _table(segments: Sequence[Segment], starts: Sequence[float], n: int) -> tuple[Array, Array]:
    parameters = segments[n].law.parameters
    span = (segments[n].end_deg - starts[n]) * DEGREE
    return (span * shares_of(parameters),
            np.array(parameters['positions'] or (0.0, segments[n].lift)))
