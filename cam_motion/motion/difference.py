# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""How far two exact curves are apart, exactly."""

from __future__ import annotations

from cam_motion.errors import DomainError
from cam_motion.motion.piecewise import Peak, Piecewise
from cam_motion.motion.superposition import superposed
import numpy as np

_POINTS = 9  # per piece, to find those that can hold the largest distance
_SURE = 0.7  # share of the largest distance at these points below which a piece cannot hold it


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
    return superposed([(1.0, first), (-1.0, second)])


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
