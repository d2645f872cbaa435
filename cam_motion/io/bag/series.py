# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Whole topics as numpy arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cam_motion.io.bag.error import BagError
from cam_motion.io.bag.reader import BagReader
from cam_motion.io.bag.uniform import read_uniform, walk_joint_state, walk_point
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Stamps = NDArray[np.int64]

_POINT = 'trajectory_msgs/msg/JointTrajectoryPoint'
_STATE = 'sensor_msgs/msg/JointState'


@dataclass(frozen=True)
class PointSeries:
    """
    A topic of trajectory_msgs/JointTrajectoryPoint; n messages of dof joints.

    Attributes
    ----------
    time_from_start_s : ndarray, shape (n,)
        The messages' own time [s].
    positions, velocities, accelerations, efforts : ndarray, shape (n, dof)
        Values [rad or m, per s, per s2; N m or N]; NaN where the messages have none.
    stamps_ns : ndarray of int64, shape (n,)
        Time of reception [ns].

    """

    time_from_start_s: Floats
    positions: Floats
    velocities: Floats
    accelerations: Floats
    efforts: Floats
    stamps_ns: Stamps


@dataclass(frozen=True)
class JointStateSeries:
    """
    A topic of sensor_msgs/JointState; n messages of dof joints.

    Attributes
    ----------
    names : tuple of str
        Joint names.
    positions, velocities, efforts : ndarray, shape (n, dof)
        Values [rad or m, per s; N m or N]; NaN where the messages have none.
    header_stamps_ns : ndarray of int64, shape (n,)
        Stamps in the messages [ns].
    stamps_ns : ndarray of int64, shape (n,)
        Time of reception [ns].

    """

    names: tuple[str, ...]
    positions: Floats
    velocities: Floats
    efforts: Floats
    header_stamps_ns: Stamps
    stamps_ns: Stamps


def read_points(reader: BagReader, topic: str) -> PointSeries:
    """
    Read all points of a topic.

    Parameters
    ----------
    reader : BagReader
        The bag.
    topic : str
        Topic of type trajectory_msgs/msg/JointTrajectoryPoint.

    Returns
    -------
    PointSeries
        The points in the order of the bag.

    Raises
    ------
    BagError
        If the topic is missing or of another type, or the number of joints changes.

    """
    stamps, raws = _collect(reader, topic, _POINT)
    fields = read_uniform(raws, walk_point)
    if fields is None:
        decoded = [reader.decode(_POINT, raw) for raw in raws]
        fields = [
            _stack(topic, [getattr(message, name) for message in decoded])
            for name in ('positions', 'velocities', 'accelerations', 'effort')
        ]
        fields.append(_times([message.time_from_start for message in decoded]))
    *values, time_ns = fields
    dof = max(value.shape[1] for value in values)
    positions, velocities, accelerations, efforts = (_fill(topic, x, dof) for x in values)
    return PointSeries(time_ns * 1e-9, positions, velocities, accelerations, efforts, stamps)


def read_joint_states(reader: BagReader, topic: str) -> JointStateSeries:
    """
    Read all joint states of a topic.

    Parameters
    ----------
    reader : BagReader
        The bag.
    topic : str
        Topic of type sensor_msgs/msg/JointState.

    Returns
    -------
    JointStateSeries
        The states in the order of the bag.

    Raises
    ------
    BagError
        If the topic is missing or of another type, or the joints change.

    """
    stamps, raws = _collect(reader, topic, _STATE)
    first: Any = reader.decode(_STATE, raws[0]) if raws else None
    names = tuple(first.name) if first else ()
    fields = read_uniform(raws, walk_joint_state)
    if fields is None:
        decoded: list[Any] = [reader.decode(_STATE, raw) for raw in raws]
        if any(tuple(message.name) != names for message in decoded):
            raise BagError(f'{reader.path}: {topic}: the joint names change (expected {names})')
        fields = [
            _stack(topic, [getattr(message, name) for message in decoded])
            for name in ('position', 'velocity', 'effort')
        ]
        fields.append(_times([message.header.stamp for message in decoded]))
    *values, header_stamps = fields
    dof = max(len(names), *(value.shape[1] for value in values))
    positions, velocities, efforts = (_fill(topic, x, dof) for x in values)
    return JointStateSeries(names, positions, velocities, efforts, header_stamps, stamps)


def _collect(reader: BagReader, topic: str, type_name: str) -> tuple[Stamps, list[bytes]]:
    """Read times and bytes of a topic, and check its type."""
    info = reader.topics.get(topic)
    if info is not None and info.type_name != type_name:
        raise BagError(f'{reader.path}: {topic}: is of type {info.type_name}, not {type_name}')
    entries = [(time_ns, raw) for _, time_ns, raw in reader.messages(topic)]
    stamps = np.array([time_ns for time_ns, _ in entries], dtype=np.int64)
    return stamps, [raw for _, raw in entries]


def _times(times: Sequence[Any]) -> Stamps:
    """Convert Time or Duration messages to ns, shape (n,)."""
    return np.array([x.sec * 10**9 + x.nanosec for x in times], dtype=np.int64)


def _stack(topic: str, rows: Sequence[Any]) -> Floats:
    """Put sequences of equal length into one array, shape (n, count)."""
    sizes = {len(row) for row in rows}
    if len(sizes) > 1:
        raise BagError(f'{topic}: the number of joints changes: {sorted(sizes)}')
    return np.array(rows, dtype=np.float64).reshape(len(rows), sizes.pop() if sizes else 0)


def _fill(topic: str, values: Floats, dof: int) -> Floats:
    """Give an absent sequence the shape of the others, filled with NaN."""
    if values.shape[1] == dof:
        return values
    if values.shape[1]:
        raise BagError(f'{topic}: {values.shape[1]} values for {dof} joints')
    return np.full((len(values), dof), np.nan)
