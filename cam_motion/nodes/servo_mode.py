# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A drive that follows an axis as a servo motor under its control loop can."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cam_motion.drive.servo_axis import ServoState
from cam_motion.drive.set_motion import Setpoint
from cam_motion.io.machine import build_drive
from cam_motion.io.parameters import ParameterSpec
from cam_motion.io.servo_parameters import follower_table
from cam_motion.nodes import diagnostics
from cam_motion.nodes.drive_mode import SetpointMode
from cam_motion.nodes.follow_mode import JOINTS
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.qos import SETPOINTS
from cam_motion.nodes.wire import JointStateCodec, pack_point
from cam_motion.runtime.point import Point
from cam_motion.runtime.ticks import NANOSECONDS
from cam_motion.units import RPM
from rclpy.timer import Timer
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectoryPoint

_WATCH_PERIOD = 0.02  # how often [s] it is looked whether setpoints still come
_LATE = 0.1  # a look that comes so long after the one before [s] is that of a late wake-up


class ServoMode(SetpointMode):
    """
    Publishes what motor, load and axis really do for every setpoint of an axis.

    When the setpoints fall silent, the drive brings its axis to rest from the last one on, and
    goes on publishing at the rate at which it looks for them.
    """

    def __init__(self, node: ManagedNode, own_process: bool) -> None:
        """Know no setpoint yet."""
        super().__init__(node, own_process)
        self._timer: Timer | None = None
        self._last: ServoState | None = None  # None until the first setpoint
        self._silent = False

    @classmethod
    def table(cls, given: Mapping[str, Any]) -> tuple[ParameterSpec, ...]:
        """List the parameters of a servo drive; see `DriveMode.table`."""
        return follower_table(given)

    def configure(self, values: Mapping[str, Any]) -> None:
        """
        Build the drive and create the topics.

        Parameters
        ----------
        values : Mapping[str, Any]
            All parameters by flat name.

        """
        built = build_drive(self.node.get_name(), values)
        assert built.servo is not None  # the mode says so
        self._settings = built.servo
        self._servo = built.servo.axis(built.drive)
        self._codec = JointStateCodec(JOINTS, with_effort=True)
        self._states = self.node.make_publisher(JointState, '~/drive_state', SETPOINTS)
        self._actual = self.node.make_publisher(JointTrajectoryPoint, '~/actual', SETPOINTS)
        self.listen_to(built.axis, with_shaft=bool(built.drive.edges))

    def activate(self) -> None:
        """Wait for setpoints; the first one is where the drive stands."""
        super().activate()
        self._last, self._silent = None, False
        self._seen, self._heard_ns, self._looked_ns = self.answered, 0, 0
        self._timer = self.node.create_timer(_WATCH_PERIOD, self._watch)

    def deactivate(self) -> None:
        """Cease to look for setpoints."""
        if self._timer is not None:
            self.node.destroy_timer(self._timer)
            self._timer = None

    def cleanup(self) -> None:
        """Give the timer back."""
        self.deactivate()

    def respond(self, setpoint: Point, stamp_ns: int) -> None:
        """
        Move on to a setpoint, and publish the state of the drive there.

        Parameters
        ----------
        setpoint : Point
            Position, velocity and acceleration of the axis.
        stamp_ns : int
            When it was due, in the node's time [ns].

        """
        time_ns = setpoint.sec * NANOSECONDS + setpoint.nanosec
        to = Setpoint(time_ns, setpoint.position, setpoint.velocity, setpoint.acceleration,
                      self.shaft_angle(setpoint))
        if self._last is None:
            state = self._servo.start(to)
        elif time_ns < self._last.time_ns - NANOSECONDS:
            # the machine's time base has begun anew, as with another master
            self._time.forget()
            self._time.begins(time_ns)
            stamp_ns = self._time.stamp(time_ns)
            state = self._servo.start(to)
        else:
            state = self._servo.follow(to, self._settings.max_catch_up_ns)
        if self._silent:
            self._silent = False
            self.node.set_state('following')
        self._publish(state, stamp_ns, setpoint.sec, setpoint.nanosec)

    def _publish(self, state: ServoState, stamp_ns: int, sec: int, nanosec: int) -> None:
        self._last = state
        shafts = state.drive
        self._states.publish(self._codec.pack(
            stamp_ns, (shafts.motor_position, shafts.load_position),
            (shafts.motor_velocity, shafts.load_velocity),
            (shafts.motor_torque, shafts.load_torque)))
        self._actual.publish(pack_point(
            state.position, state.velocity, state.acceleration, sec, nanosec))

    def _watch(self) -> None:
        """Look whether setpoints still come, and come to rest if they do not."""
        now_ns = self.node.get_clock().now().nanoseconds
        # after a late wake-up setpoints may wait in the queue: who has slept has heard no silence
        late = now_ns - self._looked_ns > _LATE * NANOSECONDS
        self._looked_ns = now_ns
        if late or self.answered != self._seen:
            self._seen, self._heard_ns = self.answered, now_ns
        if self._last is None or not self.node.active or not self._time.known:
            return
        if not self._silent:
            if now_ns - self._heard_ns <= self._settings.setpoint_timeout * NANOSECONDS:
                return
            self._silent = True
            self._servo.come_to_rest(self._settings.stop_time_ns)
            self.node.set_state('silent')
            self.node.get_logger().warning(
                f'no setpoint of {self.axis} for {self._settings.setpoint_timeout:g} s: '
                'coming to rest')
        time_ns = min(now_ns - self._time.stamp(0),
                      self._last.time_ns + self._settings.max_catch_up_ns)
        if time_ns > self._last.time_ns:
            self._publish(self._servo.advance(time_ns), self._time.stamp(time_ns),
                          *divmod(time_ns, NANOSECONDS))

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the drive is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics; a warning where a limit was reached, time was
            dropped, points were none, or the motor runs too warm.

        """
        if self._last is None:
            return diagnostics.OK, {}
        tally, shafts = self._servo.tally, self._last.drive
        values = {
            'states': self.answered, 'refused_points': self.refused,
            'motor_torque': shafts.motor_torque,
            'motor_speed_rpm': shafts.motor_velocity / RPM,
            'peak_motor_torque': tally.peak_torque,
            'running_rms_torque': tally.running_rms_torque,
            'thermal_load_pct': 100.0 * tally.thermal_load,
            'following_error': self._last.following_error,
            'peak_following_error': tally.peak_error,
            'saturations': tally.saturations,
            'saturated_s': tally.saturated_ns / NANOSECONDS,
            'dropped_s': tally.dropped_ns / NANOSECONDS,
            'regenerated_energy': tally.regenerated_energy, **self.lost,
        }
        current = self._settings.motor.current(shafts.motor_torque)
        if current is not None:
            values['motor_current'] = current
        bad = (self.refused or self.lost or tally.saturations or tally.dropped_ns
               or tally.thermal_load > 1.0)
        return diagnostics.WARN if bad else diagnostics.OK, values
