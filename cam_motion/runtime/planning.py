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
from dataclasses import dataclass, replace
from enum import Enum
import math
from typing import NamedTuple, Protocol

from cam_motion.errors import CamMotionError
from cam_motion.motion.limits import Limits, SpeedBound
from cam_motion.runtime.demand import Demand, Peaks
from cam_motion.runtime.motion_over_angle import Motion
from cam_motion.runtime.pace import Pace
from cam_motion.runtime.shaft_motion import ShaftState
from cam_motion.runtime.transition import Blend
from cam_motion.units import DEGREE, rate_text, TURN
import numpy as np

_GROWTH = 1.25  # from one span that is too short to the next that is tried
_LOOKS = 24  # places within one turn at which the soonest transition is looked for
_PLACES = 65  # places at which a motion beyond its limits of position is looked at
_AT_ANGLE = 1e-9  # an angle this near [rad] counts as reached


class Goal(Protocol):
    """What a transition leads to."""

    @property
    def motion(self) -> Motion:
        """Give the motion afterwards."""


class Way(NamedTuple):
    """The ``goal`` of a transition, and the ``blend`` that leads to it."""

    goal: Goal
    blend: Blend


Target = Callable[[Motion, float, float], Way]
"""Makes the way from the old motion, the shaft angle at which it begins and its span [rad]."""


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
        ``now``; at a shaft ``angle``; at the ``cycle_end``, which is the angle at which the cams
        begin anew; or as soon as the span fits within the limits, looked for over one turn.
    span : float
        Shaft angle over which it goes, if the limits allow [rad]; positive.
    longest : float
        Up to which it is lengthened if they do not [rad].
    angle : float
        The angle at which it begins, or the end of a cycle [rad].
    every : float
        Shaft angle after which that comes again [rad].
    turn : float
        One turn of the cam, in what the axis follows: of another axis, in the unit of that.
    reach : tuple[float, float]
        Between which places what it follows stays.

    """

    at: At = At.NOW
    span: float = 90.0 * DEGREE
    longest: float = 4.0 * TURN
    angle: float = 0.0
    every: float = TURN
    turn: float = TURN
    reach: tuple[float, float] = (-math.inf, math.inf)

    def can_end(self, phi: float, start: float, end: float) -> bool:
        """
        Tell whether a transition comes to its end.

        Parameters
        ----------
        phi : float
            Where what the axis follows is now [rad].
        start, end : float
            Where the transition is to begin and to end [rad].

        Returns
        -------
        bool
            False when what it follows turns back before; when that is already beyond its reach,
            nothing is known of it.

        """
        low, high = self.reach
        return not low <= phi <= high or low <= min(start, end) and max(start, end) <= high


class Plan(NamedTuple):
    """
    A transition that keeps the limits.

    The ``blend`` itself and the ``goal`` it leads to, its ``peaks`` at the ``speed`` of the shaft
    [rad/s], or for one that stands at the speed it may have, and the ``highest_speed`` [rad/s]
    at which it keeps all limits; the ``turn`` of the cam, see `Timing`.
    """

    blend: Blend
    goal: Goal
    peaks: Peaks
    speed: float
    highest_speed: float
    turn: float = TURN

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
        degree, rpm = self.turn / 360.0, self.turn / 60.0
        start, span = self.blend.start / degree, self.blend.span / degree
        text = (f'over {abs(span):.4g} deg from {start % 360.0:.4g} deg, up to '
                f'{self.peaks.velocity:.4g} {rate_text(unit, 1)} and '
                f'{self.peaks.acceleration:.4g} {rate_text(unit, 2)} '
                f'at {self.speed / rpm:.4g} cycles/min')
        if math.isfinite(self.highest_speed):
            text += f', within limits up to {self.highest_speed / rpm:.4g} cycles/min'
        return text


def check_speed(bound: SpeedBound | None, speed: float, turn: float = TURN) -> None:
    """
    Check that a new motion keeps its limits at the speed of the shaft.

    Parameters
    ----------
    bound : SpeedBound | None
        The highest speed at which it does.
    speed : float
        Speed of the shaft, a magnitude [rad/s].
    turn : float
        One turn of the cam in what the axis follows.

    Raises
    ------
    TransitionError
        When it does not, with the figures.

    """
    if bound is not None and bound.omega * (1.0 + 1e-9) < speed:
        raise TransitionError(
            f'the new motion keeps the limits up to {bound.omega / turn * 60.0:.4g} cycles/min '
            f'only ({bound.segment}: {bound.quantity}) and the shaft runs at '
            f'{speed / turn * 60.0:.4g}: '
            'slow down first')


def next_angle(phi: float, angle: float, sense: float, every: float = TURN) -> float:
    """
    Find when the shaft passes an angle next.

    Parameters
    ----------
    phi : float
        Where it is [rad].
    angle : float
        The angle [rad].
    sense : float
        -1 when it turns backwards.
    every : float
        After which the angle comes again [rad].

    Returns
    -------
    float
        Unwrapped shaft angle at or beyond phi [rad].

    """
    turns = sense * (phi - angle) / every
    return angle + sense * math.ceil(turns - _AT_ANGLE) * every


def plan_transition(old: Motion, target: Target, state: ShaftState, timing: Timing, pace: Pace,
                    limits: Limits, ends_at: bool = False) -> Plan:
    """
    Plan a transition within limits.

    Parameters
    ----------
    old : Motion
        What the axis does now.
    target : Callable[[Motion, float, float], Way]
        Makes the way to the goal, over the angles at which it may go.
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
    for start, span in _ending_windows(state.phi, timing, pace.sense, ends_at):
        goal, blend = target(old, start, span)
        demand = Demand(blend, min(start, blend.end), max(start, blend.end))
        allowed = demand.highest_speed(limits, pace.ramp)
        # a shaft that stands will run some time: what counts is how fast it may
        speed = pace.needed or min(pace.wanted, allowed)
        last = Plan(
            blend, goal, demand.peaks(speed, pace.ramp), speed, allowed, timing.turn)
        kept = demand.keeps_range(_reached(old, start, span, limits))
        if not kept:
            continue
        if allowed >= pace.wanted:
            return last
        if best is None or allowed > best.highest_speed:
            best = last
    if best is not None and best.highest_speed >= pace.needed:
        return best
    raise TransitionError(_why(best or last, kept or best is not None, pace, limits, timing),
                          0.0 if best is None else best.highest_speed)


def _ending_windows(phi: float, timing: Timing, sense: float, ends_at: bool,
                    ) -> Iterator[tuple[float, float]]:
    """Give what `_windows` does as far as it comes to its end, else when the axis comes back."""
    found = False
    for way in (sense, -sense):
        for start, span in _windows(phi, timing, way, ends_at):
            if timing.can_end(phi, start, start + span):
                found = True
                yield start, span
        if found:
            return


def _windows(phi: float, timing: Timing, sense: float, ends_at: bool,
             ) -> Iterator[tuple[float, float]]:
    """Give starts and signed spans to try, the preferred ones first."""
    span = timing.span
    if timing.at is At.SOONEST:
        for k in range(_LOOKS):
            yield phi + sense * k * timing.turn / _LOOKS, sense * span
    longest = max(span, timing.longest)
    while True:
        start = phi
        if timing.at is At.ANGLE:
            start = next_angle(phi, timing.angle, sense, timing.every)
        elif timing.at is At.CYCLE_END:
            lead = span if ends_at else 0.0
            start = next_angle(
                phi + sense * lead, timing.angle, sense, timing.every) - sense * lead
        yield start, sense * span
        if span >= longest:
            return
        span = min(_GROWTH * span, longest)


def _reached(old: Motion, start: float, span: float, limits: Limits) -> Limits:
    """Widen limits of position by what an axis that has left them does anyway."""
    low, high = limits.positions
    if low <= old.sample(start)[0] <= high:
        return limits
    y = old(np.linspace(start, start + span, _PLACES))[0]
    return replace(limits, lowest=min(low, float(y.min())), highest=max(high, float(y.max())))


def _why(plan: Plan | None, kept: bool, pace: Pace, limits: Limits, timing: Timing) -> str:
    if plan is None:
        low, high = timing.reach
        return (f'what the axis follows stays between {low:.6g} and {high:.6g} and turns back '
                f'before a transition over {timing.span:.4g} would end: begin it elsewhere, '
                'or take a shorter span')
    degree, rpm = timing.turn / 360.0, timing.turn / 60.0
    peaks, span = plan.peaks, abs(plan.blend.span) / degree
    if not kept:
        return (f'the transition would move the axis from {peaks.lowest:.6g} to '
                f'{peaks.highest:.6g}, beyond its limits of position '
                f'({limits.lowest} to {limits.highest}); engage at an angle where it fits')
    asked = [
        f'{name} {value:.4g} (limit {limit:g})' for name, value, limit in (
            ('velocity', peaks.velocity, limits.velocity),
            ('acceleration', peaks.acceleration, limits.acceleration),
            ('jerk', peaks.jerk, limits.jerk)) if limit is not None and value > 0.99 * limit]
    return (f'no transition fits: over {span:.4g} deg at {pace.needed / rpm:.4g} cycles/min it '
            f'would take {", ".join(asked) or "more than the limits"}; it fits up to '
            f'{plan.highest_speed / rpm:.4g} cycles/min: slow down, or allow a longer span')
