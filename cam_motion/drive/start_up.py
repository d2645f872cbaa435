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
from cam_motion.drive.course import Course
from cam_motion.drive.passage import Passage, settle, solve
from cam_motion.drive.shaft_load import ShaftLoad
from cam_motion.drive.stretch import least_contact, passing, Stretch
from cam_motion.errors import CamMotionError
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Peak
from cam_motion.units import DEGREE, RPM, TURN
import numpy as np

_LAUNCH_ANGLE = 0.03  # from rest the motion is first found over time, up to about here [rad]
_PICARD_STEPS = 60
_CONVERGED = 1e-13
_GROWTH = 2.0  # behind the launch each element ends at most at this many times its beginning
_NEARLY = 0.8  # of an element, from which on it is not split any more


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
        return [float(stretch.times(np.array([angle]))[0])
                for stretch, angle, up in passing(self.stretches, speed) if up]

    def least_contact(self, base: float) -> Peak:
        """
        Find the least force between cam and roller, the launch included.

        Parameters
        ----------
        base : float
            Distance of the roller's centre from the cam shaft at s = 0 [m].

        Returns
        -------
        Peak
            Force [N], negative where the follower would lift off, and shaft angle [rad].

        """
        drive = self.launch.drive
        angles, omegas = self.launch.state(np.linspace(0.0, self.launch.duration, 65))
        at = drive.follower(drive.elements[0], angles)
        first = drive.contact_force(at, omegas, drive.acceleration(at, omegas), base)
        low = int(np.argmin(first))
        return min(Peak(float(first[low]), float(angles[low])),
                   least_contact(self.stretches, base))

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
        When the motor does not start, or comes to a stop before the revolution in which the
        duration ends is over.

    Notes
    -----
    At rest the energy equation is singular, so the first moments are found over time, by Picard
    iteration at Gauss points. From there on each revolution is solved at once, beginning with
    what the last one lets expect; when two begin all but alike, the second is the first with a
    small linear change.

    """
    # on the way to finding that the shaft stalls, the search may leave all numbers behind
    with np.errstate(all='ignore'):
        launch = _launch(drive)
        q, omega = (float(x[0]) for x in launch.state(np.array([launch.duration])))
        course = Course.over(drive, tuple(_growing(drive, q)))
        energy = 0.5 * float(course.terms.inertia[0, 0]) * omega ** 2
        found = solved = _revolve(course, course.steady(0.5 * omega ** 2), energy)
        stretches = list(found.stretches(launch.duration))
        turns = [0] * len(stretches)
        while stretches[-1].time_at_end < duration:
            energy = float(found.starts[-1])
            if turns[-1] == 0:
                course = Course.over(drive, drive.elements)
                guess = course.steady(0.5 * float(found.speeds[-1, -1]) ** 2)
                found = solved = _revolve(course, guess, energy)
            elif (near := solved.beside(energy)) is not None:
                found = near
            else:
                course = solved.course.cut_at(solved.next_cuts(energy))
                found = solved = _revolve(course, solved.guess(course, energy), energy)
            more = found.stretches(stretches[-1].time_at_end)
            stretches += more
            turns += [turns[-1] + 1] * len(more)
    count = max(1, sum(stretch.time < duration for stretch in stretches))
    return StartUp(launch, tuple(stretches[:count]), tuple(turns[:count]))


def _growing(drive: CamDrive, q: float) -> Iterator[Element]:
    """Give the elements of the first turn behind the launch, the first ones short."""
    for element in drive.elements:
        start = max(element.start, q)
        while start < element.end:
            longest = _GROWTH * start
            end = longest if longest < _NEARLY * element.end else element.end
            yield element._replace(start=start, end=end)
            start = end


def _revolve(course: Course, guess: Array, energy: float) -> Passage:
    """Solve a revolution, or what is left of the first."""
    found = settle(course, guess, energy, lambda course: _march(course, energy))
    if found is None:
        raise _stall(course, energy)
    return found


def _march(course: Course, energy: float) -> Array:
    """Find the energies at the Gauss points one element after the other."""
    energies = []
    for single in course.rows():
        found = solve(single, single.steady(energy / float(single.terms.inertia[0, 0])), energy)
        if found is None:
            raise _stall(single, energy)
        energies.append(found.energies[0])
        energy = float(found.starts[-1])
    return np.array(energies)


def _stall(course: Course, energy: float) -> StallError:
    speed = math.sqrt(2.0 * energy / float(course.terms.inertia[0, 0]))
    return StallError(
        f'the motor stalls at {course.elements[0].start / DEGREE:.1f} deg of the cam shaft, where '
        f'{speed / RPM:.1f} rpm are left; {_against_the_load(course.drive)}; take a stronger '
        'motor, a larger ratio or a larger flywheel')


def _against_the_load(drive: CamDrive) -> str:
    torque = float(drive.motor_torque(np.zeros(1))[0])
    return (f'at rest it gives {torque:.4g} N m at the cam shaft, and must exceed the '
            f'{ShaftLoad(drive).static_peak:.4g} N m that the static load takes up to')


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
