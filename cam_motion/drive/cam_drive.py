# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A cam shaft driven by a motor through a gearbox, with a flywheel, against a load."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
import math
from typing import NamedTuple

from cam_motion.drive.gearbox import Gearbox
from cam_motion.drive.load import Follower, Part, Terms
from cam_motion.drive.motor import Motor
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.piece import Array
from cam_motion.motion.profile import CamProfile
from cam_motion.units import DEGREE, TURN
import numpy as np

_LONGEST = math.pi / 3.0  # of an element [rad]: short enough for the points chosen below
_INSIDE = 1e-12  # how far within an element its terms are looked up, free of steps at its ends
POINTS = 12
"""Gauss points per element: order 24, which leaves rounding only, 1e-12 between the points too."""
SHORTEST = 1e-9
"""Edges closer than this are the same edge, rounded [rad]."""


class Element(NamedTuple):
    """A stretch of the shaft angle [rad] without a step, and the piece of the cam it lies in."""

    start: float
    end: float
    piece: int


@dataclass(frozen=True)
class CamDrive:
    """
    A cam shaft with everything that turns it and everything it moves.

    The equation of motion J dw/dt + C w² = Q, with C = dJ/dq / 2, is d(J w²/2)/dq = Q(q, w).

    Attributes
    ----------
    profile : CamProfile
        Motion of the follower over the shaft angle [m].
    parts : Sequence[Part]
        The load.
    motor : Motor
        The motor.
    gearbox : Gearbox
        Between motor and cam shaft; its inertia counts at the cam shaft.
    flywheel : float
        Inertia of a flywheel on the motor shaft [kg m²]; not negative.
    nominal_speed : float
        Speed of the cam shaft that the drive is meant for [rad/s].

    Raises
    ------
    ConfigurationError
        When the flywheel or the speed is out of range, the cam does not return, or the load is
        not defined or has no inertia at some angle.

    Notes
    -----
    The losses of the gearbox are those of document 004, g): Q_T = T r efficiency, a share of the
    torque of the *motor*, while motor, flywheel and gearbox are one inertia at the cam shaft. The
    document puts the flywheel on the motor side, so that what it gives to the load, and gets
    back, passes the teeth too: in this form without loss. `Gearbox.motor_torque`, and by it the
    drives that follow an axis, take the share from the torque *through the teeth* instead. The
    two are the same at constant speed, and where all inertia is on the cam shaft. For the press of
    the document, losses on the torque through the teeth mean 86.24 J per turn in place of 76.38,
    a fluctuation of 6.08 % in place of 5.77, and 399.1 rpm in place of 401.05 at least.

    References
    ----------
    Document 004, report on a radial cam with roller follower, steps g) to i).

    """

    profile: CamProfile
    parts: Sequence[Part]
    motor: Motor
    gearbox: Gearbox
    flywheel: float
    nominal_speed: float

    def __post_init__(self) -> None:
        """Refuse figures that make no drive."""
        problems = []
        if not (math.isfinite(self.flywheel) and self.flywheel >= 0.0):
            problems.append(Problem('flywheel', self.flywheel, 'must be at least 0 kg m²'))
        if not (math.isfinite(self.nominal_speed) and self.nominal_speed > 0.0):
            problems.append(Problem('nominal_speed', self.nominal_speed, 'must be above 0'))
        if not problems:
            problems = self._load_problems()
        if problems:
            raise ConfigurationError(problems)

    def _load_problems(self) -> list[Problem]:
        """Look whether the load is defined, and the shaft heavy, all the way round."""
        if self.profile.advance:
            return [Problem('axis', self.profile.advance, 'the cam of a drive must return: it '
                            'gains this in each turn', 'write cycle: return')]
        for element in self.elements:
            with np.errstate(invalid='ignore', divide='ignore'):
                terms = self.terms(self.follower(
                    element, np.linspace(element.start, element.end, 9)))
            where = f'{element.start / DEGREE:g} to {element.end / DEGREE:g} deg'
            if not all(np.all(np.isfinite(term)) for term in terms):
                return [Problem('load', where, 'the load must be defined at every shaft angle',
                                'let no lever be drawn out of its reach')]
            if not np.all(terms.inertia > 0.0):
                return [Problem('load', where, 'the inertia must be above 0 at every angle',
                                'give no part a negative inertia or mass')]
        return []

    @property
    def fixed_inertia(self) -> float:
        """Sum the inertia of motor, flywheel and gearbox at the cam shaft [kg m²]."""
        ratio = self.gearbox.ratio
        return self.gearbox.inertia + (self.motor.inertia + self.flywheel) * ratio * ratio

    @cached_property
    def elements(self) -> tuple[Element, ...]:
        """Split a turn at every joint of the cam and every edge of the load."""
        return self.split_at(())

    def split_at(self, cuts: Iterable[float]) -> tuple[Element, ...]:
        """
        Split a turn at joints, edges and further angles.

        Parameters
        ----------
        cuts : Iterable[float]
            Shaft angles within one turn [rad].

        Returns
        -------
        tuple[Element, ...]
            Elements from 0 to one turn, none longer than the Gauss points can serve.

        """
        curve = self.profile.curve
        edges = {*curve.breaks, *cuts,
                 *(edge % TURN for part in self.parts for edge in part.edges())}
        ordered = sorted(edges)
        merged = [0.0]
        for x in ordered:
            if merged[-1] + SHORTEST < x < TURN - SHORTEST:
                merged.append(x)
        merged.append(TURN)
        found = []
        for low, high in zip(merged, merged[1:]):
            count = math.ceil((high - low) / _LONGEST)
            ends = [low + (high - low) * k / count for k in range(count)] + [high]
            piece = max(0, bisect_right(curve.breaks, 0.5 * (low + high)) - 1)
            found += [Element(a, b, piece) for a, b in zip(ends, ends[1:])]
        return tuple(found)

    def follower(self, element: Element, q: Array) -> Follower:
        """
        Give the follower within an element, its ends from inside.

        Parameters
        ----------
        element : Element
            The element.
        q : ndarray
            Shaft angles within it [rad].

        Returns
        -------
        Follower
            Where the follower is.

        """
        curve = self.profile.curve
        piece = curve.pieces[element.piece]
        u = q - curve.breaks[element.piece]
        inside = np.clip(q, element.start + _INSIDE, element.end - _INSIDE)
        slope = piece.derivative
        return Follower(inside, piece(u), slope(u), slope.derivative(u))

    def terms(self, at: Follower) -> Terms:
        """
        Sum the terms of the whole shaft, without the motor's torque.

        Parameters
        ----------
        at : Follower
            Where the follower is.

        Returns
        -------
        Terms
            J with all inertias, C, Q0 and Q1.

        """
        zero = np.zeros_like(at.q)
        first = Terms(zero + self.fixed_inertia, zero, zero, zero)
        return Terms(*(sum(column[1:], column[0]) for column in zip(
            first, *(part.terms(at) for part in self.parts))))

    def motor_torque(self, omega: Array) -> Array:
        """
        Give the motor's torque at the cam shaft.

        Parameters
        ----------
        omega : ndarray
            Speed of the cam shaft [rad/s].

        Returns
        -------
        ndarray
            Torque [N m].

        """
        speed = self.gearbox.ratio * omega
        torque = self.motor.torque(speed)
        found: Array = self.gearbox.gain(torque, speed) * torque
        return found

    def motor_line(self, omega: Array) -> tuple[Array, Array]:
        """
        Linearise the motor's torque at the cam shaft over its speed.

        Parameters
        ----------
        omega : ndarray
            Speed of the cam shaft [rad/s].

        Returns
        -------
        tuple[ndarray, ndarray]
            Torque [N m] and its derivative with respect to the speed [N m s/rad].

        """
        ratio = self.gearbox.ratio
        speed = ratio * omega
        torque = self.motor.torque(speed)
        gain = self.gearbox.gain(torque, speed)
        return gain * torque, gain * ratio * self.motor.slope(speed)

    def acceleration(self, at: Follower, omega: Array) -> Array:
        """
        Give the acceleration of the cam shaft from the equation of motion.

        Parameters
        ----------
        at : Follower
            Where the follower is.
        omega : ndarray
            Speed of the cam shaft [rad/s].

        Returns
        -------
        ndarray
            Acceleration [rad/s²].

        """
        terms = self.terms(at)
        torque = terms.force + terms.damping * omega + self.motor_torque(omega)
        found: Array = (torque - terms.centripetal * omega ** 2) / terms.inertia
        return found

    def contact_force(self, at: Follower, omega: Array, alpha: Array, base: float) -> Array:
        """
        Give the force between cam and roller.

        Parameters
        ----------
        at : Follower
            Where the follower is.
        omega, alpha : ndarray
            Speed [rad/s] and acceleration [rad/s²] of the cam shaft.
        base : float
            Distance of the roller's centre from the cam shaft at s = 0 [m].

        Returns
        -------
        ndarray
            Force [N] along the common normal; negative where the follower would lift off.

        """
        along = self.follower_force(at, omega, alpha)
        normal: Array = along * np.hypot(at.s1, base + at.s) / (base + at.s)
        return normal

    def follower_force(self, at: Follower, omega: Array, alpha: Array) -> Array:
        """
        Give the force that presses the follower on the cam, along its own way.

        Parameters
        ----------
        at : Follower
            Where the follower is.
        omega, alpha : ndarray
            Speed [rad/s] and acceleration [rad/s²] of the cam shaft.

        Returns
        -------
        ndarray
            Force [N], with the sign of the contact force whatever the size of the cam.

        """
        return sum((part.follower_force(at, omega, alpha) for part in self.parts),
                   np.zeros_like(at.q))
