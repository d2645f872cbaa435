# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A cam shaft in real time: fixed substeps, split wherever the equation of motion has a step."""

from __future__ import annotations

import math
from typing import NamedTuple

from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.shaft_field import Acceleration, compile_field, Torque
from cam_motion.drive.shaft_torque import Command, ShaftTorque
from cam_motion.errors import CamMotionError
from cam_motion.units import TURN

_AT_ONCE = 1e-9  # what happens within this share of a substep happens at its beginning
_NEWTON_STEPS = 6
_PLACED = 1e-18  # events are placed to this [s], or to rounding
_AT_REST = 1e-9  # a shaft that swings to and fro over a step of its load by less [rad] stands
_EVENTS = 1000  # within one substep; a motion with more of them is none


class LiveState(NamedTuple):
    """
    A cam shaft at an instant.

    Angle [rad, unwrapped], speed [rad/s] and acceleration [rad/s²] of the cam shaft; torque of
    the motor, what the gearbox passes on to the cam shaft from motor and brake, what the load
    behind flywheel and gearbox takes, its inertia included, and the torque of the brake, which
    sits on the motor shaft [N m].
    """

    phi: float
    omega: float
    alpha: float
    motor_torque: float
    shaft_torque: float
    load_torque: float
    brake_torque: float


class _Moment(NamedTuple):
    """
    Where the shaft is, and which smooth law holds from there on.

    Turn and angle within it [rad], speed [rad/s], element of the load, sense of turning (0 while
    it stands), whether it is faster than synchronous, and how often it has failed to go on.
    """

    turn: int
    x: float
    w: float
    element: int
    sense: float
    fast: bool
    stops: int


class LiveShaft:
    """
    Motor, gearbox, flywheel and cam load, integrated as time goes by.

    Substeps lie on a fixed grid of the machine's time. What is asked for between two points of
    the grid comes from a shorter step that leaves the grid alone, so that the motion does not
    depend on when, or how often, it is looked at.

    Parameters
    ----------
    drive : CamDrive
        The drive.
    substep_ns : int
        Time from grid point to grid point [ns]; positive.
    brake_torque : float
        Torque of the brake on the motor shaft [N m].
    phi : float
        Angle at which the shaft stands at first, with its brake on [rad].

    Attributes
    ----------
    command : Command
        What the motor shaft has been told last.

    Notes
    -----
    Classical Runge-Kutta of order 4 for J dw/dt = Q(q, w) - C w². A substep ends, and the next
    begins, exactly where an element of the load ends, where the shaft reverses, and where it
    passes the synchronous speed, at which the power in the gearbox changes its direction: in
    between the equation is smooth, and the order is kept.

    A shaft that comes to a stop stands while neither sense of turning would take it along. With
    Coulomb friction, a brake or the losses of a gearbox that is a range of loads, else a point.

    """

    def __init__(self, drive: CamDrive, substep_ns: int, brake_torque: float, phi: float = 0.0,
                 ) -> None:
        """Stand, held by the brake."""
        from scipy.optimize import brentq  # now, not in the middle of a tick
        self._find_root = brentq
        self.command = Command.BRAKE
        self._elements = compile_field(drive)
        self._torque = ShaftTorque(drive, brake_torque)
        self._fixed_inertia = drive.fixed_inertia
        self._step_ns = substep_ns
        self._time_ns = 0  # of the last grid point, or of the last command if that is later
        turn = math.floor(phi / TURN)
        x = phi - turn * TURN
        index = next(k for k, element in enumerate(self._elements) if x <= element.end)
        self._at = self._released(_Moment(turn, x, 0.0, index, 0.0, False, 0))

    @property
    def standing(self) -> bool:
        """Whether the shaft stands, and goes on standing whatever time goes by."""
        return self._at.sense == 0.0

    @property
    def stops(self) -> int:
        """Count how often the motor was on and the shaft came to a stop, or did not start."""
        return self._at.stops

    def tell(self, time_ns: int, command: Command) -> None:
        """
        Switch the motor on or off, or apply the brake.

        Parameters
        ----------
        time_ns : int
            When [ns]; not before the last instant that has been asked for.
        command : Command
            What holds from then on.

        """
        at = self._moment(time_ns)
        self._time_ns = time_ns
        self.command = command
        self._at = at._replace(fast=at.w > self._torque.synchronous)
        if at.w == 0.0:
            self._at = self._released(self._at)
            if command is Command.RUN and self.standing:
                self._at = self._at._replace(stops=at.stops + 1)

    def arrest(self, time_ns: int) -> None:
        """
        Stand where the shaft is, with the brake on, as if it had never turned.

        Parameters
        ----------
        time_ns : int
            When [ns].

        """
        self._at = self._moment(time_ns)._replace(w=0.0, sense=0.0)
        self._time_ns = time_ns
        self.command = Command.BRAKE

    def state(self, time_ns: int) -> LiveState:
        """
        Give the state of the shaft at an instant.

        Parameters
        ----------
        time_ns : int
            Time since the machine's time base began [ns]; not before the last grid point at or
            before what has been asked for so far.

        Returns
        -------
        LiveState
            Where it is, how it moves, and what that takes.

        """
        at = self._moment(time_ns)
        element = self._elements[at.element]
        phi = at.turn * TURN + at.x
        if at.sense == 0.0:
            load = -element.force(at.x)
            held = load / self._torque.ratio if self.command is Command.BRAKE else 0.0
            driven = self._torque.motor(self.command, 1.0, 0.0)
            return LiveState(phi, 0.0, 0.0, driven, load, load, held)
        law = self._torque.law(self.command, at.sense, at.fast)
        alpha = element.acceleration(at.x, at.w, at.sense, law)
        through = law(at.w)
        return LiveState(
            phi, at.w, alpha, self._torque.motor(self.command, at.sense, at.w), through,
            through - self._fixed_inertia * alpha, self._torque.brake(self.command, at.sense))

    def _moment(self, time_ns: int) -> _Moment:
        """Advance to the last grid point, and look ahead from there."""
        if self._at.sense == 0.0:
            return self._at
        step = self._step_ns
        following = (self._time_ns // step + 1) * step
        while following <= time_ns:
            self._at = self._integrated(self._at, 1e-9 * (following - self._time_ns))
            self._time_ns = following
            following += step
        if time_ns == self._time_ns:
            return self._at
        return self._integrated(self._at, 1e-9 * (time_ns - self._time_ns))

    def _integrated(self, at: _Moment, duration: float) -> _Moment:
        """Go on for some time, from event to event."""
        left = duration
        for _ in range(_EVENTS):
            if at.sense == 0.0:
                return at
            law = self._torque.law(self.command, at.sense, at.fast)
            acceleration = self._elements[at.element].acceleration
            x, w = _step(acceleration, left, at.x, at.w, at.sense, law)
            margins = self._margins(at, x, w)
            if max(margins) <= 0.0:
                return _Moment(at.turn, x, w, at.element, at.sense, at.fast, at.stops)
            elapsed, event = min(
                (self._when(at, left, law, number), number)
                for number, margin in enumerate(margins) if margin > 0.0)
            x, w = _step(acceleration, elapsed, at.x, at.w, at.sense, law)
            at = self._after(at._replace(x=x, w=w), event)
            left -= elapsed
            if left <= 0.0:
                return at
        raise CamMotionError(
            f'the load at {at.x:.9g} rad lets the shaft neither stand nor turn')

    def _margins(self, at: _Moment, x: float, w: float) -> tuple[float, float, float]:
        """Say by how much the end of the element, rest and the synchronous speed are passed."""
        element = self._elements[at.element]
        beyond = x - element.end if at.sense > 0.0 else element.start - x
        above = w - self._torque.synchronous
        if self.command is not Command.RUN or at.sense < 0.0:
            return beyond, -at.sense * w, 0.0
        return beyond, -at.sense * w, -above if at.fast else above

    def _when(self, at: _Moment, left: float, law: Torque, event: int) -> float:
        """Find how long it takes to an event that comes within the time left."""
        acceleration = self._elements[at.element].acceleration

        def margin(time: float) -> float:
            state = _step(acceleration, time, at.x, at.w, at.sense, law)
            return self._margins(at, *state)[event]
        soon = _AT_ONCE * left
        if event == 0:
            # the angle rises by the speed: Newton's method needs but two or three steps
            time = left
            for _ in range(_NEWTON_STEPS):
                state = _step(acceleration, time, at.x, at.w, at.sense, law)
                rate = at.sense * state[1]
                if rate <= 0.0:
                    break
                change = self._margins(at, *state)[0] / rate
                time -= change
                if not soon < time <= left:
                    break
                if abs(change) <= soon:
                    return time
        if margin(soon) > 0.0:
            return 0.0
        return float(self._find_root(margin, soon, left, xtol=_PLACED))

    def _after(self, at: _Moment, event: int) -> _Moment:
        """Go on from an event: the end of an element, rest, or the synchronous speed."""
        if event == 1:
            stops = at.stops + (self.command is Command.RUN)
            return self._released(at._replace(w=0.0, stops=stops))
        if event == 2:
            return at._replace(w=self._torque.synchronous, fast=not at.fast)
        element = self._elements[at.element]
        at = self._facing(
            at._replace(x=element.end if at.sense > 0.0 else element.start), at.sense)
        law = self._torque.law(self.command, at.sense, at.fast)
        alpha = self._elements[at.element].acceleration(at.x, at.w, at.sense, law)
        if alpha * at.sense < 0.0 and at.w * at.w < -2.0 * _AT_REST * alpha * at.sense:
            still = self._released(at._replace(w=0.0))
            return still if still.sense == 0.0 else at
        return at

    def _facing(self, at: _Moment, sense: float) -> _Moment:
        """Choose the element ahead of a shaft that is at the end of one."""
        elements = self._elements
        if sense > 0.0 and at.x == elements[at.element].end:
            if at.element + 1 < len(elements):
                return at._replace(element=at.element + 1)
            return at._replace(turn=at.turn + 1, x=0.0, element=0)
        if sense < 0.0 and at.x == elements[at.element].start:
            if at.element > 0:
                return at._replace(element=at.element - 1)
            return at._replace(turn=at.turn - 1, x=TURN, element=len(elements) - 1)
        return at

    def _released(self, at: _Moment) -> _Moment:
        """Let a shaft without speed go where its load and its motor take it, if anywhere."""
        for sense in (1.0, -1.0):
            ahead = self._facing(at, sense)._replace(sense=sense, fast=False)
            law = self._torque.law(self.command, sense, fast=False)
            element = self._elements[ahead.element]
            if sense * element.acceleration(ahead.x, 0.0, sense, law) > 0.0:
                return ahead
        return at._replace(sense=0.0)


def _step(acceleration: Acceleration, h: float, x: float, w: float, sense: float, law: Torque,
          ) -> tuple[float, float]:
    """Carry out one step of the classical Runge-Kutta method."""
    half = 0.5 * h
    a1 = acceleration(x, w, sense, law)
    w2 = w + half * a1
    a2 = acceleration(x + half * w, w2, sense, law)
    w3 = w + half * a2
    a3 = acceleration(x + half * w2, w3, sense, law)
    w4 = w + h * a3
    a4 = acceleration(x + h * w3, w4, sense, law)
    return (x + h * (w + 2.0 * (w2 + w3) + w4) / 6.0,
            w + h * (a1 + 2.0 * (a2 + a3) + a4) / 6.0)
