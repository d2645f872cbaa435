# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The ways from one motion to another: onto other cams, and into standstill."""

from __future__ import annotations

from dataclasses import replace

from cam_motion.runtime.layout import Layout
from cam_motion.runtime.motion_over_angle import Motion, Standstill
from cam_motion.runtime.planning import At, Goal, Target, Timing, Way
from cam_motion.runtime.speed_blend import SpeedBlend
from cam_motion.runtime.transition import Blend
import numpy as np

_LOOKS = 65  # angles at which a way is compared with the motions that it joins
_BEYOND = 1e-6  # by which share of the speeds it may go beyond them, for rounding


def straight(old: Motion, goal: Goal, start: float, span: float) -> Way:
    """
    Go to a goal that stays where it is, by a blend of positions.

    Parameters
    ----------
    old : Motion
        What the axis does before.
    goal : Goal
        What it is to do.
    start, span : float
        Where the transition begins, and over which shaft angle it goes [rad].

    Returns
    -------
    Way
        The way.

    """
    return Way(goal, Blend(old, goal.motion, start, span))


def going_over(old: Layout, new: Layout) -> Target:
    """
    Go over to other cams or couplings.

    Parameters
    ----------
    old, new : Layout
        The layout before, and the one afterwards as far as it is not anchored.

    Returns
    -------
    Callable[[Motion, float, float], Way]
        Makes the way. A belt with other strokes makes the whole new stroke in the cycle in which
        it changes, if its speed stays between the two motions on the way; else, as an electronic
        gear always, it goes from one speed to the other and on from where that has led it.

    """
    def way(motion: Motion, start: float, span: float) -> Way:
        goal = new.continuing(old, start, -1.0 if span < 0.0 else 1.0)
        made = straight(motion, goal, start, span)
        if goal.keeps_register(old) or _is_between(made.blend):
            return made
        gap = SpeedBlend(motion, goal.motion, start, span).gap
        goal = goal.shifted(gap)
        return Way(goal, SpeedBlend(motion, goal.motion, start, span))
    return way


def standing(layout: Layout, position: float | None, at_end: bool) -> Target:
    """
    Go to standstill.

    Parameters
    ----------
    layout : Layout
        The layout that the axis leaves.
    position : float | None
        Where it is to stand, in its unit: for a belt, whole strokes further, never back.
    at_end : bool
        Whether, without a position, it is to stand where it has come to in the end.

    Returns
    -------
    Callable[[Motion, float, float], Way]
        Makes the way. Without a position it slows down and goes never beyond the speed and the
        places that it would have had.

    """
    def way(motion: Motion, start: float, span: float) -> Way:
        there = motion.sample(start + span)[0]
        if position is not None:
            strokes = layout.strokes_ahead(position, there, span)
            return straight(motion, Standstill(position + strokes), start, span)
        if at_end:
            return straight(motion, Standstill(there), start, span)
        goal = Standstill(there + SpeedBlend(motion, Standstill(there), start, span).gap)
        return Way(goal, SpeedBlend(motion, goal, start, span))
    return way


def over_cycles(timing: Timing, layout: Layout) -> Timing:
    """
    Let the end of a cycle be that of the cams in use, not that of the shaft.

    Parameters
    ----------
    timing : Timing
        When a transition is to begin.
    layout : Layout
        The cams.

    Returns
    -------
    Timing
        The same with the end of the cycle, where it depends on that.

    """
    if timing.at is not At.CYCLE_END:
        return timing
    begin, period = layout.cycle
    return replace(timing, angle=begin, every=period)


def _is_between(blend: Blend) -> bool:
    """Tell whether the speed of a blend stays between the speeds of what it joins."""
    phi = np.linspace(blend.start, blend.end, _LOOKS)
    speeds = np.concatenate([blend.old(phi)[1], blend.new(phi)[1]])
    low, high = float(speeds.min()), float(speeds.max())
    slack = _BEYOND * max(abs(low), abs(high))
    found = blend(phi)[1]
    return bool(found.min() >= low - slack and found.max() <= high + slack)
