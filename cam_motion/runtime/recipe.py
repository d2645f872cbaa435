# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What an axis remembers of a transition: how it was planned, what it waits for and leaves."""

from __future__ import annotations

from collections.abc import Callable
import math
from typing import NamedTuple

from cam_motion.motion.limits import SpeedBound
from cam_motion.runtime.follower_settings import FollowerState
from cam_motion.runtime.layout import Layout
from cam_motion.runtime.planning import Target, Timing

Anchor = Callable[[float, float, float], Layout]
"""Anchors a layout for an axis that joins it from a position, at a shaft angle, in a sense."""


class Recipe(NamedTuple):
    """
    What a transition is planned from, so that it can be planned anew.

    The ``target`` and the ``timing``, the states while it goes on (``begun``) and after it
    (``through``), and the ``bound`` of the shaft that comes with the target, if it is known.
    """

    target: Target
    timing: Timing
    begun: FollowerState = FollowerState.CHANGING
    through: FollowerState = FollowerState.IN_SYNC
    bound: SpeedBound | None = None


class Joining(NamedTuple):
    """
    A way onto the curve that waits for the shaft to slow down.

    Its ``timing`` and ``anchored``, and the ``highest_speed`` up to which it has been found to
    fit [rad/s].
    """

    timing: Timing
    anchored: Anchor
    highest_speed: float = math.inf


class Leaving(NamedTuple):
    """What holds until a transition has begun: a ``layout``, and a ``highest_speed`` [rad/s]."""

    layout: Layout
    highest_speed: float = math.inf
