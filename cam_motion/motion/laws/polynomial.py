# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Laws that are one polynomial."""

from __future__ import annotations

from cam_motion.motion.laws.law import register
from cam_motion.motion.piece import Piece
from cam_motion.motion.piecewise import Piecewise


@register('dwell', 'no movement', 'document 000')
def dwell() -> Piecewise:
    """
    Build the law that stays where it is, s = 0.

    Returns
    -------
    Piecewise
        Zero over the whole span; the one law with s(1) = 0.

    """
    return Piecewise(0.0, [Piece(1.0, (0.0,))])


@register('constant_velocity', 'straight line; its velocity steps at a dwell',
          'VDI 2143 sheet 1, straight line')
def constant_velocity() -> Piecewise:
    """
    Build the straight line, s = xi.

    Returns
    -------
    Piecewise
        The rise from 0 to 1.

    """
    return Piecewise(0.0, [Piece(1.0, (0.0, 1.0))])


@register('cubic', 'cubic parabola: the law of least RMS acceleration',
          'document 001, cubic curve')
def cubic() -> Piecewise:
    """
    Build the cubic law, s = 3 xi² - 2 xi³.

    Returns
    -------
    Piecewise
        The rise from 0 to 1. Its acceleration is 6 at the start and -6 at the end, so it steps
        at a dwell.

    """
    return Piecewise(0.0, [Piece(1.0, (0.0, 0.0, 3.0, -2.0))])
