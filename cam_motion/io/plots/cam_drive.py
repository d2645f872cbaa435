# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A cam that loads its shaft: motion, pressure angle, curvature, inertias, generalised forces."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.load import Follower, Friction, Lever, Part, Spring, TranslatingMass
from cam_motion.io.cam_drive_config import CamDriveSettings
from cam_motion.io.plots.style import angle_axis, COLOURS, figure_text, GREY, new_figure, styled
from cam_motion.mechanism.cam_disc import CamDisc
from cam_motion.mechanism.cam_roller import TranslatingRoller
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE, TURN
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

_POINTS = 121  # per element of at most 60 deg: smooth at print resolution
_FLAT = 5.0  # radii above this many times the largest of the roller's path are not drawn
_MINOR_DEG, _APART_DEG = 30.0, 14.0  # angles numbered between the ends, unless too close to one
_NAMES: tuple[tuple[type, str], ...] = (
    (TranslatingMass, 'weight'), (Spring, 'spring'), (Friction, 'friction'),
    (Lever, 'moment of the lever'))


def turn_of(drive: CamDrive) -> tuple[Array, Follower]:
    """
    Spread points over one turn, with both sides of every step among them.

    Parameters
    ----------
    drive : CamDrive
        The drive.

    Returns
    -------
    tuple[ndarray, Follower], shape (n,) each
        Shaft angles [deg] and the follower there; where elements meet, once for either side.

    """
    spread = [np.linspace(e.start, e.end, _POINTS) for e in drive.elements]
    places = [drive.follower(e, q) for e, q in zip(drive.elements, spread)]
    return np.concatenate(spread) / DEGREE, Follower(*map(np.concatenate, zip(*places)))


def cam_figure(settings: CamDriveSettings) -> Figure:
    """
    Draw the motion of the follower, the pressure angle and the radius of curvature of the cam.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.

    Returns
    -------
    Figure
        Five panels over the shaft angle: s, s′, s″, pressure angle, radius of the contour.

    """
    cam = CamDisc(settings.drive.profile,
                  TranslatingRoller(settings.base_radius, settings.roller_radius))
    angles, at = turn_of(settings.drive)
    with styled():
        figure = new_figure(8.4)
        rows = figure.subplots(5, 1)
        for row, values, label in zip(rows, (at.s, at.s1, at.s2), (
                's [m]', 's′ [m/rad]', 's″ [m/rad²]')):
            row.plot(angles, values, color=COLOURS[0])
            row.set_ylabel(label)
        rows[0].set_title(f'{settings.name}: motion of {settings.axis}, pressure angle, '
                          'curvature of the cam')
        _draw_pressure(rows[3], cam, angles, at)
        _draw_radius(rows[4], cam, angles, at, settings.roller_radius)
        for row in rows:
            if row in rows[:3]:
                row.margins(y=0.14)
            finish_angle_axis(row, settings.drive, last=row is rows[-1])
        figure.align_ylabels(rows)
    return figure


def finish_angle_axis(row: Axes, drive: CamDrive, last: bool) -> None:
    """
    Give a panel its axis of one turn, ticks where segments and moments end, and a zero line.

    Parameters
    ----------
    row : Axes
        The panel.
    drive : CamDrive
        The drive.
    last : bool
        Whether it is the lowest of its stack, which carries the numbers.

    """
    ends = {round(segment.end_deg, 9) for segment in drive.profile.segments}
    ends |= {round(edge % TURN / DEGREE, 9) for part in drive.parts for edge in part.edges()}
    ends |= {0.0, 360.0}
    angle_axis(row, sorted(ends - {0.0}), 'shaft angle φ [deg]' if last else None, numbered=last)
    between = [angle for angle in np.arange(0.0, 360.0, _MINOR_DEG)
               if min(abs(angle - end) for end in ends) >= _APART_DEG]
    row.set_xticks(between, [f'{angle:g}°' for angle in between], minor=True)
    row.tick_params(axis='x', which='minor', labelsize=8.5, labelcolor=GREY, labelbottom=last,
                    pad=3.5)
    row.grid(visible=True, axis='x', which='minor')
    row.grid(visible=True, axis='x', which='major', color='#B8B8B8')
    low, high = row.get_ylim()
    if low <= 0.0 <= high:
        row.axhline(0.0, color='#444444', linewidth=0.8, zorder=1)


def note(row: Axes, at: tuple[float, float], text: str, shift: tuple[float, float] = (6.0, 0.0),
         colour: str = 'black') -> None:
    """
    Mark a point and write beside it.

    Parameters
    ----------
    row : Axes
        The panel.
    at : tuple[float, float]
        The point.
    text : str
        What is written.
    shift : tuple[float, float]
        Where, from the point on [pt]; its signs decide on which side the text stands.
    colour : str
        Colour of both.

    """
    row.plot([at[0]], [at[1]], 'o', color=colour, markersize=4.5, clip_on=False, zorder=5)
    across = 'center' if shift[0] == 0.0 else 'left' if shift[0] > 0.0 else 'right'
    up = 'center' if shift[1] == 0.0 else 'bottom' if shift[1] > 0.0 else 'top'
    row.annotate(text, at, xytext=shift, textcoords='offset points', ha=across, va=up,
                 color=colour, fontsize=8.5, zorder=6,
                 bbox={'boxstyle': 'square,pad=0.1', 'color': 'white', 'alpha': 0.8})


def _draw_pressure(row: Axes, cam: CamDisc, angles: Array, at: Follower) -> None:
    row.plot(angles, cam.pressure_angle(at.q) / DEGREE, color=COLOURS[0])
    greatest = cam.max_pressure_angle
    note(row, (greatest.at / DEGREE, greatest.value / DEGREE),
         f'{figure_text(greatest.value / DEGREE)}° at {figure_text(greatest.at / DEGREE)}°',
         (_sideways(greatest.at), 5.0 if greatest.value > 0.0 else -5.0))
    row.set_ylim(*_roomy(cam.pressure_angle(at.q) / DEGREE))
    row.set_ylabel('pressure\nangle α [deg]')


def _draw_radius(row: Axes, cam: CamDisc, angles: Array, at: Follower, roller: float) -> None:
    radius = cam.contour_radius(at.q)
    cap = _FLAT * (cam.base_radius + roller + float(np.max(at.s)))
    row.plot(angles, np.where(np.abs(radius) <= cap, radius, np.nan), color=COLOURS[0])
    least = cam.least_contour_radius
    note(row, (least.at / DEGREE, least.value),
         f'least {figure_text(least.value)} m' + (', undercut' if cam.undercuts else ''),
         (_sideways(least.at), 6.0), COLOURS[1] if cam.undercuts else 'black')
    shown = np.clip(radius, -cap, cap)
    low = min(0.0, float(np.min(shown)))
    high = max(float(np.max(shown)), roller)
    row.set_ylim(low - 0.04 * (high - low), high + 0.12 * (high - low))
    if roller > 0.0:
        row.axhline(roller, color=GREY, linewidth=1.1, linestyle=(0, (5, 3)))
        row.text(358.0, roller, f'radius of the roller {figure_text(roller)} m', ha='right',
                 va='bottom', color=GREY, fontsize=8.5)
    row.set_ylabel('radius of the\ncontour ρ [m]')


def _sideways(at: float) -> float:
    """Give the shift of a note across that keeps it within a turn."""
    return 4.0 if at < 0.6 * TURN else -4.0


def _roomy(values: Array) -> tuple[float, float]:
    """Give limits of a scale that leave room for a note above and below."""
    low, high = float(np.min(values)), float(np.max(values))
    return low - 0.14 * (high - low), high + 0.24 * (high - low)


def load_figure(settings: CamDriveSettings) -> Figure:
    """
    Draw the generalised inertia, centripetal inertia and generalised forces of the load.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive; its motor, gearbox and flywheel are left out.

    Returns
    -------
    Figure
        Three panels over the shaft angle; forces by part, friction at the nominal speed.

    """
    drive = settings.drive
    angles, at = turn_of(drive)
    terms = [part.terms(at) for part in drive.parts]
    zero = np.zeros_like(angles)
    with styled():
        figure = new_figure(7.4)
        rows = figure.subplots(3, 1, height_ratios=(2, 2, 3.2))
        rows[0].plot(angles, sum((t.inertia for t in terms), zero), color=COLOURS[0])
        rows[0].set_ylabel('inertia J [kg m²]')
        rows[0].set_title(f'{settings.name}: load on the cam shaft, without motor, gearbox and '
                          'flywheel')
        rows[1].plot(angles, sum((t.centripetal for t in terms), zero), color=COLOURS[0])
        rows[1].set_ylabel('centripetal inertia\nC = ½ dJ/dφ [kg m²]')
        total, count = zero, 0
        for name, t in zip(part_names(drive.parts), terms):
            force = t.force + t.damping * drive.nominal_speed
            total = total + force
            if np.any(force):
                rows[2].plot(angles, force, color=COLOURS[count % 6], label=name)
                count += 1
        rows[2].plot(angles, total, color='black', linewidth=2.2, label='sum', zorder=2.5)
        rows[2].set_ylabel('generalised\nforces Q [N m]')
        rows[0].set_ylim(0.0, None)
        for row in rows:
            row.margins(y=0.13)
            finish_angle_axis(row, drive, last=row is rows[-1])
        low = int(np.argmin(total))
        note(rows[2], (angles[low], total[low]),
             f'{figure_text(total[low])} N m at {figure_text(angles[low])}°',
             (0.0, -6.0))
        rows[2].legend(loc='lower right', ncols=count + 1)
        figure.align_ylabels(rows)
    return figure


def part_names(parts: Sequence[Part]) -> list[str]:
    """
    Name the generalised forces of the parts of a load.

    Parameters
    ----------
    parts : Sequence[Part]
        The parts.

    Returns
    -------
    list[str]
        Names by kind; numbered where there are several of a kind.

    """
    kinds = [next((name for kind, name in _NAMES if isinstance(part, kind)), 'inertia')
             for part in parts]
    seen: Counter[str] = Counter()
    names = []
    for kind in kinds:
        seen[kind] += 1
        names.append(f'{kind} {seen[kind]}' if kinds.count(kind) > 1 else kind)
    return names
