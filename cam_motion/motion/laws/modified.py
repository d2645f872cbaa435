# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The modified trapezoid: seven stages of acceleration, sinusoidal and constant."""

from __future__ import annotations

from collections.abc import Iterator
import math

from cam_motion.motion.laws.law import Member, register
from cam_motion.motion.laws.parameters import LawParameter, SHORTEST_STAGE, SUM_TOLERANCE
from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.rise import ending_at_one, from_acceleration

_FRACTIONS = LawParameter(
    'fractions', (0.125, 0.25, 0.125, 0.0, 0.125, 0.25, 0.125),
    'seven stage lengths, each from 0 to 1, that sum to 1; the first three and the last three '
    'must not all be 0', count=7,
)
_MEMBERS = (
    Member('MT 1/16', {'fractions': (0.0625, 0.375, 0.0625, 0.0, 0.0625, 0.375, 0.0625)}),
    Member('MT 40/60', {'fractions': (0.1, 0.2, 0.1, 0.0, 0.15, 0.3, 0.15)}),
    Member('MT of seven equal parts', {'fractions': (1.0 / 7.0,) * 7}),
)


@register('modified_trapezoid',
          'seven stages of acceleration: sine, constant, sine, zero, and back',
          'document 000, ModTVP; document 001, modified trapezoidal (seven parameters)',
          _FRACTIONS, members=_MEMBERS)
def modified_trapezoid(fractions: tuple[float, ...]) -> Piecewise:
    """
    Build the modified trapezoidal law from its seven stages.

    Parameters
    ----------
    fractions : tuple[float, ...], 7 values
        Lengths of the stages as shares of the span [-]. Stages 1 and 5 are quarter sines that
        grow, 3 and 7 quarter sines that fade, 2 and 6 constant, 4 has no acceleration. Stages
        of length zero drop out.

    Returns
    -------
    Piecewise
        The rise from 0 to 1, at rest at both ends.

    Raises
    ------
    ConfigurationError
        When the fractions do not sum to 1, or one half of the law has no length.

    Notes
    -----
    With k1 = 2 x1/pi + x2 + 2 x3/pi and k2 = 2 x5/pi + x6 + 2 x7/pi, the plateaus stand as
    A/B = k2/k1, so that the velocity returns to zero; the scale follows from s(1) = 1.
    Members of the family are the cycloidal law (1/4, 0, 1/4, 0, 1/4, 0, 1/4), constant
    acceleration (0, 1/2, 0, 0, 0, 1/2, 0), trapezoidal velocity (0, e, 0, 1 - 2e, 0, e, 0) and
    the simple harmonic law (0, 0, 1/2, 0, 1/2, 0, 0).

    References
    ----------
    P. L. Magnani, G. Ruggieri, Meccanismi per macchine automatiche (1986), from page 108;
    document 000.

    """
    total = math.fsum(fractions)
    if abs(total - 1.0) > SUM_TOLERANCE:
        raise _FRACTIONS.problem(list(fractions), f'they sum to {total:.9g}')
    x1, x2, x3, x4, x5, x6, x7 = (x / total for x in fractions)
    if max(x1, x2, x3) <= SHORTEST_STAGE or max(x5, x6, x7) <= SHORTEST_STAGE:
        raise _FRACTIONS.problem(list(fractions), 'give both halves some length')
    area_up = 2.0 / math.pi * (x1 + x3) + x2
    area_down = 2.0 / math.pi * (x5 + x7) + x6
    rise = from_acceleration([
        *_half(1.0 / area_up, x1, x2, x3),
        *([Piece(x4)] if x4 > SHORTEST_STAGE else []),
        *_half(-1.0 / area_down, x5, x6, x7),
    ])
    return ending_at_one(rise.pieces)


def _half(plateau: float, grow: float, hold: float, fade: float) -> Iterator[Piece]:
    """Give one half of the acceleration diagram: quarter sine, constant, quarter sine."""
    if grow > SHORTEST_STAGE:
        yield Piece(grow, (), (Wave(0.5 * math.pi / grow, 0.0, plateau),))
    if hold > SHORTEST_STAGE:
        yield Piece(hold, (plateau,))
    if fade > SHORTEST_STAGE:
        yield Piece(fade, (), (Wave(0.5 * math.pi / fade, plateau, 0.0),))
