# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""How gently the shaft must change its speed so that no axis breaks its limits meanwhile."""

from __future__ import annotations

from collections.abc import Iterable
import math

from cam_motion.motion.limits import Limits
from cam_motion.motion.piece import Array
from cam_motion.runtime.demand import Demands
from cam_motion.runtime.ramp import ramp_time, RampLimits
import numpy as np

_SOFTER = 0.7  # from one jerk to the next that is tried
_TRIES = 60
_SHARES = 1.0 - np.linspace(0.0, 1.0, 48) ** 3  # speeds looked at, denser towards the fast end
# A speed this close to where a limit breaks at constant speed leaves no room for any ramp.
_NO_ROOM = 2.5e-4


class RampRoom:
    """
    The room that the limits of all axes leave for the acceleration of the shaft.

    On a ramp an axis has y'' w² + y' a and y''' w³ + 3 y'' w a + y' j. Near the fast end of a
    ramp, where w takes most of the limits, the acceleration of a jerk-limited ramp fades with
    the square root of what is left to go.

    Parameters
    ----------
    axes : Iterable[tuple[Demands, Limits]]
        What the motion of each axis demands, and its limits.

    """

    def __init__(self, axes: Iterable[tuple[Demands, Limits]]) -> None:
        """Look at each axis."""
        self._axes = [
            (_extreme(demands.values[1:]), limits) for demands, limits in axes
            if limits.acceleration is not None or limits.jerk is not None]

    def __bool__(self) -> bool:
        """Tell whether any axis needs room."""
        return bool(self._axes)

    def soften(self, fastest: float, limits: RampLimits, alpha: float = 0.0) -> RampLimits:
        """
        Find ramp limits with which all axes keep theirs.

        Parameters
        ----------
        fastest : float
            Greatest speed on the ramp [rad/s], a magnitude.
        limits : RampLimits
            Largest acceleration and jerk of the shaft.
        alpha : float
            Its acceleration at that speed, a magnitude [rad/s²].

        Returns
        -------
        RampLimits
            The same, or softer ones: of those that fit, the pair that is fastest from rest. Where
            none does with that acceleration, the pair does not bear it. Speeds that break the
            limits at constant speed, or all but do, count for nothing: no ramp would be gentle
            enough there.

        """
        omegas = fastest * _SHARES
        rooms = [_Room(rates, own, omegas) for rates, own in self._axes]
        softest = _SOFTER ** _TRIES
        best = RampLimits(limits.acceleration * softest, limits.jerk * softest)
        soonest = math.inf
        for k in range(_TRIES):
            jerk = limits.jerk * _SOFTER ** k
            if ramp_time(fastest, RampLimits(limits.acceleration, jerk)) > soonest:
                break
            fading = np.sqrt(alpha * alpha + 2.0 * jerk * (fastest - omegas))
            bound = np.min([room.acceleration(jerk) for room in rooms], axis=0)
            # where it has not faded enough, the acceleration must be bounded from the start
            tight = bound < np.minimum(fading, max(limits.acceleration, alpha))
            acceleration = min(limits.acceleration, np.min(bound, where=tight, initial=math.inf))
            if acceleration <= 0.0 or acceleration < alpha:
                continue
            duration = ramp_time(fastest, RampLimits(acceleration, jerk))
            if duration < soonest:
                best, soonest = RampLimits(float(acceleration), jerk), duration
        return best


class _Room:
    """What the limits of one axis leave at some speeds of the shaft [rad/s]."""

    def __init__(self, rates: Array, limits: Limits, omegas: Array) -> None:
        y1, y2, y3 = rates
        near = omegas[:, None] * (1.0 + _NO_ROOM)
        free = np.ones_like(omegas, dtype=bool)
        if limits.acceleration is not None:
            free &= np.all(y2 * near ** 2 <= limits.acceleration, axis=1)
        if limits.jerk is not None:
            free &= np.all(y3 * near ** 3 <= limits.jerk, axis=1)
        self._y1, self._free, self._left = y1, free, np.full_like(omegas, math.inf)
        omega = omegas[free, None]
        if limits.acceleration is not None:
            self._left[free] = _least(limits.acceleration - y2 * omega ** 2, y1)
        self._jerk = None if limits.jerk is None else limits.jerk - y3 * omega ** 3
        self._slope = 3.0 * y2 * omega

    def acceleration(self, jerk: float) -> Array:
        """Give the largest acceleration of the shaft at each speed, beside a jerk of its own."""
        if self._jerk is None:
            return self._left
        left = self._left.copy()
        left[self._free] = np.minimum(
            left[self._free], _least(self._jerk - self._y1 * jerk, self._slope))
        return left


def _extreme(rates: Array) -> Array:
    """Keep the columns that no other one exceeds in everything; the rest never decides."""
    rates = np.unique(rates, axis=1)
    beyond = [np.count_nonzero(np.all(rates >= each[:, None], axis=0)) for each in rates.T]
    return rates[:, np.equal(beyond, 1)]


def _least(left: Array, slope: Array) -> Array:
    """Find per row the largest factor of the slope that is left for; negative where none is."""
    with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
        most = np.where(slope > 0.0, left / slope, np.where(left < 0.0, -1.0, math.inf))
    return np.asarray(np.min(most, axis=1))
