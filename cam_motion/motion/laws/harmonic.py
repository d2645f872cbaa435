# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""Laws that are one sinusoid with a straight line."""

from __future__ import annotations

from cam_motion.motion.laws.law import register
from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.piecewise import Piecewise
from cam_motion.units import TURN


@register('cycloidal', 'sinusoidal acceleration (inclined sine, Bestehorn)',
          'document 002, cycloidal')
def cycloidal() -> Piecewise:
    """
    Build the cycloidal law, s = xi - sin(2 pi xi) / (2 pi).

    Returns
    -------
    Piecewise
        The rise from 0 to 1; velocity and acceleration are zero at both ends.

    """
    return Piecewise(0.0, [Piece(1.0, (0.0, 1.0), (Wave(TURN, 0.0, -1.0 / TURN),))])
