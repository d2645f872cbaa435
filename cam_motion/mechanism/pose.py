# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Positions of a linkage, and how far it goes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
import math
from typing import NamedTuple

from cam_motion.errors import CamMotionError, Problem
from cam_motion.mechanism.linkage import Linkage
from cam_motion.mechanism.singular import Singularity
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE, TURN

_EXACT = 1e9  # rad up to which whole turns can be taken off and leave enough digits


@dataclass(frozen=True)
class Certificate:
    """
    The proof that a position is on the branch of the start.

    Attributes
    ----------
    steps : int
        Steps from the start.
    kantorovich : float
        The greatest number of Kantorovich of these steps: up to 1/2, Newton's method converges
        to the only solution near by, for every point of the step.
    orientation : int
        Sign of the Jacobian's determinant; it changes only through a singular position.

    """

    steps: int
    kantorovich: float
    orientation: int


@dataclass(frozen=True)
class Pose:
    """
    One position of a linkage.

    Attributes
    ----------
    linkage : Linkage
        The linkage.
    values : ndarray, shape (n,)
        The variables, inputs first; angles are not wrapped [m, rad].
    clearance : float
        No singular position is nearer than this, all lengths divided by the longest one and
        angles in radians.
    certificate : Certificate
        The proof that it is on the branch.

    """

    linkage: Linkage
    values: Array
    clearance: float
    certificate: Certificate

    def __getitem__(self, variable: str) -> float:
        """Give a variable by its name [m, rad]."""
        return float(self.values[self.linkage.variables.index(variable)])

    @property
    def text(self) -> str:
        """Write the inputs for people."""
        return ', '.join(f'{name} = {bound_text(self.linkage, name, self[name])}'
                         for name in self.linkage.inputs)


class Foothold(NamedTuple):
    """
    A position, and what a step from there needs to know; see `Assembly.step`.

    Attributes
    ----------
    z : ndarray, shape (n,)
        The variables, inputs first [m, rad].
    inverse : ndarray, shape (u, u)
        Inverse of the Jacobian by the unknowns, free of units.
    gain : ndarray, shape (u, inputs)
        How the unknowns follow the inputs, free of units.
    clearance : float
        As of a `Pose`.
    steps : int
        Steps from the start.
    worst : float
        The greatest number of Kantorovich of these.

    """

    z: Array
    inverse: Array
    gain: Array
    clearance: float
    steps: int
    worst: float

    def reaches(self, target: Array) -> bool:
        """
        Tell whether the inputs are those wanted.

        Parameters
        ----------
        target : ndarray, shape (inputs,)
            Inputs [m, rad].

        Returns
        -------
        bool
            Whether they are.

        """
        return bool((self.z[:len(target)] == target).all())


@dataclass(frozen=True)
class Range:
    """
    How far one input goes while the others stay.

    Attributes
    ----------
    low, high : float
        Its bounds, themselves not reached [m, rad]; infinite where nothing stops it.
    at_low, at_high : Singularity | None
        What comes into line there.

    """

    low: float
    high: float
    at_low: Singularity | None
    at_high: Singularity | None


class SingularError(CamMotionError):
    """
    A way leads into a singular position.

    Parameters
    ----------
    pose : Pose
        The last position before it.
    singularity : Singularity
        What comes into line there.

    """

    def __init__(self, pose: Pose, singularity: Singularity) -> None:
        """Keep the position and the name of what happens there."""
        self.pose, self.singularity = pose, singularity
        super().__init__(f'{pose.text} is a singular position: {singularity.text}')


def range_problem(pose: Pose, name: str, value: float, found: Range) -> Problem | None:
    """
    Say that an input is out of its range.

    Parameters
    ----------
    pose : Pose
        Where the other inputs stay.
    name : str
        The input.
    value : float
        Where it is wanted [m, rad].
    found : Range
        How far it goes while the others stay.

    Returns
    -------
    Problem | None
        The problem, its path the name of the input; None within the range.

    """
    beyond = found.at_low if value <= found.low else found.at_high
    if found.low < value < found.high or beyond is None:
        return None
    linkage = pose.linkage
    low, high = (bound_text(linkage, name, x) for x in (found.low, found.high))
    others = others_text(pose, name)
    given = f'with {others} ' if others else ''
    return Problem(
        name, value, f'{given}the linkage can be assembled from {low} to {high}, both ends '
        f'excluded; there {beyond.text}', 'stay within this range')


def others_text(pose: Pose, name: str) -> str:
    """
    Write where the other inputs are, for people.

    Parameters
    ----------
    pose : Pose
        The position.
    name : str
        The input that is left out.

    Returns
    -------
    str
        All other inputs with their values; empty where there are none.

    """
    return ', '.join(f'{other} = {bound_text(pose.linkage, other, pose[other])}'
                     for other in pose.linkage.inputs if other != name)


def together_problem(inputs: Mapping[str, float], stopped: str) -> Problem:
    """
    Say that inputs cannot be reached although none is out of range by itself.

    Parameters
    ----------
    inputs : Mapping[str, float]
        Where they are wanted [m, rad].
    stopped : str
        What stops them.

    Returns
    -------
    Problem
        The problem, its path the names of the inputs.

    """
    return Problem(', '.join(inputs), tuple(inputs.values()), stopped,
                   'give it another start, or go there by way of other inputs')


def whole_turns(linkage: Linkage, name: str, way: float, bounds: Range) -> float:
    """
    Give the part of a way that leads a crank back to where it was, time and again.

    Parameters
    ----------
    linkage : Linkage
        The linkage.
    name : str
        An input.
    way : float
        How far it is to go [m, rad].
    bounds : Range
        How far it can go.

    Returns
    -------
    float
        Whole turns [rad]; 0 for a length, for what cannot turn all the way round, and for a way
        so long that too few digits would be left of it.

    """
    through = bounds.low == -math.inf and bounds.high == math.inf
    if name not in linkage.angles or not through or not abs(way) < _EXACT:
        return 0.0
    return TURN * round(way / TURN)


def bound_text(linkage: Linkage, name: str, value: float) -> str:
    """
    Write a value of a variable for people.

    Parameters
    ----------
    linkage : Linkage
        The linkage.
    name : str
        The variable.
    value : float
        Its value [m, rad].

    Returns
    -------
    str
        Metres or degrees.

    """
    if name in linkage.angles:
        return f'{value / DEGREE:.6g} deg'
    return f'{value:.6g} m'
