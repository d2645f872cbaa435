# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Cam followers with a roller, on a line of travel or on an arm."""

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
class _Roller:
    """What the followers with a roller have in common."""

    base_radius: float
    roller_radius: float

    @property
    def is_flat(self) -> bool:
        """Whether it touches the disc with a flat face: no."""
        return False

    @property
    def prime_radius(self) -> float:
        """Sum the distance of the roller's centre from the shaft at the cam's zero [m]."""
        return self.base_radius + self.roller_radius

    def _place(self, y: Array) -> tuple[Points, Points, Points]:
        """Give the roller's centre and its derivatives with respect to the coordinate."""
        raise NotImplementedError

    def contact(self, at: Follower, sense: int) -> Contact:
        """
        Give the contact with the disc.

        Parameters
        ----------
        at : Follower
            Coordinate and derivatives.
        sense : int
            +1 where the disc turns counterclockwise, -1 clockwise.

        Returns
        -------
        Contact
            The contact.

        Notes
        -----
        The roller's centre P(q) moves over the disc, seen in the machine, with P' - i sense P and
        bends with P'' - 2 i sense P' - P; the contour lies one roller radius beside its path.

        """
        centre, by_y, by_yy = self._place(at.s)
        turn = 1j * sense
        velocity = by_y * at.s1
        over_disc = velocity - turn * centre
        bent = by_y * at.s2 + by_yy * at.s1 ** 2 - 2.0 * turn * velocity - centre
        length = np.abs(over_disc)
        normal = turn * over_disc / length
        curvature = -sense * (np.conj(over_disc) * bent).imag / length ** 3
        drive = np.conj(over_disc) * by_y
        one = np.ones_like(length)
        return Contact(
            centre, centre - self.roller_radius * normal, normal,
            over_disc * (1.0 - self.roller_radius * curvature), curvature, one,
            sense * drive.imag / length, np.arctan2(drive.real, sense * drive.imag), 0.0 * one)


@dataclass(frozen=True)
class TranslatingRoller(_Roller):
    """
    A roller that travels along a line beside or through the shaft.

    Attributes
    ----------
    base_radius : float
        Least distance of disc and shaft at zero travel, without the roller [m].
    roller_radius : float
        Radius of the roller; 0 for a knife edge [m].
    offset : float
        Distance of its line of travel from the shaft, towards +x [m].

    References
    ----------
    Document 004 b) for the in-line roller. R. L. Norton, Cam Design and Manufacturing Handbook
    (2nd ed. 2009), pressure angle of the radial roller follower, tan(alpha) = (v - offset) /
    (s + d), d² = prime radius² - offset². VDI 2142 part 1 (1994) for both senses.

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

    @property
    def height(self) -> float:
        """Give the height of the roller's centre over the shaft at zero travel [m]."""
        return math.sqrt(self.prime_radius ** 2 - self.offset ** 2)

    def _place(self, y: Array) -> tuple[Points, Points, Points]:
        zero = np.zeros(np.shape(y), dtype=np.complex128)
        centre: Points = zero + self.offset
        centre += 1j * (self.height + y)
        return centre, zero + 1j, zero

    def problems(self, profile: CamProfile, sense: int) -> list[Problem]:
        """Find what makes it no follower of this profile."""
        problems = figure_problems(self)
        if not problems and abs(self.offset) >= self.prime_radius:
            problems.append(Problem(
                'offset', self.offset, 'the line of travel must pass the shaft closer than the '
                f'roller at rest, {self.prime_radius:g} m', 'a smaller offset, or a larger '
                'base_radius'))
        if problems:
            return problems
        least = reach_of(profile)[0]
        if self.height + least.value <= 0.0:
            needed = math.hypot(least.value, self.offset) - self.roller_radius
            problems.append(Problem(
                'base_radius', self.base_radius, f'the follower goes {-least.value:g} m inwards '
                f'at {least.at / DEGREE:.6g} deg, to the centre of the shaft',
                f'take more than {needed:.6g} m'))
        return problems

    def base_radii(self, profile: CamProfile) -> Array:
        """Spread base radii over all that could be thought of, rising."""
        least = reach_of(profile)[0].value
        inner = max(math.hypot(min(least, 0.0), self.offset) - self.roller_radius, 0.0)
        return inner + spread_sizes(profile, self.roller_radius + abs(self.offset))


@dataclass(frozen=True)
class SwingingRoller(_Roller):
    """
    A roller on an arm that swings about a bearing.

    Attributes
    ----------
    base_radius : float
        Distance of disc and shaft at the cam's zero, without the roller [m].
    roller_radius : float
        Radius of the roller; 0 for a knife edge [m].
    arm_length : float
        Distance of the roller's centre from the bearing [m].
    pivot_distance : float
        Distance of the bearing from the shaft [m].

    Notes
    -----
    The coordinate is the angle of the arm outwards from where the roller lies on the base
    circle; there the angle between arm and line of centres follows from the triangle of the two
    and the prime radius. With a counterclockwise disc the contour pulls the roller away from
    the bearing (drag arm), with a clockwise one it pushes it towards it.

    References
    ----------
    H. A. Rothbart, Cam Design Handbook (2004), swinging roller follower; VDI 2142 part 1 (1994).

    """

    arm_length: float
    pivot_distance: float

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
        """Give the angle between arm and line of centres at the cam's zero [rad]."""
        # the half angle keeps its digits where the arm is long
        arm, distance = self.arm_length, self.pivot_distance
        square = (self.prime_radius ** 2 - (arm - distance) ** 2) / (4.0 * arm * distance)
        return 2.0 * math.asin(math.sqrt(square))

    def _place(self, y: Array) -> tuple[Points, Points, Points]:
        arm = self.arm_length * np.exp(-1j * (self.base_angle + y))
        return self.pivot_distance - arm, 1j * arm, arm

    def problems(self, profile: CamProfile, sense: int) -> list[Problem]:
        """Find what makes it no follower of this profile."""
        problems = figure_problems(self)
        if problems:
            return problems
        low = abs(self.arm_length - self.pivot_distance)
        high = self.arm_length + self.pivot_distance
        if not low < self.prime_radius < high:
            return [Problem(
                'base_radius', self.base_radius, 'the roller must reach the base circle: arm '
                f'{self.arm_length:g} m, pivot {self.pivot_distance:g} m',
                f'take between {max(low - self.roller_radius, 0.0):.6g} and '
                f'{high - self.roller_radius:.6g} m, or another arm or pivot')]
        for peak in reach_of(profile):
            angle = self.base_angle + peak.value
            if not 0.0 < angle < math.pi:
                problems.append(Problem(
                    'arm_length', self.arm_length, 'the arm must stay clear of the line through '
                    f'shaft and bearing: it would stand at {angle / DEGREE:.6g} deg from it at '
                    f'{peak.at / DEGREE:.6g} deg', 'a smaller stroke, or another arm or pivot'))
        return problems

    def base_radii(self, profile: CamProfile) -> Array:
        """Spread base radii over all that could be thought of, rising."""
        least, greatest = (peak.value for peak in reach_of(profile))
        angles = np.linspace(-min(least, 0.0), math.pi - max(greatest, 0.0), SCANNED + 2)[1:-1]
        arm, distance = self.arm_length, self.pivot_distance
        radii = np.sqrt((arm - distance) ** 2 + 4.0 * arm * distance * np.sin(0.5 * angles) ** 2)
        found: Array = radii - self.roller_radius
        return found[found > 0.0]
