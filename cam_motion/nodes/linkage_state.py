# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A linkage that cam axes drive: joint states and markers for every tick, on its own branch."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from cam_motion.io.linkage_line import build_driven, linkage_table
from cam_motion.io.parameters import ParameterSpec
from cam_motion.mechanism.joints import LinkageJoints
from cam_motion.mechanism.outline import Outline
from cam_motion.mechanism.tracking import Tracker
from cam_motion.nodes import diagnostics
from cam_motion.nodes.linkage_markers import LinkageMarkers
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.parameters import values_of
from cam_motion.nodes.qos import SETPOINTS
from cam_motion.nodes.runner import run
from cam_motion.nodes.time_base import TimeBase
from cam_motion.nodes.wire import JointStateCodec, unpack_point
from cam_motion.runtime.pairing import Pairing
from cam_motion.runtime.point import Point
from cam_motion.runtime.slots import Slots
from cam_motion.runtime.ticks import NANOSECONDS
import numpy as np
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectoryPoint
from visualization_msgs.msg import MarkerArray

_FIRST = 100  # ticks' worth of way that the first one may take, to where the axes begin
_OUTLIVES = 3.0  # markers outlive that many of their periods,
_LEAST_LIFE = 1.0  # and at least this long [s]


class LinkageState(ManagedNode):
    """
    Publishes where the links of a linkage are, for the setpoints of the axes that drive it.

    It follows the inputs by certified steps only. When they leave the range in which the linkage
    can be assembled it stays at the last position, says which input is out of which range, and
    goes on from there when they return.

    Parameters
    ----------
    name : str
        Name of the node, which is the name of the linkage.
    own_process : bool
        Whether setpoints come over topics; else the owner of the process hands them over by
        calling `answer`.
    **options : Any
        Further arguments of `rclpy.node.Node`.

    """

    def __init__(self, name: str = 'linkage_state', own_process: bool = True, **options: Any,
                 ) -> None:
        """Declare the parameters."""
        self._own_process = own_process
        self._states: Publisher | None = None
        super().__init__(name, **options)

    @property
    def table(self) -> tuple[ParameterSpec, ...]:
        """List the parameters, which depend on the parts that the linkage has."""
        return linkage_table(values_of(self))

    def configure(self, values: dict[str, Any]) -> None:
        """
        Assemble the linkage and create the topics.

        Parameters
        ----------
        values : dict[str, Any]
            All parameters by flat name.

        """
        if 'inputs' not in values:
            self.get_logger().info(
                f'no parameters for a node named {self.get_name()}: is that the linkage? '
                'Give its name with -r __node:=NAME')
        settings = build_driven(self.get_name(), values)
        assembly, own = settings.assembly, settings.values
        outline = Outline(assembly)
        hz = own['markers_hz']
        self._settings = settings
        self._tracker = Tracker(assembly)
        self._tracker.prepare()
        self._joints = LinkageJoints(assembly, outline, settings.forces, settings.torques)
        self._codec = JointStateCodec(self._joints.names, with_effort=settings.loaded)
        self._markers = LinkageMarkers(
            assembly, outline, own['frame_id'], own['velocity_scale'],
            max(_LEAST_LIFE, _OUTLIVES / hz if hz else 0.0))
        self._time = TimeBase(self)
        self._answered = self._held = self._refused = 0
        self._states = self.make_publisher(JointState, '~/joint_states', SETPOINTS)
        self._drawing = self.make_publisher(MarkerArray, '~/markers', SETPOINTS)
        self._rest()
        if self._own_process:
            for axis in settings.axes:
                self.make_subscription(JointTrajectoryPoint, f'{axis}/setpoint',
                                       partial(self._on_setpoint, axis), SETPOINTS, raw=True)

    def _rest(self) -> None:
        """Wait for the first tick."""
        own = self._settings.values
        self._time.forget()
        self._pairing = Pairing(self._settings.axes)
        self._state_slots, self._marker_slots = (
            Slots(own[f'{what}_hz']) for what in ('joint_states', 'markers'))
        start = self._tracker.assembly.start
        self._inputs = [start[name] for name in self._settings.linkage.inputs]
        self._rates = np.zeros(len(start.values))
        self._begun, self._reason = False, ''

    def cleanup(self) -> None:
        """Drop the topics."""
        super().cleanup()
        self._states = None

    def activate(self) -> None:
        """Wait for setpoints."""
        self._rest()
        self.set_state('waiting')

    def answer(self, axis: str, setpoint: Point) -> None:
        """
        Take a setpoint of an axis; the last one of a tick moves the linkage.

        Parameters
        ----------
        axis : str
            Name of the axis.
        setpoint : Point
            Position, velocity and acceleration of the axis.

        """
        if not self.active or axis not in self._settings.axes:
            return
        points = self._pairing.take(axis, setpoint)
        if points is None:
            return
        time_ns = setpoint.sec * NANOSECONDS + setpoint.nanosec
        self._time.begins(time_ns)
        told = self._state_slots.due(time_ns)
        drawn = self._marker_slots.due(time_ns) and self._drawing.get_subscription_count() > 0
        if told or drawn:  # no need to know where the links are otherwise
            self._follow(points)
            self._publish(self._time.stamp(time_ns), told, drawn)

    def _follow(self, points: Mapping[str, Point]) -> None:
        """Move to where the axes are, or stay and say why not."""
        settings, tracker = self._settings, self._tracker
        speeds = [0.0] * len(self._inputs)
        for k, name in enumerate(settings.linkage.inputs):
            if name in settings.drives:
                drive = settings.drives[name]
                point = points[drive.axis]
                self._inputs[k] = drive.offset + drive.factor * point.position
                speeds[k] = drive.factor * point.velocity
        if not self._begun:
            tracker.unwind(self._inputs)
        reached = None
        for _ in range(1 if self._begun else _FIRST):
            reached = tracker.follow(self._inputs)
            if reached is not None or tracker.refusal is not None:
                break
        self._begun = True
        if reached is not None:
            self._rates = tracker.rates(speeds)
            self._answered += 1
            self._tell('')
            return
        self._rates = np.zeros(len(self._rates))
        if tracker.refusal is not None:
            self._held += 1
            if not self._reason:
                self._tell('; '.join(map(str, tracker.problems(self._inputs))))
        elif not self._reason:
            self.set_state('on its way to the inputs')

    def _tell(self, reason: str) -> None:
        """Say that the linkage is held, or that it follows."""
        if reason:
            self.get_logger().error(f'held at {self._tracker.pose.text}: {reason}')
        elif self._reason:
            self.get_logger().info('the inputs are back within their range: following')
        self._reason = reason
        self.set_state(f'held: {reason}' if reason else 'following')

    def _publish(self, stamp_ns: int, told: bool, drawn: bool) -> None:
        tracker = self._tracker
        if told and self.state_text == 'following':
            self._states.publish(self._codec.pack(
                stamp_ns, *self._joints.at(tracker.pose.values, self._rates, tracker.gain())))
        if drawn:
            self._drawing.publish(self._markers.at(
                stamp_ns, tracker.pose.values, self._rates, held=bool(self._reason)))

    def _on_setpoint(self, axis: str, data: bytes) -> None:
        setpoint = unpack_point(data)
        if setpoint is not None:
            self.answer(axis, setpoint)
            return
        self._refused += 1
        self.get_logger().warning(
            f'{axis}: a point without exactly one finite position, velocity and acceleration '
            'was left out', throttle_duration_sec=1.0)

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the linkage is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics.

        """
        if self._states is None:
            return diagnostics.OK, {}
        pose = self._tracker.pose
        values: dict[str, Any] = {
            'states': self._answered, 'held_ticks': self._held, 'refused_points': self._refused,
            'unpaired_ticks': self._pairing.unpaired,
            **{name: pose[name] for name in self._settings.linkage.inputs},
            'clearance': pose.clearance, 'certified_steps': pose.certificate.steps,
            'kantorovich': pose.certificate.kantorovich}
        if self._reason:
            return diagnostics.ERROR, {**values, 'reason': self._reason}
        if not self._answered:
            values['waiting_for'] = ', '.join(self._pairing.missing())
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
    return run(lambda: [LinkageState()], argv)
