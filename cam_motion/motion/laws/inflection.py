# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Asymmetry of a symmetric law: the share of the span at which its acceleration changes sign."""

from __future__ import annotations

from collections.abc import Iterator
import math

from cam_motion.motion.laws.parameters import LawParameter, SHORTEST_STAGE
from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.rise import ending_at_one

INFLECTION = LawParameter(
    'inflection', 0.5,
    'the share of the span at which the acceleration changes its sign, above 0 and below 1',
)
"""Parameter of every symmetric law that can be made asymmetric."""


def with_inflection(symmetric: Piecewise, inflection: float) -> Piecewise:
    """
    Move the point of inflection of a symmetric rise.

    Parameters
    ----------
    symmetric : Piecewise
        A rise from 0 to 1 with s(1 - xi) = 1 - s(xi).
    inflection : float
        Share of the span that accelerates [-]; 0.5 leaves the law as it is.

    Returns
    -------
    Piecewise
        The rise whose halves span ``inflection`` and ``1 - inflection``.

    Raises
    ------
    ConfigurationError
        When one half would have no length.

    Notes
    -----
    A half that spans lambda instead of 1/2 keeps its largest velocity when its lift becomes
    lambda, too. The velocity coefficient so stays what it is; the two acceleration coefficients
    become Ca / (2 lambda) and Ca / (2 (1 - lambda)).

    References
    ----------
    VDI 2143 sheet 1 (1980), asymmetric laws; document 000, modified trapezoid with unequal halves.

    """
    if not 0.0 < inflection < 1.0:
        raise INFLECTION.problem(inflection, 'take 0.5 for the symmetric law')
    if inflection == 0.5:
        return symmetric
    up, down = 2.0 * inflection, 2.0 * (1.0 - inflection)
    pieces = []
    for begin, piece in _halves(symmetric):
        scale = up if begin < 0.5 else down
        pieces.append(piece.scaled(scale, scale, 0.0 if begin < 0.5 else 1.0 - down))
    return ending_at_one(pieces)


def _halves(curve: Piecewise) -> Iterator[tuple[float, Piece]]:
    """Give each piece with its beginning, the one across the middle in two parts."""
    for begin, piece in zip(curve.breaks, curve.pieces):
        head = 0.5 - begin
        if head <= SHORTEST_STAGE:
            yield max(begin, 0.5), piece
        elif piece.length - head <= SHORTEST_STAGE:
            yield begin, piece
        else:
            yield begin, Piece(head, piece.coefficients, piece.waves)
            yield 0.5, _tail(piece, head)


def _tail(piece: Piece, start: float) -> Piece:
    """Cut the beginning off a piece."""
    count = len(piece.coefficients)
    coefficients = tuple(
        math.fsum(math.comb(n, k) * piece.coefficients[n] * start ** (n - k)
                  for n in range(k, count))
        for k in range(count))
    waves = []
    for omega, cosine, sine in piece.waves:
        c, s = math.cos(omega * start), math.sin(omega * start)
        waves.append(Wave(omega, cosine * c + sine * s, sine * c - cosine * s))
    return Piece(piece.length - start, coefficients, tuple(waves))
