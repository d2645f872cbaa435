# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""How fast the shaft may turn while a transition goes on."""

from __future__ import annotations

import math
from typing import NamedTuple

from cam_motion.motion.limits import SpeedBound
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft_motion import ShaftState

_OBEYS_WITHIN = 0.05  # how soon the shaft hears what it may [s]


class Pace(NamedTuple):
    """
    The speeds of the shaft that a plan reckons with.

    The plan must keep its limits at the ``needed`` speed and is lengthened for the sake of the
    ``wanted`` one [rad/s], both with the shaft's ``ramp`` on top; ``sense`` is -1 for a shaft
    that turns backwards.
    """

    needed: float
    wanted: float
    ramp: RampLimits
    sense: float


def pace_of(state: ShaftState, bound: SpeedBound | None, ramp: RampLimits,
            obeyed: bool = True) -> Pace:
    """
    Choose the speeds that a transition begun now must reckon with.

    Parameters
    ----------
    state : ShaftState
        The shaft now.
    bound : SpeedBound | None
        Up to which the axis lets the shaft run.
    ramp : RampLimits
        Acceleration and jerk of the shaft to leave room for.
    obeyed : bool
        Whether the shaft can be asked to run no faster.

    Returns
    -------
    Pace
        The speed that it has or, while it accelerates, cannot but come to: a shaft that obeys
        runs no faster when asked. One that accelerates may be on its way to whatever the axis
        allows, and one that does not obey comes to it.

    """
    speed, sense = abs(state.omega), -1.0 if state.omega < 0.0 else 1.0
    fastest = speed if bound is None else max(speed, bound.omega)
    if not obeyed:
        return Pace(fastest, fastest, ramp, sense)
    if sense * state.alpha > 0.0:
        return Pace(min(speed_ahead(state, ramp), fastest), fastest, ramp, sense)
    return Pace(speed, speed or fastest, ramp, sense)


def speed_ahead(state: ShaftState, ramp: RampLimits) -> float:
    """
    Tell which speed the shaft cannot but come to before it obeys.

    Parameters
    ----------
    state : ShaftState
        The shaft now.
    ramp : RampLimits
        The jerk by which it takes its acceleration back.

    Returns
    -------
    float
        A magnitude [rad/s]: what it has or, while it accelerates, somewhat more.

    """
    speed, rise = abs(state.omega), math.copysign(1.0, state.omega) * state.alpha
    if rise <= 0.0:
        return speed
    return speed + rise * (_OBEYS_WITHIN + 0.5 * rise / ramp.jerk)
