# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Input shaping: filters over a cam after which a load that swings is left at rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
import math
from typing import Protocol

from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.superposition import superposed, total, window
from cam_motion.motion.vibration import Complex, pole
from cam_motion.units import TURN
import numpy as np
from numpy.typing import ArrayLike

TOLERANCE = 0.05
"""Share of the vibration that the shaper ``ei`` leaves at its frequency where none is stated."""


class CamFilter(Protocol):
    """What turns a cam into a shaped one; it is linear, and made for one steady speed."""

    @property
    def duration(self) -> float:
        """Time by which a shaped movement ends later [s]."""

    def applied(self, profile: CamProfile, speed: float) -> Piecewise:
        """
        Shape one cycle of a cam.

        Parameters
        ----------
        profile : CamProfile
            The cam.
        speed : float
            Speed of the cam for which it is shaped [rad/s]; above 0.

        Returns
        -------
        Piecewise
            The shaped cycle.

        """

    def transfer(self, s: Complex) -> Complex:
        """
        Tell how much of the vibration with a pole is left when the shaped movement has ended.

        Parameters
        ----------
        s : ndarray of complex, any shape
            Poles [1/s].

        Returns
        -------
        ndarray of complex, shape of s
            Factors [-].

        """


@dataclass(frozen=True)
class ImpulseShaper:
    """
    A sum of delayed copies: the cam convolved with impulses.

    Attributes
    ----------
    amplitudes : tuple[float, ...]
        Weights of the copies [-]; their sum is 1.
    times : tuple[float, ...]
        Their delays [s], rising from 0.

    """

    amplitudes: tuple[float, ...]
    times: tuple[float, ...]

    @property
    def duration(self) -> float:
        """Time by which a shaped movement ends later [s]."""
        return self.times[-1]

    def applied(self, profile: CamProfile, speed: float) -> Piecewise:
        """
        Shape one cycle of a cam.

        Parameters
        ----------
        profile : CamProfile
            The cam.
        speed : float
            Speed of the cam for which it is shaped [rad/s]; above 0.

        Returns
        -------
        Piecewise
            The shaped cycle, as smooth as the cam.

        """
        copies = []
        for amplitude, time in zip(self.amplitudes, self.times):
            back = speed * time
            copy = window(profile.curve, profile.advance, -back, TURN - back)
            breaks = [0.0, *(x + back for x in copy.breaks[1:-1]), TURN]
            copies.append((amplitude, Piecewise(0.0, copy.pieces, breaks)))
        return superposed(copies)

    def transfer(self, s: Complex) -> Complex:
        """
        Tell how much of the vibration with a pole is left when the shaped movement has ended.

        Parameters
        ----------
        s : ndarray of complex, any shape
            Poles [1/s].

        Returns
        -------
        ndarray of complex, shape of s
            Factors [-].

        """
        return np.asarray(sum(amplitude * np.exp(s * (self.duration - time))
                              for amplitude, time in zip(self.amplitudes, self.times)))


@dataclass(frozen=True)
class Polydyne:
    """
    The command y + 2 zeta y'/w + y''/w², after which the load itself moves along the cam.

    Attributes
    ----------
    frequency : float
        Undamped natural frequency w of the load [rad/s].
    damping : float
        Its damping ratio zeta [-].

    References
    ----------
    D. A. Stoddart, Polydyne cam design, Machine Design 25 (1953); the same as the flat output
    of M. Fliess et al., Int. J. Control 61 (1995) for an oscillator with its damper on the frame.

    """

    frequency: float
    damping: float = 0.0

    @property
    def duration(self) -> float:
        """Time by which a shaped movement ends later: none [s]."""
        return 0.0

    def applied(self, profile: CamProfile, speed: float) -> Piecewise:
        """
        Shape one cycle of a cam.

        Parameters
        ----------
        profile : CamProfile
            The cam; its jerk must not step, else the velocity of the shaped one would.
        speed : float
            Speed of the cam for which it is shaped [rad/s]; above 0.

        Returns
        -------
        Piecewise
            The shaped cycle, two times less smooth than the cam.

        """
        slow = speed / self.frequency
        pieces = [total([(1.0, y), (2.0 * self.damping * slow, y.derivative),
                         (slow * slow, y.derivative.derivative)]) for y in profile.curve.pieces]
        return Piecewise(0.0, pieces, profile.curve.breaks)

    def transfer(self, s: Complex) -> Complex:
        """
        Tell how much of the vibration with a pole is left when the shaped movement has ended.

        Parameters
        ----------
        s : ndarray of complex, any shape
            Poles [1/s].

        Returns
        -------
        ndarray of complex, shape of s
            Factors [-].

        """
        x = s / self.frequency
        return np.asarray(1.0 + 2.0 * self.damping * x + x * x)


def _zeros(count: int, frequency: float, damping: float) -> ImpulseShaper:
    """Make a shaper with a zero of some multiplicity at the pole: binomial weights."""
    decay, half = _half_period(frequency, damping)
    weights = [math.comb(count, n) * decay ** n for n in range(count + 1)]
    return _shaper(weights, half)


def _half_period(frequency: float, damping: float) -> tuple[float, float]:
    """Give by what an oscillation decays in half a period [-], and how long that is [s]."""
    root = math.sqrt(1.0 - damping * damping)
    return math.exp(-math.pi * damping / root), math.pi / (frequency * root)


def _shaper(weights: list[float], half: float) -> ImpulseShaper:
    whole = math.fsum(weights)
    return ImpulseShaper(tuple(weight / whole for weight in weights),
                         tuple(n * half for n in range(len(weights))))


def zv(frequency: float, damping: float = 0.0) -> ImpulseShaper:
    """
    Make the shaper of zero vibration.

    Parameters
    ----------
    frequency : float
        Undamped natural frequency [rad/s].
    damping : float
        Damping ratio [-], from 0 to below 1.

    Returns
    -------
    ImpulseShaper
        Two impulses over half a period.

    References
    ----------
    N. C. Singer, W. P. Seering, Preshaping command inputs to reduce system vibration, ASME J.
    Dyn. Syst. Meas. Control 112 (1990); O. J. M. Smith, Posicast control (1957).

    """
    return _zeros(1, frequency, damping)


def zvd(frequency: float, damping: float = 0.0) -> ImpulseShaper:
    """
    Make the shaper of zero vibration and derivative: less sensitive to the frequency.

    Parameters
    ----------
    frequency : float
        Undamped natural frequency [rad/s].
    damping : float
        Damping ratio [-], from 0 to below 1.

    Returns
    -------
    ImpulseShaper
        Three impulses over one period.

    References
    ----------
    N. C. Singer, W. P. Seering, as for `zv`.

    """
    return _zeros(2, frequency, damping)


def zvdd(frequency: float, damping: float = 0.0) -> ImpulseShaper:
    """
    Make the shaper of zero vibration and two derivatives: still less sensitive.

    Parameters
    ----------
    frequency : float
        Undamped natural frequency [rad/s].
    damping : float
        Damping ratio [-], from 0 to below 1.

    Returns
    -------
    ImpulseShaper
        Four impulses over one and a half periods.

    References
    ----------
    N. C. Singer, W. P. Seering, as for `zv`.

    """
    return _zeros(3, frequency, damping)


def ei(frequency: float, damping: float = 0.0, tolerance: float = TOLERANCE) -> ImpulseShaper:
    """
    Make the extra-insensitive shaper: it leaves a little at its frequency, none on both sides.

    Parameters
    ----------
    frequency : float
        Undamped natural frequency [rad/s].
    damping : float
        Damping ratio [-], from 0 to below 1.
    tolerance : float
        Share of the vibration that is left at the frequency [-], from 0 (`zvd`) to below 1. It
        is less where the load is so damped that weights 1, 0 and K² leave less.

    Returns
    -------
    ImpulseShaper
        Three impulses over one period.

    Notes
    -----
    Its zeros are at damped frequencies (1 ± delta / pi) times that of the load, with the decay of
    the load: the weights are 1, 2 K cos delta and K², K the decay in half a period, and delta
    follows from the tolerance in closed form. Without damping these are the published weights
    (1 + V)/4, (1 - V)/2, (1 + V)/4; with damping the published ones are numerical fits.

    References
    ----------
    W. Singhose, W. Seering, N. Singer, Residual vibration reduction using vector diagrams to
    generate shaped inputs, ASME J. Mech. Des. 116 (1994).

    """
    decay, half = _half_period(frequency, damping)
    square = decay * decay
    cosine = (2.0 * square - tolerance * (1.0 + square)) / (2.0 * square + 2.0 * tolerance * decay)
    return _shaper([1.0, 2.0 * decay * max(cosine, 0.0), square], half)


KINDS = ('zv', 'zvd', 'zvdd', 'ei', 'polydyne')
"""Names of the filters, as configurations use them."""


def make_filter(kind: str, frequency: float, damping: float = 0.0,
                tolerance: float = TOLERANCE) -> CamFilter:
    """
    Make a filter by name.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    frequency : float
        Undamped natural frequency [rad/s]; above 0.
    damping : float
        Damping ratio [-], from 0 to below 1.
    tolerance : float
        Share of the vibration that ``ei`` leaves at its frequency [-].

    Returns
    -------
    CamFilter
        The filter.

    """
    makers: dict[str, Callable[[float, float], CamFilter]] = {
        'zv': zv, 'zvd': zvd, 'zvdd': zvdd, 'ei': partial(ei, tolerance=tolerance),
        'polydyne': Polydyne}
    return makers[kind](frequency, damping)


def amplification(made: CamFilter, ratio: ArrayLike, frequency: float,
                  damping: float = 0.0) -> Array:
    """
    Find what a filter leaves of a vibration that is not the one it was made for.

    Parameters
    ----------
    made : CamFilter
        The filter.
    ratio : array_like, any shape
        Natural frequency over that for which it was made [-]; above 0. A cam that turns at
        another speed sees the same as a load with this ratio times its speed.
    frequency : float
        Frequency for which it was made [rad/s].
    damping : float
        Damping ratio of the load [-].

    Returns
    -------
    ndarray, shape of ratio
        Amplitude after the shaped movement over that after the movement as it was [-].

    """
    return np.asarray(np.abs(made.transfer(
        pole(np.asarray(ratio, dtype=float) * frequency, damping))))
