# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A drive that follows an axis: what torque and speed its motor and load shaft see."""

from __future__ import annotations

from collections.abc import Mapping
import sys
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.machine import build_drive, LINE_SHAFT
from cam_motion.io.parameters import DRIVE_SIM
from cam_motion.nodes import diagnostics
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.qos import SETPOINTS
from cam_motion.nodes.runner import run
from cam_motion.nodes.wire import JointStateCodec, Point, unpack_point
from cam_motion.runtime.ticks import NANOSECONDS
from cam_motion.units import RPM
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectoryPoint

JOINTS = ('motor', 'load')


class DriveSim(ManagedNode):
    """
    Publishes position, speed and torque of motor and load for every setpoint of an axis.

    Parameters
    ----------
    name : str
        Name of the node.
    own_process : bool
        Whether setpoints come over the topic; else the owner of the process hands them over by
        calling `answer`.
    **options : Any
        Further arguments of `rclpy.node.Node`.

    """

    TABLE = DRIVE_SIM

    def __init__(self, name: str = 'drive_sim', own_process: bool = True, **options: Any) -> None:
        """Declare the parameters."""
        super().__init__(name, **options)
        self._own_process = own_process
        self._states: Publisher | None = None

    def configure(self, values: dict[str, Any]) -> None:
        """
        Build the drive and create the topics.

        Parameters
        ----------
        values : dict[str, Any]
            All parameters by flat name.

        """
        if values.get('mode') == LINE_SHAFT:
            raise ConfigurationError([Problem(
                'mode', LINE_SHAFT, 'this node follows an axis, it does not turn the shaft yet',
                'cam_motion simulate computes the drive')])
        settings = build_drive(self.get_name(), values)
        self._axis = settings.axis
        self._drive = settings.drive
        self._codec = JointStateCodec(JOINTS, with_effort=True)
        self._epoch_ns: int | None = None  # node time at which the machine's time base began
        self._answered = 0
        self._refused = 0
        self._peak_torque = 0.0
        self._states = self.make_publisher(JointState, '~/drive_state', SETPOINTS)
        if self._own_process:
            self.make_subscription(
                JointTrajectoryPoint, f'{self._axis}/setpoint', self._on_setpoint, SETPOINTS,
                raw=True)

    def cleanup(self) -> None:
        """Drop the topics."""
        super().cleanup()
        self._states = None

    def activate(self) -> None:
        """Wait for setpoints."""
        self._epoch_ns = None
        self.set_state('waiting')

    def answer(self, setpoint: Point) -> None:
        """
        Answer a setpoint of the axis with the state of the drive.

        Parameters
        ----------
        setpoint : Point
            Position, velocity and acceleration of the axis.

        """
        if not self.active:
            return
        time_ns = setpoint.sec * NANOSECONDS + setpoint.nanosec
        if self._epoch_ns is None or self._clock_started_over(time_ns):
            self._epoch_ns = self.get_clock().now().nanoseconds - time_ns
            self.set_state('following')
        state = self._drive.follow(setpoint.position, setpoint.velocity, setpoint.acceleration)
        self._last = state
        self._peak_torque = max(self._peak_torque, abs(state.motor_torque))
        self._answered += 1
        self._states.publish(self._codec.pack(
            self._epoch_ns + time_ns,
            (state.motor_position, state.load_position),
            (state.motor_velocity, state.load_velocity),
            (state.motor_torque, state.load_torque)))

    def _clock_started_over(self, time_ns: int) -> bool:
        """Tell whether /clock has jumped back: the machine's time base goes on, stamps do not."""
        if not self.sim_time:
            return False
        return self.get_clock().now().nanoseconds < self._epoch_ns + time_ns - NANOSECONDS

    def _on_setpoint(self, data: bytes) -> None:
        setpoint = unpack_point(data)
        if setpoint is not None:
            self.answer(setpoint)
            return
        self._refused += 1
        self.get_logger().warning(
            'setpoint: a point without exactly one finite position, velocity and acceleration '
            'was left out', throttle_duration_sec=1.0)

    @property
    def hardware_id(self) -> str:
        """Name the axis that the drive moves."""
        return self._axis if self._states is not None else self.get_name()

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the drive is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics.

        """
        if self._states is None or not self._answered:
            return diagnostics.OK, {}
        return diagnostics.WARN if self._refused else diagnostics.OK, {
            'states': self._answered, 'refused_points': self._refused,
            'motor_torque': self._last.motor_torque,
            'motor_speed_rpm': self._last.motor_velocity / RPM,
            'peak_motor_torque': self._peak_torque,
        }


def main(argv: list[str] | None = None) -> int:
    """
    Run the node as a process.

    Parameters
    ----------
    argv : list[str], optional
        Command line; None takes that of the process.

    Returns
    -------
    int
        Exit code.

    """
    return run(lambda: [DriveSim()], argv)


if __name__ == '__main__':
    sys.exit(main())
