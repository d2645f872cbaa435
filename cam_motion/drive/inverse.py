# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Inverse dynamics of a drive that follows its axis: what torque and speed the motion costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from cam_motion.drive.axis_load import add_parts, LoadLaw, UNKNOWN
from cam_motion.drive.load import Friction, Part, RotatingInertia, TranslatingMass
from cam_motion.units import TURN
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

    parts : Sequence[Part]
        What else the load shaft has to move, as a cam shaft has it: its windows lie over the
        angle of the master shaft.

    Notes
    -----
    Document 001 prints C_m = J_m/tau * dw_r/dt + tau (C_r + J_tot dw_r/dt), which balances
    power only with tau = w_r / w_m, the inverse of ``gear_ratio``. The 2 on its slide is
    w2 / w1; a motor on shaft 2 turns twice as fast as the rollers, so tau is 1/2.

    The efficiency is a share of the torque that goes through the gearbox: the motor accelerates
    its own inertia without loss, and gives to the gearbox, or gets back from it, what
    `cam_motion.drive.gearbox.Gearbox.motor_torque` says.

    """

    radius: float = 1.0
    gear_ratio: float = 1.0
    efficiency: float = 1.0
    motor_inertia: float = 0.0
    load_inertia: float = 0.0
    resistance_force: float = 0.0
    always_resists: bool = False
    parts: Sequence[Part] = ()

    @cached_property
    def _bare(self) -> LoadLaw:
        """Give what the load shaft has to move without the parts."""
        resistance = self.resistance_force * self.radius
        return LoadLaw(self.load_inertia, pull=resistance if self.always_resists else 0.0,
                       friction=0.0 if self.always_resists else resistance)

    @property
    def edges(self) -> tuple[float, ...]:
        """Give the angles of the master shaft at which the load steps, within its turn [rad]."""
        return tuple(edge for part in self.parts for edge in part.edges() if 0.0 < edge < TURN)

    @property
    def is_even(self) -> bool:
        """Whether the load is the same at every place, angle and speed."""
        return all(isinstance(part, (RotatingInertia, TranslatingMass))
                   or (isinstance(part, Friction) and part.viscous == 0.0) for part in self.parts)

    def law(self, position: Any, shaft_angle: Any = UNKNOWN) -> LoadLaw:
        """
        Tell what the load takes from its shaft at a place.

        Parameters
        ----------
        position : float or ndarray
            Position of the axis [unit].
        shaft_angle : float or ndarray
            Angle of the master shaft [rad]; where it is not known, what acts in a window of it
            does not act.

        Returns
        -------
        LoadLaw
            Floats, or arrays of one shape or what broadcasts to it.

        """
        if not self.parts:
            return self._bare
        return add_parts(self._bare, self.parts, self.radius, position, shaft_angle)

    def follow(self, position: float, velocity: float, acceleration: float,
               shaft_angle: float = UNKNOWN) -> DriveState:
        """
        Compute both shafts for one setpoint.

        Parameters
        ----------
        position, velocity, acceleration : float
            Setpoint of the axis [unit, unit/s, unit/s²].
        shaft_angle : float
            Angle of the master shaft [rad]; see `law`.

        Returns
        -------
        DriveState
            Floats.

        """
        angle, speed = position / self.radius, velocity / self.radius
        rate = acceleration / self.radius
        sense = (speed > 0.0) - (speed < 0.0)
        load = self.law(position, shaft_angle).torque(speed, rate, sense)
        ratio = self.gear_ratio
        through = load / ratio
        through = through / self.efficiency if load * speed >= 0.0 else through * self.efficiency
        return DriveState(
            angle * ratio, speed * ratio, self.motor_inertia * ratio * rate + through,
            angle, speed, load)

    def follow_all(self, position: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike,
                   shaft_angle: ArrayLike = UNKNOWN) -> DriveState:
        """
        Compute both shafts for many setpoints.

        Parameters
        ----------
        position, velocity, acceleration : array_like, one shape
            Setpoints of the axis [unit, unit/s, unit/s²].
        shaft_angle : array_like, that shape or one number
            Angles of the master shaft [rad]; see `law`.

        Returns
        -------
        DriveState
            Arrays of that shape.

        """
        place = np.asarray(position, dtype=float)
        angle = place / self.radius
        speed = np.asarray(velocity, dtype=float) / self.radius
        rate = np.asarray(acceleration, dtype=float) / self.radius
        law = self.law(place, np.asarray(shaft_angle, dtype=float))
        load = law.torque(speed, rate, np.sign(speed))
        ratio = self.gear_ratio
        share = np.where(load * speed >= 0.0, 1.0 / self.efficiency, self.efficiency)
        return DriveState(
            angle * ratio, speed * ratio,
            self.motor_inertia * ratio * rate + load / ratio * share, angle, speed, load)
