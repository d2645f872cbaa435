# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What an axis does over the shaft: its motion, the transition to come, and how fast it may go."""

from __future__ import annotations

import math

from cam_motion.motion.limits import Limits, SpeedBound
from cam_motion.runtime.follower_settings import FollowerSettings, FollowerState
from cam_motion.runtime.layout import Layout
from cam_motion.runtime.motion_over_angle import Motion, Standstill
from cam_motion.runtime.pace import pace_of, speed_ahead
from cam_motion.runtime.planning import (
    check_speed,
    Plan,
    plan_transition,
    Timing,
    TransitionError,
    Way,
)
from cam_motion.runtime.recipe import Anchor, Joining, Leaving, Recipe
from cam_motion.runtime.shaft_motion import ShaftState
from cam_motion.runtime.transition import Blend
from cam_motion.runtime.ways import over_cycles, straight
from cam_motion.units import TURN

_SAME = 1e-9  # positions this close, as a share of what they are, are the same
_MOST_NESTED = 4  # transitions begun on top of others that still go on
_TURNED_BACK = 0.1  # further back than where it was planned [rad], a transition is planned anew
_ROOM = 0.98  # of the speed up to which a way onto the curve fits: it begins elsewhere then
_PLAN_AGAIN = 0.125 * TURN  # and if that fails, once more after this way [rad]
TO_BE_RESET = (FollowerState.HELD, FollowerState.FAULT)
AT_REST = (FollowerState.DISENGAGED, *TO_BE_RESET)


class Following:
    """
    The motion of an axis over the shaft, and the transition that goes on or waits to begin.

    Parameters
    ----------
    layout : Layout
        Its cams and their couplings.
    settings : FollowerSettings
        What it may.
    engaged : bool
        Whether it is on its curve from the first shaft point on, or, where the shaft is too fast
        for its limits then, as soon as that has slowed down; else it stands at its start position
        until engaged.

    Attributes
    ----------
    layout : Layout
        The cams and couplings in force, or to which a transition leads.
    settings : FollowerSettings
        What it may; takes effect with the next command.
    plan : Plan | None
        The transition that goes on or waits to begin.
    reason : str
        Why the axis is held or in fault, or why it does not do what it was told.
    revision : int
        Changes whenever something else than the state has: a plan, a reason, a speed bound.
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
        self.revision = 0
        self._shaft: ShaftState | None = None
        self._set_motion(layout.motion if engaged else Standstill(settings.start_position))
        self.state = FollowerState.WAITING if engaged else FollowerState.DISENGAGED
        """What the axis does."""
        self._begun = self._through = self.state  # states while a plan goes on, and after it
        self._recipe: Recipe | None = None  # of the plan
        self._planned_at = 0.0  # shaft angle
        self._leaving: Leaving | None = None
        self._joining: Joining | None = None
        self._rests_in_place = False  # held for no other reason than that nobody listened
        self._bound: tuple[Layout, Limits, SpeedBound | None] | None = None  # as found last
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

    # While the shaft turns

    def _progress(self, phi: float) -> None:
        """Change the state where a shaft point gives reason to."""
        plan, coasting = self.plan, self.state is FollowerState.STOPPING_ON_CURVE
        if plan is None:
            self._come_in(phi)
            return
        share = plan.blend.share(phi)
        if share >= 1.0:
            self._set_motion(plan.blend.new)
            self.plan = self._recipe = self._leaving = None
            self._watch = False
        if coasting:
            return
        if share > 0.0:
            self.state = self._through if share >= 1.0 else self._begun
        elif (phi - self._planned_at) * math.copysign(1.0, plan.blend.span) < -_TURNED_BACK:
            self._plan_anew(phi, plan)

    def _come_in(self, phi: float) -> None:
        """Go onto the curve as soon as the shaft allows it."""
        self._watch, joining = False, self._joining
        if self.state is FollowerState.WAITING and joining is not None:
            self._watch = True
            if self._too_fast is None:
                self._join_late(joining)
        elif self.state is FollowerState.WAITING:
            if self._too_fast is None or not self.settings.obeyed:
                self.state = FollowerState.IN_SYNC
                return
            self._set_motion(Standstill(self.sample(phi)[0]))
            self._await(Joining(over_cycles(self.settings.engage, self.layout), self._ahead))
        elif self._rests_in_place:
            self._rests_in_place = False
            self._rejoin_standing(self._ahead)

    def _join_late(self, joining: Joining) -> None:
        try:
            self._join(joining.timing, joining.anchored)
        except TransitionError as error:
            if error.fits_up_to > 0.0:
                # from standstill it takes more than on the curve
                self._await(joining._replace(highest_speed=_ROOM * error.fits_up_to))
                return
            self._joining = None
            self.state, self.reason = FollowerState.HELD, str(error)

    def _await(self, joining: Joining) -> None:
        """Stand until the shaft is slow enough to join."""
        self._joining, self._watch = joining, True
        self.state = self._begun = self._through = FollowerState.WAITING
        self.reason = ''
        self.revision += 1

    def _plan_anew(self, phi: float, plan: Plan) -> None:
        """Plan a transition that has not begun for a shaft that turns the other way."""
        if self._recipe is None:
            return
        try:
            self._begin(self._recipe)
        except TransitionError as error:
            self.reason = f'the shaft has turned back: {error}'
            self.revision += 1
            back = math.copysign(_PLAN_AGAIN - _TURNED_BACK, plan.blend.span)
            self._planned_at = phi - back

    # How fast the shaft may turn

    @property
    def speed_bound(self) -> SpeedBound | None:
        """Find the highest speed of the shaft within the limits; None where nothing limits it."""
        bounds, plan, leaving = [], self.plan, self._leaving
        if self.state not in AT_REST:
            bounds.append(self._bound_to_join)
        if leaving is not None and not (
                plan and self._shaft and plan.blend.share(self._shaft.phi) > 0.0):
            # the transition has not begun: what it leads away from is still in force
            bounds.append(leaving.layout.speed_bound(self.settings.limits))
            if math.isfinite(leaving.highest_speed):
                bounds.append(SpeedBound(
                    leaving.highest_speed, 'limits', math.nan, 'changing', math.nan))
        if plan is not None and math.isfinite(plan.highest_speed):
            name = self._begun.value
            bounds.append(SpeedBound(
                plan.highest_speed, 'limits', math.nan, name, plan.blend.start % TURN))
        return min((b for b in bounds if b is not None), key=lambda b: b.omega, default=None)

    @property
    def _bound_of_layout(self) -> SpeedBound | None:
        layout, limits = self.layout, self.settings.limits
        if self._bound is None or self._bound[0] is not layout or self._bound[1] is not limits:
            self._bound = layout, limits, layout.speed_bound(limits)
        return self._bound[2]

    @property
    def _bound_to_join(self) -> SpeedBound | None:
        """Give the bound of the layout, or that of the way onto it."""
        bound, joining = self._bound_of_layout, self._joining
        if joining is None or bound is None or joining.highest_speed >= bound.omega:
            return bound
        return SpeedBound(joining.highest_speed, 'limits', math.nan, 'engaging', math.nan)

    @property
    def _too_fast(self) -> SpeedBound | None:
        """Give the bound where the shaft is, or cannot but come, beyond it."""
        bound, shaft = self._bound_to_join, self._shaft
        if bound is None or shaft is None:
            return None
        speed = speed_ahead(shaft, self.settings.shaft_ramp)
        return bound if speed > bound.omega * (1.0 + 1e-9) else None

    @property
    def excess(self) -> str:
        """Say by how much the shaft is too fast for the axis; empty if it is not."""
        bound, shaft = self.speed_bound, self._shaft
        if bound is None or shaft is None or abs(shaft.omega) <= bound.omega * (1.0 + 1e-3):
            return ''
        rpm = self.settings.change.turn / 60.0
        return (f'the shaft runs at {abs(shaft.omega) / rpm:.4g} cycles/min, the axis keeps its '
                f'limits up to {bound.omega / rpm:.4g} ({bound.segment}: {bound.quantity})')

    @property
    def waits_for(self) -> str:
        """Say what keeps an axis that has been told to join from doing so; empty if nothing."""
        bound, shaft = self._bound_to_join, self._shaft
        if self._joining is None or bound is None or shaft is None:
            return ''
        rpm = self.settings.change.turn / 60.0
        return (f'joins when the shaft has slowed down to {bound.omega / rpm:.4g} cycles/min '
                f'({bound.segment}: {bound.quantity}); it runs at {abs(shaft.omega) / rpm:.4g}')

    # How

    def _ahead(self, y: float, start: float, sense: float) -> Layout:
        """Anchor the layout for an axis that comes back to it at a shaft angle."""
        return self.layout.ahead_of(y, start, sense)

    def _rejoin_standing(self, anchored: Anchor) -> bool:
        """Be on the curve if the shaft stands and the axis is there."""
        shaft = self._shaft
        if shaft is None or shaft.omega or shaft.alpha:
            return False
        y = self.sample(shaft.phi)[0]
        layout = anchored(y, shaft.phi, 1.0)
        there = layout.motion.sample(shaft.phi)[0]
        if abs(there - y) > _SAME * max(abs(y), abs(there), 1e-6):
            return False
        self.layout = layout
        self._adopt(layout.motion, FollowerState.IN_SYNC)
        return True

    def _join(self, timing: Timing, anchored: Anchor) -> Plan | None:
        """Plan the way from standstill onto the curve, or wait for a shaft that is too fast."""
        shaft = self._shaft
        if shaft is None:
            raise TransitionError('no shaft point has been heard: there is nothing to engage with')
        if self._rejoin_standing(anchored):
            return None
        too_fast = self._too_fast
        if too_fast is not None:
            if not self.settings.obeyed:
                check_speed(too_fast, speed_ahead(shaft, self.settings.shaft_ramp), timing.turn)
            self._await(Joining(timing, anchored))
            return None
        y = self.sample(shaft.phi)[0]

        def target(old: Motion, start: float, span: float) -> Way:
            return straight(old, anchored(y, start, span), start, span)
        return self._begin(Recipe(target, timing, FollowerState.ENGAGING))

    def _adopt(self, motion: Motion, state: FollowerState) -> None:
        """Take over a motion that is where the axis is."""
        self._set_motion(motion)
        self._forget_plan()
        self.reason = ''
        self.state = self._through = state

    def _forget_plan(self) -> None:
        self.revision += 1
        self.plan = self._recipe = self._leaving = self._joining = None
        self._watch = self._rests_in_place = False

    def _cancel(self) -> None:
        """Drop a plan that has not begun."""
        leaving = self._leaving
        if self.plan is not None:
            self._set_motion(self.plan.blend.old)
        self._forget_plan()
        if self.motion != self.layout.motion:
            self._leaving = leaving  # a change that had been waiting: what was before it holds
        self._through = FollowerState.IN_SYNC

    def _begin(self, recipe: Recipe, dry: bool = False) -> Plan:
        """Plan a transition from what the axis does now and let it wait for its beginning."""
        shaft = self._shaft
        if shaft is None:
            raise TransitionError('no shaft point has been heard')
        old, leaving = self.motion, self._leaving
        if self.plan is None:
            if leaving is None and recipe.begun is not FollowerState.ENGAGING:
                leaving = Leaving(self.layout)
        elif self.plan.blend.share(shaft.phi) <= 0.0:
            old = self.plan.blend.old  # it had not begun: this one takes its place
        elif _depth(old) >= _MOST_NESTED:
            raise TransitionError(
                'too many transitions at once: wait until those under way are through')
        else:
            leaving = Leaving(self.layout, self.plan.highest_speed)
        bounds = [b for b in (recipe.bound, self._bound_of_layout) if b is not None]
        pace = pace_of(shaft, min(bounds, key=lambda b: b.omega, default=None),
                       self.settings.shaft_ramp, self.settings.obeyed)
        plan = plan_transition(old, recipe.target, shaft, recipe.timing, pace,
                               self.settings.limits,
                               ends_at=recipe.through is FollowerState.DISENGAGED)
        if isinstance(plan.goal, Layout):
            plan.goal.check_range(self.settings.limits)
        if dry:
            return plan
        self._lay(plan, recipe, leaving)
        self._begun, self._through = recipe.begun, recipe.through
        self._planned_at = shaft.phi
        if isinstance(plan.goal, Layout):
            self.layout = plan.goal
        if recipe.begun is FollowerState.ENGAGING:
            self.state = FollowerState.WAITING
        return plan

    def _lay(self, plan: Plan, recipe: Recipe | None, leaving: Leaving | None) -> None:
        """Let a plan wait for its beginning: a change, unless said otherwise."""
        self._forget_plan()
        self.plan, self._recipe, self._leaving = plan, recipe, leaving
        self._watch, self.reason = True, ''
        self._begun, self._through = FollowerState.CHANGING, FollowerState.IN_SYNC
        self._set_motion(plan.blend)


def _depth(motion: Motion) -> int:
    """Count blends upon blends."""
    return 1 + _depth(motion.old) if isinstance(motion, Blend) else 0
