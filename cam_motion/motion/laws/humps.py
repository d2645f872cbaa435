# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Humps of sinusoidal acceleration, from which laws between any two velocities are made."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
import math
from typing import NamedTuple

from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.rise import ending_at_one

_SLOW = 0.75  # share of a hump of the modified sine that its slow quarter sine has


class QuarterSine(NamedTuple):
    """A quarter sine of acceleration: its length [-], and whether it grows or fades."""

    length: float
    grows: bool

    def piece(self, height: float) -> Piece:
        """
        Give the acceleration.

        Parameters
        ----------
        height : float
            Its largest value [-].

        Returns
        -------
        Piece
            The acceleration.

        """
        omega = 0.5 * math.pi / self.length
        return Piece(self.length, (), (
            Wave(omega, 0.0, height) if self.grows else Wave(omega, height, 0.0),))


def hump(length: float) -> list[QuarterSine]:
    """
    Give the first hump of the modified sine: a short quarter sine up, a long one down.

    Parameters
    ----------
    length : float
        Length of both together [-].

    Returns
    -------
    list[QuarterSine]
        The two.

    """
    return [QuarterSine((1.0 - _SLOW) * length, True), QuarterSine(_SLOW * length, False)]


def mirrored(hump: Sequence[QuarterSine]) -> list[QuarterSine]:
    """
    Turn a hump round.

    Parameters
    ----------
    hump : Sequence[QuarterSine]
        The hump.

    Returns
    -------
    list[QuarterSine]
        The last first, each growing where it faded.

    """
    return [QuarterSine(wave.length, not wave.grows) for wave in reversed(hump)]


def joining(first: Sequence[QuarterSine], second: Sequence[QuarterSine], start: float,
            end: float) -> Piecewise:
    """
    Find the heights of two humps that join two velocities over a lift of 1.

    Parameters
    ----------
    first, second : Sequence[QuarterSine]
        The humps; their lengths sum to 1.
    start, end : float
        Velocities at the ends, in lifts per span [-].

    Returns
    -------
    Piecewise
        The curve from 0 to 1.

    """
    one, other = (integrated([wave.piece(1.0) for wave in waves], 0.0)
                  for waves in (first, second))
    gain1, gain2 = one.end_values(1)[1], other.end_values(1)[1]
    lift1 = one.end_values(0)[1] + gain1 * other.end
    lift2 = other.end_values(0)[1]
    lift, gain = 1.0 - start, end - start
    # gain1 a + gain2 b = gain, lift1 a + lift2 b = lift
    scale = gain1 * lift2 - gain2 * lift1
    a, b = (gain * lift2 - gain2 * lift) / scale, (gain1 * lift - gain * lift1) / scale
    pieces = [*(wave.piece(a) for wave in first), *(wave.piece(b) for wave in second)]
    return ending_at_one(integrated(pieces, start).pieces)


def integrated(accelerations: Iterable[Piece], velocity: float) -> Piecewise:
    """
    Integrate an acceleration twice, from position 0 with a given velocity.

    Parameters
    ----------
    accelerations : Iterable[Piece]
        The acceleration, piece by piece.
    velocity : float
        Velocity at the start.

    Returns
    -------
    Piecewise
        The position.

    """
    position, pieces = 0.0, []
    for acceleration in accelerations:
        speed = acceleration.integral(velocity)
        pieces.append(speed.integral(position))
        velocity, position = speed.at(speed.length), pieces[-1].at(speed.length)
    return Piecewise(0.0, pieces)


def to_one(rise: Piecewise) -> Piecewise:
    """
    Scale a curve so that it ends at 1.

    Parameters
    ----------
    rise : Piecewise
        A curve over a length of 1.

    Returns
    -------
    Piecewise
        The curve from 0 to 1.

    """
    scale = 1.0 / rise.end_values(0)[1]
    return ending_at_one([piece.scaled(1.0, scale) for piece in rise.pieces])


def backwards(curve: Piecewise) -> Piecewise:
    """
    Turn a law round: 1 - s(1 - xi).

    Parameters
    ----------
    curve : Piecewise
        The law.

    Returns
    -------
    Piecewise
        The law that does at its start what the other does at its end.

    """
    return ending_at_one([_reversed(piece) for piece in reversed(curve.pieces)])


def _reversed(piece: Piece) -> Piece:
    """Give 1 - f(length - u)."""
    count, length = len(piece.coefficients), piece.length
    coefficients = [
        -(-1) ** k * math.fsum(math.comb(n, k) * piece.coefficients[n] * length ** (n - k)
                               for n in range(k, count))
        for k in range(count)] or [0.0]
    coefficients[0] += 1.0
    waves = []
    for omega, cosine, sine in piece.waves:
        c, s = math.cos(omega * length), math.sin(omega * length)
        waves.append(Wave(omega, -(cosine * c + sine * s), -(cosine * s - sine * c)))
    return Piece(length, tuple(coefficients), tuple(waves))
