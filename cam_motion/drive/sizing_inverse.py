# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Sizing by inverse dynamics: servo motors and gearboxes for a drive that follows its axis."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
import math

from cam_motion.drive.cycle import cycle_nodes, CycleNodes
from cam_motion.drive.inverse import FollowerDrive
from cam_motion.drive.servo_motor import ServoMotor
from cam_motion.drive.sizing import Candidate, Check, GearboxChoice, Progress, silent
from cam_motion.motion.piece import Array
from cam_motion.motion.profile import CamProfile
from cam_motion.units import RPM
import numpy as np

_REPORTS = 100  # how often at most the caller is told of the progress


@dataclass(frozen=True)
class ServoChoice:
    """
    A servo motor that a drive could have.

    Attributes
    ----------
    name : str
        Its name.
    motor : ServoMotor
        The motor.
    rated_power : float
        Rated power [W].
    source : str
        Where the figures are from.

    """

    name: str
    motor: ServoMotor
    rated_power: float
    source: str = ''


@dataclass(frozen=True)
class _Load:
    """Torque, speed and acceleration of the load shaft at the moments of a cycle."""

    torque: Array
    speed: Array
    acceleration: Array

    def motor_torque(self, choice: GearboxChoice, on_shaft: float) -> Array:
        """Give the torque of a motor with an inertia on its shaft, through a gearbox [N m]."""
        box = choice.gearbox
        own = (on_shaft + box.inertia / box.ratio ** 2) * box.ratio * self.acceleration
        torque: Array = own + box.motor_torque(self.torque, self.speed)
        return torque


class FollowerLoad:
    """
    What a drive that follows its axis has to move in one cycle, whatever moves it.

    Parameters
    ----------
    drive : FollowerDrive
        The drive; its motor and gearbox do not count.
    profile : CamProfile
        The cam of its axis.
    omega : float
        Speed of the master shaft [rad/s]; not zero.
    coupling : float
        Inertia on the motor shaft that stays whatever the motor [kg m²].

    """

    def __init__(self, drive: FollowerDrive, profile: CamProfile, omega: float,
                 coupling: float = 0.0) -> None:
        """Work out the load shaft."""
        self.coupling = coupling
        bare = replace(drive, gear_ratio=1.0, efficiency=1.0, motor_inertia=0.0)
        nodes = cycle_nodes(profile, omega, drive.edges)
        self.inertia = float(np.max(drive.law(nodes.dense[0]).inertia))
        self.period = nodes.period
        self._weights = nodes.weights / nodes.period
        self._dense, self._inner = self._shaft(bare, nodes)
        self.peak_torque = float(np.max(np.abs(self._dense.torque)))
        self.peak_speed = float(np.max(np.abs(self._dense.speed)))
        self.rms_torque = self._rms(self._inner.torque)
        self.rms_speed = self._rms(self._inner.speed)
        self.mean_speed = float(self._weights @ np.abs(self._inner.speed))

    @staticmethod
    def _shaft(bare: FollowerDrive, nodes: CycleNodes) -> tuple[_Load, _Load]:
        made = []
        for setpoints in (nodes.dense, nodes.inner):
            state = bare.follow_all(*setpoints)
            made.append(_Load(state.load_torque, state.load_velocity, setpoints[2] / bare.radius))
        return made[0], made[1]

    def _rms(self, values: Array) -> float:
        return math.sqrt(float(self._weights @ values ** 2))

    def candidate(self, servo: ServoChoice, choice: GearboxChoice, inertia_ratio: float,
                  ) -> Candidate:
        """
        Let a motor move it through a gearbox.

        Parameters
        ----------
        servo : ServoChoice
            The motor.
        choice : GearboxChoice
            The gearbox; its inertia comes on top of the motor's.
        inertia_ratio : float
            Largest ratio of the inertia moved, gearbox and coupling included, to the
            rotor's [-].

        Returns
        -------
        Candidate
            With figures as `cycle_figures` gives them, and every rule.

        """
        motor, box = servo.motor, choice.gearbox
        on_shaft = motor.inertia + self.coupling
        dense = self._dense.motor_torque(choice, on_shaft)
        inner = self._inner.motor_torque(choice, on_shaft)
        limit = motor.peak(box.ratio * np.abs(self._dense.speed))
        with np.errstate(divide='ignore', invalid='ignore'):
            worst = int(np.nanargmax(np.abs(dense) / limit))
        rms_torque, rms_speed = self._rms(inner), box.ratio * self.rms_speed
        power = inner * box.ratio * self._inner.speed * self.period
        drawn = float(self._weights @ np.maximum(power, 0.0))
        fed_back = float(self._weights @ np.maximum(-power, 0.0))
        moved = (self.inertia + box.inertia) / box.ratio ** 2 + self.coupling
        ratio = moved / motor.inertia
        figures = {
            'peak_torque': float(np.max(np.abs(dense))), 'rms_torque': rms_torque,
            'peak_speed_rpm': box.ratio * self.peak_speed / RPM,
            'rms_speed_rpm': rms_speed / RPM,
            'regenerated_energy_per_cycle': fed_back, 'motor_work_per_cycle': drawn - fed_back,
            'drawn_work_per_cycle': drawn, 'inertia_ratio': ratio,
        }
        continuous = float(motor.continuous(rms_speed))
        checks = [
            Check('peak_torque', abs(float(dense[worst])), float(limit[worst]), 'N m'),
            Check('rms_torque', rms_torque, continuous, 'N m'),
            Check('speed', figures['peak_speed_rpm'], motor.max_speed / RPM, 'rpm'),
            Check('inertia_ratio', ratio, inertia_ratio, ''),
            *gearbox_checks(
                choice, 1.0 / self.period, (self.peak_torque, self.rms_torque),
                (box.ratio * self.mean_speed, box.ratio * self.peak_speed)),
        ]
        return Candidate(servo.name, choice.name, box.ratio, None, servo.rated_power, figures,
                         tuple(checks))


def gearbox_checks(choice: GearboxChoice, rate: float, torques: tuple[float, float],
                   speeds: tuple[float, float]) -> Iterator[Check]:
    """
    Apply the limits of a gearbox, as far as they are known.

    Parameters
    ----------
    choice : GearboxChoice
        The gearbox.
    rate : float
        How often the peak torque comes [1/s].
    torques : tuple[float, float]
        Peak and RMS torque at the output [N m].
    speeds : tuple[float, float]
        Mean and peak speed of the motor shaft [rad/s].

    Yields
    ------
    Check
        One per limit.

    """
    for rule, value, bound, unit in (
            ('gearbox_peak_torque', torques[0], choice.torque_limit(rate), 'N m'),
            ('gearbox_rms_torque', torques[1], choice.rated_torque, 'N m'),
            ('gearbox_mean_speed', speeds[0] / RPM, choice.rated_speed / RPM, 'rpm'),
            ('gearbox_speed', speeds[1] / RPM, choice.max_speed / RPM, 'rpm')):
        if math.isfinite(bound):
            yield Check(rule, value, bound, unit)


def size_follower(load: FollowerLoad, pairs: Sequence[tuple[ServoChoice, GearboxChoice]],
                  inertia_ratio: float, tell: Progress = silent) -> list[Candidate]:
    """
    Let every pair of motor and gearbox move a load.

    Parameters
    ----------
    load : FollowerLoad
        The load.
    pairs : Sequence[tuple[ServoChoice, GearboxChoice]]
        Motors with gearboxes.
    inertia_ratio : float
        Largest ratio of the load's inertia to the rotor's [-].
    tell : Callable[[int, int], None]
        Told how many are done, of how many.

    Returns
    -------
    list[Candidate]
        One per pair, in their order.

    """
    every = max(1, len(pairs) // _REPORTS)
    found = []
    tell(0, len(pairs))
    for count, (servo, choice) in enumerate(pairs, start=1):
        found.append(load.candidate(servo, choice, inertia_ratio))
        if count % every == 0 or count == len(pairs):
            tell(count, len(pairs))
    return found
