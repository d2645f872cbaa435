# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Coupled cams over one turn of the shaft, added up into one cam."""

from __future__ import annotations

from collections.abc import Sequence
import math
from typing import NamedTuple

from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.superposition import cut, superposed, window
from cam_motion.units import TURN


class Turned(NamedTuple):
    """
    A cam as it is coupled: ``scale`` times the ``profile`` at ``ratio`` phi + ``phase``.

    The ``ratio`` is a whole number of turns of the cam per turn of the shaft, not 0, below 0 for
    a cam that turns backwards; the ``phase`` an angle of the cam [rad].
    """

    profile: CamProfile
    ratio: int
    phase: float
    scale: float


class TurnProfile(CamProfile):
    """
    What coupled cams make of one turn of the shaft, as one cam.

    Parameters
    ----------
    cams : Sequence[Turned]
        The cams, at least one. Segments and names are those of the first one.
    offset : float
        Added to the position, in the unit of the axis.

    Notes
    -----
    The pieces of the cams are stretched, turned round, cut and added up as they are: the curve is
    as exact as they.

    """

    def __init__(self, cams: Sequence[Turned], offset: float = 0.0) -> None:
        """Add the cams up."""
        self.segments, self.accumulate = cams[0].profile.segments, any(
            each.profile.accumulate for each in cams)
        self.advance = math.fsum(each.scale * each.ratio * each.profile.advance for each in cams)
        self.curve = superposed([
            *((each.scale, _over_a_turn(each)) for each in cams),
            (1.0, Piecewise(0.0, [Piece(TURN, (offset,))], [0.0, TURN]))])
        self.parts = (self.curve,)


def _over_a_turn(cam: Turned) -> Piecewise:
    """Give a cam over the angle of the shaft."""
    times = abs(cam.ratio)
    low = cam.phase if cam.ratio > 0 else cam.phase - times * TURN
    curve = window(cam.profile.curve, cam.profile.advance, low, low + times * TURN)
    pieces = [_compressed(piece, times) for piece in curve.pieces]
    if cam.ratio < 0:
        pieces = [_mirrored(piece) for piece in reversed(pieces)]
    breaks = [0.0]
    for piece in pieces[:-1]:
        breaks.append(breaks[-1] + piece.length)
    return Piecewise(0.0, pieces, [*breaks, TURN])


def _compressed(piece: Piece, times: int) -> Piece:
    return Piece(
        piece.length / times,
        tuple(value * times ** k for k, value in enumerate(piece.coefficients)),
        tuple(Wave(times * omega, cosine, sine) for omega, cosine, sine in piece.waves))


def _mirrored(piece: Piece) -> Piece:
    about_end = cut(piece, piece.length, 2.0 * piece.length)
    return Piece(
        piece.length,
        tuple(-value if k % 2 else value for k, value in enumerate(about_end.coefficients)),
        tuple(Wave(omega, cosine, -sine) for omega, cosine, sine in about_end.waves))
