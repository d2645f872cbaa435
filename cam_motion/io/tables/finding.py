# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""One thing that is wrong with a cam table, and the table that it is found in."""

from __future__ import annotations

from dataclasses import dataclass
import math

from cam_motion.io.tables.table import CamTable
from cam_motion.units import DEGREE, rate_text

ERROR, WARNING, NOTE = 'error', 'warning', 'note'
"""How bad it is."""


@dataclass(frozen=True)
class Finding:
    """
    One thing that is wrong with a table.

    Attributes
    ----------
    code : str
        Its name, for machines.
    severity : str
        ``error``: no cam can be made of it; ``warning``: the cam would jerk or be wrong;
        ``note``: to be known.
    line : int
        Line of the file; 0 where it concerns all of it.
    angle_deg : float
        Shaft angle [deg]; NaN likewise.
    value : float
        How large it is, in the unit that ``text`` names.
    text : str
        What is wrong.
    harm : str
        What comes of it at the stated speed.
    hint : str
        The way out.

    """

    code: str
    severity: str
    line: int
    angle_deg: float
    value: float
    text: str
    harm: str
    hint: str


@dataclass(frozen=True)
class Context:
    """
    What findings are told of.

    Attributes
    ----------
    table : CamTable
        The table.
    omega : float
        Speed of the shaft at which the harm is told [rad/s].
    unit : str
        Unit of the positions.

    """

    table: CamTable
    omega: float
    unit: str

    def found(self, code: str, severity: str, place: int | None, value: float, text: str,
              harm: str, hint: str) -> Finding:
        """
        Tell of something.

        Parameters
        ----------
        code, severity, text, harm, hint : str
            See `Finding`.
        place : int | None
            The point where it is; None where it concerns the whole table.
        value : float
            How large it is.

        Returns
        -------
        Finding
            With line and angle of the point.

        """
        line, angle = 0, math.nan
        if place is not None:
            line = self.table.lines[place]
            angle = (self.table.start + float(self.table.angle[place])) / DEGREE
        return Finding(code, severity, line, angle, float(value), text, harm, hint)

    def rate(self, value: float, order: int) -> str:
        """
        Write a derivative at the stated speed.

        Parameters
        ----------
        value : float
            The derivative by the angle [unit/rad^order].
        order : int
            Its order.

        Returns
        -------
        str
            The derivative by time, with its unit.

        """
        return f'{value * self.omega**order:.5g} {rate_text(self.unit, order)}'
