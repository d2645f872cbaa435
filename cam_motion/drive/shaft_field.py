# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
The equation of motion of a cam drive, written out for one angle and one speed at a time.

A part of a load computes its terms with numpy, 30 us for a single angle. Here J, C, Q0 and Q1 of
each element of the shaft angle become polynomials, interpolated at Chebyshev points and checked
against the parts to rounding, and the acceleration a Python function with the numbers in place,
as `motion.compiled` does for a cam. Only floats of our own enter the source.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from cam_motion.drive.cam_drive import CamDrive, Element
from cam_motion.drive.load import Friction
from cam_motion.motion.piece import Array
import numpy as np
from numpy.polynomial import chebyshev, polynomial

TOLERANCE = 1e-13
"""Largest error of a polynomial, as a share of the term's largest value in a revolution."""

_NODES = 14  # of the interpolation; an element that needs more is halved
_CHECKS = 41
_SHORTEST = 1e-4  # an element is not halved below this span [rad]: what is left is rounding
_NEGLIGIBLE = 1e-17  # coefficients below this share of the largest value are left out

Torque = Callable[[float], float]
"""Torque of the motor at the cam shaft [N m] over the speed of the cam shaft [rad/s]."""

Acceleration = Callable[[float, float, float, Torque], float]
"""Acceleration [rad/s²] at an angle [rad], speed [rad/s], sense of turning (1 or -1), torque."""


class FieldElement(NamedTuple):
    """
    A stretch of the shaft angle [rad], within which the equation of motion is smooth.

    ``force`` gives what weights, springs and moments do at an angle, without friction [N m].
    """

    start: float
    end: float
    acceleration: Acceleration
    force: Callable[[float], float]


def compile_field(drive: CamDrive) -> tuple[FieldElement, ...]:
    """
    Write out the equation of motion of a drive.

    Parameters
    ----------
    drive : CamDrive
        The drive.

    Returns
    -------
    tuple[FieldElement, ...]
        Elements from 0 to one turn. Their functions go on smoothly beyond both ends, so that an
        integrator may step over one and come back to it.

    Notes
    -----
    Coulomb friction acts against the motion: its part of Q0, which the load gives for a shaft
    that turns forwards, changes its sign with the sense of turning. All other parts keep theirs:
    weights, springs and the moment against a lever act in one direction whichever way the shaft
    turns. Friction has a kink where the follower turns back; elements are split there.

    """
    rubs = any(isinstance(part, Friction) and part.coulomb for part in drive.parts)
    elements = drive.split_at(_turning_points(drive)) if rubs else drive.elements
    ends = np.linspace(0.0, 1.0, _CHECKS)
    scales = np.max(np.abs([
        _terms(drive, e, e.start + (e.end - e.start) * ends) for e in elements]), axis=(0, 2))
    return tuple(
        _compiled(found, fits) for element in elements
        for found, fits in _fitted(drive, element, scales))


def _turning_points(drive: CamDrive) -> list[float]:
    """Find the angles at which the follower turns back within an element."""
    from scipy.optimize import brentq
    found = []
    for element in drive.elements:
        def slope(q: float, element: Element = element) -> float:
            return float(drive.follower(element, np.array([q])).s1[0])
        q = np.linspace(element.start, element.end, _CHECKS)[1:-1]
        signs = np.sign(drive.follower(element, q).s1)
        found += [brentq(slope, q[k], q[k + 1], xtol=1e-14)
                  for k in np.flatnonzero(signs[:-1] * signs[1:] < 0.0)]
        found += [float(x) for x in q[signs == 0.0]] if np.any(signs) else []
    return found


def _terms(drive: CamDrive, element: Element, q: Array) -> Array:
    """Give J, C, Q0 without friction, Coulomb friction, and Q1 in the rows."""
    at = drive.follower(element, q)
    inertia, centripetal, force, damping = drive.terms(at)
    coulomb = sum((Friction(coulomb=part.coulomb).terms(at).force for part in drive.parts
                   if isinstance(part, Friction)), np.zeros_like(q))
    return np.array([inertia, centripetal, force - coulomb, coulomb, damping])


def _fitted(drive: CamDrive, element: Element, scales: Array,
            ) -> Iterator[tuple[Element, list[list[float]]]]:
    """Fit the terms of an element, or of its halves."""
    start, end, piece = element
    middle, half = 0.5 * (start + end), 0.5 * (end - start)
    nodes = chebyshev.chebpts1(_NODES)
    fits = np.linalg.solve(
        chebyshev.chebvander(nodes, _NODES - 1), _terms(drive, element, middle + half * nodes).T)
    checks = np.linspace(-1.0, 1.0, _CHECKS)[1:-1]
    errors = np.max(np.abs(
        chebyshev.chebval(checks, fits) - _terms(drive, element, middle + half * checks)), axis=1)
    if np.all(errors <= TOLERANCE * scales) or half < _SHORTEST:
        yield element, [
            _trimmed(chebyshev.cheb2poly(fit), scale) for fit, scale in zip(fits.T, scales)]
        return
    for part in (Element(start, middle, piece), Element(middle, end, piece)):
        yield from _fitted(drive, part, scales)


def _trimmed(fit: Array, scale: float) -> list[float]:
    return [float(c) for c in polynomial.polytrim(fit, _NEGLIGIBLE * scale)]


def _compiled(element: Element, fits: Sequence[Sequence[float]]) -> FieldElement:
    middle, half = 0.5 * (element.start + element.end), 0.5 * (element.end - element.start)
    inertia, centripetal, force, coulomb, damping = map(_horner, fits)
    local = f'    u = (x - {middle!r}) * {1.0 / half!r}'
    lines = [
        'def force(x):', local, f'    return {force}',
        'def acceleration(x, w, sense, torque):', local,
        f'    q = torque(w) + ({force})',
        f'    q += sense * ({coulomb})' if coulomb != '0.0' else '',
        f'    q += w * ({damping})' if damping != '0.0' else '',
        f'    return (q - w * w * ({centripetal})) / ({inertia})',
    ]
    made: dict[str, Callable[..., float]] = {}
    exec('\n'.join(lines), {}, made)  # noqa: S102 (our own numbers only, see the head)
    return FieldElement(element.start, element.end, made['acceleration'], made['force'])


def _horner(coefficients: Sequence[float]) -> str:
    text = repr(coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        text = f'{coefficient!r} + u * ({text})'
    return '0.0' if not any(coefficients) else text
