# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The disc of a cam: contour, pressure angle and curvature, exact, for any of the followers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
import math

from cam_motion.drive.load import Follower
from cam_motion.errors import ConfigurationError, DomainError, Problem
from cam_motion.mechanism.cam_extremes import extremes
from cam_motion.mechanism.cam_follower import CamFollower, Contact, Points
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Peak
from cam_motion.motion.profile import CamProfile
from cam_motion.units import TURN
import numpy as np
from numpy.typing import ArrayLike

COUNTERCLOCKWISE, CLOCKWISE = 1, -1
"""Senses of rotation, seen so that x points to the right and y upwards."""


@dataclass(frozen=True)
class CamDisc:
    """
    A disc that moves a follower.

    Points on the disc are complex numbers x + iy in a frame fixed to it, which is that of the
    machine at the shaft angle 0 (`turned` takes them there at any other).

    Attributes
    ----------
    profile : CamProfile
        Travel [m] or angle [rad] of the follower over the shaft angle, outwards.
    follower : CamFollower
        The follower, with the base radius.
    sense : int
        `COUNTERCLOCKWISE` or `CLOCKWISE`.

    Raises
    ------
    ConfigurationError
        When the profile does not return, or the follower cannot carry it out.

    References
    ----------
    Document 004 b) for the in-line roller. The contour as a curve beside the path of the
    roller's centre, or as envelope of the face: R. L. Norton, Cam Design and Manufacturing
    Handbook (2nd ed. 2009); VDI 2142 part 1 (1994).

    """

    profile: CamProfile
    follower: CamFollower
    sense: int = COUNTERCLOCKWISE

    def __post_init__(self) -> None:
        """Refuse figures that make no cam."""
        problems = []
        if self.sense not in (COUNTERCLOCKWISE, CLOCKWISE):
            problems.append(Problem('sense', self.sense, 'must be 1 or -1'))
        if self.profile.advance:
            problems.append(Problem(
                'profile', self.profile.advance, 'the travel of a disc cam must return'))
        if not problems:
            problems = self.follower.problems(self.profile, self.sense)
        if problems:
            raise ConfigurationError(problems)

    @property
    def base_radius(self) -> float:
        """Give the radius of the base circle [m]."""
        return self.follower.base_radius

    @property
    def unit(self) -> str:
        """Name the unit of the follower's coordinate."""
        return 'rad' if self.follower.swings else 'm'

    def motion(self, q: ArrayLike) -> Follower:
        """
        Give the follower's coordinate and its derivatives.

        Parameters
        ----------
        q : array_like, any shape
            Shaft angles, unwrapped [rad]; where a derivative steps, the value from the right.

        Returns
        -------
        Follower
            Arrays of the shape of q, the angles within one turn.

        """
        angles = np.asarray(q, dtype=np.float64)
        return Follower(np.mod(angles, TURN), self.profile(angles), self.profile(angles, 1),
                        self.profile(angles, 2))

    def contact(self, q: ArrayLike) -> Contact:
        """
        Give the contact with the follower, in the frame of the machine.

        Parameters
        ----------
        q : array_like, any shape
            Shaft angles [rad]; where s'' steps, the values from the right.

        Returns
        -------
        Contact
            Arrays of the shape of q.

        """
        return self.contact_at(self.motion(q))

    def contact_at(self, at: Follower) -> Contact:
        """
        Give the contact with a follower that is somewhere.

        Parameters
        ----------
        at : Follower
            Where the follower is.

        Returns
        -------
        Contact
            The contact, in the frame of the machine.

        """
        return self.follower.contact(at, self.sense)

    def turned(self, points: ArrayLike, q: ArrayLike) -> Points:
        """
        Turn points of the disc to where they stand in the machine.

        Parameters
        ----------
        points : array_like, complex
            Points on the disc [m].
        q : array_like
            Shaft angles [rad].

        Returns
        -------
        ndarray, complex
            The points in the frame of the machine [m].

        """
        found: Points = np.asarray(points) * np.exp(1j * self.sense * np.asarray(q))
        return found

    def on_disc(self, points: ArrayLike, q: ArrayLike) -> Points:
        """
        Find what points of the machine are on the disc, the reverse of `turned`.

        Parameters
        ----------
        points : array_like, complex
            Points in the frame of the machine [m].
        q : array_like
            Shaft angles [rad].

        Returns
        -------
        ndarray, complex
            The points on the disc [m].

        """
        return self.turned(points, -np.asarray(q))

    def contour(self, q: ArrayLike) -> Points:
        """
        Give the point of the contour that the follower touches.

        Parameters
        ----------
        q : array_like, any shape
            Shaft angles [rad].

        Returns
        -------
        ndarray, complex, shape of q
            Points on the disc [m].

        """
        return self.on_disc(self.contact(q).point, q)

    def outer_flank(self, q: ArrayLike) -> Points:
        """
        Give the point of the other flank of the groove in which the roller runs.

        Parameters
        ----------
        q : array_like, any shape
            Shaft angles [rad].

        Returns
        -------
        ndarray, complex, shape of q
            Points on the disc [m].

        Raises
        ------
        DomainError
            When the follower has a flat face, for which there is no groove.

        """
        if self.follower.is_flat:
            raise DomainError('a flat face runs in no groove')
        found = self.contact(q)
        return self.on_disc(found.centre + self.follower.roller_radius * found.normal, q)

    def pitch(self, q: ArrayLike) -> Points:
        """
        Give the path of the roller's centre over the disc; of a flat face, of its trace point.

        Parameters
        ----------
        q : array_like, any shape
            Shaft angles [rad].

        Returns
        -------
        ndarray, complex, shape of q
            Points on the disc [m].

        """
        return self.on_disc(self.contact(q).centre, q)

    def pressure_angle(self, q: ArrayLike) -> Array:
        """
        Give the angle between the common normal and the way of the follower.

        Parameters
        ----------
        q : array_like, any shape
            Shaft angles [rad].

        Returns
        -------
        ndarray, shape of q
            Angles, positive where the disc drives the follower outwards [rad].

        """
        return self.contact(q).pressure

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
            Curvatures, negative where the path is hollow [1/m]; of a flat face, that of the
            contour.

        """
        found = self.contact(q)
        with np.errstate(divide='ignore'):
            return found.bend / found.span

    def contour_curvature(self, q: ArrayLike) -> Array:
        """
        Give the curvature of the contour.

        Parameters
        ----------
        q : array_like, any shape
            Shaft angles [rad]; where s'' steps, the value from the right.

        Returns
        -------
        ndarray, shape of q
            Curvatures, negative where it is hollow [1/m]; infinite where it is pointed.

        """
        found = self.contact(q)
        with np.errstate(divide='ignore'):
            return found.bend / (found.span - self.follower.roller_radius * found.bend)

    def contour_radius(self, q: ArrayLike) -> Array:
        """
        Give the radius of curvature of the contour.

        Parameters
        ----------
        q : array_like, any shape
            Shaft angles [rad]; where s'' steps, the value from the right.

        Returns
        -------
        ndarray, shape of q
            Radii [m]; infinite where the contour is straight, less than ``-roller_radius`` where
            it is hollow, between that and 0 where the roller undercuts; under a flat face below
            0 where it does not touch.

        """
        found = self.contact(q)
        with np.errstate(divide='ignore'):
            return found.span / found.bend - self.follower.roller_radius

    def extremes(self, value: Callable[[Contact], Array]) -> tuple[Peak, Peak]:
        """
        Find the least and greatest of something that follows from the contact.

        Parameters
        ----------
        value : Callable[[Contact], ndarray]
            Gives it for contacts.

        Returns
        -------
        tuple[Peak, Peak]
            Least and greatest with their (first) shaft angles, steps taken from both sides.

        """
        return extremes(self.profile, lambda at: value(self.contact_at(at)))

    @cached_property
    def pressure_angles(self) -> tuple[Peak, Peak]:
        """Find the least pressure angle, of the return, and the greatest, of the rise [rad]."""
        return self.extremes(lambda found: found.pressure)

    @property
    def max_pressure_angle(self) -> Peak:
        """Find the pressure angle that is largest in magnitude, with its sign [rad]."""
        return max(reversed(self.pressure_angles), key=lambda peak: abs(peak.value))

    @cached_property
    def _bends(self) -> tuple[Peak, Peak]:
        """Find the hollowest and the tightest place of the path, as atan2(R bend, span)."""
        scale = self.base_radius
        return self.extremes(lambda found: np.arctan2(scale * found.bend, found.span))

    @property
    def least_contour_radius(self) -> Peak:
        """
        Find the least radius of curvature of the contour where it bulges [m].

        At or below zero the contour has a cusp or a loop, and the follower does not reach its
        travel. Under a roller, hollow stretches, however tight, never undercut.
        """
        angle, at = self._bends[1]
        # from the angle itself: at the joints it comes from one side only
        return Peak(self.base_radius / math.tan(angle) - self.follower.roller_radius, at)

    @property
    def hollow_contour_radius(self) -> Peak | None:
        """Find the tightest hollow of the contour, its radius below 0 [m]; None without any."""
        angle, at = self._bends[0]
        if angle >= 0.0 or self.follower.is_flat:
            return None
        return Peak(self.base_radius / math.tan(angle) - self.follower.roller_radius, at)

    @property
    def undercuts(self) -> bool:
        """
        Whether the contour is undercut, a mere point included.

        That is where it bends too tightly for itself. Places far from each other are not
        compared: for them to meet, the flanks of a lobe must be all but radial, with pressure
        angles near 90 deg.
        """
        return self.least_contour_radius.value <= 0.0

    @property
    def groove_undercuts(self) -> bool:
        """Whether the outer flank of a groove is undercut: a hollow tighter than the roller."""
        hollow = self.hollow_contour_radius
        return hollow is not None and hollow.value + 2.0 * self.follower.roller_radius >= 0.0

    @cached_property
    def face_range(self) -> tuple[Peak, Peak]:
        """Find the ends of the stretch of a flat face that the disc touches [m]."""
        return self.extremes(lambda found: found.along)

    @cached_property
    def nearest(self) -> float:
        """Find the least distance of the contour from the shaft [m]."""
        return self.extremes(lambda found: np.abs(found.point))[0].value

    @cached_property
    def farthest(self) -> float:
        """Find the greatest distance of the contour from the shaft [m]."""
        return self.extremes(lambda found: np.abs(found.point))[1].value
