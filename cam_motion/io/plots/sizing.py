# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a sizing found: servo motors over their power, or flywheels and what they hold."""

from __future__ import annotations

from cam_motion.drive.sizing import Candidate
from cam_motion.io.plots.cam_drive import note
from cam_motion.io.plots.style import COLOURS, figure_text, GREY, new_figure, styled
from cam_motion.io.sizing import Options, SizedDrive
from matplotlib.axes import Axes
from matplotlib.figure import Figure

_FLOOR = -100.0  # margins below are drawn here [%]: by how much more does not matter any more
_ROOM = 1.35  # top of the picture, times the largest fluctuation of the chosen motor or the wanted


def sizing_figure(sized: SizedDrive, options: Options) -> Figure:
    """
    Draw the candidates for a drive.

    Parameters
    ----------
    sized : SizedDrive
        The drive.
    options : Options
        What was wanted.

    Returns
    -------
    Figure
        For a drive that follows an axis the least margin [%] over the rated power [kW]; for one
        that turns a cam shaft the fluctuation [%] over the flywheel [kg m²].

    """
    sizing = sized.sizing
    with styled():
        figure = new_figure(4.2)
        axes = figure.subplots()
        if sizing.method == 'inverse':
            _powers(axes, sized)
        else:
            _flywheels(axes, sized, options)
        total = len(sizing.ranked) + len(sizing.rejected)
        axes.set_title(f'{sized.name}: {len(sizing.ranked)} of {total} candidates keep every rule')
    return figure


def _label(one: Candidate) -> str:
    wheel = '' if one.flywheel is None else f', {figure_text(one.flywheel)} kg m²'
    return f'{one.motor}, ratio {figure_text(one.ratio)}{wheel}'


def _points(axes: Axes, points: list[tuple[float, float]], kept: bool, colour: str,
            label: str) -> None:
    if points:
        x, y = zip(*points)
        axes.plot(x, y, 'o', color=colour, label=label, markersize=5.0 if kept else 3.0,
                  markerfacecolor=colour if kept else 'none', markeredgewidth=0.6,
                  alpha=1.0 if kept else 0.45, zorder=3 if kept else 2)


def _powers(axes: Axes, sized: SizedDrive) -> None:
    sizing = sized.sizing
    for kept, some, colour, label in (
            (False, sizing.rejected, GREY, 'rejected'),
            (True, sizing.ranked, COLOURS[0], 'keeps every rule')):
        _points(axes, [(one.rated_power / 1e3, max(one.least_margin_pct, _FLOOR))
                       for one in some], kept, colour, label)
    axes.axhline(0.0, color=GREY, linewidth=0.9)
    axes.set_xscale('log')
    axes.set_xlabel('rated power of the motor [kW]')
    axes.set_ylabel('margin to the rule kept\nmost narrowly [%]')
    if sizing.ranked:
        best = sizing.ranked[0]
        note(axes, (best.rated_power / 1e3, best.least_margin_pct), 'best: ' + _label(best),
             (-6.0, 8.0), COLOURS[1])
    axes.xaxis.set_major_formatter('{x:g}')
    axes.text(0.01, _FLOOR, 'this and worse', color=GREY, fontsize=8.5, va='bottom',
              transform=axes.get_yaxis_transform())
    axes.legend(loc='center left')


def _flywheels(axes: Axes, sized: SizedDrive, options: Options) -> None:
    sizing, found = sized.sizing, sized.flywheel
    every = [one for one in (*sizing.ranked, *sizing.rejected)
             if 'fluctuation_pct' in one.figures]
    motors = list(dict.fromkeys(one.motor for one in every))
    for colour, motor in zip(COLOURS, motors):
        for kept in (False, True):
            points = [(one.flywheel or 0.0, one.figures['fluctuation_pct']) for one in every
                      if one.motor == motor and kept is not bool(one.broken)]
            _points(axes, points, kept, colour, motor if kept else f'{motor}, rejected')
    wanted = options.wishes.fluctuation_pct
    axes.axhline(wanted, color=GREY, linewidth=0.9, linestyle=(0, (5, 3)))
    axes.text(1.0, wanted, f'wanted: {figure_text(wanted)} %', color=GREY, fontsize=8.5,
              va='bottom', ha='right', transform=axes.get_yaxis_transform())
    line = sorted((one.flywheel or 0.0, one.figures['fluctuation_pct']) for one in every
                  if (one.motor, one.gearbox, one.ratio) == sized.flywheel_for)
    if len(line) > 1:
        axes.plot(*zip(*line), color=GREY, linewidth=1.0, zorder=1)
    if found is not None and found.flywheel is not None and found.fluctuation_pct is not None:
        motor, _, ratio = sized.flywheel_for or ('', '', 0.0)
        note(axes, (found.flywheel, found.fluctuation_pct),
             f'smallest: {figure_text(found.flywheel)} kg m²\n{motor}, ratio {figure_text(ratio)}',
             (8.0, 10.0))
    # far beyond the chosen motor and what is wanted nothing is worth its room
    shown = line or [(one.flywheel or 0.0, one.figures['fluctuation_pct']) for one in every]
    highest = max((y for _, y in shown), default=wanted)
    axes.set_ylim(0.0, _ROOM * max(wanted, highest))
    tried = [one.flywheel or 0.0 for one in every]
    found_at = 0.0 if found is None or found.flywheel is None else found.flywheel
    axes.set_xlim(0.0, 1.05 * max(*tried, 1.4 * found_at, 1e-6))
    axes.set_xlabel('inertia of the flywheel on the motor shaft [kg m²]')
    axes.set_ylabel('speed fluctuation\nof the nominal speed [%]')
    if every:
        axes.legend(loc='upper right')
