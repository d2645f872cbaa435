# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The torque that the load of a cam shaft asks for, at rest and at constant speed."""

from __future__ import annotations

import math

from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.collocation import gauss_rule
from cam_motion.units import TURN
import numpy as np

_DENSE = 129  # angles per element at which the peak of the load is looked for
_POINTS = 8


class ShaftLoad:
    """
    The load of a cam shaft, whatever turns it.

    Parameters
    ----------
    drive : CamDrive
        The drive; its motor, gearbox and flywheel do not count.

    """

    def __init__(self, drive: CamDrive) -> None:
        """Tabulate the load over the shaft angle."""
        rule = gauss_rule(_POINTS)
        dense, inner = [], []
        for element in drive.elements:
            span = element.end - element.start
            dense.append(drive.terms(drive.follower(
                element, np.linspace(element.start, element.end, _DENSE))))
            inner.append(drive.terms(drive.follower(
                element, element.start + span * rule.points)))
        self._dense, self._inner = (
            tuple(np.concatenate([getattr(terms, name) for terms in table])
                  for name in ('centripetal', 'force', 'damping')) for table in (dense, inner))
        self._weights = np.concatenate(
            [(e.end - e.start) * rule.weights for e in drive.elements]) / TURN
        self.static_peak = max(0.0, -float(np.min(self._dense[1])))

    def torques(self, omega: float) -> tuple[float, float]:
        """
        Give the torque that turns the shaft at a constant speed.

        Parameters
        ----------
        omega : float
            The speed [rad/s].

        Returns
        -------
        tuple[float, float]
            Peak of its magnitude, and RMS over the shaft angle [N m].

        """
        dense, inner = (c * omega * omega - q0 - q1 * omega
                        for c, q0, q1 in (self._dense, self._inner))
        return (float(np.max(np.abs(dense))),
                math.sqrt(float(self._weights @ inner ** 2)))
