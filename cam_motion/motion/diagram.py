# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The timing diagram: several cams on one shaft."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from cam_motion.motion.limits import Limits, SpeedBound
from cam_motion.motion.profile import CamProfile


@dataclass(frozen=True)
class Axis:
    """
    One axis of a machine: what it does and what it may.

    Attributes
    ----------
    name : str
        Name of the axis.
    profile : CamProfile
        Its cam.
    unit : str
        Unit of its position (``m``, ``rad``).
    limits : Limits
        Its limits.

    """

    name: str
    profile: CamProfile
    unit: str = 'm'
    limits: Limits = field(default_factory=Limits)

    def bound_by(self, limits: Limits) -> SpeedBound | None:
        """
        Find the highest steady shaft speed within given limits.

        Parameters
        ----------
        limits : Limits
            The limits.

        Returns
        -------
        SpeedBound | None
            The speed and what holds it there; None where nothing does.

        """
        return limits.highest_speed(self.profile)

    @property
    def speed_bound(self) -> SpeedBound | None:
        """Find the highest steady shaft speed within the limits, and what holds it there."""
        return self.bound_by(self.limits)


@dataclass(frozen=True)
class TimingDiagram:
    """
    All axes that one shaft drives.

    Attributes
    ----------
    axes : Mapping[str, Axis]
        The axes by name, in the order of the machine.

    """

    axes: Mapping[str, Axis]

    def speed_bound(self) -> tuple[str, SpeedBound] | None:
        """
        Find the highest steady shaft speed within the limits of all axes.

        Returns
        -------
        tuple[str, SpeedBound] | None
            The axis that holds the shaft back, and its bound; None where nothing does.

        """
        bounds = {
            name: bound for name, axis in self.axes.items()
            if (bound := axis.speed_bound) is not None
        }
        if not bounds:
            return None
        slowest = min(bounds, key=lambda name: bounds[name].omega)
        return slowest, bounds[slowest]
