# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Segments with the law ``auto``: joined to their neighbours in velocity and acceleration."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws import MotionLaw
from cam_motion.motion.laws.with_conditions import quintic
from cam_motion.motion.laws.with_points import END_STATES
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.points import through_points
from cam_motion.motion.segment import Segment
import numpy as np

_AGREE = 1e-9  # how far (relative) a stated end may lie from what the next segment starts with

_STATED = ('end_velocity', 'end_acceleration')
# From (lift, v0, a0, v1, a1) over a span of 1 to the coefficients of u³, u⁴ and u⁵.
_COEFFICIENTS = np.array([quintic(*unit.tolist()).coefficients[3:] for unit in np.eye(5)]).T
# The integral of the jerk squared, (6 c3 + 24 c4 u + 60 c5 u²)², as a form in c3, c4 and c5.
_JERK_SQUARED = np.array([[36.0, 72.0, 120.0], [72.0, 192.0, 360.0], [120.0, 360.0, 720.0]])
_STIFFNESS = _COEFFICIENTS.T @ _JERK_SQUARED @ _COEFFICIENTS


def matched(segments: Sequence[Segment]) -> tuple[Segment, ...]:
    """
    Give every segment with the law ``auto`` the curve that joins its neighbours.

    Those with the law ``spline`` get theirs first, see `through_points`.

    Parameters
    ----------
    segments : Sequence[Segment]
        The segments of one turn; their angles rise, and the first follows on the last.

    Returns
    -------
    tuple[Segment, ...]
        The segments; the curves of the ``auto`` ones are in the unit of the axis over a span of
        1, those with another law are left as they are.

    Raises
    ------
    ConfigurationError
        When a velocity or acceleration stated at the end of an ``auto`` segment is not that
        with which the next one starts.

    Notes
    -----
    Where two ``auto`` segments meet, velocity and acceleration are free unless they are stated.
    They are chosen so that the integral of the jerk squared over all ``auto`` segments is least;
    jerk and snap then do not step there either. A turn of nothing but ``auto`` segments is the
    periodic quintic spline through its points.

    References
    ----------
    C. de Boor, A Practical Guide to Splines (1978), least property of the odd-degree spline.

    """
    segments = through_points(segments)
    if not any(segment.is_auto for segment in segments):
        return segments
    starts = [0.0, *(segment.end for segment in segments)]
    spans = np.diff(starts)
    # in units of the mean span, so that the equations are well scaled
    unit = float(spans.mean())
    spans = spans / unit
    joints = _joints(segments, spans, unit)
    _smooth(segments, spans, joints)
    found = []
    for n, segment in enumerate(segments):
        if segment.is_auto:
            (v0, a0), (v1, a1) = (joints[k % len(segments)].tolist() for k in (n, n + 1))
            span = float(spans[n])
            piece = quintic(segment.lift, v0 * span, a0 * span**2, v1 * span, a1 * span**2)
            segment = replace(segment, law=MotionLaw(
                segment.law.name, segment.law.parameters, Piecewise(0.0, [piece])))
        found.append(segment)
    return tuple(found)


def shaped_with(segments: Sequence[Segment], index: int) -> tuple[int, ...]:
    """
    Find the segments whose curves follow from the law of one of them.

    Parameters
    ----------
    segments : Sequence[Segment]
        The segments of one turn.
    index : int
        Place of the one.

    Returns
    -------
    tuple[int, ...]
        Places in the order of the shaft, over its seam too, ``index`` among them: ``auto``
        segments on both sides, up to a joint at which velocity and acceleration are stated, and
        a spline whose end follows its neighbour.

    """
    count = len(segments)
    before: list[int] = []
    after: list[int] = []
    for found, step in ((before, -1), (after, 1)):
        here = index
        while len(before) + len(after) + 1 < count:
            place = (here + step) % count
            other, first = segments[place], place if step < 0 else here
            known = here == index or not (segments[here].is_auto or segments[here].is_spline)
            if other.is_auto and not (first != index and segments[first].is_auto and _is_stated(
                    segments[first], _STATED)):
                found.append(place)
                here = place
                continue
            if other.is_spline and known and not other.law.parameters['velocities'] and (
                    not _is_stated(other, END_STATES[step < 0])):
                found.append(place)
            break
    return (*reversed(before), index, *after)


def _is_stated(segment: Segment, names: Sequence[str]) -> bool:
    return None not in (segment.law.parameters[name] for name in names)


def _joints(segments: Sequence[Segment], spans: Array, unit: float) -> Array:
    """Give velocity and acceleration at the start of each segment, NaN where they are free."""
    joints = np.full((len(segments), 2), np.nan)
    problems = []
    for n, (before, after) in enumerate(zip([segments[-1], *segments[:-1]], segments)):
        if not before.is_auto:
            joints[n] = _end_state(before, spans[n - 1], 1)
            continue
        stated = [before.law.parameters[name] for name in _STATED]
        scale = np.array([unit, unit**2])
        joints[n] = scale * [np.nan if value is None else value for value in stated]
        if after.is_auto:
            continue
        needed = _end_state(after, spans[n], 0)
        largest = abs(needed) + 1e-3 * max(abs(after.lift), abs(before.lift))
        problems += [
            Problem(f'{before.name}.{name}', value, 'must be what the next segment starts with: '
                    f'{after.name} starts with {need:.9g}', 'leave it out')
            for name, value, need, miss, slack in zip(
                _STATED, stated, needed / scale, abs(joints[n] - needed), _AGREE * largest)
            if miss > slack
        ]
        joints[n] = needed
    if problems:
        raise ConfigurationError(problems)
    return joints


def _end_state(segment: Segment, span: float, end: int) -> Array:
    """Give velocity and acceleration at one end of a segment whose law is known."""
    return np.array([segment.gain * segment.law.curve.end_values(order)[end] / span**order
                     for order in (1, 2)])


def _smooth(segments: Sequence[Segment], spans: Array, joints: Array) -> None:
    """Fill in what is free at the joints, with the least integral of the jerk squared."""
    free = np.flatnonzero(np.isnan(joints))
    if not free.size:
        return
    autos = [n for n, segment in enumerate(segments) if segment.is_auto]
    # what differs from a straight line: the line itself has no jerk, and rounding stays small
    slope = sum(segments[n].lift for n in autos) / float(spans[autos].sum())
    joints[:, 0] -= slope
    values = joints.reshape(-1)  # a view: two values per joint
    values[free] = 0.0
    matrix = np.zeros((values.size, values.size))
    load = np.zeros(values.size)
    for n in autos:
        span, after = spans[n], (n + 1) % len(segments)
        places = np.array([2 * n, 2 * n + 1, 2 * after, 2 * after + 1])
        scale = np.array([span, span**2, span, span**2])
        form = _STIFFNESS / span**5
        np.add.at(matrix, (places[:, None], places), form[1:, 1:] * np.outer(scale, scale))
        np.add.at(load, places, form[1:, 0] * scale * (segments[n].lift - slope * span))
    load += matrix @ values
    size = 1.0 / np.sqrt(matrix.diagonal()[free])
    system = matrix[np.ix_(free, free)] * np.outer(size, size)
    values[free] = size * np.linalg.solve(system, -size * load[free])
    joints[:, 0] += slope
