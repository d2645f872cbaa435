# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Pieces cut, moved and added up: what a filter over a cam needs, exact throughout."""

from __future__ import annotations

from collections.abc import Sequence
import math

from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.piecewise import Piecewise
import numpy as np

_SLIVER = 1e-12  # joints closer than this share of the span are one joint, apart by rounding


def cut(piece: Piece, low: float, high: float) -> Piece:
    """
    Cut a part out of a piece.

    Parameters
    ----------
    piece : Piece
        The piece.
    low, high : float
        Local coordinates of both ends, rising; the part may reach beyond the piece, which goes
        on as it is.

    Returns
    -------
    Piece
        The same function, its local coordinate counted from ``low``.

    """
    if not low:
        return Piece(high, piece.coefficients, piece.waves)
    coefficients = list(piece.coefficients)
    # repeated synthetic division by (u - low)
    for first in range(len(coefficients) - 1):
        for k in range(len(coefficients) - 2, first - 1, -1):
            coefficients[k] += low * coefficients[k + 1]
    waves = []
    for omega, cosine, sine in piece.waves:
        c, s = math.cos(omega * low), math.sin(omega * low)
        waves.append(Wave(omega, cosine * c + sine * s, sine * c - cosine * s))
    return Piece(high - low, tuple(coefficients), tuple(waves))


def total(pieces: Sequence[tuple[float, Piece]]) -> Piece:
    """
    Add up weighted pieces of one length.

    Parameters
    ----------
    pieces : Sequence[tuple[float, Piece]]
        Weights and pieces, at least one.

    Returns
    -------
    Piece
        The sum; sinusoids of one frequency become one.

    """
    degree = max(len(piece.coefficients) for _, piece in pieces)
    coefficients = [
        math.fsum(weight * piece.coefficients[k] for weight, piece in pieces
                  if k < len(piece.coefficients)) for k in range(degree)]
    waves: dict[float, tuple[float, float]] = {}
    for weight, piece in pieces:
        for omega, cosine, sine in piece.waves:
            c, s = waves.get(omega, (0.0, 0.0))
            waves[omega] = (c + weight * cosine, s + weight * sine)
    return Piece(pieces[0][1].length, tuple(coefficients),
                 tuple(Wave(omega, *sums) for omega, sums in waves.items()))


def window(curve: Piecewise, advance: float, low: float, high: float) -> Piecewise:
    """
    Take any stretch of a curve that repeats for ever.

    Parameters
    ----------
    curve : Piecewise
        One period.
    advance : float
        What the curve gains in each period.
    low, high : float
        Abscissae of the stretch, rising; they may lie in any period.

    Returns
    -------
    Piecewise
        The stretch.

    """
    period = curve.end - curve.start
    slack = _SLIVER * period
    turn = math.floor((low - curve.start) / period)
    pieces: list[Piece] = []
    breaks = [low]
    while breaks[-1] < high - slack:
        shift = turn * period
        for begin, piece in zip(curve.breaks, curve.pieces):
            begin += shift
            end = begin + piece.length
            if end <= breaks[-1] + slack or begin >= high - slack:
                continue
            # the last bit of a piece that would be a sliver belongs to its neighbour
            end = high if end >= high - slack else end
            part = cut(piece, breaks[-1] - begin, end - begin)
            if turn * advance:
                constant, *rest = part.coefficients or (0.0,)
                part = Piece(part.length, (constant + turn * advance, *rest), part.waves)
            pieces.append(part)
            breaks.append(end)
        turn += 1
    return Piecewise(low, pieces, breaks)


def superposed(curves: Sequence[tuple[float, Piecewise]]) -> Piecewise:
    """
    Add up weighted curves over one range.

    Parameters
    ----------
    curves : Sequence[tuple[float, Piecewise]]
        Weights and curves, at least one, all over the same range but for rounding.

    Returns
    -------
    Piecewise
        The sum; the joints of all curves are its joints.

    """
    start, end = curves[0][1].start, curves[0][1].end
    slack = _SLIVER * (end - start)
    breaks = [start]
    for at in np.unique(np.concatenate([curve.breaks for _, curve in curves])).tolist():
        if at > breaks[-1] + slack and at < end - slack:
            breaks.append(at)
    breaks.append(end)
    pieces = []
    for low, high in zip(breaks, breaks[1:]):
        middle = 0.5 * (low + high)
        parts = []
        for weight, curve in curves:
            n = int(np.searchsorted(curve.breaks[1:-1], middle))
            begin = curve.breaks[n]
            parts.append((weight, cut(curve.pieces[n], low - begin, high - begin)))
        pieces.append(total(parts))
    return Piecewise(start, pieces, breaks)
