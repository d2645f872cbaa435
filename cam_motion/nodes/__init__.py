# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""The ROS 2 nodes: thin shells around the core, the only place that imports rclpy."""
