# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Quality of service of the topics."""

from __future__ import annotations

from copy import copy
from typing import Any

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

SETPOINTS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST, depth=10, reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE)
"""Streams of setpoints: reliable, so that best-effort readers are served too."""

BURST = 5
"""Points that come late are given so many at a time at most: with more, the last would push the
first out of the history of their stream before a busy reader has taken it."""

LATCHED = QoSProfile(
    history=HistoryPolicy.KEEP_LAST, depth=1, reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""State that late joiners need."""


def overridable(profile: QoSProfile) -> dict[str, Any]:
    """
    Let users override the policies of a topic the ROS way, by parameters.

    Parameters
    ----------
    profile : QoSProfile
        Policies where nobody overrides them.

    Returns
    -------
    dict[str, Any]
        Arguments of `create_publisher` or `create_subscription`. The profile is a copy: rclpy
        writes the overrides into the one it is given.

    """
    return {
        'qos_profile': copy(profile),
        'qos_overriding_options': QoSOverridingOptions.with_default_policies(),
    }
