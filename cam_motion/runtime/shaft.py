# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The virtual master shaft: angle, speed and acceleration at any instant, in closed form."""

from __future__ import annotations

from enum import Enum
import math

from cam_motion.errors import CamMotionError
from cam_motion.runtime.ramp import leads_to, RampLimits, RampStep, speed_ramp
from cam_motion.runtime.ramp_room import RampRoom
from cam_motion.runtime.shaft_motion import ShaftMotion, ShaftState
from cam_motion.units import TURN

# A cycle end this close [turns] counts as reached: the rounding of an angle after 1e6 cycles.
_AT_CYCLE_END = 1e-9
# At the very highest speed allowed the limits of the axes would have no room left for the
# shaft's own acceleration on the way there: it runs slower by this share.
_ROOM = 5e-4


class ShaftError(CamMotionError):
    """A command that the shaft cannot follow in its present state."""


class ShaftMode(Enum):
    """What the shaft has been told to do; the value is its name on the state topic."""

    STOPPED = 'stopped'
    RUNNING = 'running'
    STOPPING = 'stopping'
    STOPPING_AT_CYCLE_END = 'stopping_at_cycle_end'
    QUICK_STOPPING = 'quick_stopping'
    QUICK_STOPPED = 'quick_stopped'


class Shaft:
    """
    A shaft that follows commands with jerk-limited ramps.

    Its motion is known in closed form for all time to come. A command replaces that motion from
    its own instant on, starting from the state at that instant, so nothing ever jumps.

    Parameters
    ----------
    speed : float
        Set speed [rad/s]; negative runs backwards.
    limits : RampLimits
        Limits of ordinary ramps.
    quick_limits : RampLimits
        Limits of the quick stop.
    phi : float
        Angle at which it stands at first [rad].

    """

    def __init__(self, speed: float, limits: RampLimits, quick_limits: RampLimits,
                 phi: float = 0.0) -> None:
        """Stand still."""
        self.speed = speed
        self.allowed = math.inf
        """Highest speed that the axes allow [rad/s]; a magnitude."""
        self.limits = limits
        self.room: RampRoom | None = None
        """The axes for whose sake ordinary ramps are softened; the quick stop never is."""
        self.quick_limits = quick_limits
        self._mode = ShaftMode.STOPPED
        self._motion = ShaftMotion(0.0, ShaftState(phi, 0.0, 0.0))

    def state(self, t: float) -> ShaftState:
        """
        Give the state of the shaft at an instant.

        Parameters
        ----------
        t : float
            Time [s], not before the last command.

        Returns
        -------
        ShaftState
            Angle, speed and acceleration.

        """
        return self._motion.state(t)

    def mode(self, t: float) -> ShaftMode:
        """
        Say what the shaft is doing.

        Parameters
        ----------
        t : float
            Time [s].

        Returns
        -------
        ShaftMode
            Its mode; a stop that has come to rest is STOPPED or QUICK_STOPPED.

        """
        if self._mode in (ShaftMode.STOPPED, ShaftMode.RUNNING) or t < self.settled_at:
            return self._mode
        quick = self._mode is ShaftMode.QUICK_STOPPING
        return ShaftMode.QUICK_STOPPED if quick else ShaftMode.STOPPED

    @property
    def settled_at(self) -> float:
        """Time [s] at which the present ramp or stop is over."""
        return self._motion.settled_at

    def run(self, t: float) -> None:
        """
        Start, or resume from a stop under way, and go to the set speed.

        Parameters
        ----------
        t : float
            Time [s].

        Raises
        ------
        ShaftError
            After a quick stop that has not been reset.

        """
        if self.mode(t) in (ShaftMode.QUICK_STOPPING, ShaftMode.QUICK_STOPPED):
            raise ShaftError('the shaft has been stopped quickly: reset it before it runs again')
        self._mode = ShaftMode.RUNNING
        self._motion = self._ramp(t, self.target)

    def set_speed(self, t: float, speed: float) -> None:
        """
        Change the set speed; a running shaft ramps to it at once.

        Parameters
        ----------
        t : float
            Time [s].
        speed : float
            New set speed [rad/s].

        Raises
        ------
        ShaftError
            When the speed is not a finite number.

        """
        if not math.isfinite(speed):
            raise ShaftError(f'a speed must be a finite number, not {speed!r}')
        self.speed = speed
        if self.mode(t) is ShaftMode.RUNNING:
            self._motion = self._ramp(t, self.target)

    def allow(self, t: float, speed: float) -> None:
        """
        Obey another highest speed; a running shaft ramps as far as it may.

        A shaft that is to stop at the end of a cycle slows down too, and stops at the first end
        at which it then can; a higher speed does not hurry it.

        Parameters
        ----------
        t : float
            Time [s].
        speed : float
            Highest speed [rad/s], not negative; infinite where nothing limits it.

        """
        if speed == self.allowed:
            return
        self.allowed = speed
        mode = self.mode(t)
        if mode is ShaftMode.RUNNING:
            self._motion = self._ramp(t, self.target)
        elif mode is ShaftMode.STOPPING_AT_CYCLE_END and self._motion.fastest(t) > speed:
            if self.target:
                self._plan_stop_at_cycle_end(t)
            else:
                self.stop(t)

    def make_room(self, t: float, room: RampRoom | None) -> None:
        """
        Soften ordinary ramps for the sake of other axes; a ramp to the set speed does so at once.

        Parameters
        ----------
        t : float
            Time [s].
        room : RampRoom | None
            What their limits leave.

        """
        self.room = room
        if self.mode(t) is ShaftMode.RUNNING and t < self.settled_at:
            self._motion = self._ramp(t, self.target)

    @property
    def target(self) -> float:
        """Give the speed at which it runs: the set speed, as far as it is allowed [rad/s]."""
        return math.copysign(min(abs(self.speed), self.allowed * (1.0 - _ROOM)), self.speed)

    def stop(self, t: float) -> None:
        """
        Come to rest by an ordinary ramp, wherever that is.

        Parameters
        ----------
        t : float
            Time [s].

        """
        if self.mode(t) in (ShaftMode.RUNNING, ShaftMode.STOPPING_AT_CYCLE_END):
            self._motion = self._ramp(t, 0.0)
            self._mode = ShaftMode.STOPPING

    def quick_stop(self, t: float) -> None:
        """
        Come to rest as fast as the quick limits allow; to be reset before the next run.

        Parameters
        ----------
        t : float
            Time [s].

        """
        if self.mode(t) not in (ShaftMode.QUICK_STOPPING, ShaftMode.QUICK_STOPPED):
            self._motion = self._motion.ramped(t, 0.0, self.quick_limits)
            self._mode = ShaftMode.QUICK_STOPPING

    def stop_at_cycle_end(self, t: float) -> None:
        """
        Go on at the set speed and come to rest exactly at the end of a cycle.

        It is the first end at which the shaft can stop from its set speed; a ramp under way is
        finished before.

        Parameters
        ----------
        t : float
            Time [s].

        Raises
        ------
        ShaftError
            When the shaft is not running, or its set speed is zero.

        """
        mode = self.mode(t)
        if mode is ShaftMode.STOPPING_AT_CYCLE_END:
            return
        if mode is not ShaftMode.RUNNING or self.target == 0.0:
            raise ShaftError(f'the shaft is not running ({mode.value}): it cannot stop at the '
                             'end of a cycle')
        self._plan_stop_at_cycle_end(t)
        self._mode = ShaftMode.STOPPING_AT_CYCLE_END

    def _plan_stop_at_cycle_end(self, t: float) -> None:
        speed = self.target
        cruise = self._ramp(t, speed)
        start, cruising = cruise.settled_at, cruise.final
        brake = speed_ramp(speed, 0.0, 0.0, self._softened(cruising, 0.0))
        distance = ShaftMotion(start, cruising, brake).final.phi - cruising.phi
        sense = math.copysign(1.0, speed)
        turns = sense * (cruising.phi + distance) / TURN
        end = sense * math.ceil(turns - _AT_CYCLE_END) * TURN
        wait = max(0.0, (end - cruising.phi - distance) / speed)
        self._motion = cruise.continued([RampStep(wait, 0.0), *brake], ShaftState(end, 0.0, 0.0))

    def reset(self, t: float) -> None:
        """
        Acknowledge a quick stop.

        Parameters
        ----------
        t : float
            Time [s].

        Raises
        ------
        ShaftError
            While the shaft is still turning.

        """
        if self.mode(t) is ShaftMode.QUICK_STOPPING:
            raise ShaftError('the shaft is still turning: reset it when it stands')
        if self.mode(t) is ShaftMode.QUICK_STOPPED:
            self._mode = ShaftMode.STOPPED

    def at_rest(self, phi: float) -> Shaft:
        """
        Make a shaft with the same settings that stands still.

        Parameters
        ----------
        phi : float
            Angle at which it stands [rad].

        Returns
        -------
        Shaft
            The shaft.

        """
        still = Shaft(self.speed, self.limits, self.quick_limits, phi)
        still.allowed, still.room = self.allowed, self.room
        if self._mode is ShaftMode.QUICK_STOPPING:
            still._mode = self._mode  # to be acknowledged all the same
        return still

    def _softened(self, state: ShaftState, target: float) -> RampLimits:
        """Choose the limits of an ordinary ramp so that the axes keep theirs."""
        if not self.room:
            return self.limits
        _, omega, alpha = state
        if omega * target >= 0.0 and abs(omega) <= abs(target):
            return self.room.soften(abs(target), self.limits)  # where it arrives without alpha
        return self.room.soften(max(abs(omega), abs(target)), self.limits, abs(alpha))

    def _ramp(self, t: float, target: float) -> ShaftMotion:
        """Plan an ordinary ramp from an instant on."""
        motion = self._motion
        now = motion.state(t)
        limits = self._softened(now, target)
        if self.room and not leads_to(now.omega, now.alpha, target, limits):
            # The acceleration under way is taken back as it was built up, which the axes had
            # room for: with a softer jerk it would carry the shaft far beyond its speeds.
            motion = motion.released(t)
            t, now = motion.settled_at, motion.final
            limits = self._softened(now, target)
            steps = speed_ramp(now.omega, 0.0, target, limits)
            reached = ShaftMotion(t, now, steps).final
            return motion.continued(steps, ShaftState(reached.phi, target, 0.0))
        return motion.ramped(t, target, limits)
