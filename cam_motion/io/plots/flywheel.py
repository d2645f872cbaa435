# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The flywheel of a cam drive: what more of it gives and what it costs."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from cam_motion.drive.orbit import find_orbit, NoOrbitError
from cam_motion.drive.start_up import StallError, start_up
from cam_motion.io.cam_drive_config import CamDriveSettings
from cam_motion.io.plots.cam_drive import note
from cam_motion.io.plots.style import COLOURS, figure_text, GREY, new_figure, styled
from cam_motion.io.simulation import orbit_figures, start_up_figures
from cam_motion.motion.piece import Array
from matplotlib.figure import Figure
import numpy as np

_ORBITS = 25  # closer where the flywheel is small; the configured one is among them
_STEP = 3  # a start-up takes ten times as long: every third, the configured one included
_SPAN = 4.0  # times the configured flywheel
_WITHOUT = 10.0  # times the motor's inertia, where no flywheel is configured
_SHORTEST = 1.5  # of a start-up [s]
_LONGER = 1.5  # a start-up is followed this many times as long as it should take


class FlywheelCurve(NamedTuple):
    """
    What a drive does with other flywheels.

    Inertias of the flywheel [kg m²], fluctuation [%] and least contact force [N] of the periodic
    motion with each; inertias for which the start-up is computed, its time to settle [s] and its
    least contact force [N]. What does not exist is not a number.
    """

    inertia: Array
    fluctuation_pct: Array
    contact_force: Array
    start_inertia: Array
    settled: Array
    start_contact_force: Array


def flywheel_curve(settings: CamDriveSettings) -> FlywheelCurve:
    """
    Find periodic motion and start-up of a drive with flywheels of 0 to 4 times its own.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.

    Returns
    -------
    FlywheelCurve
        The figures.

    """
    drive = settings.drive
    most = _SPAN * drive.flywheel or _WITHOUT * drive.motor.inertia
    inertias = most * np.linspace(0.0, 1.0, _ORBITS) ** 2
    fluctuation, contact = np.full((2, _ORBITS), np.nan)
    chosen = inertias[::_STEP]
    settled, start_contact = np.full((2, chosen.size), np.nan)
    for k, inertia in enumerate(inertias):
        other = replace(settings, drive=replace(drive, flywheel=float(inertia)))
        try:
            orbit = find_orbit(other.drive)
            figures = orbit_figures(other, orbit)
            fluctuation[k], contact[k] = figures['fluctuation_pct'], figures['min_contact_force']
            if k % _STEP == 0:
                run = start_up(other.drive, _expected(other))
                figures = start_up_figures(other, orbit, run)
                start_contact[k // _STEP] = figures['min_contact_force']
                if figures['settled_s'] is not None:
                    settled[k // _STEP] = figures['settled_s']
        except (NoOrbitError, StallError):
            continue
    return FlywheelCurve(inertias, fluctuation, contact, chosen, settled, start_contact)


def _expected(settings: CamDriveSettings) -> float:
    """Estimate how long a start-up must be followed until it has settled [s]."""
    drive = settings.drive
    speeds = np.linspace(0.0, 0.95 * drive.nominal_speed, 50)
    torque = float(np.mean(drive.motor_torque(speeds)))
    revolution = 2.0 * np.pi / drive.nominal_speed
    inertia = drive.fixed_inertia
    return max(_SHORTEST, _LONGER * (inertia * drive.nominal_speed / torque * 2.0
                                     + 4.0 * revolution))


def flywheel_figure(settings: CamDriveSettings, curve: FlywheelCurve) -> Figure:
    """
    Draw what other flywheels would do.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.
    curve : FlywheelCurve
        Its figures.

    Returns
    -------
    Figure
        Fluctuation [%], time to settle [s] and least contact forces [N] over the inertia of the
        flywheel [kg m²]; the configured one is marked.

    """
    own = settings.drive.flywheel
    with styled():
        figure = new_figure(6.8)
        rows = figure.subplots(3, 1, sharex=True)
        rows[0].plot(curve.inertia, curve.fluctuation_pct, color=COLOURS[0])
        rows[0].set_ylabel('fluctuation [%]')
        rows[1].plot(curve.start_inertia, curve.settled, 'o-', color=COLOURS[1], markersize=4.0)
        rows[1].set_ylabel('start-up:\nsettled after [s]')
        rows[2].plot(curve.inertia, curve.contact_force, color=COLOURS[2],
                     label='periodic motion')
        rows[2].plot(curve.start_inertia, curve.start_contact_force, 'o--', color=COLOURS[2],
                     markersize=4.0, label='start-up')
        rows[2].set_ylabel('least contact\nforce [N]')
        rows[2].legend(loc='lower right', ncols=2)
        rows[2].set_xlabel('inertia of the flywheel on the motor shaft J [kg m²]')
        rows[2].set_xlim(0.0, float(curve.inertia[-1]))
        rows[0].set_title(f'{settings.name}: the flywheel, configured {figure_text(own)} kg m²')
        missing = np.count_nonzero(np.isnan(curve.fluctuation_pct))
        if missing:
            last = curve.inertia[np.flatnonzero(np.isnan(curve.fluctuation_pct))[-1]]
            rows[0].axvspan(0.0, float(last), color='#F3F3F3', linewidth=0)
            rows[0].text(float(last), 0.95, ' no periodic motion in the shaded range', va='top',
                         color=GREY, fontsize=8.5, transform=rows[0].get_xaxis_transform())
        for row, x, y, unit, up in (
                (rows[0], curve.inertia, curve.fluctuation_pct, '%', 7.0),
                (rows[1], curve.start_inertia, curve.settled, 's', -7.0),
                (rows[2], curve.inertia, curve.contact_force, 'N', 7.0)):
            row.axvline(own, color=GREY, linewidth=0.9, linestyle=(0, (5, 3)), clip_on=False)
            if np.any(np.isfinite(y)):
                low, high = min(0.0, float(np.nanmin(y))), float(np.nanmax(y))
                row.set_ylim(low, high + 0.15 * (high - low))
            value = float(y[np.argmin(np.abs(x - own))])
            if np.isfinite(value):
                note(row, (own, value), f'{figure_text(value)} {unit}', (6.0, up))
        figure.align_ylabels(rows)
    return figure
