# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""From a cam table to an axis of the machine file, repaired within a stated deviation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
import math
from typing import Any

from cam_motion.errors import ConfigurationError, DomainError, Problem
from cam_motion.io.axis import build_axis, CoupledAxis
from cam_motion.io.tables.lint import closing_hint, errors_in
from cam_motion.io.tables.table import CamTable, CUBIC, QUINTIC, RETURN
from cam_motion.motion.continuity import curve_joints
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Peak, Piecewise
from cam_motion.motion.spline import smooth
from cam_motion.units import DEGREE, TURN
import numpy as np

SEGMENT = 'curve'
"""Name of the one segment of an axis made of a table."""

_DIGITS = 12
_SLACK = 1e-9  # rounding of a deviation (relative)


@dataclass(frozen=True)
class CurveFigures:
    """
    What a curve does over one cycle.

    Attributes
    ----------
    peaks : tuple[Peak, ...]
        Largest velocity, acceleration and jerk per radian; infinite where the derivative below
        steps.
    continuity : int
        k of its class Ck, -1 for a position that jumps.

    """

    peaks: tuple[Peak, ...]
    continuity: int


@dataclass(frozen=True)
class ImportedCam:
    """
    An axis made of a table.

    Attributes
    ----------
    table : CamTable
        The table.
    section : Mapping[str, Any]
        Parameters of the axis, as a machine file holds them.
    axis : CoupledAxis
        The axis.
    deviation : float
        Largest distance of its curve from the points of the table.
    deviation_at : int
        The point of the table where that is.
    tolerance : float | None
        What was allowed; None where the curve goes through the points.
    before, after : CurveFigures
        What the table does as its controller interpolates it, and what the axis does.

    """

    table: CamTable
    section: Mapping[str, Any]
    axis: CoupledAxis
    deviation: float
    deviation_at: int
    tolerance: float | None
    before: CurveFigures
    after: CurveFigures

    @property
    def points(self) -> int:
        """Count the points that carry the curve."""
        return len(self.section[SEGMENT]['positions'])


def figures_of(curve: Piecewise, advance: float) -> CurveFigures:
    """
    Find the peaks and the continuity of one cycle, its seam included.

    Parameters
    ----------
    curve : Piecewise
        One cycle.
    advance : float
        What it gains in each.

    Returns
    -------
    CurveFigures
        The figures.

    """
    worst = min(curve_joints(curve, advance),
                key=lambda joint: (joint.continuity, -abs(joint.step)))
    peaks = []
    for order in (1, 2, 3):
        steps = worst.order is not None and worst.order < order
        peaks.append(Peak(math.copysign(math.inf, worst.step), worst.at) if steps else
                     curve.peak(order))
    return CurveFigures(tuple(peaks), worst.continuity)


def import_table(table: CamTable, name: str, unit: str = 'm', tolerance: float | None = None,
                 degree: int = 5) -> ImportedCam:
    """
    Make an axis of a table.

    Parameters
    ----------
    table : CamTable
        The table; it must cover one cycle.
    name : str
        Name of the axis.
    unit : str
        Unit of its positions.
    tolerance : float | None
        How far the curve may be from the points, to be smooth; None: it goes through them.
    degree : int
        3 or 5, where the table has no velocities of its own.

    Returns
    -------
    ImportedCam
        The axis and what became of the table.

    Raises
    ------
    ConfigurationError
        When no cam can be made of it, with lines and figures.

    """
    problems = [Problem(
        f'{table.source}, line {each.line}', each.value, each.text, each.hint)
        for each in errors_in(table, unit)]
    gap = table.advance if table.cycle == RETURN else 0.0
    if abs(gap) <= 1e-9 * table.stroke:
        gap = 0.0
    allowed = tolerance or 0.0
    if gap and 0.5 * abs(gap) >= allowed:
        problems.append(Problem(
            f'{table.source}, line {table.lines[-1]}', table.advance,
            'the last position must be the first of a cycle that returns',
            closing_hint(table)))
    if problems:
        raise ConfigurationError(problems)
    section = _section(table, unit, tolerance, degree, gap)
    try:
        axis = build_axis(name, dict(_flat(section)))
    except ConfigurationError as error:
        raise ConfigurationError(problem.below(table.source)
                                 for problem in error.problems) from error
    own = axis.profile.curve.evaluate(table.angle) + section.get('offset', 0.0)
    misses = np.abs(own - table.position)
    place = int(np.argmax(misses))
    if tolerance is not None and misses[place] > tolerance * (1.0 + _SLACK):
        raise ConfigurationError([Problem(
            '--repair', tolerance, 'no curve was found that close to the points: at line '
            f'{table.lines[place]} it is {misses[place]:.3g} {unit} off',
            f'state {1.1 * misses[place]:.2g} or more, or leave it out: the curve then goes '
            'through every point')])
    return ImportedCam(
        table, section, axis, float(misses[place]), place, tolerance,
        figures_of(table.curve(), table.advance if table.cycle != RETURN else 0.0),
        figures_of(axis.profile.curve, axis.profile.advance))


def _section(table: CamTable, unit: str, tolerance: float | None, degree: int,
             gap: float) -> dict[str, Any]:
    """Give the parameters of the axis."""
    angle, position = table.angle, table.position.copy()
    if gap:
        # both ends meet half-way
        position[0], position[-1] = (0.5 * (position[0] + position[-1]),) * 2
    elif table.cycle == RETURN:
        position[-1] = position[0]
    columns: dict[str, Array] = {}
    if tolerance is not None:
        try:
            found = smooth(angle, position, tolerance - 0.5 * abs(gap), degree, periodic=True)
        except DomainError as error:
            raise ConfigurationError([Problem(table.source, None, str(error))]) from error
        angle, position = found.x, found.y
    elif table.interpolation == QUINTIC and table.velocity is not None and (
            table.acceleration is not None):
        columns = {'velocities': table.velocity, 'accelerations': table.acceleration}
    elif table.interpolation == CUBIC and table.velocity is not None:
        columns = {'velocities': table.velocity}
    spline: dict[str, Any] = {'law': 'spline', 'end_deg': 360.0}
    degrees = _rounded(angle / DEGREE)
    degrees[0], degrees[-1] = 0.0, 360.0
    if not np.allclose(degrees, np.linspace(0.0, 360.0, len(degrees)), rtol=0.0, atol=1e-9):
        spline['angles_deg'] = degrees
    spline['positions'] = _rounded(position)
    if table.cycle == RETURN:
        spline['positions'][-1] = spline['positions'][0]
    spline |= {key: _rounded(values) for key, values in columns.items()}
    if degree != 5 and not columns:
        spline['degree'] = float(degree)
    section: dict[str, Any] = {'unit': unit, 'cycle': table.cycle, 'segments': [SEGMENT]}
    if start := math.remainder(table.start, TURN):
        section['phase_deg'] = _rounded([-start / DEGREE])[0]
    if spline['positions'][0]:
        section['offset'] = spline['positions'][0]
    return {**section, SEGMENT: spline}


def _rounded(values: Iterable[float]) -> list[float]:
    return [float(f'{value:.{_DIGITS}g}') + 0.0 for value in values]


def _flat(section: Mapping[str, Any], above: str = '') -> Iterable[tuple[str, Any]]:
    for key, value in section.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f'{above}{key}.')
        else:
            yield f'{above}{key}', value
