# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The offset of a translating roller that allows the smallest base circle."""

from __future__ import annotations

import math
from typing import NamedTuple

from cam_motion.mechanism.cam_extremes import extremes
from cam_motion.mechanism.cam_limits import CamLimits
from cam_motion.motion.profile import CamProfile


class OffsetDesign(NamedTuple):
    """An offset of a translating roller, and the base radius that goes with it [m]."""

    offset: float
    base_radius: float


def best_offset(profile: CamProfile, sense: int, roller_radius: float, outwards: float,
                inwards: float) -> OffsetDesign:
    """
    Find the offset that allows the smallest base circle within limits of the pressure angle.

    Parameters
    ----------
    profile : CamProfile
        Travel of the roller [m].
    sense : int
        Sense of rotation.
    roller_radius : float
        Radius of the roller [m].
    outwards, inwards : float
        Largest pressure angle while the disc drives the roller outwards, and while it comes
        back [rad].

    Returns
    -------
    OffsetDesign
        Offset and base radius, exact, no radius below 0; undercutting is another question.

    Notes
    -----
    With y0 the height of the roller's centre at zero travel and e the offset, the limits say
    y0 >= (s' - e) cot(out) - s and y0 >= (e - s') cot(in) - s: the shaft must lie within a
    wedge. The least y0² + e² within it is at its tip, or at the foot of the perpendicular on
    one of its sides.

    References
    ----------
    K.-J. Flocke, Zur Konstruktion von Kurvengetrieben bei Verarbeitungsmaschinen (1931); VDI 2142
    part 1 (1994).

    """
    CamLimits(outwards, inwards)
    rise, fall = 1.0 / math.tan(outwards), 1.0 / math.tan(inwards)
    first = extremes(profile, lambda at: at.s1 * rise - at.s)[1].value
    second = extremes(profile, lambda at: -at.s1 * fall - at.s)[1].value

    def height(offset: float) -> float:
        return max(first - offset * rise, second + offset * fall)

    feet = ((first - second) / (rise + fall), first * rise / (1.0 + rise * rise),
            -second * fall / (1.0 + fall * fall))
    offset = min(feet, key=lambda e: math.hypot(height(e), e))
    prime = math.hypot(height(offset), offset)
    return OffsetDesign(sense * offset, max(prime - roller_radius, 0.0))
