# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A recorded run: setpoints beside the exact curves, torque over speed, the shaft's speed."""

from __future__ import annotations

from collections.abc import Sequence

from cam_motion.io.comparison import AxisReport, QUANTITIES, TOLERANCE, TOLERANCE_TEXT
from cam_motion.io.plots.motor import recorded_motor_figure
from cam_motion.io.plots.style import COLOURS, exact_curve, GREY, new_figure, styled
from cam_motion.io.plots.torque import torque_curve, torque_figure
from cam_motion.io.report import Report
from cam_motion.io.turn import repeats
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE, rate_text, RPM, TURN
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray

_MOST_POINTS = 3000  # dots per panel; more would only cover each other
_EXACT = 1e-18  # where a deviation of zero is drawn on the logarithmic scale


def recorded_figure(report: Report) -> Figure:
    """
    Draw recorded setpoints over the exact curves, and how far they are apart.

    Parameters
    ----------
    report : Report
        The report.

    Returns
    -------
    Figure
        One row per axis with position, velocity and acceleration over the shaft angle; the curves
        are exact, the dots recorded. Below, the deviations as shares of the axis' own peaks on a
        logarithmic scale.

    """
    with styled():
        count = len(report.axes)
        figure = new_figure(1.6 + 1.7 * count)
        panels = figure.subplots(count + 1, 3, sharex=True, squeeze=False)
        for place, (name, axis) in enumerate(report.axes.items()):
            for order in range(3):
                _draw_quantity(panels[place, order], axis, order, COLOURS[place % len(COLOURS)])
            panels[place, 0].set_ylabel(f'{name}\ny [{axis.axis.unit}]')
        for order, panel in enumerate(panels[-1]):
            _draw_deviations(panel, list(report.axes.values()), order)
        for order, panel in enumerate(panels[0]):
            panel.set_title(QUANTITIES[order], fontsize=9.5)
        figure.suptitle('Recorded setpoints (dots) over the exact curves (lines)', x=0.01,
                        ha='left', fontweight='bold', fontsize=11.0)
        figure.align_ylabels(panels[:, 0])
    return figure


def _draw_quantity(panel: Axes, report: AxisReport, order: int, colour: str) -> None:
    profile, compared = report.axis.profile, report.comparison
    steady = _steady(compared.omega, compared.alpha) if order else np.ones(
        len(compared.phi), dtype=bool)
    values = compared.recorded[order]
    if order == 0 and profile.advance:
        values = values - np.floor(compared.phi / TURN) * profile.advance
    top = float(np.max(np.abs(compared.omega), initial=0.0))
    angles, curve = exact_curve(profile, order)
    panel.plot(angles, curve * top ** order, color=colour, linewidth=1.0)
    chosen = np.flatnonzero(steady)
    chosen = chosen[::1 + len(chosen) // _MOST_POINTS]
    panel.plot(_degrees(compared.phi[chosen]), values[chosen], '.', color=colour, markersize=3.2,
               markeredgewidth=0.0, alpha=0.7)
    if order:
        symbol = ('', 'ẏ', 'ÿ')[order]
        panel.set_ylabel(f'{symbol} [{rate_text(report.axis.unit, order)}]')
        limit = report.axis.limits.of_order(order)
        reached = float(np.max(np.abs(curve))) * top ** order
        if limit is not None and limit < 1.6 * reached:
            for sign in (1.0, -1.0):
                if sign * (curve.max() if sign > 0 else curve.min()) > 0.0:
                    panel.axhline(sign * limit, color=GREY, linewidth=0.9, linestyle=(0, (5, 3)))
    panel.margins(y=0.12)


def _steady(omega: Array, alpha: Array) -> NDArray[np.bool_]:
    """Tell the setpoints at the top speed; only they lie on the curve drawn for it."""
    top = float(np.max(np.abs(omega), initial=0.0))
    return np.asarray((np.abs(omega) >= top * (1.0 - 1e-9)) & (alpha == 0.0))


def _degrees(phi: Array) -> Array:
    return np.asarray(phi % TURN / DEGREE)


def _draw_deviations(panel: Axes, axes: Sequence[AxisReport], order: int) -> None:
    panel.set_yscale('log')
    worst = TOLERANCE
    for place, report in enumerate(axes):
        phi, shares = report.comparison.phi, report.comparison.deviations[order]
        finite = np.flatnonzero(np.isfinite(shares))
        # the largest ones must be among the dots
        chosen = finite[np.argsort(-shares[finite], kind='stable')][:_MOST_POINTS]
        worst = max(worst, float(np.max(shares[finite], initial=0.0)))
        # the later ones smaller, so that none hides another
        panel.plot(_degrees(phi[chosen]), np.maximum(shares[chosen], _EXACT), '.',
                   markersize=2.0 + 7.0 / (1 + place), markeredgewidth=0.0,
                   color=COLOURS[place % len(COLOURS)])
    panel.axhline(TOLERANCE, color=GREY, linewidth=0.9, linestyle=(0, (5, 3)))
    panel.set_xlim(0.0, 360.0)
    panel.set_xticks(range(0, 361, 90))
    panel.set_ylim(_EXACT / 10.0, worst * 100.0)
    panel.set_xlabel('shaft angle φ [deg]')
    if order == 0:
        panel.set_ylabel('deviation / peak\n[−]')
        panel.text(358.0, TOLERANCE, f'tolerance {TOLERANCE_TEXT}', ha='right', va='bottom',
                   color=GREY, fontsize=8.0)
    panel.set_yticks([_EXACT, 1e-15, 1e-12, TOLERANCE], ['exact', '1e−15', '1e−12', '1e−9'])
    panel.minorticks_off()


def recorded_torque_figure(report: Report, name: str) -> Figure:
    """
    Draw the recorded torque over speed of a motor, with the exact cycle at the top speed.

    Parameters
    ----------
    report : Report
        The report.
    name : str
        Name of the drive.

    Returns
    -------
    Figure
        Motor speed [rpm] across, motor torque [N m] up.

    """
    machine = report.recording.machine
    if name in machine.cam_drives:
        states = report.drives[name]
        return recorded_motor_figure(
            machine.cam_drives[name], states.motor_speed, states.motor_torque)
    settings = machine.drives[name]
    axis = machine.diagram.axes[settings.axis]
    drive = report.drives[name]
    curves = [torque_curve(settings, axis, report.top_speed)] if repeats(axis) else []
    return torque_figure(
        name, curves, (drive.motor_speed, drive.motor_torque), settings.motor)


def shaft_figure(report: Report) -> Figure:
    """
    Draw the recorded speed and acceleration of the master shaft over time.

    Parameters
    ----------
    report : Report
        The report.

    Returns
    -------
    Figure
        Two panels over time [s]; gaps in the grid of ticks are marked.

    """
    with styled():
        figure = new_figure(4.6)
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        shaft = report.recording.shaft
        for run in np.unique(shaft.run):
            part = shaft.chosen(shaft.run == run)
            seconds = part.time_ns * 1e-9
            upper.plot(seconds, part.velocity / RPM, color=COLOURS[0])
            lower.plot(seconds, part.acceleration, color=COLOURS[0])
        for at, _ in report.ticks.gaps:
            upper.axvline(at, color=COLOURS[1], linewidth=0.9)
        missed = report.ticks.missed
        upper.set_title(f'Master shaft: {report.ticks.recorded} ticks recorded, '
                        f'{missed} missed', pad=10)
        upper.set_ylabel('speed ω [cycles/min]')
        upper.margins(y=0.1)
        lower.set_ylabel('α [rad/s²]')
        lower.margins(y=0.15)
        lower.set_xlabel('time on the machine [s]')
        lower.set_xlim(float(shaft.time_ns.min()) * 1e-9, float(shaft.time_ns.max()) * 1e-9)
        figure.align_ylabels((upper, lower))
    return figure
