# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What takes long the first time, done before the first tick instead of in the middle of one."""

from __future__ import annotations

import inspect

from cam_motion.motion.limits import Limits
from cam_motion.runtime.demand import Demand
from cam_motion.runtime.layout import Layout
from cam_motion.runtime.motion_over_angle import Standstill
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.transition import Blend


def warm_up_logging() -> None:
    """
    Let rclpy find out quickly who logs.

    With each message it asks `inspect` for the module of the caller, which the first time goes
    through all modules there are: 30 ms of CPU time, more than the queue of a stream lasts.
    """
    inspect.getframeinfo(inspect.stack(context=0)[0].frame)


def warm_up_planning(layout: Layout) -> None:
    """
    Plan a transition that nobody has asked for: the first one imports parts of numpy.

    Parameters
    ----------
    layout : Layout
        Cams of the axis, which remember their peaks.

    """
    layout.speed_bound(Limits(velocity=1.0, acceleration=1.0))
    blend = Blend(Standstill(0.0), layout.motion, 0.0, 1.0)
    Demand(blend, 0.0, 1.0).highest_speed(Limits(velocity=1.0), RampLimits(0.0, 0.0))
