# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The setpoints of the next moments as a trajectory, for ros2_control's trajectory controller."""

from __future__ import annotations

from collections.abc import Callable, Sequence
import struct

from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.qos import SETPOINTS
from cam_motion.runtime.look_ahead import (
    AheadPoint,
    look_ahead,
    shaft_ahead,
    stopping_after,
    times_ahead,
)
from cam_motion.runtime.motion_over_angle import Motion, Standstill
from cam_motion.runtime.point import Point
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft_motion import ShaftState
from cam_motion.runtime.ticks import NANOSECONDS
from cam_motion.runtime.time_relation import TimeRelation
from trajectory_msgs.msg import JointTrajectory

Effort = Callable[[float, float, float, float], float]
"""Gives the effort that position, velocity and acceleration of an axis at a shaft angle take."""


class TrajectoryCodec:
    """
    Writes trajectory_msgs/JointTrajectory messages for one joint.

    A message of some twenty points costs rclpy 0.3 ms to build and to convert; packed as plain
    CDR (OMG DDS-XTypes 1.3, section 7.4.1) it costs about 12 us.

    Parameters
    ----------
    joint : str
        Name of the joint.
    with_effort : bool
        Whether every point has an effort.

    """

    def __init__(self, joint: str, with_effort: bool) -> None:
        """Keep the name as bytes."""
        self._joint = joint.encode() + b'\0'
        self._fields = 4 if with_effort else 3
        self._layouts: dict[int, struct.Struct] = {}  # by count of points

    def _layout(self, count: int) -> struct.Struct:
        """Lay a message out; each member is aligned to its own size."""
        length = len(self._joint)
        size = 20 + 4 + length  # stamp, empty frame_id, count of names, name
        padding = -size % 4
        text = f'<4B iI I1s3x I I{length}s{padding}x I'
        size += padding + 4
        for _ in range(count):
            for field in range(4):
                text += 'I'
                size += 4
                if field < self._fields:
                    padding = -size % 8
                    text += f'{padding}xd'
                    size += padding + 8
            text += 'iI'
            size += 8
        return struct.Struct(text)

    def pack(self, stamp_ns: int, points: Sequence[AheadPoint], efforts: Sequence[float] = (),
             ) -> bytes:
        """
        Write one message.

        Parameters
        ----------
        stamp_ns : int
            Stamp of the header [ns].
        points : Sequence[AheadPoint]
            The points; their times count from the stamp.
        efforts : Sequence[float]
            One for each point, or empty.

        Returns
        -------
        bytes
            The serialised message, to be published as it is.

        """
        count = len(points)
        if count not in self._layouts:
            self._layouts[count] = self._layout(count)
        values: list[int | float | bytes] = []
        for k, (time, position, velocity, acceleration, _) in enumerate(points):
            values += (1, position, 1, velocity, 1, acceleration)
            values += (1, efforts[k]) if efforts else (0,)
            values += divmod(round(time * NANOSECONDS), NANOSECONDS)
        return self._layouts[count].pack(
            0, 1, 0, 0, *divmod(stamp_ns, NANOSECONDS), 1, b'\0', 1, len(self._joint),
            self._joint, count, *values)


class TrajectoryOutput:
    """
    Publishes the next moments of an axis several times a second.

    Each message goes on with a stop of the shaft, at the end of which the axis stands: the
    controller carries that out if no further message comes, and takes no message that ends in
    motion unless told to.

    Parameters
    ----------
    node : ManagedNode
        Node of the axis, as it is being configured.
    rate : float
        Messages per second [Hz].
    points : int
        Points ahead in each, one every 1/rate.
    joint : str
        Name of the joint.
    stop_limits : RampLimits
        Limits of the stop.
    effort : Callable[[float, float, float, float], float] | None
        What a motion takes, where a drive is known.

    Attributes
    ----------
    count : int
        Messages published.

    """

    def __init__(self, node: ManagedNode, rate: float, points: int, joint: str,
                 stop_limits: RampLimits, effort: Effort | None) -> None:
        """Make the topic."""
        self._node = node
        self._effort = effort
        self._period_ns = round(NANOSECONDS / rate)
        self._points = points
        self._stop_limits = stop_limits
        self._codec = TrajectoryCodec(joint, effort is not None)
        self._publisher = node.make_publisher(JointTrajectory, '~/trajectory', SETPOINTS)
        self._relation = TimeRelation()
        self._last_ns = self._due_ns = 0
        self._last_alpha = 0.0
        self._moving = False
        self.count = 0

    def answer(self, point: Point, shaft: tuple[float, float, float], motion: Motion) -> None:
        """
        Publish for a tick, if it is time.

        Parameters
        ----------
        point : Point
            The shaft.
        shaft : tuple[float, float, float]
            Its angle [rad], speed [rad/s] and acceleration [rad/s²] as the axis sees them.
        motion : Motion
            What the axis does over the shaft angle.

        """
        _, _, _, sec, nanosec = point
        _, omega, alpha = shaft
        time_ns = sec * NANOSECONDS + nanosec
        moves = not omega == 0.0 == alpha
        step_ns = time_ns - self._last_ns
        # also when the shaft comes to rest, so that nothing else is the last that is known
        if time_ns >= self._due_ns or step_ns < 0 or self._moving > moves:
            self._due_ns += self._period_ns
            if not time_ns < self._due_ns <= time_ns + self._period_ns:
                self._due_ns = time_ns + self._period_ns
            jerk = 0.0
            if 0 < step_ns <= self._period_ns:
                jerk = (alpha - self._last_alpha) / (1e-9 * step_ns)
            self._publish(time_ns, ShaftState(*shaft), jerk, motion)
        self._last_ns, self._last_alpha, self._moving = time_ns, alpha, moves

    def hold(self, setpoint: Point) -> None:
        """
        Publish that the axis stands: the node ceases to work.

        Parameters
        ----------
        setpoint : Point
            Its last setpoint.

        """
        self._publish(setpoint.sec * NANOSECONDS + setpoint.nanosec, ShaftState(0.0, 0.0, 0.0),
                      0.0, Standstill(setpoint.position))

    def _publish(self, time_ns: int, shaft: ShaftState, jerk: float, motion: Motion) -> None:
        step = 1e-9 * self._period_ns
        ahead = stopping_after(
            shaft_ahead(shaft, jerk, self._points * step), self._stop_limits)
        points = look_ahead(motion, ahead, times_ahead(ahead, step, self._points))
        efforts = [] if self._effort is None else [self._effort(*point[1:]) for point in points]
        stamp = self._relation.stamp(time_ns, self._node.get_clock().now().nanoseconds)
        self._publisher.publish(self._codec.pack(stamp, points, efforts))
        self.count += 1
