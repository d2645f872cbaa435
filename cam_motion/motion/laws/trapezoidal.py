# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Laws of piecewise constant acceleration: the trapezoidal velocity family."""

from __future__ import annotations

from cam_motion.motion.laws.law import register
from cam_motion.motion.laws.parameters import LawParameter, SHORTEST_STAGE, SUM_TOLERANCE
from cam_motion.motion.piece import Piece
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.rise import ending_at_one

_SPLIT = LawParameter(
    'ramp_up', 0.5, 'the share of the span that accelerates, above 0 and below 1'
)
_RAMP_UP = LawParameter(
    'ramp_up', 1.0 / 3.0, 'the share of the span that accelerates, from 0 to 1'
)
_RAMP_DOWN = LawParameter(
    'ramp_down', None, 'the share of the span that decelerates, from 0 to 1; '
    'together with ramp_up at most 1'
)


@register('constant_acceleration', 'constant acceleration, then constant deceleration (parabola)',
          'document 000, ACS', _SPLIT)
def constant_acceleration(ramp_up: float) -> Piecewise:
    """
    Build the law of constant acceleration and constant deceleration.

    Parameters
    ----------
    ramp_up : float
        Share of the span that accelerates [-]; 0.5 is the symmetric law.

    Returns
    -------
    Piecewise
        The rise from 0 to 1.

    Raises
    ------
    ConfigurationError
        When the share is 0 or 1, which would make one acceleration infinite.

    """
    if not 0.0 < ramp_up < 1.0:
        raise _SPLIT.problem(ramp_up, 'take 0.5 for the symmetric law')
    return _trapezoid(ramp_up, 1.0 - ramp_up)


@register('trapezoidal_velocity', 'ramp up, constant velocity, ramp down (three-step law)',
          'document 000, TVP; document 001, asymmetric trapezoidal speed; '
          'document 002, three-step',
          _RAMP_UP, _RAMP_DOWN)
def trapezoidal_velocity(ramp_up: float, ramp_down: float | None) -> Piecewise:
    """
    Build the law of trapezoidal velocity.

    Parameters
    ----------
    ramp_up : float
        Share of the span that accelerates [-]; 0 lets the velocity step at the start.
    ramp_down : float | None
        Share of the span that decelerates [-]; None takes ``ramp_up``.

    Returns
    -------
    Piecewise
        The rise from 0 to 1.

    Raises
    ------
    ConfigurationError
        When both shares together exceed 1.

    Notes
    -----
    Document 001 names the abscissae alpha_v = ramp_up, alpha_w = 1 - ramp_down, alpha_s = 1.
    Its A = 2 h / (alpha_v (alpha_s - alpha_v + alpha_w)) and
    B = 2 h / ((alpha_s - alpha_w) (alpha_s - alpha_v + alpha_w)) are the two accelerations here.
    Document 002 prints A = V / (t0 - t1), which has the sign wrong: A = V / (t1 - t0).

    """
    down = ramp_up if ramp_down is None else ramp_down
    excess = ramp_up + down - 1.0
    if excess > SUM_TOLERANCE:
        raise _RAMP_DOWN.problem(down, f'ramp_up + ramp_down is {ramp_up + down:g}')
    if excess > 0.0:
        down -= excess
    return _trapezoid(ramp_up, down)


def _trapezoid(up: float, down: float) -> Piecewise:
    speed = 2.0 / (2.0 - up - down)
    hold = 1.0 - up - down
    pieces = []
    if up > SHORTEST_STAGE:
        pieces.append(Piece(up, (0.0, 0.0, 0.5 * speed / up)))
    position = 0.5 * speed * up
    if hold > SHORTEST_STAGE:
        pieces.append(Piece(hold, (position, speed)))
        position += speed * hold
    if down > SHORTEST_STAGE:
        pieces.append(Piece(down, (position, speed, -0.5 * speed / down)))
    return ending_at_one(pieces)
