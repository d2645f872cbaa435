# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The contour of a disc as machines take it: a polyline or a spline within a given distance."""

from __future__ import annotations

import math
from typing import NamedTuple

from cam_motion.drive.cam_drive import Element
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.mechanism.cam_disc import CamDisc
from cam_motion.mechanism.cam_extremes import extremes, follower_in, split_turn
from cam_motion.mechanism.cam_follower import Points
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE
import numpy as np

_FINE = 801  # points per stretch from which the density of a polyline is summed
_INNER = np.linspace(0.0, 1.0, 17)[1:-1]  # places in a segment where the distance is taken
_FLATTEST = 0.05  # curvature by that of the base circle, at least, for the density of points
_LONGEST = math.pi / 6.0  # of a segment [rad]
_MOST_POINTS = 1_000_000
_GROWTH = 1.1  # of the number of segments, where there were not enough


class Outline(NamedTuple):
    """
    A closed polyline whose points lie on the curve.

    Shaft angles [rad] of the points, the points on the disc [m], the first one once more at the
    end, and the largest distance of the curve from the polyline [m].
    """

    angles: Array
    points: Points
    deviation: float


class CubicSpline(NamedTuple):
    """
    A closed cubic B-spline over the shaft angle that touches the curve in its nodes.

    Shaft angles of the nodes [rad], control points on the disc [m], knots [rad], and the largest
    distance of the spline from the curve [m].
    """

    angles: Array
    control_points: Points
    knots: Array
    deviation: float


def outline(disc: CamDisc, tolerance: float, beside: float = 0.0) -> Outline:
    """
    Give the contour as a polyline.

    Parameters
    ----------
    disc : CamDisc
        The disc.
    tolerance : float
        Largest distance of the contour from the polyline [m].
    beside : float
        How far outwards of the contour to go: 0 for itself, the roller's radius for the path of
        its centre, the double for the other flank of a groove, the radius of a cutter for the
        path of that [m].

    Returns
    -------
    Outline
        The polyline, with hardly more points than needed.

    Raises
    ------
    ConfigurationError
        When the curve has a cusp, or the tolerance is too small.

    Notes
    -----
    A chord of length ds is ds² curvature / 8 off, so the points are spread evenly over the
    integral of sqrt(curvature / 8) ds; the distance is then measured.

    """
    _check(disc, tolerance, beside)
    angles: list[Array] = [np.zeros(1)]
    points: list[Points] = []
    worst = 0.0
    for element in split_turn(disc.profile):
        curve = _Curve(disc, element, beside)
        fine = np.linspace(element.start, element.end, _FINE)
        density = curve.density(fine)
        steps = 0.5 * (density[1:] + density[:-1]) * np.diff(fine)
        passed = np.concatenate([[0.0], np.cumsum(steps)])
        count = _segments(element, passed[-1] / math.sqrt(tolerance))
        while True:
            q = np.interp(np.linspace(0.0, passed[-1], count + 1), passed, fine)
            found = curve.points(q)
            deviation = _largest(_from_chords(curve, q, found))
            if deviation <= tolerance:
                break
            count = _more(count, tolerance)
        worst = max(worst, deviation)
        angles.append(q[1:])
        points += [found[:1]] * (not points) + [found[1:]]
    closed = np.concatenate(points)
    closed[-1] = closed[0]
    return Outline(np.concatenate(angles), closed, worst)


def spline(disc: CamDisc, tolerance: float, beside: float = 0.0) -> CubicSpline:
    """
    Give the contour as a cubic B-spline.

    Parameters
    ----------
    disc : CamDisc
        The disc.
    tolerance : float
        Largest distance of the spline from the contour [m].
    beside : float
        How far outwards of the contour to go [m].

    Returns
    -------
    CubicSpline
        The spline: where the acceleration of the cam steps its knots are triple, elsewhere
        double, as it has the points and the tangents of the contour in its nodes (cubic Hermite
        interpolation).

    Raises
    ------
    ConfigurationError
        When the curve has a cusp, or the tolerance is too small.

    """
    _check(disc, tolerance, beside)
    nodes: list[Array] = [np.zeros(1)]
    controls: list[Points] = []
    knots: list[Array] = [np.zeros(4)]
    worst = 0.0
    for element in split_turn(disc.profile):
        curve = _Curve(disc, element, beside)
        count = _segments(element, 1.0)
        while True:
            q = np.linspace(element.start, element.end, count + 1)
            deviation = _largest(_from_cubics(curve, q))
            if deviation <= tolerance:
                break
            count = _more(count, tolerance)
        worst = max(worst, deviation)
        found, inner = curve.points(q), _handles(curve, q)
        controls += [found[:1]] * (not controls) + [inner.T.reshape(-1), found[-1:]]
        nodes.append(q[1:])
        knots += [np.repeat(q[1:-1], 2), np.repeat(q[-1:], 3)]
    knots.append(knots[-1][-1:])
    closed = np.concatenate(controls)
    closed[-1] = closed[0]
    return CubicSpline(np.concatenate(nodes), closed, np.concatenate(knots), worst)


class _Curve:
    """The contour, or a curve beside it, over one stretch; its ends from inside."""

    def __init__(self, disc: CamDisc, element: Element, beside: float) -> None:
        """Keep what it is."""
        self.disc, self.element, self.beside = disc, element, beside

    def _curvature(self, q: Array) -> tuple[Array, Array]:
        """Give the curvature, and the length by that of the contour."""
        found = self.disc.contact_at(follower_in(self.disc.profile, self.element, q))
        contour = found.bend / (found.span - self.disc.follower.roller_radius * found.bend)
        stretch = 1.0 + self.beside * contour
        return contour / stretch, stretch

    def points(self, q: Array) -> Points:
        found = self.disc.contact_at(follower_in(self.disc.profile, self.element, q))
        return self.disc.on_disc(found.point + self.beside * found.normal, q)

    def tangents(self, q: Array) -> Points:
        found = self.disc.contact_at(follower_in(self.disc.profile, self.element, q))
        return self.disc.on_disc(found.tangent * self._curvature(q)[1], q)

    def density(self, q: Array) -> Array:
        curvature = np.maximum(np.abs(self._curvature(q)[0]), _FLATTEST / self.disc.base_radius)
        return np.asarray(np.abs(self.tangents(q)) * np.sqrt(curvature / 8.0), dtype=np.float64)


def _check(disc: CamDisc, tolerance: float, beside: float) -> None:
    """Refuse a curve that has a cusp or a loop."""
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        raise ConfigurationError([Problem(
            'tolerance', tolerance, 'must be a finite number above 0')])
    least = disc.least_contour_radius
    if least.value <= 0.0:
        raise ConfigurationError([Problem(
            'base_radius', disc.base_radius, 'the contour is undercut at '
            f'{least.at / DEGREE:.6g} deg: it cannot be made', 'a larger base_radius')])
    if beside == 0.0:
        return
    roller = disc.follower.roller_radius
    wide, at = extremes(disc.profile, lambda at: _stretched(disc, at, beside - roller))[0]
    if wide <= 0.0:
        raise ConfigurationError([Problem(
            'roller_radius', roller, f'the curve {beside:g} m beside the contour has a cusp at '
            f'{at / DEGREE:.6g} deg: a hollow there is tighter', 'a smaller radius')])


def _stretched(disc: CamDisc, at: object, beside: float) -> Array:
    found = disc.contact_at(at)  # type: ignore[arg-type]
    return found.span + beside * found.bend


def _segments(element: Element, wanted: float) -> int:
    return max(1, math.ceil((element.end - element.start) / _LONGEST), math.ceil(wanted))


def _more(count: int, tolerance: float) -> int:
    if count > _MOST_POINTS:
        raise ConfigurationError([Problem(
            'tolerance', tolerance, f'needs more than {_MOST_POINTS} points',
            'a larger tolerance')])
    return math.ceil(count * _GROWTH)


def _from_chords(curve: _Curve, q: Array, points: Points) -> Array:
    """Measure the distances of the curve from the chords, shape (inner, segments)."""
    inner = curve.points(_between(q))
    chord = np.diff(points)
    return np.asarray(np.abs((np.conj(chord) * (inner - points[:-1])).imag) / np.abs(chord),
                      dtype=np.float64)


def _from_cubics(curve: _Curve, q: Array) -> Array:
    """Measure the distances of Hermite's cubics from the curve, shape (inner, segments)."""
    points, between = curve.points(q), _between(q)
    x = _INNER[:, None]
    first, second = _handles(curve, q)
    cubic = ((1.0 - x) ** 3 * points[:-1] + 3.0 * x * (1.0 - x) ** 2 * first
             + 3.0 * x ** 2 * (1.0 - x) * second + x ** 3 * points[1:])
    # the nearest point of the curve is a little further on
    tangent = curve.tangents(between)
    along = (np.conj(tangent) * (cubic - curve.points(between))).real / np.abs(tangent) ** 2
    nearest = np.clip(between + along, q[0], q[-1])
    return np.asarray(np.abs(cubic - curve.points(nearest)), dtype=np.float64)


def _handles(curve: _Curve, q: Array) -> Points:
    """Give the two inner control points of the cubics between nodes, shape (2, segments)."""
    points, third = curve.points(q), curve.tangents(q)
    step = np.diff(q) / 3.0
    handles: Points = np.array([points[:-1] + third[:-1] * step, points[1:] - third[1:] * step])
    return handles


def _between(q: Array) -> Array:
    return q[:-1] + _INNER[:, None] * np.diff(q)


def _largest(distances: Array) -> float:
    """Find the largest distance, between the places looked at by parabolas."""
    k, segment = np.unravel_index(int(np.argmax(distances)), distances.shape)
    here = float(distances[k, segment])
    if not 0 < k < distances.shape[0] - 1:
        return here
    before, after = float(distances[k - 1, segment]), float(distances[k + 1, segment])
    bend = before - 2.0 * here + after
    return here if bend >= 0.0 else here - (after - before) ** 2 / (8.0 * bend)
