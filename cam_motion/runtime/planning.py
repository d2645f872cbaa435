# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Planning a transition: where it begins, how long it takes, what it demands, or why it cannot."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
import math
from typing import NamedTuple, Protocol

from cam_motion.errors import CamMotionError
from cam_motion.motion.limits import Limits, SpeedBound
from cam_motion.runtime.demand import Demand, Peaks
from cam_motion.runtime.motion_over_angle import Motion
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft_motion import ShaftState
from cam_motion.runtime.transition import Blend
from cam_motion.units import DEGREE, rate_text, RPM, TURN

_GROWTH = 1.25  # from one span that is too short to the next that is tried
_LOOKS = 24  # places within one turn at which the soonest transition is looked for
_OBEYS_WITHIN = 0.05  # how soon the shaft hears what it may [s]
_AT_ANGLE = 1e-9  # an angle this near [rad] counts as reached


class Goal(Protocol):
    """What a transition leads to."""

    @property
    def motion(self) -> Motion:
        """Give the motion afterwards."""


Target = Callable[[float, float], Goal]
"""Makes the goal from the shaft angles at which the transition begins and ends [rad]."""


class At(Enum):
    """When a transition begins; the value is its name in the configuration."""

    NOW = 'now'
    ANGLE = 'angle'
    CYCLE_END = 'cycle_end'
    SOONEST = 'soonest'


class TransitionError(CamMotionError):
    """
    A transition that cannot be made within the limits, or not now.

    Parameters
    ----------
    text : str
        Why.
    fits_up_to : float
        Speed of the shaft up to which it could be made [rad/s]; 0 where that would not help.

    """

    def __init__(self, text: str, fits_up_to: float = 0.0) -> None:
        """Say why."""
        super().__init__(text)
        self.fits_up_to = fits_up_to


@dataclass(frozen=True)
class Timing:
    """
    When a transition is to begin and how long it may take.

    Attributes
    ----------
    at : At
        ``now``; at a shaft ``angle``; at the ``cycle_end``; or as soon as the span fits within
        the limits, looked for over one turn.
    span : float
        Shaft angle over which it goes, if the limits allow [rad]; positive.
    longest : float
        Up to which it is lengthened if they do not [rad].
    angle : float
        The angle at which it begins, within a turn [rad].

    """

    at: At = At.NOW
    span: float = 90.0 * DEGREE
    longest: float = 4.0 * TURN
    angle: float = 0.0


class Plan(NamedTuple):
    """
    A transition that keeps the limits.

    The ``blend`` itself and the ``goal`` it leads to, its ``peaks`` at the ``speed`` of the shaft
    [rad/s], or for one that stands at the speed it may have, and the ``highest_speed`` [rad/s]
    at which it keeps all limits.
    """

    blend: Blend
    goal: Goal
    peaks: Peaks
    speed: float
    highest_speed: float

    def text(self, unit: str) -> str:
        """
        Describe the plan.

        Parameters
        ----------
        unit : str
            Unit of the axis.

        Returns
        -------
        str
            Angles, peaks and speeds in words.

        """
        start, span = self.blend.start / DEGREE, self.blend.span / DEGREE
        text = (f'over {abs(span):.4g} deg from {start % 360.0:.4g} deg, up to '
                f'{self.peaks.velocity:.4g} {rate_text(unit, 1)} and '
                f'{self.peaks.acceleration:.4g} {rate_text(unit, 2)} '
                f'at {self.speed / RPM:.4g} cycles/min')
        if math.isfinite(self.highest_speed):
            text += f', within limits up to {self.highest_speed / RPM:.4g} cycles/min'
        return text


class Pace(NamedTuple):
    """
    The speeds of the shaft that a plan reckons with.

    The plan must keep its limits at the ``needed`` speed and is lengthened for the sake of the
    ``wanted`` one [rad/s], both with the shaft's ``ramp`` on top; ``sense`` is -1 for a shaft
    that turns backwards.
    """

    needed: float
    wanted: float
    ramp: RampLimits
    sense: float


def pace_of(state: ShaftState, bound: SpeedBound | None, ramp: RampLimits,
            obeyed: bool = True) -> Pace:
    """
    Choose the speeds that a transition begun now must reckon with.

    Parameters
    ----------
    state : ShaftState
        The shaft now.
    bound : SpeedBound | None
        Up to which the axis lets the shaft run.
    ramp : RampLimits
        Acceleration and jerk of the shaft to leave room for.
    obeyed : bool
        Whether the shaft can be asked to run no faster.

    Returns
    -------
    Pace
        The speed that it has or, while it accelerates, cannot but come to: a shaft that obeys
        runs no faster when asked. One that accelerates may be on its way to whatever the axis
        allows, and one that does not obey comes to it.

    """
    speed, sense = abs(state.omega), -1.0 if state.omega < 0.0 else 1.0
    fastest = speed if bound is None else max(speed, bound.omega)
    if not obeyed:
        return Pace(fastest, fastest, ramp, sense)
    if sense * state.alpha > 0.0:
        return Pace(min(speed_ahead(state, ramp), fastest), fastest, ramp, sense)
    return Pace(speed, speed or fastest, ramp, sense)


def speed_ahead(state: ShaftState, ramp: RampLimits) -> float:
    """
    Tell which speed the shaft cannot but come to before it obeys.

    Parameters
    ----------
    state : ShaftState
        The shaft now.
    ramp : RampLimits
        The jerk by which it takes its acceleration back.

    Returns
    -------
    float
        A magnitude [rad/s]: what it has or, while it accelerates, somewhat more.

    """
    speed, rise = abs(state.omega), math.copysign(1.0, state.omega) * state.alpha
    if rise <= 0.0:
        return speed
    return speed + rise * (_OBEYS_WITHIN + 0.5 * rise / ramp.jerk)


def check_speed(bound: SpeedBound | None, speed: float) -> None:
    """
    Check that a new motion keeps its limits at the speed of the shaft.

    Parameters
    ----------
    bound : SpeedBound | None
        The highest speed at which it does.
    speed : float
        Speed of the shaft, a magnitude [rad/s].

    Raises
    ------
    TransitionError
        When it does not, with the figures.

    """
    if bound is not None and bound.omega * (1.0 + 1e-9) < speed:
        raise TransitionError(
            f'the new motion keeps the limits up to {bound.omega / RPM:.4g} cycles/min only '
            f'({bound.segment}: {bound.quantity}) and the shaft runs at {speed / RPM:.4g}: '
            'slow down first')


def next_angle(phi: float, angle: float, sense: float) -> float:
    """
    Find when the shaft passes an angle next.

    Parameters
    ----------
    phi : float
        Where it is [rad].
    angle : float
        The angle within a turn [rad].
    sense : float
        -1 when it turns backwards.

    Returns
    -------
    float
        Unwrapped shaft angle at or beyond phi [rad].

    """
    turns = sense * (phi - angle) / TURN
    return angle + sense * math.ceil(turns - _AT_ANGLE) * TURN


def plan_transition(old: Motion, target: Target, state: ShaftState, timing: Timing, pace: Pace,
                    limits: Limits, ends_at: bool = False) -> Plan:
    """
    Plan a transition within limits.

    Parameters
    ----------
    old : Motion
        What the axis does now.
    target : Callable[[float, float], Goal]
        Makes the goal from the angles at which the transition begins and ends [rad].
    state : ShaftState
        The shaft now.
    timing : Timing
        When it is to begin, and how long it may take.
    pace : Pace
        The speeds to reckon with.
    limits : Limits
        Limits of the axis.
    ends_at : bool
        Whether the transition is to end, rather than begin, at the end of a cycle.

    Returns
    -------
    Plan
        The shortest one that fits at the wanted speed; else, if it fits at the needed one, the
        one that allows the most.

    Raises
    ------
    TransitionError
        When none fits; the message gives the figures of the longest.

    """
    best: Plan | None = None
    last: Plan | None = None
    kept = True
    for start, span in _windows(state.phi, timing, pace.sense, ends_at):
        goal = target(start, start + span)
        blend = Blend(old, goal.motion, start, span)
        demand = Demand(blend, min(start, blend.end), max(start, blend.end))
        allowed = demand.highest_speed(limits, pace.ramp)
        # a shaft that stands will run some time: what counts is how fast it may
        speed = pace.needed or min(pace.wanted, allowed)
        last = Plan(blend, goal, demand.peaks(speed, pace.ramp), speed, allowed)
        kept = demand.keeps_range(limits)
        if not kept:
            continue
        if allowed >= pace.wanted:
            return last
        if best is None or allowed > best.highest_speed:
            best = last
    if best is not None and best.highest_speed >= pace.needed:
        return best
    raise TransitionError(_why(best or last, kept or best is not None, pace, limits),
                          0.0 if best is None else best.highest_speed)


def _windows(phi: float, timing: Timing, sense: float, ends_at: bool,
             ) -> Iterator[tuple[float, float]]:
    """Give starts and signed spans to try, the preferred ones first."""
    span = timing.span
    if timing.at is At.SOONEST:
        for k in range(_LOOKS):
            yield phi + sense * k * TURN / _LOOKS, sense * span
    longest = max(span, timing.longest)
    while True:
        start = phi
        if timing.at is At.ANGLE:
            start = next_angle(phi, timing.angle, sense)
        elif timing.at is At.CYCLE_END:
            lead = span if ends_at else 0.0
            start = next_angle(phi + sense * lead, 0.0, sense) - sense * lead
        yield start, sense * span
        if span >= longest:
            return
        span = min(_GROWTH * span, longest)


def _why(plan: Plan | None, kept: bool, pace: Pace, limits: Limits) -> str:
    if plan is None:
        return 'no span to try: give one above 0'
    peaks, span = plan.peaks, abs(plan.blend.span) / DEGREE
    if not kept:
        return (f'the transition would move the axis from {peaks.lowest:.6g} to '
                f'{peaks.highest:.6g}, beyond its limits of position '
                f'({limits.lowest} to {limits.highest}); engage at an angle where it fits')
    asked = [
        f'{name} {value:.4g} (limit {limit:g})' for name, value, limit in (
            ('velocity', peaks.velocity, limits.velocity),
            ('acceleration', peaks.acceleration, limits.acceleration),
            ('jerk', peaks.jerk, limits.jerk)) if limit is not None and value > 0.99 * limit]
    return (f'no transition fits: over {span:.4g} deg at {pace.needed / RPM:.4g} cycles/min it '
            f'would take {", ".join(asked) or "more than the limits"}; it fits up to '
            f'{plan.highest_speed / RPM:.4g} cycles/min: slow down, or allow a longer span')
