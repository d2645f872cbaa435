# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A cam table: its points, the curve made of them, and their second differences."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from cam_motion.io.plots.style import COLOURS, exact_curve, GREY, new_figure, styled
from cam_motion.io.tables.finding import Finding, NOTE
from cam_motion.io.tables.outliers import second_differences
from cam_motion.io.tables.repair import ImportedCam
from cam_motion.io.tables.table import CamTable
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE, rate_text
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

_FEW = 120  # points up to which each is worth a marker of its own
_MOST_NAMES = 6


def table_figure(table: CamTable, findings: Sequence[Finding], unit: str,
                 made: ImportedCam | None = None) -> Figure:
    """
    Draw a cam table.

    Parameters
    ----------
    table : CamTable
        The table.
    findings : Sequence[Finding]
        What is wrong with it: marked at its angle.
    unit : str
        Unit of its positions.
    made : ImportedCam | None
        The axis made of it, whose curve is drawn over the points.

    Returns
    -------
    Figure
        Position, distance of the curve from the points (where there is one), and second
        differences beside the acceleration of the curve.

    """
    with styled():
        figure = new_figure(7.5 if made else 5.5)
        rows = figure.subplots(3 if made else 2, 1, sharex=True)
        angles = table.angle / DEGREE
        size = 3.5 if len(angles) <= _FEW else 1.5
        _points(rows[0], angles, table.position, size, 'points of the table')
        rows[0].set_ylabel(f'position [{unit}]')
        if made:
            _draw_made(rows[0], rows[1], made, angles, unit, size)
        _draw_bends(rows[-1], table, made, unit, size)
        _mark(rows[0], table, findings)
        for row in rows:
            row.set_xlim(0.0, max(360.0, float(angles.max())))
            row.set_xticks(np.arange(0.0, 361.0, 45.0))
        rows[-1].set_xlabel('angle from the first point [deg]')
        rows[0].set_title(f'{PurePath(table.source).name}: {len(angles)} points')
        figure.align_ylabels(rows)
    return figure


def _points(row: Axes, angles: Array, values: Array, size: float, label: str) -> None:
    row.plot(angles, values, 'o', color=COLOURS[1], markersize=size, markeredgewidth=0.0,
             label=label, zorder=3.0)


def _draw_made(top: Axes, middle: Axes, made: ImportedCam, angles: Array, unit: str,
               size: float) -> None:
    offset = made.section.get('offset', 0.0)
    profile = made.axis.profile
    at, values = exact_curve(profile, 0)
    top.plot(at, values + offset, color=COLOURS[0], linewidth=1.2,
             label=f'spline through {made.points} points')
    top.legend(loc='upper right', markerscale=3.0)
    misses = profile.curve.evaluate(made.table.angle) + offset - made.table.position
    _points(middle, angles, misses, size, '')
    if made.tolerance is not None:
        for sign in (-1.0, 1.0):
            middle.axhline(sign * made.tolerance, color=GREY, linestyle=(0, (5, 3)),
                           linewidth=1.0)
        middle.text(359.0, made.tolerance, 'tolerance', ha='right', va='bottom', color=GREY,
                    fontsize=8.0)
        middle.margins(y=0.25)
    middle.set_ylabel(f'curve − point [{unit}]')


def _draw_bends(row: Axes, table: CamTable, made: ImportedCam | None, unit: str,
                size: float) -> None:
    if table.rises:
        bends = second_differences(table)
        _points(row, bends.angles / DEGREE, bends.values, size, 'second differences of the table')
    if made:
        at, values = exact_curve(made.axis.profile, 2)
        row.plot(at, values, color=COLOURS[0], linewidth=1.2, label='acceleration of the spline')
    row.axhline(0.0, color='#444444', linewidth=0.8, zorder=1)
    row.set_ylabel(f'y″ [{rate_text(unit, 2, "rad")}]')
    row.margins(y=0.3)
    if row.get_legend_handles_labels()[1]:
        row.legend(loc='upper right', markerscale=3.0, ncols=2)


def _mark(row: Axes, table: CamTable, findings: Sequence[Finding]) -> None:
    """Mark where something is wrong, and name the first few."""
    row.margins(y=0.18)
    named = 0
    for finding in findings:
        if not finding.line or finding.severity == NOTE:
            continue
        at = finding.angle_deg - table.start / DEGREE
        row.axvline(at, color=COLOURS[3], linewidth=0.9, alpha=0.8)
        if named < _MOST_NAMES:
            right = at > 270.0
            row.annotate(
                f'line {finding.line}: {finding.code.replace("_", " ")}', (at, 0.97 - 0.1 * named),
                xycoords=('data', 'axes fraction'), xytext=(-3 if right else 3, 0),
                textcoords='offset points', ha='right' if right else 'left', va='top',
                fontsize=8.0, color=COLOURS[3],
                bbox={'boxstyle': 'square,pad=0.1', 'color': 'white', 'alpha': 0.8})
        named += 1
