# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""One cam: position and its derivatives over one turn, geometric and at the set speed."""

from __future__ import annotations

from cam_motion.io.plots.style import (
    angle_axis,
    COLOURS,
    exact_curve,
    figure_text,
    new_figure,
    styled,
)
from cam_motion.motion.diagram import Axis
from cam_motion.motion.piecewise import Peak
from cam_motion.motion.profile import CamProfile
from cam_motion.units import DEGREE, rate_text, RPM
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

_SYMBOLS = ('y', 'y′', 'y″', 'y‴')
_QUANTITIES = ('position', 'velocity', 'acceleration', 'jerk')
# Half the width [deg] and the height (as a share of the panel's) of a value written at a peak.
_TEXT_DEG = 15.0
_TEXT_HEIGHT = 0.15
_ROUNDING = 1e-9  # smaller peaks (as a share of the segment's largest) are none
_WORTH_WRITING = 0.02  # smaller peaks (as a share of the panel's largest) carry no value


def profile_figure(axis: Axis, omega: float) -> Figure:
    """
    Draw position, velocity, acceleration and jerk of an axis over one turn.

    Parameters
    ----------
    axis : Axis
        The axis.
    omega : float
        Shaft speed of the physical scale on the right [rad/s]; 0 leaves it out.

    Returns
    -------
    Figure
        Four stacked panels: per radian on the left, per second on the right. The peaks of each
        segment are marked with their physical values (geometric ones at speed 0).

    """
    with styled():
        figure = new_figure(8.0)
        rows = figure.subplots(4, 1)
        ends = [segment.end_deg for segment in axis.profile.segments]
        for order, row in enumerate(rows):
            _draw_order(row, axis, order, omega)
            last = order == 3
            angle_axis(row, ends, 'shaft angle φ [deg]' if last else None, numbered=last)
        speed = f', at {omega / RPM:g} cycles/min (right)' if omega else ''
        rows[0].set_title(f'{axis.name}: per radian of the shaft (left){speed}')
        figure.align_ylabels(rows)
    return figure


def _draw_order(row: Axes, axis: Axis, order: int, omega: float) -> None:
    profile = axis.profile
    angles, values = exact_curve(profile, order)
    row.plot(angles, values, color=COLOURS[0])
    row.axhline(0.0, color='#444444', linewidth=0.8, zorder=1)
    row.set_ylabel(f'{_SYMBOLS[order]} [{rate_text(axis.unit, order, "rad")}]')
    start = 0.0
    for segment in profile.segments:
        if not segment.is_dwell:
            row.axvspan(start, segment.end_deg, color=COLOURS[0], alpha=0.07, linewidth=0)
        start = segment.end_deg
    low, high = float(values.min()), float(values.max())
    if order == 0:
        row.margins(y=0.12)
        return
    factor = omega ** order or 1.0
    limit = axis.limits.of_order(order) if omega else None
    if limit is not None:
        level = limit / abs(factor)
        for sign in ([1.0] if low == 0.0 else [-1.0] if high == 0.0 else [1.0, -1.0]):
            row.axhline(sign * level, color=COLOURS[1], linewidth=1.1, linestyle=(0, (5, 3)))
            low, high = min(low, sign * level), max(high, sign * level)
        row.text(359.0, high, f'limit {limit:g} {rate_text(axis.unit, order)}', ha='right',
                 va='bottom', color=COLOURS[1], fontsize=8.0)
    room = (high - low) or 1.0
    row.set_ylim(low - (0.22 if low < 0.0 else 0.06) * room, high + 0.24 * room)
    unit = rate_text(axis.unit, order, 's' if omega else 'rad')
    _mark_peaks(row, profile, order, factor, unit)
    if order == 3:
        _mark_steps(row, profile)
    if omega:
        right = row.secondary_yaxis('right', functions=(
            lambda value: np.asarray(value) * factor, lambda value: np.asarray(value) / factor))
        right.set_ylabel(f'{_QUANTITIES[order]} [{unit}]')
        right.spines['right'].set_visible(True)


def _peaks(profile: CamProfile, order: int) -> list[Peak]:
    """Give the least and the greatest value of each moving segment, the largest first."""
    found = []
    for part in profile.parts:
        if part.peak(1).value:
            least, greatest = part.extremes(order)
            rounding = _ROUNDING * max(-least.value, greatest.value)
            found += [peak for peak, sense in ((least, -1.0), (greatest, 1.0))
                      if sense * peak.value > rounding]
    return sorted(found, key=lambda peak: -abs(peak.value))


def _mark_peaks(row: Axes, profile: CamProfile, order: int, factor: float, unit: str) -> None:
    """Mark peaks with their values, leaving out values that would cover a larger one's."""
    low, high = row.get_ylim()
    written: list[tuple[float, float]] = []
    for value, phi in _peaks(profile, order):
        at, above = phi / DEGREE, value > 0.0
        row.plot([at], [value], 'o', color=COLOURS[0], markersize=4.0, clip_on=False)
        place = min(max(at, _TEXT_DEG), 360.0 - _TEXT_DEG)
        covers = any(
            abs(place - x) < 2.0 * _TEXT_DEG and abs(value - y) < _TEXT_HEIGHT * (high - low)
            for x, y in written)
        if covers or abs(value) < _WORTH_WRITING * max(abs(low), abs(high)):
            continue
        written.append((place, value))
        row.annotate(
            f'{figure_text(value * factor)} {unit}', (place, value),
            xytext=(0, 4 if above else -4), textcoords='offset points', ha='center',
            va='bottom' if above else 'top', fontsize=8.0,
            bbox={'boxstyle': 'square,pad=0.1', 'color': 'white', 'alpha': 0.8})


def _mark_steps(row: Axes, profile: CamProfile) -> None:
    """Mark where the acceleration steps: the jerk is infinite there, which no line can show."""
    steps = profile.jumps(2)
    for jump in steps:
        above = jump.amount > 0.0
        row.plot([jump.at / DEGREE], [1.0 if above else 0.0], '^' if above else 'v',
                 color=COLOURS[1], clip_on=False, transform=row.get_xaxis_transform())
    if steps:
        row.text(359.0, 0.96, '▲▼ acceleration steps: infinite jerk', ha='right', va='top',
                 color=COLOURS[1], fontsize=8.0, transform=row.get_xaxis_transform())
