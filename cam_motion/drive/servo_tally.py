# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a servo drive has done so far: saturation, error, energy and how warm its motor runs."""

from __future__ import annotations

from dataclasses import dataclass, field
import math

from cam_motion.drive.rigid_drive import Move
from cam_motion.drive.servo_motor import ServoMotor
from cam_motion.drive.set_motion import NANOSECOND


@dataclass
class ServoTally:
    """
    Sums over the motion of a servo drive.

    Attributes
    ----------
    motor : ServoMotor
        Its motor.
    thermal_time : float
        Time constant of the running means [s].
    time_ns, saturated_ns, dropped_ns : int
        Time integrated, of that time with the torque or the speed at its limit, and time that
        was not integrated [ns].
    saturations : int
        How often a limit was reached.
    peak_torque, peak_speed, peak_error : float
        Largest magnitudes [N m, rad/s, unit].
    torque_square, error_square : float
        Integrals of the squares over time [(N m)² s, unit² s].
    motor_work, regenerated_energy : float
        Work of the motor, and the part of it that was negative, as a positive figure [J].

    """

    motor: ServoMotor
    thermal_time: float = 60.0
    time_ns: int = 0
    saturated_ns: int = 0
    dropped_ns: int = 0
    saturations: int = 0
    peak_torque: float = 0.0
    peak_speed: float = 0.0
    peak_error: float = 0.0
    torque_square: float = 0.0
    error_square: float = 0.0
    motor_work: float = 0.0
    regenerated_energy: float = 0.0
    _weight: float = field(default=0.0, repr=False)
    _square: float = field(default=0.0, repr=False)
    _speed_square: float = field(default=0.0, repr=False)

    def note_torque(self, torque: float, newly_saturated: bool) -> None:
        """
        Count a torque that the loop asks for.

        Parameters
        ----------
        torque : float
            Torque within its limits [N m].
        newly_saturated : bool
            Whether it has just reached one.

        """
        self.peak_torque = max(self.peak_torque, abs(torque))
        self.saturations += newly_saturated

    def note_move(self, torque: float, move: Move, time_ns: int, saturated: bool,
                  error: float) -> None:
        """
        Count what a torque has done.

        Parameters
        ----------
        torque : float
            The torque [N m].
        move : Move
            Its motion.
        time_ns : int
            How long it acted [ns].
        saturated : bool
            Whether it stood at a limit.
        error : float
            Following error [unit].

        """
        time = time_ns * NANOSECOND
        self.time_ns += time_ns
        if saturated:
            self.saturated_ns += time_ns
        if abs(move.velocity) > self.peak_speed:
            self.peak_speed = abs(move.velocity)
        if abs(error) > self.peak_error:
            self.peak_error = abs(error)
        square = torque * torque * time
        self.torque_square += square
        self.error_square += error * error * time
        for travel in (move.before, move.after):
            work = torque * travel
            self.motor_work += work
            if work < 0.0:
                self.regenerated_energy -= work
        fade = self.thermal_time / (self.thermal_time + time)
        self._weight = self._weight * fade + time
        self._square = self._square * fade + square
        self._speed_square = self._speed_square * fade + move.velocity * move.velocity * time

    @property
    def rms_torque(self) -> float:
        """Root mean square of the torque over all the time [N m]."""
        return _root_mean(self.torque_square, self.time_ns)

    @property
    def rms_error(self) -> float:
        """Root mean square of the following error over all the time [unit]."""
        return _root_mean(self.error_square, self.time_ns)

    @property
    def running_rms_torque(self) -> float:
        """Root mean square of the torque, the past fading by the time constant [N m]."""
        return math.sqrt(self._square / self._weight) if self._weight else 0.0

    @property
    def running_speed(self) -> float:
        """Root mean square of the speed, the past fading by the time constant [rad/s]."""
        return math.sqrt(self._speed_square / self._weight) if self._weight else 0.0

    @property
    def thermal_load(self) -> float:
        """Compare running RMS and continuous torque at the running speed; above 1 is too warm."""
        allowed = self.motor.continuous_torque(self.running_speed)
        if allowed > 0.0:
            return self.running_rms_torque / float(allowed)
        return math.inf if self.running_rms_torque > 0.0 else 0.0


def _root_mean(integral: float, time_ns: int) -> float:
    return math.sqrt(integral / (time_ns * NANOSECOND)) if time_ns else 0.0
