# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
Following a shaft that an encoder measures.

Two steps: a tracking filter estimates angle, speed and acceleration from samples that come when
they come; a shaft that is turned by its jerk follows the estimate, so that what is published is
smooth: its speed is the derivative of its angle, and its acceleration that of its speed, whatever
the noise of the encoder.
"""

from __future__ import annotations

import math

from cam_motion.runtime.shaft_motion import ShaftState
from cam_motion.units import TURN

_JUMP = 0.1  # by which a measured angle may miss where it is expected, for noise [rad]
_STEEPEST = 500.0  # acceleration that no shaft of a machine has [rad/s²]
_UNSETTLED = 0.5  # share by which the estimate of the speed may be wrong


class JumpGate:
    """
    Tells angles that a shaft can have come to from those that it cannot.

    A measurement is expected where the last good one and the estimated speed lead to. What lies
    farther from there than noise and any acceleration of a machine could bring it, is a fault of
    the encoder: to follow it would make every axis jump.

    Attributes
    ----------
    refused, astray : int
        Measurements refused, ever and since the last good one.
    jump : float
        By how much the last of them missed where it was expected [rad].

    """

    def __init__(self) -> None:
        """Know no angle yet."""
        self.refused = self.astray = 0
        self.jump = 0.0
        self._last: tuple[float, float] | None = None

    def admits(self, t: float, phi: float, omega: float | None) -> bool:
        """
        Look at a measurement.

        Parameters
        ----------
        t : float
            When it was measured [s].
        phi : float
            Measured angle, unwrapped [rad].
        omega : float | None
            Estimate of the speed [rad/s]; None while there is none to be trusted.

        Returns
        -------
        bool
            Whether the shaft can be there.

        """
        if self._last is not None and omega is not None:
            step = t - self._last[0]
            if step <= 0.0:
                return True  # too late to matter
            miss = phi - self._last[1] - omega * step
            room = _JUMP + step * (_UNSETTLED * abs(omega) + 0.5 * _STEEPEST * step)
            if abs(miss) > room:
                self.refused += 1
                self.astray += 1
                self.jump = miss
                return False
        self._last, self.astray = (t, phi), 0
        return True


class TrackingFilter:
    """
    Estimates angle, speed and acceleration from measured angles.

    The fading-memory filter of second degree: without lag at constant acceleration, critically
    damped, with one figure to choose.

    Parameters
    ----------
    bandwidth : float
        Rate at which past samples fade [1/s]; higher follows faster, lower smooths more.

    References
    ----------
    E. Brookner, Tracking and Kalman Filtering Made Easy (1998), section 1.3, critically damped
    g-h-k filter.

    """

    def __init__(self, bandwidth: float) -> None:
        """Know nothing yet."""
        self.bandwidth = bandwidth
        self.time = 0.0
        """Time of the last sample [s]."""
        self.state: ShaftState | None = None
        """Estimate at that time; None before the first sample."""
        self._count = 0

    def update(self, t: float, phi: float) -> None:
        """
        Take a sample.

        Parameters
        ----------
        t : float
            When it was measured [s]; samples that are not later than the last are left out.
        phi : float
            Measured angle, unwrapped [rad].

        """
        if self.state is None:
            self.time, self.state, self._count = t, ShaftState(phi, 0.0, 0.0), 1
            return
        step = t - self.time
        if step <= 0.0:
            return
        expected = self.at(t)
        residual = phi - expected.phi
        self._count += 1
        if self._count == 2:
            # two samples give a speed; to fade it in from zero would take long
            self.state = ShaftState(phi, residual / step, 0.0)
        else:
            fading = math.exp(-self.bandwidth * step)
            # while it fills up, older samples must not fade faster than they come
            fading = min(fading, 1.0 - 1.0 / self._count)
            rest = 1.0 - fading
            self.state = ShaftState(
                expected.phi + (1.0 - fading ** 3) * residual,
                expected.omega + 1.5 * rest * rest * (1.0 + fading) * residual / step,
                expected.alpha + rest ** 3 * residual / (step * step))
        self.time = t

    def at(self, t: float) -> ShaftState:
        """
        Extrapolate the estimate.

        Parameters
        ----------
        t : float
            Time [s].

        Returns
        -------
        ShaftState
            Angle, speed and acceleration; all zero before the first sample.

        """
        if self.state is None:
            return ShaftState(0.0, 0.0, 0.0)
        phi, omega, alpha = self.state
        dt = t - self.time
        return ShaftState(phi + dt * (omega + 0.5 * dt * alpha), omega + dt * alpha, alpha)


class SmoothShaft:
    """
    A shaft that follows another one by its jerk.

    Parameters
    ----------
    stiffness : float
        Triple pole of what it has missed [1/s].
    phi : float
        Angle at which it stands at first [rad].

    """

    def __init__(self, stiffness: float, phi: float = 0.0) -> None:
        """Stand still."""
        self.stiffness = stiffness
        self.state = ShaftState(phi, 0.0, 0.0)

    def follow(self, target: ShaftState, step: float) -> ShaftState:
        """
        Go on by one tick.

        Parameters
        ----------
        target : ShaftState
            Where the other shaft is at the end of the tick.
        step : float
            Duration of the tick [s].

        Returns
        -------
        ShaftState
            Where this one is then.

        Notes
        -----
        The error e is to obey (d/dt + w)³ e = 0. Over a tick of constant jerk this holds
        exactly for the state at its end: the gains are those of the sampled triple pole.

        """
        phi, omega, alpha = self.state
        # the same tick without any jerk
        free = ShaftState(phi + step * (omega + 0.5 * step * alpha), omega + step * alpha, alpha)
        e0, e1, e2 = (have - want for have, want in zip(free, target))
        rest = 1.0 - math.exp(-self.stiffness * step)
        # Ackermann's formula for the triple pole exp(-w step), of the error without jerk
        jerk = -(rest ** 3 * e0 / step ** 3
                 + rest ** 2 * (3.0 - 2.0 * rest) * e1 / step ** 2
                 + rest * (3.0 - rest * (4.5 - rest * 11.0 / 6.0)) * e2 / step)
        self.state = ShaftState(
            free.phi + jerk * step ** 3 / 6.0, free.omega + 0.5 * jerk * step * step,
            free.alpha + jerk * step)
        return self.state


class Unwrapping:
    """
    Turns angles that an encoder gives within one turn into one that grows.

    Parameters
    ----------
    ratio : float
        Radians of the shaft per radian of the encoder [-].
    offset : float
        Angle of the shaft where the encoder is at zero [rad].
    wraps : bool
        Whether the encoder starts over after each turn.

    """

    def __init__(self, ratio: float, offset: float, wraps: bool) -> None:
        """Know no angle yet."""
        self.ratio = ratio
        self.offset = offset
        self.wraps = wraps
        self._last: float | None = None
        self._turns = 0

    def __call__(self, angle: float) -> float:
        """
        Give the angle of the shaft.

        Parameters
        ----------
        angle : float
            Angle of the encoder [rad].

        Returns
        -------
        float
            Unwrapped angle of the shaft [rad].

        """
        if self.wraps and self._last is not None:
            self._turns -= round((angle - self._last) / TURN)
        self._last = angle
        return self.ratio * (angle + self._turns * TURN) + self.offset
