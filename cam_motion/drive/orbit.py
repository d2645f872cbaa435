# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The periodic motion of a cam drive: the fixed point of one revolution, found directly."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from cam_motion.drive.approach import approach, Road
from cam_motion.drive.cam_drive import CamDrive, POINTS
from cam_motion.drive.cells import LoadTable
from cam_motion.drive.collocation import gauss_rule
from cam_motion.drive.course import Course
from cam_motion.drive.designs import Designs, Shafts
from cam_motion.drive.load import Follower
from cam_motion.drive.passage import settle
from cam_motion.drive.stretch import least, least_contact, passing, Stretch
from cam_motion.errors import CamMotionError, ConfigurationError
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Peak
from cam_motion.units import RPM, TURN
import numpy as np

_STEPS = 4  # per element, of the rough search


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
        return (least(self.stretches, lambda _, omega: omega).value,
                least(self.stretches, lambda _, omega: omega, -1.0).value)

    def least_contact(self, base: float) -> Peak:
        """
        Find the least force between cam and roller, steps taken from both sides.

        Parameters
        ----------
        base : float
            Distance of the roller's centre from the cam shaft at s = 0 [m].

        Returns
        -------
        Peak
            Force [N], negative where the follower would lift off, and shaft angle [rad].

        """
        return least_contact(self.stretches, base)

    @cached_property
    def least_follower_force(self) -> float:
        """Find the least force that presses the follower on the cam, along its way [N]."""
        drive = self.stretches[0].drive
        return least(self.stretches, lambda at, omega: drive.follower_force(
            at, omega, drive.acceleration(at, omega))).value

    @cached_property
    def motor_work(self) -> float:
        """Sum the work of the motor at its own shaft over one revolution [J]."""
        total = 0.0
        for stretch in self.stretches:
            rule, drive = gauss_rule(stretch.powers.size), stretch.drive
            torque = drive.motor.torque(drive.gearbox.ratio / stretch.slowness)
            total += drive.gearbox.ratio * stretch.span * float(rule.weights @ torque)
        return total

    @cached_property
    def drawn_work(self) -> float:
        """Sum the work of the motor while it drives over one revolution [J]."""
        drive = self.stretches[0].drive
        ratio, rule = drive.gearbox.ratio, gauss_rule(POINTS)
        synchronous = drive.motor.synchronous_speed / ratio
        cuts: dict[int, list[float]] = {}
        for stretch, angle, _ in passing(self.stretches, synchronous):
            cuts.setdefault(id(stretch), []).append(angle)
        total = 0.0
        for stretch in self.stretches:
            ends = [stretch.element.start, *cuts.get(id(stretch), ()), stretch.element.end]
            for start, end in zip(ends, ends[1:]):
                omega = stretch.omega(start + (end - start) * rule.points)
                torque = float(rule.weights @ drive.motor.torque(ratio * omega))
                total += ratio * (end - start) * max(torque, 0.0)
        return total

    @cached_property
    def peak_gearbox_torque(self) -> float:
        """Find the largest magnitude of the torque between gearbox and cam shaft [N m]."""
        drive = self.stretches[0].drive
        own = (drive.motor.inertia + drive.flywheel) * drive.gearbox.ratio ** 2

        def passed(at: Follower, omega: Array) -> Array:
            # what the motor gives, without what rotor and flywheel take up themselves
            torque = drive.motor_torque(omega) - own * drive.acceleration(at, omega)
            return np.asarray(np.abs(torque))
        return least(self.stretches, passed, -1.0).value

    def power_reversals(self) -> list[float]:
        """
        Find where the motor's torque changes its sign, and the power in the gearbox with it.

        Returns
        -------
        list[float]
            Shaft angles within one turn [rad].

        """
        drive = self.stretches[0].drive
        synchronous = drive.motor.synchronous_speed / drive.gearbox.ratio
        return [angle for _, angle, _ in passing(self.stretches, synchronous)]


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
    The fixed point of the one-revolution map, without going through a single revolution: the
    energy equation is solved for all elements at once, with E(2 pi) = E(0).

    """
    # on the way to finding that there is none, the search may leave all numbers behind
    with np.errstate(all='ignore'):
        base = Course.over(drive, drive.elements)
        for guess in _guesses(drive, base):
            found = settle(base, guess, None)
            if found is not None and abs(found.multiplier) < 1.0:
                return Orbit(found.stretches(0.0), found.multiplier)
        raise NoOrbitError(_why(base))


def _guesses(drive: CamDrive, base: Course) -> Iterator[Array]:
    """Give energies to begin the search with, the cheap ones first."""
    yield base.steady(0.5 * drive.nominal_speed ** 2)
    # the motor may be meant for another speed than the cam shaft, or the shaft fluctuate widely
    try:
        shafts = Shafts.of(Designs.of([drive]))
    except ConfigurationError:
        return  # a motor with a torque curve of its own
    road = Road(LoadTable(drive), _STEPS)
    speeds, exists = approach(shafts, road)
    if exists[0] != 0.0:
        omega = np.interp(base.angles[:, 1:-1], road.q, speeds[:, 0])
        yield 0.5 * base.terms.inertia[:, 1:-1] * omega ** 2


def _why(course: Course) -> str:
    drive = course.drive
    speeds = np.linspace(0.0, drive.nominal_speed * 1.5, 301)
    largest = float(np.max(drive.motor_torque(speeds)))
    taken = -(course.terms.force + course.terms.damping * drive.nominal_speed)[:, 1:-1]
    weights = course.spans * gauss_rule(taken.shape[1]).weights
    needed, peak = float(np.sum(weights * taken)) / TURN, -float(np.min(course.terms.force))
    return (
        f'no periodic motion near {drive.nominal_speed / RPM:g} rpm: the load takes {needed:.4g} '
        f'N m on average and up to {peak:.4g} N m, the motor gives up to {largest:.4g} N m at the '
        'cam shaft; take a stronger motor, a larger ratio or a larger flywheel')
