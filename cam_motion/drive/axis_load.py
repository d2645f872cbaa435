# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
The load of an axis at the shaft that moves it, built from the same parts as that of a cam shaft.

A drive that follows an axis has no cam: the load shaft stands for the cam shaft, and the axis for
the follower, which moves by the same travel for every radian, s' = radius and s'' = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
import math
from typing import Any, NamedTuple

from cam_motion.drive.load import Follower, Friction, Part
from cam_motion.units import TURN

UNKNOWN = math.nan
"""Angle of the master shaft where it is not known: what acts in a window then does not act."""


class LoadLaw(NamedTuple):
    """
    What a load takes from its shaft at one place: J a + C w² + D w + P, and F against the motion.

    Inertia J [kg m²], C = dJ/dq / 2 [kg m²/rad], damping D [N m s/rad], pull P against the
    positive direction [N m] and Coulomb friction F [N m]: floats, or arrays of one shape.
    """

    inertia: Any
    centripetal: Any = 0.0
    damping: Any = 0.0
    pull: Any = 0.0
    friction: Any = 0.0

    def torque(self, velocity: Any, acceleration: Any, sense: Any) -> Any:
        """
        Compute the torque that a motion takes.

        Parameters
        ----------
        velocity, acceleration : float or ndarray
            Of the shaft [rad/s, rad/s²].
        sense : float or ndarray
            Sign of the motion: 1, -1, or 0 at rest.

        Returns
        -------
        float or ndarray
            Torque [N m].

        """
        return (self.inertia * acceleration + self.pull + self.friction * sense
                + (self.centripetal * velocity + self.damping) * velocity)


def add_parts(bare: LoadLaw, parts: Sequence[Part], radius: float, position: Any,
              shaft_angle: Any) -> LoadLaw:
    """
    Add the parts of a load to what a shaft has to move anyway.

    Parameters
    ----------
    bare : LoadLaw
        What it has to move without them.
    parts : Sequence[Part]
        The parts, as a cam shaft has them.
    radius : float
        Travel of the axis per radian of the load shaft [unit/rad].
    position : float or ndarray
        Position of the axis [unit].
    shaft_angle : float or ndarray
        Angle of the master shaft, over which windows lie [rad, unwrapped]; `UNKNOWN` where it is
        not known.

    Returns
    -------
    LoadLaw
        The sum; NaN where a part is not defined.

    Notes
    -----
    A part counts its Coulomb friction as Q0 = -F |s'|, for a shaft that turns forwards; here it
    is told apart, as the load shaft of an axis turns both ways.

    """
    inertia, centripetal, damping, pull, friction = bare
    at = Follower(shaft_angle % TURN, position, radius, 0.0)
    for part in parts:
        terms = part.terms(at)
        inertia = inertia + terms.inertia
        centripetal = centripetal + terms.centripetal
        damping = damping - terms.damping
        if isinstance(part, Friction):
            friction = friction + part.coulomb * radius
        else:
            pull = pull - terms.force
    return LoadLaw(inertia, centripetal, damping, pull, friction)
