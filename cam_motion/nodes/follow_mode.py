# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A drive that follows an axis exactly: what torque and speed that costs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cam_motion.drive.inverse import DriveState
from cam_motion.io.machine import build_drive
from cam_motion.io.parameters import ParameterSpec
from cam_motion.io.servo_parameters import follower_table
from cam_motion.nodes import diagnostics
from cam_motion.nodes.drive_mode import SetpointMode
from cam_motion.nodes.qos import SETPOINTS
from cam_motion.nodes.wire import JointStateCodec
from cam_motion.runtime.point import Point
from cam_motion.units import RPM
from sensor_msgs.msg import JointState

JOINTS = ('motor', 'load')


class FollowMode(SetpointMode):
    """Publishes position, speed and torque of motor and load for every setpoint of an axis."""

    @classmethod
    def table(cls, given: Mapping[str, Any]) -> tuple[ParameterSpec, ...]:
        """List the parameters of a drive that follows; see `DriveMode.table`."""
        return follower_table(given)

    def configure(self, values: Mapping[str, Any]) -> None:
        """
        Build the drive and create the topics.

        Parameters
        ----------
        values : Mapping[str, Any]
            All parameters by flat name.

        """
        settings = build_drive(self.node.get_name(), values)
        self._drive = settings.drive
        self._codec = JointStateCodec(JOINTS, with_effort=True)
        self._peak_torque = 0.0
        self._last: DriveState | None = None
        self._states = self.node.make_publisher(JointState, '~/drive_state', SETPOINTS)
        self.listen_to(settings.axis, with_shaft=bool(settings.drive.edges))

    def respond(self, setpoint: Point, stamp_ns: int) -> None:
        """
        Publish the state of the drive at a setpoint.

        Parameters
        ----------
        setpoint : Point
            Position, velocity and acceleration of the axis.
        stamp_ns : int
            When it was due, in the node's time [ns].

        """
        state = self._drive.follow(setpoint.position, setpoint.velocity, setpoint.acceleration,
                                   self.shaft_angle(setpoint))
        self._last = state
        self._peak_torque = max(self._peak_torque, abs(state.motor_torque))
        self._states.publish(self._codec.pack(
            stamp_ns,
            (state.motor_position, state.load_position),
            (state.motor_velocity, state.load_velocity),
            (state.motor_torque, state.load_torque)))

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the drive is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics.

        """
        if self._last is None:
            return diagnostics.OK, {}
        return diagnostics.WARN if self.refused or self.lost else diagnostics.OK, {
            'states': self.answered, 'refused_points': self.refused,
            'motor_torque': self._last.motor_torque,
            'motor_speed_rpm': self._last.motor_velocity / RPM,
            'peak_motor_torque': self._peak_torque, **self.lost,
        }
