# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a law does at its ends: the four kinds of boundary condition of VDI 2143."""

from __future__ import annotations

from enum import Enum

_ROUNDING = 1e-9  # values below this share of the curve's own peak are zero


class Boundary(Enum):
    """
    The state of motion at one end of a law.

    References
    ----------
    VDI 2143 sheet 1 (1980): rest R, constant velocity G, turn U, motion B.

    """

    REST = 'rest'
    CONSTANT_VELOCITY = 'constant velocity'
    TURN = 'turn'
    MOTION = 'motion'

    @property
    def moves(self) -> bool:
        """Whether there is a velocity."""
        return self in (Boundary.CONSTANT_VELOCITY, Boundary.MOTION)

    @classmethod
    def of(cls, velocity: float, acceleration: float,
           largest_velocity: float, largest_acceleration: float) -> Boundary:
        """
        Tell the kind of a boundary condition.

        Parameters
        ----------
        velocity, acceleration : float
            First and second derivative at the end, in any unit.
        largest_velocity, largest_acceleration : float
            Largest magnitudes over the whole curve, against which rounding is judged.

        Returns
        -------
        Boundary
            The kind.

        """
        moves = abs(velocity) > _ROUNDING * largest_velocity
        bends = abs(acceleration) > _ROUNDING * largest_acceleration
        if moves:
            return cls.MOTION if bends else cls.CONSTANT_VELOCITY
        return cls.TURN if bends else cls.REST
