# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""An electronic-cam axis: answers every shaft point with a setpoint on its motion curve."""

from __future__ import annotations

from collections.abc import Callable, Mapping
import sys
from typing import Any

from cam_motion.io.axis import build_axis
from cam_motion.io.parameters import CAM_AXIS
from cam_motion.nodes import diagnostics
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.qos import SETPOINTS
from cam_motion.nodes.runner import run
from cam_motion.nodes.shaft_watch import ShaftWatch
from cam_motion.nodes.wire import pack_point, Point, unpack_point
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft_motion import ShaftMotion, ShaftState
from cam_motion.runtime.ticks import NANOSECONDS
from rclpy.publisher import Publisher
from rclpy.timer import Timer
from trajectory_msgs.msg import JointTrajectoryPoint

Listener = Callable[[Point], None]


class CamAxis(ManagedNode):
    """
    Publishes position, velocity and acceleration of one axis for every shaft point received.

    Parameters
    ----------
    name : str
        Name of the node, which is the name of the axis.
    own_process : bool
        Whether shaft points come over the topic; else the owner of the process hands them over
        by calling `answer`.
    **options : Any
        Further arguments of `rclpy.node.Node`.

    """

    TABLE = CAM_AXIS

    def __init__(self, name: str = 'cam_axis', own_process: bool = True, **options: Any) -> None:
        """Declare the parameters."""
        super().__init__(name, **options)
        self.listeners: list[Listener] = []
        """Called with every setpoint: drives of the same process."""
        self._own_process = own_process
        self._setpoints: Publisher | None = None

    def configure(self, values: dict[str, Any]) -> None:
        """
        Compile the cam and create the topics.

        Parameters
        ----------
        values : dict[str, Any]
            All parameters by flat name.

        """
        if 'segments' not in values:
            self.get_logger().info(
                f'no parameters for a node named {self.get_name()}: is that the axis? '
                'Give its name with -r __node:=NAME')
        self.axis = build_axis(self.get_name(), values)
        self._sample = self.axis.profile.sample
        self._stop_limits = RampLimits(
            *(self.get_parameter(name).value for name in ('stop_acceleration', 'stop_jerk')))
        self._watch = ShaftWatch()
        self._last: Point | None = None  # the last setpoint
        self._answered = 0
        self._refused = 0
        self._coast: ShaftMotion | None = None
        self._coast_timer: Timer | None = None
        self._setpoints = self.make_publisher(JointTrajectoryPoint, '~/setpoint', SETPOINTS)
        if self._own_process:
            self.make_subscription(
                JointTrajectoryPoint, 'shaft', self._on_shaft, SETPOINTS, raw=True)

    def cleanup(self) -> None:
        """Drop the topics."""
        super().cleanup()
        self._setpoints = None

    def activate(self) -> None:
        """Wait for the shaft."""
        self.set_state('waiting')

    def deactivate(self) -> None:
        """Leave a hold setpoint behind: the last position, no velocity, no acceleration."""
        if self._coast_timer is not None:
            self.destroy_timer(self._coast_timer)
            self._coast_timer = None
        self._coast = None
        if self._last is not None:
            self._emit(self._last._replace(velocity=0.0, acceleration=0.0))

    def answer(self, point: Point) -> None:
        """
        Answer a shaft point with a setpoint.

        Parameters
        ----------
        point : Point
            Angle, speed and acceleration of the shaft.

        """
        if not self.active or self._coast is not None:
            return
        self._watch.note(point)
        self._follow(point)
        if self._answered == 0:
            self.set_state('in_sync')
        self._answered += 1

    def _on_shaft(self, data: bytes) -> None:
        point = unpack_point(data)
        if point is not None:
            self.answer(point)
            return
        self._refused += 1
        self.get_logger().warning(
            'shaft: a point without exactly one finite position, velocity and acceleration '
            'was left out', throttle_duration_sec=1.0)

    def _follow(self, point: Point) -> None:
        phi, omega, alpha, sec, nanosec = point
        y, slope, bend, _ = self._sample(phi)
        self._emit(Point(
            y, slope * omega, bend * omega * omega + slope * alpha, sec, nanosec))

    def _emit(self, setpoint: Point) -> None:
        self._last = setpoint
        self._setpoints.publish(pack_point(*setpoint))
        for listener in self.listeners:
            listener(setpoint)

    def begin_stop(self) -> None:
        """Follow a shaft that comes to rest; else stop on the axis' own curve."""
        if self.active:
            self._watch.begin_stop(self.steady_now())

    @property
    def stopped(self) -> bool:
        """Whether the axis stands."""
        if not self.active or self._watch.at_rest:
            return True
        if self._coast is None and self._watch.goes_on(self.steady_now()):
            self._begin_coast()
        return False

    def _begin_coast(self) -> None:
        """Ramp a shaft of our own down, so that the axis stops on its curve."""
        shaft = self._watch.last
        motion = ShaftMotion(shaft.time, ShaftState(*shaft[:3]))
        self._coast = motion.ramped(shaft.time, 0.0, self._stop_limits)
        self._coast_ns = shaft.sec * NANOSECONDS + shaft.nanosec
        self.set_state('stopping_on_curve')
        self._coast_timer = self.create_timer(
            self._watch.period, self._on_coast, clock=self.steady_clock)

    def _on_coast(self) -> None:
        self._coast_ns += round(self._watch.period * NANOSECONDS)
        state = self._coast.state(self._coast_ns * 1e-9)
        point = Point(*state, *divmod(self._coast_ns, NANOSECONDS))
        self._watch.note(point)
        self._follow(point)
        if self._watch.at_rest:
            self._coast_timer.cancel()
            self.set_state('held')

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the axis is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics.

        """
        if self._setpoints is None:
            return diagnostics.OK, {}
        last = self._last
        values: dict[str, Any] = {'setpoints': self._answered, 'refused_points': self._refused}
        if last is not None:
            values |= {'position': last.position, 'velocity': last.velocity,
                       'acceleration': last.acceleration, 'unit': self.axis.unit}
        return diagnostics.WARN if self._refused else diagnostics.OK, values


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
    return run(lambda: [CamAxis()], argv)


if __name__ == '__main__':
    sys.exit(main())
