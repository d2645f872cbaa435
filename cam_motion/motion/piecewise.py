# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The exact curve: pieces joined end to end, evaluated, differentiated and searched exactly."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import accumulate
import math
from typing import Any, NamedTuple

from cam_motion.errors import DomainError
from cam_motion.motion.compiled import compile_sampler, Sampler
from cam_motion.motion.piece import Array, find_zeros, Piece
import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import ArrayLike, NDArray

JOINT_TOLERANCE = 1e-9
"""Steps at joints below this share of the curve's own peak are rounding, not steps."""

_TIE = 1e-12  # peaks this close (relative) count as equal; the first one is reported
_EDGE = 1e-12  # how far (relative) an argument may lie outside the curve by rounding
_SHORT = 6  # coefficients of a polynomial whose products keep their roots exact enough
_BLOCK = 16384  # points evaluated at a time: small enough to stay in a core's cache


class Peak(NamedTuple):
    """An extreme value and where it occurs."""

    value: float
    at: float


class Jump(NamedTuple):
    """A step of a derivative at a joint: where, which order, by how much."""

    at: float
    order: int
    amount: float


class Piecewise:
    """
    A curve made of exact pieces.

    Parameters
    ----------
    start : float
        Abscissa of the first piece's beginning.
    pieces : Iterable[Piece]
        The pieces in order, at least one; their lengths place the joints.
    breaks : Sequence[float], optional
        The joints, both ends included, where the sum of the lengths would round differently.

    """

    def __init__(
        self, start: float, pieces: Iterable[Piece], breaks: Sequence[float] | None = None
    ) -> None:
        """Place the pieces one behind the other."""
        self.pieces = tuple(pieces)
        if not self.pieces:
            raise DomainError('a curve needs at least one piece')
        lengths = (piece.length for piece in self.pieces)
        self.breaks = tuple(accumulate(lengths, initial=start) if breaks is None else breaks)

    @property
    def start(self) -> float:
        """Abscissa at which the curve begins."""
        return self.breaks[0]

    @property
    def end(self) -> float:
        """Abscissa at which the curve ends."""
        return self.breaks[-1]

    def __getstate__(self) -> dict[str, Any]:
        """Leave the compiled function out: it is made anew where it is needed."""
        return {key: value for key, value in self.__dict__.items() if key != 'sample'}

    @cached_property
    def sample(self) -> Sampler:
        """Evaluate (y, y', y'', y''') for one float, compiled for speed."""
        return compile_sampler(self.breaks, self.pieces)

    @cached_property
    def derivative(self) -> Piecewise:
        """Differentiate piece by piece; steps at joints leave no trace in the derivative."""
        pieces = [piece.derivative for piece in self.pieces]
        return Piecewise(self.start, pieces, self.breaks)

    def differentiated(self, order: int) -> Piecewise:
        """
        Differentiate several times.

        Parameters
        ----------
        order : int
            How many times; 0 gives the curve itself.

        Returns
        -------
        Piecewise
            The derivative of that order.

        """
        return self if order == 0 else self.derivative.differentiated(order - 1)

    def __call__(self, x: ArrayLike, order: int = 0) -> Array:
        """
        Evaluate the curve or one of its derivatives.

        Parameters
        ----------
        x : array_like, any shape
            Abscissae within the curve's range.
        order : int
            Order of the derivative, 0 or more. At a joint the value from the right is given
            (at the very end, from the left).

        Returns
        -------
        ndarray, shape of x
            Values of that derivative.

        Raises
        ------
        DomainError
            When an abscissa lies outside the curve.

        """
        points = np.asarray(x, dtype=float)
        edge = _EDGE * max(abs(self.start), abs(self.end), self.end - self.start)
        outside = (points < self.start - edge) | (points > self.end + edge)
        if outside.any():
            raise DomainError(
                f'the curve is defined from {self.start:g} to {self.end:g}; asked for '
                f'{points[outside].min():g} to {points[outside].max():g}'
            )
        return self.evaluate(points, order)

    def evaluate(self, points: Array, order: int = 0) -> Array:
        """
        Evaluate without looking at the range; beyond its ends the end pieces go on.

        Parameters
        ----------
        points : ndarray, any shape
            Abscissae.
        order : int
            Order of the derivative.

        Returns
        -------
        ndarray, shape of points
            Values of that derivative.

        """
        pieces = self.differentiated(order).pieces
        flat = np.ascontiguousarray(points).reshape(-1)
        values = np.empty_like(flat)
        for piece, begin, chosen in self._runs(flat):
            if isinstance(chosen, slice):
                for low in range(chosen.start, chosen.stop, _BLOCK):
                    block = slice(low, min(low + _BLOCK, chosen.stop))
                    values[block] = pieces[piece](flat[block] - begin)
            else:
                values[chosen] = pieces[piece](flat[chosen] - begin)
        # a constant piece would give its constant for what is no number at all
        values[np.isnan(flat)] = np.nan
        return values.reshape(points.shape)

    def _runs(self, flat: Array) -> Iterator[tuple[int, float, slice | NDArray[np.intp]]]:
        """Give (piece, its start, which points lie in it); slices where the points are sorted."""
        inner = np.array(self.breaks[1:-1])
        descents = np.flatnonzero(~(flat[1:] >= flat[:-1])) + 1
        if descents.size <= flat.size // 256:
            for low, high in zip([0, *descents], [*descents, flat.size]):
                cuts = low + np.searchsorted(flat[low:high], inner, side='left')
                for piece, (first, last) in enumerate(zip([low, *cuts], [*cuts, high])):
                    if first < last:
                        yield piece, self.breaks[piece], slice(int(first), int(last))
            return
        piece_of = np.searchsorted(inner, flat, side='right').astype(np.uint16)
        by_piece = np.argsort(piece_of, kind='stable')
        cuts = np.searchsorted(piece_of[by_piece], np.arange(len(self.pieces) + 1))
        for piece, (first, last) in enumerate(zip(cuts[:-1], cuts[1:])):
            if first < last:
                yield piece, self.breaks[piece], by_piece[first:last]

    def scaled(self, start: float, end: float, lift: float, offset: float = 0.0) -> Piecewise:
        """
        Fit the curve into another span and lift.

        Parameters
        ----------
        start, end : float
            New abscissae of both ends, rising.
        lift : float
            Factor on the values.
        offset : float
            Added to the scaled values.

        Returns
        -------
        Piecewise
            The scaled curve.

        """
        stretch = (end - start) / (self.end - self.start)
        pieces = [piece.scaled(stretch, lift, offset) for piece in self.pieces]
        breaks = [start + stretch * (x - self.start) for x in self.breaks]
        breaks[-1] = end
        return Piecewise(start, pieces, breaks)

    def candidates(self, order: int) -> Iterator[Peak]:
        """
        List one-sided end values and stationary values of a derivative, from left to right.

        Parameters
        ----------
        order : int
            Order of the derivative.

        Yields
        ------
        Peak
            All local extremes are among them.

        """
        curve = self.differentiated(order)
        for begin, piece in zip(self.breaks, curve.pieces):
            for u in (0.0, *sorted(piece.derivative.zeros()), piece.length):
                yield Peak(piece.at(u), begin + u)

    def extremes(self, order: int) -> tuple[Peak, Peak]:
        """
        Find the least and the greatest value of a derivative.

        Parameters
        ----------
        order : int
            Order of the derivative.

        Returns
        -------
        tuple[Peak, Peak]
            Least and greatest, each with its (first) abscissa. At steps the one-sided values
            count.

        """
        points = list(self.candidates(order))
        slack = _TIE * max(abs(point.value) for point in points)
        least, greatest = min(p.value for p in points), max(p.value for p in points)
        return (
            next(p for p in points if p.value <= least + slack),
            next(p for p in points if p.value >= greatest - slack),
        )

    def peak(self, order: int) -> Peak:
        """
        Find the value of a derivative that is largest in magnitude, with its sign.

        Parameters
        ----------
        order : int
            Order of the derivative.

        Returns
        -------
        Peak
            The signed value and its abscissa; of equal ones, the first.

        """
        points = list(self.candidates(order))
        largest = max(abs(point.value) for point in points)
        return next(p for p in points if abs(p.value) >= largest * (1.0 - _TIE))

    def peak_power(self) -> Peak:
        """
        Find the largest magnitude of the product y' y'' (power of an inertia per unit mass).

        Returns
        -------
        Peak
            The signed product and its abscissa; of equal ones, the first.

        """
        points: list[Peak] = []
        for begin, piece in zip(self.breaks, self.pieces):
            v, a = piece.derivative, piece.derivative.derivative
            points += [Peak(v.at(u) * a.at(u), begin + u)
                       for u in (0.0, *sorted(_stationary_power(piece)), piece.length)]
        largest = max(abs(point.value) for point in points)
        return next(p for p in points if abs(p.value) >= largest * (1.0 - _TIE))

    def rms(self, order: int) -> float:
        """
        Take the root of the mean square of a derivative over the whole curve.

        Parameters
        ----------
        order : int
            Order of the derivative.

        Returns
        -------
        float
            Root mean square, exact to rounding.

        """
        curve = self.differentiated(order)
        total = sum(piece.mean_square() * piece.length for piece in curve.pieces)
        return math.sqrt(total / (self.end - self.start))

    def jumps(self, order: int) -> list[Jump]:
        """
        List the steps of a derivative at the inner joints.

        Parameters
        ----------
        order : int
            Order of the derivative.

        Returns
        -------
        list[Jump]
            Steps larger than `JOINT_TOLERANCE` of that derivative's own peak.

        """
        curve = self.differentiated(order)
        steps = [
            Jump(at, order, right.at(0.0) - left.at(left.length))
            for at, left, right in zip(self.breaks[1:], curve.pieces, curve.pieces[1:])
        ]
        # mostly rounding against any value already, and no peak need be searched for
        some = max(abs(piece.at(0.5 * piece.length)) for piece in curve.pieces)
        steps = [step for step in steps if abs(step.amount) > JOINT_TOLERANCE * some]
        slack = JOINT_TOLERANCE * abs(self.peak(order).value) if steps else 0.0
        return [step for step in steps if abs(step.amount) > slack]

    def end_values(self, order: int) -> tuple[float, float]:
        """
        Give the values of a derivative at both ends.

        Parameters
        ----------
        order : int
            Order of the derivative.

        Returns
        -------
        tuple[float, float]
            Value at the start and at the end.

        """
        pieces = self.differentiated(order).pieces
        return pieces[0].at(0.0), pieces[-1].at(pieces[-1].length)


def _stationary_power(piece: Piece) -> list[float]:
    """Find where y' y'' of a piece is stationary: y''² + y' y''' = 0."""
    v = piece.derivative
    a = v.derivative
    j = a.derivative
    if v.is_zero or a.is_zero:
        return []
    if not piece.waves and len(piece.coefficients) <= _SHORT:
        # as in tables, of which there are many pieces
        found = polynomial.polyadd(polynomial.polymul(a.coefficients, a.coefficients),
                                   polynomial.polymul(v.coefficients, j.coefficients or (0.0,)))
        return Piece(piece.length, tuple(found.tolist())).zeros()
    return find_zeros(
        lambda u: a(u) ** 2 + v(u) * j(u),
        lambda u: 3.0 * a(u) * j(u) + v(u) * j.derivative(u),
        piece.stretches(),
    )
