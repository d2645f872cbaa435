# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""How fast a film goes: its frames against the time of the machine."""

from __future__ import annotations

from dataclasses import dataclass
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.piece import Array
import numpy as np

FPS = 25.0
"""Frames per second unless something else is asked for."""

MOST_FRAMES = 5000
"""Frames that a film may have."""

_LEAST_SECONDS, _MOST_SECONDS = 5.0, 15.0  # of a film nobody set the speed of
_SECONDS_A_CYCLE = 1.0  # what the eye can follow


@dataclass(frozen=True)
class Wishes:
    """
    How fast a film shall go.

    Attributes
    ----------
    fps : float
        Frames per second.
    seconds : float, optional
        How long the film shall take [s].
    speed : float, optional
        How fast it shall go, 1 for real time.

    """

    fps: float = FPS
    seconds: float | None = None
    speed: float | None = None


@dataclass(frozen=True)
class Pace:
    """
    The frames of a film against the time of the machine.

    Attributes
    ----------
    duration : float
        Time of the machine that the film shows [s].
    count : int
        Number of frames.
    fps : float
        Frames per second.
    closed : bool
        Whether the end is the begin, so that the film has only one of them.
    points : int
        How many points the curves have at least.

    """

    duration: float
    count: int
    fps: float
    closed: bool = False
    points: int = 360

    @property
    def stride(self) -> int:
        """Give how many points of the curves there are for a frame."""
        return max(1, math.ceil(self.points / self._steps))

    @property
    def _steps(self) -> int:
        """Count the steps from frame to frame."""
        return self.count if self.closed else self.count - 1

    @property
    def times(self) -> Array:
        """Give the times of the points of the curves, both ends among them [s]."""
        return np.linspace(0.0, self.duration, self._steps * self.stride + 1)

    def frames(self, values: Array) -> Array:
        """
        Choose those of the points of the curves that stand at frames.

        Parameters
        ----------
        values : ndarray, shape (points, ...)
            One value for each time.

        Returns
        -------
        ndarray, shape (count, ...)
            Those at the frames.

        """
        return values[::self.stride][:self.count]

    @property
    def note(self) -> str:
        """Say how fast the film goes."""
        speed = self.duration * self.fps / self.count
        if abs(speed - 1.0) < 0.01:
            return 'in real time'
        return f'{speed:.3g} times as fast' if speed > 1.0 else f'{1.0 / speed:.3g} times slower'


def pace_problems(wishes: Wishes) -> list[Problem]:
    """
    Find what is wrong with how fast a film shall go.

    Parameters
    ----------
    wishes : Wishes
        How fast it shall go.

    Returns
    -------
    list[Problem]
        All problems.

    """
    if wishes.seconds is None or wishes.speed is None:
        return []
    return [Problem('--speed', wishes.speed, 'stands beside --seconds, and both say how fast the '
                    'film goes', 'leave one out')]


def pace(wishes: Wishes, duration: float, cycles: float = 0.0, closed: bool = False,
         points: int = 360) -> Pace:
    """
    Set the frames of a film.

    Parameters
    ----------
    wishes : Wishes
        How fast it shall go; where nothing is wished, in real time if that is between 5 and 15 s
        and leaves a second for every cycle, and otherwise as near to it as can be.
    duration : float
        Time of the machine that it shows [s].
    cycles : float
        Turns of the shaft in this time.
    closed : bool
        Whether the end is the begin.
    points : int
        How many points the curves have at least.

    Returns
    -------
    Pace
        The frames.

    Raises
    ------
    ConfigurationError
        When both the length and the speed are wished, or the film would have too many frames,
        or too few.

    """
    if problems := pace_problems(wishes):
        raise ConfigurationError(problems)
    if wishes.seconds is not None:
        seconds = wishes.seconds
    elif wishes.speed is not None:
        seconds = duration / wishes.speed
    else:
        seconds = min(_MOST_SECONDS, max(duration, cycles * _SECONDS_A_CYCLE, _LEAST_SECONDS))
    count = round(seconds * wishes.fps)
    if not 2 <= count <= MOST_FRAMES:
        raise ConfigurationError([Problem(
            '--fps', wishes.fps, f'makes {count} frames of {seconds:g} s: a film has 2 to '
            f'{MOST_FRAMES}', 'choose another --fps, --seconds or --speed')])
    return Pace(duration, count, wishes.fps, closed, points)
