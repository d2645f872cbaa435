# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Bringing a shaft to rest whose points have ceased to come."""

from __future__ import annotations

from collections.abc import Iterator

from cam_motion.runtime.follower_settings import FollowerState
from cam_motion.runtime.point import Point
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft_motion import ShaftMotion, ShaftState
from cam_motion.runtime.ticks import NANOSECONDS


def stop_of_axis(last: Point, limits: RampLimits) -> RampLimits:
    """
    Find limits for the stop of an axis that others follow, whatever its unit.

    Nothing tells which speed of the shaft stands behind the speed of an axis. Its stop takes the
    time of the shaft's from the speed at which that just comes to its full deceleration: twice
    the acceleration over the jerk.

    Parameters
    ----------
    last : Point
        The last point of the axis.
    limits : RampLimits
        Limits of the shaft's stop [rad/s², rad/s³].

    Returns
    -------
    RampLimits
        Limits in the unit of the axis. An acceleration that is under way is taken back within an
        eighth of that time.

    """
    rise = limits.acceleration / limits.jerk
    speed, under_way = abs(last.velocity), abs(last.acceleration)
    acceleration = max(speed / rise, under_way)
    if not acceleration:
        return limits
    return RampLimits(acceleration, max(speed / rise ** 2, 4.0 * under_way / rise))


class Coasting:
    """
    The shaft as an axis turns it on for itself, from the last point it has, until it stands.

    The ramp begins at that point's own time, so that all axes that had the same last point come
    to rest on their curves together, whenever each of them has noticed the silence.

    Parameters
    ----------
    last : Point
        The last point of the shaft.
    period : float
        Time from tick to tick [s].
    arrival : float
        Steady time at which the last point arrived [s].
    limits : RampLimits
        Limits of the ramp.
    reason : str
        Why.
    state : FollowerState
        What the axis is in afterwards, HELD or FAULT.

    """

    def __init__(self, last: Point, period: float, arrival: float, limits: RampLimits,
                 reason: str, state: FollowerState) -> None:
        """Plan the ramp."""
        self.reason = reason
        self.state = state
        self._arrival = arrival
        self._start = last.time
        self._time_ns = last.sec * NANOSECONDS + last.nanosec
        self._period_ns = max(1, round(period * NANOSECONDS))
        self._motion = ShaftMotion(last.time, ShaftState(*last[:3])).ramped(
            last.time, 0.0, limits)
        self.over = False
        """Whether the shaft stands and its last point has been given."""

    def due(self, now: float) -> Iterator[Point]:
        """
        Give the points that are due, at the scheduled times of the ticks that did not come.

        Parameters
        ----------
        now : float
            Steady time [s].

        Yields
        ------
        Point
            Points of the shaft; the last one stands exactly.

        """
        until = self._start + (now - self._arrival)
        while not self.over:
            time_ns = self._time_ns + self._period_ns
            if time_ns * 1e-9 > until:
                return
            self._time_ns = time_ns
            state = self._motion.state(time_ns * 1e-9)
            self.over = state.omega == 0.0 == state.alpha
            yield Point(*state, *divmod(time_ns, NANOSECONDS))
