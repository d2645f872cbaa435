# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Motors by their torque over speed: induction motors and servo motors."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
import math
from typing import Any, Protocol

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.units import RPM
import numpy as np
from numpy.polynomial import polynomial

_NO_BEND = 1e-12  # share of a below which b does nothing to the torque curve


class Motor(Protocol):
    """What a drive needs to know of its motor, whose torque is zero at synchronous speed only."""

    inertia: float
    synchronous_speed: float
    breakdown_slip: float

    def torque(self, speed: Any) -> Any:
        """Give the torque [N m] at a speed [rad/s], float or array."""

    def slope(self, speed: Any) -> Any:
        """Give the derivative of the torque with respect to the speed [N m s/rad]."""


def _positive(**values: float) -> list[Problem]:
    return [
        Problem(name, value, 'must be a finite number above 0')
        for name, value in values.items() if not (math.isfinite(value) and value > 0.0)
    ]


@dataclass(frozen=True)
class InductionMotor:
    """
    An induction motor by the curve T = T_b s / (s + (s_b - s)² (a - b s³)) over the slip s.

    Attributes
    ----------
    synchronous_speed : float
        Speed at zero slip [rad/s].
    breakdown_torque : float
        Largest torque T_b [N m], reached at the breakdown slip.
    breakdown_slip : float
        Slip s_b at breakdown [-], between 0 and 1.
    a, b : float
        Constants of the curve [-].
    inertia : float
        Inertia of the rotor [kg m²].

    Raises
    ------
    ConfigurationError
        When a figure is not positive, or the curve has a pole between stalling and twice the
        synchronous speed.

    Notes
    -----
    Document 004 prints T_b / (1 + (s_b - s)² (a/s - b s²)), which divides by zero at the
    synchronous speed; multiplied by s/s it is the curve above, through zero and on to negative
    torque when the load drives the motor. Beyond standstill (s > 1, turning backwards) the term
    b s³ would bend the curve through a pole; there it stays as it is at s = 1, so that the torque
    goes on, against the motion, and fades slowly.

    References
    ----------
    Document 004, section g): E. Soylemez' formula for EMTAS motors.

    """

    synchronous_speed: float
    breakdown_torque: float
    breakdown_slip: float
    a: float
    b: float
    inertia: float

    def __post_init__(self) -> None:
        """Refuse figures that make no motor."""
        problems = _positive(
            synchronous_speed=self.synchronous_speed, breakdown_torque=self.breakdown_torque,
            a=self.a, inertia=self.inertia)
        if not 0.0 < self.breakdown_slip < 1.0:
            problems.append(Problem(
                'breakdown_slip', self.breakdown_slip, 'must lie between 0 and 1'))
        if not problems:
            slip = polynomial.Polynomial([0.0, 1.0])
            # a b too small to bend the curve would only make the search for roots overflow
            b = self.b if abs(self.b) > _NO_BEND * self.a else 0.0
            below = slip + (self.breakdown_slip - slip) ** 2 * (self.a - b * slip ** 3)
            roots = np.asarray(below.roots(), dtype=complex)
            poles = (np.abs(roots.imag) < 1e-9) & (np.abs(roots.real) <= 1.0)
            rule = 'the torque curve must be finite from standstill to twice the synchronous speed'
            if self.a <= self.b:
                problems.append(Problem('b', self.b, rule, f'with a = {self.a:g} take b below it'))
            elif poles.any():
                problems.append(Problem('a', self.a, rule, 'take a larger a'))
        if problems:
            raise ConfigurationError(problems)

    def torque(self, speed: Any) -> Any:
        """
        Give the torque at a speed.

        Parameters
        ----------
        speed : float or ndarray
            Speed of the motor shaft [rad/s]; negative turns backwards.

        Returns
        -------
        float or ndarray
            Torque in the sense of positive speed [N m].

        """
        s = 1.0 - speed / self.synchronous_speed
        gap = self.breakdown_slip - s
        bend = np.minimum(s, 1.0)
        rest = self.a - self.b * bend * bend * bend
        return self.breakdown_torque * s / (s + gap * gap * rest)

    def slope(self, speed: Any) -> Any:
        """
        Differentiate the torque with respect to the speed.

        Parameters
        ----------
        speed : float or ndarray
            Speed of the motor shaft [rad/s].

        Returns
        -------
        float or ndarray
            Slope [N m s/rad]; negative on the working side of the breakdown.

        """
        s = 1.0 - speed / self.synchronous_speed
        gap = self.breakdown_slip - s
        bend = np.minimum(s, 1.0)
        square = self.b * bend * bend
        rest = self.a - square * bend
        below = s + gap * gap * rest
        turn = 1.0 - gap * (2.0 * rest + 3.0 * gap * square * (s < 1.0))
        by_slip = self.breakdown_torque * (below - s * turn) / (below * below)
        return -by_slip / self.synchronous_speed


@dataclass(frozen=True)
class KlossMotor:
    """
    An induction motor known by rated and breakdown figures only, T = 2 T_b / (s/s_b + s_b/s).

    Attributes
    ----------
    synchronous_speed : float
        Speed at zero slip [rad/s].
    breakdown_torque : float
        Largest torque T_b [N m].
    breakdown_slip : float
        Slip s_b at breakdown [-].
    inertia : float
        Inertia of the rotor [kg m²].

    Raises
    ------
    ConfigurationError
        When a figure is not positive.

    References
    ----------
    M. Kloss, Drehmoment und Schluepfung des Drehstrommotors (1908), without stator resistance.

    """

    synchronous_speed: float
    breakdown_torque: float
    breakdown_slip: float
    inertia: float

    def __post_init__(self) -> None:
        """Refuse figures that make no motor."""
        if problems := _positive(
                synchronous_speed=self.synchronous_speed, inertia=self.inertia,
                breakdown_torque=self.breakdown_torque, breakdown_slip=self.breakdown_slip):
            raise ConfigurationError(problems)

    @classmethod
    def from_rated(cls, synchronous_speed: float, rated_speed: float, rated_torque: float,
                   breakdown_torque: float, inertia: float) -> KlossMotor:
        """
        Find the curve through the rated point.

        Parameters
        ----------
        synchronous_speed, rated_speed : float
            Speeds [rad/s].
        rated_torque, breakdown_torque : float
            Torques [N m].
        inertia : float
            Inertia of the rotor [kg m²].

        Returns
        -------
        KlossMotor
            With s_b = s_n (k + sqrt(k² - 1)), k the ratio of the torques.

        Raises
        ------
        ConfigurationError
            When the rated point is not below breakdown and synchronous speed.

        """
        problems = []
        if not 0.0 < rated_speed < synchronous_speed:
            problems.append(Problem(
                'rated_speed', rated_speed / RPM, 'must lie below the synchronous speed of '
                f'{synchronous_speed / RPM:g} rpm'))
        if not 0.0 < rated_torque < breakdown_torque:
            problems.append(Problem(
                'rated_torque', rated_torque,
                f'must lie below the breakdown torque of {breakdown_torque:g} N m'))
        if problems:
            raise ConfigurationError(problems)
        ratio = breakdown_torque / rated_torque
        slip = (1.0 - rated_speed / synchronous_speed) * (ratio + math.sqrt(ratio * ratio - 1.0))
        return cls(synchronous_speed, breakdown_torque, slip, inertia)

    def started_with(self, torque: float, at: float | None = None) -> InductionMotor:
        """
        Bend the curve to a known torque at rest, which it gives too low for most motors.

        Parameters
        ----------
        torque : float
            Torque at rest [N m]; below the breakdown torque.
        at : float, optional
            Speed at which the torque stays what it is, as the rated one [rad/s]; left out it is
            that of breakdown.

        Returns
        -------
        InductionMotor
            A motor with the same breakdown, that torque at rest, and the same torque at ``at``.

        Raises
        ------
        ConfigurationError
            When there is no such curve.

        Notes
        -----
        This curve is that of `InductionMotor` with a = 1 / (2 s_b) and b = 0. There the torque at
        rest makes a - b = (T_b / T_0 - 1) / (1 - s_b)², and what shall stay at the slip s makes
        a - b s³ = 1 / (2 s_b).

        """
        rule = f'must lie below the breakdown torque of {self.breakdown_torque:g} N m'
        if 0.0 < torque < self.breakdown_torque:
            rule = (f'is out of the reach of a curve with breakdown at the slip '
                    f'{self.breakdown_slip:.4g}, which gives {float(self.torque(0.0)):.4g} N m')
            if self.breakdown_slip < 1.0:
                kept = self.breakdown_slip if at is None else 1.0 - at / self.synchronous_speed
                at_rest = (self.breakdown_torque / torque - 1.0) / (1.0 - self.breakdown_slip) ** 2
                b = (0.5 / self.breakdown_slip - at_rest) / (1.0 - kept ** 3)
                with suppress(ConfigurationError):  # it says no more than that there is none
                    return InductionMotor(self.synchronous_speed, self.breakdown_torque,
                                          self.breakdown_slip, at_rest + b, b, self.inertia)
        raise ConfigurationError([Problem(
            'starting_torque', torque, rule,
            'give breakdown_slip, a and b of a curve that the maker draws')])

    def torque(self, speed: Any) -> Any:
        """
        Give the torque at a speed.

        Parameters
        ----------
        speed : float or ndarray
            Speed of the motor shaft [rad/s].

        Returns
        -------
        float or ndarray
            Torque in the sense of positive speed [N m].

        """
        s = 1.0 - speed / self.synchronous_speed
        return (2.0 * self.breakdown_torque * self.breakdown_slip * s
                / (s * s + self.breakdown_slip ** 2))

    def slope(self, speed: Any) -> Any:
        """
        Differentiate the torque with respect to the speed.

        Parameters
        ----------
        speed : float or ndarray
            Speed of the motor shaft [rad/s].

        Returns
        -------
        float or ndarray
            Slope [N m s/rad].

        """
        s = 1.0 - speed / self.synchronous_speed
        square = self.breakdown_slip ** 2
        by_slip = (2.0 * self.breakdown_torque * self.breakdown_slip * (square - s * s)
                   / (s * s + square) ** 2)
        return -by_slip / self.synchronous_speed
