# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The topics of a line, as its machine file implies them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from cam_motion.io.axis import Values
from cam_motion.io.interlocks import line_values
from cam_motion.io.line_parts import guess_line, shaft_drives
from cam_motion.io.servo_parameters import SERVO
from cam_motion.io.tracks import track_names
from cam_motion.nodes.diagnostics import TOPIC as DIAGNOSTICS
from cam_motion.nodes.qos import LATCHED, SETPOINTS
from rclpy.qos import QoSProfile

_POINT = 'trajectory_msgs/msg/JointTrajectoryPoint'
_JOINTS = 'sensor_msgs/msg/JointState'
_NUMBER = 'std_msgs/msg/Float64'
_TEXT = 'std_msgs/msg/String'


class LineTopic(NamedTuple):
    """Name (relative unless global), type and offered quality of service of a topic."""

    name: str
    type_name: str
    qos: QoSProfile


def topics_of(sections: Mapping[str, Values]) -> list[LineTopic]:
    """
    List what a line publishes.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, object]]
        Parameters of every node, by node name.

    Returns
    -------
    list[LineTopic]
        The topics of the contract.

    """
    names, _ = line_values(sections.get('line', guess_line(sections)))
    # a drive that turns the shaft is the master
    masters = [] if shaft_drives(sections, names['drives']) else [names['master']]
    parts = [*masters, *names['axes'], *names['drives'], *names['linkages'], 'line']
    return [
        LineTopic('shaft', _POINT, SETPOINTS),
        LineTopic('joint_states', _JOINTS, SETPOINTS),
        *(LineTopic(f'{axis}/setpoint', _POINT, SETPOINTS) for axis in names['axes']),
        *(LineTopic(f'{axis}/max_speed_cpm', _NUMBER, LATCHED) for axis in names['axes']),
        *(LineTopic(f'{axis}/format_change', _NUMBER, LATCHED) for axis in names['axes']),
        *(LineTopic(f'{drive}/drive_state', _JOINTS, SETPOINTS) for drive in names['drives']),
        *(LineTopic(f'{drive}/actual', _POINT, SETPOINTS) for drive in names['drives']
          if sections.get(drive, {}).get('mode') == SERVO),
        *(LineTopic(f'{linkage}/joint_states', _JOINTS, SETPOINTS)
          for linkage in names['linkages']),
        *(LineTopic(f'{linkage}/markers', 'visualization_msgs/msg/MarkerArray', SETPOINTS)
          for linkage in names['linkages']),
        *(LineTopic(f'{part}/{track}', 'std_msgs/msg/Bool', LATCHED)
          for part in parts for track in track_names(sections.get(part, {}))),
        *(LineTopic(f'{axis}/trajectory', 'trajectory_msgs/msg/JointTrajectory', SETPOINTS)
          for axis in names['axes'] if sections.get(axis, {}).get('trajectory.rate_hz')),
        *(LineTopic(f'{part}/state', _TEXT, LATCHED) for part in parts),
        LineTopic(DIAGNOSTICS, 'diagnostic_msgs/msg/DiagnosticArray', SETPOINTS),
    ]
