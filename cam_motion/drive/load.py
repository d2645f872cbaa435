# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
Loads on a cam shaft, built from parts: generalised inertia J(q) and generalised force Q(q, w).

Each part knows what it adds to J, to C = dJ/dq / 2, to Q, and to the force between the cam and its
follower. Q is kept as Q0(q) + Q1(q) w, for a shaft that turns forwards.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.piece import Array
from cam_motion.units import TURN
import numpy as np

GRAVITY = 9.81
"""Acceleration of free fall as document 004 takes it [m/s²]."""

_WHOLE = TURN * (1.0 + 1e-12)  # a window that ends here ends with the turn, but for rounding


class Follower(NamedTuple):
    """
    Where the follower is at given shaft angles: arrays of one shape, or floats.

    The angle ``q`` [rad] lies within one turn, and is NaN where it is not known; ``s`` [m], ``s1``
    [m/rad] and ``s2`` [m/rad²] are position and derivatives with respect to the shaft angle.
    """

    q: Any
    s: Any
    s1: Any
    s2: Any


class Terms(NamedTuple):
    """
    What a load adds at given angles: J and C [kg m²], Q0 [N m], Q1 [N m s/rad].

    All are floats for a follower in floats, else arrays of its shape, or what broadcasts to it.
    """

    inertia: Any
    centripetal: Any
    force: Any
    damping: Any


class Part(Protocol):
    """A part of a load."""

    def terms(self, at: Follower) -> Terms:
        """Give what the part adds to the equation of motion of the shaft."""

    def follower_force(self, at: Follower, omega: Array, alpha: Array) -> Array:
        """Give the force [N] that the part needs at the follower, positive against the cam."""

    def edges(self) -> tuple[float, ...]:
        """Give the shaft angles [rad] at which the part's terms step."""


class _Smooth:
    """A part whose terms have no steps of their own."""

    def edges(self) -> tuple[float, ...]:
        """Give the shaft angles [rad] at which the part's terms step: none."""
        return ()


@dataclass(frozen=True)
class RotatingInertia(_Smooth):
    """An inertia that turns with the shaft [kg m²]."""

    inertia: float

    def terms(self, at: Follower) -> Terms:
        """Give a constant inertia."""
        zero = 0.0 * at.s
        return Terms(zero + self.inertia, zero, zero, zero)

    def follower_force(self, at: Follower, omega: Array, alpha: Array) -> Array:
        """Need nothing at the follower."""
        return np.zeros_like(at.q)


@dataclass(frozen=True)
class TranslatingMass(_Smooth):
    """A mass that moves with the follower, with its weight where it moves up and down."""

    mass: float
    gravity: float = GRAVITY

    def terms(self, at: Follower) -> Terms:
        """Give J = m s'², C = m s' s'', Q = -m g s'."""
        return Terms(self.mass * at.s1 ** 2, self.mass * at.s1 * at.s2,
                     -self.mass * self.gravity * at.s1, 0.0 * at.s)

    def follower_force(self, at: Follower, omega: Array, alpha: Array) -> Array:
        """Give the force of inertia and weight."""
        force: Array = self.mass * (at.s1 * alpha + at.s2 * omega ** 2 + self.gravity)
        return force


@dataclass(frozen=True)
class Spring(_Smooth):
    """A spring that holds the follower on the cam; stiffness [N/m], preload at s = 0 [m]."""

    stiffness: float
    preload: float = 0.0

    def terms(self, at: Follower) -> Terms:
        """Give Q = -k (s + delta) s' (document 004 a) prints it without s')."""
        zero = 0.0 * at.s
        return Terms(zero, zero, -self.stiffness * (at.s + self.preload) * at.s1, zero)

    def follower_force(self, at: Follower, omega: Array, alpha: Array) -> Array:
        """Give the force of the spring."""
        force: Array = self.stiffness * (at.s + self.preload)
        return force


@dataclass(frozen=True)
class Friction(_Smooth):
    """Friction at the follower: viscous [N s/m] and Coulomb [N], against the motion."""

    viscous: float = 0.0
    coulomb: float = 0.0

    def terms(self, at: Follower) -> Terms:
        """Give Q0 = -F |s'|, Q1 = -c s'²."""
        zero = 0.0 * at.s
        return Terms(zero, zero, -self.coulomb * abs(at.s1), -self.viscous * at.s1 ** 2)

    def follower_force(self, at: Follower, omega: Array, alpha: Array) -> Array:
        """Give the friction as a force on the follower."""
        force: Array = self.coulomb * np.sign(at.s1) + self.viscous * at.s1 * omega
        return force


def _check_window(window: tuple[float, float]) -> None:
    """Refuse a window that is none."""
    first, last = window
    if not 0.0 <= first <= last <= _WHOLE:
        raise ConfigurationError([Problem(
            'window', window, 'must be two rising angles within one turn')])


def _acts(window: tuple[float, float], q: Any) -> Any:
    """Tell where angles lie in a window; a whole turn holds those too that are not known."""
    first, last = window
    if first <= 0.0 and last >= TURN:
        return True
    return (q >= first) & (q <= last)


@dataclass(frozen=True)
class Process:
    """
    What the product does to the machine while the shaft angle lies in a window.

    Attributes
    ----------
    force : float
        Force against the rise of the follower [N].
    moment : float
        Moment on the shaft against turning forwards [N m].
    window : tuple[float, float]
        First and last shaft angle of the window, within one turn [rad].

    Raises
    ------
    ConfigurationError
        When the window is none.

    """

    force: float = 0.0
    moment: float = 0.0
    window: tuple[float, float] = (0.0, TURN)

    def __post_init__(self) -> None:
        """Refuse a window that is none."""
        _check_window(self.window)

    def terms(self, at: Follower) -> Terms:
        """Give Q = -F s' - M inside the window."""
        zero = 0.0 * at.s
        against = self.force * at.s1 + self.moment
        return Terms(zero, zero, zero - _acts(self.window, at.q) * against, zero)

    def follower_force(self, at: Follower, omega: Array, alpha: Array) -> Array:
        """Give the force of the process."""
        force: Array = np.zeros_like(at.q) + _acts(self.window, at.q) * self.force
        return force

    def edges(self) -> tuple[float, ...]:
        """Give the ends of the window [rad]."""
        return self.window


@dataclass(frozen=True)
class Lever:
    """
    A lever that the follower turns through a slider, with a moment against it in a window.

    Attributes
    ----------
    inertia : float
        Inertia of the lever about its bearing [kg m²].
    arm : float
        Length of the lever, a2 [m].
    height : float
        Height of the slider over the bearing at s = 0: cos(phi) = (height - s) / arm [m].
    moment : float
        Moment against the lever while the shaft angle lies in the window [N m].
    window : tuple[float, float]
        First and last shaft angle of the window, within one turn [rad].

    Notes
    -----
    Document 004 a): g1 = s' / (arm sin(phi)) (printed with the wrong sign) and
    g1' = (s'' arm sin(phi) - arm cos(phi) g1 s') / (arm sin(phi))² (printed without g1).

    """

    inertia: float
    arm: float
    height: float
    moment: float = 0.0
    window: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        """Refuse a window that is none."""
        _check_window(self.window)

    def ratios(self, at: Follower) -> tuple[Any, Any, Any]:
        """
        Give the transmission to the lever.

        Parameters
        ----------
        at : Follower
            Where the follower is.

        Returns
        -------
        tuple[float or ndarray, ...]
            arm * sin(phi) [m], g1 = dphi/dq [-] and its derivative g1' [1/rad].

        """
        across = self.height - at.s
        with np.errstate(invalid='ignore'):  # out of reach it is not defined
            reach = np.sqrt(self.arm ** 2 - across ** 2)
        g1 = at.s1 / reach
        return reach, g1, (at.s2 * reach - across * g1 * at.s1) / reach ** 2

    def moment_at(self, at: Follower) -> Any:
        """
        Give the moment against the lever.

        Parameters
        ----------
        at : Follower
            Where the follower is.

        Returns
        -------
        float or ndarray
            Moment [N m].

        """
        return 0.0 * at.s + _acts(self.window, at.q) * self.moment

    def terms(self, at: Follower) -> Terms:
        """Give J = I g1², C = I g1 g1', Q = -M g1."""
        _, g1, g1_slope = self.ratios(at)
        return Terms(self.inertia * g1 ** 2, self.inertia * g1 * g1_slope,
                     -self.moment_at(at) * g1, 0.0 * at.s)

    def follower_force(self, at: Follower, omega: Array, alpha: Array) -> Array:
        """Give the force that turns the lever, (I phi'' + M) / (arm sin(phi))."""
        reach, g1, g1_slope = self.ratios(at)
        turned = self.inertia * (g1 * alpha + g1_slope * omega ** 2)
        force: Array = (turned + self.moment_at(at)) / reach
        return force

    def edges(self) -> tuple[float, ...]:
        """Give the ends of the window [rad]."""
        return self.window if self.moment else ()
