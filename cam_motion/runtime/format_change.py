# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Going over to a new format at an exact shaft angle, together with other axes or not at all."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from cam_motion.motion.limits import SpeedBound
from cam_motion.runtime.demand import Demand
from cam_motion.runtime.follower import Follower
from cam_motion.runtime.follower_settings import FollowerSettings, FollowerState
from cam_motion.runtime.layout import Layout
from cam_motion.runtime.motion_over_angle import Motion
from cam_motion.runtime.pace import Pace
from cam_motion.runtime.planning import (
    check_speed,
    next_angle,
    Plan,
    plan_transition,
    Target,
    Timing,
    TransitionError,
)
from cam_motion.runtime.recipe import Leaving, Recipe
from cam_motion.runtime.shaft_motion import ShaftState
from cam_motion.runtime.ways import going_over
from cam_motion.units import DEGREE, RPM

_STANDS = (FollowerState.DISENGAGED, FollowerState.HELD, FollowerState.FAULT)
_LATE = 1e-9  # an angle passed by no more is not late [rad]


class Format(NamedTuple):
    """
    What an axis is to go over to, and how.

    The new ``layout`` and ``settings``; the shaft angle ``at`` which the transition begins,
    within a turn, and the ``span`` over which it goes [rad]; 0 for as short as the limits allow.
    """

    layout: Layout
    settings: FollowerSettings
    at: float
    span: float


class Scheduled(NamedTuple):
    """
    A format that waits for the shaft.

    The ``new`` format, the unwrapped shaft angle ``start`` [rad], the ``sense`` in which the shaft
    comes to it, and the ``plan`` of the transition; None for an axis that stands.
    """

    new: Format
    start: float
    sense: float
    plan: Plan | None


class FormatFollower(Follower):
    """
    A follower that can go over to a whole new format at an exact shaft angle.

    Such a change has two parts, so that several axes can make it together: `check_format` plans
    it dry, and whoever asks all axes gets a yes or a reason from each; `schedule` then commits
    the axis, which does not refuse any more. Whatever the shaft does meanwhile, the transition
    goes over the shaft angles agreed upon: a shaft too fast for it is told to slow down by
    `speed_bound`.

    Parameters
    ----------
    layout : Layout
        Its cams and their couplings.
    settings : FollowerSettings
        What it may.
    engaged : bool
        Whether it is on its curve from the first shaft point on.

    Attributes
    ----------
    scheduled : Scheduled | None
        The format that waits for the shaft.
    on_taken : Callable[[], None]
        Called when the layout and settings of a scheduled format come into force.

    """

    def __init__(self, layout: Layout, settings: FollowerSettings, engaged: bool = True) -> None:
        """Wait for the shaft."""
        super().__init__(layout, settings, engaged)
        self.scheduled: Scheduled | None = None
        self.on_taken: Callable[[], None] = _nothing

    @property
    def turning(self) -> bool:
        """Whether the shaft turns, as far as the axis knows."""
        return self._shaft is not None and bool(self._shaft.omega or self._shaft.alpha)

    def check_format(self, new: Format) -> Plan | None:
        """
        Plan a change of format without making it.

        Parameters
        ----------
        new : Format
            The format.

        Returns
        -------
        Plan | None
            The transition; None for an axis that stands.

        Raises
        ------
        TransitionError
            When it would not keep the limits, or cannot be made now.

        """
        if self.scheduled is not None:
            raise TransitionError('a change of format is scheduled already')
        limits = new.settings.limits
        new.layout.check_range(limits)
        if self.state in _STANDS:
            return None
        shaft = self._shaft
        if self.state is not FollowerState.IN_SYNC or self.plan is not None or shaft is None:
            raise TransitionError(
                f'the axis is {self.state.value}: its format can change when it is in_sync or '
                'stands')
        speed = abs(shaft.omega)
        check_speed(new.layout.speed_bound(limits), speed)
        sense = -1.0 if shaft.omega < 0.0 else 1.0
        start = next_angle(shaft.phi, new.at, sense)
        if not new.span:
            return shortest_plan(self.layout, new.layout, start, sense, new.settings, speed)
        plan = self._planned(new, start, sense)
        wanting = f'the transition over {new.span / DEGREE:.4g} deg from {new.at / DEGREE:.4g} deg'
        if plan.highest_speed < speed:
            raise TransitionError(
                f'{wanting} keeps the limits up to {plan.highest_speed / RPM:.4g} cycles/min only '
                f'and the shaft runs at {speed / RPM:.4g}: slow down, or allow a longer span')
        plan_range = Demand(plan.blend, *sorted((start, plan.blend.end)))
        if not plan_range.keeps_range(limits):
            raise TransitionError(
                f'{wanting} goes from {plan.peaks.lowest:.6g} to {plan.peaks.highest:.6g}, beyond '
                f'the limits of position ({limits.lowest} to {limits.highest})')
        return plan

    def schedule(self, new: Format, start: float) -> Plan | None:
        """
        Go over to a format when the shaft comes to an angle.

        Parameters
        ----------
        new : Format
            The format, which has passed `check_format`.
        start : float
            The angle, unwrapped [rad]. One that has been passed means now.

        Returns
        -------
        Plan | None
            The transition; None for an axis that stands, or comes to stand: it has the new
            format when the shaft has passed the angle, or when it is reset.

        """
        shaft = self._shaft
        sense = -1.0 if shaft is not None and (shaft.omega or start - shaft.phi) < 0.0 else 1.0
        if self.state is not FollowerState.IN_SYNC or shaft is None:
            self.scheduled, self._watch = Scheduled(new, start, sense, None), True
            return None
        if sense * (shaft.phi - start) > _LATE:
            start = shaft.phi
        plan = self._planned(new, start, sense)
        self.scheduled = Scheduled(new, start, sense, plan)
        # all axes have agreed upon the angle: until then nothing is planned anew
        self._lay(plan, None, Leaving(self.layout))
        self._planned_at = start
        return plan

    def revoke(self) -> bool:
        """
        Drop a format that waits for the shaft.

        Returns
        -------
        bool
            Whether there was one; a transition that has begun goes on.

        """
        scheduled, self.scheduled = self.scheduled, None
        if scheduled is not None and scheduled.plan is not None and self.plan is scheduled.plan:
            self._cancel()
        return scheduled is not None

    def _planned(self, new: Format, start: float, sense: float) -> Plan:
        shaft = self._shaft
        speed = 0.0 if shaft is None else abs(shaft.omega)
        return fixed_plan(self.motion, going_over(self.layout, new.layout), start,
                          sense * new.span, new.settings, speed)

    @property
    def speed_bound(self) -> SpeedBound | None:
        """Find the highest speed of the shaft within the limits, also those to come."""
        now, waiting = super().speed_bound, self.scheduled
        if waiting is None or waiting.plan is None:
            return now
        then = waiting.new.layout.speed_bound(waiting.new.settings.limits)
        return min((b for b in (now, then) if b is not None), key=lambda b: b.omega, default=None)

    def _progress(self, phi: float) -> None:
        super()._progress(phi)
        waiting = self.scheduled
        if waiting is None:
            return
        passed = waiting.sense * (phi - waiting.start) > 0.0
        if passed and (waiting.plan is not None or self.state in _STANDS):
            self._take_over(waiting)
        self._watch = self.plan is not None or self.scheduled is not None

    def _take_over(self, waiting: Scheduled) -> None:
        plan, new, old = waiting.plan, waiting.new, self.layout
        self.layout = new.layout.anchored_as(old)
        if plan is not None and isinstance(plan.goal, Layout):
            self.layout = plan.goal
            timing = Timing(span=new.span, longest=new.settings.change.longest)
            self._recipe = Recipe(going_over(old, new.layout), timing)
        self.settings = new.settings
        self.scheduled = None
        self.on_taken()

    def reset(self) -> Plan | None:
        """
        Acknowledge a stop; an axis for which a format waited comes back with that.

        Returns
        -------
        Plan | None
            The transition, see `Follower.reset`.

        Raises
        ------
        TransitionError
            See `Follower.reset`.

        """
        if self.scheduled is not None and self.state in _STANDS:
            self._take_over(self.scheduled)
        return super().reset()

    def hold(self, state: FollowerState, reason: str, in_place: bool = False) -> None:
        """
        Stand where the axis is until it is reset; a format goes on waiting.

        Parameters
        ----------
        state : FollowerState
            HELD or FAULT.
        reason : str
            Why.
        in_place : bool
            See `Follower.hold`.

        """
        super().hold(state, reason, in_place)
        if self.scheduled is not None:
            self.scheduled, self._watch = self.scheduled._replace(plan=None), True


def _nothing() -> None:
    """Stand in for a callback."""


def fixed_plan(old: Motion, target: Target, start: float, span: float,
               settings: FollowerSettings, speed: float) -> Plan:
    """
    Plan a transition whose angles are given.

    Parameters
    ----------
    old : Motion
        What the axis does before.
    target : Callable[[Motion, float, float], Way]
        Makes the way to what it goes over to.
    start, span : float
        The angles [rad]; a negative span for a shaft that turns backwards.
    settings : FollowerSettings
        Limits, and the acceleration of the shaft to leave room for.
    speed : float
        Speed of the shaft, a magnitude [rad/s].

    Returns
    -------
    Plan
        The transition, whether or not it keeps the limits at that speed.

    """
    goal, blend = target(old, start, span)
    demand = Demand(blend, *sorted((start, blend.end)))
    return Plan(blend, goal, demand.peaks(speed, settings.shaft_ramp), speed,
                demand.highest_speed(settings.limits, settings.shaft_ramp))


def shortest_plan(old: Layout, new: Layout, start: float, sense: float,
                  settings: FollowerSettings, speed: float) -> Plan:
    """
    Plan a transition that begins at an angle and is as short as the limits allow.

    Parameters
    ----------
    old, new : Layout
        What the axis does before, and what it goes over to.
    start : float
        Shaft angle at which it begins [rad].
    sense : float
        -1 for a shaft that turns backwards.
    settings : FollowerSettings
        The new settings: their limits, and the spans of their `change`.
    speed : float
        Speed of the shaft, a magnitude [rad/s].

    Returns
    -------
    Plan
        The transition.

    Raises
    ------
    TransitionError
        When none keeps the limits.

    """
    timing = Timing(span=settings.change.span, longest=settings.change.longest)
    return plan_transition(
        old.motion, going_over(old, new), ShaftState(start, sense * speed, 0.0), timing,
        Pace(speed, speed, settings.shaft_ramp, sense), settings.limits)
