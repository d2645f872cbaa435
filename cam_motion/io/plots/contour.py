# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A cam disc: its contour with the follower, pressure angle, curvature and contact force."""

from __future__ import annotations

from collections.abc import Callable
import math

from cam_motion.io.cam_disc_config import CamDiscSettings, Keyway
from cam_motion.io.plots.cam_drive import note
from cam_motion.io.plots.style import angle_axis, COLOURS, figure_text, GREY, new_figure, styled
from cam_motion.mechanism.cam_disc import CamDisc
from cam_motion.mechanism.cam_extremes import follower_in, split_turn
from cam_motion.mechanism.cam_follower import Contact, Points
from cam_motion.mechanism.cam_pose import follower_pose
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Peak
from cam_motion.units import DEGREE, MM, RPM, TURN
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
import numpy as np

_POINTS = 181  # per stretch: smooth at print resolution
_METAL, _ROLLER = '#DCE6EE', '#F6E3D3'
_FLAT = 6.0  # radii above this many times the largest of the contour are not drawn
_ARROW = 0.62  # radius of the arrow that shows the sense of rotation, by the base radius
_ROOM = 0.14  # of a scale, for notes above and below
_PIN = 0.05  # radius of a bearing, by the largest radius of the contour


def contour_figure(settings: CamDiscSettings, at: float = 0.0) -> Figure:
    """
    Draw a cam disc with its follower, and over the shaft angle what matters of their contact.

    Parameters
    ----------
    settings : CamDiscSettings
        The disc.
    at : float
        Shaft angle at which the follower is drawn [rad].

    Returns
    -------
    Figure
        The disc as it stands then; follower, pressure angle, curvature of the contour and, where
        something loads the follower, contact force.

    """
    disc, force = settings.disc, settings.force
    panels: list[Callable[[Axes, CamDiscSettings], None]] = [_draw_motion, _draw_curvature]
    if np.ptp([peak.value for peak in disc.pressure_angles]) > 0.0:
        panels.insert(1, _draw_pressure)
    if force is not None:
        panels.append(_draw_force)
    with styled():
        figure = new_figure(1.9 * len(panels) + 0.4)
        grid = figure.add_gridspec(len(panels), 2, width_ratios=(1.0, 1.05))
        _draw_disc(figure.add_subplot(grid[:, 0]), settings, at)
        rows = [figure.add_subplot(grid[k, 1]) for k in range(len(panels))]
        for row, draw in zip(rows, panels):
            draw(row, settings)
            last = row is rows[-1]
            ends = [segment.end_deg for segment in disc.profile.segments]
            angle_axis(row, ends, 'shaft angle φ [deg]' if last else None, numbered=last)
            low, high = row.get_ylim()
            if low < 0.0 < high:
                row.axhline(0.0, color='#444444', linewidth=0.8, zorder=1)
        figure.align_ylabels(rows)
    return figure


def _over_turn(disc: CamDisc, value: Callable[[Contact], Array]) -> tuple[Array, Array]:
    """Give shaft angles [deg] and values, at a joint from either side."""
    angles, values = [], []
    for element in split_turn(disc.profile):
        q = np.linspace(element.start, element.end, _POINTS)
        angles.append(q / DEGREE)
        values.append(value(disc.contact_at(follower_in(disc.profile, element, q))))
    return np.concatenate(angles), np.concatenate(values)


def _draw_disc(axes: Axes, settings: CamDiscSettings, at: float) -> None:
    disc = settings.disc
    q = np.concatenate([np.linspace(e.start, e.end, _POINTS) for e in split_turn(disc.profile)])

    def path(points: Points) -> tuple[Array, Array]:
        turned = disc.turned(points, at) / MM
        return turned.real, turned.imag

    contour = np.column_stack(path(disc.contour(q)))
    reach = disc.farthest / MM
    if settings.groove:
        outer = np.column_stack(path(disc.outer_flank(q)))
        axes.add_patch(Polygon(outer, facecolor='none', edgecolor='black', linewidth=1.6))
        reach = float(np.max(np.hypot(*outer.T)))
    axes.add_patch(Polygon(contour, facecolor=_METAL, edgecolor='black', linewidth=1.6))
    if not disc.follower.is_flat:
        axes.plot(*path(disc.pitch(q)), color=COLOURS[0], linewidth=1.0,
                  linestyle=(0, (8, 3, 2, 3)))
    axes.add_patch(Circle((0.0, 0.0), disc.base_radius / MM, facecolor='none', edgecolor=GREY,
                          linewidth=1.0, linestyle=(0, (5, 3))))
    if settings.bore_radius is not None:
        bore = _bore(settings.bore_radius, settings.keyway)
        axes.add_patch(Polygon(np.column_stack(path(bore)), facecolor='white',
                               edgecolor='black', linewidth=1.2))
    axes.plot([0.0], [0.0], '+', color='black', markersize=9.0, markeredgewidth=1.0)
    axes.plot(*path(np.array([0.0, disc.contour(0.0)])), color=GREY, linewidth=0.8)
    _draw_sense(axes, _ARROW * disc.base_radius / MM, disc.sense)
    _draw_follower(axes, disc, at, _PIN * reach)
    axes.set_aspect('equal')
    axes.margins(0.06)
    axes.autoscale_view()
    axes.grid(visible=False)
    axes.set_xlabel('x [mm]')
    axes.set_ylabel('y [mm]')
    axes.set_title(f'{settings.name} at {figure_text(at / DEGREE)}°')


def _bore(radius: float, key: Keyway | None) -> Points:
    """Give the outline of the bore with its keyway, on the disc [m]."""
    half = 0.0 if key is None else math.asin(0.5 * key.width / radius)
    angles = np.linspace(half, TURN - half, _POINTS)
    points: Points = radius * np.exp(1j * angles)
    if key is None:
        return points
    corners = radius + key.depth + 0.5j * key.width * np.array([-1.0, 1.0])
    turned: Points = np.append(points, corners) * np.exp(1j * key.angle)
    return turned


def _draw_sense(axes: Axes, radius: float, sense: int) -> None:
    """Draw an arrow around the shaft."""
    angles = np.linspace(0.15 * TURN, 0.35 * TURN, 60)[::sense]
    x, y = radius * np.cos(angles), radius * np.sin(angles)
    axes.plot(x[:-3], y[:-3], color=GREY, linewidth=1.2)
    axes.annotate('', (x[-1], y[-1]), (x[-8], y[-8]),
                  arrowprops={'arrowstyle': '-|>', 'color': GREY, 'linewidth': 1.2})


def _draw_follower(axes: Axes, disc: CamDisc, at: float, pin: float) -> None:
    pose, colour = follower_pose(disc, at), COLOURS[1]
    foot, centre, contact = (
        (z.real / MM, z.imag / MM) for z in (pose.foot, pose.centre, pose.contact))
    begin = centre
    if pose.face is not None:
        ends = np.array(pose.face) / MM
        axes.plot(ends.real, ends.imag, color=colour, linewidth=4.0, solid_capstyle='butt',
                  zorder=4)
        if pose.pivot is not None:
            begin = (float(ends[0].real), float(ends[0].imag))
    axes.plot(*zip(begin, foot), color=colour, linewidth=2.6, zorder=3.5,
              solid_capstyle='round')
    if pose.roller_radius:
        axes.add_patch(Circle(centre, pose.roller_radius / MM, facecolor=_ROLLER,
                              edgecolor=colour, linewidth=1.8, zorder=4))
        axes.plot(*centre, '+', color=colour, markersize=6.0, zorder=5)
    if pose.pivot is not None:
        axes.add_patch(Circle(foot, pin, facecolor='white', edgecolor=colour, linewidth=1.8,
                              zorder=5))
    axes.plot(*contact, 'o', color='black', markersize=3.5, zorder=6)


def _mark(row: Axes, peak: Peak, scale: float, unit: str, above: bool, colour: str = 'black',
          ) -> None:
    """Mark an extreme and write its value and angle beside it."""
    angle = peak.at / DEGREE
    across = 5.0 if angle < 235.0 else -5.0
    text = f'{figure_text(peak.value / scale)}{unit} at {angle:.4g}°'
    note(row, (angle, peak.value / scale), text, (across, 5.0 if above else -5.0), colour)


def _make_room(row: Axes, values: Array) -> None:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = (high - low or abs(high) or 1.0) * _ROOM
    row.set_ylim(low - 1.4 * room, high + 2.0 * room)


def _draw_motion(row: Axes, settings: CamDiscSettings) -> None:
    disc = settings.disc
    scale, unit = (DEGREE, 'deg') if disc.follower.swings else (MM, 'mm')
    angles = np.linspace(0.0, 360.0, 4 * _POINTS)
    values = disc.profile.curve(angles * DEGREE) / scale
    row.plot(angles, values, color=COLOURS[0])
    _make_room(row, values)
    row.set_ylabel(f'{"angle" if disc.follower.swings else "travel"}\n[{unit}]')
    row.set_title(f'{settings.axis}, {settings.kind.replace("_", " ")}')


def _draw_pressure(row: Axes, settings: CamDiscSettings) -> None:
    disc = settings.disc
    angles, values = _over_turn(disc, lambda found: found.pressure / DEGREE)
    row.plot(angles, values, color=COLOURS[0])
    back, out = settings.limits.return_pressure_angle, settings.limits.pressure_angle
    for limit in (out, None if back is None else -back):
        if limit is not None:
            row.axhline(limit / DEGREE, color=GREY, linewidth=1.1, linestyle=(0, (5, 3)))
    _make_room(row, np.append(values, [0.0 if limit is None else sign * limit / DEGREE
                                       for sign, limit in ((1.0, out), (-1.0, back))]))
    for peak, above in zip(disc.pressure_angles, (False, True)):
        _mark(row, peak, DEGREE, '°', above)
    row.set_ylabel('pressure\nangle α [deg]')


def _draw_curvature(row: Axes, settings: CamDiscSettings) -> None:
    disc = settings.disc
    roller = disc.follower.roller_radius
    angles, values = _over_turn(
        disc, lambda found: MM * found.bend / (found.span - roller * found.bend))
    row.plot(angles, values, color=COLOURS[0])
    _make_room(row, np.append(values, 0.0))
    least = disc.least_contour_radius
    if least.value > 0.0:
        angle = least.at / DEGREE
        note(row, (angle, MM / least.value),
             f'radius {figure_text(least.value / MM)} mm at {angle:.4g}°',
             (5.0 if angle < 200.0 else -5.0, 5.0))
    row.set_ylabel('curvature of the\ncontour [1/mm]')


def _draw_force(row: Axes, settings: CamDiscSettings) -> None:
    force, orbit = settings.force, settings.orbit
    if force is None:
        return
    angles, values = force.at_speed(settings.speed)
    row.plot(angles / DEGREE, values, color=COLOURS[0],
             label=f'steady {figure_text(settings.speed / RPM)} rpm')
    shown = [values]
    if orbit is not None:
        q = [stretch.dense() for stretch in orbit.stretches]
        on_orbit = np.concatenate([
            force.on_stretch(stretch, at) for stretch, at in zip(orbit.stretches, q)])
        row.plot(np.concatenate(q) / DEGREE, on_orbit, color=COLOURS[1], linewidth=1.3,
                 label='periodic motion')
        shown.append(on_orbit)
        row.legend(loc='upper right')
    _make_room(row, np.append(np.concatenate(shown), 0.0))
    least = force.extremes(settings.speed)[0]
    _mark(row, least, 1.0, ' N', above=False,
          colour=COLOURS[0] if least.value > 0.0 or settings.groove else 'red')
    row.set_ylabel('contact force\n[N]')
