# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The radial cam with an in-line translating roller follower."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.piece import Array, Piece
from cam_motion.motion.piecewise import Peak
from cam_motion.motion.profile import CamProfile
import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar

_DENSE = 65  # points per piece among which extremes are looked for before they are refined
_PLACED = 1e-10  # share of a piece; its square, which is the error of the value, is rounding


@dataclass(frozen=True)
class RadialCam:
    """
    A disc that moves a roller along a line through its shaft.

    Attributes
    ----------
    profile : CamProfile
        Travel of the follower over the shaft angle, outwards [m].
    base_radius : float
        Radius of the disc where the travel is zero [m].
    roller_radius : float
        Radius of the roller [m].

    Raises
    ------
    ConfigurationError
        When a radius is not above 0, the profile does not return, or the follower would travel
        into the shaft's centre.

    References
    ----------
    Document 004, section b).

    """

    profile: CamProfile
    base_radius: float
    roller_radius: float

    def __post_init__(self) -> None:
        """Refuse figures that make no cam."""
        problems = [
            Problem(name, value, 'must be a finite number above 0')
            for name, value in (('base_radius', self.base_radius),
                                ('roller_radius', self.roller_radius))
            if not (math.isfinite(value) and value > 0.0)
        ]
        if self.profile.advance:
            problems.append(Problem(
                'profile', self.profile.advance, 'the travel of a disc cam must return'))
        lowest = self.profile.curve.extremes(0)[0].value
        if not problems and self.base_radius + lowest <= 0.0:
            problems.append(Problem(
                'base_radius', self.base_radius,
                f'the follower goes {-lowest:g} m inwards, to the centre of the shaft',
                f'take more than {-lowest:g} m'))
        if problems:
            raise ConfigurationError(problems)

    @property
    def base(self) -> float:
        """Give the distance of the roller's centre from the shaft at zero travel [m]."""
        return self.base_radius + self.roller_radius

    def pitch_radius(self, q: ArrayLike) -> Array:
        """
        Give the distance of the roller's centre from the shaft.

        Parameters
        ----------
        q : array_like, any shape
            Shaft angles [rad].

        Returns
        -------
        ndarray, shape of q
            Distances [m].

        """
        return self.base + self.profile(q)

    def pressure_angle(self, q: ArrayLike) -> Array:
        """
        Give the angle between the common normal and the travel of the follower.

        Parameters
        ----------
        q : array_like, any shape
            Shaft angles [rad].

        Returns
        -------
        ndarray, shape of q
            Angles, positive while the follower goes outwards [rad].

        """
        return np.asarray(np.arctan2(self.profile(q, 1), self.pitch_radius(q)), dtype=np.float64)

    def pitch_curvature(self, q: ArrayLike) -> Array:
        """
        Give the curvature of the path of the roller's centre over the disc.

        Parameters
        ----------
        q : array_like, any shape
            Shaft angles [rad]; where s'' steps, the value from the right.

        Returns
        -------
        ndarray, shape of q
            Curvatures, negative where the path is hollow [1/m].

        """
        return _curvature(self.pitch_radius(q), self.profile(q, 1), self.profile(q, 2))

    def contour_radius(self, q: ArrayLike) -> Array:
        """
        Give the radius of curvature of the disc's contour.

        Parameters
        ----------
        q : array_like, any shape
            Shaft angles [rad]; where s'' steps, the value from the right.

        Returns
        -------
        ndarray, shape of q
            Radii [m]; infinite where the path of the roller's centre is straight, less than
            ``-roller_radius`` where it is hollow, between that and 0 where the roller undercuts.

        """
        with np.errstate(divide='ignore'):
            return np.asarray(1.0 / self.pitch_curvature(q) - self.roller_radius,
                              dtype=np.float64)

    @cached_property
    def pressure_angles(self) -> tuple[Peak, Peak]:
        """Find the least pressure angle, of the return, and the greatest, of the rise [rad]."""
        def angle(s: Array, s1: Array, _: Array) -> Array:
            return np.asarray(np.arctan2(s1, self.base + s), dtype=np.float64)
        return self._least(angle, 1.0), self._least(angle, -1.0)

    @cached_property
    def max_pressure_angle(self) -> Peak:
        """Find the pressure angle that is largest in magnitude, with its sign [rad]."""
        return max(reversed(self.pressure_angles), key=lambda peak: abs(peak.value))

    @cached_property
    def pitch_curvatures(self) -> tuple[Peak, Peak]:
        """Find the least and the greatest pitch curvature, steps taken from both sides [1/m]."""
        def curvature(s: Array, s1: Array, s2: Array) -> Array:
            return _curvature(self.base + s, s1, s2)
        return self._least(curvature, 1.0), self._least(curvature, -1.0)

    @cached_property
    def least_contour_radius(self) -> Peak:
        """
        Find the least radius of curvature of the contour where it bulges [m].

        At or below zero the roller undercuts: the contour has a cusp or a loop, and the
        follower does not reach its travel. Hollow stretches, however tight, never undercut.
        """
        tightest = self.pitch_curvatures[1]
        return Peak(1.0 / tightest.value - self.roller_radius, tightest.at)

    @property
    def undercuts(self) -> bool:
        """Whether the roller undercuts the contour."""
        return self.least_contour_radius.value <= 0.0

    def _least(self, function: Callable[[Array, Array, Array], Array], sign: float) -> Peak:
        """Find the least (sign 1) or greatest (sign -1) value of a function of s, s', s''."""
        curve = self.profile.curve
        best = Peak(math.inf, 0.0)
        for begin, piece in zip(curve.breaks, curve.pieces):
            found = _least_in(piece, lambda *s: sign * function(*s))
            if found.value < best.value:
                best = Peak(found.value, begin + found.at)
        return Peak(sign * best.value, best.at)


def _least_in(piece: Piece, function: Callable[[Array, Array, Array], Array]) -> Peak:
    """Find the least value within a piece, its ends from inside."""
    slope = piece.derivative
    bend = slope.derivative

    def at(u: Array) -> Array:
        return function(piece(u), slope(u), bend(u))

    u = np.linspace(0.0, piece.length, _DENSE)
    values = at(u)
    best = Peak(float(np.min(values)), float(u[np.argmin(values)]))
    inner = (values[1:-1] < values[:-2]) & (values[1:-1] <= values[2:])
    for k in np.flatnonzero(inner) + 1:
        found = minimize_scalar(
            lambda x: float(at(np.array([x]))[0]), bounds=(u[k - 1], u[k + 1]),
            method='bounded', options={'xatol': _PLACED * piece.length})
        if found.fun < best.value:
            best = Peak(float(found.fun), float(found.x))
    return best


def _curvature(radius: Array, slope: Array, bend: Array) -> Array:
    """Give the curvature of r(q) in polar coordinates, (r² + 2 r'² - r r'') / (r² + r'²)^1.5."""
    square = radius ** 2 + slope ** 2
    return np.asarray(
        (square + slope ** 2 - radius * bend) / square ** 1.5, dtype=np.float64)
