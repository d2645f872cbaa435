# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A cam drive at work: its periodic motion and its start-up."""

from __future__ import annotations

import math

from cam_motion.drive.orbit import Orbit
from cam_motion.drive.start_up import StartUp
from cam_motion.io.cam_drive_config import CamDriveSettings
from cam_motion.io.plots.cam_drive import finish_angle_axis, note
from cam_motion.io.plots.style import COLOURS, figure_text, GREY, new_figure, styled
from cam_motion.io.simulation import start_up_figures
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE, RPM
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

_DASHES = (0, (5, 3))
_BAND = '#CFE5F3'  # the periodic motion behind the lines


def revolution(orbit: Orbit) -> tuple[Array, Array, dict[str, Array]]:
    """
    List speed and torques of a revolution, with both sides of every step.

    Parameters
    ----------
    orbit : Orbit
        The periodic motion.

    Returns
    -------
    tuple[ndarray, ndarray, dict[str, ndarray]], shape (n,) each
        Shaft angles [deg], speeds of the cam shaft [rad/s], and the torques at the cam shaft
        [N m]: motor and load, which together make up J dω/dt and C ω².

    """
    columns = []
    for stretch in orbit.stretches:
        q = stretch.dense(121)
        omega, alpha = stretch.motion(q)
        terms = stretch.drive.terms(stretch.drive.follower(stretch.element, q))
        columns.append((q / DEGREE, omega, stretch.drive.motor_torque(omega),
                        terms.force + terms.damping * omega, terms.inertia * alpha,
                        terms.centripetal * omega ** 2))
    angles, omega, *torques = (np.concatenate(column) for column in zip(*columns))
    return angles, omega, dict(zip(('motor', 'load Q', 'J dω/dt', 'C ω²'), torques))


def orbit_figure(settings: CamDriveSettings, orbit: Orbit) -> Figure:
    """
    Draw one revolution of the periodic motion.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.
    orbit : Orbit
        Its periodic motion.

    Returns
    -------
    Figure
        Speed of the cam shaft [rpm], torques at it [N m] and contact force [N] over the angle.

    """
    drive = settings.drive
    angles, omega, torques = revolution(orbit)
    with styled():
        figure = new_figure(7.6)
        rows = figure.subplots(3, 1, height_ratios=(2, 3, 2))
        rows[0].plot(angles, omega / RPM, color=COLOURS[0])
        rows[0].axhline(drive.nominal_speed / RPM, color=GREY, linewidth=1.1, linestyle=_DASHES)
        rows[0].text(358.0, drive.nominal_speed / RPM, f'nominal {rpm_text(drive.nominal_speed)}',
                     ha='right', va='bottom', color=GREY, fontsize=8.5)
        low, high = int(np.argmin(omega)), int(np.argmax(omega))
        for at, speed, up in ((low, orbit.speeds[0], 7.0), (high, orbit.speeds[1], -7.0)):
            across = 0.0 if 24.0 < angles[at] < 336.0 else math.copysign(5.0, 180.0 - angles[at])
            note(rows[0], (angles[at], omega[at] / RPM), rpm_text(speed), (across, up))
        share = 100.0 * (orbit.speeds[1] - orbit.speeds[0]) / drive.nominal_speed
        rows[0].set_title(f'{settings.name}: periodic motion, fluctuation {share:.2f} %, '
                          f'period {orbit.period:.4f} s')
        rows[0].set_ylabel('speed n [rpm]')
        for colour, (name, values) in zip(COLOURS, torques.items()):
            rows[1].plot(angles, values, color=colour, label=name,
                         linewidth=1.8 if name in ('motor', 'load Q') else 1.2)
        rows[1].set_ylabel('torques at the\ncam shaft [N m]')
        force = np.concatenate([
            stretch.contact_force(stretch.dense(121), settings.base)
            for stretch in orbit.stretches])
        _draw_contact(rows[2], angles, force, orbit.least_contact(settings.base).value)
        for row in rows:
            row.margins(y=0.12)
            finish_angle_axis(row, drive, last=row is rows[-1])
        rows[1].legend(loc='lower right', ncols=4, title='motor + load Q = J dω/dt + C ω²',
                       title_fontsize=8.5)
        figure.align_ylabels(rows)
    return figure


def _draw_contact(row: Axes, x: Array, force: Array, least: float) -> None:
    row.plot(x, force, color=COLOURS[2])
    at = int(np.argmin(force))
    away = -8.0 if x[at] > 0.6 * x[-1] else 8.0
    lifts = ', the follower lifts off' if least < 0.0 else ''
    note(row, (x[at], force[at]), f'least {figure_text(least)} N{lifts}', (away, -4.0),
         COLOURS[1] if least < 0.0 else 'black')
    row.set_ylim(min(0.0, 1.15 * least), 1.1 * float(np.max(force)))
    row.set_ylabel('contact\nforce F [N]')


def start_up_figure(settings: CamDriveSettings, orbit: Orbit, run: StartUp) -> Figure:
    """
    Draw the start-up from rest.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.
    orbit : Orbit
        Its periodic motion.
    run : StartUp
        Its start-up.

    Returns
    -------
    Figure
        Speed of the cam shaft [rpm], the band of the periodic motion shaded, and contact force
        [N] over time [s], until well behind settling.

    """
    nominal = settings.drive.nominal_speed
    figures = start_up_figures(settings, orbit, run)
    t, _, omega = run.history
    times, force = contact_history(settings, run)
    first, settled = figures['first_crossing_s'], figures['settled_s']
    with styled():
        figure = new_figure(6.4)
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        low, high = orbit.speeds
        upper.axhspan(low / RPM, high / RPM, color=_BAND, linewidth=0,
                      label=f'periodic motion, {low / RPM:.1f} to {rpm_text(high)}')
        upper.axhline(nominal / RPM, color=GREY, linewidth=1.1, linestyle=_DASHES,
                      label=f'nominal speed, {rpm_text(nominal)}')
        upper.plot(t, omega / RPM, color=COLOURS[0])
        if first is not None:
            note(upper, (first, nominal / RPM), f'first at the nominal speed: {first:.4f} s',
                 (-4.0, 20.0))
        if settled is not None:
            level = float(np.interp(settled, t, omega)) / RPM
            note(upper, (settled, level), f'settled: {settled:.4f} s', (6.0, -14.0), COLOURS[1])
            for row in (upper, lower):
                row.axvline(settled, color=COLOURS[1], linewidth=0.9, linestyle=_DASHES)
        upper.set_ylim(0.0, 1.12 * float(np.max(omega)) / RPM)
        upper.set_ylabel('speed n [rpm]')
        upper.set_title(f'{settings.name}: start-up from rest')
        upper.legend(loc='lower right')
        _draw_contact(lower, times, force, figures['min_contact_force'])
        lower.set_xlabel('time t [s]')
        until = max(times[np.argmin(force)], 2.0 * (settled or first or run.duration))
        lower.set_xlim(0.0, min(float(until), run.duration))
        figure.align_ylabels((upper, lower))
    return figure


def contact_history(settings: CamDriveSettings, run: StartUp) -> tuple[Array, Array]:
    """
    List the contact force of a start-up over time, steps from both sides.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.
    run : StartUp
        Its start-up.

    Returns
    -------
    tuple[ndarray, ndarray], shape (n,) each
        Times [s] and forces [N].

    """
    drive, launch = settings.drive, run.launch
    t = np.linspace(0.0, launch.duration, 33)
    angles, omega = launch.state(t)
    at = drive.follower(drive.elements[0], angles)
    force = drive.contact_force(at, omega, drive.acceleration(at, omega), settings.base)
    columns = [(t, force)]
    for stretch in run.stretches:
        q = stretch.dense()
        columns.append((stretch.times(q), stretch.contact_force(q, settings.base)))
    times, forces = (np.concatenate(column) for column in zip(*columns))
    return times, forces


def rpm_text(omega: float) -> str:
    """
    Write a speed.

    Parameters
    ----------
    omega : float
        The speed [rad/s].

    Returns
    -------
    str
        The speed in rpm, to a tenth.

    """
    value = omega / RPM
    return f'{value:.0f} rpm' if math.isclose(value, round(value)) else f'{value:.1f} rpm'
