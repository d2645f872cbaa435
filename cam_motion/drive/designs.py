# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Many motors, gearboxes and flywheels as a struct of arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.cells import Flags, Numbers
from cam_motion.drive.gearbox import Gearbox
from cam_motion.drive.load import Part
from cam_motion.drive.motor import InductionMotor, KlossMotor
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.piece import Array
from cam_motion.motion.profile import CamProfile
import numpy as np

_Rule = tuple[str, Callable[[Array], Any]]
_POSITIVE: _Rule = ('a finite number above 0', lambda x: x > 0.0)
_NOT_NEGATIVE: _Rule = ('a finite number of at least 0', lambda x: x >= 0.0)
_RULES: dict[str, _Rule] = {
    'b': ('a finite number', np.isfinite),
    'efficiency': ('above 0 and at most 1', lambda x: (x > 0.0) & (x <= 1.0)),
    'gearbox_inertia': _NOT_NEGATIVE,
    'flywheel': _NOT_NEGATIVE,
}


@dataclass(frozen=True)
class Designs:
    """
    What may differ between the drives of one load, arrays of shape (n,).

    Attributes
    ----------
    synchronous_speed : ndarray
        Of the motor [rad/s].
    breakdown_torque : ndarray
        T_b of the motor [N m].
    breakdown_slip : ndarray
        s_b of the motor [-].
    a, b : ndarray
        Constants of the motor's curve [-]; Kloss' curve has a = 1 / (2 s_b) and b = 0.
    motor_inertia : ndarray
        Of the rotor [kg m²].
    ratio : ndarray
        Turns of the motor per turn of the cam shaft [-].
    efficiency : ndarray
        Share of the power that passes the gearbox [-].
    gearbox_inertia : ndarray
        At the cam shaft [kg m²].
    flywheel : ndarray
        Inertia on the motor shaft [kg m²].

    Raises
    ------
    ConfigurationError
        When the arrays differ in shape or a figure is out of range.

    """

    synchronous_speed: Array
    breakdown_torque: Array
    breakdown_slip: Array
    a: Array
    b: Array
    motor_inertia: Array
    ratio: Array
    efficiency: Array
    gearbox_inertia: Array
    flywheel: Array

    def __post_init__(self) -> None:
        """Refuse what makes no drives."""
        problems = []
        for field in fields(self):
            values = np.asarray(getattr(self, field.name), dtype=np.float64)
            object.__setattr__(self, field.name, values)
            if values.ndim != 1 or values.size != self.synchronous_speed.size:
                problems.append(Problem(
                    field.name, values.shape, 'must be an array of one figure per design'))
                continue
            rule, good = _RULES.get(field.name, _POSITIVE)
            if not (fits := np.isfinite(values) & good(values)).all():
                first = int(np.argmin(fits))
                problems.append(Problem(
                    f'{field.name}[{first}]', float(values[first]), f'must be {rule}'))
        if problems:
            raise ConfigurationError(problems)

    def __len__(self) -> int:
        """Count the designs."""
        return int(self.ratio.size)

    def __getitem__(self, part: slice | Numbers | Flags) -> Designs:
        """Take some of the designs."""
        return Designs(*(getattr(self, field.name)[part] for field in fields(self)))

    @classmethod
    def of(cls, drives: Sequence[CamDrive]) -> Designs:
        """
        Gather drives.

        Parameters
        ----------
        drives : Sequence[CamDrive]
            Drives with induction motors.

        Returns
        -------
        Designs
            One design per drive, in the same order.

        Raises
        ------
        ConfigurationError
            When a motor has no torque curve of its own, as a servo motor.

        """
        rows, problems = [], []
        for k, drive in enumerate(drives):
            motor, box = drive.motor, drive.gearbox
            if isinstance(motor, InductionMotor):
                a, b = motor.a, motor.b
            elif isinstance(motor, KlossMotor):
                a, b = 0.5 / motor.breakdown_slip, 0.0
            else:
                problems.append(Problem(
                    f'drives[{k}].motor', type(motor).__name__, 'must be an induction motor'))
                continue
            rows.append((motor.synchronous_speed, motor.breakdown_torque, motor.breakdown_slip,
                         a, b, motor.inertia, box.ratio, box.efficiency, box.inertia,
                         drive.flywheel))
        if problems:
            raise ConfigurationError(problems)
        return cls(*np.array(rows, dtype=np.float64).reshape(-1, len(fields(cls))).T.copy())

    def drive(self, number: int, profile: CamProfile, parts: Sequence[Part],
              nominal_speed: float) -> CamDrive:
        """
        Build the drive of one design.

        Parameters
        ----------
        number : int
            Which design.
        profile : CamProfile
            Motion of the follower over the shaft angle [m].
        parts : Sequence[Part]
            The load.
        nominal_speed : float
            Speed of the cam shaft that the drive is meant for [rad/s].

        Returns
        -------
        CamDrive
            The drive.

        """
        speed, torque, slip, a, b, rotor, ratio, efficiency, box, flywheel = (
            float(getattr(self, field.name)[number]) for field in fields(self))
        motor: Any = (  # frozen, which the protocol is not
            KlossMotor(speed, torque, slip, rotor) if b == 0.0 and a == 0.5 / slip
            else InductionMotor(speed, torque, slip, a, b, rotor))
        return CamDrive(profile, parts, motor, Gearbox(ratio, efficiency, box), flywheel,
                        nominal_speed)


class Shafts(NamedTuple):
    """
    The motors as the cam shaft sees them, arrays of shape (n,).

    The speed of the cam shaft without load [rad/s], T_b [N m], s_b, a, b [-], ratio [-], gain of
    the gearbox where the motor drives and where it is driven [-], inertia of motor, flywheel and
    gearbox [kg m²].
    """

    idle_speed: Array
    breakdown_torque: Array
    breakdown_slip: Array
    a: Array
    b: Array
    ratio: Array
    driving: Array
    driven: Array
    inertia: Array

    @classmethod
    def of(cls, d: Designs) -> Shafts:
        """
        Reduce designs to the cam shaft.

        Parameters
        ----------
        d : Designs
            The designs.

        Returns
        -------
        Shafts
            In the same order.

        """
        return cls(d.synchronous_speed / d.ratio, d.breakdown_torque, d.breakdown_slip, d.a, d.b,
                   d.ratio, d.ratio * d.efficiency, d.ratio / d.efficiency,
                   d.gearbox_inertia + (d.motor_inertia + d.flywheel) * d.ratio * d.ratio)

    def take(self, which: Numbers | Flags) -> Shafts:
        """
        Take some of them.

        Parameters
        ----------
        which : ndarray
            Which ones.

        Returns
        -------
        Shafts
            These.

        """
        return Shafts(*(values[which] for values in self))

    def motor(self, omega: Array) -> tuple[Array, Array]:
        """
        Give the torque of the motors and its derivative with respect to their slip.

        Parameters
        ----------
        omega : ndarray, shape (..., n)
            Speed of the cam shaft [rad/s], forwards: there the curve needs no other branch.

        Returns
        -------
        tuple[ndarray, ndarray]
            At the motor shaft [N m].

        """
        s = 1.0 - omega / self.idle_speed
        gap = self.breakdown_slip - s
        bend = self.b * s * s
        rest = self.a - bend * s
        below = s + gap * gap * rest
        torque = self.breakdown_torque * s / below
        turn = 1.0 - gap * (2.0 * rest + 3.0 * gap * bend)
        return torque, (self.breakdown_torque - torque * turn) / below

    def power(self, force: Array, damping: Array, inertia: Array, energy: Array,
              ) -> tuple[Array, Array]:
        """
        Give the right-hand side of dE/dq = Q(q, w) and its derivative with respect to E.

        Parameters
        ----------
        force, damping, inertia : ndarray
            Q0 [N m] and Q1 [N m s/rad] of the load, J of the whole shaft [kg m²].
        energy : ndarray, shape (..., n)
            Kinetic energy [J].

        Returns
        -------
        tuple[ndarray, ndarray]
            Q [N m] and dQ/dE [1/rad].

        """
        omega = np.sqrt(2.0 * energy / inertia)
        torque, by_slip = self.motor(omega)
        gain = np.where(torque >= 0.0, self.driving, self.driven)
        return (force + damping * omega + gain * torque,
                (damping - gain * by_slip / self.idle_speed) / (inertia * omega))
