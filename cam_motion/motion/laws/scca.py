# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Sine - constant - cosine accelerations: the family that the seven stages generate."""

from __future__ import annotations

import math

from cam_motion.motion.laws.inflection import INFLECTION, with_inflection
from cam_motion.motion.laws.law import Member, register
from cam_motion.motion.laws.modified import modified_trapezoid
from cam_motion.motion.laws.parameters import LawParameter, SUM_TOLERANCE
from cam_motion.motion.piecewise import Piecewise

_HOLD = LawParameter(
    'constant_velocity', 0.5,
    'the share of the span at constant velocity, from 0 and below 1',
)
_NO_HOLD = LawParameter('constant_velocity', 0.0, _HOLD.rule)
_SHARES = LawParameter(
    'shares', (0.25, 0.5, 0.25),
    'what sine, constant and cosine have of the acceleration, each from 0 to 1, that sum to 1',
    count=3,
)
_JOINTS = LawParameter(
    'joints', (0.125, 0.375, 0.5, 0.5, 0.625, 0.875),
    'six joints T1 to T6 from 0 to 1 that never fall; T1 to T3 must not all be 0, T4 to T6 '
    'not all be 1', count=6,
)
_RAMP_UP = LawParameter(
    'ramp_up', 1.0 / 3.0, 'the share of the span that accelerates, above 0 and below 1'
)
_RAMP_DOWN = LawParameter(
    'ramp_down', None, 'the share of the span that decelerates, above 0 and below 1; '
    'together with ramp_up at most 1'
)


@register('universal', 'universal cam curve of Makino: seven stages between the joints T1 to T6',
          'H. Makino (1976), universal cam curve', _JOINTS, generic=True)
def universal(joints: tuple[float, ...]) -> Piecewise:
    """
    Build the universal cam curve from its joints.

    Parameters
    ----------
    joints : tuple[float, ...], 6 values
        T1 to T6, as shares of the span [-]: quarter sine to T1, constant to T2, quarter cosine
        to T3, no acceleration to T4, and the same with the other sign to T5, T6 and 1.

    Returns
    -------
    Piecewise
        The rise from 0 to 1, at rest at both ends.

    Raises
    ------
    ConfigurationError
        When the joints fall, or one half has no length.

    Notes
    -----
    It is `modified_trapezoid` said in joints instead of lengths. Members: parabola
    (0, 1/2, 1/2, 1/2, 1/2, 1), simple harmonic (0, 0, 1/2, 1/2, 1, 1), cycloidal
    (1/4, 1/4, 1/2, 1/2, 3/4, 3/4), modified trapezoid (1/8, 3/8, 1/2, 1/2, 5/8, 7/8), modified
    sine (1/8, 1/8, 1/2, 1/2, 7/8, 7/8), modified constant velocity
    (1/16, 1/16, 1/4, 3/4, 15/16, 15/16).

    """
    ends = (0.0, *joints, 1.0)
    lengths = tuple(b - a for a, b in zip(ends, ends[1:]))
    if min(lengths) < 0.0 or joints[2] == 0.0 or joints[3] == 1.0:
        raise _JOINTS.problem(list(joints), 'the modified sine has 0.125, 0.125, 0.5, 0.5, '
                              '0.875, 0.875')
    return modified_trapezoid(lengths)


@register('scca', 'sine, constant, cosine acceleration by three shares (Norton b, c, d)',
          'R. L. Norton, Cam Design and Manufacturing Handbook (2002), SCCA family',
          _SHARES, _NO_HOLD, INFLECTION, generic=True)
def scca(shares: tuple[float, ...], constant_velocity: float, inflection: float) -> Piecewise:
    """
    Build a law of the sine - constant - cosine acceleration family.

    Parameters
    ----------
    shares : tuple[float, ...], 3 values
        Shares b, c, d of the quarter sines at the ends, the constant accelerations and the
        quarter cosines towards the middle [-], of what is not at constant velocity.
    constant_velocity : float
        Share of the span at constant velocity [-].
    inflection : float
        Share of the span that accelerates, half of the constant velocity included [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1, at rest at both ends.

    Raises
    ------
    ConfigurationError
        When the shares do not sum to 1 or nothing is left to accelerate in.

    Notes
    -----
    Members without constant velocity: constant acceleration (0, 1, 0), modified trapezoid
    (1/4, 1/2, 1/4), simple harmonic (0, 0, 1), modified sine (1/4, 0, 3/4), cycloidal
    (1/2, 0, 1/2).

    """
    total = math.fsum(shares)
    if abs(total - 1.0) > SUM_TOLERANCE:
        raise _SHARES.problem(list(shares), f'they sum to {total:.9g}')
    if constant_velocity >= 1.0:
        raise _NO_HOLD.problem(constant_velocity, 'take the law constant_velocity for a line')
    grow, flat, fade = (0.5 * (1.0 - constant_velocity) * x / total for x in shares)
    curve = modified_trapezoid((grow, flat, fade, constant_velocity, fade, flat, grow))
    return with_inflection(curve, inflection)


@register('modified_sine', 'slow and fast sine: little torque at finite jerk (Neklutin)',
          'VDI 2143 sheet 1, modified sine line', INFLECTION)
def modified_sine(inflection: float) -> Piecewise:
    """
    Build the modified sine: the acceleration rises over 1/8 and fades over 3/8 of the span.

    Parameters
    ----------
    inflection : float
        Share of the span that accelerates [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1, at rest at both ends; Cv = 4 pi/(4 + pi), Ca = 4 pi²/(4 + pi).

    References
    ----------
    C. N. Neklutin, Mechanisms and Cams for Automatic Machines (1969).

    """
    return scca((0.25, 0.0, 0.75), 0.0, inflection)


@register('modified_constant_velocity', 'modified sine with a stretch of constant velocity (MCV)',
          'R. L. Norton, Cam Design and Manufacturing Handbook (2002), SCCA family',
          _HOLD, INFLECTION, members=(
              Member('MCV20', {'constant_velocity': 0.2}),
              Member('MCV33', {'constant_velocity': 1.0 / 3.0}),
              Member('MCV50', {'constant_velocity': 0.5})))
def modified_constant_velocity(constant_velocity: float, inflection: float) -> Piecewise:
    """
    Build the modified sine with constant velocity between its halves.

    Parameters
    ----------
    constant_velocity : float
        Share of the span at constant velocity [-]: 0.5 is the law known as MCV50.
    inflection : float
        Share of the span that accelerates, half of the constant velocity included [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1, at rest at both ends.

    Raises
    ------
    ConfigurationError
        When nothing is left to accelerate in.

    """
    return scca((0.25, 0.0, 0.75), constant_velocity, inflection)


@register('cycloidal_constant_velocity', 'cycloidal with a stretch of constant velocity',
          'R. L. Norton, Cam Design and Manufacturing Handbook (2002), SCCA family',
          _HOLD, INFLECTION, members=(
              Member('cycloidal CV50', {'constant_velocity': 0.5}),))
def cycloidal_constant_velocity(constant_velocity: float, inflection: float) -> Piecewise:
    """
    Build the cycloidal law with constant velocity between its halves.

    Parameters
    ----------
    constant_velocity : float
        Share of the span at constant velocity [-].
    inflection : float
        Share of the span that accelerates, half of the constant velocity included [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1, at rest at both ends.

    Raises
    ------
    ConfigurationError
        When nothing is left to accelerate in.

    """
    return scca((0.5, 0.0, 0.5), constant_velocity, inflection)


@register('smooth_trapezoidal_velocity', 'trapezoidal velocity with half-sine accelerations',
          'L. Biagiotti, C. Melchiorri, Trajectory Planning for Automatic Machines and Robots '
          '(2008), chapter 3', _RAMP_UP, _RAMP_DOWN)
def smooth_trapezoidal_velocity(ramp_up: float, ramp_down: float | None) -> Piecewise:
    """
    Build the law of trapezoidal velocity whose ramps are cycloidal.

    Parameters
    ----------
    ramp_up : float
        Share of the span that accelerates [-].
    ramp_down : float | None
        Share of the span that decelerates [-]; None takes ``ramp_up``.

    Returns
    -------
    Piecewise
        The rise from 0 to 1, at rest at both ends.

    Raises
    ------
    ConfigurationError
        When a ramp has no length or both together exceed 1.

    """
    down = ramp_up if ramp_down is None else ramp_down
    hold = 1.0 - ramp_up - down
    if ramp_up == 0.0:
        raise _RAMP_UP.problem(ramp_up)
    if down == 0.0 or hold < -SUM_TOLERANCE:
        raise _RAMP_DOWN.problem(down, f'ramp_up + ramp_down is {ramp_up + down:g}')
    up, down = 0.5 * ramp_up, 0.5 * down
    return modified_trapezoid((up, 0.0, up, max(hold, 0.0), down, 0.0, down))
