# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The set motion between the setpoints that a drive is given."""

from __future__ import annotations

import math
from typing import NamedTuple

NANOSECOND = 1e-9
"""One nanosecond [s]."""


class Setpoint(NamedTuple):
    """
    Where an axis shall be, and how it shall move there.

    Time on the machine's time base [ns], position, velocity and acceleration [unit, unit/s,
    unit/s²], and the angle of the master shaft [rad], NaN where it is not known.
    """

    time_ns: int
    position: float
    velocity: float = 0.0
    acceleration: float = 0.0
    shaft_angle: float = math.nan


class SetState(NamedTuple):
    """Position, velocity, acceleration and jerk of a set motion [unit, unit/s, ...]."""

    position: float
    velocity: float
    acceleration: float
    jerk: float


class SetMotion:
    """
    The polynomial of fifth degree through two setpoints; after the second one the axis is held.

    Parameters
    ----------
    first, last : Setpoint
        The setpoints; position, velocity and acceleration are met at both.

    Raises
    ------
    ValueError
        When the second is not later than the first.

    Notes
    -----
    The quintic Hermite interpolant: what a drive does that is given position, velocity and
    acceleration at a rate below its own. Motion laws of up to fifth degree come out exactly.

    """

    def __init__(self, first: Setpoint, last: Setpoint) -> None:
        """Find the coefficients."""
        if last.time_ns <= first.time_ns:
            raise ValueError('the second setpoint must be later than the first')
        self.first, self.last = first, last
        time = (last.time_ns - first.time_ns) * NANOSECOND
        lift = (last.position - first.position) / time ** 3
        v0, v1 = first.velocity / time ** 2, last.velocity / time ** 2
        a0, a1 = first.acceleration / time, last.acceleration / time
        self._c3 = 10.0 * lift - 4.0 * v1 - 6.0 * v0 - 1.5 * a0 + 0.5 * a1
        self._c4 = (-15.0 * lift + 7.0 * v1 + 8.0 * v0 + 1.5 * a0 - a1) / time
        self._c5 = (6.0 * lift - 3.0 * (v1 + v0) - 0.5 * (a0 - a1)) / time ** 2

    def at(self, time_ns: int) -> SetState:
        """
        Evaluate the set motion.

        Parameters
        ----------
        time_ns : int
            Time on the machine's time base [ns], not before the first setpoint; after the second
            the axis is held at its position.

        Returns
        -------
        SetState
            Position and derivatives.

        """
        if time_ns == self.last.time_ns:
            return SetState(*self.last[1:4], 0.0)
        if time_ns > self.last.time_ns:
            return SetState(self.last.position, 0.0, 0.0, 0.0)
        start, c3, c4, c5 = self.first, self._c3, self._c4, self._c5
        u = (time_ns - start.time_ns) * NANOSECOND
        half = 0.5 * start.acceleration
        return SetState(
            start.position + u * (start.velocity + u * (half + u * (c3 + u * (c4 + u * c5)))),
            start.velocity + u * (2.0 * half + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5))),
            2.0 * half + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5)),
            6.0 * c3 + u * (24.0 * c4 + u * 60.0 * c5))

    def shaft_angle(self, time_ns: int) -> float:
        """
        Look up the angle of the master shaft, which turns steadily between two setpoints.

        Parameters
        ----------
        time_ns : int
            Time on the machine's time base [ns]; after the second setpoint the shaft stands.

        Returns
        -------
        float
            Angle [rad]; NaN where it is not known.

        """
        first, last = self.first, self.last
        if time_ns >= last.time_ns:
            return last.shaft_angle
        share = (time_ns - first.time_ns) / (last.time_ns - first.time_ns)
        return first.shaft_angle + share * (last.shaft_angle - first.shaft_angle)


def stop_from(start: Setpoint, duration_ns: int) -> Setpoint:
    """
    Find where an axis comes to rest that is given no further setpoint.

    Parameters
    ----------
    start : Setpoint
        The last setpoint.
    duration_ns : int
        How long coming to rest takes [ns].

    Returns
    -------
    Setpoint
        Standstill after that time, at the place where the velocity falls to rest by a cubic; the
        shaft is taken to stand.

    """
    time = duration_ns * NANOSECOND
    travel = time * (start.velocity / 2.0 + time * start.acceleration / 12.0)
    return Setpoint(start.time_ns + duration_ns, start.position + travel,
                    shaft_angle=start.shaft_angle)
