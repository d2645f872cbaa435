# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The force between a disc cam and its follower, and the speed at which they part."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
import math
from typing import NamedTuple

from cam_motion.drive.cam_drive import Element
from cam_motion.drive.load import Follower, Part, Spring
from cam_motion.drive.orbit import Orbit
from cam_motion.drive.stretch import Stretch
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.mechanism.cam_disc import CamDisc
from cam_motion.mechanism.cam_extremes import (
    candidates,
    extremes,
    follower_in,
    greatest_of,
    least_of,
    split_turn,
)
from cam_motion.mechanism.cam_follower import reach_of
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Peak
import numpy as np

_SPEED = 100.0  # rad/s at which the parts are asked, to separate the powers of the speed
_POINTS = 65  # per stretch, among which the search for the lift-off speed begins
_ROUNDS = 60
_INSIDE = 1e-6  # share of a piece within which it turns round, and not at its ends
_ZERO = 1e-12  # share of a force that is none, rounded


@dataclass(frozen=True)
class ContactForce:
    """
    The force along the common normal between a disc and its follower.

    Attributes
    ----------
    disc : CamDisc
        The disc.
    parts : Sequence[Part]
        What the follower has to move and to overcome; of a swinging follower inertia, spring and
        friction about its bearing.

    References
    ----------
    Document 004 i), equation (4), divided by cos(alpha): what the parts need along the way of
    the follower, by the speed of the follower along the normal per unit of its own (virtual
    work). Friction between disc and follower and in a guide is left out, as there.

    """

    disc: CamDisc
    parts: Sequence[Part]

    @cached_property
    def cuts(self) -> tuple[float, ...]:
        """List the shaft angles at which the force may step besides the joints [rad]."""
        curve = self.disc.profile.curve
        turns = [begin + u for begin, piece in zip(curve.breaks, curve.pieces)
                 for u in piece.derivative.zeros()  # friction changes its sign
                 if _INSIDE * piece.length < u < (1.0 - _INSIDE) * piece.length]
        return (*turns, *(edge for part in self.parts for edge in part.edges()))

    def along(self, at: Follower, omega: Array, alpha: Array) -> Array:
        """
        Sum what the parts need along the way of the follower.

        Parameters
        ----------
        at : Follower
            Where the follower is.
        omega, alpha : ndarray
            Speed [rad/s] and acceleration [rad/s²] of the shaft.

        Returns
        -------
        ndarray
            Force [N], or moment [N m] of a swinging follower, against the disc.

        """
        return _sum(self.parts, at, omega, alpha)

    def normal(self, at: Follower, omega: Array, alpha: Array) -> Array:
        """
        Give the contact force.

        Parameters
        ----------
        at : Follower
            Where the follower is.
        omega, alpha : ndarray
            Speed [rad/s] and acceleration [rad/s²] of the shaft.

        Returns
        -------
        ndarray
            Force along the common normal [N]; negative where the follower would lift off.

        """
        return self.along(at, omega, alpha) / self.disc.contact_at(at).reach

    def at_speed(self, omega: float) -> tuple[Array, Array]:
        """
        Give the contact force over one turn at steady speed, for drawing.

        Parameters
        ----------
        omega : float
            Speed of the shaft [rad/s].

        Returns
        -------
        tuple[ndarray, ndarray], shape (n,) each
            Shaft angles [rad] and forces [N]; where something steps, either side.

        """
        angles, forces = [], []
        for element in split_turn(self.disc.profile, self.cuts):
            q = np.linspace(element.start, element.end, _POINTS)
            at = follower_in(self.disc.profile, element, q)
            angles.append(q)
            forces.append(self.normal(at, np.full_like(q, omega), np.zeros_like(q)))
        return np.concatenate(angles), np.concatenate(forces)

    def extremes(self, omega: float) -> tuple[Peak, Peak]:
        """
        Find the least and the greatest contact force at steady speed.

        Parameters
        ----------
        omega : float
            Speed of the shaft [rad/s].

        Returns
        -------
        tuple[Peak, Peak]
            Forces [N] with their shaft angles [rad], steps taken from both sides.

        """
        return self._extremes(lambda at: self.normal(
            at, np.full_like(at.q, omega), np.zeros_like(at.q)))

    def extremes_on(self, orbit: Orbit) -> tuple[Peak, Peak]:
        """
        Find the least and the greatest contact force in the periodic motion of a drive.

        Parameters
        ----------
        orbit : Orbit
            The motion of a drive on whose shaft the disc sits.

        Returns
        -------
        tuple[Peak, Peak]
            Forces [N] with their shaft angles [rad], steps taken from both sides.

        """
        points = [
            point for stretch in orbit.stretches
            for point in candidates(lambda q, on=stretch: self.on_stretch(  # type: ignore[misc]
                on, q), stretch.element.start, stretch.element.end)]
        return least_of(points), greatest_of(points)

    def on_stretch(self, stretch: Stretch, q: Array) -> Array:
        """
        Give the contact force in the motion of a drive.

        Parameters
        ----------
        stretch : Stretch
            A stretch of the motion.
        q : ndarray, shape (n,)
            Shaft angles within it [rad].

        Returns
        -------
        ndarray, shape (n,)
            Forces [N].

        """
        return self.normal(follower_in(self.disc.profile, stretch.element, q), *stretch.motion(q))

    @cached_property
    def lift_off(self) -> Peak | None:
        """
        Find the lowest steady speed at which the least contact force comes down to zero.

        The speed [rad/s] with the shaft angle where the follower parts from the disc [rad];
        speed 0 where nothing holds it even at rest, None where no speed parts them.

        Notes
        -----
        F = F0 + F1 omega + F2 omega². Without F1, 1 / omega² is the greatest of -F2 / F0 over the
        turn. With it (viscous friction), a speed at which the least force is negative is lowered
        to where the force at that shaft angle is zero, again and again, which is Newton's way
        down to the speed sought.

        """
        at_rest = self._extremes(lambda at: self._powers(at).constant)[0]
        if at_rest.value <= 0.0:
            return Peak(0.0, at_rest.at)
        if not self._is_viscous:
            def inverse(at: Follower) -> Array:
                powers = self._powers(at)
                return -powers.square / powers.constant
            square = self._extremes(inverse)[1]
            return None if square.value <= 0.0 else Peak(square.value ** -0.5, square.at)
        return self._lowered(_ZERO * at_rest.value)

    def stiffness_for(self, omega: float, preload: float, force: float = 0.0) -> Peak:
        """
        Find the stiffness with which one spring holds the follower on the disc.

        Parameters
        ----------
        omega : float
            Steady speed of the shaft [rad/s].
        preload : float
            Compression of the spring at the cam's zero [m, rad].
        force : float
            Contact force that must be left [N].

        Returns
        -------
        Peak
            Stiffness [N/m, N m/rad] of a spring in place of all springs among the parts, and
            where it is needed; 0 where none is.

        Raises
        ------
        ConfigurationError
            When the spring would be slack where it is needed.

        """
        slack = preload + reach_of(self.disc.profile)[0].value
        if slack <= 0.0:
            raise ConfigurationError([Problem(
                'preload', preload, 'the spring must be compressed at every shaft angle',
                f'take more than {preload - slack:g} {self.disc.unit}')])
        needed = self._extremes(
            lambda at: self._lacking(at, omega, force) / (at.s + preload))[1]
        return Peak(max(needed.value, 0.0), needed.at)

    def preload_for(self, omega: float, stiffness: float, force: float = 0.0) -> Peak:
        """
        Find the preload with which one spring holds the follower on the disc.

        Parameters
        ----------
        omega : float
            Steady speed of the shaft [rad/s].
        stiffness : float
            Stiffness of the spring [N/m, N m/rad].
        force : float
            Contact force that must be left [N].

        Returns
        -------
        Peak
            Compression at the cam's zero [m, rad] of a spring in place of all springs among the
            parts, and where it is needed; negative where less than none would do.

        Raises
        ------
        ConfigurationError
            When the spring has no stiffness.

        """
        if not (math.isfinite(stiffness) and stiffness > 0.0):
            raise ConfigurationError([Problem(
                'stiffness', stiffness, 'must be a finite number above 0')])
        return self._extremes(
            lambda at: self._lacking(at, omega, force) / stiffness - at.s)[1]

    @property
    def _is_viscous(self) -> bool:
        """Whether the force has a part that is linear in the speed, other than rounding."""
        for element in split_turn(self.disc.profile, self.cuts):
            powers = self._powers(follower_in(
                self.disc.profile, element, np.linspace(element.start, element.end, _POINTS)))
            if np.any(np.abs(powers.linear) * _SPEED > _ZERO * np.max(
                    np.abs(powers.constant) + np.abs(powers.square) * _SPEED ** 2)):
                return True
        return False

    def _lacking(self, at: Follower, omega: float, force: float) -> Array:
        """Give what the springs must bring along the way of the follower."""
        others = [part for part in self.parts if not isinstance(part, Spring)]
        given = _sum(others, at, np.full_like(at.q, omega), np.zeros_like(at.q))
        return force * self.disc.contact_at(at).reach - given

    def _extremes(self, value: Callable[[Follower], Array]) -> tuple[Peak, Peak]:
        return extremes(self.disc.profile, value, self.cuts)

    def _powers(self, at: Follower) -> _Powers:
        """Separate the powers of the speed: every part is a polynomial of second degree in it."""
        still = np.zeros_like(at.q)
        constant, ahead, back = (
            self.along(at, still + omega, still) for omega in (0.0, _SPEED, -_SPEED))
        return _Powers(constant, (ahead - back) / (2.0 * _SPEED),
                       (0.5 * (ahead + back) - constant) / _SPEED ** 2)

    def _lowered(self, slack: float) -> Peak | None:
        """Lower a speed until the least force is zero, from where points suggest it to be."""
        profile = self.disc.profile
        elements = split_turn(profile, self.cuts)
        speed = Peak(math.inf, 0.0)
        for element in elements:
            q = np.linspace(element.start, element.end, _POINTS)
            zeros = _first_zero(self._powers(follower_in(profile, element, q)))
            k = int(np.argmin(zeros))
            speed = min(speed, Peak(float(zeros[k]), float(q[k])))
        for _ in range(_ROUNDS if math.isfinite(speed.value) else 0):
            found = []
            for element in elements:
                def force(q: Array, element: Element = element, omega: float = speed.value,
                          ) -> Array:
                    return self._powers(follower_in(profile, element, q)).at(omega)
                found += [(point, element) for point in candidates(
                    force, element.start, element.end)]
            least, element = min(found, key=lambda pair: pair[0].value)
            if least.value >= -slack:
                break
            here = self._powers(follower_in(profile, element, np.array([least.at])))
            speed = Peak(float(_first_zero(here)[0]), least.at)
        return speed if math.isfinite(speed.value) else None


class _Powers(NamedTuple):
    """A force at steady speed, constant + linear omega + square omega²."""

    constant: Array
    linear: Array
    square: Array

    def at(self, omega: float) -> Array:
        """Give the force at a speed [rad/s]."""
        return self.constant + self.linear * omega + self.square * omega ** 2


def _sum(parts: Sequence[Part], at: Follower, omega: Array, alpha: Array) -> Array:
    return sum((part.follower_force(at, omega, alpha) for part in parts), np.zeros_like(at.q))


def _first_zero(powers: _Powers) -> Array:
    """Find the lowest speed above 0 at which a force that holds at rest is none, or infinity."""
    constant, linear, square = powers
    root = linear ** 2 - 4.0 * constant * square
    with np.errstate(divide='ignore', invalid='ignore'):
        # the greatest 1 / omega of constant / omega² + linear / omega + square
        slowness = (np.sqrt(root) - linear) / (2.0 * constant)
        return np.where((root >= 0.0) & (slowness > 0.0), 1.0 / slowness, math.inf)
