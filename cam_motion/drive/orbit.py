# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The periodic motion of a cam drive: the fixed point of one revolution, found directly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
import math

from cam_motion.drive.cam_drive import CamDrive, Element, POINTS
from cam_motion.drive.collocation import gauss_rule
from cam_motion.errors import CamMotionError
from cam_motion.motion.piece import Array
from cam_motion.units import RPM
import numpy as np
from scipy.optimize import brentq, minimize_scalar

_STEPS = 60
_REFINEMENTS = 12
_NO_TORQUE = 1e-9  # share of the torque in an element below which it counts as none
_CONVERGED = 1e-13  # relative; what is left then is rounding
_DENSE = 33  # points per element among which extremes are looked for before they are refined


class NoOrbitError(CamMotionError):
    """The drive has no periodic motion: the motor cannot carry the load."""


@dataclass(frozen=True)
class Orbit:
    """
    One revolution of a cam drive in its periodic motion.

    Attributes
    ----------
    drive : CamDrive
        The drive.
    elements : tuple[Element, ...]
        The revolution, split wherever something steps.
    start_energy : float
        Kinetic energy at q = 0 [J].
    powers : ndarray, shape (elements, points)
        Q(q, w), motor included, at the Gauss points of each element [N m].
    multiplier : float
        By how much a disturbance of the energy is multiplied in one revolution [-].
    period : float
        Duration of the revolution [s].

    """

    drive: CamDrive
    elements: tuple[Element, ...]
    start_energy: float
    powers: Array
    multiplier: float
    period: float

    @cached_property
    def _energies(self) -> Array:
        """Sum the kinetic energy at the beginning of each element, and at the end of the last."""
        spans = np.array([e.end - e.start for e in self.elements])
        gains = spans * (self.powers @ gauss_rule(POINTS).weights)
        return self.start_energy + np.concatenate([[0.0], np.cumsum(gains)])

    def omega(self, index: int, q: Array) -> Array:
        """
        Give the speed within an element.

        Parameters
        ----------
        index : int
            Number of the element.
        q : ndarray, shape (n,)
            Shaft angles within it [rad].

        Returns
        -------
        ndarray, shape (n,)
            Speed of the cam shaft [rad/s].

        """
        element = self.elements[index]
        span = element.end - element.start
        gained = span * (gauss_rule(POINTS).row((q - element.start) / span) @ self.powers[index])
        inertia = self.drive.terms(self.drive.follower(element, q)).inertia
        speed: Array = np.sqrt(2.0 * (self._energies[index] + gained) / inertia)
        return speed

    def motion(self, index: int, q: Array) -> tuple[Array, Array]:
        """
        Give speed and acceleration within an element, its ends from inside.

        Parameters
        ----------
        index : int
            Number of the element.
        q : ndarray, shape (n,)
            Shaft angles within it [rad].

        Returns
        -------
        tuple[ndarray, ndarray]
            Speed [rad/s] and acceleration [rad/s²] of the cam shaft.

        """
        drive = self.drive
        omega = self.omega(index, q)
        t = drive.terms(drive.follower(self.elements[index], q))
        torque = t.force + t.damping * omega + drive.motor_torque(omega)
        return omega, (torque - t.centripetal * omega ** 2) / t.inertia

    @cached_property
    def speeds(self) -> tuple[float, float]:
        """Find the least and the greatest speed of the cam shaft [rad/s]."""
        return (self._extreme(lambda i, q: self.omega(i, q), 1.0),
                self._extreme(lambda i, q: self.omega(i, q), -1.0))

    def least_contact_force(self, base: float) -> float:
        """
        Find the least force between cam and roller, steps taken from both sides.

        Parameters
        ----------
        base : float
            Distance of the roller's centre from the cam shaft at s = 0 [m].

        Returns
        -------
        float
            Force [N].

        """
        def force(index: int, q: Array) -> Array:
            at = self.drive.follower(self.elements[index], q)
            return self.drive.contact_force(at, *self.motion(index, q), base)
        return self._extreme(force, 1.0)

    @cached_property
    def motor_work(self) -> float:
        """Sum the work of the motor at its own shaft over one revolution [J]."""
        rule = gauss_rule(POINTS)
        total = 0.0
        for index, element in enumerate(self.elements):
            span = element.end - element.start
            speed = self.drive.gearbox.ratio * self.omega(
                index, element.start + span * rule.points)
            total += span * float(rule.weights @ self.drive.motor.torque(speed))
        return total * self.drive.gearbox.ratio

    def power_reversals(self) -> list[float]:
        """
        Find where the motor's torque changes its sign, and the power in the gearbox with it.

        Returns
        -------
        list[float]
            Shaft angles within one turn [rad].

        """
        if self.drive.gearbox.efficiency == 1.0:
            return []
        ratio, torque = self.drive.gearbox.ratio, self.drive.motor.torque

        def at(q: float, index: int) -> float:
            return float(torque(ratio * self.omega(index, np.array([q]))[0]))

        found: list[float] = []
        before = 0.0
        for index, element in enumerate(self.elements):
            q = np.linspace(element.start, element.end, _DENSE)
            values = torque(ratio * self.omega(index, q))
            # an element may begin or end at such a place, where rounding decides on the sign
            values[np.abs(values) < _NO_TORQUE * np.max(np.abs(values))] = 0.0
            for k in np.flatnonzero(values[:-1] * values[1:] < 0.0):
                found.append(float(brentq(at, q[k], q[k + 1], args=(index,), xtol=1e-14)))
            signs = np.sign(values[values != 0.0])
            if before * signs[0] < 0.0:
                found.append(element.start)
            before = signs[-1]
        return sorted(found)

    def _extreme(self, function: Callable[[int, Array], Array], sign: float) -> float:
        """Find the least (sign 1) or greatest (sign -1) value over the revolution."""
        best = math.inf
        for index, element in enumerate(self.elements):
            q = np.linspace(element.start, element.end, _DENSE)
            values = sign * function(index, q)
            low = int(np.argmin(values))
            best = min(best, float(values[low]))
            if 0 < low < _DENSE - 1 and values[low] <= best:
                found = minimize_scalar(
                    lambda x, index=index: sign * float(function(index, np.array([x]))[0]),
                    bounds=(q[low - 1], q[low + 1]), method='bounded',
                    options={'xatol': 1e-9})
                best = min(best, float(found.fun))
        return sign * best


class _Revolution:
    """The terms of a drive at all Gauss points of a revolution, and the integration over it."""

    def __init__(self, drive: CamDrive, elements: tuple[Element, ...]) -> None:
        rule = gauss_rule(POINTS)
        spans = np.array([e.end - e.start for e in elements])
        columns = [drive.terms(drive.follower(e, e.start + span * rule.points))
                   for e, span in zip(elements, spans)]
        self.inertia, _, self.force, self.damping = (
            np.concatenate([getattr(c, name) for c in columns]) for name in columns[0]._fields)
        self.weights = np.concatenate([span * rule.weights for span in spans])
        count = self.weights.size
        self.matrix = np.tile(self.weights, (count, 1))
        for k, span in enumerate(spans):
            rows = slice(k * POINTS, (k + 1) * POINTS)
            self.matrix[rows, rows] = span * rule.matrix
            self.matrix[rows, (k + 1) * POINTS:] = 0.0


def find_orbit(drive: CamDrive) -> Orbit:
    """
    Find the periodic motion of a drive.

    Parameters
    ----------
    drive : CamDrive
        The drive.

    Returns
    -------
    Orbit
        Its periodic motion.

    Raises
    ------
    NoOrbitError
        When there is none on the working side of the motor's breakdown.

    Notes
    -----
    Where the power in the gearbox changes its direction, Q has a kink; the revolution is split
    there, and solved again until the places stand.

    With the energy E = J w²/2 as unknown, dE/dq = Q(q, w(E)) is one equation of first order in
    the shaft angle. It is collocated at the Gauss points of all elements of a revolution, with
    E(2 pi) = E(0), and solved by Newton's method: the fixed point of the one-revolution map
    without going through a single revolution.

    """
    cuts: list[float] = []
    orbit = _solve(drive, drive.elements)
    for _ in range(_REFINEMENTS):
        reversals = orbit.power_reversals()
        if len(reversals) == len(cuts) and np.allclose(reversals, cuts, rtol=0.0, atol=1e-12):
            break
        cuts = reversals
        orbit = _solve(drive, drive.split_at(cuts))
    return orbit


def _solve(drive: CamDrive, elements: tuple[Element, ...]) -> Orbit:
    table = _Revolution(drive, elements)
    count = table.weights.size
    system = np.zeros((count + 1, count + 1))
    start = 0.5 * table.inertia * drive.nominal_speed ** 2
    state = np.append(start, start[0])
    eye = np.eye(count)
    step = np.inf
    for _ in range(_STEPS):
        energy, first = state[:-1], state[-1]
        omega = np.sqrt(2.0 * energy / table.inertia)
        power = table.force + table.damping * omega + drive.motor_torque(omega)
        slope = (table.damping + drive.motor_slope(omega)) / (table.inertia * omega)
        inner = eye - table.matrix * slope
        if step < _CONVERGED:
            break
        system[:-1, :-1], system[:-1, -1] = inner, -1.0
        system[-1, :-1] = table.weights * slope
        residual = np.append(energy - first - table.matrix @ power, table.weights @ power)
        change = np.linalg.solve(system, -residual)
        # never below a tenth of the energy there is: the speed must stay positive
        falling = float(np.max(-change / state))
        change *= min(1.0, 0.9 / falling) if falling > 0.0 else 1.0
        state = state + change
        step = float(np.max(np.abs(change / state)))
    else:
        raise NoOrbitError(_why(drive, table))
    multiplier = 1.0 + float((table.weights * slope) @ np.linalg.solve(inner, np.ones(count)))
    if not abs(multiplier) < 1.0:
        raise NoOrbitError(_why(drive, table))
    return Orbit(
        drive, elements, float(first), power.reshape(len(elements), POINTS), multiplier,
        float(np.sum(table.weights / omega)))


def _why(drive: CamDrive, table: _Revolution) -> str:
    speeds = np.linspace(0.0, drive.nominal_speed * 1.5, 301)
    largest = float(np.max(drive.motor_torque(speeds)))
    needed = -float(table.weights @ (table.force + table.damping * drive.nominal_speed))
    needed /= float(np.sum(table.weights))
    peak = -float(np.min(table.force))
    return (
        f'no periodic motion near {drive.nominal_speed / RPM:g} rpm: the load takes {needed:.4g} '
        f'N m on average and up to {peak:.4g} N m, the motor gives up to {largest:.4g} N m at the '
        'cam shaft; take a stronger motor, a larger ratio or a larger flywheel')


__all__ = ['Element', 'NoOrbitError', 'Orbit', 'find_orbit']
