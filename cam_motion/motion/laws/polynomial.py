# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Laws that are one polynomial."""

from __future__ import annotations

import math

from cam_motion.motion.laws.inflection import INFLECTION, with_inflection
from cam_motion.motion.laws.law import register
from cam_motion.motion.piece import Piece
from cam_motion.motion.piecewise import Piecewise


@register('dwell', 'no movement', 'document 000')
def dwell() -> Piecewise:
    """
    Build the law that stays where it is, s = 0.

    Returns
    -------
    Piecewise
        Zero over the whole span; the one law with s(1) = 0.

    """
    return Piecewise(0.0, [Piece(1.0, (0.0,))])


@register('constant_velocity', 'straight line; its velocity steps at a dwell',
          'VDI 2143 sheet 1, straight line')
def constant_velocity() -> Piecewise:
    """
    Build the straight line, s = xi.

    Returns
    -------
    Piecewise
        The rise from 0 to 1.

    """
    return Piecewise(0.0, [Piece(1.0, (0.0, 1.0))])


@register('cubic', 'cubic parabola: the law of least RMS acceleration',
          'document 001, cubic curve')
def cubic() -> Piecewise:
    """
    Build the cubic law, s = 3 xi² - 2 xi³.

    Returns
    -------
    Piecewise
        The rise from 0 to 1. Its acceleration is 6 at the start and -6 at the end, so it steps
        at a dwell.

    """
    return Piecewise(0.0, [Piece(1.0, (0.0, 0.0, 3.0, -2.0))])


@register('polynomial_345', 'polynomial of degree 5', 'VDI 2143 sheet 1, polynomial 3-4-5',
          INFLECTION)
def polynomial_345(inflection: float) -> Piecewise:
    """
    Build the polynomial 3-4-5, s = 10 xi³ - 15 xi⁴ + 6 xi⁵.

    Parameters
    ----------
    inflection : float
        Share of the span that accelerates [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1, at rest at both ends; Ca = 10/sqrt(3).

    """
    return with_inflection(_flat_at_both_ends(2), inflection)


@register('polynomial_4567', 'polynomial of degree 7: its jerk does not step either',
          'VDI 2143 sheet 1, polynomial 4-5-6-7', INFLECTION)
def polynomial_4567(inflection: float) -> Piecewise:
    """
    Build the polynomial 4-5-6-7, s = 35 xi⁴ - 84 xi⁵ + 70 xi⁶ - 20 xi⁷.

    Parameters
    ----------
    inflection : float
        Share of the span that accelerates [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1, at rest with zero jerk at both ends; Ca = 84 sqrt(5)/25 = 7.5132,
        where some books print 7.526.

    """
    return with_inflection(_flat_at_both_ends(3), inflection)


@register('polynomial_5_to_9', 'polynomial of degree 9: four derivatives vanish at its ends',
          'L. Biagiotti, C. Melchiorri, Trajectory Planning for Automatic Machines and Robots '
          '(2008), chapter 2', INFLECTION)
def polynomial_5_to_9(inflection: float) -> Piecewise:
    """
    Build the polynomial 5 to 9, s = 126 xi⁵ - 420 xi⁶ + 540 xi⁷ - 315 xi⁸ + 70 xi⁹.

    Parameters
    ----------
    inflection : float
        Share of the span that accelerates [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1, four derivatives zero at both ends.

    """
    return with_inflection(_flat_at_both_ends(4), inflection)


@register('polynomial_6_to_11', 'polynomial of degree 11: five derivatives vanish at its ends',
          'L. Biagiotti, C. Melchiorri, Trajectory Planning for Automatic Machines and Robots '
          '(2008), chapter 2', INFLECTION)
def polynomial_6_to_11(inflection: float) -> Piecewise:
    """
    Build the polynomial 6 to 11 with coefficients 462, -1980, 3465, -3080, 1386, -252.

    Parameters
    ----------
    inflection : float
        Share of the span that accelerates [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1, five derivatives zero at both ends.

    """
    return with_inflection(_flat_at_both_ends(5), inflection)


# Kloomok and Muffley's coefficients of xi³ to xi⁸. As decimal fractions they meet s = 1, s' = 0
# and no jerk at the end exactly.
_EIGHTH_DEGREE = (0.0, 0.0, 0.0, 6.09755, 0.0, -20.7804, 26.73155, -13.60965, 2.56095)


@register('polynomial_8', 'eighth-degree polynomial, from rest to a turn',
          'M. Kloomok, R. V. Muffley, Plate cam design with emphasis on dynamic effects, '
          'Product Engineering 26 (1955)')
def polynomial_8() -> Piecewise:
    """
    Build the eighth-degree polynomial of Kloomok and Muffley, for a cam that turns at its end.

    Returns
    -------
    Piecewise
        The rise from 0 to 1. It starts at rest and ends with the acceleration -5.2683 without
        jerk.

    """
    return Piecewise(0.0, [Piece(1.0, _EIGHTH_DEGREE)])


@register('polynomial_8_return', 'the eighth-degree polynomial backwards, from a turn to rest',
          'M. Kloomok, R. V. Muffley, Plate cam design with emphasis on dynamic effects, '
          'Product Engineering 26 (1955)')
def polynomial_8_return() -> Piecewise:
    """
    Build s = 1 - p(1 - xi) from the eighth-degree polynomial p.

    Returns
    -------
    Piecewise
        The rise from 0 to 1. It starts with the acceleration 5.2683 and ends at rest.

    """
    turned = [
        -(-1) ** k * math.fsum(math.comb(n, k) * c for n, c in enumerate(_EIGHTH_DEGREE))
        for k in range(len(_EIGHTH_DEGREE))
    ]
    # at the turn position and slope are zero but for rounding
    return Piecewise(0.0, [Piece(1.0, (0.0, 0.0, *turned[2:]))])


def _flat_at_both_ends(order: int) -> Piecewise:
    """Build the rise whose derivatives up to an order vanish at both ends."""
    # s' is (xi - xi²)^order in a scale that makes every coefficient of s a whole number
    scale = (2 * order + 1) * math.comb(2 * order, order)
    rising = (scale * (-1) ** k * math.comb(order, k) // (order + 1 + k)
              for k in range(order + 1))
    return Piecewise(0.0, [Piece(1.0, (*(0.0,) * (order + 1), *(float(c) for c in rising)))])
