# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
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
