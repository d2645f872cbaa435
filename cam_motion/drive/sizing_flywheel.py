# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The smallest flywheel with which the speed of a cam drive fluctuates no more than wanted."""

from __future__ import annotations

from dataclasses import replace
import math
from typing import NamedTuple

from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.orbit import find_orbit, NoOrbitError
import numpy as np

_FIRST = 0.05  # of the motor's inertia: the first flywheel tried after none at all
_STEP = math.sqrt(2.0)  # from one flywheel tried to the next
MOST = 1000.0
"""Flywheels up to this many times the motor's inertia are tried [-]."""


class SmallestFlywheel(NamedTuple):
    """
    What the search found.

    The wanted fluctuation [%]; the flywheel [kg m²] and the fluctuation with it [%], both None
    where even ``largest`` [kg m²], the largest tried, does not hold it; the fluctuation [%] with
    none and with the largest, None where there is no periodic motion.
    """

    wanted_pct: float
    flywheel: float | None
    fluctuation_pct: float | None
    largest: float
    without_pct: float | None
    with_largest_pct: float | None


def fluctuation(drive: CamDrive, flywheel: float) -> float:
    """
    Find how much the speed of a drive fluctuates with another flywheel.

    Parameters
    ----------
    drive : CamDrive
        The drive.
    flywheel : float
        Inertia of the flywheel [kg m²].

    Returns
    -------
    float
        Greatest less least speed, in per cent of the nominal speed; infinite where the drive
        has no periodic motion.

    """
    try:
        with np.errstate(all='ignore'):  # where there is none, the search may overflow
            low, high = find_orbit(replace(drive, flywheel=flywheel)).speeds
    except NoOrbitError:
        return math.inf
    return 100.0 * (high - low) / drive.nominal_speed


def smallest_flywheel(drive: CamDrive, wanted_pct: float) -> SmallestFlywheel:
    """
    Find the smallest flywheel that holds a fluctuation.

    Parameters
    ----------
    drive : CamDrive
        The drive; its own flywheel does not count.
    wanted_pct : float
        Largest fluctuation, in per cent of the nominal speed; above 0.

    Returns
    -------
    SmallestFlywheel
        What was found.

    Notes
    -----
    Nothing makes sure that the fluctuation falls with every step of the flywheel where that is
    small. So flywheels are tried upwards in steps of sqrt(2) until one holds it, and the crossing
    before that is found by Brent's method; a dip narrower than a step would be missed.

    """
    largest = MOST * drive.motor.inertia
    without = excess = fluctuation(drive, 0.0)
    low, flywheel = 0.0, 0.0
    while excess > wanted_pct and flywheel < largest:
        low = flywheel
        flywheel = min(max(_FIRST * drive.motor.inertia, flywheel * _STEP), largest)
        excess = fluctuation(drive, flywheel)
    if excess > wanted_pct:
        return SmallestFlywheel(wanted_pct, None, None, largest, _known(without), _known(excess))
    if flywheel > 0.0:
        from scipy.optimize import brentq
        # no periodic motion counts as twice what is wanted, so that the root stays bracketed
        flywheel = brentq(
            lambda inertia: min(fluctuation(drive, inertia), 2.0 * wanted_pct) - wanted_pct,
            low, flywheel, xtol=1e-9 * flywheel, rtol=1e-9)
        while (excess := fluctuation(drive, flywheel)) > wanted_pct:
            flywheel *= 1.0 + 1e-9
    return SmallestFlywheel(wanted_pct, float(flywheel), excess, largest, _known(without),
                            _known(fluctuation(drive, largest)))


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
