# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""One piece of an exact curve: a polynomial plus a few sinusoids in the local coordinate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev, polynomial
from numpy.typing import NDArray

Array = NDArray[np.float64]

# A polynomial of this degree represents half a wave to rounding (its 25th Chebyshev coefficient
# is below 1e-20), so zeros of mixed pieces are found on stretches of at most half a wave.
_CHEBYSHEV_DEGREE = 24
_CHEBYSHEV_POINTS = chebyshev.chebpts1(_CHEBYSHEV_DEGREE + 1)
# From values at the points to coefficients: the discrete orthogonality of the polynomials.
_CHEBYSHEV_TRANSFORM = chebyshev.chebvander(_CHEBYSHEV_POINTS, _CHEBYSHEV_DEGREE).T * (
    2.0 / (_CHEBYSHEV_DEGREE + 1))
_CHEBYSHEV_TRANSFORM[0] *= 0.5
# Zeros of the interpolant that are complex only by rounding are kept: a point too many is
# harmless, because the zeros serve as candidates at which a curve is then evaluated.
_IMAGINARY_SLACK = 1e-4
_NEWTON_STEPS = 3
_SMALL = 1e-12  # share of the largest coefficient below which a leading one spoils the roots
_NEAR = 5e-3  # how far (as a share of the piece) a root may be off before it is polished
_VANISHES = 1e-12  # values below this share of the largest in their stretch are zero
# Gauss-Legendre rule: exact for the square of any polynomial up to degree 31, and to rounding
# for the square of a sinusoid over at most half a wave.
_GAUSS_NODES, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(32)


class Wave(NamedTuple):
    """A sinusoid ``cosine * cos(omega u) + sine * sin(omega u)`` in the local coordinate u."""

    omega: float
    cosine: float
    sine: float


@dataclass(frozen=True)
class Piece:
    """
    A stretch of a curve, f(u) = sum(c_k u^k) + sum(waves), for 0 <= u <= length.

    Attributes
    ----------
    length : float
        Length of the stretch, in the unit of the abscissa; positive.
    coefficients : tuple[float, ...]
        Polynomial coefficients c_k, lowest power first.
    waves : tuple[Wave, ...]
        Sinusoids added to the polynomial.

    """

    length: float
    coefficients: tuple[float, ...] = ()
    waves: tuple[Wave, ...] = ()

    def __call__(self, u: Array) -> Array:
        """
        Evaluate at local coordinates.

        Parameters
        ----------
        u : ndarray, any shape
            Local coordinates, in the unit of the abscissa.

        Returns
        -------
        ndarray, shape of u
            Values.

        """
        coefficients = self.coefficients or (0.0,)
        value = np.full_like(u, coefficients[-1])
        for coefficient in reversed(coefficients[:-1]):
            value *= u
            value += coefficient
        for wave in self.waves:
            angle = wave.omega * u
            if wave.cosine:
                value += wave.cosine * np.cos(angle)
            if wave.sine:
                value += wave.sine * np.sin(angle)
        return value

    def at(self, u: float) -> float:
        """
        Evaluate at one local coordinate.

        Parameters
        ----------
        u : float
            Local coordinate, in the unit of the abscissa.

        Returns
        -------
        float
            The value.

        """
        value = 0.0
        for coefficient in reversed(self.coefficients):
            value = value * u + coefficient
        for omega, cosine, sine in self.waves:
            value += cosine * math.cos(omega * u) + sine * math.sin(omega * u)
        return value

    @cached_property
    def derivative(self) -> Piece:
        """Differentiate with respect to the local coordinate, again exact."""
        return Piece(
            self.length,
            tuple(k * c for k, c in enumerate(self.coefficients))[1:],
            tuple(Wave(w, w * sine, -w * cosine) for w, cosine, sine in self.waves),
        )

    def integral(self, start: float = 0.0) -> Piece:
        """
        Integrate over the local coordinate.

        Parameters
        ----------
        start : float
            Value of the integral at u = 0.

        Returns
        -------
        Piece
            The antiderivative, exact, with the wanted value at u = 0.

        """
        waves = tuple(Wave(w, -sine / w, cosine / w) for w, cosine, sine in self.waves)
        constant = start - sum(wave.cosine for wave in waves)
        rising = tuple(c / (k + 1) for k, c in enumerate(self.coefficients))
        return Piece(self.length, (constant, *rising), waves)

    def scaled(self, stretch: float, lift: float, offset: float = 0.0) -> Piece:
        """
        Stretch along the abscissa, then multiply and shift the values.

        Parameters
        ----------
        stretch : float
            New length over old length; positive.
        lift : float
            Factor on the values.
        offset : float
            Added to the scaled values.

        Returns
        -------
        Piece
            offset + lift * f(u / stretch), over the stretched length.

        """
        coefficients = [lift * c / stretch**k for k, c in enumerate(self.coefficients or (0.0,))]
        coefficients[0] += offset
        return Piece(
            self.length * stretch,
            tuple(coefficients),
            tuple(Wave(w / stretch, lift * c, lift * s) for w, c, s in self.waves),
        )

    @cached_property
    def is_zero(self) -> bool:
        """Whether the piece is zero everywhere."""
        return not any(self.coefficients) and not any(w.cosine or w.sine for w in self.waves)

    def stretches(self) -> Array:
        """
        Split the piece so that no stretch is longer than half a wave.

        Returns
        -------
        ndarray, shape (n + 1,)
            Ends of the n stretches, local coordinates.

        """
        fastest = max((wave.omega for wave in self.waves), default=0.0)
        count = max(1, math.ceil(fastest * self.length / math.pi))
        return np.linspace(0.0, self.length, count + 1)

    def zeros(self) -> list[float]:
        """
        Find where the piece is zero.

        Returns
        -------
        list[float]
            Local coordinates inside the piece. All zeros are among them; near a multiple zero
            a few further points can be. Empty where the piece is zero everywhere.

        """
        if self.is_zero:
            return []
        if self.waves:
            return find_zeros(self, self.derivative, self.stretches())
        # in u / length, where the coefficients say how much each power matters
        scaled = [c * self.length**k for k, c in enumerate(self.coefficients)]
        if abs(scaled[0]) > sum(map(abs, scaled[1:])):
            return []  # as in most pieces of a table: it cannot come down to zero
        series = np.array(scaled)
        sizes = np.abs(series)
        # very small leading coefficients spoil the roots: these are found without them, and
        # polished with them
        last = int(np.flatnonzero(sizes > _SMALL * sizes.max())[-1])
        roots = polynomial.polyroots(series[:last + 1])
        near = roots.real[(np.abs(roots.imag) < _IMAGINARY_SLACK)
                          & (np.abs(roots.real - 0.5) < 0.5 + 2.0 * _NEAR)]
        slope = polynomial.polyder(series)
        for _ in range(_NEWTON_STEPS if near.size else 0):
            rise = polynomial.polyval(near, slope)
            step = np.divide(polynomial.polyval(near, series), rise, out=np.zeros_like(near),
                             where=rise != 0.0)
            near = near - np.where(np.abs(step) < _NEAR, step, 0.0)
        return [self.length * float(x) for x in near if 0.0 < x < 1.0]

    def mean_square(self) -> float:
        """
        Average the square of the piece over its length.

        Returns
        -------
        float
            (1 / length) * integral of f(u)² du, exact to rounding.

        """
        ends = self.stretches()
        half = 0.5 * np.diff(ends)
        points = ends[:-1, None] + half[:, None] * (1.0 + _GAUSS_NODES)
        return float(np.sum(half[:, None] * _GAUSS_WEIGHTS * self(points) ** 2) / self.length)


def find_zeros(
    function: Callable[[Array], Array], slope: Callable[[Array], Array], stretches: Array
) -> list[float]:
    """
    Find the zeros of a smooth function by Chebyshev interpolation and Newton polishing.

    Parameters
    ----------
    function, slope : Callable[[ndarray], ndarray]
        The function and its derivative, vectorised.
    stretches : ndarray, shape (n + 1,)
        Ends of the n intervals to search; on each one the function is smooth and holds at most
        about half a wave.

    Returns
    -------
    list[float]
        Candidates for zeros; all zeros are among them.

    References
    ----------
    L. N. Trefethen, Approximation Theory and Approximation Practice (2013), chapter 18.

    """
    found: list[float] = []
    for low, high in zip(stretches[:-1], stretches[1:]):
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        nodes = middle + half * _CHEBYSHEV_POINTS
        series = _CHEBYSHEV_TRANSFORM @ function(nodes)
        largest = float(np.max(np.abs(series)))
        if largest == 0.0:
            continue
        roots = chebyshev.chebroots(chebyshev.chebtrim(series, 1e-15 * largest))
        roots = roots.real[np.abs(roots.imag) < _IMAGINARY_SLACK]
        points = middle + half * roots[np.abs(roots) < 1.0 + _IMAGINARY_SLACK]
        for _ in range(_NEWTON_STEPS):
            rise = slope(points)
            step = np.divide(function(points), rise, out=np.zeros_like(points), where=rise != 0.0)
            # near a multiple zero Newton's step can be wild; there the interpolant's root stands
            step = np.where(np.abs(step) < 1e-3 * half, step, 0.0)
            points = np.clip(points - step, low, high)
        found += [float(point) for point in points]
        # a zero of high multiplicity on an end spreads over both sides and out of both stretches
        if abs(function(np.array([high]))[0]) <= _VANISHES * largest:
            found.append(float(high))
    return found
