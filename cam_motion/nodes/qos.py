# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""Quality of service of the topics."""

from __future__ import annotations

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

SETPOINTS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST, depth=10, reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE)
"""Streams of setpoints: reliable, so that best-effort readers are served too."""

LATCHED = QoSProfile(
    history=HistoryPolicy.KEEP_LAST, depth=1, reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""State that late joiners need."""


def overridable() -> QoSOverridingOptions:
    """
    Let users override the policies the ROS way, by parameters.

    Returns
    -------
    QoSOverridingOptions
        Options for a publisher or subscription.

    """
    return QoSOverridingOptions.with_default_policies()
