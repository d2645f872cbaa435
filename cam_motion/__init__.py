# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""
The electronic line shaft for ROS 2.

Timing diagrams become a synchronised machine: exact motion laws, cam profiles, a virtual master
shaft, electronic-cam axes and drives. Everything offered here works without ROS.
"""

from cam_motion.errors import CamMotionError, ConfigurationError, Problem
from cam_motion.motion.diagram import Axis, TimingDiagram
from cam_motion.motion.laws import LAWS, make_law, MotionLaw
from cam_motion.motion.limits import Limits
from cam_motion.motion.point_to_point import PointToPoint
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import Segment, segment

__all__ = [
    'Axis', 'CamMotionError', 'CamProfile', 'ConfigurationError', 'LAWS', 'Limits', 'MotionLaw',
    'PointToPoint', 'Problem', 'Segment', 'TimingDiagram', 'make_law', 'segment',
]
