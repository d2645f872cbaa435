# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What the points of one shaft, or of one axis that others follow, cannot do from tick to tick."""

from __future__ import annotations

from cam_motion.runtime.point import Point
from cam_motion.units import DEGREE

_PER_GAP = 0.1  # share of the way by which a fluctuating shaft may miss it over lost ticks
_STEEPEST = 5000.0  # acceleration that no shaft has [rad/s²]: its speed has stepped
_STEP = 1e-6  # of the speed that is rounding [rad/s]
_TOLERANCE = 1e-3  # by which an angle may miss what speed and time lead to [rad]
_SHARE = 0.02  # the same for an axis, of its way at the highest speed heard from tick to tick
_BETWEEN = 4.0  # between two points an axis may accelerate so many times as hard as in any of them
_SOONEST = 100.0  # no axis comes to the highest speed heard faster than in 1 / this [s]


class Plausibility:
    """
    What the angle and the speed of a shaft may miss.

    Attributes
    ----------
    tolerance : float
        By how much an angle may miss the trapezoidal rule from tick to tick [rad].

    """

    def __init__(self) -> None:
        """Use the figures of a machine's shaft."""
        self.tolerance = _TOLERANCE

    def learn(self, point: Point, period: float) -> None:
        """
        Take note of a point that is to be believed; of a shaft nothing need be learnt.

        Parameters
        ----------
        point : Point
            The point.
        period : float
            Time from tick to tick [s].

        """

    def forget(self) -> None:
        """Begin anew."""

    def accepts(self, point: Point, last: Point, step: float, miss: float, gap: bool) -> bool:
        """
        Look closer at a point that misses the tolerance.

        Parameters
        ----------
        point, last : Point
            The point and the one before.
        step : float
            Time between them [s].
        miss : float
            By how much it misses the trapezoidal rule [rad].
        gap : bool
            Whether ticks have been lost between.

        Returns
        -------
        bool
            Whether its position fits, as far as its speed can have changed.

        """
        change = point.velocity - last.velocity
        # ticks may have been lost while the speed changed, or while it fluctuated
        room = self.tolerance + 0.5 * abs(change * step)
        if gap:
            room += _PER_GAP * abs(0.5 * (point.velocity + last.velocity) * step)
        return abs(miss) <= room

    def is_steady(self, point: Point, last: Point, step: float) -> bool:
        """
        Tell whether the speed has not stepped.

        Parameters
        ----------
        point, last : Point
            The point and the one before.
        step : float
            Time between them [s].

        Returns
        -------
        bool
            Whether the change of speed is none that a shaft cannot make.

        """
        return abs(point.velocity - last.velocity) <= _STEEPEST * step + _STEP

    def place(self, position: float) -> str:
        """
        Describe a position.

        Parameters
        ----------
        position : float
            The position [rad].

        Returns
        -------
        str
            It in degrees.

        """
        return f'{position / DEGREE:.6g} deg'

    @property
    def speed_unit(self) -> str:
        """Name the unit of speeds."""
        return 'rad/s'


class AxisPlausibility(Plausibility):
    """
    What the setpoints of an axis may miss, whatever its unit.

    Nothing is known of an axis but what it says, so that the measure is taken from there: the
    highest speed V and the largest acceleration A of all points heard. From one point to the next
    the speed may change by what 4 A, or V within 10 ms, lead to; the position may miss the
    trapezoidal rule by A step² / 2, twice the most that an acceleration of up to A can do, and by
    2 % of the way at V. Over lost ticks it may have moved on unheard, no farther than at V.

    Attributes
    ----------
    tolerance : float
        By how much a position may miss the trapezoidal rule from tick to tick, in its unit.

    """

    def __init__(self) -> None:
        """Know nothing of the axis."""
        super().__init__()
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        self.tolerance = self._speed = self._acceleration = 0.0

    def learn(self, point: Point, period: float) -> None:
        """
        Take the measure of a point that is to be believed.

        Parameters
        ----------
        point : Point
            The point.
        period : float
            Time from tick to tick [s].

        """
        speed, acceleration = abs(point.velocity), abs(point.acceleration)
        if speed > self._speed or acceleration > self._acceleration:
            self._speed = max(self._speed, speed)
            self._acceleration = max(self._acceleration, acceleration)
            self.tolerance = period * (
                _SHARE * self._speed + 0.25 * self._acceleration * period)

    def accepts(self, point: Point, last: Point, step: float, miss: float, gap: bool) -> bool:
        """
        Look closer at a point that misses the tolerance; see `Plausibility.accepts`.

        Parameters
        ----------
        point, last : Point
            The point and the one before.
        step : float
            Time between them [s].
        miss : float
            By how much it misses the trapezoidal rule, in the unit of the axis.
        gap : bool
            Whether ticks have been lost between.

        Returns
        -------
        bool
            Whether its position fits.

        """
        speed, acceleration = self._with(point)
        moved = _SHARE * speed * step + 0.5 * acceleration * step * step
        if gap:
            moved = min(moved, speed * step)
        return abs(miss) <= moved or super().accepts(point, last, step, miss, gap)

    def is_steady(self, point: Point, last: Point, step: float) -> bool:
        """
        Tell whether the speed has not stepped.

        Parameters
        ----------
        point, last : Point
            The point and the one before.
        step : float
            Time between them [s].

        Returns
        -------
        bool
            Whether the change of speed is explained by what has been heard; the first motion
            ever heard explains itself.

        """
        speed, acceleration = self._with(point)
        change = abs(point.velocity - last.velocity)
        most = max(_BETWEEN * acceleration, _SOONEST * speed) * step
        if change <= most or not self._speed:
            if step > 0.0:
                # who states no accelerations is known by the changes of speed
                self._acceleration = max(self._acceleration, change / step)
            return True
        return False

    def _with(self, point: Point) -> tuple[float, float]:
        return (max(self._speed, abs(point.velocity)),
                max(self._acceleration, abs(point.acceleration)))

    def place(self, position: float) -> str:
        """
        Describe a position.

        Parameters
        ----------
        position : float
            The position, in the unit of the axis.

        Returns
        -------
        str
            It as a number.

        """
        return f'{position:.6g}'

    @property
    def speed_unit(self) -> str:
        """Name the unit of speeds."""
        return '/s'
