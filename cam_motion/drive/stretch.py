# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The motion of a cam drive over one element of the shaft angle, as the energy solver finds it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
import math

from cam_motion.drive.cam_drive import CamDrive, Element
from cam_motion.drive.collocation import gauss_rule
from cam_motion.motion.piece import Array
import numpy as np
from scipy.optimize import minimize_scalar

_DENSE = 33  # points among which extremes are looked for before they are refined
_NO_TORQUE = 1e-9  # share of the motor's torque in an element below which it counts as none


@dataclass(frozen=True)
class Stretch:
    """
    One passage of an element.

    Attributes
    ----------
    drive : CamDrive
        The drive.
    element : Element
        The element, within one turn.
    time : float
        Time at its beginning [s].
    energy : float
        Kinetic energy at its beginning [J].
    powers : ndarray, shape (points,)
        Q(q, w), motor included, at the Gauss points [N m].
    slowness : ndarray, shape (points,)
        1 / w at the Gauss points [s/rad].

    """

    drive: CamDrive
    element: Element
    time: float
    energy: float
    powers: Array
    slowness: Array

    @property
    def span(self) -> float:
        """Measure the element [rad]."""
        return self.element.end - self.element.start

    @cached_property
    def energy_at_end(self) -> float:
        """Sum the kinetic energy at the end [J]."""
        rule = gauss_rule(self.powers.size)
        return self.energy + self.span * float(rule.weights @ self.powers)

    @cached_property
    def time_at_end(self) -> float:
        """Give the time at the end [s]."""
        rule = gauss_rule(self.powers.size)
        return self.time + self.span * float(rule.weights @ self.slowness)

    def omega(self, q: Array) -> Array:
        """
        Give the speed.

        Parameters
        ----------
        q : ndarray, shape (n,)
            Shaft angles within the element [rad].

        Returns
        -------
        ndarray, shape (n,)
            Speed of the cam shaft [rad/s].

        """
        rule = gauss_rule(self.powers.size)
        gained = self.span * (rule.row((q - self.element.start) / self.span) @ self.powers)
        inertia = self.drive.terms(self.drive.follower(self.element, q)).inertia
        speed: Array = np.sqrt(2.0 * (self.energy + gained) / inertia)
        return speed

    def times(self, q: Array) -> Array:
        """
        Give the times at which angles are passed.

        Parameters
        ----------
        q : ndarray, shape (n,)
            Shaft angles within the element [rad].

        Returns
        -------
        ndarray, shape (n,)
            Times [s].

        """
        rule = gauss_rule(self.powers.size)
        passed: Array = rule.row((q - self.element.start) / self.span) @ self.slowness
        return self.time + self.span * passed

    def motion(self, q: Array) -> tuple[Array, Array]:
        """
        Give speed and acceleration, the ends from inside.

        Parameters
        ----------
        q : ndarray, shape (n,)
            Shaft angles within the element [rad].

        Returns
        -------
        tuple[ndarray, ndarray]
            Speed [rad/s] and acceleration [rad/s²] of the cam shaft.

        """
        omega = self.omega(q)
        return omega, self.drive.acceleration(self.drive.follower(self.element, q), omega)

    def contact_force(self, q: Array, base: float) -> Array:
        """
        Give the force between cam and roller, the ends from inside.

        Parameters
        ----------
        q : ndarray, shape (n,)
            Shaft angles within the element [rad].
        base : float
            Distance of the roller's centre from the cam shaft at s = 0 [m].

        Returns
        -------
        ndarray, shape (n,)
            Force [N].

        """
        at = self.drive.follower(self.element, q)
        return self.drive.contact_force(at, *self.motion(q), base)

    def dense(self, count: int = _DENSE) -> Array:
        """
        Spread angles evenly over the element.

        Parameters
        ----------
        count : int
            How many, both ends included.

        Returns
        -------
        ndarray, shape (count,)
            Shaft angles [rad].

        """
        return np.linspace(self.element.start, self.element.end, count)

    def motor_signs(self) -> tuple[Array, Array]:
        """
        Tell where the motor drives and where it is driven.

        Returns
        -------
        tuple[ndarray, ndarray]
            Shaft angles [rad], and the sign of the motor's torque at them; angles at which it is
            zero but for rounding, as at the ends of an element cut there, are left out.

        """
        at_points = self.drive.motor.torque(self.drive.gearbox.ratio / self.slowness)
        if np.min(np.abs(at_points)) > np.max(np.abs(np.diff(at_points))):
            # zero is farther away than a step between the points: no need to look closer
            return self.dense(1), np.sign(at_points[:1])
        q = self.dense()
        torque = self.drive.motor.torque(self.drive.gearbox.ratio * self.omega(q))
        clear = np.abs(torque) > _NO_TORQUE * np.max(np.abs(torque))
        return q[clear], np.sign(torque[clear])

    def reversal_between(self, low: float, high: float) -> float:
        """
        Find where the motor's torque is zero, by regula falsi to a few steps.

        Parameters
        ----------
        low, high : float
            Shaft angles with torques of opposite sign [rad].

        Returns
        -------
        float
            Shaft angle [rad].

        """
        ratio, torque = self.drive.gearbox.ratio, self.drive.motor.torque
        ends = np.array([low, high])
        for _ in range(4):
            at_low, at_high = torque(ratio * self.omega(ends))
            if at_low == at_high:
                break
            better = ends[1] - at_high * (ends[1] - ends[0]) / (at_high - at_low)
            ends = np.clip([ends[1], better], self.element.start, self.element.end)
        return float(ends[1])


def least(stretches: Iterable[Stretch], value: Callable[[Stretch, Array], Array],
          sign: float = 1.0) -> float:
    """
    Find the least value of something over several stretches, steps taken from both sides.

    Parameters
    ----------
    stretches : Iterable[Stretch]
        Where to look.
    value : Callable[[Stretch, ndarray], ndarray]
        Gives the value at angles within a stretch.
    sign : float
        -1 finds the greatest value instead.

    Returns
    -------
    float
        The value, refined between the points looked at.

    """
    best = math.inf
    for stretch in stretches:
        q = stretch.dense()
        values = sign * value(stretch, q)
        low = int(np.argmin(values))
        if values[low] < best and 0 < low < q.size - 1:
            found = minimize_scalar(
                lambda x, stretch=stretch: sign * float(value(stretch, np.array([x]))[0]),
                bounds=(q[low - 1], q[low + 1]), method='bounded', options={'xatol': 1e-9})
            best = min(best, float(found.fun))
        best = min(best, float(values[low]))
    return sign * best
