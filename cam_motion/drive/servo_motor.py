# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A servo motor by its torque over speed: what it gives for a moment, and what for good."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
import math
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.units import RPM
import numpy as np


@dataclass(frozen=True)
class TorqueLimit:
    """
    A torque that a motor can give, linear over the magnitude of its speed between given points.

    Attributes
    ----------
    speeds : tuple[float, ...]
        Speeds [rad/s], the first 0, rising; beyond the last the torque stays as it is there.
    torques : tuple[float, ...]
        Torque at each speed [N m]; not negative.

    Raises
    ------
    ConfigurationError
        When the points make no curve; all problems are listed.

    """

    speeds: tuple[float, ...]
    torques: tuple[float, ...]

    def __post_init__(self) -> None:
        """Take lists as well, and refuse points that make no curve."""
        for name in ('speeds', 'torques'):
            object.__setattr__(self, name, tuple(float(x) for x in getattr(self, name)))
        problems = []
        if not self.speeds:
            problems.append(Problem('speeds', [], 'must hold at least one point'))
        elif not (self.speeds[0] == 0.0 and math.isfinite(self.speeds[-1])
                  and all(a < b for a, b in pairwise(self.speeds))):
            problems.append(Problem(
                'speeds', list(self.speeds), 'must begin at 0 and rise from point to point'))
        if not all(math.isfinite(torque) and torque >= 0.0 for torque in self.torques):
            problems.append(Problem(
                'torques', list(self.torques), 'every torque must be a finite number, at least 0'))
        if len(self.speeds) != len(self.torques):
            problems.append(Problem(
                'torques', list(self.torques),
                f'must hold one torque per speed: there are {len(self.speeds)} speeds'))
        if problems:
            raise ConfigurationError(problems)

    def __call__(self, speed: Any) -> Any:
        """
        Read the curve.

        Parameters
        ----------
        speed : float or ndarray
            Speed [rad/s]; only its magnitude counts.

        Returns
        -------
        float or ndarray
            Torque [N m], of the shape of the speed.

        """
        if isinstance(speed, np.ndarray):
            return np.interp(np.abs(speed), self.speeds, self.torques)
        speeds, torques, speed = self.speeds, self.torques, abs(speed)
        at = bisect_right(speeds, speed)
        if at == len(speeds):
            return torques[-1]
        share = (speed - speeds[at - 1]) / (speeds[at] - speeds[at - 1])
        return torques[at - 1] + share * (torques[at] - torques[at - 1])


@dataclass(frozen=True)
class ServoMotor:
    """
    A servo motor with its drive, by peak and continuous torque over speed.

    Attributes
    ----------
    peak : TorqueLimit
        The most that motor and drive give for a moment.
    continuous : TorqueLimit
        What the motor stands for good (duty S1) at a steady speed.
    inertia : float
        Inertia of the rotor [kg m²].
    max_speed : float
        Speed above which the motor drives no more, by its voltage or its bearings [rad/s].
    rated_speed : float
        Speed of the name plate [rad/s].
    torque_constant : float | None
        Torque per current [N m/A], where it is known.

    Raises
    ------
    ConfigurationError
        When the figures make no motor; all problems are listed.

    Notes
    -----
    The limits hold in all four quadrants: braking, the motor gives as much as driving. In truth
    the voltage allows somewhat more then; catalogues do not say how much.

    """

    peak: TorqueLimit
    continuous: TorqueLimit
    inertia: float
    max_speed: float
    rated_speed: float
    torque_constant: float | None = None

    def __post_init__(self) -> None:
        """Refuse figures that make no motor."""
        problems = [
            Problem(name, value, 'must be a finite number above 0')
            for name in ('inertia', 'max_speed', 'rated_speed', 'torque_constant')
            if (value := getattr(self, name)) is not None
            and not (math.isfinite(value) and value > 0.0)
        ]
        if not problems and self.rated_speed > self.max_speed:
            problems.append(Problem(
                'rated_speed', self.rated_speed, f'must be at most max_speed, {self.max_speed:g}'))
        if not self.peak(0.0) > 0.0:
            problems.append(Problem(
                'peak.torques', list(self.peak.torques), 'the peak torque at rest must be above 0',
                'without it the motor never starts'))
        corners = sorted({*self.peak.speeds, *self.continuous.speeds})
        below = [speed for speed in corners if self.peak(speed) < self.continuous(speed)]
        if below:
            problems.append(Problem(
                'continuous.torques', list(self.continuous.torques),
                'the continuous torque must be at most the peak torque, at every speed',
                f'at {below[0] / RPM:g} rpm it is {self.continuous(below[0]):g} N m against '
                f'{self.peak(below[0]):g} N m'))
        if problems:
            raise ConfigurationError(problems)

    @classmethod
    def from_plate(
        cls, *, standstill_torque: float, rated_torque: float, rated_speed: float,
        peak_torque: float, max_speed: float, inertia: float, corner_speed: float | None = None,
        torque_constant: float | None = None,
    ) -> ServoMotor:
        """
        Draw the curves of a motor of which only the figures of its plate are known.

        Parameters
        ----------
        standstill_torque, rated_torque : float
            Continuous torque at rest and at rated speed [N m].
        rated_speed : float
            Rated speed [rad/s].
        peak_torque : float
            Largest torque [N m], held up to ``corner_speed``.
        max_speed : float
            Largest speed [rad/s].
        inertia : float
            Inertia of the rotor [kg m²].
        corner_speed : float, optional
            Speed up to which the peak torque is held [rad/s]; the rated speed where not given.
        torque_constant : float, optional
            Torque per current [N m/A].

        Returns
        -------
        ServoMotor
            With a continuous torque that falls linearly from rest to rated speed and on to the
            rated power at the largest speed, and a peak torque that falls linearly from the
            corner to the rated torque at the largest speed.

        Raises
        ------
        ConfigurationError
            When the figures make no motor; all problems are listed.

        Notes
        -----
        Straight lines between the few figures of a plate are an assumption; where the maker
        draws the curves, read points from those.

        """
        corner = rated_speed if corner_speed is None else corner_speed
        figures = {
            'standstill_torque': standstill_torque, 'rated_torque': rated_torque,
            'rated_speed': rated_speed, 'peak_torque': peak_torque, 'max_speed': max_speed,
            'corner_speed': corner}
        problems = [
            Problem(name, value, 'must be a finite number above 0')
            for name, value in figures.items() if not (math.isfinite(value) and value > 0.0)]
        if not problems:
            problems = _order_problems(figures)
        if problems:
            raise ConfigurationError(problems)
        peak = [(0.0, peak_torque), (corner, peak_torque)]
        continuous = [(0.0, standstill_torque), (rated_speed, rated_torque)]
        if corner < max_speed:
            peak.append((max_speed, rated_torque))
        if rated_speed < max_speed:
            continuous.append((max_speed, rated_torque * rated_speed / max_speed))
        return cls(_limit(peak), _limit(continuous), inertia, max_speed, rated_speed,
                   torque_constant)

    def peak_torque(self, speed: Any) -> Any:
        """
        Give the most that the motor drives with for a moment.

        Parameters
        ----------
        speed : float or ndarray
            Speed [rad/s]; only its magnitude counts.

        Returns
        -------
        float or ndarray
            Torque [N m]; 0 above the largest speed.

        """
        return self.peak(speed) * (abs(speed) <= self.max_speed)

    def continuous_torque(self, speed: Any) -> Any:
        """
        Give what the motor stands for good.

        Parameters
        ----------
        speed : float or ndarray
            Speed [rad/s]; only its magnitude counts.

        Returns
        -------
        float or ndarray
            Torque [N m]; 0 above the largest speed.

        """
        return self.continuous(speed) * (abs(speed) <= self.max_speed)

    def current(self, torque: Any) -> Any:
        """
        Give the current that a torque takes.

        Parameters
        ----------
        torque : float or ndarray
            Torque of the motor [N m].

        Returns
        -------
        float or ndarray or None
            Current [A]; None where the torque constant is not known.

        """
        return None if self.torque_constant is None else torque / self.torque_constant


def _order_problems(plate: dict[str, float]) -> list[Problem]:
    """Find figures of a plate that stand in the wrong order."""
    return [
        Problem(small, plate[small], f'must be at most {large}, {plate[large]:g}')
        for small, large in (
            ('rated_torque', 'standstill_torque'), ('standstill_torque', 'peak_torque'),
            ('rated_speed', 'max_speed'), ('corner_speed', 'max_speed'))
        if plate[small] > plate[large]
    ]


def _limit(points: Sequence[tuple[float, float]]) -> TorqueLimit:
    speeds, torques = zip(*points)
    return TorqueLimit(speeds, torques)
