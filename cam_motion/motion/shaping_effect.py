# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a filter over a cam does to the vibration of its load, before and after."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
import math

from cam_motion.motion.piece import Array
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.shaped_profile import Movement, movements, ShapedProfile
from cam_motion.motion.superposition import window
from cam_motion.motion.vibration import pole, residual_amplitude, Response
import numpy as np
from numpy.typing import ArrayLike

ERRORS = (-0.2, -0.1, 0.1, 0.2)
"""By how much (relative) the frequency is taken to be wrong where robustness is told."""


@dataclass(frozen=True)
class Load:
    """
    What swings behind an axis.

    Attributes
    ----------
    frequency : float
        Undamped natural frequency [rad/s]; above 0.
    damping : float
        Damping ratio [-], from 0 to below 1.
    factor : float
        What is reported per deviation of the load [-]: 1, or the height of a wave at the wall.

    """

    frequency: float
    damping: float = 0.0
    factor: float = 1.0


@dataclass(frozen=True)
class MovementEffect:
    """
    The vibration that one movement causes in a load that is at rest before.

    Attributes
    ----------
    profile : CamProfile
        The cam, shaped or not.
    movement : Movement
        The movement, as it is without a filter.
    load : Load
        The load.

    """

    profile: CamProfile
    movement: Movement
    load: Load

    @property
    def name(self) -> str:
        """Names of its segments, joined."""
        return '+'.join(self.movement.segments)

    def residual(self, speed: ArrayLike, error: float = 0.0, shaped: bool = True) -> Array:
        """
        Find the amplitude that is left when the movement has ended, the shaped one later.

        Parameters
        ----------
        speed : array_like, any shape
            Speeds of the cam [rad/s]; above 0.
        error : float
            By how much the frequency of the load is higher than assumed (relative).
        shaped : bool
            Whether with the filter of the cam, if it has one.

        Returns
        -------
        ndarray, shape of speed
            Amplitudes, in the unit of the axis.

        """
        speeds = np.asarray(speed, dtype=float)
        cam, load = self.profile, self.load
        original, gain = cam, np.ones_like(speeds)
        frequency = load.frequency * (1.0 + error)
        if isinstance(cam, ShapedProfile):
            original = cam.shortened
            if shaped:
                # in angles the filter stays what it was made for, whatever the speed is
                gain = np.abs(cam.filter.transfer(
                    pole(frequency * cam.speed / speeds, load.damping)))
            else:
                original = cam.original
        curve = window(original.curve, original.advance, *self._range(original))
        left = residual_amplitude(curve, frequency / speeds, load.damping)
        return np.asarray(load.factor * gain * left)

    def _range(self, original: CamProfile) -> tuple[float, float]:
        """Give where the movement begins and ends on the cam before the filter [rad]."""
        for each in movements(original):
            if each.segments == self.movement.segments:
                return each.start, each.end
        return self.movement.start, self.movement.end

    def response(self, speed: float) -> Response:
        """
        Follow the load through the movement, at rest before.

        Parameters
        ----------
        speed : float
            Speed of the cam [rad/s]; above 0.

        Returns
        -------
        Response
            Its deviation over the angle of the cam, until the next movement begins; to be
            multiplied by the factor of the load.

        """
        start, end = self.movement.start, self.movement.end
        if isinstance(self.profile, ShapedProfile) and not self.profile.fit:
            end += self.profile.filter.duration * self.profile.speed
        curve = window(self.profile.curve, self.profile.advance, start, end)
        return Response(curve, self.load.frequency / speed, self.load.damping)


@dataclass(frozen=True)
class Effect:
    """
    The vibration that a cam causes in a load.

    Attributes
    ----------
    profile : CamProfile
        The cam, shaped or not.
    load : Load
        The load.
    speed : float
        Speed of the cam [rad/s]; above 0.

    """

    profile: CamProfile
    load: Load
    speed: float

    @cached_property
    def movements(self) -> tuple[MovementEffect, ...]:
        """Movements of the cam, one by one."""
        return tuple(MovementEffect(self.profile, movement, self.load)
                     for movement in movements(self.profile))

    @cached_property
    def repeated_peak(self) -> float:
        """
        Largest deviation when the cycle has been repeated for long, in the unit of the axis.

        Infinite where a load without damping is in resonance with the cycle.
        """
        cycle = Response(self.profile.curve, self.load.frequency / self.speed,
                         self.load.damping).repeated
        if not np.isfinite(cycle.before):
            return math.inf
        return abs(cycle.peak.value) * self.load.factor
