# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""One cycle of an axis on a servo motor: what is left of the motor's limits, what is lost."""

from __future__ import annotations

from typing import NamedTuple

from cam_motion.drive.cycle import cycle_nodes
from cam_motion.drive.inverse import FollowerDrive
from cam_motion.drive.servo_axis import ServoAxis
from cam_motion.drive.servo_motor import ServoMotor
from cam_motion.drive.servo_tally import ServoTally
from cam_motion.drive.set_motion import NANOSECOND, Setpoint
from cam_motion.motion.piece import Array
from cam_motion.motion.profile import CamProfile
from cam_motion.units import TURN
import numpy as np

_CYCLES = 10  # at most, until one is like the one before
_ALIKE = 0.01  # in the following error
_SECOND_NS = 1_000_000_000
_LAGGING = 1e-3  # of the travel, by which the error at the end may grow in a cycle


class LimitFigures(NamedTuple):
    """
    What the exact motion of a cycle leaves of a motor's limits; negative where it breaks one.

    The least distance of the torque from the peak torque at the speed of the moment [N m], that
    of the RMS torque from the continuous torque at the RMS speed [N m], that of the largest
    speed from the motor's own [rad/s], the mean and that RMS speed [rad/s]. What a motor loses
    grows with torque squared and about with speed squared: the mean of both is what warms it, and
    what the continuous torque at a constant speed stands for.
    """

    peak_torque_margin: float
    rms_torque_margin: float
    speed_margin: float
    mean_speed: float
    rms_speed: float


def limit_figures(drive: FollowerDrive, motor: ServoMotor, profile: CamProfile, omega: float,
                  ) -> LimitFigures:
    """
    Compare one cycle at steady shaft speed with the limits of a motor.

    Parameters
    ----------
    drive : FollowerDrive
        Gearbox and load, all inertia on the motor shaft included.
    motor : ServoMotor
        The motor.
    profile : CamProfile
        The cam of the axis.
    omega : float
        Speed of the master shaft [rad/s]; not zero.

    Returns
    -------
    LimitFigures
        The figures.

    """
    nodes = cycle_nodes(profile, omega, drive.edges)
    dense, inner = drive.follow_all(*nodes.dense), drive.follow_all(*nodes.inner)
    allowed = motor.peak_torque(dense.motor_velocity)
    mean = float(nodes.weights @ np.abs(inner.motor_velocity)) / nodes.period
    rms, rms_speed = (float(np.sqrt(nodes.weights @ values ** 2 / nodes.period))
                      for values in (inner.motor_torque, inner.motor_velocity))
    return LimitFigures(
        float(np.min(allowed - np.abs(dense.motor_torque))),
        float(motor.continuous_torque(rms_speed)) - rms,
        motor.max_speed - float(np.max(np.abs(dense.motor_velocity))), mean, rms_speed)


class ServoCycle(NamedTuple):
    """
    One cycle of a servo drive.

    Times from its beginning [s], motor velocity [rad/s] and torque [N m] and following error
    [unit] at the setpoints, arrays of one shape (n,); what was counted over the cycle; and
    whether the drive catches up: its following error does not grow from cycle to cycle.
    """

    time: Array
    motor_velocity: Array
    motor_torque: Array
    following_error: Array
    tally: ServoTally
    catches_up: bool


def servo_cycle(servo: ServoAxis, profile: CamProfile, omega: float, rate: float) -> ServoCycle:
    """
    Drive an axis in cycles at steady shaft speed until one is like the one before.

    Parameters
    ----------
    servo : ServoAxis
        The drive; it is started anew.
    profile : CamProfile
        The cam of its axis.
    omega : float
        Speed of the master shaft [rad/s]; not zero.
    rate : float
        Setpoints per second [Hz].

    Returns
    -------
    ServoCycle
        The last cycle, of at most ten: stick and slip in a dwell may never repeat exactly.

    """
    count = max(1, round(TURN / abs(omega) * rate))  # setpoints per cycle, which may be rounded
    step = omega / rate

    def setpoint(k: int) -> Setpoint:
        y, slope, bend, _ = profile.sample(k * step)
        return Setpoint(round(k * _SECOND_NS / rate), y, slope * omega, bend * omega * omega,
                        k * step)

    servo.start(setpoint(0))
    error = 0.0  # at the end of a cycle
    last_peak = -1.0
    for cycle in range(_CYCLES):
        servo.reset_tally()
        last_error = error
        first = cycle * count
        states = [servo.follow(setpoint(first + k)) for k in range(1, count + 1)]
        error, peak = states[-1].following_error, servo.tally.peak_error
        if abs(peak - last_peak) <= _ALIKE * peak:
            break
        last_peak = peak
    travel = float(np.ptp(profile.curve(np.linspace(0.0, TURN, count + 1, endpoint=False))))
    grown = abs(error) - abs(last_error)
    start_ns = round(first * _SECOND_NS / rate)
    return ServoCycle(
        np.array([(s.time_ns - start_ns) * NANOSECOND for s in states]),
        np.array([s.drive.motor_velocity for s in states]),
        np.array([s.drive.motor_torque for s in states]),
        np.array([s.following_error for s in states]), servo.tally, grown <= _LAGGING * travel)
