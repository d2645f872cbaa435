# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a drive does: the protocol of its modes, and what those that take setpoints share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from cam_motion.drive.axis_load import UNKNOWN
from cam_motion.io.parameters import ParameterSpec
from cam_motion.nodes import diagnostics
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.qos import SETPOINTS
from cam_motion.nodes.shaft_ticker import Listener
from cam_motion.nodes.time_base import TimeBase
from cam_motion.nodes.wire import unpack_point
from cam_motion.runtime.point import Point
from cam_motion.runtime.shaft_angle import ShaftAngles
from cam_motion.runtime.ticks import NANOSECONDS
from trajectory_msgs.msg import JointTrajectoryPoint

_FINDING = 50  # setpoints that may come before the shaft is heard, while nodes find each other


class DriveMode:
    """
    What a drive does; a `DriveSim` holds one, chosen by its parameter ``mode``.

    A mode is made and configured when the node is configured, activated and deactivated with it,
    and cleaned up with it, be it after a configuration that failed. What it makes by the node's
    `make_publisher`, `make_subscription` and `make_service` the node destroys; what it makes
    otherwise, such as timers, is its own to destroy in `cleanup`.

    Parameters
    ----------
    node : ManagedNode
        The node that holds it: its name, clocks, logger, topics and state.
    own_process : bool
        Whether setpoints come over topics; else the owner of the process calls `answer`.

    Attributes
    ----------
    axis : str
        Name of the axis that the drive moves; known when configured.
    listeners : list[Callable[[Point], None]]
        To be called with every point of the shaft, by a mode that turns one.
    section : Callable[[str], Mapping[str, Any]] | None
        Gives the parameters of another node of the same process; None in a process of its own.

    """

    TURNS_SHAFT: ClassVar[bool] = False
    """Whether the drive turns the shaft itself, so that no master does."""

    def __init__(self, node: ManagedNode, own_process: bool) -> None:
        """Keep the node; everything else waits for the configuration."""
        self.node = node
        self.own_process = own_process
        self.axis = ''
        self.listeners: list[Listener] = []
        self.section: Callable[[str], Mapping[str, Any]] | None = None

    @classmethod
    def table(cls, given: Mapping[str, Any]) -> tuple[ParameterSpec, ...]:
        """
        List the parameters of a drive in this mode.

        Parameters
        ----------
        given : Mapping[str, Any]
            What the node has been given, by flat name: a table may depend on it.

        Returns
        -------
        tuple[ParameterSpec, ...]
            The parameters, ``mode`` and ``autostart`` among them.

        """
        raise NotImplementedError

    def configure(self, values: Mapping[str, Any]) -> None:
        """
        Build the drive from its parameters; make topics and services.

        Parameters
        ----------
        values : Mapping[str, Any]
            All parameters by flat name, as given: to be checked here.

        Raises
        ------
        ConfigurationError
            With every problem, paths relative to the node.

        """
        raise NotImplementedError

    def activate(self) -> None:
        """Begin to work."""

    def answer(self, setpoint: Point) -> None:
        """
        Answer a setpoint of the axis; a mode that follows none leaves it out.

        Parameters
        ----------
        setpoint : Point
            Position, velocity and acceleration of the axis.

        """

    def note_shaft(self, point: Point) -> None:
        """
        Hear a point of the shaft, before the setpoint that answers it.

        Parameters
        ----------
        point : Point
            Angle, speed and acceleration of the shaft.

        """

    def deactivate(self) -> None:
        """Cease to work; a drive that others follow leaves a hold point behind."""

    def begin_stop(self) -> None:
        """Begin to come to rest: the process is to end. Called whether active or not."""

    @property
    def stopped(self) -> bool:
        """Whether the drive has come to rest, as far as that is its own doing."""
        return True

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the drive is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics.

        """
        return diagnostics.OK, {}

    def cleanup(self) -> None:
        """Drop what `configure` has made without the node, be it only half of it."""


class SetpointMode(DriveMode):
    """
    A mode that answers the setpoints of an axis, which it gets by topic or by `answer`.

    Subclasses implement `respond`; `listen_to` is the last step of their `configure`.

    Attributes
    ----------
    answered, refused : int
        Setpoints answered, and points left out because they are none.

    """

    def __init__(self, node: ManagedNode, own_process: bool) -> None:
        """Know no setpoint yet."""
        super().__init__(node, own_process)
        self.answered = 0
        self.refused = 0
        self._time = TimeBase(node)
        self._angles: ShaftAngles | None = None  # for a load that depends on them
        self._without_angle = 0  # setpoints, by now without a break

    def respond(self, setpoint: Point, stamp_ns: int) -> None:
        """
        Do what the drive does with a setpoint, and publish it.

        Parameters
        ----------
        setpoint : Point
            Position, velocity and acceleration of the axis.
        stamp_ns : int
            When it was due, in the node's time [ns].

        """
        raise NotImplementedError

    def listen_to(self, axis: str, with_shaft: bool = False) -> None:
        """
        Follow an axis from now on.

        Parameters
        ----------
        axis : str
            Its name.
        with_shaft : bool
            Whether the angle of the shaft counts too, as for a force in a window of it.

        """
        self.axis = axis
        self._angles = ShaftAngles() if with_shaft else None
        if self.own_process:
            if with_shaft:
                self.node.make_subscription(
                    JointTrajectoryPoint, 'shaft', self._on_shaft, SETPOINTS, raw=True)
            self.node.make_subscription(
                JointTrajectoryPoint, f'{axis}/setpoint', self._on_setpoint, SETPOINTS, raw=True)

    def activate(self) -> None:
        """Wait for setpoints."""
        self._time.forget()
        self.node.set_state('waiting')

    def answer(self, setpoint: Point) -> None:
        """
        Answer a setpoint of the axis, if active.

        Parameters
        ----------
        setpoint : Point
            Position, velocity and acceleration of the axis.

        """
        if not self.node.active:
            return
        time_ns = setpoint.sec * NANOSECONDS + setpoint.nanosec
        if self._time.begins(time_ns):
            self.node.set_state('following')
        self.respond(setpoint, self._time.stamp(time_ns))
        self.answered += 1

    def note_shaft(self, point: Point) -> None:
        """
        Hear a point of the shaft.

        Parameters
        ----------
        point : Point
            Angle, speed and acceleration of the shaft.

        """
        if self._angles is not None:
            self._angles.note(point)

    def shaft_angle(self, setpoint: Point) -> float:
        """
        Look up the angle of the shaft that a setpoint answers.

        Parameters
        ----------
        setpoint : Point
            The setpoint.

        Returns
        -------
        float
            Angle [rad]; NaN where it does not count, or no shaft is heard.

        """
        if self._angles is None:
            return UNKNOWN
        found = self._angles.at(setpoint.sec * NANOSECONDS + setpoint.nanosec)
        if found == found:
            self._without_angle = 0
            return found
        self._without_angle += 1
        if self._without_angle > _FINDING:
            self.node.get_logger().warning(
                'the angle of the shaft is not known: the parts of the load that act in a window '
                'of it do not act', throttle_duration_sec=10.0)
        return UNKNOWN

    @property
    def lost(self) -> dict[str, str]:
        """Say that a part of the load does not act, as it should, where that is so."""
        if self._without_angle <= _FINDING:
            return {}
        return {'reason': 'the angle of the shaft is not known: what acts in a window of it does '
                          'not act'}

    def _on_shaft(self, data: bytes) -> None:
        point = unpack_point(data)
        if point is not None:
            self.note_shaft(point)

    def _on_setpoint(self, data: bytes) -> None:
        setpoint = unpack_point(data)
        if setpoint is not None:
            self.answer(setpoint)
            return
        self.refused += 1
        self.node.get_logger().warning(
            'setpoint: a point without exactly one finite position, velocity and acceleration '
            'was left out', throttle_duration_sec=1.0)
