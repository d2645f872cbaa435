# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The drive in the plane of speed and torque, where motors are chosen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from cam_motion.drive.inverse import DriveState
from cam_motion.io.machine import DriveSettings
from cam_motion.io.plots.style import COLOURS, exact_curve, figure_text, new_figure, styled
from cam_motion.motion.diagram import Axis
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE, RPM
from matplotlib.figure import Figure
import numpy as np


class TorqueCurve(NamedTuple):
    """
    Speed and torque of a motor over one cycle.

    Shaft speed ``speed_cpm`` [cycles/min], shaft angles ``phi`` [rad], motor velocity [rad/s] and
    torque [N m], arrays of one shape (n,).
    """

    speed_cpm: float
    phi: Array
    velocity: Array
    torque: Array

    @property
    def rms_torque(self) -> float:
        """Root mean square of the torque over the cycle [N m]."""
        mean = np.trapezoid(self.torque ** 2, self.phi) / (self.phi[-1] - self.phi[0])
        return float(np.sqrt(mean))


def torque_curve(settings: DriveSettings, axis: Axis, omega: float) -> TorqueCurve:
    """
    Compute what a motor must do over one cycle at a steady shaft speed.

    Parameters
    ----------
    settings : DriveSettings
        The drive.
    axis : Axis
        The axis that it moves.
    omega : float
        Shaft speed [rad/s].

    Returns
    -------
    TorqueCurve
        Motor speed and torque over one turn of the shaft.

    """
    angles, position = exact_curve(axis.profile, 0)
    slope, bend = (exact_curve(axis.profile, order)[1] for order in (1, 2))
    state: DriveState = settings.drive.follow_all(position, slope * omega, bend * omega * omega)
    return TorqueCurve(omega / RPM, angles * DEGREE, np.asarray(state.motor_velocity),
                       np.asarray(state.motor_torque))


def torque_figure(name: str, curves: Sequence[TorqueCurve],
                  recorded: tuple[Array, Array] | None = None) -> Figure:
    """
    Draw torque over speed of a motor.

    Parameters
    ----------
    name : str
        Name of the drive.
    curves : Sequence[TorqueCurve]
        What to draw, each in a colour of its own.
    recorded : tuple[ndarray, ndarray], shape (n,) each
        Recorded motor speeds [rad/s] and torques [N m], drawn as dots.

    Returns
    -------
    Figure
        Motor speed [rpm] across, motor torque [N m] up.

    """
    with styled():
        figure = new_figure(5.0)
        plane = figure.subplots()
        plane.axhline(0.0, color='#444444', linewidth=0.8)
        plane.axvline(0.0, color='#444444', linewidth=0.8)
        for colour, curve in zip(COLOURS * (1 + len(curves) // len(COLOURS)), curves):
            rpm = curve.velocity / RPM
            peak = int(np.argmax(np.abs(curve.torque)))
            plane.plot(rpm, curve.torque, color=colour, label=(
                f'{curve.speed_cpm:g} cycles/min: '
                f'peak {figure_text(abs(curve.torque[peak]))} N m, '
                f'RMS {figure_text(curve.rms_torque)} N m, up to {np.abs(rpm).max():.4g} rpm'))
            plane.plot([rpm[peak]], [curve.torque[peak]], 'o', color=colour, markersize=5.0)
        if recorded is not None:
            plane.plot(recorded[0] / RPM, recorded[1], '.', color=COLOURS[1], markersize=5.0,
                       markeredgewidth=0.0, alpha=0.7,
                       label=f'{len(recorded[0])} recorded states, ramps of the shaft included')
        plane.set_xlabel('motor speed n [rpm]')
        plane.set_ylabel('motor torque C [N m]')
        plane.set_title(f'{name}: torque over speed, one cycle')
        plane.margins(0.06)
        figure.legend(loc='outside lower left', ncols=1)
    return figure
