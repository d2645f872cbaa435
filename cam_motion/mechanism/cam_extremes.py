# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
Extremes over one turn of whatever follows from a cam's motion, found and not looked up on a grid.

Between two joints everything is smooth. There it is replaced by Chebyshev series that agree with
it to rounding, and the zeros of their derivatives are all the places an extreme can be.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator
from functools import partial
import math

from cam_motion.drive.cam_drive import Element, SHORTEST
from cam_motion.drive.load import Follower
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Peak
from cam_motion.motion.profile import CamProfile
from cam_motion.units import TURN
import numpy as np
from numpy.polynomial import chebyshev

_DEGREE = 40
_POINTS = chebyshev.chebpts1(_DEGREE + 1)
_TRANSFORM = chebyshev.chebvander(_POINTS, _DEGREE).T * (2.0 / (_DEGREE + 1))
_TRANSFORM[0] *= 0.5
_FIRST = 17  # values of a stretch that are looked at first
_TAIL = 4  # coefficients at the end of a series that tell whether it is complete
_RESOLVED = 1e-12  # share of the largest coefficient below which they are rounding
_ROUNDING = 1e-14  # share of a scale that is rounding
_HALVINGS = 9  # of a stretch, at most, until its series is complete
_REAL = 1e-6  # imaginary part of a zero that is real, rounded
_TIE = 1e-12  # extremes this close (relative) count as equal; the first one is reported
_INSIDE = 1e-12  # how far within a stretch loads are looked up, free of steps at its ends
_AT_REST, _TINY = 1e-10, 1e-300  # friction needs to know whether it is about to move out or in


def split_turn(profile: CamProfile, cuts: Iterable[float] = ()) -> tuple[Element, ...]:
    """
    Split a turn at the joints of a cam and at further angles.

    Parameters
    ----------
    profile : CamProfile
        The cam.
    cuts : Iterable[float]
        Shaft angles [rad].

    Returns
    -------
    tuple[Element, ...]
        Stretches from 0 to one turn, each within one piece.

    """
    curve = profile.curve
    joints = [0.0, *curve.breaks[1:-1], TURN]
    further = {cut % TURN for cut in cuts}
    ends = sorted((*joints, *(cut for cut in further if min(
        abs(cut - joint) for joint in joints) > SHORTEST)))
    return tuple(
        Element(low, high, max(0, bisect_right(curve.breaks, 0.5 * (low + high)) - 1))
        for low, high in zip(ends, ends[1:]))


def follower_in(profile: CamProfile, element: Element, q: Array) -> Follower:
    """
    Give the follower within a stretch, its ends from inside.

    Parameters
    ----------
    profile : CamProfile
        The cam.
    element : Element
        The stretch.
    q : ndarray
        Shaft angles within it [rad].

    Returns
    -------
    Follower
        Where the follower is. Where it comes to rest, ``s1`` keeps the sign it has within.

    """
    piece, begin = profile.curve.pieces[element.piece], profile.curve.breaks[element.piece]
    slope = piece.derivative
    u = q - begin
    s1 = slope(u)
    within = slope.at(0.5 * (element.start + element.end) - begin)
    s1 = np.where(np.abs(s1) <= _AT_REST * abs(within), math.copysign(_TINY, within), s1)
    inside = np.clip(q, element.start + _INSIDE, element.end - _INSIDE)
    return Follower(inside, piece(u), s1 if within else slope(u), slope.derivative(u))


def candidates(value: Callable[[Array], Array], low: float, high: float,
               known: tuple[float, float] | None = None) -> Iterator[Peak]:
    """
    List the ends and the stationary values of a smooth function.

    Parameters
    ----------
    value : Callable[[ndarray], ndarray]
        The function.
    low, high : float
        Ends of the interval.
    known : tuple[float, float] | None
        A lower and a higher value that are found elsewhere: what lies between them, or is their
        rounding, is not searched.

    Yields
    ------
    Peak
        All extremes are among them, rising by their place.

    References
    ----------
    L. N. Trefethen, Approximation Theory and Approximation Practice (2013), chapters 3 and 18.

    """
    places = [low, *_stationary(value, low, high, known, _HALVINGS), high]
    values = value(np.array(places))
    yield from (Peak(float(found), at) for found, at in zip(values, places))


def _stationary(value: Callable[[Array], Array], low: float, high: float,
                known: tuple[float, float] | None, halvings: int) -> list[float]:
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    series = _TRANSFORM @ value(middle + half * _POINTS)
    largest, reach = float(np.max(np.abs(series))), float(np.sum(np.abs(series[1:])))
    noise = 0.0 if known is None else _ROUNDING * max(abs(known[0]), abs(known[1]))
    if reach <= noise:
        return []
    complete = np.max(np.abs(series[-_TAIL:])) <= max(_RESOLVED * largest, noise)
    if not complete and halvings > 0:
        return [*_stationary(value, low, middle, known, halvings - 1), middle,
                *_stationary(value, middle, high, known, halvings - 1)]
    slack = _TIE * largest  # no polynomial of Chebyshev's is beyond 1
    if known is not None and (known[0] + slack < series[0] - reach
                              and series[0] + reach < known[1] - slack):
        return []
    slope = chebyshev.chebder(chebyshev.chebtrim(series, 1e-15 * largest))
    if slope.size < 2:
        return []
    roots = chebyshev.chebroots(slope)
    inside = roots.real[(np.abs(roots.imag) < _REAL) & (np.abs(roots.real) < 1.0)]
    return [middle + half * float(root) for root in np.sort(inside)]


def extremes(profile: CamProfile, value: Callable[[Follower], Array],
             cuts: Iterable[float] = ()) -> tuple[Peak, Peak]:
    """
    Find the least and the greatest value over one turn, steps taken from both sides.

    Parameters
    ----------
    profile : CamProfile
        The cam.
    value : Callable[[Follower], ndarray]
        Gives the value where the follower is; smooth between the joints and the cuts.
    cuts : Iterable[float]
        Shaft angles at which it may step besides [rad].

    Returns
    -------
    tuple[Peak, Peak]
        Least and greatest, each with its (first) shaft angle [rad].

    """
    functions = [(element, partial(_within, profile, value, element))
                 for element in split_turn(profile, cuts)]
    values = np.concatenate([function(np.linspace(element.start, element.end, _FIRST))
                             for element, function in functions])
    known = (float(np.min(values)), float(np.max(values)))
    points = [point for element, function in functions
              for point in candidates(function, element.start, element.end, known)]
    return least_of(points), greatest_of(points)


def _within(profile: CamProfile, value: Callable[[Follower], Array], element: Element, q: Array,
            ) -> Array:
    return value(follower_in(profile, element, q))


def least_of(points: list[Peak]) -> Peak:
    """
    Choose the least of several values, of equal ones the first.

    Parameters
    ----------
    points : list[Peak]
        Values and their places.

    Returns
    -------
    Peak
        The least.

    """
    slack = _TIE * max(abs(point.value) for point in points)
    least = min(point.value for point in points)
    return next(point for point in points if point.value <= least + slack)


def greatest_of(points: list[Peak]) -> Peak:
    """
    Choose the greatest of several values, of equal ones the first.

    Parameters
    ----------
    points : list[Peak]
        Values and their places.

    Returns
    -------
    Peak
        The greatest.

    """
    least = least_of([Peak(-point.value, point.at) for point in points])
    return Peak(-least.value, least.at)
