# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Whether a table has points and digits enough for a smooth acceleration."""

from __future__ import annotations

from collections.abc import Iterator

from cam_motion.io.tables.finding import Context, Finding, WARNING
from cam_motion.io.tables.outliers import angle_noise, resolution_of, second_differences
from cam_motion.io.tables.table import QUINTIC
from cam_motion.motion.spline import interpolate, NATURAL, PERIODIC, smooth
from cam_motion.units import rate_text
import numpy as np

_COARSE = 0.01  # error between every second point, as a share of the stroke, that is too much
_NOISE = 0.05  # share of the peak acceleration that rounding may add
_ENOUGH = 1001  # points that show the course of a cam: one for each 0.36 deg


def too_few_points(context: Context) -> Iterator[Finding]:
    """
    Leave out every second point, and see what a spline makes of them.

    Parameters
    ----------
    context : Context
        The table.

    Yields
    ------
    Finding
        Where it misses the points left out by too much.

    """
    table = context.table
    if table.stroke == 0.0 or table.velocity is not None:
        return
    kept = np.unique([*range(0, len(table.angle), 2), len(table.angle) - 1])
    if len(kept) < 3:
        miss, place, expected = table.stroke, 0, table.stroke
    else:
        x, y = table.angle[kept], table.position[kept]
        closes = table.covers_cycle
        curve = interpolate(x, y, 3, PERIODIC if closes else NATURAL)
        misses = np.abs(curve.evaluate(table.angle) - table.position)
        place = int(np.argmax(misses))
        # halving the steps divides the error of a cubic spline by 16, where it is fine enough
        miss = float(misses[place])
        expected = miss / 16.0
    if miss > _COARSE * table.stroke:
        step = float(np.diff(table.angle).max())
        yield context.found(
            'too_few_points', WARNING, place, miss,
            f'{len(table.angle)} points are too few: a spline through every second one misses '
            f'the others by up to {miss:.4g} {context.unit}, '
            f'{miss / table.stroke:.1%} of the stroke',
            f'between the points the curve may be off by about {expected:.2g} {context.unit}, '
            f'its acceleration by {context.rate(16.0 * expected / step**2, 2)}',
            'export the table with at least twice as many points')


def rounded_angles(context: Context) -> Iterator[Finding]:
    """
    See whether angles that should have equal steps are rounded so far that it shows.

    Parameters
    ----------
    context : Context
        The table.

    Yields
    ------
    Finding
        Where it does.

    """
    table = context.table
    off = angle_noise(table)
    bends = second_differences(table)
    if not off or table.stroke == 0.0 or not bends.values.size:
        return
    step = float(bends.steps.min())
    # half of the bound, as rounding goes; the peak from steps over which it does not matter
    noise = 2.0 * off / step ** 2
    wide = slice(None, None, max(1, len(table.angle) // 360))
    slopes = np.diff(table.position[wide]) / np.diff(table.angle[wide])
    peak = float(np.abs(np.diff(slopes) / np.diff(table.angle[wide])[1:]).max(initial=0.0))
    if noise <= _NOISE * peak:
        return
    yield context.found(
        'rounded_angles', WARNING, None, off,
        f'the angles are rounded: with equal steps, the positions are off by up to {off:.3g} '
        f'{context.unit}', f'noise of {context.rate(noise, 2)} in the acceleration',
        'write the angles with more digits')


def rounded_positions(context: Context) -> Iterator[Finding]:
    """
    See whether the rounding of the positions shows in the acceleration.

    Parameters
    ----------
    context : Context
        The table.

    Yields
    ------
    Finding
        Where it does.

    """
    table = context.table
    resolution = resolution_of(table.position)
    count = len(table.angle)
    if resolution is None or table.stroke == 0.0 or count < 12 or table.interpolation == QUINTIC \
            and table.acceleration is not None:
        return
    # fewer points are as good: over longer steps their rounding bends the curve less
    kept = np.unique(np.linspace(0, count - 1, min(count, _ENOUGH)).round().astype(int))
    smoothed = smooth(table.angle[kept], table.position[kept], resolution, 5, table.covers_cycle)
    bends = second_differences(table)
    own = smoothed.curve.evaluate(np.clip(bends.angles, 0.0, table.angle[-1]), 2)
    noise = np.abs(bends.values - own)
    place = int(np.argmax(noise))
    worst, peak = float(noise[place]), float(np.abs(own).max())
    # what rounding can explain: half a unit at each of three points
    explained = 2.0 * resolution / bends.steps[place] ** 2
    if peak == 0.0 or worst <= _NOISE * peak or worst > 1.5 * explained:
        return
    third = worst / bends.steps[place]
    yield context.found(
        'rounded_positions', WARNING, int(bends.places[place]), worst,
        f'positions are rounded to {resolution:g} {context.unit}: their second difference is '
        f'off by up to {worst:.4g} {rate_text(context.unit, 2, "rad")}, {worst / peak:.0%} of '
        'the peak acceleration',
        f'noise of {context.rate(worst, 2)} in the acceleration, {context.rate(third, 3)} in the '
        'jerk', f'export it with more digits, or --repair {resolution:g}')
