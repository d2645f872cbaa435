# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The start-up of a cam drive from rest, by the energy equation in the shaft angle."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
import math

from cam_motion.drive.cam_drive import CamDrive, Element, POINTS
from cam_motion.drive.collocation import gauss_rule
from cam_motion.drive.load import Terms
from cam_motion.drive.stretch import least, Stretch
from cam_motion.errors import CamMotionError
from cam_motion.motion.piece import Array
from cam_motion.units import RPM, TURN
import numpy as np
from scipy.optimize import brentq

_LAUNCH_ANGLE = 0.1  # from rest the motion is first found over time, up to about here [rad]
_PICARD_STEPS = 60
_NEWTON_STEPS = 25
_CONVERGED = 1e-13
_CUTTING_STEPS = 6
_PLACED = 1e-8  # a cut misplaced by this [rad] changes the energy by its square only
_LEAST_CUT = 1e-7  # a stretch shorter than this [rad] is not split any more
_GROWTH = 2.0  # behind the launch each stretch ends at most at this many times its beginning


class StallError(CamMotionError):
    """The motor cannot turn the shaft through."""


@dataclass(frozen=True)
class Launch:
    """
    The first moments from rest, over time.

    Attributes
    ----------
    drive : CamDrive
        The drive.
    duration : float
        How long they take [s].
    alphas, omegas, angles : ndarray, shape (points,)
        Acceleration [rad/s²], speed [rad/s] and angle [rad] at the Gauss points of that time.

    """

    drive: CamDrive
    duration: float
    alphas: Array
    omegas: Array
    angles: Array

    def state(self, t: Array) -> tuple[Array, Array]:
        """
        Give angle and speed.

        Parameters
        ----------
        t : ndarray, shape (n,)
            Times within the launch [s].

        Returns
        -------
        tuple[ndarray, ndarray]
            Angle [rad] and speed [rad/s] of the cam shaft.

        """
        row = self.duration * gauss_rule(self.alphas.size).row(t / self.duration)
        return row @ self.omegas, row @ self.alphas


@dataclass(frozen=True)
class StartUp:
    """
    The motion of a cam drive from rest.

    Attributes
    ----------
    launch : Launch
        The first moments.
    stretches : tuple[Stretch, ...]
        What follows, element by element.
    turns : tuple[int, ...]
        Number of the revolution of each stretch.

    """

    launch: Launch
    stretches: tuple[Stretch, ...]
    turns: tuple[int, ...]

    @property
    def duration(self) -> float:
        """Give the time at which the last stretch ends [s]."""
        return self.stretches[-1].time_at_end

    def crossings(self, speed: float) -> list[float]:
        """
        Find when the shaft passes a speed upwards.

        Parameters
        ----------
        speed : float
            Speed of the cam shaft [rad/s].

        Returns
        -------
        list[float]
            Times [s], in order; the launch, far below any working speed, is left out.

        """
        found = []
        for stretch in self.stretches:
            q = stretch.dense()
            above = stretch.omega(q) - speed
            for k in np.flatnonzero((above[:-1] < 0.0) & (above[1:] >= 0.0)):
                place = brentq(
                    lambda x, stretch=stretch: float(stretch.omega(np.array([x]))[0]) - speed,
                    q[k], q[k + 1], xtol=1e-13)
                found.append(float(stretch.times(np.array([place]))[0]))
        return found

    def least_contact_force(self, base: float) -> float:
        """
        Find the least force between cam and roller, the launch included.

        Parameters
        ----------
        base : float
            Distance of the roller's centre from the cam shaft at s = 0 [m].

        Returns
        -------
        float
            Force [N].

        """
        drive = self.launch.drive
        angles, omegas = self.launch.state(np.linspace(0.0, self.launch.duration, 65))
        at = drive.follower(drive.elements[0], angles)
        first = drive.contact_force(at, omegas, drive.acceleration(at, omegas), base)
        rest = least(self.stretches, lambda stretch, q: stretch.contact_force(q, base))
        return min(float(np.min(first)), rest)

    @cached_property
    def history(self) -> tuple[Array, Array, Array]:
        """List times [s], unwrapped angles [rad] and speeds [rad/s] for pictures."""
        t = np.linspace(0.0, self.launch.duration, 33)
        columns = [(t, *self.launch.state(t))]
        for stretch, turn in zip(self.stretches, self.turns):
            q = stretch.dense()
            columns.append((stretch.times(q), q + turn * TURN, stretch.omega(q)))
        t, q, omega = (np.concatenate(column) for column in zip(*columns))
        return t, q, omega


def start_up(drive: CamDrive, duration: float) -> StartUp:
    """
    Start a drive from rest at q = 0.

    Parameters
    ----------
    drive : CamDrive
        The drive.
    duration : float
        How long [s]; the last stretch ends at or behind it.

    Returns
    -------
    StartUp
        The motion.

    Raises
    ------
    StallError
        When the motor does not start, or comes to a stop before the end.

    Notes
    -----
    At rest the energy equation is singular, so the first tenth of a radian is found over time, by
    Picard iteration at Gauss points. From there on each element is solved by Newton's method at
    its Gauss points, cut where the power in the gearbox changes its direction.

    """
    launch = _launch(drive)
    q, omega = (float(x[0]) for x in launch.state(np.array([launch.duration])))
    first = drive.elements[0]
    at = drive.terms(drive.follower(first, np.array([q])))
    energy, time = 0.5 * float(at.inertia[0]) * omega ** 2, launch.duration
    tables: dict[Element, Terms] = {}
    stretches: list[Stretch] = []
    turns: list[int] = []
    for turn, whole in _elements_from(drive, q):
        start = whole.start
        while start < whole.end:
            part = whole._replace(start=start)
            done = _pass(drive, part, time, energy, tables, q + turn * TURN)
            done = _cut_at_reversal(drive, done, tables)
            stretches.append(done)
            turns.append(turn)
            start, energy, time = done.element.end, done.energy_at_end, done.time_at_end
        if time >= duration:
            break
    return StartUp(launch, tuple(stretches), tuple(turns))


def _elements_from(drive: CamDrive, q: float) -> Iterator[tuple[int, Element]]:
    """Give the elements of turn after turn, the first ones shortened and growing."""
    for element in drive.elements:
        start = max(element.start, q)
        while start < element.end:
            end = min(element.end, max(_GROWTH * start, start + _LAUNCH_ANGLE))
            end = element.end if element.end - end < _LAUNCH_ANGLE else end
            yield 0, element._replace(start=start, end=end)
            start = end
    turn = 1
    while True:
        for element in drive.elements:
            yield turn, element
        turn += 1


def _launch(drive: CamDrive) -> Launch:
    rule = gauss_rule(POINTS)
    element = drive.elements[0]
    alpha = drive.acceleration(drive.follower(element, np.zeros(1)), np.zeros(1))[0]
    if not alpha > 0.0:
        raise StallError(
            'the motor does not start: at rest it gives '
            f'{float(drive.motor_torque(np.zeros(1))[0]):.4g} N m at the cam shaft, which the '
            'load outweighs; take a stronger motor or a larger ratio')
    angle = min(_LAUNCH_ANGLE, 0.5 * element.end)
    duration = math.sqrt(2.0 * angle / alpha)
    alphas = np.full(POINTS, alpha)
    for _ in range(_PICARD_STEPS):
        omegas = duration * (rule.matrix @ alphas)
        angles = duration * (rule.matrix @ omegas)
        better = drive.acceleration(drive.follower(element, angles), omegas)
        change = float(np.max(np.abs(better - alphas))) / alpha
        alphas = better
        if change < _CONVERGED:
            break
    omegas = duration * (rule.matrix @ alphas)
    return Launch(drive, duration, alphas, omegas, duration * (rule.matrix @ omegas))


def _pass(drive: CamDrive, element: Element, time: float, energy: float,
          tables: dict[Element, Terms], angle: float) -> Stretch:
    """Solve one element from a given energy on."""
    rule = gauss_rule(POINTS)
    span = element.end - element.start
    terms = tables.get(element)
    if terms is None:
        terms = drive.terms(drive.follower(element, element.start + span * rule.points))
        tables[element] = terms
    matrix = span * rule.matrix
    energies = np.full(POINTS, energy)
    eye = np.eye(POINTS)
    for _ in range(_NEWTON_STEPS):
        omega = np.sqrt(2.0 * energies / terms.inertia)
        power = terms.force + terms.damping * omega + drive.motor_torque(omega)
        slope = (terms.damping + drive.motor_slope(omega)) / (terms.inertia * omega)
        change = np.linalg.solve(eye - matrix * slope, energy + matrix @ power - energies)
        falling = float(np.max(-change / energies))
        change *= min(1.0, 0.9 / falling) if falling > 0.0 else 1.0
        energies = energies + change
        if np.max(np.abs(change / energies)) < _CONVERGED:
            break
    else:
        raise StallError(
            f'the motor stalls at {element.start / TURN * 360.0:.1f} deg of the cam shaft, where '
            f'{math.sqrt(2.0 * energy / float(terms.inertia[0])) / RPM:.1f} rpm are left; take a '
            'stronger motor, a larger ratio or a larger flywheel')
    omega = np.sqrt(2.0 * energies / terms.inertia)
    power = terms.force + terms.damping * omega + drive.motor_torque(omega)
    return Stretch(drive, element, time, energy, power, 1.0 / omega)


def _cut_at_reversal(drive: CamDrive, done: Stretch, tables: dict[Element, Terms]) -> Stretch:
    """Shorten a stretch to its first reversal of power, where Q has a kink."""
    if drive.gearbox.efficiency == 1.0:
        return done
    whole, before = done.element, math.inf
    for _ in range(_CUTTING_STEPS):
        q, signs = done.motor_signs()
        turns = np.flatnonzero(signs[:-1] * signs[1:] < 0.0)
        if not turns.size:
            return done
        cut = done.reversal_between(q[turns[0]], q[turns[0] + 1])
        if not whole.start + _LEAST_CUT < cut < whole.end - _LEAST_CUT:
            return done
        if abs(cut - before) < _PLACED:
            return done
        before = cut
        done = _pass(drive, whole._replace(end=cut), done.time, done.energy, tables, cut)
        tables.pop(done.element)
    return done
