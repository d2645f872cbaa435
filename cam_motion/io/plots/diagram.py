# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The timing diagram: all axes of a machine over one turn of the shaft."""

from __future__ import annotations

from cam_motion.io.plots.style import (
    angle_axis,
    COLOURS,
    exact_curve,
    figure_text,
    GREY,
    new_figure,
    styled,
)
from cam_motion.motion.diagram import Axis, TimingDiagram
from matplotlib.axes import Axes
from matplotlib.figure import Figure

# Segments narrower than this have no room for their name [deg].
_NAME_DEG = 16.0


def timing_diagram(diagram: TimingDiagram) -> Figure:
    """
    Draw the positions of all axes over one turn, each on its own scale.

    Parameters
    ----------
    diagram : TimingDiagram
        The axes.

    Returns
    -------
    Figure
        One row per axis; segments that move are shaded and named, dwells are not.

    """
    with styled():
        count = max(1, len(diagram.axes))
        figure = new_figure(0.8 + 1.45 * count)
        rows = figure.subplots(count, 1, squeeze=False)[:, 0]
        for place, (row, axis) in enumerate(zip(rows, diagram.axes.values())):
            last = place == len(diagram.axes) - 1
            _draw_axis(row, axis, COLOURS[place % len(COLOURS)])
            ends = [segment.end_deg for segment in axis.profile.segments]
            angle_axis(row, ends, 'shaft angle φ [deg]' if last else None)
        rows[0].set_title('Timing diagram', pad=12)
        figure.align_ylabels(rows)
    return figure


def _draw_axis(row: Axes, axis: Axis, colour: str) -> None:
    angles, positions = exact_curve(axis.profile, 0)
    row.plot(angles, positions, color=colour)
    low, high = float(positions.min()), float(positions.max())
    room = (high - low) or 1.0
    row.set_ylim(low - 0.12 * room, high + 0.34 * room)
    levels = _levels(axis, low, high)
    row.set_yticks(levels, [figure_text(level) for level in levels])
    row.set_ylabel(f'{axis.name}\ny [{axis.unit}]')
    row.grid(False)
    start = 0.0
    for segment in axis.profile.segments:
        if not segment.is_dwell:
            row.axvspan(start, segment.end_deg, color=colour, alpha=0.12, linewidth=0)
            if segment.end_deg - start >= _NAME_DEG:
                row.text(0.5 * (start + segment.end_deg), 0.97, segment.name, ha='center',
                         va='top', transform=row.get_xaxis_transform())
        row.axvline(segment.end_deg, color=colour, alpha=0.35, linewidth=0.8)
        start = segment.end_deg
    if axis.profile.advance:
        # away from the names of the segments and from the curve, which has risen by then
        above = axis.profile.advance < 0.0
        row.text(0.995, 0.82 if above else 0.06,
                 f'advances {axis.profile.advance:g} {axis.unit} per cycle', ha='right',
                 va='top' if above else 'bottom', color=GREY, transform=row.transAxes)


def _levels(axis: Axis, low: float, high: float) -> list[float]:
    """Give the positions at which segments end, unless they stand too close to be told apart."""
    levels = [0.0]
    for segment in axis.profile.segments:
        levels.append(levels[-1] + segment.lift)
    apart: list[float] = []
    for level in sorted(levels):
        if not apart or level - apart[-1] > 0.15 * (high - low):
            apart.append(round(level, 12))
    return apart
