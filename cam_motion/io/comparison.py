# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Setpoints of one axis beside the exact curve at the recorded shaft angles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from cam_motion.io.recording import Track
from cam_motion.motion.diagram import Axis
from cam_motion.motion.piece import Array
import numpy as np
from numpy.typing import NDArray

TOLERANCE = 1e-9
"""Largest deviation from the exact curve, as a share of the axis' own peak."""
TOLERANCE_TEXT = '1e-9'
"""The same as people write it."""

# A recorder finds the topics of a line one after the other; ticks that an axis must have
# answered before it was heard are told apart from ticks that it left out [s].
_STARTING = 2.0
# A recorder that ends before the line cuts through the last tick or two [s].
_ENDING = 0.05

QUANTITIES = ('position', 'velocity', 'acceleration')
"""What a setpoint holds, by order of the derivative."""


class Comparison(NamedTuple):
    """
    Setpoints beside the exact curve, arrays of one shape (n,).

    Shaft angle phi [rad], speed omega [rad/s] and acceleration alpha [rad/s²]; recorded and exact
    values, each (position, velocity, acceleration) [unit, unit/s, unit/s²]; and the deviations as
    shares of the axis' own peaks [-].
    """

    phi: Array
    omega: Array
    alpha: Array
    recorded: tuple[Array, Array, Array]
    exact: tuple[Array, Array, Array]
    deviations: tuple[Array, Array, Array]


@dataclass(frozen=True)
class AxisReport:
    """
    What an axis did.

    Attributes
    ----------
    axis : Axis
        The axis.
    setpoints : int
        Setpoints that answer a shaft tick.
    holds : int
        Hold setpoints: they repeat the last one without velocity and acceleration.
    repeated : int
        Setpoints that repeat a tick without being a hold.
    unpaired : int
        Setpoints for which the bag has no shaft point.
    unanswered : int
        Shaft ticks without a setpoint.
    unanswered_at : float | None
        Time of the first of them [s].
    unheard : int
        Shaft ticks before the recorder heard the axis, or after it had left; not counted above.
    peaks : tuple[float, float]
        Largest magnitudes of recorded velocity and acceleration [unit/s, unit/s²].
    comparison : Comparison
        The setpoints beside the exact curve.

    """

    axis: Axis
    setpoints: int
    holds: int
    repeated: int
    unpaired: int
    unanswered: int
    unanswered_at: float | None
    unheard: int
    peaks: tuple[float, float]
    comparison: Comparison

    @property
    def deviations(self) -> tuple[float, float, float]:
        """Worst deviations of position, velocity and acceleration as shares of the peaks [-]."""
        return tuple(  # type: ignore[return-value]
            float(np.max(each, initial=0.0)) for each in self.comparison.deviations)


def repeats_of(track: Track) -> NDArray[np.bool_]:
    """
    Tell the points that repeat the time of the one before.

    Parameters
    ----------
    track : Track
        The points.

    Returns
    -------
    ndarray of bool, shape (n,)
        Whether each is a repeat.

    """
    same = (np.diff(track.time_ns) == 0) & (np.diff(track.run) == 0)
    return np.concatenate([[False], same]) if len(track) else np.zeros(0, dtype=bool)


def compare_axis(axis: Axis, shaft: Track, setpoints: Track) -> AxisReport:
    """
    Pair setpoints with the shaft points they answer, and compare them with the exact curve.

    Parameters
    ----------
    axis : Axis
        The axis.
    shaft : Track
        Shaft points, each tick once.
    setpoints : Track
        Setpoints of the axis.

    Returns
    -------
    AxisReport
        Counts and deviations.

    """
    repeats = repeats_of(setpoints)
    same_place = np.concatenate([[False], np.diff(setpoints.position) == 0.0])[:len(setpoints)]
    holds = repeats & same_place & (setpoints.velocity == 0.0) & (setpoints.acceleration == 0.0)
    answers = setpoints.chosen(~holds)
    place, paired = _pair(shaft, answers)
    answered = np.zeros(len(shaft), dtype=bool)
    answered[place[paired]] = True
    unheard = _unheard(shaft, answered)
    chosen, at = answers.chosen(paired), place[paired]
    left_out = ~answered & ~unheard
    comparison = _compare(axis, shaft.position[at], shaft.velocity[at], shaft.acceleration[at],
                          (chosen.position, chosen.velocity, chosen.acceleration))
    return AxisReport(
        axis, int(paired.sum()), int(holds.sum()), int((repeats & ~holds).sum()),
        int((~paired).sum()), int(left_out.sum()),
        float(shaft.time_ns[left_out][0]) * 1e-9 if left_out.any() else None, int(unheard.sum()),
        (float(np.max(np.abs(setpoints.velocity), initial=0.0)),
         float(np.max(np.abs(setpoints.acceleration), initial=0.0))),
        comparison)


def _pair(shaft: Track, answers: Track) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Find for each setpoint the shaft point of its time, and whether there is one."""
    known = {key: place for place, key in enumerate(zip(shaft.run.tolist(),
                                                        shaft.time_ns.tolist()))}
    place = np.array([known.get(key, -1) for key in zip(answers.run.tolist(),
                                                        answers.time_ns.tolist())],
                     dtype=np.int64)
    return place, place >= 0


def _unheard(shaft: Track, answered: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Tell the ticks at both ends that a recorder may miss the answers of by its own timing."""
    found = np.zeros(len(shaft), dtype=bool)
    if not answered.any():
        return found
    first, last = np.flatnonzero(answered)[[0, -1]]
    found[:first] = (shaft.time_ns[:first] <= shaft.time_ns[0] + _STARTING * 1e9) & (
        shaft.run[:first] == shaft.run[0])
    if shaft.velocity[-1] != 0.0:
        # the recording ends while the shaft turns: it was the recorder that ended
        found[last + 1:] = shaft.time_ns[last + 1:] >= shaft.time_ns[-1] - _ENDING * 1e9
    return found


def _compare(axis: Axis, phi: Array, omega: Array, alpha: Array,
             recorded: tuple[Array, Array, Array]) -> Comparison:
    profile = axis.profile
    slope, bend = profile(phi, 1), profile(phi, 2)
    exact = (profile(phi), slope * omega, bend * omega * omega + slope * alpha)
    top = float(np.max(np.abs(omega), initial=0.0))
    peaks = (abs(profile.curve.peak(0).value), abs(profile.curve.peak(1).value) * top,
             abs(profile.curve.peak(2).value) * top * top)
    return Comparison(phi, omega, alpha, recorded, exact, (
        _share(recorded[0] - exact[0], peaks[0]), _share(recorded[1] - exact[1], peaks[1]),
        _share(recorded[2] - exact[2], peaks[2])))


def _share(difference: Array, peak: float) -> Array:
    """Give deviations as shares of a peak; what is no number deviates infinitely."""
    size = np.abs(difference)
    share = size / peak if peak > 0.0 else np.where(size > 0.0, np.inf, 0.0)
    return np.where(np.isfinite(size), share, np.inf)
