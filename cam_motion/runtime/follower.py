# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""An axis that follows the shaft: engaged or not, changing, stopping, resuming, never jumping."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
import math

from cam_motion.motion.limits import SpeedBound
from cam_motion.runtime.follower_settings import FollowerSettings, FollowerState
from cam_motion.runtime.layout import Layout
from cam_motion.runtime.motion_over_angle import Motion, Standstill
from cam_motion.runtime.planning import (
    At,
    check_speed,
    Goal,
    pace_of,
    Plan,
    plan_transition,
    Target,
    Timing,
    TransitionError,
)
from cam_motion.runtime.shaft_motion import ShaftState
from cam_motion.runtime.transition import Blend
from cam_motion.units import TURN

_SAME = 1e-9  # positions this close, as a share of what they are, are the same
_MOST_NESTED = 4  # transitions begun on top of others that still go on
_TO_BE_RESET = (FollowerState.HELD, FollowerState.FAULT)
_AT_REST = (FollowerState.DISENGAGED, *_TO_BE_RESET)


Anchor = Callable[[float, float], Layout]
"""Anchors a layout for an axis that joins it from a position at a shaft angle [rad]."""


class Follower:
    """
    The state machine of an axis over the shaft.

    Parameters
    ----------
    layout : Layout
        Its cams and their couplings.
    settings : FollowerSettings
        What it may.
    engaged : bool
        Whether it is on its curve from the first shaft point on; else it stands at its
        start position until engaged.

    Attributes
    ----------
    layout : Layout
        The cams and couplings in force, or to which a transition leads.
    settings : FollowerSettings
        What it may; takes effect with the next command.
    plan : Plan | None
        The transition that goes on or waits to begin.
    reason : str
        Why the axis is held or in fault.
    motion : Motion
        What the axis does now over the shaft angle, transitions included.
    sample : Callable[[float], tuple[float, float, float, float]]
        Evaluates it at a shaft angle [rad].

    """

    def __init__(self, layout: Layout, settings: FollowerSettings, engaged: bool = True) -> None:
        """Wait for the shaft."""
        self.layout = layout
        self.settings = settings
        self.plan: Plan | None = None
        self.reason = ''
        self._shaft: ShaftState | None = None
        self._set_motion(layout.motion if engaged else Standstill(settings.start_position))
        self.state = FollowerState.WAITING if engaged else FollowerState.DISENGAGED
        """What the axis does."""
        self._begun = self._through = self.state  # states while a plan goes on, and after it
        self._held_at: float | None = None  # shaft angle at which the axis came to be held
        self._watch = True  # whether the next shaft point may change the state

    def _set_motion(self, motion: Motion) -> None:
        self.motion = motion
        self.sample = motion.sample

    def answer(self, phi: float, omega: float, alpha: float) -> tuple[float, float, float]:
        """
        Give the setpoint for a shaft point.

        Parameters
        ----------
        phi, omega, alpha : float
            Angle [rad], speed [rad/s] and acceleration [rad/s²] of the shaft.

        Returns
        -------
        tuple[float, float, float]
            Position, velocity and acceleration, in the unit of the axis.

        """
        self._shaft = ShaftState(phi, omega, alpha)
        if self._watch:
            self._progress(phi)
        y, slope, bend, _ = self.sample(phi)
        return y, slope * omega, bend * omega * omega + slope * alpha

    @property
    def course(self) -> tuple[ShaftState, Motion]:
        """Give the shaft as the axis last heard it, at zero if never, and the motion over it."""
        return self._shaft or ShaftState(0.0, 0.0, 0.0), self.motion

    def _progress(self, phi: float) -> None:
        """Change the state where a shaft point gives reason to."""
        plan, coasting = self.plan, self.state is FollowerState.STOPPING_ON_CURVE
        if plan is None:
            if self.state is FollowerState.WAITING:
                self.state = FollowerState.IN_SYNC
            self._watch = False
            return
        share = plan.blend.share(phi)
        if share >= 1.0:
            self._set_motion(plan.blend.new)
            self.plan, self._watch = None, False
        if share > 0.0 and not coasting:
            self.state = self._through if share >= 1.0 else self._begun

    @property
    def speed_bound(self) -> SpeedBound | None:
        """Find the highest speed of the shaft within the limits; None where nothing limits it."""
        bounds = []
        if self.state not in _AT_REST:
            bounds.append(self.layout.speed_bound(self.settings.limits))
        plan = self.plan
        if plan is not None and math.isfinite(plan.highest_speed):
            name = self._begun.value
            bounds.append(SpeedBound(
                plan.highest_speed, 'limits', math.nan, name, plan.blend.start % TURN))
        return min((b for b in bounds if b is not None), key=lambda b: b.omega, default=None)

    # Commands

    def engage(self) -> Plan | None:
        """
        Go from standstill onto the curve.

        Returns
        -------
        Plan | None
            The transition; None when none is needed.

        Raises
        ------
        TransitionError
            When the axis is held, in fault or stopping, or no transition fits.

        """
        if self.state in _TO_BE_RESET:
            raise TransitionError(
                f'the axis is {self.state.value} ({self.reason}): reset it before it engages')
        if self.state in (FollowerState.STOPPING_ON_CURVE, FollowerState.DISENGAGING):
            raise TransitionError(f'the axis is {self.state.value}: engage it when it stands')
        if self.state is not FollowerState.DISENGAGED:
            if self.plan is not None and self._begun is FollowerState.DISENGAGING:
                self._cancel()
                if self.motion != self.layout.motion:
                    # a change had been waiting when it was told to stand
                    return self.change(self.layout)
            return self.plan
        return self._join(self.settings.engage, self._engaged_layout)

    def disengage(self) -> Plan | None:
        """
        Go from the curve to standstill.

        Returns
        -------
        Plan | None
            The transition; None when none is needed.

        Raises
        ------
        TransitionError
            When the axis is stopping already, or no transition fits.

        """
        if self.state in _AT_REST or self.state is FollowerState.DISENGAGING:
            return self.plan
        if self.state is FollowerState.STOPPING_ON_CURVE:
            raise TransitionError('the axis is stopping already')
        stop, shaft = self.settings.stop_position, self._shaft
        if self.state is FollowerState.WAITING and self.plan is not None:
            self._cancel()  # it has not begun: the axis stands where it is
            self.state = FollowerState.DISENGAGED
            return None
        if shaft is None or (shaft.omega == 0.0 == shaft.alpha and stop is None):
            position = self.settings.start_position if shaft is None else (
                self.sample(shaft.phi)[0])
            self._adopt(Standstill(position), FollowerState.DISENGAGED)
            return None
        timing, now = self.settings.disengage, self.sample

        def target(start: float, end: float) -> Goal:
            # halfway the blend neither hurries nor turns back
            at = end if timing.at is At.CYCLE_END else 0.5 * (start + end)
            return Standstill(now(at)[0] if stop is None else stop)
        return self._begin(target, timing, FollowerState.DISENGAGING, FollowerState.DISENGAGED)

    def change(self, layout: Layout, dry: bool = False) -> Plan | None:
        """
        Go over to other cams or couplings.

        Parameters
        ----------
        layout : Layout
            The new cams and couplings; the axis anchors them.
        dry : bool
            Whether only to plan: nothing is changed.

        Returns
        -------
        Plan | None
            The transition; None when none is needed, or the axis stands and takes the layout
            over when it engages.

        Raises
        ------
        TransitionError
            When no transition fits, or the axis is in the middle of something that a change
            would spoil. Everything stays as it was.

        """
        if self.state in (FollowerState.STOPPING_ON_CURVE, FollowerState.DISENGAGING) or (
                self.state is FollowerState.WAITING and self.plan is not None):
            raise TransitionError(f'the axis is {self.state.value}: change it afterwards')
        shaft = self._shaft
        if self.state in _AT_REST or shaft is None:
            if not dry:
                self.layout = layout.anchored_as(self.layout)
                if self.state not in _AT_REST:
                    self._set_motion(self.layout.motion)
            return None
        bound = layout.speed_bound(self.settings.limits)
        check_speed(bound, abs(shaft.omega))
        old, sense = self.layout, -1.0 if shaft.omega < 0.0 else 1.0
        return self._begin(lambda start, _: layout.continuing(old, start, sense),
                           self.settings.change, FollowerState.CHANGING, FollowerState.IN_SYNC,
                           bound, dry)

    def reset(self) -> Plan | None:
        """
        Acknowledge a stop and plan the way back onto the curve.

        Returns
        -------
        Plan | None
            The transition; None when there was nothing to reset, or the axis stands where the
            shaft wants it.

        Raises
        ------
        TransitionError
            When the axis still moves, no shaft has been heard, or no transition fits.

        """
        if self.state is FollowerState.STOPPING_ON_CURVE:
            raise TransitionError('the axis is still moving: reset it when it stands')
        if self.state not in _TO_BE_RESET:
            return self.plan
        if self._through is FollowerState.DISENGAGED:
            self.state = FollowerState.DISENGAGED  # it was told to stand before it was held
            return None
        timing = self.settings.resume
        if timing.at is At.ANGLE and self._held_at is not None:
            timing = replace(timing, angle=self._held_at % TURN)
        layout = self.layout
        return self._join(timing, lambda y, start: layout.ahead_of(y, start))

    # What happens to it

    def coast(self) -> None:
        """Note that the shaft points to come are the axis' own, on its way to rest."""
        if self.state not in _AT_REST:
            self.state = FollowerState.STOPPING_ON_CURVE

    def hold(self, state: FollowerState, reason: str) -> None:
        """
        Stand where the axis is until it is reset.

        Parameters
        ----------
        state : FollowerState
            HELD or FAULT.
        reason : str
            Why.

        """
        shaft, self._shaft = self._shaft, None  # when it is heard again it may be anywhere
        if self.state is FollowerState.DISENGAGED:
            return  # it stands because it was told to
        self.reason = reason
        if self.state not in _TO_BE_RESET:
            self._held_at = 0.0 if shaft is None else shaft.phi
            self._set_motion(Standstill(self.sample(self._held_at)[0]))
        self.plan, self._watch = None, False
        self.state = state

    # How

    def _engaged_layout(self, y: float, start: float) -> Layout:
        """Anchor the layout for an axis that engages from a position at a shaft angle."""
        settings = self.settings
        layout = replace(self.layout, origin=0.0, shift=0.0)
        if settings.master_relative:
            layout = layout.begun_at(start)
        return layout.lifted_to(y, start) if settings.slave_relative else layout.ahead_of(y, start)

    def _join(self, timing: Timing, anchored: Anchor) -> Plan | None:
        shaft = self._shaft
        if shaft is None:
            raise TransitionError('no shaft point has been heard: there is nothing to engage with')
        y = self.sample(shaft.phi)[0]
        if shaft.omega == 0.0 == shaft.alpha:
            layout = anchored(y, shaft.phi)
            there = layout.motion.sample(shaft.phi)[0]
            if abs(there - y) <= _SAME * max(abs(y), abs(there), 1e-6):
                self.layout = layout
                self._adopt(layout.motion, FollowerState.IN_SYNC)
                return None
        return self._begin(lambda start, _: anchored(y, start), timing,
                           FollowerState.ENGAGING, FollowerState.IN_SYNC)

    def _adopt(self, motion: Motion, state: FollowerState) -> None:
        """Take over a motion that is where the axis is."""
        self._set_motion(motion)
        self.plan, self._watch = None, False
        self.state = self._through = state

    def _cancel(self) -> None:
        """Drop a plan that has not begun."""
        if self.plan is not None:
            self._set_motion(self.plan.blend.old)
        self.plan, self._watch = None, False
        self._through = FollowerState.IN_SYNC

    def _begin(self, target: Target, timing: Timing, begun: FollowerState,
               through: FollowerState, bound: SpeedBound | None = None,
               dry: bool = False) -> Plan:
        """Plan a transition from what the axis does now and let it wait for its beginning."""
        shaft = self._shaft
        if shaft is None:
            raise TransitionError('no shaft point has been heard')
        old = self.motion
        if self.plan is not None:
            if self.plan.blend.share(shaft.phi) <= 0.0:
                old = self.plan.blend.old  # it had not begun: this one takes its place
            elif _depth(old) >= _MOST_NESTED:
                raise TransitionError(
                    'too many transitions at once: wait until those under way are through')
        ours = self.layout.speed_bound(self.settings.limits)
        bounds = [b for b in (bound, ours) if b is not None]
        pace = pace_of(shaft, min(bounds, key=lambda b: b.omega, default=None),
                       self.settings.shaft_ramp, self.settings.obeyed)
        plan = plan_transition(old, target, shaft, timing, pace, self.settings.limits,
                               ends_at=through is FollowerState.DISENGAGED)
        if isinstance(plan.goal, Layout):
            plan.goal.check_range(self.settings.limits)
        if dry:
            return plan
        self.plan, self._watch = plan, True
        self._set_motion(plan.blend)
        self._begun, self._through = begun, through
        if isinstance(plan.goal, Layout):
            self.layout = plan.goal
        if begun is FollowerState.ENGAGING:
            self.state = FollowerState.WAITING
        return plan


def _depth(motion: Motion) -> int:
    """Count blends upon blends."""
    return 1 + _depth(motion.old) if isinstance(motion, Blend) else 0
