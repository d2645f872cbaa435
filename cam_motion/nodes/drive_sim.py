# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A simulated drive: it follows an axis, or turns the shaft that all axes follow."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from cam_motion.io.line_parts import LINE_SHAFT
from cam_motion.io.parameters import ParameterSpec
from cam_motion.io.servo_parameters import SERVO
from cam_motion.nodes import diagnostics
from cam_motion.nodes.drive_mode import DriveMode
from cam_motion.nodes.follow_mode import FollowMode
from cam_motion.nodes.line_shaft_mode import LineShaftMode
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.parameters import values_of
from cam_motion.nodes.runner import run
from cam_motion.nodes.servo_mode import ServoMode
from cam_motion.nodes.shaft_ticker import Listener
from cam_motion.runtime.point import Point

MODES: dict[str, type[DriveMode]] = {
    'follow': FollowMode, SERVO: ServoMode, LINE_SHAFT: LineShaftMode,
}
"""What a drive can do, by the value of its parameter ``mode``."""


class DriveSim(ManagedNode):
    """
    Publishes position, speed and torque of motor and load, in the mode that it is given.

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

    def __init__(self, name: str = 'drive_sim', own_process: bool = True, **options: Any) -> None:
        """Declare the parameters of the mode."""
        self._own_process = own_process
        self._mode: DriveMode | None = None
        self.listeners: list[Listener] = []
        """Called with every point of the shaft, where the drive turns it: axes of the process."""
        self.section: Callable[[str], Mapping[str, Any]] | None = None
        """Gives the parameters of another node of the process; None in one of its own."""
        super().__init__(name, **options)

    @property
    def kind(self) -> type[DriveMode]:
        """Look up what the parameter ``mode`` asks for; what is no mode counts as left out."""
        given = values_of(self).get('mode')
        return MODES.get(given if isinstance(given, str) else '', FollowMode)

    @property
    def table(self) -> tuple[ParameterSpec, ...]:
        """List the parameters, which depend on the mode."""
        return self.kind.table(values_of(self))

    def refuse_change(self, name: str, value: Any) -> str:
        """
        Refuse another mode: other parameters would go with it.

        Parameters
        ----------
        name : str
            Name of the parameter.
        value : Any
            The value.

        Returns
        -------
        str
            The reason, empty to accept.

        """
        if name == 'mode' and MODES.get(value) is not self.kind:
            return 'the mode is chosen when the node is started: its parameters depend on it'
        return ''

    def configure(self, values: dict[str, Any]) -> None:
        """
        Build the drive and create the topics.

        Parameters
        ----------
        values : dict[str, Any]
            All parameters by flat name.

        """
        self._mode = self.kind(self, self._own_process)
        self._mode.listeners = self.listeners
        self._mode.section = self.section
        self._mode.configure(values)

    def cleanup(self) -> None:
        """Drop the topics and the mode."""
        mode, self._mode = self._mode, None
        if mode is not None:
            mode.cleanup()
        super().cleanup()

    def activate(self) -> None:
        """Begin to work."""
        self._mode.activate()

    def answer(self, setpoint: Point) -> None:
        """
        Answer a setpoint of the axis with the state of the drive.

        Parameters
        ----------
        setpoint : Point
            Position, velocity and acceleration of the axis.

        """
        if self._mode is not None:
            self._mode.answer(setpoint)

    def note_shaft(self, point: Point) -> None:
        """
        Hear a point of the shaft, before the setpoint that answers it.

        Parameters
        ----------
        point : Point
            Angle, speed and acceleration of the shaft.

        """
        if self._mode is not None:
            self._mode.note_shaft(point)

    def deactivate(self) -> None:
        """Cease to work."""
        self._mode.deactivate()

    def begin_stop(self) -> None:
        """Begin to come to rest."""
        if self._mode is not None:
            self._mode.begin_stop()

    @property
    def stopped(self) -> bool:
        """Whether the drive has come to rest."""
        return self._mode is None or self._mode.stopped

    @property
    def hardware_id(self) -> str:
        """Name the axis that the drive moves."""
        return (self._mode.axis if self._mode is not None else '') or self.get_name()

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the drive is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics.

        """
        if self._mode is None:
            return diagnostics.OK, {}
        return self._mode.health()


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
