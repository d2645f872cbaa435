# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Optimising one movement: the question in SI units, before and after."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
import math
from typing import Any

from cam_motion.drive.inverse import FollowerDrive
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.plain import finite
from cam_motion.motion.laws import make_law, MotionLaw
from cam_motion.motion.limits import Limits, QUANTITIES
from cam_motion.motion.optimal import Demands, End, figures, Load, weighed
from cam_motion.motion.optimal_spline import best_spline, INTERVALS
from cam_motion.motion.optimal_stages import best_member
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.spline_programme import Tell
from cam_motion.units import DEGREE, RPM

SPLINE = 'spline'
"""What the optimiser calls the spline; the law that it writes is `b_spline`."""

_COMPARED = 'polynomial_345'  # what a movement without a machine is compared with


@dataclass(frozen=True)
class Movement:
    """
    One movement that is to be optimised.

    Attributes
    ----------
    name : str
        What to call it.
    unit : str
        Unit of the position.
    lift : float
        Change of position [unit].
    span : float
        Span of the shaft [rad], positive.
    omega : float
        Speed of the shaft [rad/s], positive.
    before : Piecewise
        The law as it is, normalised.
    law : str
        Name of that law.
    ends : tuple[End, End]
        What the neighbours do, normalised.
    limits : Limits
        Limits on the physical derivatives.
    drive : FollowerDrive | None
        The drive, where there is one.
    given_lift : float | None
        The lift as the cam has it, before the scale of its coupling; None where it is the same.

    """

    name: str
    unit: str
    lift: float
    span: float
    omega: float
    before: Piecewise
    law: str
    ends: tuple[End, End] = (End(), End())
    limits: Limits = Limits()
    drive: FollowerDrive | None = None
    given_lift: float | None = None

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        return self.span / self.omega

    def scale(self, order: int) -> float:
        """
        Give the factor from a derivative of the law to that of the position.

        Parameters
        ----------
        order : int
            Order of the derivative.

        Returns
        -------
        float
            Lift over duration to that order, its magnitude [unit/s^order].

        """
        return abs(self.lift) / self.duration ** order

    def demands(self, continuity: int) -> Demands:
        """
        Give limits and ends for the law, lift 1 over span 1.

        Parameters
        ----------
        continuity : int
            Class with which it shall meet its neighbours.

        Returns
        -------
        Demands
            The demands.

        """
        velocity, acceleration, jerk = (
            None if limit is None else limit / self.scale(order) for order, limit in (
                (order, self.limits.of_order(order)) for order in (1, 2, 3)))
        return Demands(velocity, acceleration, jerk, continuity, *self.ends)

    @property
    def load(self) -> Load | None:
        """
        Give the torque at the motor for s''.

        None without a drive that has an inertia, and where the load depends on place or speed.
        """
        drive = self.drive
        if drive is None or not drive.is_even:
            return None
        law = drive.law(0.0)
        if drive.motor_inertia + law.inertia <= 0.0:
            return None
        rate = self.scale(2) / drive.radius
        against = math.copysign(1.0, self.lift) * law.pull + law.friction
        return Load(
            drive.motor_inertia * drive.gear_ratio * rate,
            law.inertia * rate / drive.gear_ratio, against / drive.gear_ratio, drive.efficiency)


@dataclass(frozen=True)
class Wish:
    """
    What is to be found.

    Attributes
    ----------
    weights : Mapping[str, float]
        Weight of each figure to minimise.
    law : str
        `SPLINE` or a family of `cam_motion.motion.optimal_stages.FAMILIES`.
    continuity : int
        Class with which the law shall meet its neighbours.
    intervals : int
        Of the spline; a sinusoidal stage is no shorter than one of them.
    degree : int | None
        Of the spline; None takes the natural one.

    """

    weights: Mapping[str, float]
    law: str = SPLINE
    continuity: int = 2
    intervals: int = INTERVALS
    degree: int | None = None


@dataclass(frozen=True)
class Optimised:
    """
    A movement before and after.

    Attributes
    ----------
    movement : Movement
        The movement.
    wish : Wish
        What was to be found.
    law : MotionLaw
        The law found.
    before, after : Mapping[str, float]
        Figures of the normalised law, torques in N m.
    objectives : tuple[float, float]
        What was minimised, before and after.

    """

    movement: Movement
    wish: Wish
    law: MotionLaw
    before: Mapping[str, float]
    after: Mapping[str, float]
    objectives: tuple[float, float]

    @property
    def parameters(self) -> dict[str, Any]:
        """Give the law with its parameters as a machine file takes them."""
        return {'law': self.law.name, **{
            name: list(value) if isinstance(value, tuple) else value
            for name, value in self.law.parameters.items() if value is not None}}


def optimise(movement: Movement, wish: Wish, tell: Tell = lambda done, total: None) -> Optimised:
    """
    Find the best law for a movement.

    Parameters
    ----------
    movement : Movement
        The movement.
    wish : Wish
        What is to be found.
    tell : Callable[[int, int], None]
        Hears of the progress.

    Returns
    -------
    Optimised
        The movement before and after.

    Raises
    ------
    ConfigurationError
        When no such law keeps the limits, or what is asked makes no sense.

    """
    demands, load = movement.demands(wish.continuity), movement.load
    if wish.law == SPLINE:
        law = best_spline(wish.weights, demands, load, wish.intervals, wish.degree, tell)
    else:
        law = best_member(
            wish.law, wish.weights, demands, load, 1.0 / max(wish.intervals, 1), tell)
    found = [figures(curve, demands, load) for curve in (movement.before, law.curve)]
    objectives = [weighed(wish.weights, each, load) for each in found]
    return Optimised(movement, wish, law, found[0], found[1], (objectives[0], objectives[1]))


def free_movement(lift: float, span_deg: float, speed_cpm: float, limits: Limits) -> Movement:
    """
    Describe a movement between two dwells without a machine.

    Parameters
    ----------
    lift : float
        Change of position [unit].
    span_deg : float
        Span of the shaft [deg].
    speed_cpm : float
        Speed of the shaft [cycles/min].
    limits : Limits
        Limits [unit/s, unit/s², unit/s³].

    Returns
    -------
    Movement
        The movement, compared with the polynomial 3-4-5.

    Raises
    ------
    ConfigurationError
        When a number makes no movement.

    """
    problems = [Problem(name, value, 'must not be 0' if name == 'lift' else 'must be above 0')
                for name, value in (('lift', lift), ('span-deg', span_deg),
                                    ('speed-cpm', speed_cpm))
                if not (value > 0.0 or (name == 'lift' and value))]
    if span_deg > 360.0:
        problems.append(Problem('span-deg', span_deg, 'must be at most 360'))
    if problems:
        raise ConfigurationError(problems)
    return Movement('movement', 'unit', lift, span_deg * DEGREE, speed_cpm * RPM,
                    make_law(_COMPARED).curve, _COMPARED, limits=limits)


def optimised_as_data(found: Optimised) -> dict[str, Any]:
    """
    Turn the outcome of an optimisation into plain data.

    Parameters
    ----------
    found : Optimised
        The outcome.

    Returns
    -------
    dict[str, Any]
        The movement, the law, and its figures before and after; infinite ones are None.

    """
    movement = found.movement

    def side(curve: Piecewise, law: str, own: Mapping[str, float], objective: float,
             ) -> dict[str, Any]:
        peaks = {f'peak_{name}': own[f'peak_{name}'] * movement.scale(order)
                 for order, name in enumerate(QUANTITIES[1:], 1)}
        return {
            'law': law, 'objective': finite(objective), 'cv': finite(own['peak_velocity']),
            'ca': finite(own['peak_acceleration']), 'cj': finite(own['peak_jerk']),
            'power': abs(curve.peak_power().value),
            'rms_acceleration': finite(own['rms_acceleration']),
            **{name: finite(value) for name, value in peaks.items()},
            **{name: finite(own[name]) for name in ('peak_torque', 'rms_torque') if name in own}}

    return {
        'movement': movement.name, 'unit': movement.unit, 'lift': movement.lift,
        'span_deg': movement.span / DEGREE, 'speed_cpm': movement.omega / RPM,
        'minimise': dict(found.wish.weights),
        'before': side(movement.before, movement.law, found.before, found.objectives[0]),
        'after': side(found.law.curve, found.law.name, found.after, found.objectives[1]),
        'law': found.parameters,
    }
