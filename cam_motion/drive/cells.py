# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A revolution of the cam shaft in cells, and the load on it, for many designs at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.collocation import gauss_rule, GaussRule
from cam_motion.drive.load import Follower, Terms
from cam_motion.motion.piece import Array
import numpy as np

Numbers = np.ndarray[tuple[Any, ...], np.dtype[np.intp]]
"""Integers, to pick by."""

Flags = np.ndarray[tuple[Any, ...], np.dtype[np.bool_]]
"""Truths, to pick by."""

POINTS = 8
"""Gauss points per cell: order 16; where Q is too rough for them, cells are halved."""


_DENSE = 9  # places per element, of at most 60 degrees, at which contact forces are looked at


@dataclass(frozen=True)
class Cells:
    """
    One revolution in K cells, the same for all designs (n = 1) or each its own.

    Attributes
    ----------
    element : ndarray of int, shape (K, n)
        The element of the drive in which a cell lies.
    start, span : ndarray, shape (K, n)
        Beginning and length [rad].
    inertia, centripetal, force, damping : ndarray, shape (POINTS + 2, K, n)
        J and C [kg m²], Q0 [N m] and Q1 [N m s/rad] of the load, at the beginning, at the Gauss
        points and at the end of each cell.

    """

    element: Numbers
    start: Array
    span: Array
    inertia: Array
    centripetal: Array
    force: Array
    damping: Array

    @property
    def inner(self) -> tuple[Array, Array, Array]:
        """Give J, Q0 and Q1 at the Gauss points."""
        return self.inertia[1:-1], self.force[1:-1], self.damping[1:-1]

    def take(self, which: Numbers | Flags) -> Cells:
        """
        Take the cells of some designs.

        Parameters
        ----------
        which : ndarray
            Which ones.

        Returns
        -------
        Cells
            Theirs; the same, if they are those of all designs.

        """
        if self.span.shape[1] == 1:
            return self
        return Cells(*(getattr(self, field.name)[..., which] for field in fields(self)))


class LoadTable:
    """
    The load of a drive, ready for cells.

    Parameters
    ----------
    drive : CamDrive
        The drive; only its cam and its parts count.

    """

    def __init__(self, drive: CamDrive) -> None:
        self._drive = drive
        self.edges = np.array([0.0, *(e.end for e in drive.elements)])
        whole = np.arange(len(drive.elements))[:, None]
        start, span = self.edges[:-1, None], np.diff(self.edges)[:, None]
        q = start + span * NODES[:, None, None]
        columns = [self.terms(k, q[:, k, 0]) for k in range(len(drive.elements))]
        self.whole = Cells(whole, start, span, *np.stack(columns, axis=2)[..., None])

    @cached_property
    def dense(self) -> tuple[Follower, Terms]:
        """Give follower and load at places spread over each element, shape (_DENSE, K, 1)."""
        drive = self._drive
        each = [drive.follower(e, np.linspace(e.start, e.end, _DENSE)) for e in drive.elements]
        columns = [self.terms(k, at.q) for k, at in enumerate(each)]
        return (Follower(*(np.stack(x, axis=1)[..., None] for x in zip(*each))),
                Terms(*np.stack(columns, axis=2)[..., None]))

    def follower_force(self, omega: Array, alpha: Array) -> Array:
        """
        Give the force that presses the followers on the cam, at the places of `dense`.

        Parameters
        ----------
        omega, alpha : ndarray, shape (_DENSE, K, n)
            Speed [rad/s] and acceleration [rad/s²] of the cam shaft.

        Returns
        -------
        ndarray, shape (_DENSE, K, n)
            Force along the way of the follower [N].

        """
        at = self.dense[0]
        return np.broadcast_to(self._drive.follower_force(at, omega, alpha), omega.shape)

    def terms(self, element: int, q: Array) -> Array:
        """
        Sum the terms of the load within an element, its ends from inside.

        Parameters
        ----------
        element : int
            Number of the element.
        q : ndarray, shape (n,)
            Shaft angles within it [rad].

        Returns
        -------
        ndarray, shape (4, n)
            J, C, Q0 and Q1 of all parts.

        """
        at = self._drive.follower(self._drive.elements[element], q)
        total = np.zeros((4, q.size))
        for part in self._drive.parts:
            for row, term in zip(total, part.terms(at)):
                row += term
        return total

    def terms_in(self, elements: Numbers, q: Array) -> Array:
        """
        Sum the terms of the load within several elements.

        Parameters
        ----------
        elements : ndarray of int, shape (n,)
            Numbers of the elements.
        q : ndarray, shape (n,)
            A shaft angle within each [rad].

        Returns
        -------
        ndarray, shape (4, n)
            J, C, Q0 and Q1 of all parts.

        """
        found = np.empty((4, q.size))
        for number in range(self.edges.size - 1):
            mine = elements == number
            if mine.any():
                found[:, mine] = self.terms(number, q[mine])
        return found

    def halved(self, times: int) -> Cells:
        """
        Halve every element.

        Parameters
        ----------
        times : int
            How often.

        Returns
        -------
        Cells
            K = elements * 2**times cells, the same for all designs.

        """
        return self.split(np.empty((0, 1)), times) if times else self.whole

    def split(self, cuts: Array, halvings: int = 0) -> Cells:
        """
        Split the revolution of each design at its own angles too.

        Parameters
        ----------
        cuts : ndarray, shape (c, n)
            Shaft angles within one turn [rad].
        halvings : int
            How often to halve every element.

        Returns
        -------
        Cells
            K = elements * 2**halvings + c cells for each design.

        """
        count = self.edges.size - 1
        evenly = np.interp(np.linspace(0.0, count, (count << halvings) + 1),
                           np.arange(count + 1.0), self.edges)
        columns = np.broadcast_to(evenly[:, None], (evenly.size, cuts.shape[1]))
        edges = np.sort(np.concatenate([columns, cuts]), axis=0)
        start, end = edges[:-1], edges[1:]
        element = np.searchsorted(self.edges[1:-1], 0.5 * (start + end))
        terms = [getattr(self.whole, name)[:, element, 0]
                 for name in ('inertia', 'centripetal', 'force', 'damping')]
        parted = (start != self.edges[element]) | (end != self.edges[element + 1])
        q = (start + (end - start) * NODES[:, None, None])[:, parted]
        numbers = np.broadcast_to(element[parted], q.shape)
        found = self.terms_in(numbers.ravel(), q.ravel())
        for term, values in zip(terms, found):
            term[:, parted] = values.reshape(q.shape)
        return Cells(element, start, end - start, *terms)


def weigh(weights: Sequence[float] | Array, values: Array) -> Array:
    """
    Add values along the first axis with weights.

    Parameters
    ----------
    weights : Sequence[float], shape (m,)
        The weights.
    values : ndarray, shape (m, ...)
        The values.

    Returns
    -------
    ndarray, shape (...)
        The sum, term by term: a matrix product may round a column by where it stands in the
        matrix, and a design must not depend on its neighbours.

    """
    total: Array = weights[0] * values[0]
    for weight, value in zip(weights[1:], values[1:]):
        total += weight * value
    return total


def transform(matrix: Array, values: Array) -> Array:
    """
    Apply a matrix along the first axis.

    Parameters
    ----------
    matrix : ndarray, shape (i, m)
        The matrix.
    values : ndarray, shape (m, ...)
        The values.

    Returns
    -------
    ndarray, shape (i, ...)
        The products, rounded as by `weigh`.

    """
    columns = matrix.T.reshape(*matrix.T.shape, *(1,) * (values.ndim - 1))
    return weigh(columns, values)


RULE: GaussRule = gauss_rule(POINTS)
NODES: Array = np.array([0.0, *RULE.points, 1.0])
"""Beginning, Gauss points and end of a cell of length 1."""
