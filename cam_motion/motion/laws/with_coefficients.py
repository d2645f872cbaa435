# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A curve by the coefficients of its B-spline: what an optimiser finds, told to the last digit."""

from __future__ import annotations

import math

from cam_motion.motion.laws.law import register
from cam_motion.motion.laws.parameters import ANY_NUMBER, LARGEST_VALUE, LawParameter
from cam_motion.motion.piece import Array, Piece
from cam_motion.motion.piecewise import Piecewise
import numpy as np

_DEGREE = LawParameter('degree', 5.0, 'a whole number from 2 to 9', least=2.0, most=9.0)
_COEFFICIENTS = LawParameter(
    'coefficients', (0.0, 0.0, 0.0, 1.0, 1.0, 1.0),
    'at least one more than the degree, from 0 at the start to 1 at the end', count=ANY_NUMBER,
    least=-LARGEST_VALUE, most=LARGEST_VALUE)


def uniform_knots(degree: int, intervals: int) -> Array:
    """
    Place the knots of a B-spline over 0 to 1 so that it begins and ends in its coefficients.

    Parameters
    ----------
    degree : int
        Its degree p.
    intervals : int
        Number of equal intervals n.

    Returns
    -------
    ndarray, shape (n + 2 p + 1,)
        The knots, those at the ends p + 1 times.

    """
    inner = np.linspace(0.0, 1.0, intervals + 1)
    return np.concatenate([np.zeros(degree), inner, np.ones(degree)])


@register('b_spline', 'B-spline by its coefficients, as the optimiser writes it',
          'C. de Boor, A Practical Guide to Splines (1978), chapter IX', _COEFFICIENTS, _DEGREE,
          any_ends=True)
def b_spline(coefficients: tuple[float, ...], degree: float) -> Piecewise:
    """
    Build a curve from the coefficients of its B-spline over equal intervals.

    Parameters
    ----------
    coefficients : tuple[float, ...], n + p values
        Coefficients in lifts [-], for n intervals. The curve lies between neighbouring ones;
        three equal ones at an end make velocity and acceleration zero there, exactly.
    degree : float
        Degree p of the pieces; all derivatives below it are continuous.

    Returns
    -------
    Piecewise
        The curve from 0 to 1.

    Raises
    ------
    ConfigurationError
        When the degree is no whole number, there are too few coefficients, or they do not lead
        from 0 to 1.

    """
    from scipy.interpolate import BSpline, PPoly
    if degree != int(degree):
        raise _DEGREE.problem(degree)
    order = int(degree)
    intervals = len(coefficients) - order
    if intervals < 1 or coefficients[0] != 0.0 or coefficients[-1] != 1.0:
        raise _COEFFICIENTS.problem(
            list(coefficients), f'of degree {order}: [0, ..., 1] with {order + 1} or more')
    knots = uniform_knots(order, intervals)
    found = PPoly.from_spline(BSpline(knots, np.array(coefficients), order))
    columns = found.c[::-1, order:order + intervals].T
    ends = knots[order:order + intervals + 1].tolist()
    return Piecewise(0.0, [
        Piece(b - a, tuple(column)) for a, b, column in zip(ends, ends[1:], columns.tolist())
    ], ends)


def hodograph(degree: int, intervals: int, order: int) -> Array:
    """
    Give the matrix from the coefficients of a B-spline to those of its derivative.

    Parameters
    ----------
    degree, intervals : int
        Degree p and number of equal intervals n.
    order : int
        Order k of the derivative, up to p.

    Returns
    -------
    ndarray, shape (n + p - k, n + p)
        The matrix; the derivative has the degree p - k and k knots fewer at each end.

    References
    ----------
    C. de Boor, A Practical Guide to Splines (1978), chapter X, equation (15).

    """
    matrix = np.eye(intervals + degree)
    knots = uniform_knots(degree, intervals)
    for k in range(1, order + 1):
        left = degree - k + 1
        inner = knots[k:len(knots) - k]
        spans = inner[left:] - inner[:-left]
        matrix = left * np.diff(matrix, axis=0) / spans[:, None]
    return matrix


def end_coefficients(degree: int, intervals: int, values: tuple[float, ...]) -> list[float]:
    """
    Find the first coefficients of a B-spline from its derivatives at the start.

    Parameters
    ----------
    degree, intervals : int
        Degree and number of equal intervals.
    values : tuple[float, ...]
        The value at the start, then the derivatives in order.

    Returns
    -------
    list[float]
        As many coefficients as there are values.

    """
    found: list[float] = []
    for order, value in enumerate(values):
        if order and not any(values[1:order + 1]):
            found.append(found[0])  # at rest they are equal, free of rounding
            continue
        row = hodograph(degree, intervals, order)[0]
        rest = math.fsum(a * c for a, c in zip(row, found))
        found.append((value - rest) / float(row[order]))
    return found
