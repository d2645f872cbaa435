# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The motion of a shaft over time: phases of constant jerk, evaluated in closed form."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
import math
from typing import NamedTuple

from cam_motion.runtime.ramp import RampLimits, RampStep, speed_ramp


class ShaftState(NamedTuple):
    """Angle [rad, unwrapped], speed [rad/s] and acceleration [rad/s²] of a shaft."""

    phi: float
    omega: float
    alpha: float


class _Phase(NamedTuple):
    """Constant jerk from a given instant on."""

    start: float
    state: ShaftState
    jerk: float

    def at(self, t: float) -> ShaftState:
        phi, omega, alpha = self.state
        dt = t - self.start
        return ShaftState(
            phi + dt * (omega + dt * (0.5 * alpha + dt * self.jerk / 6.0)),
            omega + dt * (alpha + 0.5 * dt * self.jerk),
            alpha + dt * self.jerk,
        )


class ShaftMotion:
    """
    The planned motion of a shaft, from a start on and for ever.

    The state at any instant comes from the start of the phase it lies in, so that nothing
    accumulates from tick to tick. After the last step the shaft goes on at constant speed.

    Parameters
    ----------
    start : float
        Time at which it begins [s].
    state : ShaftState
        State at that time.
    steps : Iterable[RampStep]
        Stretches of constant jerk, one behind the other.
    final : ShaftState, optional
        State after the last step, exactly, where rounding on the way there would leave another.

    """

    def __init__(self, start: float, state: ShaftState, steps: Iterable[RampStep] = (),
                 final: ShaftState | None = None) -> None:
        """Lay the steps one behind the other."""
        self._phases: list[_Phase] = []
        self._lay(start, state, steps, final)

    def _lay(self, start: float, state: ShaftState, steps: Iterable[RampStep],
             final: ShaftState | None) -> None:
        for duration, jerk in steps:
            if duration > 0.0:
                self._phases.append(_Phase(start, state, jerk))
                start += duration
                state = self._phases[-1].at(start)
        self._phases.append(_Phase(start, final or state, 0.0))
        self._starts = [phase.start for phase in self._phases]

    @property
    def settled_at(self) -> float:
        """Time [s] at which the last step is over."""
        return self._starts[-1]

    @property
    def final(self) -> ShaftState:
        """State at which the last step ends."""
        return self._phases[-1].state

    def state(self, t: float) -> ShaftState:
        """
        Give the state at an instant.

        Parameters
        ----------
        t : float
            Time [s], not before the start.

        Returns
        -------
        ShaftState
            Angle, speed and acceleration.

        """
        return self._phases[max(0, bisect_right(self._starts, t) - 1)].at(t)

    def fastest(self, t: float) -> float:
        """
        Find the highest speed at an instant and at the beginnings of the steps behind it.

        Parameters
        ----------
        t : float
            Time [s].

        Returns
        -------
        float
            A magnitude [rad/s]; that of the whole rest of a motion whose ramps do not turn back.

        """
        return max(abs(self.state(t).omega), *(
            abs(phase.state.omega) for phase in self._phases if phase.start >= t), 0.0)

    def ramped(self, t: float, target: float, limits: RampLimits) -> ShaftMotion:
        """
        Plan the fastest ramp to another speed, from this motion's state at an instant.

        Parameters
        ----------
        t : float
            Time at which the ramp begins [s].
        target : float
            Speed at which it ends [rad/s].
        limits : RampLimits
            Limits of the ramp.

        Returns
        -------
        ShaftMotion
            The motion from that instant on; it ends at exactly the target speed.

        """
        now = self.state(t)
        steps = speed_ramp(now.omega, now.alpha, target, limits)
        reached = ShaftMotion(t, now, steps).final
        return ShaftMotion(t, now, steps, ShaftState(reached.phi, target, 0.0))

    def released(self, t: float) -> ShaftMotion:
        """
        Take the acceleration back from an instant on, with the jerk of the ramp under way.

        Parameters
        ----------
        t : float
            Time from which on [s].

        Returns
        -------
        ShaftMotion
            The motion from that instant on; it ends at constant speed.

        """
        now, phase = self.state(t), max(0, bisect_right(self._starts, t) - 1)
        # while the acceleration is held, the jerk of the ramp is that of its next phase
        jerk = next((abs(each.jerk) for each in self._phases[phase:] if each.jerk), 0.0)
        steps = [RampStep(abs(now.alpha) / jerk, -math.copysign(jerk, now.alpha))] if jerk else []
        reached = ShaftMotion(t, now, steps).final
        return ShaftMotion(t, now, steps, reached._replace(alpha=0.0))

    def continued(self, steps: Iterable[RampStep], final: ShaftState) -> ShaftMotion:
        """
        Add steps behind the last one.

        Parameters
        ----------
        steps : Iterable[RampStep]
            The steps.
        final : ShaftState
            State after them, exactly.

        Returns
        -------
        ShaftMotion
            This motion, then the steps.

        """
        longer = ShaftMotion(0.0, self.final)
        longer._phases = self._phases[:-1]
        longer._lay(self.settled_at, self.final, steps, final)
        return longer
