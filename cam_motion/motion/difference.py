# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""How far two exact curves are apart, exactly."""

from __future__ import annotations

from itertools import zip_longest
import math

from cam_motion.errors import DomainError
from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.piecewise import Peak, Piecewise
import numpy as np

_SAME = 1e-12  # joints closer than this share of the curve are one
_POINTS = 9  # per piece, to find those that can hold the largest distance
_SURE = 0.7  # share of the largest distance at these points below which a piece cannot hold it


def stretch_of(piece: Piece, start: float, length: float) -> Piece:
    """
    Cut a stretch out of a piece.

    Parameters
    ----------
    piece : Piece
        The piece.
    start, length : float
        Where the stretch starts in the piece's own coordinate, and how long it is.

    Returns
    -------
    Piece
        The same curve, its coordinate starting at the stretch.

    """
    coefficients = []
    derived = Piece(piece.length, piece.coefficients)
    for order in range(len(piece.coefficients)):
        coefficients.append(derived.at(start) / math.factorial(order))
        derived = derived.derivative
    waves = []
    for omega, cosine, sine in piece.waves:
        c, s = math.cos(omega * start), math.sin(omega * start)
        waves.append(Wave(omega, cosine * c + sine * s, sine * c - cosine * s))
    return Piece(length, tuple(coefficients), tuple(waves))


def difference(first: Piecewise, second: Piecewise) -> Piecewise:
    """
    Subtract one curve from another.

    Parameters
    ----------
    first, second : Piecewise
        Two curves over the same range.

    Returns
    -------
    Piecewise
        first - second, exact, with the joints of both.

    Raises
    ------
    DomainError
        When they do not have the same range.

    """
    span = first.end - first.start
    if max(abs(first.start - second.start), abs(first.end - second.end)) > 1e-9 * span:
        raise DomainError('curves over different ranges have no difference')
    joints = np.unique([*first.breaks, *second.breaks])
    joints = joints[np.concatenate([[True], np.diff(joints) > _SAME * span])]
    joints[-1] = max(joints[-1], first.end)
    pieces = []
    for low, high in zip(joints[:-1].tolist(), joints[1:].tolist()):
        middle = 0.5 * (low + high)
        parts = []
        for curve in (first, second):
            place = int(np.searchsorted(curve.breaks, middle, side='right')) - 1
            place = min(max(place, 0), len(curve.pieces) - 1)
            parts.append(stretch_of(curve.pieces[place], low - curve.breaks[place], high - low))
        ours, theirs = parts
        pieces.append(Piece(
            high - low, tuple(a - b for a, b in zip_longest(
                ours.coefficients, theirs.coefficients, fillvalue=0.0)),
            (*ours.waves, *(Wave(w, -c, -s) for w, c, s in theirs.waves))))
    return Piecewise(float(joints[0]), pieces, joints.tolist())


def largest(curve: Piecewise, order: int = 0) -> Peak:
    """
    Find the largest value of a curve of very many pieces, or of its derivative.

    Parameters
    ----------
    curve : Piecewise
        The curve, mostly a `difference`.
    order : int
        Order of the derivative.

    Returns
    -------
    Peak
        The value largest in magnitude, with its sign, and its abscissa; at steps both sides
        count.

    """
    derivative = curve.differentiated(order)
    sizes = np.array([np.abs(piece(np.linspace(0.0, piece.length, _POINTS))).max()
                      for piece in derivative.pieces])
    worth = np.flatnonzero(sizes >= _SURE * sizes.max())
    found = [Piecewise(curve.breaks[n], [derivative.pieces[n]]).peak(0) for n in worth]
    return max(found, key=lambda peak: abs(peak.value))
