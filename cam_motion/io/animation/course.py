# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a machine goes through in a film: a cycle at steady speed, or a recorded run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.animation.pace import Pace, pace, Wishes
from cam_motion.io.axis import CoupledAxis
from cam_motion.io.axis_limits import CascadedAxis
from cam_motion.io.bag import JointStateSeries
from cam_motion.io.interlocks import motions_of
from cam_motion.io.machine import Machine
from cam_motion.io.recording import Recording, RecordingError, Track
from cam_motion.motion.piece import Array
from cam_motion.runtime.interlock import common_turns
from cam_motion.runtime.motion_over_angle import Motion
from cam_motion.units import DEGREE, RPM, TURN
import numpy as np
from numpy.typing import NDArray

Ticks = NDArray[np.int64]
"""Times [ns]."""

_RECORDED_POINTS = 1500  # of the curves of a recorded run
_BESIDE = 1e-9  # how near a joint its two sides are looked at [rad]
_STANDS = 1e-9  # share of its greatest speed below which an axis stands
_TICKS = 9  # on an axis of angles at most


@dataclass(frozen=True)
class Course:
    """
    What the shaft and its axes do in a film, at each point of the curves.

    Attributes
    ----------
    title : str
        What it is.
    timing : Pace
        Which of the points are frames.
    times, phi : ndarray, shape (n,)
        Times from the begin [s], angles of the shaft [rad].
    axes : Mapping[str, ndarray of shape (3, n)]
        Position, velocity and acceleration of every axis [unit, unit/s, unit/s²].
    turns : int
        Turns of the shaft after which all axes stand again where they stood.
    joints : Mapping[str, ndarray]
        Shaft angles at which an axis may step, where the curves go over the angle [rad].
    motions : Mapping[str, Motion]
        Motions over the shaft angle, by axis.
    omega : float
        Speed of the shaft, where that is steady [rad/s].
    over_angle : bool
        Whether the curves go over the shaft angle, or over time.
    linkages : Mapping[str, Mapping[str, ndarray of shape (2, n)]]
        Position and velocity of every variable of the linkages that told their state.

    """

    title: str
    timing: Pace
    times: Array
    phi: Array
    axes: Mapping[str, Array]
    turns: int
    motions: Mapping[str, Motion]
    omega: float = 0.0
    over_angle: bool = True
    joints: Mapping[str, Array] = field(default_factory=dict)
    linkages: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)

    @property
    def across(self) -> str:
        """Say what the curves go over."""
        return 'shaft angle φ [deg]' if self.over_angle else 'time [s]'

    @property
    def x(self) -> Array:
        """Give what the curves go over [deg, s]."""
        return self.phi / DEGREE if self.over_angle else self.times

    @property
    def cursor(self) -> Array:
        """Give where the cursor stands in each frame [deg, s]."""
        return self.timing.frames(self.x)

    @property
    def ticks(self) -> Sequence[float]:
        """Give the ticks of an axis of angles [deg]; none for an axis of times."""
        return angle_ticks(self.turns) if self.over_angle else ()

    @property
    def captions(self) -> list[str]:
        """Say of every frame when it is and where the shaft is."""
        frames = zip(self.timing.frames(self.times), self.timing.frames(self.phi) / DEGREE)
        if self.over_angle:
            return [f't = {time:.3f} s   φ = {angle:.0f}°' for time, angle in frames]
        return [f't = {time:.2f} s   φ = {angle % 360.0:.0f}°   cycle {angle // 360.0:.0f}'
                for time, angle in frames]

    def curve(self, axis: str, order: int) -> tuple[Array, Array]:
        """
        Give the curve of an axis, with both values where it steps.

        Parameters
        ----------
        axis : str
            Name of the axis.
        order : int
            0 for its position, 1 for its velocity, 2 for its acceleration.

        Returns
        -------
        tuple[ndarray, ndarray], shape (n,) each
            What it goes over [deg, s], and its values [unit, unit/s, unit/s²].

        """
        if not self.over_angle:
            return self.x, self.axes[axis][order]
        joints = self.joints[axis]
        phi = np.sort(np.clip(np.concatenate([self.phi, joints - _BESIDE, joints + _BESIDE]),
                              self.phi[0], self.phi[-1]))
        return phi / DEGREE, self.motions[axis](phi)[order] * self.omega ** order

    def moving(self, axis: str) -> list[tuple[float, float]]:
        """
        Find where an axis moves in a cycle.

        Parameters
        ----------
        axis : str
            Name of the axis.

        Returns
        -------
        list[tuple[float, float]]
            Begin and end of each stretch [rad].

        """
        motion = self.motions[axis]
        ends = np.unique(np.concatenate([
            [0.0], np.clip(motion.joints(0.0, self.turns * TURN), 0.0, self.turns * TURN),
            [self.turns * TURN]]))
        # a motion stands between two joints if it does at some places there
        inner = ends[:-1, None] + np.diff(ends)[:, None] * np.array([0.11, 0.37, 0.63, 0.89])
        speeds = np.abs(motion(inner.ravel())[1]).reshape(inner.shape).max(axis=1)
        moves = speeds > _STANDS * speeds.max(initial=0.0)
        found: list[tuple[float, float]] = []
        for begin, end, moving in zip(ends, ends[1:], moves):
            if moving and end > begin:
                joined = bool(found) and found[-1][1] == begin
                found.append((found.pop()[0] if joined else float(begin), float(end)))
        return found


def cycle_of(machine: Machine, wishes: Wishes) -> Course:
    """
    Give one cycle of a machine at its set speed.

    Parameters
    ----------
    machine : Machine
        The machine.
    wishes : Wishes
        How fast the film shall go.

    Returns
    -------
    Course
        The cycle: as many turns as it takes until all axes stand again where they stood.

    Raises
    ------
    ConfigurationError
        When the shaft stands.

    """
    omega = machine.master.speed
    if omega <= 0.0:
        raise ConfigurationError([Problem(
            f'{machine.master.name}.speed_cpm', omega / RPM, 'a shaft that stands moves nothing',
            'give it a speed with --speed-cpm')])
    motions, turns = _motions(machine)
    timing = pace(wishes, turns * TURN / omega, turns, closed=True)
    phi = timing.times * omega
    scale = omega ** np.arange(3)[:, None]
    return Course(
        f'one cycle at {omega / RPM:g} cycles/min', timing, timing.times, phi,
        {name: motion(phi)[:3] * scale for name, motion in motions.items()}, turns, motions,
        omega, joints={name: motion.joints(0.0, turns * TURN)
                       for name, motion in motions.items()})


def recorded_course(recording: Recording, wishes: Wishes,
                    window: tuple[float | None, float | None] = (None, None)) -> Course:
    """
    Give a recorded run of a machine, or a part of it.

    Parameters
    ----------
    recording : Recording
        The run; where its time base begins anew, the longest stretch is taken.
    wishes : Wishes
        How fast the film shall go.
    window : tuple[float or None, float or None]
        From and to when, counted from the first tick [s].

    Returns
    -------
    Course
        What was recorded, at the ticks nearest to the times of the film. Axes that were not
        recorded are left out.

    Raises
    ------
    ConfigurationError
        When the window holds nothing.
    RecordingError
        When too little was recorded.

    """
    shaft = _longest(recording.shaft)
    if len(shaft) < 2:
        raise RecordingError(f'{recording.path}: a single tick makes no film')
    clock = (shaft.time_ns - shaft.time_ns[0]) * 1e-9
    begin = 0.0 if window[0] is None else window[0]
    end = clock[-1] if window[1] is None else min(window[1], clock[-1])
    if not 0.0 <= begin < end:
        raise ConfigurationError([Problem(
            '--from', begin, f'the film would end at {end:g} s, and the run goes from 0 to '
            f'{clock[-1]:g} s', 'choose --from and --to within it')])
    inside = shaft.position[(clock >= begin) & (clock <= end)]
    timing = pace(wishes, end - begin, float(np.ptp(inside)) / TURN if len(inside) else 0.0,
                  points=_RECORDED_POINTS)
    at = shaft.time_ns[0] + np.rint((begin + timing.times) * 1e9).astype(np.int64)
    motions, turns = _motions(recording.machine)
    tracks = {name: _longest(track) for name, track in recording.setpoints.items()
              if track is not None and len(track)}
    return Course(
        f'recorded in {recording.path.name}', timing, timing.times + begin,
        _nearest(shaft, at)[0], {name: _nearest(track, at) for name, track in tracks.items()},
        turns, {name: motions[name] for name in tracks}, over_angle=False,
        linkages={name: _states(shaft, states, at)
                  for name, states in recording.linkages.items() if len(states.stamps_ns)})


def _states(shaft: Track, states: JointStateSeries, at: Ticks) -> dict[str, Array]:
    """Give position and velocity of every joint at the states nearest to some ticks."""
    # two clocks tell the same ticks: the fastest message of each says how they differ
    ahead = (states.stamps_ns - states.header_stamps_ns).min() - (
        shaft.stamps_ns - shaft.time_ns).min()
    place = _place(states.header_stamps_ns + ahead, at)
    return {name: np.array([states.positions[place, k], states.velocities[place, k]])
            for k, name in enumerate(states.names)}


def angle_ticks(turns: int) -> Sequence[float]:
    """
    Give the ticks of an axis of shaft angles.

    Parameters
    ----------
    turns : int
        How many turns it shows.

    Returns
    -------
    Sequence[float]
        Angles [deg].

    """
    step = next((each for each in (45, 90, 180, 360) if turns * 360 / each < _TICKS),
                360 * math.ceil(turns / _TICKS))
    return [float(each) for each in range(0, turns * 360 + 1, step)]


def _motions(machine: Machine) -> tuple[dict[str, Motion], int]:
    """Give the motions of all axes, and after how many turns they repeat."""
    axes = {name: axis for name, axis in machine.diagram.axes.items()
            if isinstance(axis, CoupledAxis)}
    ratios = [axis.layout.couplings[cam].ratio for axis in axes.values()
              if not isinstance(axis, CascadedAxis) for cam in axis.layout.active]
    periods = [axis.period / TURN for axis in axes.values() if isinstance(axis, CascadedAxis)]
    return motions_of(axes), common_turns([*ratios, *(1.0 / turns for turns in periods)])


def _longest(track: Track) -> Track:
    """Choose the longest stretch within which time goes on, every time once."""
    if not len(track):
        return track
    runs, counts = np.unique(track.run, return_counts=True)
    chosen = track.chosen(track.run == runs[np.argmax(counts)])
    return chosen.chosen(np.concatenate([np.diff(chosen.time_ns) > 0, [True]]))


def _nearest(track: Track, at: Ticks) -> Array:
    """Give position, velocity and acceleration at the points nearest to some times."""
    place = _place(track.time_ns, at)
    return np.array([track.position[place], track.velocity[place], track.acceleration[place]])


def _place(times: Ticks, at: Ticks) -> NDArray[np.intp]:
    """Find which of some rising times are nearest to others."""
    after = np.clip(np.searchsorted(times, at), 0, len(times) - 1)
    before = np.maximum(after - 1, 0)
    return np.where(at - times[before] <= times[after] - at, before, after)
