# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
The messages of the hot path as bytes.

Building a JointTrajectoryPoint costs 7-10 us in rclpy and converting it about as much again; the
same 64 bytes packed by `struct` cost under 1 us, and rclpy publishes and delivers bytes as they
are. The layout is plain CDR, little endian (OMG DDS-XTypes 1.3, section 7.4.1): a four-byte
encapsulation header, then each member aligned to its own size. Whatever arrives in another
encoding, as from other vendors' writers, goes through rclpy's deserialiser instead.
"""

from __future__ import annotations

from collections.abc import Sequence
import math
import struct

from cam_motion.runtime.point import Point
from rclpy.serialization import deserialize_message
from trajectory_msgs.msg import JointTrajectoryPoint

_LITTLE_ENDIAN_CDR = (0, 1, 0, 0)
# encapsulation, then three sequences of one double each, no effort, seconds, nanoseconds
_POINT = struct.Struct('<4B I4xd I4xd I4xd I iI')
_ONE_DOUBLE_EACH = (*_LITTLE_ENDIAN_CDR, 1, 1, 1, 0)
_NANOSECONDS = 1_000_000_000


def pack_point(
    position: float, velocity: float, acceleration: float, sec: int, nanosec: int
) -> bytes:
    """
    Write a JointTrajectoryPoint of one joint.

    Parameters
    ----------
    position, velocity, acceleration : float
        The sample.
    sec, nanosec : int
        Its time_from_start.

    Returns
    -------
    bytes
        The serialised message, to be published as it is.

    """
    return _POINT.pack(
        0, 1, 0, 0, 1, position, 1, velocity, 1, acceleration, 0, sec, nanosec)


def unpack_point(data: bytes) -> Point | None:
    """
    Read a JointTrajectoryPoint of one joint.

    Parameters
    ----------
    data : bytes
        The serialised message as it arrived.

    Returns
    -------
    Point | None
        The sample; None when it is no such message, has not exactly one position, velocity and
        acceleration, or holds a number that is not finite.

    """
    try:
        (e0, e1, e2, e3, n0, position, n1, velocity, n2, acceleration, n3, sec, nanosec
         ) = _POINT.unpack_from(data)
        if (e0, e1, e2, e3, n0, n1, n2, n3) != _ONE_DOUBLE_EACH:
            return _unpack_other(data)
    except struct.error:
        return _unpack_other(data)
    # x - x is zero for finite numbers only, and cheaper than three calls of isfinite
    if not (position - position == 0.0 == velocity - velocity == acceleration - acceleration):
        return None
    return Point(position, velocity, acceleration, sec, nanosec)


def _unpack_other(data: bytes) -> Point | None:
    """Read a message in any other encoding or with more in it, such as efforts."""
    try:
        message = deserialize_message(data, JointTrajectoryPoint)
    except Exception:  # noqa: B902 (rclpy raises whatever its typesupport does)
        return None
    values = (message.positions, message.velocities, message.accelerations)
    if any(len(each) != 1 for each in values):
        return None
    position, velocity, acceleration = (float(each[0]) for each in values)
    if not (math.isfinite(position) and math.isfinite(velocity) and math.isfinite(acceleration)):
        return None
    stamp = message.time_from_start
    return Point(position, velocity, acceleration, stamp.sec, stamp.nanosec)


class JointStateCodec:
    """
    Writes sensor_msgs/JointState messages for fixed joints.

    Parameters
    ----------
    names : Sequence[str]
        Names of the joints.
    with_effort : bool
        Whether efforts are given; else that list stays empty.

    """

    def __init__(self, names: Sequence[str], with_effort: bool) -> None:
        """Lay out the message once; only stamp and numbers change."""
        size = 0  # counted from behind the encapsulation header, as CDR aligns
        head = ['<4B', 'iI', 'I1s3x', 'I']  # stamp, empty frame_id, count of names
        size += 8 + 8 + 4
        self._fixed: list[int | bytes] = []
        for name in names:
            text = name.encode() + b'\0'
            padding = -(size + 4 + len(text)) % 4
            head.append(f'I{len(text)}s{padding}x')
            size += 4 + len(text) + padding
            self._fixed += [len(text), text]
        for count in (len(names), len(names), len(names) if with_effort else 0):
            head.append('I')
            size += 4
            if count:
                padding = -size % 8
                head.append(f'{padding}x{count}d')
                size += padding + 8 * count
        self._count = len(names)
        self._with_effort = with_effort
        self._struct = struct.Struct(''.join(head))

    def pack(self, stamp_ns: int, positions: Sequence[float], velocities: Sequence[float],
             efforts: Sequence[float] = ()) -> bytes:
        """
        Write one message.

        Parameters
        ----------
        stamp_ns : int
            Stamp of the header [ns].
        positions, velocities : Sequence[float]
            One number per joint [rad, rad/s].
        efforts : Sequence[float]
            One number per joint [N m], or empty.

        Returns
        -------
        bytes
            The serialised message.

        """
        sec, nanosec = divmod(stamp_ns, _NANOSECONDS)
        count = self._count
        return self._struct.pack(
            *_LITTLE_ENDIAN_CDR, sec, nanosec, 1, b'\0', count, *self._fixed,
            count, *positions, count, *velocities, count if self._with_effort else 0, *efforts)
