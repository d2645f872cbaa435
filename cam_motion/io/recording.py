# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A recorded run of a machine: its bag as arrays, beside the machine that made it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from cam_motion.errors import CamMotionError, ConfigurationError, Problem
from cam_motion.io.axis import Values
from cam_motion.io.bag import (
    BagReader,
    JointStateSeries,
    PointSeries,
    read_joint_states,
    read_points,
)
from cam_motion.io.config import parse_sections, read_sections
from cam_motion.io.machine import build_machine, Machine
from cam_motion.motion.piece import Array
import numpy as np
from numpy.typing import NDArray

MACHINE_KEY = 'machine'
"""Under this key a bag carries the text of the machine file."""

_POINT = 'trajectory_msgs/msg/JointTrajectoryPoint'
_TEXT = 'std_msgs/msg/String'
_DIAGNOSTICS = 'diagnostic_msgs/msg/DiagnosticArray'


class RecordingError(CamMotionError):
    """A bag that holds no run of a machine."""


@dataclass(frozen=True)
class Track:
    """
    A stream of points of one joint, in the order in which they were recorded.

    Attributes
    ----------
    run : ndarray of int64, shape (n,)
        Number of the run: it rises where the time base starts anew.
    time_ns : ndarray of int64, shape (n,)
        Time on the machine's time base [ns].
    position, velocity, acceleration : ndarray, shape (n,)
        Values [unit, unit/s, unit/s²]; of the shaft phi, omega, alpha [rad, rad/s, rad/s²].
    stamps_ns : ndarray of int64, shape (n,)
        Time of reception [ns].

    """

    run: NDArray[np.int64]
    time_ns: NDArray[np.int64]
    position: Array
    velocity: Array
    acceleration: Array
    stamps_ns: NDArray[np.int64]

    def __len__(self) -> int:
        """Count the points."""
        return len(self.time_ns)

    def chosen(self, which: NDArray[np.bool_]) -> Track:
        """
        Give some of the points.

        Parameters
        ----------
        which : ndarray of bool, shape (n,)
            The points wanted.

        Returns
        -------
        Track
            Those points.

        """
        return Track(self.run[which], self.time_ns[which], self.position[which],
                     self.velocity[which], self.acceleration[which], self.stamps_ns[which])


@dataclass(frozen=True)
class Recording:
    """
    A recorded run.

    Attributes
    ----------
    path : Path
        The bag.
    incomplete : bool
        Whether its recorder was cut off.
    machine : Machine
        The machine that was recorded.
    shaft : Track
        Points of the master shaft.
    setpoints : Mapping[str, Track | None]
        Setpoints by axis; None where the bag has no such topic.
    drives : Mapping[str, JointStateSeries]
        States by drive, joints ``motor`` and ``load``; drives without a topic are left out.
    counts : Mapping[str, int]
        Number of messages by topic.
    files : Mapping[str, int]
        Sizes of the bag's files by name [B].
    master_health : Mapping[str, str]
        Last diagnostic figures of the master shaft, as text by key.
    actual : Mapping[str, Track]
        What the axes really did, by servo drive.
    states : Mapping[str, Sequence[tuple[int, str]]]
        (Time of reception [ns], state) as each axis told them.
    linkages : Mapping[str, JointStateSeries]
        States of the linkages, by linkage: every variable, and more.
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node, as the machine file has them.

    """

    path: Path
    incomplete: bool
    machine: Machine
    shaft: Track
    setpoints: Mapping[str, Track | None]
    drives: Mapping[str, JointStateSeries]
    counts: Mapping[str, int]
    files: Mapping[str, int]
    master_health: Mapping[str, str]
    actual: Mapping[str, Track] = field(default_factory=dict)
    states: Mapping[str, Sequence[tuple[int, str]]] = field(default_factory=dict)
    linkages: Mapping[str, JointStateSeries] = field(default_factory=dict)
    sections: Mapping[str, Values] = field(default_factory=dict)


def read_recording(path: Path, config: Path | None = None) -> Recording:
    """
    Read the bag of a machine.

    Parameters
    ----------
    path : Path
        The bag.
    config : Path | None
        Machine file; None takes the one that the bag carries.

    Returns
    -------
    Recording
        The run.

    Raises
    ------
    BagError
        When it is no bag, or damaged.
    RecordingError
        When it holds no shaft point.
    ConfigurationError
        When there is no machine file, or it cannot be used.

    """
    with BagReader(path) as reader:
        sections = _sections(reader, config)
        machine = build_machine(sections)
        namespace, shaft = _shaft(reader)

        def topic(name: str) -> str | None:
            return f'{namespace}/{name}' if f'{namespace}/{name}' in reader.topics else None

        setpoints = {
            axis: _track(read_points(reader, found))
            if (found := topic(f'{axis}/setpoint')) else None
            for axis in machine.diagram.axes
        }
        drives = {
            name: read_joint_states(reader, found) for name in machine.drive_names
            if (found := topic(f'{name}/drive_state'))
        }
        return Recording(
            path, reader.incomplete, machine, shaft, setpoints, drives,
            {name: info.count for name, info in sorted(reader.topics.items())},
            _files(path), _master_health(reader, machine.master.name),
            {name: _track(read_points(reader, found)) for name in machine.drives
             if (found := topic(f'{name}/actual'))},
            {axis: [(stamp, str(reader.decode(_TEXT, raw).data))
                    for _, stamp, raw in reader.messages(found)]
             for axis in machine.diagram.axes if (found := topic(f'{axis}/state'))},
            {name: read_joint_states(reader, found) for name in machine.linkages
             if (found := topic(f'{name}/joint_states'))},
            sections)


def _sections(reader: BagReader, config: Path | None) -> Mapping[str, Values]:
    if config is not None:
        return read_sections(config)
    text = reader.custom_data.get(MACHINE_KEY)
    if not text:
        raise ConfigurationError([Problem(
            str(reader.path), None, 'the bag carries no machine file to compare with',
            'give it with --config')])
    return parse_sections(text, f'{reader.path}: {MACHINE_KEY}')


def _shaft(reader: BagReader) -> tuple[str, Track]:
    """Find the shaft, and with it the namespace of the line."""
    found = sorted(
        (name for name, info in reader.topics.items()
         if name.endswith('/shaft') and info.type_name == _POINT), key=len)
    if not found:
        there = ', '.join(sorted(reader.topics)) or 'none'
        raise RecordingError(
            f'{reader.path}: holds no shaft (a topic `shaft` of {_POINT}); topics: {there}')
    shaft = _track(read_points(reader, found[0]))
    if not len(shaft):
        raise RecordingError(
            f'{reader.path}: {found[0]}: no shaft point was recorded (did the line run?)')
    return found[0].removesuffix('/shaft'), shaft


def _track(series: PointSeries) -> Track:
    time_ns = np.rint(series.time_from_start_s * 1e9).astype(np.int64)
    run = np.concatenate([[0], np.cumsum(np.diff(time_ns) < 0)]) if len(time_ns) else time_ns
    columns = (series.positions, series.velocities, series.accelerations)
    position, velocity, acceleration = (
        values[:, 0] if values.shape[1] else np.full(len(values), np.nan) for values in columns)
    return Track(run.astype(np.int64), time_ns, position, velocity, acceleration,
                 series.stamps_ns)


def _files(path: Path) -> dict[str, int]:
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    return {file.name: file.stat().st_size for file in files if file.is_file()}


def _master_health(reader: BagReader, master: str) -> dict[str, str]:
    found: dict[str, str] = {}
    for name, info in reader.topics.items():
        if info.type_name == _DIAGNOSTICS:
            for _, _, raw in reader.messages(name):
                for status in reader.decode(_DIAGNOSTICS, raw).status:
                    if status.name.rsplit('/', 1)[-1] == master and status.values:
                        found = {pair.key: pair.value for pair in status.values}
    return found
