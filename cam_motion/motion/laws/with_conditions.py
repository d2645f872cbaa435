# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Polynomials that meet what is asked of them: boundary values, points, neighbours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws.law import register
from cam_motion.motion.laws.parameters import ANY_NUMBER, LARGEST_VALUE, LawParameter
from cam_motion.motion.piece import Piece
from cam_motion.motion.piecewise import Piecewise

MOST_CONDITIONS = 20
"""More conditions than this make a polynomial that swings; take several segments instead."""

_MISS = 1e-9  # how far rounding may carry the curve from a condition, as a share of what is asked
_PAIRS = 'pairs of a share of the span from 0 to 1 and '
_CONDITIONS = tuple(
    LawParameter(name, default, _PAIRS + what, count=ANY_NUMBER,
                 least=-LARGEST_VALUE, most=LARGEST_VALUE)
    for name, default, what in (
        ('positions', (), 'the position there in lifts'),
        ('velocities', (0.0, 0.0, 1.0, 0.0), 'the velocity there in lifts per span'),
        ('accelerations', (0.0, 0.0, 1.0, 0.0), 'the acceleration there in lifts per span²'),
        ('jerks', (), 'the jerk there in lifts per span³'),
    ))


def _end(name: str, rule: str, default: float | None = 0.0) -> LawParameter:
    return LawParameter(name, default, rule, least=-LARGEST_VALUE, most=LARGEST_VALUE)


def quintic(lift: float, start_velocity: float, start_acceleration: float,
            end_velocity: float, end_acceleration: float) -> Piece:
    """
    Build the polynomial of degree 5 with given values at both ends of a span of 1.

    Parameters
    ----------
    lift : float
        Value at the end; it is 0 at the start.
    start_velocity, start_acceleration, end_velocity, end_acceleration : float
        First and second derivative at the ends.

    Returns
    -------
    Piece
        The polynomial over the length 1.

    References
    ----------
    VDI 2143 sheet 1 (1980), polynomial of degree 5 for motion at both ends.

    """
    a0, a1 = start_acceleration, end_acceleration
    # By what a straight line would miss: rounding of these two moves the end by itself, but not
    # the acceleration there, so that a curve that is nearly straight joins well, too.
    rise, gain = lift - start_velocity, end_velocity - start_velocity
    return Piece(1.0, (
        0.0, start_velocity, 0.5 * a0,
        10.0 * rise - 4.0 * gain - 1.5 * a0 + 0.5 * a1,
        -15.0 * rise + 7.0 * gain + 1.5 * a0 - a1,
        6.0 * rise - 3.0 * gain - 0.5 * a0 + 0.5 * a1,
    ))


@register('polynomial', 'degree 5 with any velocity and acceleration at its ends',
          'VDI 2143 sheet 1, polynomial of degree 5, motion to motion',
          _end('start_velocity', 'the velocity at the start in lifts per span'),
          _end('start_acceleration', 'the acceleration at the start in lifts per span²'),
          _end('end_velocity', 'the velocity at the end in lifts per span'),
          _end('end_acceleration', 'the acceleration at the end in lifts per span²'),
          any_ends=True)
def polynomial(start_velocity: float, start_acceleration: float,
               end_velocity: float, end_acceleration: float) -> Piecewise:
    """
    Build the polynomial of degree 5 with given boundary values.

    Parameters
    ----------
    start_velocity, end_velocity : float
        s' at the ends [-]: 1 is the mean velocity of the segment.
    start_acceleration, end_acceleration : float
        s'' at the ends [-].

    Returns
    -------
    Piecewise
        The curve from 0 to 1; with other velocities than 0 it can pass beyond them.

    """
    return Piecewise(0.0, [quintic(
        1.0, start_velocity, start_acceleration, end_velocity, end_acceleration)])


@register('auto', 'joins its neighbours: velocity and acceleration are theirs',
          'VDI 2143 sheet 1, polynomial of degree 5, motion to motion',
          _end('end_velocity', 'the velocity at the end in units of the axis per rad, where the '
               'next segment is auto as well; left out, the smoothest', None),
          _end('end_acceleration', 'the acceleration at the end in units of the axis per rad², '
               'where the next segment is auto as well; left out, the smoothest', None),
          any_ends=True)
def auto(end_velocity: float | None, end_acceleration: float | None) -> Piecewise:
    """
    Build the polynomial of degree 5 as it is between two dwells.

    In a cam the neighbours decide, see `cam_motion.motion.matching.matched`.

    Parameters
    ----------
    end_velocity, end_acceleration : float | None
        Values at the end of a segment of lift 1 over 1 rad; None is 0.

    Returns
    -------
    Piecewise
        The curve from 0 to 1.

    """
    return Piecewise(0.0, [quintic(1.0, 0.0, 0.0, end_velocity or 0.0, end_acceleration or 0.0)])


@register('flexible_polynomial', 'polynomial through given points; its degree follows from them',
          'J. Angeles, C. S. Lopez-Cajun, Optimization of Cam Mechanisms (1991), polynomial '
          'interpolation of positions and derivatives', *_CONDITIONS, any_ends=True)
def flexible_polynomial(
    positions: tuple[float, ...], velocities: tuple[float, ...],
    accelerations: tuple[float, ...], jerks: tuple[float, ...],
) -> Piecewise:
    """
    Build the polynomial of least degree that meets conditions at any place.

    Parameters
    ----------
    positions, velocities, accelerations, jerks : tuple[float, ...]
        Pairs of a share of the span [-] and the derivative of that order there [-], each list
        as long as wanted. s(0) = 0 and s(1) = 1 always hold and are not given.

    Returns
    -------
    Piecewise
        The curve from 0 to 1, of one degree less than there are conditions.

    Raises
    ------
    ConfigurationError
        When a list is not made of pairs, there are too many, or they contradict each other or
        say the same twice.

    """
    given = (positions, velocities, accelerations, jerks)
    problems = [
        problem for parameter, values in zip(_CONDITIONS, given)
        if len(values) % 2 or not all(0.0 <= x <= 1.0 for x in values[::2])
        for problem in parameter.problem(
            list(values), 'write [0.5, 0.7] for 0.7 half-way').problems
    ]
    if problems:
        raise ConfigurationError(problems)
    conditions = [(0.0, 0, 0.0), (1.0, 0, 1.0)]
    for order, values in enumerate(given):
        conditions += [(x, order, y) for x, y in zip(values[::2], values[1::2])]
    if len(conditions) > MOST_CONDITIONS:
        raise _refusal(conditions, f'at most {MOST_CONDITIONS} conditions make a good polynomial',
                       'divide the segment')
    coefficients = _solve(conditions)
    if coefficients is None:
        raise _refusal(conditions, 'every condition must say something of its own',
                       'two contradict each other or say the same: s(0) = 0 and s(1) = 1 are '
                       'always there')
    curve = Piecewise(0.0, [Piece(1.0, coefficients)])
    for x, order, value in conditions:
        asked = max(abs(y) for _, n, y in conditions if n == order)
        if abs(float(curve(x, order)) - value) > _MISS * max(1.0, asked):
            raise _refusal(conditions, 'the conditions must not be so close to each other that '
                           'only rounding tells them apart', 'divide the segment')
    return curve


def _refusal(conditions: Sequence[tuple[float, int, float]], rule: str,
             hint: str) -> ConfigurationError:
    marks = ', '.join(f's{"′" * order}({x:g}) = {y:g}' for x, order, y in conditions)
    return ConfigurationError([Problem('law', 'flexible_polynomial', rule, f'{hint}: {marks}')])


def _solve(conditions: Sequence[tuple[float, int, float]]) -> tuple[float, ...] | None:
    """Solve for the coefficients in fractions, without rounding; None if they are not unique."""
    count = len(conditions)
    rows = [list(_row(count, *condition)) for condition in conditions]
    for column in range(count):
        pivot = next((n for n in range(column, count) if rows[n][column]), None)
        if pivot is None:
            return None
        rows[column], rows[pivot] = rows[pivot], rows[column]
        top = [value / rows[column][column] for value in rows[column]]
        rows[column] = top
        for n in range(count):
            factor = rows[n][column]
            if n != column and factor:
                rows[n] = [a - factor * b for a, b in zip(rows[n], top)]
    return tuple(float(row[-1]) for row in rows)


def _row(count: int, x: float, order: int, value: float) -> Iterator[Fraction]:
    """Give one equation: the derivatives of the powers at x, then the value."""
    # as decimal fractions, the way people write them
    at = Fraction(repr(x))
    for power in range(count):
        yield math.perm(power, order) * at ** (power - order) if power >= order else Fraction(0)
    yield Fraction(repr(value))
