# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The control loop of a servo drive: position, velocity and feed-forward in cascade."""

from __future__ import annotations

from dataclasses import dataclass
import math

from cam_motion.errors import ConfigurationError, Problem

INTEGRAL_SHARE = 0.25
"""Corner of the velocity controller's integral part, as a share of the bandwidth."""

POSITION_SHARE = 0.25
"""Gain of the position controller, as a share of the bandwidth."""


@dataclass(frozen=True)
class ServoLoop:
    """
    The gains of a position controller over a proportional-integral velocity controller.

    Attributes
    ----------
    position_gain : float
        Velocity asked for per position error, the K_v factor [1/s].
    velocity_gain : float
        Torque per velocity error at the motor shaft [N m s/rad].
    integral_time : float
        Integral time of the velocity controller [s]; infinite switches the integral off.
    velocity_feed_forward, torque_feed_forward : float
        Share of the set velocity, and of the torque that the set motion takes, that is fed
        forward [-], 0 to 1.

    Raises
    ------
    ConfigurationError
        When a gain is out of range; all problems are listed.

    """

    position_gain: float
    velocity_gain: float
    integral_time: float
    velocity_feed_forward: float = 1.0
    torque_feed_forward: float = 1.0

    def __post_init__(self) -> None:
        """Refuse gains that make no loop."""
        problems = [
            Problem(name, value, 'must be a finite number above 0')
            for name in ('position_gain', 'velocity_gain')
            if not (math.isfinite(value := getattr(self, name)) and value > 0.0)]
        if not self.integral_time > 0.0:
            problems.append(Problem('integral_time', self.integral_time, 'must be above 0'))
        problems += [
            Problem(name, value, 'must be from 0 to 1')
            for name in ('velocity_feed_forward', 'torque_feed_forward')
            if not 0.0 <= (value := getattr(self, name)) <= 1.0]
        if problems:
            raise ConfigurationError(problems)

    @classmethod
    def for_bandwidth(cls, bandwidth: float, inertia: float, *,
                      position_gain: float | None = None, velocity_gain: float | None = None,
                      integral_time: float | None = None, velocity_feed_forward: float = 1.0,
                      torque_feed_forward: float = 1.0) -> ServoLoop:
        """
        Choose gains by the bandwidth of the velocity loop.

        Parameters
        ----------
        bandwidth : float
            Crossover frequency of the open velocity loop [rad/s].
        inertia : float
            All inertia, reduced to the motor shaft [kg m²].
        position_gain, velocity_gain, integral_time : float, optional
            Gains to take as they are.
        velocity_feed_forward, torque_feed_forward : float
            As the attributes.

        Returns
        -------
        ServoLoop
            Velocity gain J w_c, integral time 4 / w_c, position gain w_c / 4.

        Notes
        -----
        An inertia under the gain J w_c has the open loop w_c / s. The integral time is that of
        the symmetrical optimum with a = 4 (a crossover a times below the corner of what the
        loop leaves out and a times above that of the integral part: phase margin 62 degrees);
        the position loop is as far from the velocity loop. The closed loop is
        s³ + w_c s² + w_c²/2 s + w_c³/16; its least damping ratio is 0.69.

        References
        ----------
        C. Kessler, Das symmetrische Optimum, Regelungstechnik 6 (1958); W. Leonhard, Control of
        Electrical Drives, on cascaded position control.

        """
        return cls(
            POSITION_SHARE * bandwidth if position_gain is None else position_gain,
            bandwidth * inertia if velocity_gain is None else velocity_gain,
            1.0 / (INTEGRAL_SHARE * bandwidth) if integral_time is None else integral_time,
            velocity_feed_forward, torque_feed_forward)
