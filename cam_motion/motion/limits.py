# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Limits of an axis and the shaft speed up to which its cam keeps them."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import NamedTuple

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.piecewise import Peak
from cam_motion.motion.profile import CamProfile, SegmentPeaks

QUANTITIES = ('position', 'velocity', 'acceleration', 'jerk')
"""Names of the derivatives with respect to time by their order."""


class SpeedBound(NamedTuple):
    """
    The highest steady shaft speed at which a cam keeps its limits, and what holds it there.

    The speed ``omega`` is in rad/s, the angle ``at`` in rad; ``limit`` is the limit that binds,
    of the named quantity, in the unit of the axis per s to its order.
    """

    omega: float
    quantity: str
    limit: float
    segment: str
    at: float


@dataclass(frozen=True)
class Limits:
    """
    The largest magnitudes that an axis may reach; None where there is no limit.

    Attributes
    ----------
    velocity, acceleration, jerk : float | None
        In the unit of the axis per s, s² and s³; positive.
    lowest, highest : float | None
        Range of positions, in the unit of the axis.

    Raises
    ------
    ConfigurationError
        When a limit is not a finite number, one on a derivative is not above 0, or the range of
        positions is empty.

    """

    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    lowest: float | None = None
    highest: float | None = None

    def __post_init__(self) -> None:
        """Refuse limits that are none."""
        rates = {name: self.of_order(order)
                 for order, name in enumerate(QUANTITIES[1:], start=1)}
        problems = [
            Problem(f'limits.{name}', value, 'must be a finite number above 0',
                    'leave it out where nothing limits the axis')
            for name, value in rates.items()
            if value is not None and not (math.isfinite(value) and value > 0.0)
        ]
        low, high = self.positions
        if not low < high:
            problems.append(Problem(
                'limits.highest', self.highest, f'must lie above limits.lowest, {self.lowest}'))
        if problems:
            raise ConfigurationError(problems)

    @property
    def positions(self) -> tuple[float, float]:
        """Range of positions, infinite where there is no limit."""
        return (-math.inf if self.lowest is None else self.lowest,
                math.inf if self.highest is None else self.highest)

    def of_order(self, order: int) -> float | None:
        """
        Give the limit on one derivative.

        Parameters
        ----------
        order : int
            1 for the velocity, 2 for the acceleration, 3 for the jerk.

        Returns
        -------
        float | None
            The limit, in the unit of the axis per s^order.

        """
        return (self.velocity, self.acceleration, self.jerk)[order - 1]

    def highest_speed(self, profile: CamProfile) -> SpeedBound | None:
        """
        Find the highest steady shaft speed at which a cam keeps all limits.

        Parameters
        ----------
        profile : CamProfile
            The cam.

        Returns
        -------
        SpeedBound | None
            The lowest bound over all segments and limits; None where nothing limits the speed.
            Its speed is 0 where the jerk is limited and the cam's acceleration steps.

        """
        bounds = [
            bound for peaks in profile.segment_peaks for order in (1, 2, 3)
            if (bound := self._bound(peaks, order)) is not None
        ]
        return min(bounds, key=lambda bound: bound.omega, default=None)

    def _bound(self, peaks: SegmentPeaks, order: int) -> SpeedBound | None:
        limit = self.of_order(order)
        peak: Peak = (peaks.velocity, peaks.acceleration, peaks.jerk)[order - 1]
        if limit is None or peak.value == 0.0:
            return None
        # y^(n) omega^n <= limit; an infinite peak allows no speed at all
        omega = 0.0 if math.isinf(peak.value) else (limit / abs(peak.value)) ** (1.0 / order)
        return SpeedBound(omega, QUANTITIES[order], limit, peaks.segment.name, peak.at)
