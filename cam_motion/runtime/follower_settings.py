# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What an axis that follows the shaft may do, and the names of what it does."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from cam_motion.motion.limits import Limits
from cam_motion.runtime.planning import Timing
from cam_motion.runtime.ramp import RampLimits


class FollowerState(Enum):
    """What an axis does; the value is its name on the state topic."""

    DISENGAGED = 'disengaged'
    WAITING = 'waiting'
    ENGAGING = 'engaging'
    IN_SYNC = 'in_sync'
    CHANGING = 'changing'
    DISENGAGING = 'disengaging'
    STOPPING_ON_CURVE = 'stopping_on_curve'
    HELD = 'held'
    FAULT = 'fault'


@dataclass(frozen=True)
class FollowerSettings:
    """
    What an axis may, and how it is to engage, disengage, change and resume.

    Attributes
    ----------
    limits : Limits
        Limits of the axis.
    shaft_ramp : RampLimits
        Acceleration and jerk of the shaft that every transition leaves room for.
    engage, disengage, change, resume : Timing
        When each of these transitions begins and how long it may take; `resume` at an angle
        means the angle at which the axis came to be held.
    master_relative : bool
        Whether engaging starts the cams at their own beginning, wherever the shaft is.
    slave_relative : bool
        Whether engaging adds the cams to the position at which the axis stands.
    start_position : float
        Where an axis stands that is not engaged from the start.
    stop_position : float | None
        Where the axis is to stand when disengaged; None stops it where it is.
    obeyed : bool
        Whether the shaft can be asked to run no faster than a transition bears.

    """

    limits: Limits = field(default_factory=Limits)
    shaft_ramp: RampLimits = RampLimits(30.0, 300.0)
    engage: Timing = field(default_factory=Timing)
    disengage: Timing = field(default_factory=Timing)
    change: Timing = field(default_factory=Timing)
    resume: Timing = field(default_factory=Timing)
    master_relative: bool = False
    slave_relative: bool = False
    start_position: float = 0.0
    stop_position: float | None = None
    obeyed: bool = True
