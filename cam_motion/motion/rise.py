# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Building the normalised rise of a law from its pieces."""

from __future__ import annotations

from collections.abc import Iterable

from cam_motion.motion.piece import Piece
from cam_motion.motion.piecewise import Piecewise


def from_acceleration(pieces: Iterable[Piece], start: float = 0.0) -> Piecewise:
    """
    Integrate an acceleration diagram twice into a rise from 0 to 1 that starts at rest.

    Parameters
    ----------
    pieces : Iterable[Piece]
        The acceleration in any scale; its own integral must close to zero velocity if the rise
        is to end at rest.
    start : float
        Abscissa of the beginning.

    Returns
    -------
    Piecewise
        The normalised rise: value 0 and slope 0 at the start, value 1 at the end.

    """
    position, velocity = 0.0, 0.0
    rise: list[Piece] = []
    for acceleration in pieces:
        speed = acceleration.integral(velocity)
        rise.append(speed.integral(position))
        velocity, position = speed.at(speed.length), rise[-1].at(speed.length)
    return Piecewise(start, [piece.scaled(1.0, 1.0 / position) for piece in rise])


def ending_at_one(pieces: Iterable[Piece]) -> Piecewise:
    """
    Place the pieces of a law from 0 to exactly 1, whatever rounding makes of their sum.

    Parameters
    ----------
    pieces : Iterable[Piece]
        Pieces whose lengths sum to 1 but for rounding.

    Returns
    -------
    Piecewise
        The curve.

    """
    curve = Piecewise(0.0, pieces)
    return Piecewise(0.0, curve.pieces, (*curve.breaks[:-1], 1.0))
