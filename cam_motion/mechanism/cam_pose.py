# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Where the follower of a disc cam stands at one shaft angle, for drawing."""

from __future__ import annotations

from typing import NamedTuple

from cam_motion.mechanism.cam_disc import CamDisc
from cam_motion.mechanism.cam_follower import reach_of

_STEM = 0.6  # of the base radius: how far a stem is drawn behind the stroke


class FollowerPose(NamedTuple):
    """
    A follower at one shaft angle, in the frame of the machine [m].

    Where it touches (``contact``), the roller's centre or the trace point on the face
    (``centre``), the roller's radius or None, the ends of the face or None, the bearing of a
    swinging follower or None (``pivot``), and where its arm or stem ends (``foot``).
    """

    contact: complex
    centre: complex
    roller_radius: float | None
    face: tuple[complex, complex] | None
    pivot: complex | None
    foot: complex


def follower_pose(disc: CamDisc, q: float) -> FollowerPose:
    """
    Place the follower of a disc.

    Parameters
    ----------
    disc : CamDisc
        The disc.
    q : float
        Shaft angle [rad].

    Returns
    -------
    FollowerPose
        Where everything is; the face is as long as the disc ever touches it.

    """
    found, follower = disc.contact(float(q)), disc.follower
    point, centre, face = complex(found.point), complex(found.centre), None
    pivot = follower.pivot
    if follower.is_flat:
        outwards = 1.0 if pivot is None else 1j * complex(found.normal)
        first, last = (
            point + (end.value - float(found.along)) * outwards for end in disc.face_range)
        face = (first, last)
    foot = pivot
    if foot is None:
        low, high = (peak.value for peak in reach_of(disc.profile))
        foot = centre + 1j * (_STEM * disc.base_radius + high - low + follower.roller_radius)
    return FollowerPose(
        point, centre, None if follower.is_flat else follower.roller_radius, face, pivot, foot)
