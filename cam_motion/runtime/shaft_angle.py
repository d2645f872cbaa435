# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The angle of the shaft at the time of a setpoint, for whoever is told both separately."""

from __future__ import annotations

from collections import deque
import math

from cam_motion.runtime.point import Point
from cam_motion.runtime.ticks import NANOSECONDS

KEPT = 16
"""Shaft points that are kept: those of as many setpoints may still be on their way."""

FARTHEST = 0.1
"""A point that is farther away in time does not tell the angle [s]."""


class ShaftAngles:
    """
    Remembers the last points of a shaft, to be asked for its angle at the time of one of them.

    A setpoint bears the time of the shaft point that it answers, and so finds its angle exactly,
    whichever of the two arrives first by up to `KEPT` points; where its own is missing, another
    one near in time is carried on with its speed and acceleration.
    """

    def __init__(self) -> None:
        """Know no point yet."""
        self._points: deque[tuple[int, Point]] = deque(maxlen=KEPT)

    def note(self, point: Point) -> None:
        """
        Take a point of the shaft.

        Parameters
        ----------
        point : Point
            Angle [rad], speed [rad/s] and acceleration [rad/s²] of the shaft.

        """
        time_ns = point.sec * NANOSECONDS + point.nanosec
        if self._points and time_ns < self._points[-1][0]:
            self._points.clear()  # the time base has begun anew
        self._points.append((time_ns, point))

    def at(self, time_ns: int) -> float:
        """
        Tell the angle of the shaft.

        Parameters
        ----------
        time_ns : int
            Time on the machine's time base [ns].

        Returns
        -------
        float
            Angle [rad, unwrapped]; NaN where no point is near.

        """
        if not self._points:
            return math.nan
        noted_ns, point = next(
            (each for each in reversed(self._points) if each[0] <= time_ns), self._points[0])
        late = (time_ns - noted_ns) / NANOSECONDS
        if abs(late) > FARTHEST:
            return math.nan
        return point.position + late * (point.velocity + 0.5 * late * point.acceleration)
