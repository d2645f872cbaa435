# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
Conversion factors between the units of people and the SI units used inside.

Degrees, revolutions and cycles per minute appear only at the edges, in names that end in
``_deg``, ``_rpm`` and ``_cpm``. One cycle of the shaft is one turn of 2 pi.
"""

from __future__ import annotations

import math

TURN = 2.0 * math.pi
"""One turn of a shaft, one cycle of the machine [rad]."""

DEGREE = math.pi / 180.0
"""One degree [rad]."""

RPM = TURN / 60.0
"""One revolution, or one cycle, per minute [rad/s]."""

MM = 1e-3
"""One millimetre [m]."""

_POWERS = ('', '', '²', '³', '⁴', '⁵', '⁶')


def rate_text(unit: str, order: int, base: str = 's') -> str:
    """
    Write the unit of a derivative.

    Parameters
    ----------
    unit : str
        Unit of the quantity itself (``m``).
    order : int
        Order of the derivative, 0 to 6.
    base : str
        Unit of the variable of differentiation (``s``, ``rad``).

    Returns
    -------
    str
        The unit, for example ``m/s²``.

    """
    return unit if order == 0 else f'{unit}/{base}{_POWERS[order]}'
