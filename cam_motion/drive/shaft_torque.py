# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The torque at the cam shaft, one speed at a time: motor on, off, or brake."""

from __future__ import annotations

from enum import Enum

from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.motor import InductionMotor, KlossMotor, Motor
from cam_motion.drive.shaft_field import Torque


class Command(Enum):
    """What the motor shaft has been told; the motor is on in one of them only."""

    RUN = 'run'
    COAST = 'coast'
    BRAKE = 'brake'


class ShaftTorque:
    """
    The torques of motor and brake behind a gearbox, in plain Python.

    Parameters
    ----------
    drive : CamDrive
        The drive.
    brake_torque : float
        Torque of the brake on the motor shaft [N m]; it acts against the motion, and holds a
        standing shaft against any load up to it.

    Attributes
    ----------
    synchronous : float
        Speed of the cam shaft above which its load drives the motor [rad/s].

    Notes
    -----
    The efficiency multiplies where the motor drives and divides where it is driven: by the load,
    above the synchronous speed, or when the shaft turns backwards. A brake is always driven.

    """

    def __init__(self, drive: CamDrive, brake_torque: float) -> None:
        """Write out the curve of the motor."""
        gearbox = drive.gearbox
        ratio = self.ratio = gearbox.ratio
        self.synchronous = drive.motor.synchronous_speed / ratio
        self.brake_torque = brake_torque
        driving, driven = ratio * gearbox.efficiency, ratio / gearbox.efficiency
        self._slow, _ = _curves(drive.motor, ratio, driving)
        self._fast, self._back = _curves(drive.motor, ratio, driven)
        self._forwards, self._backwards = _curves(drive.motor, ratio, 1.0)
        brake = driven * brake_torque
        self._brake: dict[bool, Torque] = {True: lambda w: -brake, False: lambda w: brake}

    def law(self, command: Command, sense: float, fast: bool) -> Torque:
        """
        Choose the smooth law that holds for a sense of turning and a side of synchronism.

        Parameters
        ----------
        command : Command
            What the motor shaft has been told.
        sense : float
            1 forwards, -1 backwards.
        fast : bool
            Whether the shaft turns faster than synchronously.

        Returns
        -------
        Callable[[float], float]
            Torque at the cam shaft [N m] over its speed [rad/s]; it goes on smoothly beyond the
            range that it holds for.

        """
        if command is Command.RUN:
            if sense < 0.0:
                return self._back
            return self._fast if fast else self._slow
        return self._brake[sense > 0.0] if command is Command.BRAKE else _none

    def motor(self, command: Command, sense: float, omega: float) -> float:
        """
        Give the torque of the motor while it turns.

        Parameters
        ----------
        command : Command
            What the motor shaft has been told.
        sense : float
            1 forwards, -1 backwards.
        omega : float
            Speed of the cam shaft [rad/s].

        Returns
        -------
        float
            Torque [N m].

        """
        if command is Command.RUN:
            return (self._forwards if sense > 0.0 else self._backwards)(omega)
        return 0.0

    def brake(self, command: Command, sense: float) -> float:
        """
        Give the torque of the brake on the motor shaft while it turns.

        Parameters
        ----------
        command : Command
            What the motor shaft has been told.
        sense : float
            1 forwards, -1 backwards.

        Returns
        -------
        float
            Torque [N m].

        """
        return -sense * self.brake_torque if command is Command.BRAKE else 0.0


def _none(_: float) -> float:
    return 0.0


def _curves(motor: Motor, ratio: float, gain: float) -> tuple[Torque, Torque]:
    """Write out what a motor gives, times a gain, turning forwards and turning backwards."""
    per_speed = ratio / motor.synchronous_speed
    if isinstance(motor, InductionMotor):
        most, best, a, b = gain * motor.breakdown_torque, motor.breakdown_slip, motor.a, motor.b
        rest = a - b

        def ahead(w: float) -> float:
            s = 1.0 - w * per_speed
            gap = best - s
            return most * s / (s + gap * gap * (a - b * s * s * s))

        def back(w: float) -> float:
            s = 1.0 - w * per_speed
            gap = best - s
            return most * s / (s + gap * gap * rest)
        return ahead, back
    if isinstance(motor, KlossMotor):
        factor = 2.0 * gain * motor.breakdown_torque * motor.breakdown_slip
        square = motor.breakdown_slip ** 2

        def kloss(w: float) -> float:
            s = 1.0 - w * per_speed
            return factor * s / (s * s + square)
        return kloss, kloss

    def given(w: float) -> float:
        return gain * float(motor.torque(ratio * w))
    return given, given
