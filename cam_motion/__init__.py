# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
The electronic line shaft for ROS 2.

Timing diagrams become a synchronised machine: exact motion laws, cam profiles, a virtual master
shaft, electronic-cam axes and drives. Everything offered here works without ROS.
"""

from importlib import import_module
from typing import Any, TYPE_CHECKING

if TYPE_CHECKING:
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

_HOMES = {
    'errors': ('CamMotionError', 'ConfigurationError', 'Problem'),
    'motion.diagram': ('Axis', 'TimingDiagram'),
    'motion.laws': ('LAWS', 'MotionLaw', 'make_law'),
    'motion.limits': ('Limits',),
    'motion.point_to_point': ('PointToPoint',),
    'motion.profile': ('CamProfile',),
    'motion.segment': ('Segment', 'segment'),
}


def __getattr__(name: str) -> Any:
    """
    Import what is offered here when it is first used.

    A node has to obey signals before numpy and scipy are there, which takes most of a second.

    Parameters
    ----------
    name : str
        Something of this package.

    Returns
    -------
    Any
        It.

    Raises
    ------
    AttributeError
        When there is no such thing.

    """
    for module, names in _HOMES.items():
        if name in names:
            return getattr(import_module(f'{__name__}.{module}'), name)
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
