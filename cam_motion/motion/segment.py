# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A segment of a cam: one motion law over a span of the shaft with a lift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cam_motion.motion.laws import make_law, MotionLaw
from cam_motion.units import DEGREE


@dataclass(frozen=True)
class Segment:
    """
    What an axis does up to a shaft angle.

    Attributes
    ----------
    name : str
        The segment's name.
    law : MotionLaw
        The motion law; the dwell for standing still.
    end_deg : float
        Shaft angle at which the segment ends [deg]; it starts where the one before ends.
    lift : float
        Change of position, in the unit of the axis; may be negative.

    """

    name: str
    law: MotionLaw
    end_deg: float
    lift: float = 0.0

    @property
    def end(self) -> float:
        """Shaft angle at which the segment ends [rad]."""
        return self.end_deg * DEGREE

    @property
    def is_dwell(self) -> bool:
        """Whether the axis stands still in this segment."""
        return self.law.name == 'dwell'

    @property
    def is_auto(self) -> bool:
        """Whether the neighbours decide about the curve."""
        return self.law.name == 'auto'

    @property
    def is_spline(self) -> bool:
        """Whether the curve goes through the points of a table."""
        return self.law.name == 'spline'

    @property
    def gain(self) -> float:
        """Factor from the law to the position: 1 where the curve has the axis' unit."""
        return 1.0 if self.is_auto or self.is_spline else self.lift


def segment(name: str, end_deg: float, lift: float = 0.0, law: str = 'dwell',
            **parameters: Any) -> Segment:
    """
    Make a segment, its law given by name.

    Parameters
    ----------
    name : str
        The segment's name.
    end_deg : float
        Shaft angle at which the segment ends [deg].
    lift : float
        Change of position, in the unit of the axis.
    law : str
        Name of the motion law.
    **parameters : Any
        Parameters of the law.

    Returns
    -------
    Segment
        The segment.

    Raises
    ------
    ConfigurationError
        When the law or its parameters are wrong.

    """
    return Segment(name, make_law(law, **parameters), end_deg, lift)
