# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Splines through points, or within a stated deviation of them, as exact curves."""

from __future__ import annotations

from typing import NamedTuple

from cam_motion.errors import DomainError
from cam_motion.motion.piece import Array, Piece
from cam_motion.motion.piecewise import Piecewise
import numpy as np
from numpy.typing import ArrayLike

NATURAL = 'natural'
"""Ends at which the spline is free: it bends no more than its points ask for."""

PERIODIC = 'periodic'
"""Ends that close: the spline begins as it ends, or goes on by the same advance each time."""

DEGREES = (3, 5)
"""Degree of the splines: cubic, its acceleration continuous (C2), and quintic (C4)."""

_NEIGHBOURS = 5  # points from which the derivatives at an end are estimated
# FITPACK's bound on the sum of squares is tried from the loosest that can hold down to this share
_SMOOTHING = np.geomspace(1.0, 1e-4, 40)


class EndState(NamedTuple):
    """First and second derivative at an end of a spline."""

    velocity: float = 0.0
    acceleration: float = 0.0


Ends = str | tuple[EndState, EndState]
"""`NATURAL`, `PERIODIC`, or what is told at the start and at the end."""


class Smoothed(NamedTuple):
    """
    A smoothing spline.

    ``x`` and ``y``, shape (k,), are the points through which `interpolate` with ``ends`` gives
    the same curve; ``deviation`` is the largest distance between it and the points it was made
    of, in their unit.
    """

    x: Array
    y: Array
    ends: Ends
    curve: Piecewise
    deviation: float


def interpolate(x: ArrayLike, y: ArrayLike, degree: int = 5, ends: Ends = NATURAL) -> Piecewise:
    """
    Lay a spline of odd degree through points.

    Parameters
    ----------
    x : array_like, shape (n,)
        Rising abscissae, at any distances; n is at least 2.
    y : array_like, shape (n,)
        Values.
    degree : int
        3 or 5.
    ends : str or tuple[EndState, EndState]
        `NATURAL`; `PERIODIC`, where y[-1] - y[0] is what the curve advances by in each period;
        or velocity (and, of degree 5, acceleration) at both ends, each per unit of x.

    Returns
    -------
    Piecewise
        The spline, a piece between each two points, exactly through the points.

    Raises
    ------
    DomainError
        When the points are too few, or do not rise.

    References
    ----------
    C. de Boor, A Practical Guide to Splines (1978), chapter XIII; solved by
    scipy.interpolate.make_interp_spline.

    """
    x, y = _points(x, y)
    kind: str | tuple[list[tuple[int, float]], list[tuple[int, float]]]
    # what differs from a straight line, so that a table far from zero loses nothing to rounding
    slope = (y[-1] - y[0]) / (x[-1] - x[0])
    rest = y - y[0] - slope * (x - x[0])
    if isinstance(ends, str):
        if len(x) == 2:
            return hermite(x, y, [slope, slope], [0.0, 0.0])
        rest[-1] = 0.0
        free = [(order, 0.0) for order in range((degree + 1) // 2, degree)]
        kind = PERIODIC if ends == PERIODIC else (free, free)
    else:
        first, last = ([(1, each.velocity - slope), (2, each.acceleration)][:degree // 2]
                       for each in ends)
        kind = (first, last)
    from scipy.interpolate import make_interp_spline
    spline = make_interp_spline(x, rest, k=degree, bc_type=kind)
    velocities, accelerations = slope + spline(x, 1), spline(x, 2)
    if ends == PERIODIC:
        velocities[-1], accelerations[-1] = velocities[0], accelerations[0]
    elif not isinstance(ends, str):
        for place, end in zip((0, -1), ends):
            velocities[place] = end.velocity
            accelerations[place] = end.acceleration if degree > 3 else accelerations[place]
    # a cubic has no room for accelerations of its own: they follow, alike from both sides
    return hermite(x, y, velocities, accelerations if degree > 3 else None)


def hermite(x: ArrayLike, y: ArrayLike, velocities: ArrayLike,
            accelerations: ArrayLike | None = None) -> Piecewise:
    """
    Join points at which the velocity is known, and the acceleration or not.

    Parameters
    ----------
    x, y : array_like, shape (n,)
        Rising abscissae and the values there.
    velocities : array_like, shape (n,)
        First derivative at the points.
    accelerations : array_like, shape (n,) or None
        Second derivative at the points; None gives cubic pieces, whose acceleration may step.

    Returns
    -------
    Piecewise
        Polynomials of degree 5 (or 3) between the points.

    Raises
    ------
    DomainError
        When the points are too few, or do not rise.

    """
    x, y = _points(x, y)
    v = np.asarray(velocities, dtype=float)
    h = np.diff(x)
    # over a span of 1, by what a straight line from the start would miss
    v0, gain = v[:-1] * h, (v[1:] - v[:-1]) * h
    rise = np.diff(y) - v0
    if accelerations is None:
        scaled = [y[:-1], v0, 3.0 * rise - gain, gain - 2.0 * rise]
    else:
        a = np.asarray(accelerations, dtype=float)
        a0, a1 = a[:-1] * h * h, a[1:] * h * h
        scaled = [y[:-1], v0, 0.5 * a0,
                  10.0 * rise - 4.0 * gain - 1.5 * a0 + 0.5 * a1,
                  -15.0 * rise + 7.0 * gain + 1.5 * a0 - a1,
                  6.0 * rise - 3.0 * gain - 0.5 * a0 + 0.5 * a1]
    rows = np.array([c / h**k for k, c in enumerate(scaled)]).T
    return Piecewise(float(x[0]), [Piece(length, tuple(row)) for length, row in zip(
        h.tolist(), rows.tolist())], x.tolist())


def linear(x: ArrayLike, y: ArrayLike) -> Piecewise:
    """
    Join points by straight lines.

    Parameters
    ----------
    x, y : array_like, shape (n,)
        Rising abscissae and the values there.

    Returns
    -------
    Piecewise
        The polygon; its velocity steps at every point.

    Raises
    ------
    DomainError
        When the points are too few, or do not rise.

    """
    x, y = _points(x, y)
    h = np.diff(x)
    rows = zip(h.tolist(), y.tolist(), (np.diff(y) / h).tolist())
    return Piecewise(float(x[0]), [Piece(length, (low, slope)) for length, low, slope in rows],
                     x.tolist())


def estimate(x: ArrayLike, y: ArrayLike, at: float) -> EndState:
    """
    Estimate velocity and acceleration from the nearest points.

    Parameters
    ----------
    x, y : array_like, shape (n,)
        Rising abscissae and the values there.
    at : float
        Where.

    Returns
    -------
    EndState
        Derivatives of the polynomial through the five nearest points (or all, of fewer).

    """
    from scipy.interpolate import KroghInterpolator
    x, y = _points(x, y)
    nearest = np.sort(np.argsort(np.abs(x - at), kind='stable')[:_NEIGHBOURS])
    unit = float(np.mean(np.diff(x[nearest])))
    polynomial = KroghInterpolator((x[nearest] - at) / unit, y[nearest])
    slopes = np.atleast_1d(polynomial.derivatives(0.0, der=3))
    return EndState(float(slopes[1]) / unit, float(slopes[2]) / unit**2)


def smooth(x: ArrayLike, y: ArrayLike, tolerance: float, degree: int = 5,
           periodic: bool = False) -> Smoothed:
    """
    Find the smoothest spline that stays within a deviation of the points.

    Parameters
    ----------
    x, y : array_like, shape (n,)
        Rising abscissae and the values there.
    tolerance : float
        Largest distance allowed between the spline and any of the points, above 0.
    degree : int
        3 or 5.
    periodic : bool
        Whether it goes on after the end as at the start, y[-1] - y[0] further.

    Returns
    -------
    Smoothed
        The spline; where nothing smoother holds the tolerance, the one through all points.

    Raises
    ------
    DomainError
        When the points are too few, or do not rise.

    Notes
    -----
    FITPACK's smoothing spline has the fewest knots with which the sum of squares stays below a
    bound, and among these the least steps of its highest derivative. That bound is lowered
    until the largest deviation holds. A spline with simple knots is the interpolating spline
    through its values at the knots, so these few points carry it.

    References
    ----------
    P. Dierckx, Curve and Surface Fitting with Splines (1993), chapters 5 and 6;
    scipy.interpolate.splrep.

    """
    from scipy.interpolate import BSpline, splrep
    x, y = _points(x, y)
    slope = (y[-1] - y[0]) / (x[-1] - x[0])
    rest = y - y[0] - slope * (x - x[0])
    if periodic:
        rest[-1] = rest[0]
    for share in _SMOOTHING if len(x) > degree + 1 else ():
        (knots, coefficients, _), _, _, _ = splrep(
            x, rest, k=degree, s=share * len(x) * tolerance**2, per=periodic, full_output=True,
            quiet=True)
        spline = BSpline(knots, coefficients, degree)
        if np.max(np.abs(spline(x) - rest)) > tolerance:
            continue
        places = knots[degree:-degree]
        values = y[0] + slope * (places - x[0]) + spline(places)
        ends: Ends = PERIODIC
        if periodic:
            values[-1] = values[0] + (y[-1] - y[0])
        else:
            first, last = ([float(spline(at, order)) for order in (1, 2)]
                           for at in (x[0], x[-1]))
            ends = (EndState(slope + first[0], first[1]), EndState(slope + last[0], last[1]))
        curve = interpolate(places, values, degree, ends)
        deviation = float(np.max(np.abs(curve.evaluate(x) - y)))
        if deviation <= tolerance:
            return Smoothed(places, values, ends, curve, deviation)
    ends = PERIODIC if periodic else NATURAL
    return Smoothed(x, y, ends, interpolate(x, y, degree, ends), 0.0)


def _points(x: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
    x, y = np.array(x, dtype=float), np.array(y, dtype=float)
    if x.ndim != 1 or x.shape != y.shape or len(x) < 2:
        raise DomainError('a spline needs at least two points, each with its value')
    if not (np.isfinite(x).all() and np.isfinite(y).all() and (np.diff(x) > 0.0).all()):
        raise DomainError('the abscissae of a spline must rise, and all be finite')
    return x, y
