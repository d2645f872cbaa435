# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The recorder: writes every topic of the line into a rosbag2 bag, readable at any moment."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
import time
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.bag import BagError, BagWriter, QosProfile
from cam_motion.io.config import parse_sections
from cam_motion.io.parameters import BAG_RECORDER, check_values
from cam_motion.nodes import diagnostics
from cam_motion.nodes.line_topics import LineTopic, topics_of
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.parameters import machine_files
from cam_motion.nodes.runner import run
from cam_motion.nodes.wire import unpack_point
from cam_motion.runtime.watchdog import ShaftWatch
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription

MACHINE = 'machine'
"""Key of the bag's custom data that holds the text of the machine file."""

_QUEUE = 2000  # messages that may wait while a flush holds the recorder up
_LOOK_FOR_TOPICS = 0.5
_SILENCE = 0.3  # after a stop, this long [s] without a message ends the recording
# Chatter of ROS itself, which would drown the machine
_NOT_OF_THE_LINE = ('/rosout', '/parameter_events')


class BagRecorder(ManagedNode):
    """
    Records topics as they are, without unpacking a message.

    Parameters
    ----------
    name : str
        Name of the node.
    **options : Any
        Further arguments of `rclpy.node.Node`.

    """

    TABLE = BAG_RECORDER

    def __init__(self, name: str = 'bag_recorder', **options: Any) -> None:
        """Declare the parameters."""
        super().__init__(name, **options)
        self._writer: BagWriter | None = None
        self._subscriptions_by_topic: dict[str, Subscription] = {}
        self._timers_of_recording: list[Any] = []

    def configure(self, values: dict[str, Any]) -> None:
        """
        Check the parameters and find the topics that the machine file implies.

        Parameters
        ----------
        values : dict[str, Any]
            All parameters by flat name.

        Raises
        ------
        ConfigurationError
            When the parameters cannot be used.

        """
        checked, problems = check_values(BAG_RECORDER, values)
        if problems:
            raise ConfigurationError(problems)
        self._settings = checked
        self._machine_text = _machine_text(checked['machine'])
        self._expected: list[LineTopic] = []
        if self._machine_text and not checked['topics']:
            self._expected = topics_of(parse_sections(self._machine_text))
        self._wanted = {self.resolve_topic_name(name) for name in checked['topics']}

    def activate(self) -> None:
        """
        Open the bag and begin to record.

        Raises
        ------
        ConfigurationError
            When the bag cannot be made, as where it exists already.

        """
        custom = {MACHINE: self._machine_text} if self._machine_text else None
        try:
            self._writer = BagWriter(
                self._settings['output'], storage=self._settings['storage'],
                flush_interval=self._settings['flush_interval'], custom_data=custom)
        except BagError as error:
            raise ConfigurationError([
                Problem('output', self._settings['output'], str(error))]) from error
        self._watch = ShaftWatch(_SILENCE)
        self._shaft_topic = self.resolve_topic_name('shaft')
        self._last_shaft: bytes | None = None
        self._last_message = self.steady_now()
        self._error = ''
        self._unknown: set[str] = set()
        for topic in self._expected:
            self._record(self.resolve_topic_name(topic.name), topic.type_name, topic.qos,
                         [QosProfile.from_ros(topic.qos)])
        self._look_for_topics()
        self._timers_of_recording = [
            self.create_timer(period, work, clock=self.steady_clock) for period, work in (
                (_LOOK_FOR_TOPICS, self._look_for_topics),
                (0.5 * self._settings['flush_interval'], self._flush))
        ]
        self.set_state('recording')
        self.get_logger().info(f'recording into {self._writer.path}')

    def deactivate(self) -> None:
        """Close the bag."""
        for timer in self._timers_of_recording:
            self.destroy_timer(timer)
        for subscription in self._subscriptions_by_topic.values():
            self.destroy_subscription(subscription)
        self._subscriptions_by_topic.clear()
        writer, self._writer = self._writer, None
        if writer is None:
            return
        writer.close()
        self.get_logger().info(
            f'{writer.message_count} messages of {len(writer.topics)} topics in {writer.path}')

    def begin_stop(self) -> None:
        """Go on until the machine is silent or at rest, so that nothing of its stop is lost."""
        if self.active:
            self._watch.begin_stop(self.steady_now())

    @property
    def stopped(self) -> bool:
        """Whether everything that belongs to the recording has come."""
        now = self.steady_now()
        if not self.active or now - self._last_message > _SILENCE:
            return True
        point = unpack_point(self._last_shaft) if self._last_shaft else None
        if point is not None:
            if not self._watch.note(point, now):
                self._watch.forget()  # another shaft, or the same one from its beginning
                self._watch.note(point, now)
        # a machine that goes on was not asked to stop: only the recording was
        return not self._watch.at_rest and self._watch.goes_on(now)

    def _look_for_topics(self) -> None:
        """Subscribe to what has appeared since."""
        for name, types in self.get_topic_names_and_types():
            if name in self._subscriptions_by_topic or name in self._unknown:
                continue
            if len(types) != 1 or not self._is_wanted(name):
                continue
            offered = [info.qos_profile for info in self.get_publishers_info_by_topic(name)]
            if offered:
                self._record(name, types[0], _reading(offered),
                             [QosProfile.from_ros(qos) for qos in offered])

    def _is_wanted(self, name: str) -> bool:
        if self._wanted:
            return name in self._wanted
        return not self._expected and name not in _NOT_OF_THE_LINE

    def _record(self, name: str, type_name: str, qos: QoSProfile,
                offered: list[QosProfile]) -> None:
        assert self._writer is not None  # only called while recording
        try:
            message_type = _message_type(type_name)
            handle = self._writer.add_topic(name, type_name, offered)
        except (BagError, AttributeError, ModuleNotFoundError, ValueError) as error:
            self._unknown.add(name)
            self.get_logger().warning(f'{name} is not recorded: {error}')
            return
        deep = QoSProfile(
            history=HistoryPolicy.KEEP_LAST, depth=_QUEUE, reliability=qos.reliability,
            durability=qos.durability)
        self._subscriptions_by_topic[name] = self.create_subscription(
            message_type, name, self._take(handle, name == self._shaft_topic), deep, raw=True)

    def _take(self, handle: int, is_shaft: bool) -> Callable[[bytes], None]:
        """Make the callback of a topic; the hot path of the recorder."""
        write = self._writer.write
        now_ns = (lambda: self.get_clock().now().nanoseconds) if self.sim_time else time.time_ns

        def take(data: bytes) -> None:
            try:
                write(handle, now_ns(), data)
            except BagError as error:
                self._fail(error)
            self._last_message = self.steady_now()
            if is_shaft:
                self._last_shaft = data
        return take

    def _flush(self) -> None:
        try:
            self._writer.flush_if_due()
            self._error = ''
        except BagError as error:
            self._fail(error)

    def _fail(self, error: BagError) -> None:
        """Say what is wrong; the messages wait for the next flush."""
        self._error = str(error)
        self.get_logger().error(self._error, throttle_duration_sec=1.0)

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the recording is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics.

        """
        if self._writer is None:
            return diagnostics.OK, {}
        values = {'messages': self._writer.message_count, 'bytes': self._writer.bytes_written,
                  'bag': str(self._writer.path)}
        if self._error:
            return diagnostics.ERROR, {**values, 'error': self._error}
        return diagnostics.OK, values


def _reading(offered: Sequence[QoSProfile]) -> QoSProfile:
    """Choose what every publisher of a topic can serve."""
    reliable = all(qos.reliability is ReliabilityPolicy.RELIABLE for qos in offered)
    latched = all(qos.durability is DurabilityPolicy.TRANSIENT_LOCAL for qos in offered)
    return QoSProfile(
        depth=_QUEUE,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE)


def _message_type(type_name: str) -> Any:
    """Find the class of a message type such as std_msgs/msg/String."""
    package, kind, name = type_name.split('/')
    return getattr(import_module(f'{package}.{kind}'), name)


def _machine_text(path: str) -> str:
    """Read the machine file: the one named, else the last one on the command line."""
    if not path:
        given = machine_files()
        if not given:
            return ''
        path = given[-1]
    try:
        with open(path, encoding='utf-8') as file:
            return file.read()
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigurationError([Problem('machine', path, f'cannot be read: {error}')]) from error


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
    return run(lambda: [BagRecorder()], argv)
