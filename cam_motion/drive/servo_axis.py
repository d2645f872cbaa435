# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A servo drive in motion: setpoints in, the motion that motor and load really make out."""

from __future__ import annotations

import math
from typing import NamedTuple

from cam_motion.drive.inverse import DriveState, FollowerDrive
from cam_motion.drive.load import Spring
from cam_motion.drive.rigid_drive import RigidDrive
from cam_motion.drive.servo_loop import ServoLoop
from cam_motion.drive.servo_motor import ServoMotor
from cam_motion.drive.servo_tally import ServoTally
from cam_motion.drive.set_motion import NANOSECOND, SetMotion, Setpoint, stop_from
from cam_motion.errors import ConfigurationError, Problem

SUBSTEP_NS = 250_000
"""Substep of a servo drive unless given [ns]: the position loops of today's drives."""

COARSEST = 0.5
"""Largest product of substep and velocity gain over inertia [-]; at 2 the loop is unstable."""

STIFFEST = 1.0
"""Largest product of substep and natural frequency on springs [-]; at 2 it is unstable."""

BRAKING_SHARE = 0.5
"""Share of the peak torque with which a large position error is taken to be braked."""


class ServoState(NamedTuple):
    """
    What a servo drive does at an instant.

    Time on the machine's time base [ns], motion and torque of both shafts, position, velocity
    and acceleration of the axis [unit, unit/s, unit/s²], and the following error: set minus
    actual position [unit].
    """

    time_ns: int
    drive: DriveState
    position: float
    velocity: float
    acceleration: float
    following_error: float


class ServoAxis:
    """
    A motor that moves an axis through a gearbox, under a digital position and velocity loop.

    Parameters
    ----------
    drive : FollowerDrive
        Gearbox and load; its motor inertia is everything on the motor shaft, the rotor included.
    motor : ServoMotor
        The motor with its limits.
    loop : ServoLoop
        The gains.
    substep_ns : int
        Period of the loop [ns].
    thermal_time : float
        Time constant of the running means of torque and speed [s].

    Raises
    ------
    ConfigurationError
        When there is no inertia to move, or the substep is too long for the gains.

    Notes
    -----
    The loop samples at whole multiples of its period on the machine's time base, whatever
    instants it is asked for, and its torque stands for one period; within the period the motion
    is that of a constant torque, in closed form. Between two setpoints the set motion is
    `SetMotion`. The feed-forward is that of the middle of the period, where a torque that
    stands for the period belongs. So two streams of setpoints at different rates with the same
    motion between them give the same motion of the axis at common times, to rounding.

    What the parts of a load take changes with place, velocity and shaft angle. It stands for one
    period too, at the place where half a period at the present velocity leads: of order two, and
    without gain or loss of energy in a spring.

    A large position error is taken away no faster than half of the peak torque can brake, or the
    axis would overrun its set position after every overload. The velocity asked for is limited
    to the largest speed of the motor; while it is, no acceleration is fed forward. The torque is
    limited to the peak torque at the speed of the moment. While it is, the integral part goes on
    only if that leads away from the limit.

    References
    ----------
    K. J. Astrom and L. Rundqwist, Integrator windup and how to avoid it, American Control
    Conference 1989 (conditional integration). M. L. Workman, Adaptive proximate time-optimal
    servomechanisms, Stanford University 1987 (the braking curve with its linear end).

    """

    def __init__(self, drive: FollowerDrive, motor: ServoMotor, loop: ServoLoop,
                 substep_ns: int = SUBSTEP_NS, thermal_time: float = 60.0) -> None:
        """Stand at 0 at the beginning of time."""
        self._drive, self._loaded = drive, bool(drive.parts)
        self._rigid = RigidDrive.of(drive)
        self._motor, self._loop = motor, loop
        self._substep_ns = substep_ns
        self._substep = substep_ns * NANOSECOND
        self._scale = drive.gear_ratio / drive.radius  # motor shaft per axis [rad/unit]
        self._ratio = drive.gear_ratio
        self._thermal_time = thermal_time
        self._inertia = inertia = self._rigid.motor_inertia + self._rigid.load_inertia
        if not inertia > 0.0:
            raise ConfigurationError([Problem(
                'motor_inertia', drive.motor_inertia, 'a servo drive needs an inertia to move')])
        stiffness = sum(part.stiffness for part in drive.parts if isinstance(part, Spring))
        swing = math.sqrt(stiffness / inertia) / self._scale  # natural frequency [rad/s]
        if swing * self._substep > STIFFEST:
            raise ConfigurationError([Problem(
                'substep', self._substep, f'must be at most {STIFFEST / swing:.3g} s for springs '
                f'of {stiffness:.6g} N/m on {inertia:.6g} kg m²',
                'a shorter substep or softer springs')])
        if loop.velocity_gain / inertia * self._substep > COARSEST:
            most = COARSEST * inertia / loop.velocity_gain
            raise ConfigurationError([Problem(
                'substep', self._substep,
                f'must be at most {most:.3g} s for a velocity gain of {loop.velocity_gain:.6g} '
                f'N m s/rad on {inertia:.6g} kg m²', 'a shorter substep or a smaller bandwidth')])
        self.start(Setpoint(0, 0.0))

    def start(self, at: Setpoint) -> ServoState:
        """
        Begin anew on a setpoint, moving as it says.

        Parameters
        ----------
        at : Setpoint
            The setpoint.

        Returns
        -------
        ServoState
            The drive on it.

        """
        self.time_ns = at.time_ns
        self._last = at  # the set motion up to now
        self._rest: SetMotion | None = None  # by which the set motion comes to rest
        self._error = 0.0  # following error at the last sample of the loop [unit]
        self._position = at.position * self._scale
        self._velocity = at.velocity * self._scale
        self._integral = 0.0
        self._saturated = False
        if self._loaded:
            self._rigid = self._load_at(at.position, at.shaft_angle, self._velocity, 0.0)
        self._torque, _ = self._limited(
            self._rigid.torque(self._velocity, at.acceleration * self._scale))
        self.reset_tally()
        return self.state()

    def reset_tally(self) -> None:
        """Count from now on."""
        self.tally = ServoTally(self._motor, self._thermal_time)

    def follow(self, to: Setpoint, budget_ns: int | None = None) -> ServoState:
        """
        Move along the set motion to the next setpoint.

        Parameters
        ----------
        to : Setpoint
            The setpoint. One that is not later than what has been integrated moves nothing;
            the set motion then goes on from it.
        budget_ns : int, optional
            The most time to integrate [ns]. What lies before it is dropped: over that time the
            drive is taken to follow with the following error that it had, and the time is
            counted.

        Returns
        -------
        ServoState
            The drive at that instant.

        """
        if to.time_ns > self._last.time_ns:
            motion = SetMotion(self._last, to)
            if budget_ns is not None and to.time_ns - self.time_ns > budget_ns:
                self._drop(motion, to.time_ns - budget_ns)
            self._integrate(motion, to.time_ns)
        self._last = to
        self._rest = None
        return self.state()

    def come_to_rest(self, duration_ns: int) -> None:
        """
        Let the set motion come to rest, as nobody says how it goes on; `advance` moves it on.

        Parameters
        ----------
        duration_ns : int
            How long coming to rest takes [ns].

        """
        rest = stop_from(self._last, duration_ns)
        if (self._last.velocity, self._last.acceleration) == (0.0, 0.0):
            rest = rest._replace(position=self._last.position)
        self._rest = SetMotion(self._last, rest)

    def advance(self, time_ns: int) -> ServoState:
        """
        Move along a set motion that comes to rest.

        Parameters
        ----------
        time_ns : int
            Until when [ns].

        Returns
        -------
        ServoState
            The drive at that instant.

        """
        if self._rest is not None and time_ns > self.time_ns:
            self._integrate(self._rest, time_ns)
            self._last = Setpoint(time_ns, *self._rest.at(time_ns)[:3],
                                  self._rest.shaft_angle(time_ns))
        return self.state()

    def state(self) -> ServoState:
        """
        Tell what the drive does now.

        Returns
        -------
        ServoState
            With the torque that has acted up to now.

        """
        rigid, scale, ratio = self._rigid, self._scale, self._ratio
        rate = rigid.acceleration(self._torque, self._velocity)
        shafts = DriveState(
            self._position, self._velocity, self._torque,
            self._position / ratio, self._velocity / ratio,
            ratio * rigid.load_torque(self._torque, self._velocity))
        position = self._position / scale
        return ServoState(self.time_ns, shafts, position, self._velocity / scale, rate / scale,
                          self._last.position - position)

    def _integrate(self, motion: SetMotion, end_ns: int) -> None:
        """Move on to an instant, which need not lie on the grid of the loop."""
        period = self._substep_ns
        while self.time_ns < end_ns:
            if self.time_ns % period == 0:
                self._control(motion)
            stop = min((self.time_ns // period + 1) * period, end_ns)
            span = stop - self.time_ns
            move = self._rigid.move(
                self._position, self._velocity, self._torque, span * NANOSECOND)
            self._position, self._velocity = move.position, move.velocity
            self.tally.note_move(self._torque, move, span, self._saturated, self._error)
            self.time_ns = stop

    def _control(self, motion: SetMotion) -> None:
        """Sample, and set the torque for the period that begins."""
        loop, scale, half = self._loop, self._scale, 0.5 * self._substep
        wanted = motion.at(self.time_ns)
        set_velocity = wanted.velocity * scale
        if self._loaded:
            shaft_angle = motion.shaft_angle(self.time_ns + self._substep_ns // 2)
            self._rigid = self._load_at((self._position + half * self._velocity) / scale,
                                        shaft_angle, self._velocity, half)
        error = wanted.position * scale - self._position
        self._error = error / scale
        asked = loop.velocity_feed_forward * set_velocity + self._approach(error)
        fastest = self._motor.max_speed
        at_speed_limit = abs(asked) > fastest
        if at_speed_limit:
            asked = fastest if asked > 0.0 else -fastest
            forward = self._rigid.torque(asked, 0.0)
        else:
            rate, jerk = wanted.acceleration * scale, wanted.jerk * scale
            middle = set_velocity + half * (rate + 0.5 * half * jerk)
            rigid = self._rigid
            if self._loaded:
                ahead = half * (wanted.velocity + 0.5 * half * wanted.acceleration)
                rigid = self._load_at(wanted.position + ahead, shaft_angle, middle, 0.0)
            forward = rigid.torque(middle, rate + half * jerk)
        deviation = asked - self._velocity
        torque = (loop.torque_feed_forward * forward
                  + loop.velocity_gain * (deviation + self._integral))
        self._torque, at_torque_limit = self._limited(torque)
        if not at_torque_limit or (torque - self._torque) * deviation < 0.0:
            self._integral += deviation * self._substep / loop.integral_time
        saturated = at_torque_limit or at_speed_limit
        self.tally.note_torque(self._torque, saturated and not self._saturated)
        self._saturated = saturated

    def _load_at(self, position: float, shaft_angle: float, velocity: float, ahead: float,
                 ) -> RigidDrive:
        """Reduce the drive at a place; one where the load is not defined changes nothing."""
        found = RigidDrive.of(self._drive, position, shaft_angle, velocity, ahead)
        return found if math.isfinite(found.load_inertia + found.pull) else self._rigid

    def _approach(self, error: float) -> float:
        """Give the velocity that takes a position error away and can be braked in time."""
        gain = self._loop.position_gain
        asked = gain * error
        braking = BRAKING_SHARE * self._motor.peak(self._velocity) / self._inertia
        if abs(asked) * gain <= braking:
            return asked
        fastest = math.sqrt(braking * (2.0 * abs(error) - braking / (gain * gain)))
        return fastest if error > 0.0 else -fastest

    def _limited(self, torque: float) -> tuple[float, bool]:
        """Cut a torque to what the motor gives, and tell whether that was needed."""
        speed = self._velocity
        drives = torque * speed >= 0.0
        most = self._motor.peak_torque(speed) if drives else self._motor.peak(speed)
        if abs(torque) <= most:
            return torque, False
        return (most if torque > 0.0 else -most), True

    def _drop(self, motion: SetMotion, until_ns: int) -> None:
        """Leave out time: the drive stands to its set motion after it as it did before."""
        period = self._substep_ns
        until_ns = min(-(-until_ns // period) * period, motion.last.time_ns)  # samples at once
        before, after = motion.at(self.time_ns), motion.at(until_ns)
        self._position += (after.position - before.position) * self._scale
        self._velocity += (after.velocity - before.velocity) * self._scale
        self.tally.dropped_ns += until_ns - self.time_ns
        self.time_ns = until_ns
