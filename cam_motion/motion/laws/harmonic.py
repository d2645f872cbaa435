# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
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
