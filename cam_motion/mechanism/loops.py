# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The loop equations of a linkage as matrices: values, first and second derivatives."""

from __future__ import annotations

from collections.abc import Iterable

from cam_motion.mechanism.compiled_sums import compile_sums, Compiled
from cam_motion.mechanism.linkage import Linkage
from cam_motion.motion.piece import Array
import numpy as np
from numpy.typing import NDArray

ComplexArray = NDArray[np.complex128]


class LoopEquations:
    """
    Vectors, loops and points of a linkage over its variables z, the inputs first.

    Lengths and angles of the vectors are affine in z, so that a vector is
    ``(l0 + L z) · exp(j (a0 + A z))``; loops and points are sums of vectors.

    Parameters
    ----------
    linkage : Linkage
        The linkage.

    Attributes
    ----------
    size : float
        The longest fixed length in a loop [m], by which lengths are made free of units.
    units : ndarray, shape (n,)
        What one unit of each variable is: `size` for lengths, 1 for angles.
    loops, points : ndarray, shape (loops, vectors) and (points, vectors)
        How often each loop and each point passes each vector; -1 backwards.
    gaps : Callable[[Sequence[float]], tuple[float, ...]]
        The closure as plain floats, for where an array costs more than what is in it.

    References
    ----------
    Uicker, Pennock, Shigley, Theory of Machines and Mechanisms, chapters 2 to 4 (loop closure in
    complex polar form).

    """

    def __init__(self, linkage: Linkage) -> None:
        """Translate the description."""
        variables, vectors = linkage.variables, linkage.vectors
        self._place = {vector.name: i for i, vector in enumerate(vectors)}
        angles = {body.name: variables.index(body.angle) for body in linkage.bodies}
        self._fixed = np.zeros(len(vectors))
        # a quarter turn in radians is not exact: what is below rounding is none
        turns = np.array([vector.turn for vector in vectors])
        self._turned: ComplexArray = _without_rounding(np.cos(turns)) + 1j * _without_rounding(
            np.sin(turns))
        self._length = np.zeros((len(vectors), len(variables)))
        self._angle = np.zeros((len(vectors), len(variables)))
        for i, vector in enumerate(vectors):
            if isinstance(vector.length, str):
                self._length[i, variables.index(vector.length)] = 1.0
            else:
                self._fixed[i] = vector.length
            if vector.body in angles:
                self._angle[i, angles[vector.body]] = 1.0
        self.loops = np.array([self.along(loop.path) for loop in linkage.loops])
        chains: dict[str, Array] = {'': np.zeros(len(vectors))}
        for point in linkage.points:
            chains[point.name] = chains[point.start] + self.along(point.path)
        self.points = np.array([chains[point.name] for point in linkage.points]).reshape(
            len(linkage.points), len(vectors))
        passed = np.abs(self.loops)
        mixed = np.einsum('ki,ia,ib->kab', passed, self._angle, self._length)
        self._slides = mixed.sum(axis=1) + mixed.sum(axis=2)
        self._passed = passed
        self._linkage = linkage
        self.gaps, self._jacobian = self.compiled(self.loops)
        self._slid = self._length.sum(axis=1)[:, None] * self._angle
        self.size = float((self._fixed * passed.max(axis=0)).max()) or 1.0
        self.units = np.array([1.0 if name in linkage.angles else self.size
                               for name in variables])

    def compiled(self, counts: Array) -> tuple[Compiled, Compiled]:
        """
        Write sums of vectors out as functions of plain floats.

        Parameters
        ----------
        counts : ndarray, shape (k, vectors)
            How often each sum holds each vector.

        Returns
        -------
        tuple[Callable, Callable]
            The sums and their derivatives, see `compile_sums`.

        """
        return compile_sums(self._linkage, counts, self._turned.tolist())

    def along(self, path: Iterable[str]) -> Array:
        """
        Count how often a path passes each vector.

        Parameters
        ----------
        path : Iterable[str]
            Names of vectors, ``-`` before those passed backwards.

        Returns
        -------
        ndarray, shape (vectors,)
            Counts, backwards negative.

        """
        passed = np.zeros(len(self._place))
        for name in path:
            passed[self._place[name.removeprefix('-')]] += -1.0 if name.startswith('-') else 1.0
        return passed

    def vectors(self, z: Array) -> ComplexArray:
        """
        Give all vectors.

        Parameters
        ----------
        z : ndarray, shape (n,)
            The variables [m, rad].

        Returns
        -------
        ndarray, shape (vectors,)
            The vectors [m].

        """
        return (self._fixed + self._length @ z) * self._directions(z)

    def slopes(self, z: Array) -> ComplexArray:
        """
        Give the derivatives of all vectors by the variables.

        Parameters
        ----------
        z : ndarray, shape (n,)
            The variables [m, rad].

        Returns
        -------
        ndarray, shape (vectors, n)
            Derivatives [m/rad, or without unit].

        """
        length = self._fixed + self._length @ z
        values: ComplexArray = self._directions(z)[:, None] * (
            self._length + 1j * length[:, None] * self._angle)
        return values

    def bend(self, z: Array, rate: Array) -> ComplexArray:
        """
        Give the accelerations that all vectors have without one of the variables.

        Parameters
        ----------
        z, rate : ndarray, shape (n,)
            The variables [m, rad] and their rates [m/s, rad/s].

        Returns
        -------
        ndarray, shape (vectors,)
            The centripetal and Coriolis parts [m/s²].

        """
        length, omega = self._fixed + self._length @ z, self._angle @ rate
        values: ComplexArray = self._directions(z) * (
            2j * omega * (self._length @ rate) - length * omega ** 2)
        return values

    def _directions(self, z: Array) -> ComplexArray:
        directions: ComplexArray = self._turned * np.exp(1j * (self._angle @ z))
        return directions

    def closure(self, z: Array) -> Array:
        """
        Give by how much the loops fail to close.

        Parameters
        ----------
        z : ndarray, shape (n,)
            The variables [m, rad].

        Returns
        -------
        ndarray, shape (2 loops,)
            Real parts, then imaginary parts [m].

        """
        return np.array(self.gaps(z.tolist()))

    def jacobian(self, z: Array) -> Array:
        """
        Give the derivatives of the closure.

        Parameters
        ----------
        z : ndarray, shape (n,)
            The variables [m, rad].

        Returns
        -------
        ndarray, shape (2 loops, n)
            Derivatives, rows as in `closure`.

        """
        return np.array(self._jacobian(z.tolist())).reshape(2 * len(self.loops), len(z))

    def bends(self, z: Array, weights: Array) -> tuple[Array, Array]:
        """
        Bound the second derivatives of the loops around a position, all free of units.

        For changes a, b of the variables the second derivative of loop k is at most |a|ᵀ N |b|,
        where the matrix N sums the lengths that turn, and 1 for every slide that turns.

        Parameters
        ----------
        z : ndarray, shape (n,)
            The variables [m, rad].
        weights : ndarray, shape (loops,)
            Weights of the loops, above 0.

        Returns
        -------
        tuple[ndarray, ndarray], shapes (n,)
            The row sums of the weighted sum of the N, whose greatest bounds its norm: at z, and
            what is added for each unit of distance from z, in units of the variables.

        """
        weighted = weights @ self._passed
        length = np.abs(self._fixed + self._length @ z) / self.size
        here: Array = (weighted * length) @ self._angle + weights @ self._slides
        growth: Array = weighted @ self._slid
        return here, growth


def _without_rounding(values: Array) -> Array:
    return np.where(np.abs(values) < np.finfo(float).eps, 0.0, values)
