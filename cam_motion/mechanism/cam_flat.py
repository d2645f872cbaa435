# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Cam followers with a flat face, on a line of travel or on an arm."""

from __future__ import annotations

from dataclasses import dataclass
import math

from cam_motion.drive.load import Follower
from cam_motion.errors import Problem
from cam_motion.mechanism.cam_follower import (
    Contact,
    figure_problems,
    Points,
    reach_of,
    SCANNED,
    spread_sizes,
)
from cam_motion.motion.piece import Array
from cam_motion.motion.profile import CamProfile
from cam_motion.units import DEGREE
import numpy as np


@dataclass(frozen=True)
class _Flat:
    """What the followers with a flat face have in common: the contour is the face's envelope."""

    base_radius: float

    @property
    def is_flat(self) -> bool:
        """Whether it touches the disc with a flat face: yes."""
        return True

    @property
    def roller_radius(self) -> float:
        """Give the radius of the roller: none."""
        return 0.0


def _envelope(distance: tuple[Array, Array, Array], normal: Points, turning: Array,
              turning_slope: Array) -> tuple[Points, Array, Points]:
    """
    Give the envelope of a line from its distance to the shaft, the derivatives by q behind it.

    ``turning`` is the derivative of the angle of its normal on the disc. With h over that angle
    the envelope is h n + h' i n, and its radius of curvature h + h'' (support function; I. M.
    Yaglom, V. G. Boltyanskii, Convex Figures, 1961).
    """
    h, slope, bend = distance
    first = slope / turning
    second = (bend * turning - slope * turning_slope) / turning ** 3
    radius = h + second
    return normal * (h + 1j * first), radius, 1j * normal * radius * turning


@dataclass(frozen=True)
class TranslatingFlat(_Flat):
    """
    A mushroom: a flat face square to the line on which it travels.

    Attributes
    ----------
    base_radius : float
        Distance of the face from the shaft at zero travel [m].
    offset : float
        Distance of the stem from the shaft, towards +x; the contour does not depend on it [m].

    References
    ----------
    R. L. Norton, Cam Design and Manufacturing Handbook (2nd ed. 2009), flat-faced follower: radius
    of curvature rho = base radius + s + s'', the contact lies s' beside the shaft, so that the
    face is at least max(s') - min(s') wide.

    """

    offset: float = 0.0

    @property
    def swings(self) -> bool:
        """Whether its coordinate is an angle: no."""
        return False

    @property
    def pivot(self) -> complex | None:
        """Give the bearing: it has none."""
        return None

    def contact(self, at: Follower, sense: int) -> Contact:
        """
        Give the contact with the disc.

        Parameters
        ----------
        at : Follower
            Travel and derivatives.
        sense : int
            Sense of rotation.

        Returns
        -------
        Contact
            The contact; ``along`` counts from the stem towards +x.

        """
        zero = np.zeros(np.shape(at.s))
        normal: Points = np.full(np.shape(at.s), 1j)
        h = self.base_radius + at.s
        point, radius, tangent = _envelope((h, at.s1, at.s2), normal, zero - sense, zero)
        along: Array = np.asarray(point.real - self.offset, dtype=np.float64)
        centre = np.asarray(self.offset + 1j * h, dtype=np.complex128)
        return Contact(centre, point, normal, tangent, zero + 1.0, radius,
                       zero + 1.0, zero, along)

    def problems(self, profile: CamProfile, sense: int) -> list[Problem]:
        """Find what makes it no follower of this profile."""
        problems = figure_problems(self)
        least = reach_of(profile)[0]
        if not problems and self.base_radius + least.value <= 0.0:
            problems.append(Problem(
                'base_radius', self.base_radius, f'the follower goes {-least.value:g} m inwards '
                f'at {least.at / DEGREE:.6g} deg, to the centre of the shaft',
                f'take more than {-least.value:.6g} m'))
        return problems

    def base_radii(self, profile: CamProfile) -> Array:
        """Spread base radii over all that could be thought of, rising."""
        return max(-reach_of(profile)[0].value, 0.0) + spread_sizes(profile, 0.0)


@dataclass(frozen=True)
class SwingingFlat(_Flat):
    """
    A flat face that swings about a bearing.

    Attributes
    ----------
    base_radius : float
        Distance of the face from the shaft at the cam's zero [m].
    pivot_distance : float
        Distance of the bearing from the shaft [m].
    face_offset : float
        Distance of the face from the bearing, towards the disc [m].

    References
    ----------
    H. A. Rothbart, Cam Design Handbook (2004), swinging flat-faced follower; VDI 2142 part 1
    (1994).

    """

    pivot_distance: float
    face_offset: float = 0.0

    @property
    def swings(self) -> bool:
        """Whether its coordinate is an angle: yes."""
        return True

    @property
    def pivot(self) -> complex | None:
        """Give the bearing."""
        return complex(self.pivot_distance)

    @property
    def base_angle(self) -> float:
        """Give the angle between face and line of centres at the cam's zero [rad]."""
        return math.asin((self.base_radius + self.face_offset) / self.pivot_distance)

    def contact(self, at: Follower, sense: int) -> Contact:
        """
        Give the contact with the disc.

        Parameters
        ----------
        at : Follower
            Angle and derivatives.
        sense : int
            Sense of rotation.

        Returns
        -------
        Contact
            The contact; ``along`` counts from the foot of the bearing on the face.

        """
        angle = self.base_angle + at.s
        sine, cosine = self.pivot_distance * np.sin(angle), self.pivot_distance * np.cos(angle)
        normal = np.exp(1j * (0.5 * math.pi - angle))
        turning = -(at.s1 + sense)
        point, radius, tangent = _envelope(
            (sine - self.face_offset, cosine * at.s1, cosine * at.s2 - sine * at.s1 ** 2),
            normal, turning, -at.s2)
        along = -sense * cosine / turning
        first = self.pivot_distance * math.cos(self.base_angle)
        centre = self.pivot_distance + normal * (1j * first - self.face_offset)
        return Contact(centre, point, normal, tangent, np.ones_like(angle), radius, along,
                       np.arctan2(-sense * self.face_offset + 0.0 * along, along), along)

    def problems(self, profile: CamProfile, sense: int) -> list[Problem]:
        """Find what makes it no follower of this profile."""
        problems = figure_problems(self)
        if problems:
            return problems
        if not abs(self.base_radius + self.face_offset) < self.pivot_distance:
            return [Problem(
                'base_radius', self.base_radius, 'the face must reach the base circle: base '
                'radius and face_offset together less than the pivot distance of '
                f'{self.pivot_distance:g} m',
                f'take less than {self.pivot_distance - self.face_offset:.6g} m')]
        least, greatest = reach_of(profile)
        if self.base_angle + greatest.value >= 0.5 * math.pi:
            problems.append(Problem(
                'pivot_distance', self.pivot_distance, 'the face must stay within 90 deg of the '
                f'line of centres: it would stand at '
                f'{(self.base_angle + greatest.value) / DEGREE:.6g} deg at '
                f'{greatest.at / DEGREE:.6g} deg', 'a larger distance or a smaller stroke'))
        lowest = max(self.base_angle + least.value, -0.5 * math.pi)
        if self.pivot_distance * math.sin(lowest) <= self.face_offset:
            problems.append(Problem(
                'base_radius', self.base_radius, 'the face would come to the centre of the shaft '
                f'at {least.at / DEGREE:.6g} deg', 'a larger base_radius'))
        slope = max(reach_of(profile, 1), key=lambda peak: -sense * peak.value)
        if sense * slope.value <= -1.0:
            problems.append(Problem(
                'profile', slope.value, 'a swinging face must turn slower than the disc '
                f'backwards: it turns {abs(slope.value):.6g} rad per rad at '
                f'{slope.at / DEGREE:.6g} deg', 'a smaller stroke, a longer segment or the other '
                'direction'))
        return problems

    def base_radii(self, profile: CamProfile) -> Array:
        """Spread base radii over all that could be thought of, rising."""
        greatest = max(reach_of(profile)[1].value, 0.0)
        most = self.pivot_distance * math.cos(min(greatest, 0.5 * math.pi)) - self.face_offset
        return np.linspace(0.0, max(most, 0.0), SCANNED + 2)[1:-1]
