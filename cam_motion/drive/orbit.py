# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The periodic motion of a cam drive: the fixed point of one revolution, found directly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from cam_motion.drive.cam_drive import CamDrive, Element, POINTS
from cam_motion.drive.collocation import gauss_rule
from cam_motion.drive.stretch import least, Stretch
from cam_motion.errors import CamMotionError
from cam_motion.units import RPM
import numpy as np

_STEPS = 60
_REFINEMENTS = 12
_RUNAWAY = 1e4  # times the energy at nominal speed: no motor is meant for that
_PLACED = 1e-8  # a cut misplaced by this [rad] changes the energy by its square only
_CONVERGED = 1e-13  # relative; what is left then is rounding


class NoOrbitError(CamMotionError):
    """The drive has no periodic motion: the motor cannot carry the load."""


@dataclass(frozen=True)
class Orbit:
    """
    One revolution of a cam drive in its periodic motion.

    Attributes
    ----------
    stretches : tuple[Stretch, ...]
        The revolution, split wherever something steps; its time begins at zero.
    multiplier : float
        By how much a disturbance of the energy is multiplied in one revolution [-].

    """

    stretches: tuple[Stretch, ...]
    multiplier: float

    @property
    def start_energy(self) -> float:
        """Give the kinetic energy at q = 0 [J]."""
        return self.stretches[0].energy

    @property
    def period(self) -> float:
        """Give the duration of the revolution [s]."""
        return self.stretches[-1].time_at_end

    @cached_property
    def speeds(self) -> tuple[float, float]:
        """Find the least and the greatest speed of the cam shaft [rad/s]."""
        return (least(self.stretches, Stretch.omega), least(self.stretches, Stretch.omega, -1.0))

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
        return least(self.stretches, lambda stretch, q: stretch.contact_force(q, base))

    @cached_property
    def motor_work(self) -> float:
        """Sum the work of the motor at its own shaft over one revolution [J]."""
        total = 0.0
        for stretch in self.stretches:
            rule, drive = gauss_rule(stretch.powers.size), stretch.drive
            omega = stretch.omega(stretch.element.start + stretch.span * rule.points)
            torque = drive.motor.torque(drive.gearbox.ratio * omega)
            total += drive.gearbox.ratio * stretch.span * float(rule.weights @ torque)
        return total

    def power_reversals(self) -> list[float]:
        """
        Find where the motor's torque changes its sign, and the power in the gearbox with it.

        Returns
        -------
        list[float]
            Shaft angles within one turn [rad].

        """
        found: list[float] = []
        before = 0.0
        for stretch in self.stretches:
            q, signs = stretch.motor_signs()
            if not signs.size:
                continue
            if before * signs[0] < 0.0:
                found.append(stretch.element.start)
            found += [stretch.reversal_between(q[k], q[k + 1])
                      for k in np.flatnonzero(signs[:-1] * signs[1:] < 0.0)]
            before = signs[-1]
        return sorted(found)


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
    orbit = _solve(drive, drive.elements, 0.5 * drive.nominal_speed ** 2)
    if drive.gearbox.efficiency == 1.0:
        return orbit
    for _ in range(_REFINEMENTS):
        reversals = orbit.power_reversals()
        if len(reversals) == len(cuts) and np.allclose(reversals, cuts, rtol=0.0, atol=_PLACED):
            break
        cuts = reversals
        inertia = drive.terms(drive.follower(drive.elements[0], np.zeros(1))).inertia[0]
        orbit = _solve(drive, drive.split_at(cuts), orbit.start_energy / inertia)
    return orbit


def _solve(drive: CamDrive, elements: tuple[Element, ...], half_square: float) -> Orbit:
    """Solve with given elements, from a guess of w²/2."""
    table = _Revolution(drive, elements)
    count = table.weights.size
    system = np.zeros((count + 1, count + 1))
    start = table.inertia * half_square
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
        if not np.all(np.isfinite(system)) or np.max(energy) > _RUNAWAY * np.max(start):
            raise NoOrbitError(_why(drive, table))
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
    stretches: list[Stretch] = []
    at, time = float(first), 0.0
    shape = (len(elements), POINTS)
    for element, powers, slowness in zip(
            elements, power.reshape(shape), (1.0 / omega).reshape(shape)):
        stretches.append(Stretch(drive, element, time, at, powers, slowness))
        at, time = stretches[-1].energy_at_end, stretches[-1].time_at_end
    return Orbit(tuple(stretches), multiplier)


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
