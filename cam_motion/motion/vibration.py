# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
What a curve leaves vibrating: an oscillator driven by exact pieces, without any time grid.

A load that hangs on its axis by a spring and a damper deviates from where the axis is by
x'' + 2 zeta nu x' + nu² x = -y'', with nu the natural frequency per unit of the abscissa. In
the complex state w, which turns and decays with the pole s = nu (-zeta + i sqrt(1 - zeta²)), this
is w' = s w - y'' and x = Im(w) / Im(s). Over a polynomial or a sinusoid w has a closed form.

After a movement the amplitude is the same where the damper holds the load to the frame instead:
then -y'' - 2 zeta nu y' drives it, which at the pole differs by the factor 1 + 2 zeta nu / s, of
magnitude 1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
import math

from cam_motion.motion.piece import Array, find_zeros, Piece
from cam_motion.motion.piecewise import Peak, Piecewise
import numpy as np
from numpy.typing import ArrayLike, NDArray

Complex = NDArray[np.complex128]

_TERMS = 40  # of the series below: its terms fall by half at least
_LOOKS = np.linspace(0.0, 1.0, 17)  # per half wave: no peak is missed by more than half a percent
_RESONANT = 1e-9  # a cycle that takes so little from a vibration lets it grow beyond all bounds
_NEAR = 0.98  # a half wave whose looks stay below this share of the largest holds no peak


def pole(frequency: ArrayLike, damping: float = 0.0) -> Complex:
    """
    Give the pole of an oscillator.

    Parameters
    ----------
    frequency : array_like, any shape
        Undamped natural frequency [rad per unit of the abscissa]; above 0.
    damping : float
        Damping ratio [-], from 0 to below 1.

    Returns
    -------
    ndarray of complex, shape of frequency
        The one above the real axis.

    """
    nu = np.asarray(frequency, dtype=float)
    return np.asarray(nu * complex(-damping, math.sqrt(1.0 - damping * damping)))


def _phi(k: int, z: Complex) -> Complex:
    """
    Integrate e^(z (1 - t)) t^k over 0 to 1, which is k! phi_(k+1)(z) of exponential integrators.

    By its series where that has no cancellation, else by recursion from below.
    """
    series = np.zeros_like(z)
    term = np.full_like(z, 1.0 / (k + 1))
    for n in range(1, _TERMS + 1):
        series += term
        term = term * z / (k + 1 + n)
    far = np.abs(z) > 0.5 * (k + 2)
    if far.any():
        distant = np.where(far, z, 1.0)
        recursion = np.expm1(distant) / distant
        for n in range(1, k + 1):
            recursion = (n * recursion - 1.0) / distant
        series = np.where(far, recursion, series)
    return series


def forced(piece: Piece, s: Complex, u: ArrayLike) -> Complex:
    """
    Integrate e^(s (u - t)) f(t) over 0 to u: the state that a force leaves, from rest.

    Parameters
    ----------
    piece : Piece
        The force f.
    s : ndarray of complex
        Pole, or poles.
    u : array_like
        Local coordinates; of one shape with the poles, or to be spread over it.

    Returns
    -------
    ndarray of complex
        The states, of the common shape.

    """
    u = np.asarray(u, dtype=float)
    z: Complex = np.asarray(s * u)
    state: Complex = np.zeros_like(z)
    for k, coefficient in enumerate(piece.coefficients):
        if coefficient:
            state += coefficient * u ** (k + 1) * _phi(k, z)
    for omega, cosine, sine in piece.waves:
        for sign in (1.0, -1.0):
            # e^(s u) (e^((i w - s) u) - 1) / (i w - s), also where the wave is in resonance
            factor = 0.5 * complex(cosine, -sign * sine)
            state += factor * np.exp(z) * u * _phi(0, 1j * sign * omega * u - z)
    return state


def _state_after(curve: Piecewise, s: Complex) -> Complex:
    """Carry the state through a whole curve, from rest."""
    state = np.zeros_like(s)
    for piece in curve.differentiated(2).pieces:
        state = state * np.exp(s * piece.length)
        if not piece.is_zero:
            state = state - forced(piece, s, piece.length)
    return state


def residual_amplitude(curve: Piecewise, frequency: ArrayLike, damping: float = 0.0) -> Array:
    """
    Find the amplitude of the vibration that is left at the end of a movement.

    Parameters
    ----------
    curve : Piecewise
        The movement; its velocity does not step, and the load is at rest on it before.
    frequency : array_like, any shape
        Undamped natural frequencies [rad per unit of the abscissa]; above 0.
    damping : float
        Damping ratio [-], from 0 to below 1.

    Returns
    -------
    ndarray, shape of frequency
        Amplitude of the deviation of the load from the curve, in the unit of the curve, as it
        is at the end; with damping it decays from there on.

    References
    ----------
    M. P. Koster, Vibrations of Cam Mechanisms (1974), residual vibration of a single-degree-of-
    freedom follower; the integral is the Duhamel integral, taken piece by piece.

    """
    s = pole(frequency, damping)
    return np.asarray(np.abs(_state_after(curve, s)) / s.imag)


def residual_spectrum(curve: Piecewise, ratio: ArrayLike, damping: float = 0.0) -> Array:
    """
    Find the residual amplitude over the frequency ratio.

    Parameters
    ----------
    curve : Piecewise
        The movement.
    ratio : array_like, any shape
        Duration of the movement times the natural frequency in Hz: how many free periods it
        lasts [-]; above 0.
    damping : float
        Damping ratio [-], from 0 to below 1.

    Returns
    -------
    ndarray, shape of ratio
        Amplitudes, in the unit of the curve.

    """
    span = curve.end - curve.start
    return residual_amplitude(
        curve, np.asarray(ratio, dtype=float) * (2.0 * math.pi / span), damping)


@dataclass(frozen=True)
class Response:
    """
    How a load deviates from a curve.

    Attributes
    ----------
    curve : Piecewise
        The curve.
    frequency : float
        Undamped natural frequency [rad per unit of the abscissa]; above 0.
    damping : float
        Damping ratio [-], from 0 to below 1.
    before : complex
        State at the start, in the unit of the curve per unit of the abscissa; 0 for a load that
        is at rest on the curve.

    """

    curve: Piecewise
    frequency: float
    damping: float = 0.0
    before: complex = 0.0

    @cached_property
    def _pole(self) -> Complex:
        return pole(self.frequency, self.damping)

    @cached_property
    def _starts(self) -> list[Complex]:
        """Give the state at the start of each piece, and at the very end."""
        s = self._pole
        states = [np.full_like(s, self.before)]
        for piece in self.curve.differentiated(2).pieces:
            states.append(self._state(piece, states[-1], np.asarray(piece.length)))
        return states

    def _state(self, piece: Piece, start: Complex, u: Array) -> Complex:
        s = self._pole
        state = start * np.exp(s * u)
        return state if piece.is_zero else state - forced(piece, s, u)

    def __call__(self, x: ArrayLike) -> Array:
        """
        Evaluate the deviation; beyond the end of the curve the load swings freely.

        Parameters
        ----------
        x : array_like, any shape
            Abscissae, from the start of the curve on.

        Returns
        -------
        ndarray, shape of x
            Deviation of the load, in the unit of the curve.

        """
        points = np.asarray(x, dtype=float)
        pieces = (*self.curve.differentiated(2).pieces, Piece(math.inf))
        n = np.searchsorted(self.curve.breaks[1:], points, side='right')
        values = np.zeros_like(points)
        for k, (begin, piece, start) in enumerate(zip(self.curve.breaks, pieces, self._starts)):
            chosen = n == k
            if chosen.any():
                state = self._state(piece, start, points[chosen] - begin)
                values[chosen] = state.imag / self._pole.imag
        return values

    @cached_property
    def residual(self) -> float:
        """Amplitude of the vibration left at the end, in the unit of the curve."""
        return float(np.abs(self._starts[-1]) / self._pole.imag)

    @property
    def repeated(self) -> Response:
        """
        Take the curve as one cycle of many: the response that repeats with it.

        There is none without damping where the natural frequency is a multiple of the cycle's:
        the state before then is infinite.
        """
        missing = 1.0 - complex(np.exp(self._pole * (self.curve.end - self.curve.start)))
        if abs(missing) < _RESONANT:
            return replace(self, before=complex(math.inf, math.inf))
        return replace(self, before=complex(_state_after(self.curve, self._pole)) / missing)

    @cached_property
    def peak(self) -> Peak:
        """
        Largest deviation during the movement, with its sign and abscissa.

        Found from the closed form: a stationary value, or one at a joint.
        """
        s = self._pole
        looked = []
        for begin, piece, start in zip(
                self.curve.breaks, self.curve.differentiated(2).pieces, self._starts):
            fastest = max([self.frequency, *(wave.omega for wave in piece.waves)])
            cuts = np.linspace(0.0, piece.length,
                               max(1, math.ceil(fastest * piece.length / math.pi)) + 1)
            looks = cuts[:-1, None] + np.diff(cuts)[:, None] * _LOOKS
            values = self._state(piece, start, looks).imag / s.imag
            looked.append((begin, piece, start, cuts, looks, values))
        largest = max(float(np.max(np.abs(values))) for *_, values in looked)
        best = Peak(0.0, self.curve.start)
        for begin, piece, start, cuts, looks, values in looked:
            for n in np.flatnonzero(np.max(np.abs(values), axis=1) >= _NEAR * largest):
                points = [*looks[n], *self._stationary(piece, start, cuts[n:n + 2])]
                found = self._state(piece, start, np.array(points)).imag / s.imag
                k = int(np.argmax(np.abs(found)))
                if abs(found[k]) > abs(best.value):
                    best = Peak(float(found[k]), begin + float(points[k]))
        return best

    def _stationary(self, piece: Piece, start: Complex, cuts: Array) -> list[float]:
        """Find where the deviation is stationary: Im(s w) = 0, as the force is real."""
        s = self._pole
        return find_zeros(
            lambda u: (s * self._state(piece, start, u)).imag,
            lambda u: (s * (s * self._state(piece, start, u) - piece(u))).imag, cuts)
