# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The joint states of a linkage: its variables, and where its moving pieces are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.outline import Outline, Piece
from cam_motion.motion.piece import Array
import numpy as np


class Joint(NamedTuple):
    """
    A joint that is told beside the variables because one of these moves it too.

    Attributes
    ----------
    name : str
        Its name.
    variable : str
        The variable that it is equal to.

    """

    name: str
    variable: str


def repeated_joints(outline: Outline) -> dict[str, Joint]:
    """
    Name the joints of pieces and slides whose variable moves another one before them.

    Parameters
    ----------
    outline : Outline
        The pieces.

    Returns
    -------
    dict[str, Joint]
        Joints by the name of the piece or the slide.

    """
    moved = [(piece.name, piece.angle) for piece in outline.pieces if piece.angle] + [
        (slide.name, slide.variable) for piece in outline.pieces for slide in piece.slides]
    variables = [variable for _, variable in moved]
    return {name: Joint(f'{name}_joint', variable)
            for k, (name, variable) in enumerate(moved) if variable in variables[:k]}


def origin_joints(piece: Piece) -> tuple[str, str]:
    """
    Name the two joints by which the origin of a moving piece moves along x and y.

    Parameters
    ----------
    piece : Piece
        The piece.

    Returns
    -------
    tuple[str, str]
        Their names.

    """
    return f'{piece.name}_x', f'{piece.name}_y'


class LinkageJoints:
    """
    Positions and velocities of all joints, and the efforts that hold loads.

    Parameters
    ----------
    assembly : Assembly
        The linkage.
    outline : Outline
        Its pieces.
    forces : Mapping[str, complex]
        Forces on points that the inputs hold, x + j y [N]; empty for none.
    torques : Mapping[str, float], optional
        Loads along variables that they hold: torques on angles [N m], forces along lengths [N].

    Attributes
    ----------
    names : tuple[str, ...]
        Names of the joints: the inputs, the unknowns, x and y of the origin of each piece whose
        origin moves, and what `repeated_joints` names.

    """

    def __init__(self, assembly: Assembly, outline: Outline,
                 forces: Mapping[str, complex],
                 torques: Mapping[str, float] | None = None) -> None:
        """Gather what moves."""
        self._equations = assembly.equations
        self._inputs = len(assembly.linkage.inputs)
        moving = [piece for piece in outline.pieces if piece.moves]
        repeated = repeated_joints(outline).values()
        variables = assembly.linkage.variables
        self.names = (*variables, *(name for piece in moving for name in origin_joints(piece)),
                      *(joint.name for joint in repeated))
        self._repeated = [variables.index(joint.variable) for joint in repeated]
        self._origins, self._slopes = self._equations.compiled(np.array(
            [piece.origin for piece in moving]).reshape(
                len(moving), len(assembly.linkage.vectors)))
        self._count = len(moving)
        # the power of the loads: this sum over the velocities of the vectors, and the second one
        # over the rates of the variables
        self._loaded = bool(forces or torques)
        self._force = sum(
            (np.conj(forces[point.name]) * row for point, row in zip(
                assembly.linkage.points, self._equations.points) if point.name in forces),
            np.zeros(len(assembly.linkage.vectors), dtype=np.complex128))
        self._torque = np.array([(torques or {}).get(name, 0.0) for name in variables])

    def at(self, values: Array, rates: Array, gain: Array,
           ) -> tuple[list[float], list[float], list[float]]:
        """
        Give the joint states of a position.

        Parameters
        ----------
        values, rates : ndarray, shape (n,)
            The variables, inputs first [m, rad], and their rates [m/s, rad/s].
        gain : ndarray, shape (u, inputs)
            How the unknowns follow the inputs.

        Returns
        -------
        tuple[list[float], list[float], list[float]]
            Positions, velocities and efforts; efforts are none without loads, else those of the
            inputs by virtual work [N m, N], and 0 for all other joints.

        """
        positions, velocities = values.tolist(), rates.tolist()
        origins, count = self._origins(positions), self._count
        slopes = np.array(self._slopes(positions)).reshape(2 * count, len(positions))
        speeds = (slopes @ rates).tolist()
        for k in range(count):
            positions += (origins[k], origins[count + k])
            velocities += (speeds[k], speeds[count + k])
        positions += [positions[k] for k in self._repeated]
        velocities += [velocities[k] for k in self._repeated]
        if not self._loaded:
            return positions, velocities, []
        power = np.real(self._force @ self._equations.slopes(values)) + self._torque
        efforts = [0.0] * len(self.names)
        efforts[:self._inputs] = (-(power[:self._inputs] + power[self._inputs:] @ gain)).tolist()
        return positions, velocities, efforts
