# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""An axis that follows the shaft: engaged or not, changing, stopping, resuming, never jumping."""

from __future__ import annotations

from dataclasses import replace

from cam_motion.runtime.follower_settings import FollowerState
from cam_motion.runtime.following import AT_REST, Following, TO_BE_RESET
from cam_motion.runtime.layout import Layout
from cam_motion.runtime.motion_over_angle import Standstill
from cam_motion.runtime.planning import At, check_speed, Plan, TransitionError
from cam_motion.runtime.recipe import Recipe
from cam_motion.runtime.ways import going_over, over_cycles, standing

_ON_ITS_WAY = (FollowerState.WAITING, FollowerState.ENGAGING, FollowerState.IN_SYNC,
               FollowerState.CHANGING)


class Follower(Following):
    """
    The state machine of an axis over the shaft: its commands, and what happens to it.

    Its parameters and attributes are those of `Following`.

    """

    _held_at: float | None = None  # shaft angle at which the axis came to be held

    # Commands

    def engage(self) -> Plan | None:
        """
        Go from standstill onto the curve.

        Returns
        -------
        Plan | None
            The transition; None when none is needed, or the axis `waits_for` a slower shaft.

        Raises
        ------
        TransitionError
            When the axis is held, in fault or stopping, no transition fits, or the shaft is too
            fast and cannot be asked to slow down.

        """
        if self.state in TO_BE_RESET:
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
        timing, layout = self.settings.engage, replace(self.layout, origin=0.0, shift=0.0)
        if self.settings.master_relative:
            timing = replace(timing, angle=timing.angle if timing.at is At.ANGLE else 0.0)
        else:
            timing = over_cycles(timing, layout)
        return self._join(timing, self._engaged_layout)

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
        if self.state in AT_REST or self.state is FollowerState.DISENGAGING:
            return self.plan
        if self.state is FollowerState.STOPPING_ON_CURVE:
            raise TransitionError('the axis is stopping already')
        stop, shaft = self.settings.stop_position, self._shaft
        if self.state is FollowerState.WAITING and (self.plan or self._joining):
            self._cancel()  # it has not begun: the axis stands where it is
            self.state = FollowerState.DISENGAGED
            return None
        if shaft is None or (shaft.omega == 0.0 == shaft.alpha and stop is None):
            position = self.settings.start_position if shaft is None else (
                self.sample(shaft.phi)[0])
            self._adopt(Standstill(position), FollowerState.DISENGAGED)
            return None
        timing = over_cycles(self.settings.disengage, self.layout)
        target = standing(self.layout, stop, timing.at is At.CYCLE_END)
        return self._begin(Recipe(
            target, timing, FollowerState.DISENGAGING, FollowerState.DISENGAGED))

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
        stands = self.state in AT_REST or self._joining is not None
        if stands or shaft is None:
            if not dry:
                self.layout = layout.anchored_as(self.layout)
                if not stands:
                    self._set_motion(self.layout.motion)
            return None
        bound = layout.speed_bound(self.settings.limits)
        check_speed(bound, abs(shaft.omega), self.settings.change.turn)
        return self._begin(Recipe(
            going_over(self.layout, layout), over_cycles(self.settings.change, self.layout),
            bound=bound), dry)

    def reset(self) -> Plan | None:
        """
        Acknowledge a stop and plan the way back onto the curve.

        Returns
        -------
        Plan | None
            The transition; None when there was nothing to reset, or the axis stands where the
            shaft wants it, or it `waits_for` a slower shaft.

        Raises
        ------
        TransitionError
            When the axis still moves, no shaft has been heard, no transition fits, or the shaft
            is too fast and cannot be asked to slow down.

        """
        if self.state is FollowerState.STOPPING_ON_CURVE:
            raise TransitionError('the axis is still moving: reset it when it stands')
        if self.state not in TO_BE_RESET:
            return self.plan
        if self._through is FollowerState.DISENGAGED:
            self.state = FollowerState.DISENGAGED  # it was told to stand before it was held
            self.reason = ''
            return None
        timing = self.settings.resume
        if timing.at is At.ANGLE and self._held_at is not None:
            # where the cams, and not only the shaft, are again where they were
            timing = replace(timing, angle=self._held_at, every=self.layout.cycle.period)
        return self._join(timing, self._ahead)

    # What happens to it

    def coast(self) -> None:
        """Note that the shaft points to come are the axis' own, on its way to rest."""
        if self.state not in AT_REST:
            self.state = FollowerState.STOPPING_ON_CURVE

    def hold(self, state: FollowerState, reason: str, in_place: bool = False) -> None:
        """
        Stand where the axis is until it is reset; a fault remains one.

        Parameters
        ----------
        state : FollowerState
            HELD or FAULT.
        reason : str
            Why.
        in_place : bool
            Whether an axis that was on its way goes on without a reset where the next shaft point
            stands still and finds it on its curve.

        """
        shaft, self._shaft = self._shaft, None  # when it is heard again it may be anywhere
        if self.state in (FollowerState.DISENGAGED, FollowerState.FAULT):
            return  # it stands because it was told to, or for a better reason
        self.reason = reason
        in_place = in_place and (self._rests_in_place or (
            self.state in _ON_ITS_WAY and self._through is not FollowerState.DISENGAGED))
        if self.state not in TO_BE_RESET:
            self._held_at = 0.0 if shaft is None else shaft.phi
            self._set_motion(Standstill(self.sample(self._held_at)[0]))
        self._forget_plan()
        self.state = state
        self._rests_in_place = self._watch = in_place

    # How

    def _engaged_layout(self, y: float, start: float, sense: float) -> Layout:
        """Anchor the layout for an axis that engages from a position at a shaft angle."""
        settings = self.settings
        layout = replace(self.layout, origin=0.0, shift=0.0)
        if settings.master_relative:
            layout = layout.begun_at(start)
        if settings.slave_relative:
            return layout.lifted_to(y, start)
        return layout.ahead_of(y, start, sense)
