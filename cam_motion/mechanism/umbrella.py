# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The umbrella of document 003: its description, and its closed forms as an independent check."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import NamedTuple

from cam_motion.errors import DomainError
from cam_motion.mechanism.linkage import Body, Linkage, Loop, Point, Transmission, Vector
from cam_motion.units import DEGREE


class UmbrellaAngles(NamedTuple):
    """
    One figure for each of the four links, angles [rad] or angular velocities [rad/s].

    Attributes
    ----------
    link2, link3, link5, link6 : float
        The links in the numbers of the document.

    """

    link2: float
    link3: float
    link5: float
    link6: float


@dataclass(frozen=True)
class Umbrella:
    """
    The umbrella with two inputs: h1 moves the slider, h2 is let out by the spool of a crank.

    Attributes
    ----------
    l2, d1, l3, d4, l5, l6 : float
        Lengths [m]. The document gives none; these close.

    References
    ----------
    Document 003, whose ω5 is printed with the wrong sign and without ω3 in both terms of d4; the
    derivative of its own second loop gives what stands here.

    """

    l2: float = 1.0
    d1: float = 1.2
    l3: float = 2.6
    d4: float = 0.9
    l5: float = 0.6
    l6: float = 0.1

    def linkage(self) -> Linkage:
        """
        Describe the umbrella as vector loops.

        Returns
        -------
        Linkage
            Inputs h1 and h2, unknowns theta2, theta3, theta5 and theta6, the branch of the
            document's drawing: at h1 = 1 m, h2 = 0.8 m.

        """
        turn = 90.0 * DEGREE
        return Linkage(
            'umbrella',
            bodies=tuple(Body(f'link{k}', f'theta{k}') for k in (2, 3, 5, 6)),
            vectors=(
                Vector('slide', 'h1', turn=turn), Vector('L2', self.l2, 'link2'),
                Vector('d1', self.d1, 'link3'), Vector('L3', self.l3, 'link3'),
                Vector('d4', self.d4, 'link3'), Vector('L5', self.l5, 'link5'),
                Vector('L6', self.l6, 'link6'), Vector('stretch', 'h2', 'link6', -turn)),
            loops=(Loop('rib', ('d1', '-L2', '-slide')),
                   Loop('tip', ('d4', 'L6', 'stretch', 'L5'))),
            points=(
                Point('A'), Point('B', ('-slide',), 'A'), Point('C', ('L2',), 'A'),
                Point('G', ('L3',), 'B'), Point('F', ('L6',), 'G'), Point('E', ('stretch',), 'F'),
                Point('D', ('L5',), 'E')),
            inputs=('h1', 'h2'), unknowns=('theta2', 'theta3', 'theta5', 'theta6'),
            start={'h1': 1.0, 'h2': 0.8, 'theta2': -16.3 * DEGREE, 'theta3': 36.9 * DEGREE,
                   'theta5': -81.9 * DEGREE, 'theta6': -101.0 * DEGREE},
            transmissions=(Transmission('rib_angle', ('d1',), ('L2',)),
                           Transmission('tip_angle', ('L6', 'stretch'), ('L5',))))

    @property
    def ranges(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """
        Give the bounds of h1 and h2 [m], at which two links are in line.

        h1 is a side of the triangle with d1 and L2, √(L6² + h2²) one of that with d4 and L5.
        """
        return ((abs(self.d1 - self.l2), self.d1 + self.l2),
                (math.sqrt(max(0.0, (self.d4 - self.l5) ** 2 - self.l6 ** 2)),
                 math.sqrt(max(0.0, (self.d4 + self.l5) ** 2 - self.l6 ** 2))))

    def angles(self, h1: float, h2: float) -> UmbrellaAngles:
        """
        Give the angles of the links by the law of cosines.

        Parameters
        ----------
        h1, h2 : float
            The inputs [m].

        Returns
        -------
        UmbrellaAngles
            Angles, each in (-π, π] [rad].

        Raises
        ------
        DomainError
            When the loops do not close.

        """
        for name, value, (low, high) in zip(('h1', 'h2'), (h1, h2), self.ranges):
            if not low < value < high:
                raise DomainError(f'{name} = {value:g} m: must be above {low:g} and below '
                                  f'{high:g} m')
        theta3 = math.asin((self.d1 ** 2 + h1 ** 2 - self.l2 ** 2) / (2.0 * self.d1 * h1))
        theta2 = math.atan2(self.d1 * math.sin(theta3) - h1, self.d1 * math.cos(theta3))
        # link 6 and the slide on it are one side of a triangle, turned against the link
        side = math.hypot(self.l6, h2)
        psi = theta3 + math.acos(
            (self.l5 ** 2 - self.d4 ** 2 - side ** 2) / (2.0 * self.d4 * side))
        theta5 = math.atan2(-self.d4 * math.sin(theta3) - side * math.sin(psi),
                            -self.d4 * math.cos(theta3) - side * math.cos(psi))
        theta6 = psi + math.atan2(h2, self.l6)
        return UmbrellaAngles(theta2, theta3, theta5, math.remainder(theta6, math.tau))

    def angular_velocities(self, h1: float, h2: float, h1_dot: float, h2_dot: float,
                           ) -> UmbrellaAngles:
        """
        Give the angular velocities of the links by the document's closed forms, ω5 corrected.

        Parameters
        ----------
        h1, h2 : float
            The inputs [m].
        h1_dot, h2_dot : float
            Their rates [m/s].

        Returns
        -------
        UmbrellaAngles
            Angular velocities [rad/s].

        """
        t2, t3, t5, t6 = self.angles(h1, h2)
        omega2 = h1_dot * math.sin(t3) / (self.l2 * math.sin(t2 - t3))
        omega3 = h1_dot * math.sin(t2) / (self.d1 * math.sin(t2 - t3))
        lever = self.l6 * math.sin(t5 - t6) + h2 * math.cos(t5 - t6)
        omega6 = (h2_dot * math.sin(t5 - t6) + self.d4 * omega3 * math.sin(t3 - t5)) / lever
        omega5 = (h2 * h2_dot - self.d4 * omega3 * (
            self.l6 * math.sin(t3 - t6) + h2 * math.cos(t3 - t6))) / (self.l5 * lever)
        return UmbrellaAngles(omega2, omega3, omega5, omega6)
