# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
The one transition for everything: a blend from one motion to another over the shaft angle.

Engaging, disengaging, a shift of phase, a change of scale, another cam: the axis goes from an old
motion to a new one by y = old + w (new - old), with a weight w of the shaft angle that is smooth
to the second derivative at both ends. Position, velocity and acceleration follow the shaft by the
chain rule, so that they are continuous whatever the shaft does meanwhile, standing still and
turning back included.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from cam_motion.motion.compiled import Sampler
from cam_motion.motion.piece import Array
from cam_motion.runtime.motion_over_angle import Motion
import numpy as np


def weight(x: Array) -> Array:
    """
    Evaluate the weight 10 x³ - 15 x⁴ + 6 x⁵ and its derivatives.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Share of the span [-].

    Returns
    -------
    ndarray, shape (4, n)
        The weight, 0 before 0 and 1 behind 1, and three derivatives.

    References
    ----------
    VDI 2143 sheet 1, polynomial 3-4-5.

    """
    inside = (x >= 0.0) & (x <= 1.0)
    x = np.clip(x, 0.0, 1.0)
    rest = 1.0 - x
    return np.array([
        x * x * x * (10.0 - x * (15.0 - 6.0 * x)), 30.0 * (x * rest) ** 2,
        60.0 * x * rest * (rest - x), 60.0 * (1.0 - 6.0 * x * rest) * inside])


@dataclass(frozen=True)
class Blend:
    """
    The way from one motion to another.

    Attributes
    ----------
    old, new : Motion
        What the axis did before, and what it does afterwards.
    start : float
        Shaft angle at which the blend begins [rad].
    span : float
        Shaft angle over which it goes [rad]; negative for a shaft that turns backwards.

    """

    old: Motion
    new: Motion
    start: float
    span: float

    @property
    def end(self) -> float:
        """Shaft angle at which the blend is over [rad]."""
        return self.start + self.span

    def share(self, phi: float) -> float:
        """
        Tell how much of the span has been passed.

        Parameters
        ----------
        phi : float
            Shaft angle [rad].

        Returns
        -------
        float
            Below 0 before the start, above 1 behind the end.

        """
        return (phi - self.start) / self.span

    @cached_property
    def sample(self) -> Sampler:
        """Evaluate (y, y', y'', y''') at one shaft angle [rad]."""
        old, new, start, rate = self.old.sample, self.new.sample, self.start, 1.0 / self.span

        def blended(phi: float) -> tuple[float, float, float, float]:
            x = (phi - start) * rate
            if x <= 0.0:
                return old(phi)
            if x >= 1.0:
                return new(phi)
            rest = 1.0 - x
            w = x * x * x * (10.0 - x * (15.0 - 6.0 * x))
            w1 = 30.0 * (x * rest) ** 2 * rate
            w2 = 60.0 * x * rest * (rest - x) * rate * rate
            w3 = 60.0 * (1.0 - 6.0 * x * rest) * rate * rate * rate
            y, slope, bend, jerk = old(phi)
            d, d1, d2, d3 = new(phi)
            d, d1, d2, d3 = d - y, d1 - slope, d2 - bend, d3 - jerk
            return (
                y + w * d,
                slope + w1 * d + w * d1,
                bend + w2 * d + 2.0 * w1 * d1 + w * d2,
                jerk + w3 * d + 3.0 * (w2 * d1 + w1 * d2) + w * d3)
        return blended

    def __call__(self, phi: Array) -> Array:
        """
        Evaluate the blend and its derivatives.

        Parameters
        ----------
        phi : ndarray, shape (n,)
            Shaft angles [rad].

        Returns
        -------
        ndarray, shape (4, n)
            Position and three derivatives, in the unit of the axis per rad^order of the shaft.

        """
        rates = self.span ** -np.arange(4.0)
        w, w1, w2, w3 = weight((phi - self.start) / self.span) * rates[:, None]
        values = self.old(phi)
        d, d1, d2, d3 = self.new(phi) - values
        values[0] += w * d
        values[1] += w1 * d + w * d1
        values[2] += w2 * d + 2.0 * w1 * d1 + w * d2
        values[3] += w3 * d + 3.0 * (w2 * d1 + w1 * d2) + w * d3
        return values

    def joints(self, low: float, high: float) -> Array:
        """
        Give the angles of steps.

        Parameters
        ----------
        low, high : float
            Range of shaft angles [rad].

        Returns
        -------
        ndarray, shape (n,)
            Those of both motions and the ends of the blend, rising [rad].

        """
        ends = np.array([x for x in (self.start, self.end) if low <= x <= high])
        return np.unique(np.concatenate(
            [self.old.joints(low, high), self.new.joints(low, high), ends]))
