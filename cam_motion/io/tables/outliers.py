# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Where the points of a table leave a smooth curve: jumps, corners, single wrong points."""

from __future__ import annotations

from typing import NamedTuple

from cam_motion.io.tables.table import ACCUMULATE, CamTable
from cam_motion.motion.piece import Array
from cam_motion.units import TURN
import numpy as np
from numpy.typing import NDArray

_STANDS_OUT = 6.0  # a second difference so many times those around it is none of a smooth curve
_SIDE = 0.3  # share of a spike that its neighbours have where one point is wrong
_ROUNDING = 1e-12
_MOST_DECIMALS = 9
_EXACT = 1e-9  # angles this close (relative to a step) to equal steps have equal steps
_FINE = 0.1  # resolution of angles, as a share of a step: a coarser one is a choice of points


class Differences(NamedTuple):
    """
    Second divided differences, twice, so that they stand for the acceleration.

    ``places`` are the points in their middle, ``angles`` these points' angles [rad], ``steps``
    the mean distance to both neighbours [rad], and ``noise`` what rounding makes of them.
    """

    places: NDArray[np.intp]
    angles: Array
    values: Array
    steps: Array
    noise: Array


class Break(NamedTuple):
    """
    A place where a table is not smooth.

    ``kind`` is ``jump``, ``velocity_step`` or ``outlier``, at the point ``place``, by
    ``amount``, over a ``step`` of the table [rad]; ``reach`` is how far the next one is [rad].
    """

    kind: str
    place: int
    amount: float
    step: float
    reach: float


def second_differences(table: CamTable) -> Differences:
    """
    Take the second differences of the positions, over the seam where the cycle closes.

    Parameters
    ----------
    table : CamTable
        A table of at least two points whose angles rise.

    Returns
    -------
    Differences
        One for each inner point, and one at the seam.

    """
    x, y = table.angle, table.position
    places = np.arange(1, len(x) - 1)
    closes = table.covers_cycle and len(x) > 2
    if closes and (table.cycle == ACCUMULATE or abs(table.advance) <= 1e-9 * table.stroke):
        x = np.concatenate([[x[-2] - TURN], x])
        y = np.concatenate([[y[-2] - table.advance], y])
        places = np.concatenate([[0], places])
    if len(x) < 3:
        empty = np.zeros(0)
        return Differences(np.zeros(0, dtype=np.intp), empty, empty, empty, empty)
    h = np.diff(x)
    steps = 0.5 * (h[1:] + h[:-1])
    slopes = np.diff(y) / h
    resolution = _ROUNDING * max(float(np.abs(y).max()), table.stroke)
    decimals = 0.5 * (resolution_of(table.position) or 0.0)
    # each point may be off by that: once before, twice at, once behind the middle
    noise = (4.0 + 1e-6) * (max(resolution, decimals) + angle_noise(table)) / steps**2
    return Differences(places, x[1:-1], np.diff(slopes) / steps, steps, noise)


def resolution_of(values: Array) -> float | None:
    """
    Find the power of ten to which numbers were rounded.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The numbers.

    Returns
    -------
    float | None
        1, 0.1, 0.01 ...; None where they have all their digits.

    """
    for decimals in range(_MOST_DECIMALS + 1):
        scaled = values * 10.0**decimals
        if np.abs(scaled - np.round(scaled)).max() < 1e-6:
            return float(10.0**-decimals)
    return None


def angle_noise(table: CamTable) -> float:
    """
    Tell by how much positions are off because their angles are rounded.

    Parameters
    ----------
    table : CamTable
        A table whose angles rise.

    Returns
    -------
    float
        Largest velocity times the largest distance of an angle from where it would be if all
        had equal steps, in the unit of the axis; 0 where rounding does not explain that
        distance.

    """
    ideal = np.linspace(table.angle[0], table.angle[-1], len(table.angle))
    off = float(np.abs(table.angle - ideal).max())
    step = float(ideal[1] - ideal[0])
    if off <= _EXACT * step:
        return 0.0
    resolution = resolution_of((table.angle + table.start) * table.per_radian)
    if resolution is None or off * table.per_radian > 0.51 * resolution or (
            resolution > _FINE * step * table.per_radian):
        return 0.0
    slopes = np.diff(table.position) / np.diff(table.angle)
    return off * float(np.abs(slopes).max())


def breaks_in(table: CamTable) -> list[Break]:
    """
    Find where a table is not smooth.

    Parameters
    ----------
    table : CamTable
        A table whose angles rise.

    Returns
    -------
    list[Break]
        Jumps, corners and wrong points in order of the angle.

    """
    found = second_differences(table)
    d, count = found.values, len(found.values)
    if count < 7:
        return []
    size = np.abs(d)
    # of a closed cycle the neighbours of the first are the last
    closed = found.places[0] == 0
    around = np.zeros(count)
    for shift in (-4, -3, -2, 2, 3, 4):
        near = np.roll(size, shift)
        if not closed:
            if shift > 0:
                near[:shift] = 0.0
            else:
                near[shift:] = 0.0
        around = np.maximum(around, near)
    # a line that meets a dwell has no bend around it at all: that is a corner, too
    stands_out = (size > _STANDS_OUT * around + found.noise) & (
        size > 0.02 * size.max() + found.noise)
    listed: list[Break] = []
    taken = -2
    spikes = np.flatnonzero(stands_out)
    for n in spikes.tolist():
        if n <= taken:
            continue
        before, after = (float(d[(n + k) % count]) if closed or 0 <= n + k < count else 0.0
                         for k in (-1, 1))
        here, step = float(d[n]), float(found.steps[n])
        later = spikes[spikes > n + 1]
        reach = float(found.angles[later[0]] - found.angles[n]) if later.size else step
        place = int(found.places[n])
        if before * here < 0.0 > after * here and min(abs(before), abs(after)) > _SIDE * abs(here):
            listed.append(Break('outlier', place, -0.5 * here * step**2, step, reach))
            taken = n + 1
        elif after * here < 0.0 and 0.5 < abs(after / here) < 2.0:
            jump = 0.5 * (here - after) * step**2
            listed.append(Break('jump', place, jump, step, reach))
            taken = n + 1
        else:
            same = sum(value for value in (before, after) if value * here > 0.0)
            listed.append(Break('velocity_step', place, (here + same) * step, step, reach))
            taken = n + 1 if after * here > 0.0 and abs(after) > _SIDE * abs(here) else n
    return listed
