# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
A glance at a running line, a few times per second.

Subscriptions keep one message each and belong to no executor: DDS receives in its own threads, and
Python pays only when it looks. rclpy is imported when a line is watched, not before.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from cam_motion.errors import CamMotionError
from cam_motion.io.machine import Machine
from cam_motion.units import RPM, TURN

_ANSWER_WITHIN = 5.0  # time for a service to be found, and again to answer [s]


@dataclass(frozen=True)
class Snapshot:
    """
    What a line was doing when last looked at; None where nothing has been heard.

    Attributes
    ----------
    time : float | None
        Time on the machine's time base [s].
    speed_cpm : float
        Shaft speed [cycles/min].
    phi : float
        Shaft angle, unwrapped [rad].
    axes : Mapping[str, tuple[float, float] | None]
        Position and velocity by axis [unit, unit/s].
    states : Mapping[str, str]
        State by axis, drive and linkage; of those only that have told theirs.
    drives : Mapping[str, tuple[float, float] | None]
        Motor torque [N m] and motor speed [rpm] by drive.
    health : Mapping[str, str]
        Last diagnostic figures of the master shaft, as text by key.
    drive_health : Mapping[str, Mapping[str, str]]
        The same of each drive that has told them.

    """

    time: float | None = None
    speed_cpm: float = 0.0
    phi: float = 0.0
    axes: Mapping[str, tuple[float, float] | None] = field(default_factory=dict)
    states: Mapping[str, str] = field(default_factory=dict)
    drives: Mapping[str, tuple[float, float] | None] = field(default_factory=dict)
    health: Mapping[str, str] = field(default_factory=dict)
    drive_health: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    @property
    def cycles(self) -> int:
        """Whole turns of the shaft."""
        return int(self.phi // TURN)

    @property
    def angle_deg(self) -> float:
        """Shaft angle within its turn [deg]."""
        return self.phi % TURN / TURN * 360.0


class LineWatch:
    """
    Looks at the topics of a line; to be used as a context.

    Parameters
    ----------
    machine : Machine
        The machine that is to be watched.

    """

    def __init__(self, machine: Machine) -> None:
        """Join the ROS graph."""
        import rclpy
        from rclpy.signals import SignalHandlerOptions
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node(
            'cam_motion_display', context=self._context, use_global_arguments=False,
            enable_rosout=False, start_parameter_services=False)
        self._master = machine.master.name
        self._subscriptions = _subscribe(self._node, machine)
        self._heard: dict[tuple[str, str], Any] = {}
        self._drives = machine.drive_names
        self._health: dict[str, dict[str, str]] = {}  # by node

    def look(self) -> Snapshot:
        """
        Take what has arrived.

        Returns
        -------
        Snapshot
            The newest of each topic.

        """
        for key, subscription in self._subscriptions.items():
            for message in _take_all(subscription):
                self._heard[key] = message
                if key == ('diagnostics', ''):
                    self._note_health(message)
        shaft = self._heard.get(('shaft', ''))
        stamp = shaft.time_from_start if shaft else None
        return Snapshot(
            stamp.sec + 1e-9 * stamp.nanosec if stamp else None,
            shaft.velocities[0] / RPM if shaft else 0.0,
            shaft.positions[0] if shaft else 0.0,
            {name: _motion(self._heard.get((kind, name)))
             for kind, name in self._subscriptions if kind == 'axis'},
            {name: message.data for (kind, name), message in self._heard.items()
             if kind == 'state'},
            {name: _effort(self._heard.get((kind, name)))
             for kind, name in self._subscriptions if kind == 'drive'},
            self._health.get(self._master, {}),
            {name: self._health[name] for name in self._drives if name in self._health})

    @property
    def recorder_state(self) -> str:
        """State of the recorder; empty while it has not been heard."""
        for message in _take_all(self._subscriptions['recorder', '']):
            self._heard['recorder', ''] = message
        message = self._heard.get(('recorder', ''))
        return message.data if message else ''

    def _note_health(self, message: Any) -> None:
        for status in message.status:
            name = status.name.rsplit('/', 1)[-1]
            if name in (self._master, *self._drives) and status.values:
                self._health[name] = {pair.key: pair.value for pair in status.values}

    def run_shaft(self) -> None:
        """
        Tell the master shaft to run.

        Raises
        ------
        CamMotionError
            When it does not answer, or refuses.

        """
        from rclpy.executors import SingleThreadedExecutor
        from std_srvs.srv import SetBool
        client = self._node.create_client(SetBool, f'{self._master}/run')
        executor = SingleThreadedExecutor(context=self._context)
        try:
            answer = None
            if client.wait_for_service(_ANSWER_WITHIN):
                executor.add_node(self._node)
                future = client.call_async(SetBool.Request(data=True))
                executor.spin_until_future_complete(future, _ANSWER_WITHIN)
                answer = future.result() if future.done() else None
        finally:
            executor.remove_node(self._node)
            executor.shutdown()
            self._node.destroy_client(client)
        if answer is None:
            raise CamMotionError(f'{self._master} does not answer its service ~/run')
        if not answer.success:
            raise CamMotionError(f'{self._master}: {answer.message}')

    def close(self) -> None:
        """Leave the ROS graph."""
        self._node.destroy_node()
        self._context.try_shutdown()

    def __enter__(self) -> LineWatch:
        """Give the watch itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the ROS graph."""
        self.close()


def _subscribe(node: Any, machine: Machine) -> dict[tuple[str, str], Any]:
    """Subscribe to everything shown, by (kind, name)."""
    from diagnostic_msgs.msg import DiagnosticArray
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
    from sensor_msgs.msg import JointState
    from std_msgs.msg import String
    from trajectory_msgs.msg import JointTrajectoryPoint
    newest = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    several = QoSProfile(depth=20, reliability=ReliabilityPolicy.BEST_EFFORT)
    latched = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE,
                         durability=DurabilityPolicy.TRANSIENT_LOCAL)
    wanted: list[tuple[str, str, Any, str, Any]] = [
        ('shaft', '', JointTrajectoryPoint, 'shaft', newest),
        ('recorder', '', String, 'bag_recorder/state', latched),
        ('diagnostics', '', DiagnosticArray, '/diagnostics', several),
        *(('axis', name, JointTrajectoryPoint, f'{name}/setpoint', newest)
          for name in machine.diagram.axes),
        *(('state', name, String, f'{name}/state', latched)
          for name in (*machine.diagram.axes, *machine.drive_names, *machine.linkages)),
        *(('drive', name, JointState, f'{name}/drive_state', newest)
          for name in machine.drive_names),
    ]
    return {
        (kind, name): node.create_subscription(message, topic, _ignore, qos)
        for kind, name, message, topic, qos in wanted
    }


def _ignore(_: Any) -> None:
    """Stand in for a callback that is never called."""


def _take_all(subscription: Any) -> list[Any]:
    found: list[Any] = []
    with subscription.handle:
        while True:
            taken = subscription.handle.take_message(subscription.msg_type, False)
            # no more than a queue holds: a stream must not keep us here
            if taken is None or len(found) >= 20:
                return found
            found.append(taken[0])


def _motion(setpoint: Any) -> tuple[float, float] | None:
    return (setpoint.positions[0], setpoint.velocities[0]) if setpoint else None


def _effort(state: Any) -> tuple[float, float] | None:
    if not state or 'motor' not in state.name:
        return None
    motor = list(state.name).index('motor')
    return state.effort[motor], state.velocity[motor] / RPM
