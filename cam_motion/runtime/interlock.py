# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Interlocks: what two axes must never do at once, looked for over a range of shaft angles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
import math
from typing import NamedTuple, Protocol

from cam_motion.motion.piece import Array
from cam_motion.runtime.motion_over_angle import Motion
from cam_motion.units import DEGREE, TURN
import numpy as np

_POINTS = 33  # between two joints, among which extremes and crossings are looked for
_COARSEST = 0.2  # longest stretch between joints that so many points can serve [rad]
_INSIDE = 1e-9  # how far from a joint its two sides are read [rad]
_HALVINGS = 50
_THIRDS = 60
_MOVING = 1e-12  # of the greatest slope: less is rounding

Function = Callable[[Array], Array]
"""Evaluates something at n shaft angles [rad]."""

Window = tuple[float, float]
"""Shaft angles from where to where [rad]."""


class Verdict(NamedTuple):
    """
    Whether an interlock is kept, and by how much.

    The ``margin`` is negative where it is broken; for a distance in the unit of the axes, for
    windows the shaft angle between them [rad], or minus the one over which they overlap;
    infinite where there is nothing to keep apart. ``at`` is the shaft angle of the least margin
    [rad], ``text`` says it in words.
    """

    kept: bool
    margin: float
    at: float
    text: str


class Interlock(Protocol):
    """Something that the motions of two axes must keep."""

    @property
    def name(self) -> str:
        """Give its name."""

    @property
    def axes(self) -> tuple[str, str]:
        """Name the two axes."""

    def judge(self, motions: Mapping[str, Motion], low: float, high: float,
              repeats: bool = True) -> Verdict:
        """
        Find the least margin over a range of shaft angles.

        Parameters
        ----------
        motions : Mapping[str, Motion]
            Motions by axis.
        low, high : float
            Range of shaft angles [rad].
        repeats : bool
            Whether the motions repeat after that range, so that its end meets its beginning.

        Returns
        -------
        Verdict
            Whether it is kept, and by how much.

        """


@dataclass(frozen=True)
class Distance:
    """
    A gap between two axes that must never become too small.

    The gap is offset + factors[0] y_first + factors[1] y_second.

    Attributes
    ----------
    name : str
        Its name.
    axes : tuple[str, str]
        The two axes.
    factors : tuple[float, float]
        What their positions are multiplied by [-].
    offset : float
        The gap where both stand at 0, in the unit of the axes.
    least : float
        What it must never fall below.

    """

    name: str
    axes: tuple[str, str]
    factors: tuple[float, float]
    offset: float
    least: float

    def judge(self, motions: Mapping[str, Motion], low: float, high: float,
              repeats: bool = True) -> Verdict:
        """
        Find the smallest gap.

        Parameters
        ----------
        motions : Mapping[str, Motion]
            Motions by axis.
        low, high : float
            Range of shaft angles [rad].
        repeats : bool
            Not used: the end of the range is looked at anyway.

        Returns
        -------
        Verdict
            The gap less what it must be.

        """
        pair = [motions[axis] for axis in self.axes]

        def gap(phi: Array) -> Array:
            first, second = (motion(phi)[0] for motion in pair)
            return np.asarray(
                self.offset + self.factors[0] * first + self.factors[1] * second)
        at, smallest = _least(gap, _grid(pair, low, high))
        margin = smallest - self.least
        kept = margin >= -1e-12 * (1.0 + abs(self.least))
        place = f'at {_angle(at)} deg'
        first, second = self.axes
        text = f'{first} and {second} come as near as {smallest:.6g} {place}'
        if kept:
            return Verdict(True, margin, at, f'{text}, {max(margin, 0.0):.4g} more than they must')
        return Verdict(False, margin, at, f'{text}: {-margin:.4g} too near')


class Side(Enum):
    """On which side of a position an axis is out of its rest; the value is its key."""

    ABOVE = 'above'
    BELOW = 'below'
    MOVING = 'moving'


class Out(NamedTuple):
    """When an axis counts as out of its rest: above or below a position, or in motion."""

    side: Side
    position: float = 0.0

    def excess(self, motion: Motion, phi: Array) -> Function:
        """
        Make the function that is positive where the axis is out of its rest.

        Parameters
        ----------
        motion : Motion
            Motion of the axis.
        phi : ndarray, shape (n,)
            The angles at which it will be looked at [rad].

        Returns
        -------
        Callable[[ndarray], ndarray]
            The function of shaft angles [rad].

        """
        if self.side is Side.MOVING:
            least = _MOVING * float(np.max(np.abs(motion(phi)[1]), initial=0.0))
            return lambda phi: np.abs(motion(phi)[1]) - least
        sign = 1.0 if self.side is Side.ABOVE else -1.0
        return lambda phi: sign * (motion(phi)[0] - self.position)

    def __str__(self) -> str:
        """Say it in words."""
        return 'moving' if self.side is Side.MOVING else f'{self.side.value} {self.position:g}'


@dataclass(frozen=True)
class Windows:
    """
    Two axes that must never be out of their rest at once.

    Attributes
    ----------
    name : str
        Its name.
    axes : tuple[str, str]
        The two axes.
    out : tuple[Out, Out]
        When each of them is out of its rest.

    """

    name: str
    axes: tuple[str, str]
    out: tuple[Out, Out]

    def judge(self, motions: Mapping[str, Motion], low: float, high: float,
              repeats: bool = True) -> Verdict:
        """
        Find where both are out of their rest, or how near they come to that.

        Parameters
        ----------
        motions : Mapping[str, Motion]
            Motions by axis.
        low, high : float
            Range of shaft angles [rad].
        repeats : bool
            Whether the motions repeat after that range, so that its end meets its beginning.

        Returns
        -------
        Verdict
            The angle between the windows, or minus the longest overlap.

        """
        pair = [motions[axis] for axis in self.axes]
        first, second = (
            windows(out, motion, low, high) for out, motion in zip(self.out, pair))
        (one, two), (out_1, out_2) = self.axes, self.out
        both = [(max(a, c), min(b, d)) for a, b in first for c, d in second
                if min(b, d) - max(a, c) > 4.0 * _INSIDE]
        if both:
            start, end = max(both, key=lambda window: window[1] - window[0])
            return Verdict(False, start - end, start, (
                f'{one} ({out_1}) and {two} ({out_2}) are out of rest at once from '
                f'{_angle(start)} to {_angle(end)} deg: {(end - start) / DEGREE:.4g} deg'))
        laps = (-1, 0, 1) if repeats else (0,)
        gaps = [gap for a, b in first for c, d in second for lap in laps
                for gap in _gaps(a, b, c + lap * (high - low), d + lap * (high - low))]
        if not gaps:
            return Verdict(True, math.inf, low,
                           f'{one} ({out_1}) and {two} ({out_2}) never meet')
        gap, at = min(gaps)
        return Verdict(True, gap, at, (
            f'{one} ({out_1}) and {two} ({out_2}) are {gap / DEGREE:.4g} deg apart '
            f'at {_angle(at)} deg'))


def _angle(phi: float) -> str:
    return f'{round(phi / DEGREE % 360.0, 3):g}'


def _gaps(a: float, b: float, c: float, d: float) -> list[tuple[float, float]]:
    """Give (angle between, where it begins) of two windows that do not overlap."""
    return [(max(0.0, start - end), end) for end, start in ((b, c), (d, a))
            if start - end >= -4.0 * _INSIDE]


def windows(out: Out, motion: Motion, low: float, high: float) -> list[Window]:
    """
    Find where an axis is out of its rest.

    Parameters
    ----------
    out : Out
        When it is.
    motion : Motion
        Its motion.
    low, high : float
        Range of shaft angles [rad].

    Returns
    -------
    list[tuple[float, float]]
        From where to where [rad], cut off at the ends of the range.

    """
    phi = _grid([motion], low, high)
    excess = out.excess(motion, phi)
    # a peak between two points may reach out where neither of them does
    phi = np.unique(np.concatenate([phi, _peaks(excess, phi)]))
    is_out = excess(phi) > 0.0
    turns = np.flatnonzero(is_out[:-1] != is_out[1:])
    a, b, before = phi[turns], phi[turns + 1], is_out[turns]
    for _ in range(_HALVINGS if len(turns) else 0):
        middle = 0.5 * (a + b)
        same = (excess(middle) > 0.0) == before
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    edges = [*([low] if is_out[0] else []), *b.tolist(), *([high] if is_out[-1] else [])]
    return list(zip(edges[::2], edges[1::2]))


def _grid(motions: list[Motion], low: float, high: float) -> Array:
    """Lay points between the joints of motions, close to both sides of each."""
    edges = np.unique(np.concatenate(
        [[low, high], *(motion.joints(low, high) for motion in motions)]))
    parts = np.maximum(1, np.ceil(np.diff(edges) / _COARSEST)).astype(int)
    edges = np.append(np.concatenate([
        np.linspace(a, b, count, endpoint=False)
        for a, b, count in zip(edges, edges[1:], parts)]), edges[-1])
    inside = np.minimum(_INSIDE, 0.25 * np.diff(edges))
    starts, spans = edges[:-1] + inside, np.diff(edges) - 2.0 * inside
    return (starts[:, None] + spans[:, None] * np.linspace(0.0, 1.0, _POINTS)).ravel()


def _peaks(function: Function, phi: Array) -> Array:
    """Refine the maxima of a function between points of a grid."""
    values = function(phi)
    k = 1 + np.flatnonzero((values[1:-1] >= values[:-2]) & (values[1:-1] >= values[2:]) & (
        (values[1:-1] > values[:-2]) | (values[1:-1] > values[2:])))
    a, b = phi[k - 1], phi[k + 1]
    for _ in range(_THIRDS if len(k) else 0):
        # a third less each time, from the side that is lower
        one, two = a + (b - a) / 3.0, b - (b - a) / 3.0
        lower = function(one) < function(two)
        a, b = np.where(lower, one, a), np.where(lower, b, two)
    return np.asarray(0.5 * (a + b))


def _least(function: Function, phi: Array) -> tuple[float, float]:
    """Find where a function is least over a grid, and its value there."""
    phi = np.concatenate([phi, _peaks(lambda at: -function(at), phi)])
    values = function(phi)
    k = int(np.argmin(values))
    return float(phi[k]), float(values[k])


def common_turns(ratios: list[float], most: int = 24) -> int:
    """
    Count the turns of the shaft after which cams stand again where they stood.

    Parameters
    ----------
    ratios : list[float]
        Turns of each cam per turn of the shaft [-].
    most : int
        Where they do not within so many, these are looked at.

    Returns
    -------
    int
        Whole turns, at least 1.

    """
    for turns in range(1, most):
        if all(abs(ratio * turns - round(ratio * turns)) < 1e-9 for ratio in ratios):
            return turns
    return most


def judge_cycle(interlock: Interlock, motions: Mapping[str, Motion], turns: int) -> Verdict:
    """
    Judge an interlock in steady running.

    Parameters
    ----------
    interlock : Interlock
        The interlock.
    motions : Mapping[str, Motion]
        Motions by axis.
    turns : int
        Turns of the shaft after which they repeat.

    Returns
    -------
    Verdict
        Over all these turns.

    """
    return interlock.judge(motions, 0.0, turns * TURN)
