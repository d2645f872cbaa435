# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Gauss collocation: integration over an element to twice the order of its points."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

from cam_motion.motion.piece import Array
import numpy as np
from numpy.polynomial import legendre


class GaussRule(NamedTuple):
    """
    Collocation on the unit interval.

    The n ``points`` and ``weights`` [-], and the n x n ``matrix`` that integrates a polynomial
    given by its values at the points from 0 to each of them (Butcher's matrix of the
    implicit Gauss methods, of order 2 n).
    """

    points: Array
    weights: Array
    matrix: Array

    def row(self, x: float | Array) -> Array:
        """
        Integrate from 0 to any place.

        Parameters
        ----------
        x : float or ndarray, shape (m,)
            Places in the unit interval [-].

        Returns
        -------
        ndarray, shape (n,) or (m, n)
            Weights of the values at the points.

        """
        row: Array = _integrals(np.asarray(x), self.points.size) @ _inverse(self.points.size)
        return row


def _integrals(x: Array, count: int) -> Array:
    """Integrate the first Legendre polynomials from the left end to x."""
    values = legendre.legvander(2.0 * x - 1.0, count)
    k = np.arange(1, count)
    rows = np.empty((*np.shape(x), count))
    rows[..., 0] = x
    rows[..., 1:] = (values[..., 2:] - values[..., :-2]) / (2.0 * (2.0 * k + 1.0))
    return rows


@cache
def _inverse(count: int) -> Array:
    points = legendre.leggauss(count)[0]
    return np.asarray(
        np.linalg.inv(legendre.legvander(points, count - 1)), dtype=np.float64)


@cache
def spread(count: int, places: int) -> Array:
    """
    Interpolate between the ends and the Gauss points of the unit interval.

    Parameters
    ----------
    count : int
        Number n of Gauss points.
    places : int
        Number m of places, evenly spread, both ends included.

    Returns
    -------
    ndarray, shape (m, n + 2)
        Weights of the values at 0, the points and 1, for the value at each place.

    """
    nodes = np.concatenate([[-1.0], legendre.leggauss(count)[0], [1.0]])
    values = legendre.legvander(np.linspace(-1.0, 1.0, places), count + 1)
    return np.asarray(
        values @ np.linalg.inv(legendre.legvander(nodes, count + 1)), dtype=np.float64)


@cache
def gauss_rule(count: int) -> GaussRule:
    """
    Make the rule with a number of points.

    Parameters
    ----------
    count : int
        Number of points, at least 1.

    Returns
    -------
    GaussRule
        The rule.

    References
    ----------
    E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I (1993),
    section II.7, theorem 7.13.

    """
    x, w = legendre.leggauss(count)
    points = np.asarray(0.5 * (x + 1.0), dtype=np.float64)
    matrix = _integrals(points, count) @ _inverse(count)
    return GaussRule(points, np.asarray(0.5 * w, dtype=np.float64), matrix)


@cache
def tail(count: int) -> Array:
    """
    Give the last two terms of the Legendre series through the values at the points.

    Parameters
    ----------
    count : int
        Number n of Gauss points.

    Returns
    -------
    ndarray, shape (n, 2)
        Weights of the values at the points, for each term.

    """
    return np.asarray(_inverse(count)[-2:].T, dtype=np.float64)
