# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A cam table as it was read: points over the shaft angle, and the lines they stand in."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field, replace
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.spline import hermite, interpolate, linear, NATURAL, PERIODIC
from cam_motion.units import TURN
import numpy as np

LINEAR, CUBIC, QUINTIC = 'linear', 'cubic', 'quintic'
INTERPOLATIONS = (LINEAR, CUBIC, QUINTIC)
"""How a controller goes from point to point."""

RETURN, ACCUMULATE = 'return', 'accumulate'
CYCLES = (RETURN, ACCUMULATE)
"""Whether the last point is meant to be the first again, or one stroke further."""

LARGEST = 1e15
"""Largest number of a table."""

MOST_PROBLEMS = 10
"""So many wrong lines of a file are told one by one."""

_NOTHING = 1e-100
_RETURNS = 0.02  # ends this close, as a share of the stroke, are meant to be the same place


@dataclass(frozen=True)
class TableOptions:
    """
    What a table file does not say of itself.

    Attributes
    ----------
    angle_unit : str
        Unit of the master column: ``deg``, ``rad``, or ``length`` for any other, of which
        ``cycle_length`` makes a cycle; empty: what the format says.
    cycle_length : float | None
        What the master column counts in one cycle; None: one turn of ``deg`` or ``rad``, else
        from the first to the last point.
    slave_scale : float
        Units of the axis per unit of the slave column.
    per : str
        What velocities and accelerations are derivatives by: ``master``, the unit of the master
        column, or ``rad`` of the shaft.
    cycle : str
        `RETURN` or `ACCUMULATE`; empty: what the end points say.
    interpolation : str
        One of `INTERPOLATIONS`; empty: what the format says.
    delimiter : str
        What stands between columns; empty: found out.

    """

    angle_unit: str = ''
    cycle_length: float | None = None
    slave_scale: float = 1.0
    per: str = 'master'
    cycle: str = ''
    interpolation: str = ''
    delimiter: str = ''


@dataclass(frozen=True)
class RawTable:
    """
    The numbers of a file, in its own units.

    Attributes
    ----------
    columns : ndarray, shape (n, m)
        Master, slave, and where there are more: velocity, acceleration.
    lines : tuple[int, ...]
        Line of the file in which each point stands.
    angle_unit : str
        Unit of the master column as far as the format says.
    cycle_length : float | None
        What the master column counts in one cycle, where the format says.
    interpolation : str
        How controllers of this format interpolate.
    notes : tuple[str, ...]
        What else is to be known.

    """

    columns: Array
    lines: tuple[int, ...]
    angle_unit: str = ''
    cycle_length: float | None = None
    interpolation: str = CUBIC
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class CamTable:
    """
    A cam table over one turn of the shaft.

    Attributes
    ----------
    angle : ndarray, shape (n,)
        Shaft angles from the first point on [rad]; as the file has them, so perhaps not rising.
    position : ndarray, shape (n,)
        Positions [unit of the axis].
    velocity, acceleration : ndarray, shape (n,), or None
        Derivatives where the file has them [unit/rad, unit/rad²].
    lines : tuple[int, ...]
        Line of each point in the file; 0 for one that was added.
    start : float
        Shaft angle of the first point [rad].
    per_radian : float
        What the master column counts per radian of the shaft.
    per : str
        What the derivatives of the file are by: ``master`` or ``rad``.
    cycle : str
        `RETURN` or `ACCUMULATE`.
    interpolation : str
        How its controller goes from point to point.
    source, format_name : str
        Name of the file and of its format.
    notes : tuple[str, ...]
        What was assumed.

    """

    angle: Array
    position: Array
    lines: tuple[int, ...]
    velocity: Array | None = None
    acceleration: Array | None = None
    start: float = 0.0
    per_radian: float = 1.0
    per: str = 'master'
    cycle: str = RETURN
    interpolation: str = CUBIC
    source: str = ''
    format_name: str = 'csv'
    notes: tuple[str, ...] = field(default=())

    @property
    def rises(self) -> bool:
        """Whether every angle is greater than the one before."""
        return bool((np.diff(self.angle) > 0.0).all())

    @property
    def covers_cycle(self) -> bool:
        """Whether it goes once round, from its first point to that place again."""
        return math.isclose(self.angle[-1] - self.angle[0], TURN, rel_tol=1e-6)

    @property
    def advance(self) -> float:
        """Give what the axis has gained at the last point."""
        return float(self.position[-1] - self.position[0])

    @property
    def stroke(self) -> float:
        """Measure from the lowest to the highest position."""
        return float(np.ptp(self.position))

    def without(self, lines: Collection[int]) -> CamTable:
        """
        Leave points out.

        Parameters
        ----------
        lines : Collection[int]
            Lines of the file in which they stand; neither the first nor the last point.

        Returns
        -------
        CamTable
            The table without them.

        Raises
        ------
        ConfigurationError
            When one of the lines holds no point, or an end.

        """
        inner = set(self.lines[1:-1])
        if wrong := [line for line in lines if line not in inner]:
            raise ConfigurationError([
                Problem(self.source, line, 'only lines that hold a point between the first and '
                        'the last can be left out') for line in wrong])
        kept = np.array([line not in lines for line in self.lines])
        return replace(
            self, angle=self.angle[kept], position=self.position[kept],
            lines=tuple(line for line in self.lines if line not in lines),
            velocity=None if self.velocity is None else self.velocity[kept],
            acceleration=None if self.acceleration is None else self.acceleration[kept])

    def curve(self, interpolation: str = '') -> Piecewise:
        """
        Give the curve that a controller makes of the table.

        Parameters
        ----------
        interpolation : str
            One of `INTERPOLATIONS`; empty: that of the table.

        Returns
        -------
        Piecewise
            The curve; as a spline it closes on itself where the table does.

        """
        kind = interpolation or self.interpolation
        if kind == LINEAR:
            return linear(self.angle, self.position)
        if kind == QUINTIC and self.velocity is not None and self.acceleration is not None:
            return hermite(self.angle, self.position, self.velocity, self.acceleration)
        if kind == CUBIC and self.velocity is not None:
            return hermite(self.angle, self.position, self.velocity)
        closes = self.covers_cycle and (
            self.cycle == ACCUMULATE or abs(self.advance) <= 1e-12 * self.stroke)
        return interpolate(self.angle, self.position, 5 if kind == QUINTIC else 3,
                           PERIODIC if closes else NATURAL)


def to_cam(raw: RawTable, options: TableOptions, source: str, name: str) -> CamTable:
    """
    Bring the numbers of a file to the units of the project.

    Parameters
    ----------
    raw : RawTable
        The numbers.
    options : TableOptions
        What the user says of them.
    source, name : str
        The file, and the name of its format.

    Returns
    -------
    CamTable
        The table; where the file leaves out the last point of a cycle that returns, it is added.

    Raises
    ------
    ConfigurationError
        When an option cannot be used with the file.

    """
    if problems := [
            Problem(f'{source}, line {line}', float(row[np.argmax(np.abs(row))]),
                    f'a number must be at most {LARGEST:g}', 'take a larger unit')
            for line, row in zip(raw.lines, raw.columns) if np.abs(row).max() > LARGEST]:
        raise ConfigurationError(problems[:MOST_PROBLEMS])
    raw = _without_repetition(raw)
    # what no machine can do is nothing
    columns = np.where(np.abs(raw.columns) < _NOTHING, 0.0, raw.columns)
    master, slave = columns[:, 0], columns[:, 1]
    unit = options.angle_unit or raw.angle_unit
    length = options.cycle_length or (
        raw.cycle_length if raw.cycle_length is not None and not options.angle_unit else
        {'deg': 360.0, 'rad': TURN}.get(unit, float(np.max(master) - np.min(master))))
    if not length > 0.0:
        raise ConfigurationError([Problem(
            source, length, 'one cycle must be more than nothing', 'state --cycle-length')])
    per_radian = length / TURN
    angle = (master - master[0]) / per_radian
    by = per_radian if options.per == 'master' else 1.0

    def derivative(order: int) -> Array | None:
        if columns.shape[1] <= 1 + order:
            return None
        return np.asarray(columns[:, 1 + order] * options.slave_scale * by**order)
    position = slave * options.slave_scale
    stroke = float(np.ptp(position))
    cycle = options.cycle or (
        RETURN if abs(position[-1] - position[0]) <= _RETURNS * stroke else ACCUMULATE)
    table = CamTable(
        angle, position, raw.lines, derivative(1), derivative(2),
        start=float(master[0]) / per_radian, per_radian=per_radian, per=options.per, cycle=cycle,
        interpolation=options.interpolation or raw.interpolation, source=source, format_name=name,
        notes=raw.notes)
    return _closed(table, options)


def _without_repetition(raw: RawTable) -> RawTable:
    """Leave out rows that say what the one before says: they say nothing."""
    again = np.flatnonzero((np.diff(raw.columns, axis=0) == 0.0).all(axis=1)) + 1
    if not again.size or len(raw.columns) - len(again) < 2:
        return raw
    kept = np.ones(len(raw.columns), dtype=bool)
    kept[again] = False
    lines = np.array(raw.lines)
    told = ', '.join(map(str, lines[again][:MOST_PROBLEMS])) + ', ...' * (
        len(again) > MOST_PROBLEMS)
    note = f'left out, as they repeat the line before: line{"s" * (len(again) > 1)} {told}'
    return replace(raw, columns=raw.columns[kept], lines=tuple(lines[kept].tolist()),
                   notes=(*raw.notes, note))


def _closed(table: CamTable, options: TableOptions) -> CamTable:
    """Add the last point of a returning cycle that the file leaves to the first one."""
    if table.covers_cycle or not table.rises or options.cycle == ACCUMULATE:
        return table
    steps, moves = np.diff(table.angle), np.abs(np.diff(table.position))
    gap = TURN - table.angle[-1]
    if not 0.0 < gap <= 1.5 * steps.max() or abs(table.advance) > 2.0 * moves.max():
        return table

    def closed(values: Array | None) -> Array | None:
        return None if values is None else np.append(values, values[0])
    return replace(
        table, angle=np.append(table.angle, TURN),
        position=np.append(table.position, table.position[0]),
        velocity=closed(table.velocity), acceleration=closed(table.acceleration),
        lines=(*table.lines, 0), cycle=RETURN, notes=(
            *table.notes, 'the file ends one step before the cycle does: its first point was '
            'taken as the last one, too'))
