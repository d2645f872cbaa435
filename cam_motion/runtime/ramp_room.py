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
from cam_motion.runtime.demand import Demand
from cam_motion.runtime.motion_over_angle import Motion
from cam_motion.runtime.ramp import RampLimits
import numpy as np

_SOFTER = 0.8  # from one pair of ramp limits to the next that is tried
_TRIES = 40
_SPEEDS = 48  # at which a ramp is looked at, denser towards its fast end


class RampRoom:
    """
    The room that the limits of all axes leave for the acceleration of the shaft.

    On a ramp an axis has y'' w² + y' a and y''' w³ + 3 y'' w a + y' j. Near the fast end of a
    ramp, where w takes most of the limits, the acceleration of a jerk-limited ramp fades with
    the square root of what is left to go.

    Parameters
    ----------
    axes : Iterable[tuple[Motion, float, Limits]]
        The motion of each axis, the shaft angle after which it repeats [rad], and its limits.

    """

    def __init__(self, axes: Iterable[tuple[Motion, float, Limits]]) -> None:
        """Look at each axis over a period."""
        self._axes = [
            (_extreme(Demand(motion, 0.0, period).values[1:]), limits)
            for motion, period, limits in axes
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
            The same, or both made smaller by the same factor. Speeds that break the limits at
            constant speed count for nothing: no ramp would be gentle enough there.

        """
        share = 1.0
        for _ in range(_TRIES):
            softer = RampLimits(limits.acceleration * share, limits.jerk * share)
            if all(_keeps(rates, own, fastest, softer, alpha) for rates, own in self._axes):
                return softer
            share *= _SOFTER
        return softer


def _extreme(rates: Array) -> Array:
    """Keep one of equal columns, which dwells have many of."""
    return np.unique(rates, axis=1)


def _keeps(rates: Array, limits: Limits, fastest: float, ramp: RampLimits, least: float) -> bool:
    y1, y2, y3 = rates
    for share in np.linspace(0.0, 1.0, _SPEEDS) ** 3:
        omega = fastest * (1.0 - share)
        if _breaks(y2 * omega ** 2, limits.acceleration) or _breaks(y3 * omega ** 3, limits.jerk):
            continue
        alpha = min(max(ramp.acceleration, least),
                    math.sqrt(least * least + 2.0 * ramp.jerk * (fastest - omega)))
        if _breaks(y2 * omega ** 2 + y1 * alpha, limits.acceleration) or _breaks(
                y3 * omega ** 3 + 3.0 * y2 * omega * alpha + y1 * ramp.jerk, limits.jerk):
            return False
    return True


def _breaks(values: Array, limit: float | None) -> bool:
    return limit is not None and bool(np.any(values > limit))
