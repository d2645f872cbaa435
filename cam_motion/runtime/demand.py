# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a motion demands of its axis, over a range of shaft angles or for ever, and how fast."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
import math
from typing import NamedTuple

from cam_motion.motion.limits import Limits
from cam_motion.motion.piece import Array
from cam_motion.runtime.motion_over_angle import Motion
from cam_motion.runtime.ramp import RampLimits
import numpy as np

_POINTS = 25  # between two joints: what lies between the points is covered by the margin
_INSIDE = 1e-9  # how far from a joint its two sides are read [rad]
_COARSEST = 0.2  # longest stretch between joints that so many points can serve [rad]
_MARGIN = 0.995  # of each limit: the points miss up to 0.3 % of a peak
_BISECTIONS = 50


class Peaks(NamedTuple):
    """
    Largest magnitudes of a motion at a speed of the shaft, and its range of positions.

    In the unit of the axis, per s, s² and s³.
    """

    velocity: float
    acceleration: float
    jerk: float
    lowest: float
    highest: float


class Demands:
    """What a motion demands, whatever that is known from."""

    @property
    def values(self) -> Array:
        """Position and three derivatives, magnitudes but for the position: shape (4, n)."""
        raise NotImplementedError

    def peaks(self, speed: float, ramp: RampLimits) -> Peaks:
        """
        Compute the peaks.

        Parameters
        ----------
        speed : float
            Speed of the shaft, a magnitude [rad/s].
        ramp : RampLimits
            Acceleration and jerk of the shaft that come on top.

        Returns
        -------
        Peaks
            What may be reached.

        """
        y, y1, y2, y3 = self.values
        acceleration = y2 * speed ** 2 + y1 * ramp.acceleration
        jerk = y3 * speed ** 3 + 3.0 * y2 * speed * ramp.acceleration + y1 * ramp.jerk
        return Peaks(
            float(np.max(y1)) * speed, float(np.max(acceleration)), float(np.max(jerk)),
            float(np.min(y)), float(np.max(y)))

    def highest_speed(self, limits: Limits, ramp: RampLimits) -> float:
        """
        Find the highest speed of the shaft at which all limits on derivatives hold.

        Parameters
        ----------
        limits : Limits
            The limits.
        ramp : RampLimits
            Acceleration and jerk of the shaft that come on top.

        Returns
        -------
        float
            Speed [rad/s]; infinite where nothing limits it, 0 where the shaft's acceleration
            alone breaks a limit.

        """
        _, y1, y2, y3 = self.values
        bounds = [math.inf]
        if limits.velocity is not None and np.any(y1):
            bounds.append(_MARGIN * limits.velocity / float(np.max(y1)))
        if limits.acceleration is not None:
            left = _MARGIN * limits.acceleration - y1 * ramp.acceleration
            bounds.append(_root(left, y2))
        if limits.jerk is not None:
            left = _MARGIN * limits.jerk - y1 * ramp.jerk
            bounds.append(_cubic_bound(left, y3, 3.0 * y2 * ramp.acceleration))
        return min(bounds)

    def keeps_range(self, limits: Limits) -> bool:
        """
        Tell whether the positions stay within their limits.

        Parameters
        ----------
        limits : Limits
            The limits.

        Returns
        -------
        bool
            Whether they do, but for rounding.

        """
        low, high = limits.positions
        y = self.values[0]
        slack = 1e-9 * (1.0 + float(np.ptp(y)))
        return bool(np.min(y) >= low - slack and np.max(y) <= high + slack)


@dataclass(frozen=True)
class Demand(Demands):
    """
    A motion over a range of shaft angles.

    Attributes
    ----------
    motion : Motion
        The motion.
    low, high : float
        The range [rad]; low < high.

    """

    motion: Motion
    low: float
    high: float

    @cached_property
    def values(self) -> Array:
        """Position and three derivatives, magnitudes but for the position: shape (4, n)."""
        joints = self.motion.joints(self.low, self.high)
        edges = np.unique(np.concatenate([[self.low, self.high], joints]))
        parts = np.maximum(1, np.ceil(np.diff(edges) / _COARSEST)).astype(int)
        edges = np.append(np.concatenate([
            np.linspace(a, b, count, endpoint=False)
            for a, b, count in zip(edges, edges[1:], parts)]), edges[-1])
        shares = np.linspace(0.0, 1.0, _POINTS)
        inside = np.minimum(_INSIDE, 0.25 * np.diff(edges))
        starts, spans = edges[:-1] + inside, np.diff(edges) - 2.0 * inside
        values = self.motion((starts[:, None] + spans[:, None] * shares).ravel())
        values[1:] = np.abs(values[1:])
        return values


@dataclass(frozen=True)
class AnyPhase(Demands):
    """
    A sum of motions, each of which may stand anywhere while the others do.

    Attributes
    ----------
    parts : Sequence[Demands]
        The motions.

    """

    parts: Sequence[Demands]

    @cached_property
    def values(self) -> Array:
        """Give lowest and highest position, beside the worst of everything: shape (4, 2)."""
        return np.array([[
            sum(float(pick(part.values[row])) for part in self.parts) for pick in picks]
            for row, picks in enumerate([(np.min, np.max), *[(np.max, np.max)] * 3])])


@dataclass(frozen=True)
class AnyPhaseCascade(Demands):
    """
    A motion that follows another one, and may stand anywhere while that does.

    Attributes
    ----------
    outer, inner : Demands
        What the axis demands over what it follows, and that over the shaft angle.

    """

    outer: Demands
    inner: Demands

    @cached_property
    def values(self) -> Array:
        """Give the chain rule with the worst of the outer motion everywhere: shape (4, n)."""
        y, (y1, y2, y3) = self.outer.values[0], self.outer.values[1:].max(axis=1)
        _, slope, bend, jerk = self.inner.values
        even = np.arange(slope.size) % 2 == 0
        return np.array([
            np.where(even, y.min(), y.max()), y1 * slope, y2 * slope ** 2 + y1 * bend,
            y3 * slope ** 3 + 3.0 * y2 * slope * bend + y1 * jerk])


def _root(left: Array, y2: Array) -> float:
    """Find the largest w with y2 w² <= left everywhere."""
    if np.min(left) < 0.0:
        return 0.0
    bent = y2 > 0.0
    return math.sqrt(float(np.min(left[bent] / y2[bent]))) if bent.any() else math.inf


def _cubic_bound(left: Array, y3: Array, slope: Array) -> float:
    """Find the largest w with y3 w³ + slope w <= left everywhere, by bisection."""
    if np.min(left) < 0.0:
        return 0.0
    if not (np.any(y3) or np.any(slope)):
        return math.inf
    # where either term alone reaches the limit, both together have passed it
    with np.errstate(divide='ignore', invalid='ignore'):
        one = np.nanmin(np.where(y3 > 0.0, np.cbrt(left / y3), np.inf))
        two = np.nanmin(np.where(slope > 0.0, left / slope, np.inf))
    low, high = 0.0, float(min(one, two))
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if np.all(y3 * middle ** 3 + slope * middle <= left):
            low = middle
        else:
            high = middle
    return low
