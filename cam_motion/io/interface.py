# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The ROS interface of the nodes as data: README shows it, a test compares it with the nodes."""

from __future__ import annotations

from typing import NamedTuple


class Endpoint(NamedTuple):
    """
    A topic or service of a node: which way, its name, type and meaning.

    A mode behind the name of the node says that the node has it in that mode only.
    """

    node: str
    kind: str
    name: str
    type_name: str
    meaning: str


_POINT = 'trajectory_msgs/msg/JointTrajectoryPoint'
_JOINTS = 'sensor_msgs/msg/JointState'

_TRACK = 'std_msgs/msg/Bool'
_OF_TRACK = 'latched, at every change: whether the cam track of that name is on'

INTERFACE = (
    Endpoint('master_shaft', 'publishes', 'shaft', _POINT,
             'every tick: [φ], [ω], [α]; time_from_start is the scheduled time of the tick'),
    Endpoint('master_shaft', 'publishes', 'joint_states', _JOINTS, 'φ and ω for viewers'),
    Endpoint('master_shaft', 'subscribes', '~/speed_cpm', 'std_msgs/msg/Float64',
             'new set speed [cycles/min], at any moment'),
    Endpoint('master_shaft', 'serves', '~/run', 'std_srvs/srv/SetBool',
             'true: start or resume; false: controlled stop'),
    Endpoint('master_shaft', 'serves', '~/stop_at_cycle_end', 'std_srvs/srv/Trigger',
             'come to rest exactly at the end of a cycle'),
    Endpoint('master_shaft', 'serves', '~/quick_stop', 'std_srvs/srv/Trigger',
             'come to rest fast; stays stopped until reset'),
    Endpoint('master_shaft', 'serves', '~/reset', 'std_srvs/srv/Trigger',
             'acknowledge a quick stop'),
    Endpoint('master_shaft', 'subscribes', '<axis>/max_speed_cpm', 'std_msgs/msg/Float64',
             'what each axis allows: the shaft obeys the lowest'),
    Endpoint('master_shaft', 'publishes', '~/<track>', _TRACK, _OF_TRACK),
    Endpoint('cam_axis', 'subscribes', 'shaft', _POINT,
             'the shaft that the axis follows, or <axis>/setpoint'),
    Endpoint('cam_axis', 'publishes', '~/setpoint', _POINT,
             'one per shaft point: [y], [ẏ], [ÿ]; time_from_start is copied'),
    Endpoint('cam_axis', 'publishes', '~/max_speed_cpm', 'std_msgs/msg/Float64',
             'latched: the highest shaft speed that its limits allow now; inf: no limit, or the '
             'axis follows another one'),
    Endpoint('cam_axis', 'subscribes', 'format_change', 'std_msgs/msg/Float64',
             'shaft angle [rad], never wrapped: told once, every axis with a staged format '
             'answers whether it is ready; told again, it goes over there; NaN revokes'),
    Endpoint('cam_axis', 'publishes', '~/format_change', 'std_msgs/msg/Float64',
             'latched: the angle for which the axis is ready; NaN: none'),
    Endpoint('cam_axis', 'serves', '~/engage', 'std_srvs/srv/SetBool',
             'true: onto the curve; false: to standstill; answers with the plan and its peaks'),
    Endpoint('cam_axis', 'serves', '~/reset', 'std_srvs/srv/Trigger',
             'acknowledge a stop and come back onto the curve; answers with the plan'),
    Endpoint('cam_axis', 'publishes', '~/<track>', _TRACK, _OF_TRACK),
    Endpoint('cam_axis', 'publishes', '~/trajectory', 'trajectory_msgs/msg/JointTrajectory',
             'with trajectory.rate_hz: the setpoints of the next moments, for '
             'joint_trajectory_controller'),
    Endpoint('drive_sim', 'subscribes', '<axis>/setpoint', _POINT,
             'the axis that it moves; not with mode line_shaft'),
    Endpoint('drive_sim', 'subscribes', 'shaft', _POINT,
             'where a part of its load acts in a window of the shaft angle; not with mode '
             'line_shaft'),
    Endpoint('drive_sim', 'publishes', '~/drive_state', _JOINTS,
             'joints motor and load, with mode line_shaft also shaft: position, velocity, effort '
             '(rad, rad/s, N m); the effort of motor is that of the motor alone, without its '
             'brake'),
    Endpoint('drive_sim: servo', 'publishes', '~/actual', _POINT,
             'one per setpoint: what the axis really does, [y], [ẏ], [ÿ]; time_from_start is '
             'copied'),
    Endpoint('drive_sim: line_shaft', 'publishes', 'shaft', _POINT,
             'every tick, in the place of a master shaft'),
    Endpoint('drive_sim: line_shaft', 'publishes', 'joint_states', _JOINTS, 'φ and ω for viewers'),
    Endpoint('drive_sim: line_shaft', 'publishes', '~/<track>', _TRACK, _OF_TRACK),
    Endpoint('drive_sim: line_shaft', 'serves', '~/run', 'std_srvs/srv/SetBool',
             'true: release the brake, switch the motor on; false: switch it off, and coast'),
    Endpoint('drive_sim: line_shaft', 'serves', '~/quick_stop', 'std_srvs/srv/Trigger',
             'motor off, brake on; stays stopped until reset'),
    Endpoint('drive_sim: line_shaft', 'serves', '~/reset', 'std_srvs/srv/Trigger',
             'acknowledge a quick stop; the brake holds until the next run'),
    Endpoint('linkage_state', 'subscribes', '<axis>/setpoint', _POINT,
             'every axis that drives an input; points with the same time_from_start belong '
             'together'),
    Endpoint('linkage_state', 'publishes', '~/joint_states', _JOINTS,
             'per tick, or joint_states_hz: every input and unknown by name (rad, m), then '
             '<body>_x and <body>_y of the moving bodies, for the URDF; efforts that hold loads'),
    Endpoint('linkage_state', 'publishes', '~/markers', 'visualization_msgs/msg/MarkerArray',
             'markers_hz: links, slides, joints, names, velocity arrows; links in red while the '
             'inputs are out of range'),
    Endpoint('all', 'publishes', '~/state', 'std_msgs/msg/String', 'latched: what the node does'),
    Endpoint('all', 'publishes', '/diagnostics', 'diagnostic_msgs/msg/DiagnosticArray',
             'health and figures, once a second'),
)
"""Every topic and service of the nodes but those that ROS gives to every lifecycle node."""
