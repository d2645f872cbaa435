# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The motor of a cam drive: torque over speed, and the periodic motion in it."""

from __future__ import annotations

from cam_motion.drive.orbit import Orbit
from cam_motion.io.cam_drive_config import CamDriveSettings
from cam_motion.io.plots.cam_drive import note
from cam_motion.io.plots.cam_drive_motion import revolution, rpm_text
from cam_motion.io.plots.style import COLOURS, figure_text, GREY, new_figure, styled
from cam_motion.motion.piece import Array
from cam_motion.units import RPM
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np


def motor_figure(settings: CamDriveSettings, orbit: Orbit) -> Figure:
    """
    Draw torque over speed of the motor and the periodic motion in it.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.
    orbit : Orbit
        Its periodic motion.

    Returns
    -------
    Figure
        Motor speed [rpm] across, torque at the motor shaft [N m] up: from turning backwards to
        overspeed on the left, the speeds of the periodic motion on the right, with the loop of
        what the load takes, (C ω² − Q)/i.

    """
    drive, motor = settings.drive, settings.drive.motor
    ratio = drive.gearbox.ratio
    low, high = (ratio * speed for speed in orbit.speeds)
    with styled():
        figure = new_figure(5.2)
        whole, near = figure.subplots(1, 2, width_ratios=(3, 2))
        speeds = _motor_range(settings)
        for panel in (whole, near):
            panel.axhline(0.0, color='#444444', linewidth=0.8)
            panel.plot(speeds / RPM, motor.torque(speeds), color=COLOURS[0], label='motor')
            used = np.linspace(low, high, 101)
            panel.plot(used / RPM, motor.torque(used), color=COLOURS[1], linewidth=4.5,
                       solid_capstyle='butt', label='motor in periodic motion')
            panel.set_xlabel('motor speed n [rpm]')
        synchronous = motor.synchronous_speed
        for begin, end, what, up in ((speeds[0], 0.0, 'turned\nbackwards', 0.1),
                                     (synchronous, speeds[-1], 'overspeed:\nbrakes', 0.9)):
            whole.axvspan(begin / RPM, end / RPM, color='#F3F3F3', linewidth=0, zorder=0)
            whole.text(0.5 * (begin + end) / RPM, up, what, ha='center', va='center',
                       color=GREY, fontsize=8.5, transform=whole.get_xaxis_transform())
        breakdown = synchronous * (1.0 - motor.breakdown_slip)
        for speed, what, shift in (
                (0.0, 'standstill', (-4.0, 6.0)), (breakdown, 'breakdown', (0.0, 7.0)),
                (settings.rated_speed, 'at rated speed', (-8.0, 0.0)),
                (synchronous, 'synchronous', (8.0, 8.0))):
            torque = float(motor.torque(speed))
            if what == 'standstill':
                text = f'standstill\n{figure_text(torque)} N m'
            elif what == 'synchronous':
                text = f'synchronous\n{rpm_text(speed)}'
            else:
                text = f'{what}\n{figure_text(torque)} N m, {rpm_text(speed)}'
            note(whole, (speed / RPM, torque), text, shift)
        whole.set_ylabel('torque at the motor shaft T [N m]')
        whole.set_title(f'{settings.name}: motor')
        whole.margins(x=0.0)
        low_torque, high_torque = whole.get_ylim()
        whole.set_ylim(low_torque, high_torque + 0.1 * (high_torque - low_torque))
        _draw_loop(near, settings, orbit)
        figure.legend(*near.get_legend_handles_labels(), loc='outside lower left', ncols=3)
    return figure


def recorded_motor_figure(settings: CamDriveSettings, speed: Array, torque: Array) -> Figure:
    """
    Draw the recorded torque over speed of a motor that turns the shaft, beside its curve.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.
    speed, torque : ndarray, shape (n,)
        Recorded speeds [rad/s] and torques [N m] of the motor shaft, brake included.

    Returns
    -------
    Figure
        Motor speed [rpm] across, torque at the motor shaft [N m] up.

    """
    motor = settings.drive.motor
    low, high = min(0.0, float(speed.min())), max(motor.synchronous_speed, float(speed.max()))
    speeds = np.linspace(low, high + 0.03 * (high - low), 401)
    with styled():
        figure = new_figure(5.0)
        plane = figure.subplots()
        plane.axhline(0.0, color='#444444', linewidth=0.8)
        plane.plot(speeds / RPM, motor.torque(speeds), color=COLOURS[0], label='motor')
        plane.plot(speed / RPM, torque, '.', color=COLOURS[1], markersize=5.0,
                   markeredgewidth=0.0, alpha=0.7,
                   label=f'{len(speed)} recorded states, start-up and braking included')
        plane.set_xlabel('motor speed n [rpm]')
        plane.set_ylabel('torque at the motor shaft T [N m]')
        plane.set_title(f'{settings.name}: recorded torque over speed')
        plane.margins(0.06)
        figure.legend(loc='outside lower left', ncols=1)
    return figure


def _draw_loop(panel: Axes, settings: CamDriveSettings, orbit: Orbit) -> None:
    """Draw what the load takes of the motor shaft over its speed, round the revolution."""
    drive = settings.drive
    ratio = drive.gearbox.ratio
    angles, omega, torques = revolution(orbit)
    taken = (torques['C ω²'] - torques['load Q']) / ratio
    panel.plot(ratio * omega / RPM, taken, color=GREY, linewidth=1.4,
               label='load, (C ω² − Q)/i, round the revolution')
    for segment in drive.profile.segments:
        at = int(np.argmin(np.abs(angles - segment.end_deg)))
        if segment.end_deg > 359.999:
            at = 0
        note(panel, (ratio * omega[at] / RPM, taken[at]), f'φ = {angles[at]:.6g}°',
             (6.0, 6.0) if taken[at] >= 0.0 else (6.0, -6.0), GREY)
    low, high = (ratio * speed / RPM for speed in orbit.speeds)
    note(panel, (low, float(drive.motor.torque(low * RPM))), f'{low:.1f} rpm', (4.0, 7.0),
         COLOURS[1])
    note(panel, (high, float(drive.motor.torque(high * RPM))), f'{high:.1f} rpm', (-4.0, -8.0),
         COLOURS[1])
    panel.set_title('periodic motion')
    room = high - low
    panel.set_xlim(low - 0.18 * room, high + 0.26 * room)
    inside = np.linspace(low - 0.18 * room, high + 0.26 * room, 9)
    values = np.concatenate([taken, drive.motor.torque(inside * RPM)])
    spread = float(values.max() - values.min())
    panel.set_ylim(values.min() - 0.08 * spread, values.max() + 0.1 * spread)


def _motor_range(settings: CamDriveSettings) -> Array:
    """Spread motor speeds from turning backwards to overspeed [rad/s]."""
    synchronous = settings.drive.motor.synchronous_speed
    return np.linspace(-0.4 * synchronous, 1.6 * synchronous, 801)
