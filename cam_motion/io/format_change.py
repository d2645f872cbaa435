# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Planning a change of format of a whole line: what changes, where, over which shaft angle."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
import math
from typing import Any

from cam_motion.errors import CamMotionError, ConfigurationError, Problem
from cam_motion.io.axis import axis_table, build_axis, CoupledAxis, Values
from cam_motion.io.axis_limits import CascadedAxis
from cam_motion.io.axis_parameters import SHAFT
from cam_motion.io.format_parameters import is_of_a_format
from cam_motion.io.machine import Machine
from cam_motion.io.parameters import is_of_every_node, REQUIRED
from cam_motion.runtime.demand import Demand
from cam_motion.runtime.format_change import fixed_plan, shortest_plan
from cam_motion.runtime.interlock import Verdict
from cam_motion.runtime.motion_over_angle import Cascade, Motion
from cam_motion.runtime.planning import check_speed, next_angle, Plan, TransitionError
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.ways import going_over
from cam_motion.units import DEGREE, RPM, TURN

_TRIES = 24  # shaft angles within a turn at which a change is tried
_STEADY = RampLimits(0.0, 0.0)
_AHEAD = 2.0  # from now to the beginning of the change at least [s]


class FormatError(CamMotionError):
    """A change of format that cannot be made; nothing has changed."""


@dataclass(frozen=True)
class AxisChange:
    """
    What changes on one axis.

    Attributes
    ----------
    given : Mapping[str, Any]
        All its new parameters by flat name.
    differences : Mapping[str, tuple[Any, Any]]
        Values before and after by name, None where there is none.
    plan : Plan | None
        The transition; None for an axis that stands.

    """

    given: Values
    differences: Mapping[str, tuple[Any, Any]]
    plan: Plan | None


@dataclass(frozen=True)
class FormatPlan:
    """
    A change of format of a line.

    Attributes
    ----------
    at : float
        Shaft angle within a turn at which all axes begin [rad].
    span : float
        Shaft angle over which they all change [rad]; one for all, so that distances between
        axes stay between what they are before and after.
    sense : float
        -1 for a shaft that turns backwards.
    speed : float
        Speed of the shaft for which it was planned, a magnitude [rad/s].
    axes : Mapping[str, AxisChange]
        The axes that change; none where the line has this format already.
    verdicts : Mapping[str, Verdict]
        How the interlocks are kept while the axes change.

    """

    at: float
    span: float
    sense: float
    speed: float
    axes: Mapping[str, AxisChange]
    verdicts: Mapping[str, Verdict]

    def start(self, phi: float, omega: float) -> float:
        """
        Choose the shaft angle from which on all axes change.

        Parameters
        ----------
        phi, omega : float
            Angle [rad] and speed [rad/s] of the shaft now.

        Returns
        -------
        float
            The next passage of the planned angle that is two seconds and a transition ahead,
            unwrapped [rad].

        """
        lead = abs(omega) * _AHEAD + self.span
        return next_angle(phi + self.sense * lead, self.at, self.sense)


def check_fixed(before: CoupledAxis, after: CoupledAxis) -> None:
    """
    Check that a format leaves alone what is no part of a format.

    Parameters
    ----------
    before, after : CoupledAxis
        The axis as it is, and as it is to be.

    Raises
    ------
    ConfigurationError
        With every parameter that would have to change.

    """
    problems = [
        Problem(key, after.values[key], f'is no part of a format: it is {before.values[key]!r} '
                'until the axis is started anew')
        for key in after.values
        if not is_of_a_format(key) and after.values[key] != before.values.get(key)]
    if before.values['follows'] != SHAFT:
        problems.append(Problem(
            'follows', before.values['follows'], 'only an axis that follows the shaft itself '
            'knows at which shaft angle to change'))
    if problems:
        raise ConfigurationError(problems)


def plan_format(machine: Machine, sections: Mapping[str, Values], running: Mapping[str, Values],
                speed: float, at: float | None = None, standing: Collection[str] = ()
                ) -> FormatPlan:
    """
    Plan a change of format.

    Parameters
    ----------
    machine : Machine
        The machine in the new format, checked at the present speed of the shaft.
    sections : Mapping[str, Mapping[str, Any]]
        Its parameters by node.
    running : Mapping[str, Mapping[str, Any]]
        Parameters of the axes as they are, by axis and flat name.
    speed : float
        Speed of the shaft, negative backwards [rad/s].
    at : float | None
        Shaft angle within a turn at which the axes are to begin [rad]; None looks for one, from
        the end of the cycle on.
    standing : Collection[str]
        Axes that stand, and will move only when they engage.

    Returns
    -------
    FormatPlan
        The change.

    Raises
    ------
    ConfigurationError
        When something would change that is no part of a format, or other axes are running.
    FormatError
        When limits or interlocks would not be kept on the way.

    """
    new = {name: axis for name, axis in machine.diagram.axes.items()
           if isinstance(axis, CoupledAxis)}
    problems = [Problem(f'line.axes.{name}', name, 'the running line has no such axis')
                for name in new if name not in running]
    problems += [Problem('line.axes', list(new), f'the running line has an axis {name} too',
                         'a format describes all axes') for name in running if name not in new]
    old, changes = {}, {}
    for name in new if not problems else ():
        old[name] = build_axis(name, running[name])
        given = {key: value for key, value in sections[name].items()
                 if value is not None and not is_of_every_node(key)}
        different = differences(running[name], given)
        if different:
            changes[name] = (given, different)
            try:
                check_fixed(old[name], new[name])
            except ConfigurationError as error:
                problems += [problem.below(name) for problem in error.problems]
    if problems:
        raise ConfigurationError(problems)
    sense, pace = -1.0 if speed < 0.0 else 1.0, abs(speed)
    if not changes:
        return FormatPlan(at or 0.0, 0.0, sense, pace, {}, {})
    moving = {name: new[name] for name in changes if name not in standing}
    refusals: list[str] = []
    ways: list[tuple[float, dict[str, Plan]]] = []
    tries = [k * TURN / _TRIES for k in range(_TRIES)] if at is None else [at]
    for angle in tries:
        try:
            ways.append((angle, _transitions(old, moving, angle, sense, pace)))
        except TransitionError as error:
            refusals.append(str(error))
    # the gentlest one first: the shaft might go fastest with it
    ways.sort(key=lambda way: -min(
        (plan.highest_speed for plan in way[1].values()), default=math.inf))
    for angle, plans in ways:
        try:
            verdicts = _check_together(machine, new, plans, pace)
        except TransitionError as error:
            refusals.append(str(error))
            continue
        spans = [abs(plan.blend.span) for plan in plans.values()] or [
            new[name].settings.change.span for name in changes]
        return FormatPlan(angle, max(spans), sense, pace, {
            name: AxisChange(given, different, plans.get(name))
            for name, (given, different) in changes.items()}, verdicts)
    more = '' if at is not None else ' (and no other angle that was tried will do)'
    raise FormatError(f'no change at {tries[0] / DEGREE:g} deg{more}: {refusals[0]}')


def differences(running: Values, given: Values) -> dict[str, tuple[Any, Any]]:
    """
    Compare parameters of an axis, defaults filled in.

    Parameters
    ----------
    running, given : Mapping[str, Any]
        Parameters by flat name.

    Returns
    -------
    dict[str, tuple[Any, Any]]
        Values before and after by name, None where there is none.

    """
    def filled(values: Values) -> dict[str, Any]:
        defaults = {spec.name: spec.default for spec in axis_table(values)
                    if spec.default is not None and spec.default is not REQUIRED}
        return {**defaults, **values}
    before, after = filled(running), filled(given)
    return {name: (before.get(name), after.get(name))
            for name in dict.fromkeys([*before, *after]) if before.get(name) != after.get(name)}


def _transitions(old: Mapping[str, CoupledAxis], moving: Mapping[str, CoupledAxis], at: float,
                 sense: float, speed: float) -> dict[str, Plan]:
    """Plan the transitions of axes that move, over the span that the slowest of them needs."""
    span, name = 0.0, ''
    try:
        for name, axis in moving.items():
            settings = axis.settings
            check_speed(axis.layout.speed_bound(settings.limits), speed)
            span = max(span, abs(shortest_plan(
                old[name].layout, axis.layout, at, sense, settings, speed).blend.span))
    except TransitionError as error:
        raise TransitionError(f'{name}: {error}') from None
    plans = {name: fixed_plan(
        old[name].layout.motion, going_over(old[name].layout, axis.layout), at, sense * span,
        axis.settings, speed) for name, axis in moving.items()}
    for name, plan in plans.items():
        _check_allowed(name, plan.highest_speed, speed, span)
    return plans


def _check_allowed(name: str, allowed: float, speed: float, span: float) -> None:
    if allowed < speed:
        raise TransitionError(
            f'{name}: over the {span / DEGREE:.4g} deg that all axes need it keeps its limits up '
            f'to {allowed / RPM:.4g} cycles/min only, the shaft runs at {speed / RPM:.4g}: slow '
            'down, or change at another angle')


def _check_together(machine: Machine, axes: Mapping[str, CoupledAxis],
                    plans: Mapping[str, Plan], speed: float) -> dict[str, Verdict]:
    """Check on the way what concerns several axes: interlocks, and axes that follow others."""
    blends = {name: plan.blend for name, plan in plans.items()}
    if not blends:
        return {}
    low, high = sorted((next(iter(blends.values())).start, next(iter(blends.values())).end))
    own: dict[str, Motion] = {
        name: blends.get(name, axis.layout.motion) for name, axis in axes.items()}
    motions = {name: _chained(name, axes, own) for name in axes}
    for name, axis in axes.items():
        if isinstance(axis, CascadedAxis):
            allowed = Demand(motions[name], low, high).highest_speed(axis.limits, _STEADY)
            _check_allowed(name, allowed, speed, high - low)
    verdicts = {}
    for name, each in machine.interlocks.items():
        verdicts[name] = verdict = each.interlock.judge(motions, low, high, repeats=False)
        if not verdict.kept:
            raise TransitionError(f'interlock {name} would be broken on the way: {verdict.text}')
    return verdicts


def _chained(name: str, axes: Mapping[str, CoupledAxis], motions: Mapping[str, Motion]) -> Motion:
    """Give what an axis does over the shaft, through the axes that it follows."""
    source = axes[name].values['follows']
    if source == SHAFT:
        return motions[name]
    return Cascade(motions[name], _chained(source, axes, motions))
