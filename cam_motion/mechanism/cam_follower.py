# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
The followers of a disc cam: where each touches the disc, and how the contour bends there.

All lengths are in m, all points complex numbers x + iy in the frame of the machine: the shaft
turns about 0; a translating follower travels along +y, a swinging one has its bearing on +x and
its roller or face to the left of it, above the line from the bearing to the shaft. ``sense`` is
+1 where the disc turns counterclockwise and -1 where it turns clockwise.
"""

from __future__ import annotations

from dataclasses import fields
from functools import lru_cache
import math
from typing import Any, NamedTuple, Protocol

from cam_motion.drive.load import Follower
from cam_motion.errors import Problem
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Peak
from cam_motion.motion.profile import CamProfile
import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.complex128]
"""Points of the plane, x + iy [m]."""

SCANNED = 160
"""Base radii among which the smallest usable one is looked for."""

_DECADES = 3.0  # of base radii, on either side of the size of the motion
_MAY_BE_ZERO = {'roller_radius'}
_ANY_SIGN = {'offset', 'face_offset'}


class Contact(NamedTuple):
    """
    The contact of disc and follower at given shaft angles, in the frame of the machine.

    ``centre`` is the roller's centre (on a flat face: its trace point), ``point`` where they
    touch, ``normal`` the unit normal from the disc to the follower, ``tangent`` the derivative of
    the contour with respect to the shaft angle, turned into the machine. The curvature of the
    contour, positive where it bulges, is ``bend / (span - roller_radius * bend)``; that of the
    path of the roller's centre ``bend / span``. Of a roller ``span`` is 1, of a flat face
    ``bend`` is 1, so that neither a straight nor a pointed place divides by zero. ``reach`` is the
    speed of the follower along the normal by that of its coordinate (1 or m/rad), ``pressure``
    the pressure angle [rad], positive while the follower goes outwards, and ``along`` where a flat
    face is touched, from its reference outwards [m].
    """

    centre: Points
    point: Points
    normal: Points
    tangent: Points
    bend: Array
    span: Array
    reach: Array
    pressure: Array
    along: Array


class CamFollower(Protocol):
    """A follower of a disc cam, with what it takes to touch one."""

    @property
    def base_radius(self) -> float:
        """Give the distance of the disc from the shaft at the cam's zero [m]."""

    @property
    def roller_radius(self) -> float:
        """Give the radius of the roller; 0 of a knife edge and of a flat face [m]."""

    @property
    def swings(self) -> bool:
        """Whether its coordinate is an angle [rad] and not a travel [m]."""

    @property
    def is_flat(self) -> bool:
        """Whether it touches the disc with a flat face."""

    @property
    def pivot(self) -> complex | None:
        """Give the bearing; None of a translating follower [m]."""

    def contact(self, at: Follower, sense: int) -> Contact:
        """
        Give the contact with the disc.

        Parameters
        ----------
        at : Follower
            Coordinate and its derivatives with respect to the shaft angle, outwards.
        sense : int
            +1 where the disc turns counterclockwise, -1 clockwise.

        Returns
        -------
        Contact
            The contact.

        """

    def problems(self, profile: CamProfile, sense: int) -> list[Problem]:
        """
        Find what makes it no follower of a profile.

        Parameters
        ----------
        profile : CamProfile
            The profile.
        sense : int
            Sense of rotation.

        Returns
        -------
        list[Problem]
            Everything that is wrong.

        """

    def base_radii(self, profile: CamProfile) -> Array:
        """
        Spread base radii over all that could be thought of.

        Parameters
        ----------
        profile : CamProfile
            The profile.

        Returns
        -------
        ndarray, shape (n,)
            Base radii, rising [m].

        """


@lru_cache(maxsize=64)
def reach_of(profile: CamProfile, order: int = 0) -> tuple[Peak, Peak]:
    """
    Find the least and the greatest value of a profile, and remember them.

    Parameters
    ----------
    profile : CamProfile
        The profile.
    order : int
        Order of the derivative.

    Returns
    -------
    tuple[Peak, Peak]
        Least and greatest [m/rad^order, rad/rad^order], with their shaft angles [rad].

    """
    return profile.curve.extremes(order)


def figure_problems(follower: Any) -> list[Problem]:
    """
    Refuse figures of a follower that are no lengths.

    Parameters
    ----------
    follower : dataclass
        The follower, all of its fields lengths [m].

    Returns
    -------
    list[Problem]
        Everything that is wrong.

    """
    problems = []
    for field in fields(follower):
        name, value = field.name, getattr(follower, field.name)
        if name in _ANY_SIGN:
            rule, sound = 'must be a finite number', True
        elif name in _MAY_BE_ZERO:
            rule, sound = 'must be a finite number of at least 0', value >= 0.0
        else:
            rule, sound = 'must be a finite number above 0', value > 0.0
        if not (math.isfinite(value) and sound):
            problems.append(Problem(name, value, rule))
    return problems


def spread_sizes(profile: CamProfile, further: float) -> Array:
    """
    Spread lengths over the sizes that matter beside a motion.

    Parameters
    ----------
    profile : CamProfile
        The motion.
    further : float
        A further length that matters [m].

    Returns
    -------
    ndarray, shape (n,)
        Lengths, rising [m].

    """
    size = further + sum(abs(peak.value) for order in (0, 1, 2)
                         for peak in reach_of(profile, order))
    return (size or 1.0) * np.logspace(-_DECADES, _DECADES, SCANNED)
