# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Motor, gearbox and load as one rigid mass at the motor shaft: from torque to motion and back."""

from __future__ import annotations

from typing import NamedTuple

from cam_motion.drive.axis_load import UNKNOWN
from cam_motion.drive.inverse import FollowerDrive

# At rest, a net torque below this share of those that act is what rounding left of a balance.
_ROUNDING = 1e-12


class Move(NamedTuple):
    """
    What a constant torque does within a time.

    Position [rad] and velocity [rad/s] at its end, and the travel [rad] before and after the
    shaft comes to rest within it (all of it before, if it does not).
    """

    position: float
    velocity: float
    before: float
    after: float


class RigidDrive(NamedTuple):
    """
    A drive without play or spring, every figure reduced to the motor shaft.

    Attributes
    ----------
    motor_inertia, load_inertia : float
        Inertias before and behind the losses of the gearbox [kg m²].
    friction : float
        Coulomb friction [N m], not negative: a torque against the motion, which holds the drive
        at rest as long as nothing exceeds it.
    pull : float
        Torque against the positive direction, in motion and at rest [N m].
    efficiency : float
        Efficiency of the gearbox [-], in the direction in which power flows.

    Notes
    -----
    The load takes L = J_l a + pull + friction sign(w) from the gearbox, and the motor gives
    T = J_m a + L / efficiency where power flows to the load (L w >= 0), J_m a + L * efficiency
    where it flows back: the equation of `FollowerDrive`, solved for the acceleration. T rises
    with a, so that there is exactly one solution; at rest it is standstill for all torques
    between those that start the drive forwards and backwards. A worm gear's self-locking is not
    in this equation: an efficiency below one half does not lock.

    """

    motor_inertia: float
    load_inertia: float
    friction: float = 0.0
    pull: float = 0.0
    efficiency: float = 1.0

    @classmethod
    def of(cls, drive: FollowerDrive, position: float = 0.0, shaft_angle: float = UNKNOWN,
           velocity: float = 0.0, ahead: float = 0.0) -> RigidDrive:
        """
        Reduce a drive to its motor shaft, at a place and a velocity of its load.

        Parameters
        ----------
        drive : FollowerDrive
            The drive.
        position : float
            Position of the axis [unit].
        shaft_angle : float
            Angle of the master shaft [rad]; see `FollowerDrive.law`.
        velocity : float
            Of the motor shaft [rad/s].
        ahead : float
            How long the velocity will have changed [s] when what depends on it is to be right:
            half a step, for a mean over the step.

        Returns
        -------
        RigidDrive
            With the same torque for the same motion there.

        """
        inertia, centripetal, damping, pull, friction = drive.law(position, shaft_angle)
        ratio = drive.gear_ratio
        damping /= ratio * ratio
        swept = (centripetal / ratio ** 3 * velocity + damping) * velocity
        # D (w + a t) is an inertia D t and a pull D w: implicit, so that no damping is too large
        return cls(drive.motor_inertia, inertia / ratio ** 2 + damping * ahead, friction / ratio,
                   pull / ratio + swept, drive.efficiency)

    def torque(self, velocity: float, acceleration: float) -> float:
        """
        Compute the torque that a motion takes.

        Parameters
        ----------
        velocity, acceleration : float
            Of the motor shaft [rad/s, rad/s²].

        Returns
        -------
        float
            Torque of the motor [N m].

        """
        sense = (velocity > 0.0) - (velocity < 0.0)
        load = self.load_inertia * acceleration + self.pull + self.friction * sense
        through = load / self.efficiency if load * velocity >= 0.0 else load * self.efficiency
        return self.motor_inertia * acceleration + through

    def acceleration(self, torque: float, velocity: float) -> float:
        """
        Compute the acceleration that a torque gives.

        Parameters
        ----------
        torque : float
            Torque of the motor [N m].
        velocity : float
            Velocity of the motor shaft [rad/s]; at 0 the drive may stick.

        Returns
        -------
        float
            Acceleration of the motor shaft [rad/s²].

        """
        if velocity != 0.0:
            return self._moving(torque, 1.0 if velocity > 0.0 else -1.0)
        least = (_ROUNDING * (abs(torque) + self.friction + abs(self.pull))
                 / (self.motor_inertia + self.load_inertia))
        if (forwards := self._moving(torque, 1.0)) > least:
            return forwards
        backwards = self._moving(torque, -1.0)
        return backwards if backwards < -least else 0.0

    def _moving(self, torque: float, sense: float) -> float:
        """Solve for the acceleration of a drive that moves, or begins to, in a given sense."""
        resistance = self.pull + self.friction * sense
        share = self.efficiency
        driven = ((torque * share - resistance)
                  / (self.load_inertia + self.motor_inertia * share))
        if (self.load_inertia * driven + resistance) * sense >= 0.0:
            return driven
        return (torque - resistance * share) / (self.motor_inertia + self.load_inertia * share)

    def load_torque(self, torque: float, velocity: float) -> float:
        """
        Compute what the gearbox gives to the load.

        Parameters
        ----------
        torque : float
            Torque of the motor [N m].
        velocity : float
            Velocity of the motor shaft [rad/s].

        Returns
        -------
        float
            Torque reduced to the motor shaft [N m].

        """
        acceleration = self.acceleration(torque, velocity)
        moving = velocity if velocity != 0.0 else acceleration
        if moving != 0.0:
            sense = 1.0 if moving > 0.0 else -1.0
            return self.load_inertia * acceleration + self.pull + self.friction * sense
        # held, by friction of the load or in the gearbox
        least, most = self.pull - self.friction, self.pull + self.friction
        return min(max(torque * self.efficiency, least), most)

    def move(self, position: float, velocity: float, torque: float, time: float) -> Move:
        """
        Let a constant torque act.

        Parameters
        ----------
        position, velocity : float
            Of the motor shaft at the beginning [rad, rad/s].
        torque : float
            Torque of the motor [N m].
        time : float
            How long [s].

        Returns
        -------
        Move
            The motion in closed form: where the shaft comes to rest on the way, it stays there
            or turns back from that instant on.

        """
        rate = self.acceleration(torque, velocity)
        last = velocity + rate * time
        # by sign, as a product of small numbers may vanish
        if velocity == 0.0 or (last != 0.0 and (last > 0.0) is (velocity > 0.0)):
            travel = time * (velocity + 0.5 * rate * time)
            return Move(position + travel, last, travel, 0.0)
        before = -0.5 * velocity * velocity / rate
        left = time + velocity / rate
        rate = self.acceleration(torque, 0.0)
        after = 0.5 * rate * left * left
        return Move(position + before + after, rate * left, before, after)
