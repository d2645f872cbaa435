# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a recorded run shows: ticks, axes against their exact curves, drives, findings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from cam_motion.io.bag import JointStateSeries
from cam_motion.io.comparison import AxisReport, compare_axis, repeats_of
from cam_motion.io.linkage_report import linkage_report, LinkageReport
from cam_motion.io.recording import Recording, Track
from cam_motion.motion.piece import Array
from cam_motion.units import TURN
import numpy as np
from numpy.typing import NDArray


class TickFigures(NamedTuple):
    """
    Shaft points: how many there are, how many the grid of the time base has, and the gaps.

    ``gaps`` holds (time of the last tick before it [s], ticks missed) for each gap;
    ``irregular`` counts points off the grid, ``holds`` those that repeat the time of the one
    before at rest, ``repeated`` those that repeat it in motion.
    """

    recorded: int
    expected: int
    gaps: tuple[tuple[float, int], ...]
    irregular: int
    holds: int
    repeated: int
    rate_hz: float

    @property
    def missed(self) -> int:
        """Ticks of the grid that were not recorded."""
        return sum(count for _, count in self.gaps)


@dataclass(frozen=True)
class DriveReport:
    """
    What a drive did.

    Attributes
    ----------
    states : int
        States recorded.
    peak_torque, rms_torque : float
        Largest magnitude, and root mean square from first to last movement, of the motor's
        torque [N m].
    peak_speed : float
        Largest magnitude of the motor's speed [rad/s].
    motor_speed, motor_torque : ndarray, shape (n,)
        All states [rad/s, N m].
    following_error : float | None
        Largest magnitude of set minus actual position [unit]; None where no actual positions
        were recorded.

    """

    states: int
    peak_torque: float
    rms_torque: float
    peak_speed: float
    motor_speed: Array
    motor_torque: Array
    following_error: float | None = None


@dataclass(frozen=True)
class Report:
    """
    What a recorded run shows.

    Attributes
    ----------
    recording : Recording
        The run.
    ticks : TickFigures
        The shaft points.
    duration : float
        Time from first to last tick [s].
    cycles : float
        Turns of the shaft.
    top_speed : float
        Largest magnitude of the shaft speed [rad/s].
    axes : Mapping[str, AxisReport]
        The axes that were recorded.
    drives : Mapping[str, DriveReport]
        The drives that were recorded.
    linkages : Mapping[str, LinkageReport]
        The linkages that were recorded.

    """

    recording: Recording
    ticks: TickFigures
    duration: float
    cycles: float
    top_speed: float
    axes: Mapping[str, AxisReport]
    drives: Mapping[str, DriveReport]
    linkages: Mapping[str, LinkageReport] = field(default_factory=dict)


def make_report(recording: Recording) -> Report:
    """
    Compare a recorded run with the exact curves.

    Parameters
    ----------
    recording : Recording
        The run.

    Returns
    -------
    Report
        What it shows.

    """
    repeats = repeats_of(recording.shaft)
    holds = repeats & (recording.shaft.velocity == 0.0) & (recording.shaft.acceleration == 0.0)
    shaft = recording.shaft.chosen(~repeats)
    per_run = [shaft.chosen(shaft.run == run) for run in np.unique(shaft.run)]
    return Report(
        recording,
        tick_figures(shaft, float(recording.machine.master.values['rate_hz']), int(holds.sum()),
                     int((repeats & ~holds).sum())),
        sum(float(run.time_ns[-1] - run.time_ns[0]) * 1e-9 for run in per_run),
        sum(abs(float(run.position[-1] - run.position[0])) / TURN for run in per_run),
        float(np.max(np.abs(shaft.velocity))),
        {name: compare_axis(recording.machine.diagram.axes[name], shaft, setpoints,
                            recording.states.get(name, ()))
         for name, setpoints in recording.setpoints.items() if setpoints is not None},
        {name: replace(drive_report(states), following_error=_following_error(recording, name))
         for name, states in recording.drives.items()},
        {name: linkage_report(recording.machine.linkages[name].assembly, states)
         for name, states in recording.linkages.items()})


def _following_error(recording: Recording, drive: str) -> float | None:
    """Compare set and actual positions of the same instants; None where there are none."""
    actual = recording.actual.get(drive)
    if actual is None:
        return None
    wanted = recording.setpoints.get(recording.machine.drives[drive].axis)
    if wanted is None:
        return None
    worst = []
    for run in np.unique(actual.run):  # the time base may begin anew
        set_to, real = (track.chosen(track.run == run) for track in (wanted, actual))
        _, at, there = np.intersect1d(set_to.time_ns, real.time_ns, return_indices=True)
        worst += list(np.abs(set_to.position[at] - real.position[there]))
    return float(np.max(worst)) if worst else None


def tick_figures(
    shaft: Track, rate_hz: float, holds: int = 0, repeated: int = 0
) -> TickFigures:
    """
    Lay the recorded ticks onto the grid of the time base.

    Parameters
    ----------
    shaft : Track
        Shaft points, each tick once.
    rate_hz : float
        Configured rate [Hz]; where the ticks do not stand on its grid, their own is taken.
    holds, repeated : int
        Points that were set aside before because they repeat a tick, at rest and in motion.

    Returns
    -------
    TickFigures
        Counts and gaps.

    """
    ticks, irregular = _on_grid(shaft, rate_hz)
    within = np.diff(shaft.time_ns)[np.diff(shaft.run) == 0]
    if irregular > len(shaft) // 2 and len(within):
        # another rate than the machine file says: the recorded one shows by itself
        rate_hz = 1e9 / float(np.median(within))
        ticks, irregular = _on_grid(shaft, rate_hz)
    steps = np.where(np.diff(shaft.run) == 0, np.diff(ticks), 1)
    gaps = tuple((float(shaft.time_ns[i]) * 1e-9, int(steps[i]) - 1)
                 for i in np.flatnonzero(steps > 1))
    return TickFigures(len(shaft), len(shaft) + sum(n for _, n in gaps), gaps, irregular, holds,
                       repeated, rate_hz)


def _on_grid(shaft: Track, rate_hz: float) -> tuple[NDArray[np.int64], int]:
    """Give the ticks their numbers, and count the points whose time is not that of their tick."""
    ticks = np.rint(shaft.time_ns * 1e-9 * rate_hz).astype(np.int64)
    # the time of tick k is k / rate, rounded to the nanosecond
    return ticks, int(np.sum(np.abs(shaft.time_ns - ticks * (1e9 / rate_hz)) > 1.0))


def drive_report(states: JointStateSeries) -> DriveReport:
    """
    Gather the figures of a drive.

    Parameters
    ----------
    states : JointStateSeries
        Its states, with a joint ``motor``.

    Returns
    -------
    DriveReport
        Peaks and root mean square; zeros where nothing was recorded.

    """
    column = states.names.index('motor') if 'motor' in states.names else 0
    empty = not len(states.positions) or not states.names
    speed = np.zeros(0) if empty else states.velocities[:, column]
    torque = np.zeros(0) if empty else states.efforts[:, column]
    moving = np.flatnonzero(speed)
    busy = torque[moving[0]:moving[-1] + 1] if len(moving) else torque[:0]
    return DriveReport(
        len(speed), float(np.max(np.abs(torque), initial=0.0)),
        float(np.sqrt(np.mean(busy ** 2))) if len(busy) else 0.0,
        float(np.max(np.abs(speed), initial=0.0)), speed, torque)
