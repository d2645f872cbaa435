# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What comes into line in a singular position of a linkage."""

from __future__ import annotations

from dataclasses import dataclass

from cam_motion.mechanism.linkage import Linkage
from cam_motion.mechanism.loops import LoopEquations
from cam_motion.motion.piece import Array
import numpy as np

_TAKES_PART = 1e-3  # least share of a singular vector that is more than rounding


@dataclass(frozen=True)
class Singularity:
    """
    A singular position: some unknowns can move although all inputs are held.

    Attributes
    ----------
    loops, unknowns : tuple[str, ...]
        The loops that no longer determine their unknowns, and these.
    text : str
        What happens there, in words.

    """

    loops: tuple[str, ...]
    unknowns: tuple[str, ...]
    text: str

    @classmethod
    def nearest(cls, linkage: Linkage, equations: LoopEquations, z: Array) -> Singularity:
        """
        Name the singular position that is nearest, by the least singular value.

        Parameters
        ----------
        linkage : Linkage
            The linkage.
        equations : LoopEquations
            Its equations.
        z : ndarray, shape (n,)
            The variables close to the singular position [m, rad].

        Returns
        -------
        Singularity
            Its name.

        """
        given = len(linkage.inputs)
        jacobian = (equations.jacobian(z) * equations.units / equations.size)[:, given:]
        left, _, right = np.linalg.svd(jacobian)
        count = len(linkage.loops)
        # a loop takes part where a force in it moves nothing, an unknown where it moves freely
        force = np.hypot(left[:count, -1], left[count:, -1])
        moves = np.abs(right[-1])
        tied = np.hypot(jacobian[:count], jacobian[count:])
        part = (tied > _TAKES_PART) & (force > _TAKES_PART)[:, None] & (moves > _TAKES_PART)
        loops = tuple(loop.name for loop, takes in zip(linkage.loops, part.any(axis=1)) if takes)
        unknowns = tuple(name for name, takes in zip(linkage.unknowns, part.any(axis=0)) if takes)
        return cls(loops, unknowns, _text(linkage, loops, unknowns))


def _text(linkage: Linkage, loops: tuple[str, ...], unknowns: tuple[str, ...]) -> str:
    owner = {body.angle: body.name for body in linkage.bodies}
    where = f'in loop {", ".join(loops)}'
    turning = [owner[name] for name in unknowns if name in owner]
    sliding = [name for name in unknowns if name not in owner]
    if len(turning) == 2 and not sliding:
        return f'{turning[0]} and {turning[1]} come into line {where}'
    if len(turning) == 1 and len(sliding) == 1:
        return f'{turning[0]} comes square to the slide {sliding[0]} {where}'
    return f'{", ".join(turning + sliding)} can move {where} although all inputs are held'
