# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Writing a cam as a table for another controller, and what that costs in accuracy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.tables.formats import FORMATS, Samples, TableFormat, written_formats
from cam_motion.io.tables.table import (
    ACCUMULATE,
    CamTable,
    RETURN,
    TableOptions,
    to_cam,
)
from cam_motion.motion.difference import difference, largest
from cam_motion.motion.piecewise import Peak, Piecewise
from cam_motion.units import TURN
import numpy as np

DEFAULT_POINTS = 361
"""Points of a table of which no count is stated."""

_PARTS = 7.0  # decades of a stroke that its positions are written with
_LEAST_DECIMALS, _MOST_DECIMALS = 6, 15
_COARSE = 12  # points between those of the table, to see quickly how far it is off


@dataclass(frozen=True)
class CamToExport:
    """
    A movement that is to be written as a table.

    Attributes
    ----------
    name : str
        Its name.
    curve : Piecewise
        The movement, over 0 to one turn [unit of the axis].
    advance : float
        What it gains from end to end.
    cyclic : bool
        Whether it goes on after its end: a whole cam, and not one segment of it.
    span : float
        Shaft angle that the turn stands for [rad].
    note : str
        What the table leaves to the coupling of the axis.

    """

    name: str
    curve: Piecewise
    advance: float = 0.0
    cyclic: bool = True
    span: float = TURN
    note: str = ''


@dataclass(frozen=True)
class ExportOptions:
    """
    How a table is written.

    Attributes
    ----------
    points : int | None
        Number of points, the last one closing the cycle; None: 361, or the fewest that hold the
        tolerance.
    tolerance : float | None
        Largest deviation of the position that the target may have [unit of the axis].
    decimals : int | None
        Digits behind the point of the positions; None: as many as the stroke asks for, see
        `decimals_for`.
    cycle_length : float | None
        What the master column counts in one cycle; None: 360 degrees, or what the format wants.
    slave_scale : float
        Units of the axis per unit of the slave column.
    interpolation : str
        How the target interpolates; empty: as its format says.

    """

    points: int | None = None
    tolerance: float | None = None
    decimals: int | None = None
    cycle_length: float | None = None
    slave_scale: float = 1.0
    interpolation: str = ''


@dataclass(frozen=True)
class ExportedTable:
    """
    A written table and how far its target's curve is from the cam.

    Attributes
    ----------
    target : TableFormat
        Its format.
    samples : Samples
        The points as they stand in the file.
    text : str
        The file.
    table : CamTable
        The table as it is read back.
    deviations : tuple[Peak, Peak, Peak]
        Largest differences of position, velocity and acceleration [unit/rad^order] between the
        target's curve and the cam, and where; exact.
    steps : tuple[float, float]
        Largest steps of velocity and acceleration that the target's interpolation makes at the
        points, beyond those of the cam.
    interpolation : str
        How the target interpolates.

    """

    target: TableFormat
    samples: Samples
    text: str
    table: CamTable
    deviations: tuple[Peak, Peak, Peak]
    steps: tuple[float, float]
    interpolation: str

    @property
    def points(self) -> int:
        """Count the points, the closing one included."""
        return len(self.samples.master)


def export_cam(cam: CamToExport, name: str, options: ExportOptions | None = None
               ) -> ExportedTable:
    """
    Write a cam as a table and compare what comes of it with the cam.

    Parameters
    ----------
    cam : CamToExport
        The cam.
    name : str
        Name of the format.
    options : ExportOptions | None
        How it is written.

    Returns
    -------
    ExportedTable
        The table, not yet in a file.

    Raises
    ------
    ConfigurationError
        When the format cannot hold the cam, or not within the tolerance, with the figures.

    """
    options = options or ExportOptions()
    target = FORMATS[name]
    if options.decimals is None:
        options = replace(options, decimals=decimals_for(cam, target, options.slave_scale))
    _check(cam, target, options)
    allowed = list(_counts(target, options))
    if not allowed:
        length = options.cycle_length
        raise ConfigurationError([Problem(
            '--cycle-length', length, f'{target.title} has steps of {target.steps[0]} to '
            f'{target.steps[-1]} and at most {target.most} points: none of these divides it',
            'state the counts of one turn of the master, such as 4096')])
    if options.points is not None:
        if options.points not in allowed:
            near = min(allowed, key=lambda count: abs(count - (options.points or 0)))
            raise ConfigurationError([Problem(
                '-n', options.points, f'{target.title} has {target.least} to {target.most} '
                'points' + (', at steps that divide the cycle' if target.steps else ''),
                f'the nearest is {near}')])
        return _finished(cam, target, options, options.points)
    if options.tolerance is not None:
        return _within(cam, target, options, allowed)
    return _finished(cam, target, options,
                     min(allowed, key=lambda count: abs(count - DEFAULT_POINTS)))


def _check(cam: CamToExport, target: TableFormat, options: ExportOptions) -> None:
    if target.write is None:
        raise ConfigurationError([Problem(
            '--format', target.name, f'{target.title} is only read',
            'write one of: ' + ', '.join(written_formats()))])
    if target.steps and options.cycle_length is None:
        raise ConfigurationError([Problem(
            '--cycle-length', None, f'{target.title} counts the master in integers: state how '
            'many make one cycle', 'such as 4096')])
    if target.angle_unit == 'share':
        slope = cam.curve.extremes(1)
        if not cam.advance or min(peak.value * math.copysign(1.0, cam.advance)
                                  for peak in slope) < -1e-9 * abs(cam.curve.peak(1).value):
            raise ConfigurationError([Problem(
                '--format', target.name, f'{target.title} holds one rise, without a way back',
                'choose a segment that rises or falls with --segment')])


def _counts(target: TableFormat, options: ExportOptions) -> Iterator[int]:
    """Give the numbers of points that the format may have, the least first."""
    if not target.steps:
        yield from range(target.least, target.most + 1)
        return
    for step in sorted(target.steps, reverse=True):
        count, rest = divmod(options.cycle_length or 0.0, step)
        if not rest and target.least <= count + 1 <= target.most:
            yield int(count) + 1


def _within(cam: CamToExport, target: TableFormat, options: ExportOptions,
            allowed: list[int]) -> ExportedTable:
    """Find the smallest table that holds the tolerance."""
    tolerance = options.tolerance or 0.0

    def holds(count: int) -> bool:
        _, _, table = _table(cam, target, options, count)
        angles = np.linspace(0.0, TURN, _COARSE * (count - 1) + 1)
        misses = table.curve().evaluate(angles) - cam.curve.evaluate(angles)
        return float(np.abs(misses).max()) <= tolerance

    # less than half a digit is never held but by chance
    rounding = 0.5 * _unit_of(target, options)
    if tolerance < rounding:
        raise ConfigurationError([Problem(
            '--tolerance', tolerance, f'rounding alone costs {rounding:.3g}',
            'state more --decimals, or a larger tolerance')])
    low, high, last = 0, 0, len(allowed) - 1
    while not (held := holds(allowed[high])) and high < last:
        low, high = high + 1, min(2 * high + 1, last)
    low = low if held else high
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if holds(allowed[middle]) else (middle + 1, high)
    # between the places looked at it may be a little farther off; where rounding alone decides,
    # more points need not help, so that the steps grow
    step = 1
    while True:
        count = allowed[high]
        done = _finished(cam, target, options, count)
        if abs(done.deviations[0].value) <= tolerance:
            return done
        if high == last:
            break
        high, step = min(high + step, last), 2 * step
    raise ConfigurationError([Problem(
        '--tolerance', tolerance, f'{target.title} cannot hold it: with {count} points it '
        f'deviates by {abs(done.deviations[0].value):.3g}',
        f'of which rounding is {rounding:.3g}: state --decimals, or a larger tolerance')])


def decimals_for(cam: CamToExport, target: TableFormat, scale: float) -> int:
    """
    Choose how many decimals a cam is written with.

    Parameters
    ----------
    cam : CamToExport
        The cam.
    target : TableFormat
        The format.
    scale : float
        Units of the axis per unit of the slave column.

    Returns
    -------
    int
        Six at least, and as many as divide the stroke into ten million parts: with 361 points
        rounding then adds less than 0.1 % to the acceleration of a movement over a quarter of
        the cycle, whether the column is in mm or in m.

    """
    least, greatest = (each.value for each in cam.curve.extremes(0))
    stroke = 1.0 if target.angle_unit == 'share' else (greatest - least) / abs(scale)
    if not stroke > 0.0:
        return _LEAST_DECIMALS
    return min(max(math.ceil(_PARTS - math.log10(stroke) - 1e-9), _LEAST_DECIMALS),
               _MOST_DECIMALS)


def _digits(target: TableFormat, options: ExportOptions) -> int:
    return 0 if target.whole else options.decimals or 0


def _unit_of(target: TableFormat, options: ExportOptions) -> float:
    """Give the last digit of a written position, in the unit of the axis."""
    return float(abs(options.slave_scale) * 10.0 ** -_digits(target, options))


def _table(cam: CamToExport, target: TableFormat, options: ExportOptions, count: int
           ) -> tuple[Samples, str, CamTable]:
    """Write the points, and read them as the target would."""
    length = options.cycle_length or {'deg': 360.0, 'share': 1.0}[target.angle_unit] * (
        cam.span / TURN if target.angle_unit == 'deg' else 1.0)
    angles = np.linspace(0.0, TURN, count)
    position = cam.curve.evaluate(angles)
    shift, scale = 0.0, options.slave_scale
    if target.angle_unit == 'share':
        shift, scale = float(position[0]), cam.advance
    if cam.cyclic:
        position[-1] = position[0] + cam.advance
    slave = (position - shift) / scale
    digits = _digits(target, options)
    slopes = [cam.curve.evaluate(angles, order) / scale * (TURN / length) ** order
              if order + 1 < target.columns else None for order in (1, 2)]
    if cam.cyclic:
        for values in slopes:
            if values is not None:
                values[-1] = values[0]
    samples = Samples(np.round(angles / TURN * length, 0 if target.whole else 10),
                      np.round(slave, digits), slopes[0], slopes[1], options.decimals or 0,
                      cam.name, cam.cyclic)
    text = target.written(samples)
    read = TableOptions(
        cycle_length=length, slave_scale=scale, interpolation=options.interpolation or
        target.interpolation, cycle=ACCUMULATE if cam.advance or not cam.cyclic else RETURN)
    table = to_cam(target.read(text, cam.name, read), read, cam.name, target.name)
    return samples, text, replace(table, position=table.position + shift)


def _finished(cam: CamToExport, target: TableFormat, options: ExportOptions, count: int
              ) -> ExportedTable:
    samples, text, table = _table(cam, target, options, count)
    theirs = table.curve()
    # over a segment the turn of the table is not a turn of the shaft
    factor = TURN / cam.span
    apart = difference(theirs, cam.curve)
    found = [largest(apart, order) for order in range(3)]
    first, second, third = (
        Peak(peak.value * factor**order, peak.at / factor) for order, peak in enumerate(found))
    velocity, acceleration = (
        max((abs(jump.amount) for jump in theirs.jumps(order)), default=0.0) * factor**order
        for order in (1, 2))
    return ExportedTable(target, samples, text, table, (first, second, third),
                         (velocity, acceleration), table.interpolation)
