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
from cam_motion.drive.servo_cycle import ServoCycle
from cam_motion.drive.servo_motor import ServoMotor
from cam_motion.drive.set_motion import NANOSECOND
from cam_motion.io.machine import DriveSettings
from cam_motion.io.plots.style import (
    COLOURS,
    exact_curve,
    figure_text,
    GREY,
    new_figure,
    styled,
)
from cam_motion.io.turn import turn_profile
from cam_motion.motion.diagram import Axis
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE, RPM
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

_MARGIN = 0.06  # around what is drawn, as a share of it


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
    def rms_speed(self) -> float:
        """Root mean square of the motor speed over the cycle [rad/s]."""
        mean = np.trapezoid(self.velocity ** 2, self.phi) / (self.phi[-1] - self.phi[0])
        return float(np.sqrt(mean))

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
    drive = settings.drive
    profile = turn_profile(axis)
    angles, position = exact_curve(profile, 0, drive.edges)
    slope, bend = (exact_curve(profile, order, drive.edges)[1] for order in (1, 2))
    phi = angles * DEGREE
    state: DriveState = drive.follow_all(position, slope * omega, bend * omega * omega, phi)
    return TorqueCurve(omega / RPM, phi, np.asarray(state.motor_velocity),
                       np.asarray(state.motor_torque))


def torque_figure(name: str, curves: Sequence[TorqueCurve],
                  recorded: tuple[Array, Array] | None = None, motor: ServoMotor | None = None,
                  live: ServoCycle | None = None) -> Figure:
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
    motor : ServoMotor, optional
        The motor, whose limits are drawn behind; each curve then has a cross at its RMS speed
        and RMS torque, to be compared with the continuous torque.
    live : ServoCycle, optional
        What a servo drive really does in a cycle, drawn as dots at its setpoints.

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
        dots = _dots(recorded, live)
        if motor is not None:
            drawn = [curve.velocity for curve in curves] + [speeds for speeds, _, _ in dots]
            _draw_limits(plane, motor, min(float(speeds.min()) for speeds in drawn))
        for colour, curve in zip(COLOURS * (1 + len(curves) // len(COLOURS)), curves):
            rpm = curve.velocity / RPM
            peak = int(np.argmax(np.abs(curve.torque)))
            plane.plot(rpm, curve.torque, color=colour, label=(
                f'{curve.speed_cpm:g} cycles/min: '
                f'peak {figure_text(abs(curve.torque[peak]))} N m, '
                f'RMS {figure_text(curve.rms_torque)} N m, up to {np.abs(rpm).max():.4g} rpm'))
            plane.plot([rpm[peak]], [curve.torque[peak]], 'o', color=colour, markersize=5.0)
            if motor is not None:
                plane.plot([curve.rms_speed / RPM], [curve.rms_torque], 'X', color=colour,
                           markersize=8.0, markeredgecolor='white', zorder=4.0)
        for speeds, torques, text in dots:
            plane.plot(speeds / RPM, torques, '.', color=COLOURS[1], markersize=5.0,
                       markeredgewidth=0.0, alpha=0.7, label=text)
        plane.set_xlabel('motor speed n [rpm]')
        plane.set_ylabel('motor torque C [N m]')
        plane.set_title(f'{name}: torque over speed, one cycle')
        plane.margins(_MARGIN)
        figure.legend(loc='outside lower left', ncols=1)
    return figure


def _dots(recorded: tuple[Array, Array] | None, live: ServoCycle | None,
          ) -> list[tuple[Array, Array, str]]:
    """List what is drawn as dots: motor speeds, torques and the label."""
    dots = []
    if live is not None:
        late = live.tally.saturated_ns * NANOSECOND
        dots.append((live.motor_velocity, live.motor_torque,
                     f'servo drive, at its setpoints: {figure_text(late)} s of the cycle at a '
                     'limit'))
    if recorded is not None:
        text = f'{len(recorded[0])} recorded states, ramps of the shaft included'
        dots.append((*recorded, text))
    return dots


def _draw_limits(plane: Axes, motor: ServoMotor, slowest: float) -> None:
    """Draw peak and continuous torque over the speeds from the slowest to the motor's largest."""
    top = motor.max_speed
    for curve, style, text in (
            (motor.peak, '-', 'peak torque of the motor'),
            (motor.continuous, '--', 'continuous torque; crosses: RMS torque at RMS speed')):
        knots = [speed for speed in curve.speeds if speed < top]
        speeds = np.array([-top, *(-speed for speed in reversed(knots[1:])), *knots, top])
        torques = curve(speeds)
        # down at the largest speed, where the motor drives no more, and back along the mirror
        outline = np.concatenate([speeds, speeds[::-1], speeds[:1]]) / RPM
        mirrored = np.concatenate([torques, -torques[::-1], torques[:1]])
        plane.plot(outline, mirrored, color=GREY, linestyle=style, linewidth=1.2, label=text)
        if curve is motor.peak:
            plane.fill(outline, mirrored, color=GREY, alpha=0.06, linewidth=0.0)
    if slowest > -0.5 * top:  # an axis that hardly turns back: leave the empty half out
        plane.set_xlim((min(slowest, 0.0) - _MARGIN * top) / RPM, (1.0 + _MARGIN) * top / RPM)
