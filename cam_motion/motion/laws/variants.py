# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Classic laws between other conditions than two dwells: turns (T) and constant velocity (V)."""

from __future__ import annotations

import math

from cam_motion.motion.laws.humps import (
    backwards,
    hump,
    integrated,
    joining,
    mirrored,
    QuarterSine,
    to_one,
)
from cam_motion.motion.laws.law import register
from cam_motion.motion.laws.parameters import LARGEST_VALUE, LawParameter, SHORTEST_STAGE
from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.rise import ending_at_one

_LOSS = 1.0 - 2.0 / math.pi  # of the area below a plateau, per length of a quarter sine

_TURNING = 2.0 * math.sqrt(3.0) - 3.0
"""Share of the turning part of the harmonic combination whose jerk runs through."""

_BLEND = LawParameter(
    'blend', 0.125, 'the share of the span of each quarter sine, above 0 and at most 0.27',
    most=0.27)
_BLEND_OF_ONE = LawParameter(
    'blend', 0.125, 'the share of the span of each quarter sine, above 0 and at most 0.5',
    most=0.5)
_INFLECTION_RT = LawParameter(
    'inflection', 1.0 - _TURNING,
    'the share of the span at which the acceleration changes its sign, above 0 and below 1')
_INFLECTION_TR = LawParameter('inflection', _TURNING, _INFLECTION_RT.rule)
_INFLECTION = LawParameter('inflection', 0.5, _INFLECTION_RT.rule)


def _velocity(end: str, default: float | None) -> LawParameter:
    return LawParameter(
        f'{end}_velocity', default, f'the velocity at the {end} in lifts per span',
        least=-LARGEST_VALUE, most=LARGEST_VALUE)


_START, _END = _velocity('start', 0.5), _velocity('end', 0.5)
_START_VT, _END_TV = _velocity('start', None), _velocity('end', None)
_SPLIT = LawParameter(
    'inflection', None, 'the share of the span at which one hump of acceleration ends and the '
    'other begins, above 0 and below 1; left out, one of them is a straight line')
_VDI = 'VDI 2143 sheet 1, {}; derived here from the conditions at its ends'


@register('acceleration_trapezoid_rt', 'modified acceleration trapezoid from rest to a turn',
          _VDI.format('modified acceleration trapezoid'), _BLEND)
def acceleration_trapezoid_rt(blend: float) -> Piecewise:
    """
    Build the acceleration trapezoid that starts at rest and ends at a turn.

    Parameters
    ----------
    blend : float
        Share of the span of each quarter sine [-]: at the start and on both sides of the change
        of sign; at the turn the acceleration stays on its plateau.

    Returns
    -------
    Piecewise
        The rise from 0 to 1. Both plateaus are of one height, and the jerk runs through where
        the acceleration changes its sign.

    Raises
    ------
    ConfigurationError
        When the blends leave nothing of a plateau.

    Notes
    -----
    With k = 1 - 2/pi a hump of length L with n quarter sines of length b has the area
    A (L - n b k). The velocity returns to zero when the hump of two blends, up to lambda, and
    that of one, behind it, have the same area: lambda = (1 + b k)/2.

    """
    return _trapezoid_to_turn(blend)


@register('acceleration_trapezoid_tr', 'modified acceleration trapezoid from a turn to rest',
          _VDI.format('modified acceleration trapezoid'), _BLEND)
def acceleration_trapezoid_tr(blend: float) -> Piecewise:
    """
    Build the acceleration trapezoid that starts at a turn and ends at rest.

    Parameters
    ----------
    blend : float
        Share of the span of each quarter sine [-], as in `acceleration_trapezoid_rt`.

    Returns
    -------
    Piecewise
        The rise from 0 to 1: that from rest to a turn backwards.

    Raises
    ------
    ConfigurationError
        When the blends leave nothing of a plateau.

    """
    return backwards(_trapezoid_to_turn(blend))


@register('acceleration_trapezoid_rv', 'one trapezoid of acceleration, from rest to velocity 2',
          _VDI.format('modified acceleration trapezoid'), _BLEND_OF_ONE)
def acceleration_trapezoid_rv(blend: float) -> Piecewise:
    """
    Build the acceleration trapezoid that starts at rest and ends at constant velocity.

    Parameters
    ----------
    blend : float
        Share of the span of each of its two quarter sines [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1; as its acceleration is symmetric it ends with twice the mean
        velocity, and its peak acceleration is 2 / (1 - 2 b (1 - 2/pi)).

    Raises
    ------
    ConfigurationError
        When the blend has no length.

    """
    return _single_trapezoid(blend)


@register('acceleration_trapezoid_vr', 'one trapezoid of deceleration, from velocity 2 to rest',
          _VDI.format('modified acceleration trapezoid'), _BLEND_OF_ONE)
def acceleration_trapezoid_vr(blend: float) -> Piecewise:
    """
    Build the acceleration trapezoid that starts at constant velocity and ends at rest.

    Parameters
    ----------
    blend : float
        Share of the span of each of its two quarter sines [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1: that from rest to constant velocity backwards.

    Raises
    ------
    ConfigurationError
        When the blend has no length.

    """
    return backwards(_single_trapezoid(blend))


@register('harmonic_combination_rt', 'modified sine without its last quarter wave, to a turn',
          _VDI.format('harmonic combination'), _INFLECTION_RT)
def harmonic_combination_rt(inflection: float) -> Piecewise:
    """
    Build the harmonic combination that starts at rest and ends at a turn.

    Parameters
    ----------
    inflection : float
        Share of the span that accelerates [-]; at its default 4 - 2 sqrt(3) the jerk runs
        through where the acceleration changes its sign.

    Returns
    -------
    Piecewise
        The rise from 0 to 1; its acceleration is greatest, and its jerk zero, at the turn.

    Raises
    ------
    ConfigurationError
        When one part would have no length.

    Notes
    -----
    A quarter sine grows, one of three times its length fades, a third one grows to the turn:
    p = 3 lambda/4 fades into mu = 1 - lambda. The velocity closes with A lambda = B mu, the jerk
    is continuous with A/p = B/mu; both hold for mu = lambda sqrt(3)/2.

    """
    _check(inflection, _INFLECTION_RT)
    return joining(hump(inflection), [QuarterSine(1.0 - inflection, True)], 0.0, 0.0)


@register('harmonic_combination_tr', 'modified sine without its first quarter wave, from a turn',
          _VDI.format('harmonic combination'), _INFLECTION_TR)
def harmonic_combination_tr(inflection: float) -> Piecewise:
    """
    Build the harmonic combination that starts at a turn and ends at rest.

    Parameters
    ----------
    inflection : float
        Share of the span that accelerates [-]; at its default 2 sqrt(3) - 3 the jerk runs
        through where the acceleration changes its sign.

    Returns
    -------
    Piecewise
        The rise from 0 to 1: that from rest to a turn backwards.

    Raises
    ------
    ConfigurationError
        When one part would have no length.

    """
    _check(inflection, _INFLECTION_TR)
    return backwards(harmonic_combination_rt(1.0 - inflection))


@register('harmonic_combination_vt', 'harmonic combination from constant velocity to a turn',
          _VDI.format('harmonic combination'), _START_VT, _SPLIT)
def harmonic_combination_vt(start_velocity: float | None, inflection: float | None) -> Piecewise:
    """
    Build the harmonic combination that starts at constant velocity and ends at a turn.

    Parameters
    ----------
    start_velocity : float | None
        Velocity at the start, in lifts per span [-]; None takes the one with which the curve
        runs straight up to the inflection.
    inflection : float | None
        Share of the span up to which the first hump of acceleration reaches [-], as in the
        modified sine; None lets the curve run straight there, if the velocity is above 1 and at
        most pi/2. Both left out, it is a quarter of a sine: s = sin(pi xi / 2).

    Returns
    -------
    Piecewise
        The curve from 0 to 1; it can pass beyond 1 where the velocity is high.

    Raises
    ------
    ConfigurationError
        When one part would have no length, or the velocity needs a first hump.

    Notes
    -----
    A straight line up to lambda and a quarter of a sine over mu = 1 - lambda have the velocity
    1 / (1 - mu (1 - 2/pi)).

    """
    return _to_a_turn(start_velocity, inflection, _START_VT, _SPLIT)


@register('harmonic_combination_tv', 'harmonic combination from a turn to constant velocity',
          _VDI.format('harmonic combination'), _END_TV, _SPLIT)
def harmonic_combination_tv(end_velocity: float | None, inflection: float | None) -> Piecewise:
    """
    Build the harmonic combination that starts at a turn and ends at constant velocity.

    Parameters
    ----------
    end_velocity : float | None
        Velocity at the end, in lifts per span [-]; None takes the one with which the curve runs
        straight from the inflection on.
    inflection : float | None
        Share of the span from which the second hump of acceleration reaches to the end [-]; None
        lets the curve run straight there, if the velocity is above 1 and at most pi/2. Both left
        out, it is s = 1 - cos(pi xi / 2).

    Returns
    -------
    Piecewise
        The curve from 0 to 1: that from constant velocity to a turn backwards.

    Raises
    ------
    ConfigurationError
        When one part would have no length, or the velocity needs a second hump.

    """
    return backwards(_to_a_turn(
        end_velocity, None if inflection is None else 1.0 - inflection, _END_TV, _SPLIT))


@register('modified_sine_vv', 'modified sine between two constant velocities',
          _VDI.format('modified sine line'), _START, _END, _INFLECTION)
def modified_sine_vv(start_velocity: float, end_velocity: float, inflection: float) -> Piecewise:
    """
    Build the modified sine that joins two constant velocities.

    Parameters
    ----------
    start_velocity, end_velocity : float
        Velocities at the ends, in lifts per span [-].
    inflection : float
        Share of the span up to which the first of its two humps of acceleration reaches [-].

    Returns
    -------
    Piecewise
        The curve from 0 to 1, without acceleration at its ends; with both velocities 0 it is the
        law `modified_sine`, with both 1 a straight line.

    Raises
    ------
    ConfigurationError
        When one part would have no length.

    Notes
    -----
    Each hump of length L is two quarter sines of L/4 and 3 L/4, as in the modified sine. Their
    heights follow from the two conditions on velocity and lift, which are linear in them.

    """
    _check(inflection, _INFLECTION)
    return joining(hump(inflection), mirrored(hump(1.0 - inflection)), start_velocity,
                   end_velocity)


def _check(inflection: float, parameter: LawParameter) -> None:
    if not 0.0 < inflection < 1.0:
        raise parameter.problem(inflection)


def _to_a_turn(velocity: float | None, inflection: float | None,
               of_velocity: LawParameter, of_inflection: LawParameter) -> Piecewise:
    """Build the harmonic combination to a turn, the parameters named as the user gave them."""
    if inflection is not None:
        _check(inflection, of_inflection)
    if velocity is None:
        turning = 1.0 - (inflection or 0.0)
    elif inflection is None:
        turning = (1.0 - 1.0 / velocity) / _LOSS if velocity else 0.0
        if not SHORTEST_STAGE < turning <= 1.0 + SHORTEST_STAGE:
            raise of_velocity.problem(velocity, 'above 1 and at most pi/2, or give the '
                                      'inflection, 0.5 for example')
    else:
        return joining(hump(inflection), [QuarterSine(1.0 - inflection, True)], velocity, 0.0)
    straight = max(1.0 - turning, 0.0)
    speed = 1.0 / (1.0 - turning * _LOSS)
    pieces = [Piece(straight, (0.0, speed))] if straight > SHORTEST_STAGE else []
    reach = speed * turning * 2.0 / math.pi
    sine = Piece(turning, (speed * straight,), (Wave(0.5 * math.pi / turning, 0.0, reach),))
    return ending_at_one([*pieces, sine])


def _trapezoid_to_turn(blend: float) -> Piecewise:
    hold = 0.5 * (1.0 + blend * _LOSS) - 2.0 * blend
    rest = 1.0 - hold - 3.0 * blend
    if blend <= 0.0:
        raise _BLEND.problem(blend, 'constant_acceleration has no blends')
    grow, fade = QuarterSine(blend, True), QuarterSine(blend, False)
    rise = integrated([
        grow.piece(1.0), Piece(hold, (1.0,)), fade.piece(1.0), grow.piece(-1.0),
        Piece(rest, (-1.0,))], 0.0)
    return to_one(rise)


def _single_trapezoid(blend: float) -> Piecewise:
    if blend <= 0.0:
        raise _BLEND_OF_ONE.problem(blend)
    plateau = [Piece(1.0 - 2.0 * blend, (1.0,))] if blend < 0.5 else []
    return to_one(integrated([
        QuarterSine(blend, True).piece(1.0), *plateau, QuarterSine(blend, False).piece(1.0)], 0.0))
