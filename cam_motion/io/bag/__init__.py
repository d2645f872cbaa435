# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""Bags of rosbag2: a writer whose bag is valid at any moment, and a reader for any bag."""

from cam_motion.io.bag.error import BagError
from cam_motion.io.bag.qos import QosProfile
from cam_motion.io.bag.reader import BagReader
from cam_motion.io.bag.series import JointStateSeries, PointSeries, read_joint_states, read_points
from cam_motion.io.bag.topic_info import TopicInfo
from cam_motion.io.bag.writer import BagWriter

__all__ = [
    'BagError',
    'BagReader',
    'BagWriter',
    'JointStateSeries',
    'PointSeries',
    'QosProfile',
    'TopicInfo',
    'read_joint_states',
    'read_points',
]
