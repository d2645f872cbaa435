# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Setpoints of one axis beside the exact curve at the recorded shaft angles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from cam_motion.io.axis import CoupledAxis
from cam_motion.io.axis_limits import CascadedAxis
from cam_motion.io.axis_states import durations, spells_of, within
from cam_motion.io.recording import Track
from cam_motion.motion.diagram import Axis
from cam_motion.motion.piece import Array
from cam_motion.runtime.demand import Demand, Demands
from cam_motion.runtime.motion_over_angle import CoupledCam, Motion
from cam_motion.units import TURN
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
    elsewhere : Mapping[str, float]
        How long the axis was not on its curve [s], by what it did instead; not compared.

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
    elsewhere: Mapping[str, float] = field(default_factory=dict)

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


def compare_axis(axis: Axis, shaft: Track, setpoints: Track,
                 states: Sequence[tuple[int, str]] = ()) -> AxisReport:
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
    states : Sequence[tuple[int, str]]
        (Time of reception [ns], state) as the axis told them: what it did while it was not on
        its curve is not compared.

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
    spells = spells_of(states, isinstance(axis, CoupledAxis) and (
        axis.settings.master_relative or axis.settings.slave_relative))
    off = within(spells, answers.stamps_ns)
    compared = paired & ~off
    chosen, at = answers.chosen(compared), place[compared]
    left_out = ~answered & ~unheard & ~within(spells, shaft.stamps_ns)
    recorded, seen = (chosen.position, chosen.velocity, chosen.acceleration), _seen(
        axis, shaft, at)
    if spells and axis.profile.advance:
        # whole strokes are all the same to a belt that has been stopped and engaged anew
        later = chosen.stamps_ns > spells[0].begin_ns
        recorded = (chosen.position - later * _strokes(axis, seen[0], chosen.position),
                    *recorded[1:])
    comparison = _compare(axis, *seen, recorded)
    return AxisReport(
        axis, int(paired.sum()), int(holds.sum()), int((repeats & ~holds).sum()),
        int((~paired & ~off).sum()), int(left_out.sum()),
        float(shaft.time_ns[left_out][0]) * 1e-9 if left_out.any() else None, int(unheard.sum()),
        (float(np.max(np.abs(setpoints.velocity), initial=0.0)),
         float(np.max(np.abs(setpoints.acceleration), initial=0.0))),
        comparison, durations(spells, int(setpoints.stamps_ns[-1]) if len(setpoints) else 0))


def _seen(axis: Axis, shaft: Track, at: NDArray[np.int64]) -> tuple[Array, Array, Array]:
    """Give angle, speed and acceleration as the axis saw them, ahead by its dead time."""
    phi, omega, alpha = shaft.position[at], shaft.velocity[at], shaft.acceleration[at]
    lead = axis.values['dead_time'] if isinstance(axis, CoupledAxis) else 0.0
    return phi + lead * (omega + 0.5 * lead * alpha), omega + lead * alpha, alpha


def _strokes(axis: Axis, phi: Array, position: Array) -> Array:
    """Find the whole strokes by which a belt lies ahead of its curve."""
    stroke = axis.profile.advance
    if isinstance(axis, CoupledAxis):
        stroke = axis.layout.stroke
    return np.asarray(stroke * np.rint((position - _motion(axis)(phi)[0]) / stroke))


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
    top = float(np.max(np.abs(omega), initial=0.0))
    y, slope, bend, *_ = _motion(axis)(phi)
    exact = (y, slope * omega, bend * omega * omega + slope * alpha)
    peaks = [peak * top ** order for order, peak in enumerate(_peaks(axis))]
    return Comparison(phi, omega, alpha, recorded, exact, (
        _share(recorded[0] - exact[0], peaks[0]), _share(recorded[1] - exact[1], peaks[1]),
        _share(recorded[2] - exact[2], peaks[2])))


def _motion(axis: Axis) -> Motion:
    if isinstance(axis, CascadedAxis):
        return axis.motion
    return axis.layout.motion if isinstance(axis, CoupledAxis) else CoupledCam(axis.profile)


def _peaks(axis: Axis) -> list[float]:
    """Find the largest magnitudes of position and two derivatives in one cycle."""
    motion = _motion(axis)
    if motion == CoupledCam(axis.profile):
        return [abs(axis.profile.curve.peak(order).value) for order in range(3)]
    course: Demands = Demand(motion, 0.0, TURN)
    if isinstance(axis, CoupledAxis):
        course = axis.course if isinstance(axis, CascadedAxis) else axis.layout.course
    return [float(np.max(np.abs(row))) for row in course.values[:3]]


def _share(difference: Array, peak: float) -> Array:
    """Give deviations as shares of a peak; what is no number deviates infinitely."""
    size = np.abs(difference)
    share = size / peak if peak > 0.0 else np.where(size > 0.0, np.inf, 0.0)
    return np.where(np.isfinite(size), share, np.inf)
