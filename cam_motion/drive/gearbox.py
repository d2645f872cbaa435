# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The gearbox between a motor and its load."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
import numpy as np


@dataclass(frozen=True)
class Gearbox:
    """
    A gearbox by ratio, efficiency and inertia.

    Attributes
    ----------
    ratio : float
        Turns of the motor per turn of the load shaft [-]; above 0.
    efficiency : float
        Share of the power that passes [-], above 0 and at most 1, in whichever direction the
        power flows.
    inertia : float
        Inertia reduced to the load shaft [kg m²]; not negative.
    rated_torque : float | None
        Torque that it may pass on at the load shaft [N m]; None where it is not known.
    max_speed : float | None
        Speed at which its motor side may turn [rad/s]; None where it is not known.

    Raises
    ------
    ConfigurationError
        When a figure is out of range; all are listed.

    Notes
    -----
    Document 004 multiplies by the efficiency always; when the load drives the motor that would
    let the losses push. Here they divide then.

    `gain` is for a torque of the motor that reaches the gearbox whole, all inertia being taken
    together at the load shaft, as document 004 does; `motor_torque` for what passes the teeth,
    without what the inertia on the motor shaft takes.

    """

    ratio: float = 1.0
    efficiency: float = 1.0
    inertia: float = 0.0
    rated_torque: float | None = None
    max_speed: float | None = None

    def __post_init__(self) -> None:
        """Refuse figures that make no gearbox."""
        problems = []
        if not (math.isfinite(self.ratio) and self.ratio > 0.0):
            problems.append(Problem('ratio', self.ratio, 'must be a finite number above 0'))
        if not 0.0 < self.efficiency <= 1.0:
            problems.append(Problem(
                'efficiency', self.efficiency, 'must be above 0 and at most 1',
                'a gearbox gives no power: write 0.9 for 90 %'))
        if not (math.isfinite(self.inertia) and self.inertia >= 0.0):
            problems.append(Problem('inertia', self.inertia, 'must be at least 0 kg m²'))
        problems += [
            Problem(name, value, 'must be a finite number above 0', 'leave out what is not known')
            for name, value in (
                ('rated_torque', self.rated_torque), ('max_speed', self.max_speed))
            if value is not None and not (math.isfinite(value) and value > 0.0)]
        if problems:
            raise ConfigurationError(problems)

    def gain(self, motor_torque: Any, motor_speed: Any) -> Any:
        """
        Give the torque at the load shaft per torque of the motor.

        Parameters
        ----------
        motor_torque, motor_speed : float or ndarray
            Torque [N m] and speed [rad/s] of the motor.

        Returns
        -------
        float or ndarray
            ratio * efficiency where the motor drives, ratio / efficiency where it is driven.

        """
        drives = np.asarray(motor_torque) * motor_speed >= 0.0
        return self.ratio * np.where(drives, self.efficiency, 1.0 / self.efficiency)

    def motor_torque(self, load_torque: Any, load_speed: Any) -> Any:
        """
        Give the torque that the motor must deliver.

        Parameters
        ----------
        load_torque, load_speed : float or ndarray
            Torque [N m] and speed [rad/s] of the load shaft.

        Returns
        -------
        float or ndarray
            Torque at the motor shaft, without what its own rotor takes [N m].

        """
        drives = np.asarray(load_torque) * load_speed >= 0.0
        share = np.where(drives, 1.0 / self.efficiency, self.efficiency)
        return load_torque / self.ratio * share
