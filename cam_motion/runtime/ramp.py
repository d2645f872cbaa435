# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Jerk-limited speed ramps: the fastest way from one speed to another, in closed form."""

from __future__ import annotations

import math
from typing import NamedTuple


class RampLimits(NamedTuple):
    """Largest magnitudes of the shaft's acceleration [rad/s²] and jerk [rad/s³]; positive."""

    acceleration: float
    jerk: float


class RampStep(NamedTuple):
    """A stretch of constant jerk [rad/s³] and its duration [s]."""

    duration: float
    jerk: float


def speed_ramp(omega: float, alpha: float, target: float, limits: RampLimits) -> list[RampStep]:
    """
    Plan the fastest change of speed within the limits.

    Parameters
    ----------
    omega : float
        Speed at the start [rad/s].
    alpha : float
        Acceleration at the start [rad/s²]; may exceed the limit (after a quick stop), it is
        then taken back first.
    target : float
        Speed at the end [rad/s], reached with zero acceleration.
    limits : RampLimits
        Limits on acceleration and jerk.

    Returns
    -------
    list[RampStep]
        At most four steps; empty when there is nothing to do.

    Notes
    -----
    The time-optimal control of a double integrator with bounded input (jerk) and bounded state
    (acceleration): jerk +-J until the peak acceleration, hold it if it is the limit, jerk -+J.
    With d the direction, a = d alpha and D = d (target - omega), the peak is
    a_p = sqrt(J D + a²/2), cut at the limit.

    """
    bound, jerk = limits
    steps: list[RampStep] = []
    excess = abs(alpha) - bound
    if excess > 0.0:
        duration = excess / jerk
        steps.append(RampStep(duration, -math.copysign(jerk, alpha)))
        reduced = math.copysign(bound, alpha)
        omega += 0.5 * (alpha + reduced) * duration
        alpha = reduced
    released = omega + 0.5 * alpha * abs(alpha) / jerk
    direction = math.copysign(1.0, target - released)
    start = direction * alpha
    change = direction * (target - omega)
    peak = min(bound, math.sqrt(max(0.0, jerk * change + 0.5 * start * start)))
    hold = 0.0
    if peak == bound:
        hold = (change - (2.0 * peak * peak - start * start) / (2.0 * jerk)) / peak
    steps += [
        RampStep((peak - start) / jerk, direction * jerk),
        RampStep(hold, 0.0),
        RampStep(peak / jerk, -direction * jerk),
    ]
    return [step for step in steps if step.duration > 0.0]


def ramp_time(change: float, limits: RampLimits) -> float:
    """
    Tell how long the fastest ramp takes that begins and ends without acceleration.

    Parameters
    ----------
    change : float
        Change of speed, a magnitude [rad/s].
    limits : RampLimits
        Limits on acceleration and jerk.

    Returns
    -------
    float
        Its duration [s].

    """
    bound, jerk = limits
    if bound * bound < jerk * change:
        return change / bound + bound / jerk
    return 2.0 * math.sqrt(change / jerk)


def leads_to(omega: float, alpha: float, target: float, limits: RampLimits) -> bool:
    """
    Tell whether a speed can be reached without taking the acceleration under way back first.

    Parameters
    ----------
    omega, alpha : float
        Speed [rad/s] and acceleration [rad/s²] now.
    target : float
        Speed to come to [rad/s].
    limits : RampLimits
        Limits on acceleration and jerk of the way there.

    Returns
    -------
    bool
        Whether the acceleration is within the limits, and points at the target and not beyond.

    """
    return abs(alpha) <= limits.acceleration and (
        0.0 <= 0.5 * alpha * abs(alpha) / limits.jerk * math.copysign(1.0, target - omega)
        <= abs(target - omega))
