# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The motion of an axis for a short time to come, as points between which a quintic fits."""

from __future__ import annotations

from collections.abc import Sequence
import math
from typing import NamedTuple

from cam_motion.runtime.motion_over_angle import Motion
from cam_motion.runtime.ramp import RampLimits, RampStep, speed_ramp
from cam_motion.runtime.shaft_motion import ShaftMotion, ShaftState
import numpy as np

SHORTEST = 2e-4
"""Points closer to each other than this are one [s]."""

_APART = 0.99 * SHORTEST  # but for rounding
_ITERATIONS = 8  # of Newton's method, for a time within a few steps of a smooth motion
_MOST_TO_REST = 20  # times in the part in which the shaft comes to rest
_ROUNDING = 1e-12  # of an angle
_NEAR = 1e-7  # how far before and behind a joint its two sides are looked at [rad]


class AheadPoint(NamedTuple):
    """
    The setpoint of an axis at a time to come.

    The time [s] counts from the shaft's present state; position, velocity and acceleration are
    in the unit of the axis, per s, per s²; the angle is that of the shaft [rad].
    """

    time: float
    position: float
    velocity: float
    acceleration: float
    shaft_angle: float = math.nan


def shaft_ahead(state: ShaftState, jerk: float, horizon: float) -> ShaftMotion:
    """
    Let a shaft go on as it does now.

    A jerk takes the acceleration to zero and no further, as at the end of a ramp; and the shaft
    comes to rest where its speed falls to zero, instead of turning round.

    Parameters
    ----------
    state : ShaftState
        Its present state.
    jerk : float
        Its present jerk [rad/s³].
    horizon : float
        For how long that is wanted [s].

    Returns
    -------
    ShaftMotion
        The motion, from time 0 on.

    """
    _, omega, alpha = state
    duration = horizon
    if alpha == 0.0:
        jerk = 0.0
    elif alpha * jerk < 0.0:
        duration = min(horizon, -alpha / jerk)
    steps = [RampStep(duration, jerk), RampStep(horizon - duration, 0.0)]
    rest = _time_of_rest(omega, alpha, jerk)
    if rest > duration:
        return ShaftMotion(0.0, state, steps)
    stands = ShaftMotion(0.0, state, steps[:1]).state(rest).phi
    return ShaftMotion(0.0, state, [RampStep(rest, jerk)], ShaftState(stands, 0.0, 0.0))


def stopping_after(shaft: ShaftMotion, limits: RampLimits) -> ShaftMotion:
    """
    Let a shaft come to rest behind its last step.

    Parameters
    ----------
    shaft : ShaftMotion
        Its motion.
    limits : RampLimits
        Limits of the ramp to rest.

    Returns
    -------
    ShaftMotion
        That motion, then the ramp; it ends exactly at rest.

    """
    final = shaft.final
    steps = speed_ramp(final.omega, final.alpha, 0.0, limits)
    rest = ShaftMotion(0.0, final, steps).final.phi
    return shaft.continued(steps, ShaftState(rest, 0.0, 0.0))


def times_ahead(shaft: ShaftMotion, step: float, count: int) -> list[float]:
    """
    Choose times for a look-ahead: a grid, and a part behind it in which the shaft comes to rest.

    Parameters
    ----------
    shaft : ShaftMotion
        What the shaft does, from time 0 on.
    step : float
        Step of the grid [s].
    count : int
        Steps of the grid.

    Returns
    -------
    list[float]
        The times [s], from 0 on, rising; the last one is not before the shaft has settled.

    """
    grid = [k * step for k in range(count + 1)]
    rest = shaft.settled_at - grid[-1]
    if rest <= 0.0:
        return grid
    more = min(math.ceil(rest / step), _MOST_TO_REST)
    return grid + [grid[-1] + rest * k / more for k in range(1, more)] + [shaft.settled_at]


def _time_of_rest(omega: float, alpha: float, jerk: float) -> float:
    """Find when a speed first falls to zero; infinite if it does not, or is zero now."""
    if omega * alpha >= 0.0:
        return math.inf
    square = alpha * alpha - 2.0 * omega * jerk
    if square < 0.0:
        # the end of a ramp to rest, where both end together but for rounding
        return -alpha / jerk if abs(square) <= 1e-9 * alpha * alpha else math.inf
    return -2.0 * omega / (alpha + math.copysign(math.sqrt(square), alpha))


def look_ahead(motion: Motion, shaft: ShaftMotion, times: Sequence[float]) -> list[AheadPoint]:
    """
    Sample the motion of an axis ahead, at given times and at the joints between them.

    At a joint a derivative steps: of a curve that is smooth between its points a quintic through
    position, velocity and acceleration misses next to nothing, across a joint it does. Where the
    acceleration itself steps there is a point on either side.

    Parameters
    ----------
    motion : Motion
        What the axis does over the shaft angle.
    shaft : ShaftMotion
        What the shaft does, from time 0 on.
    times : Sequence[float]
        At which points are wanted [s], rising from 0.

    Returns
    -------
    list[AheadPoint]
        The points, rising in time by at least `SHORTEST`; the first and the last time are kept,
        others give way to a joint that is as close.

    """
    marks = [times[0]]
    joints = _joint_times(motion, shaft, times[0], times[-1])
    inner = sorted([*((t, False) for t in times[1:-1]), *((t, True) for t in joints)])
    joint_before = True
    for t, is_joint in inner:
        if t - marks[-1] >= _APART:
            marks.append(t)
        elif is_joint and len(marks) == 1:
            marks.append(marks[0] + SHORTEST)
        elif is_joint and not joint_before:
            marks[-1] = t
        else:
            continue
        joint_before = is_joint
    while len(marks) > 1 and times[-1] - marks[-1] < _APART:
        marks.pop()
    return [_point(motion, shaft, t) for t in [*marks, times[-1]]]


def _point(motion: Motion, shaft: ShaftMotion, t: float) -> AheadPoint:
    phi, omega, alpha = shaft.state(t)
    y, slope, bend, _ = motion.sample(phi)
    return AheadPoint(t, y, slope * omega, bend * omega * omega + slope * alpha, phi)


def _joint_times(motion: Motion, shaft: ShaftMotion, start: float, end: float) -> list[float]:
    """Find when the shaft passes the joints of the motion."""
    first, last = shaft.state(start), shaft.state(end)
    low, high = sorted((first.phi, last.phi))
    if low == high:
        return []
    found = []
    room = _ROUNDING * (1.0 + abs(low))
    for phi in map(float, np.unique(motion.joints(low - room, high + room))):
        t = start + (end - start) * (phi - first.phi) / (last.phi - first.phi)
        for _ in range(_ITERATIONS):
            state = shaft.state(t)
            if state.omega == 0.0:
                break
            step = (phi - state.phi) / state.omega
            t = min(max(t + step, start), end)
            if abs(step) < SHORTEST * 1e-4:
                aside = 0.5 * SHORTEST if _acceleration_steps(motion, phi) else 0.0
                found += [t - aside, t + aside] if aside else [t]
                break
    return found


def _acceleration_steps(motion: Motion, phi: float) -> bool:
    """Tell whether the second derivative steps at a joint, and not only the third."""
    _, _, before, jerk_before = motion.sample(phi - _NEAR)
    _, _, behind, jerk_behind = motion.sample(phi + _NEAR)
    smooth = 3.0 * _NEAR * (abs(jerk_before) + abs(jerk_behind))
    return abs(behind - before) > smooth + 1e-6 * (abs(before) + abs(behind))
