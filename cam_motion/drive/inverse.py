# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Inverse dynamics of a drive that follows its axis: what torque and speed the motion costs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike


class DriveState(NamedTuple):
    """
    Motion and torque of both shafts.

    Positions [rad], velocities [rad/s], torques [N m] of the motor and of the load shaft: all
    floats, or all arrays of one shape. The load torque is what the gearbox must deliver.
    """

    motor_position: Any
    motor_velocity: Any
    motor_torque: Any
    load_position: Any
    load_velocity: Any
    load_torque: Any


@dataclass(frozen=True)
class FollowerDrive:
    """
    A motor that moves an axis through a gearbox exactly as its setpoints say.

    Attributes
    ----------
    radius : float
        Travel of the axis per radian of the load shaft [unit/rad]; the roller radius of a belt.
    gear_ratio : float
        Turns of the motor per turn of the load shaft [-].
    efficiency : float
        Efficiency of the gearbox [-], above 0 and at most 1; it acts in the direction in which
        power flows.
    motor_inertia, load_inertia : float
        Inertias on the motor shaft and on the load shaft [kg m²].
    resistance_force : float
        Force against the travel of the axis [N].
    always_resists : bool
        Whether the resistance is a pull against the positive direction that acts in the dwell
        too; else it acts against the motion only.

    Notes
    -----
    Document 001 prints C_m = J_m/tau * dw_r/dt + tau (C_r + J_tot dw_r/dt), which balances
    power only with tau = w_r / w_m, the inverse of ``gear_ratio``. The 2 on its slide is
    w2 / w1; a motor on shaft 2 turns twice as fast as the rollers, so tau is 1/2.

    """

    radius: float = 1.0
    gear_ratio: float = 1.0
    efficiency: float = 1.0
    motor_inertia: float = 0.0
    load_inertia: float = 0.0
    resistance_force: float = 0.0
    always_resists: bool = False

    def follow(self, position: float, velocity: float, acceleration: float) -> DriveState:
        """
        Compute both shafts for one setpoint.

        Parameters
        ----------
        position, velocity, acceleration : float
            Setpoint of the axis [unit, unit/s, unit/s²].

        Returns
        -------
        DriveState
            Floats.

        """
        angle, speed = position / self.radius, velocity / self.radius
        rate = acceleration / self.radius
        sense = 1.0 if self.always_resists else (speed > 0.0) - (speed < 0.0)
        load = self.load_inertia * rate + self.resistance_force * self.radius * sense
        ratio = self.gear_ratio
        through = load / ratio
        through = through / self.efficiency if load * speed >= 0.0 else through * self.efficiency
        return DriveState(
            angle * ratio, speed * ratio, self.motor_inertia * ratio * rate + through,
            angle, speed, load)

    def follow_all(
        self, position: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
    ) -> DriveState:
        """
        Compute both shafts for many setpoints.

        Parameters
        ----------
        position, velocity, acceleration : array_like, one shape
            Setpoints of the axis [unit, unit/s, unit/s²].

        Returns
        -------
        DriveState
            Arrays of that shape.

        """
        angle = np.asarray(position, dtype=float) / self.radius
        speed = np.asarray(velocity, dtype=float) / self.radius
        rate = np.asarray(acceleration, dtype=float) / self.radius
        sense = np.ones_like(speed) if self.always_resists else np.sign(speed)
        load = self.load_inertia * rate + self.resistance_force * self.radius * sense
        ratio = self.gear_ratio
        share = np.where(load * speed >= 0.0, 1.0 / self.efficiency, self.efficiency)
        return DriveState(
            angle * ratio, speed * ratio,
            self.motor_inertia * ratio * rate + load / ratio * share, angle, speed, load)
