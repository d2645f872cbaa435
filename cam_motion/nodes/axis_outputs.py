# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What an axis tells beside its setpoints: cam tracks, and a trajectory for ros2_control."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.axis import CoupledAxis
from cam_motion.io.axis_parameters import SHAFT
from cam_motion.io.machine import build_drive
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.track_output import TrackOutput
from cam_motion.nodes.trajectory_output import Effort, TrajectoryOutput
from cam_motion.runtime.dead_time import ahead
from cam_motion.runtime.motion_over_angle import Cascade, Motion
from cam_motion.runtime.point import Point
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft_motion import ShaftState

Course = tuple[tuple[float, float, float], Motion]
"""Angle, speed and acceleration of the shaft, and what an axis does over its angle."""

DriveValues = Callable[[], Mapping[str, Any]]
"""Gives the parameters of a drive of the same process by flat name."""


class AxisOutputs:
    """
    The outputs of an axis that depend on its parameters.

    Parameters
    ----------
    node : ManagedNode
        Node of the axis, as it is being configured.
    axis : CoupledAxis
        The axis.
    now : Callable[[], Course]
        Gives what the axis follows, with the dead time made up for, and what it does over that.
    drive : Callable[[], Mapping[str, Any]] | None
        Gives the parameters of the drive that follows the axis; None where none is known.
    source : Callable[[], AxisOutputs] | None
        Gives the outputs of the axis that this one follows; None where that is the shaft, or an
        axis of another process.

    Raises
    ------
    ConfigurationError
        When a look-ahead is wanted, and nothing is known of what the axis follows.

    """

    def __init__(self, node: ManagedNode, axis: CoupledAxis, now: Callable[[], Course],
                 drive: DriveValues | None, source: Callable[[], AxisOutputs] | None) -> None:
        """Make the topics."""
        self._now = now
        self._tracks = TrackOutput(node, axis.tracks)
        self._source = source
        values = axis.values
        self._dead_time = values['dead_time']
        rate = values['trajectory.rate_hz']
        if rate and source is None and values['follows'] != SHAFT:
            raise ConfigurationError([Problem(
                'trajectory.rate_hz', rate, 'an axis that follows another one knows what that '
                'will do in the process of the line only',
                f'start both by the line, or let it follow the {SHAFT}')])
        with_effort = drive is not None and values['trajectory.effort']
        self._trajectory = TrajectoryOutput(
            node, rate, values['trajectory.points'], values['trajectory.joint'] or axis.name,
            RampLimits(values['stop_acceleration'], values['stop_jerk']),
            _effort_of(drive()) if with_effort else None) if rate else None
        self.wanted = bool(axis.tracks) or self._trajectory is not None
        """Whether there is anything to tell at a tick."""

    @property
    def course(self) -> Course:
        """Look up what the shaft does, and what the axis does over its angle."""
        followed, motion = self._now()
        if self._source is None:
            return followed, motion
        shaft, inner = self._source().course
        return ahead(ShaftState(*shaft), self._dead_time), Cascade(motion, inner)

    def answer(self, point: Point, setpoint: Point) -> None:
        """
        Answer a shaft point.

        Parameters
        ----------
        point : Point
            The shaft, or the setpoint of the axis that is followed.
        setpoint : Point
            What the axis has answered.

        """
        self._tracks.answer(point, setpoint)
        if self._trajectory is not None:
            self._trajectory.answer(point, *self.course)

    def take(self, axis: CoupledAxis) -> None:
        """
        Be the outputs of another axis from now on, of which only the cams differ.

        Parameters
        ----------
        axis : CoupledAxis
            The axis; its tracks have the same names.

        """
        self._tracks.take(axis.tracks)

    def hold(self, setpoint: Point | None) -> None:
        """
        Switch the tracks off and stand: the node ceases to work.

        Parameters
        ----------
        setpoint : Point | None
            The last setpoint of the axis; None where there was none.

        """
        self._tracks.release()
        if self._trajectory is not None and setpoint is not None:
            self._trajectory.hold(setpoint)

    @property
    def misses(self) -> bool:
        """Whether a window of a track has been too short to be seen."""
        return self._tracks.misses

    def health(self) -> dict[str, Any]:
        """
        Give the figures of the diagnostics.

        Returns
        -------
        dict[str, Any]
            Figures by name.

        """
        values = self._tracks.health()
        if self._trajectory is not None:
            values |= {'trajectories': self._trajectory.count}
        return values


def _effort_of(given: Mapping[str, Any]) -> Effort | None:
    """Give what the motor of a drive must exert, as seen by its axis [N m/rad, per unit]."""
    try:
        drive = build_drive('', given).drive
    except ConfigurationError:
        return None  # the drive itself says what is wrong with it
    factor = drive.gear_ratio / drive.radius

    def effort(position: float, velocity: float, acceleration: float, shaft_angle: float) -> float:
        state = drive.follow(position, velocity, acceleration, shaft_angle)
        return float(factor * state.motor_torque)
    return effort
