# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Whether axes keep their limits at the set speed, those that follow other axes included."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.axis import ANYWHERE, build_axis, CoupledAxis, Reach, Values
from cam_motion.io.axis_parameters import SHAFT
from cam_motion.motion.limits import Limits, QUANTITIES, SpeedBound
from cam_motion.runtime.demand import AnyPhaseCascade, Demand, Demands
from cam_motion.runtime.layout import EQUAL, LARGEST_SHARE, MOST_TURNS
from cam_motion.runtime.motion_over_angle import Cascade, Motion
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.ramp_room import RampRoom
from cam_motion.units import DEGREE, rate_text, RPM, TURN

_STEADY = RampLimits(0.0, 0.0)


@dataclass(frozen=True)
class CascadedAxis(CoupledAxis):
    """
    An axis that follows another one.

    Attributes
    ----------
    motion : Motion
        Its motion over the angle of the shaft, through all axes between.
    period : float
        Shaft angle after which the motion repeats [rad]; for one that never does, or after very
        many turns, that of the axis on the shaft.
    course : Demands
        What the motion demands for ever.

    """

    motion: Motion = field(kw_only=True)
    period: float = field(kw_only=True)
    course: Demands = field(kw_only=True)

    def bound_by(self, limits: Limits) -> SpeedBound | None:
        """
        Find the highest steady shaft speed within given limits.

        Parameters
        ----------
        limits : Limits
            The limits.

        Returns
        -------
        SpeedBound | None
            The speed and what holds it there; None where nothing does.

        """
        omega = self.course.highest_speed(limits, _STEADY)
        if math.isinf(omega):
            return None
        names = [name for order, name in enumerate(QUANTITIES[1:], 1) if limits.of_order(order)]
        limit = limits.of_order(QUANTITIES.index(names[0])) if len(names) == 1 else None
        return SpeedBound(omega, names[0], math.nan if limit is None else limit,
                          f'behind {self.values["follows"]}', math.nan)


def in_cascade(axes: Mapping[str, CoupledAxis | None], problems: list[Problem],
               ) -> dict[str, CoupledAxis | None]:
    """
    Join axes that follow others to what these do.

    Parameters
    ----------
    axes : Mapping[str, CoupledAxis | None]
        The axes by name; None for one that could not be built.
    problems : list[Problem]
        Gets what is wrong: an axis that follows none of the line, or, in the end, itself.

    Returns
    -------
    dict[str, CoupledAxis | None]
        The axes, those in cascade with their motion over the angle of the shaft.

    """
    found: dict[str, CoupledAxis | None] = {}
    for name, axis in axes.items():
        found[name] = axis
        chain = [name]
        while axis is not None and (source := axis.values['follows']) != SHAFT:
            if source not in axes or source in chain:
                problems.append(Problem(
                    f'{name}.follows', source, 'must name the shaft, or an axis of the line that '
                    'does not itself follow this one', 'known are: ' + ', '.join([SHAFT, *axes])))
                break
            chain.append(source)
            axis = axes[source]
        else:
            if len(chain) > 1 and axis is not None:
                found[name] = _cascaded([axes[link] for link in chain])
    return found


def _cascaded(chain: list[CoupledAxis | None]) -> CoupledAxis | None:
    """Join an axis to those that it follows, the one on the shaft last."""
    links = [link for link in chain if link is not None]
    if len(links) < len(chain):
        return chain[0]
    first = links[-1].layout
    motion: Motion = first.motion
    period, gain, course = first.period, first.advance * first.period / TURN, first.course
    for link in reversed(links[:-1]):
        outer = link.layout
        motion = Cascade(outer.motion, motion)
        # both repeat together where the inner one gains a rational share of the outer's period
        share = gain / outer.period
        rational = Fraction(share).limit_denominator(LARGEST_SHARE) if math.isfinite(share) else (
            None)
        if rational is None or abs(share - rational) > EQUAL * max(1.0, abs(share)):
            period = gain = math.nan
        else:
            period *= rational.denominator
            gain = outer.advance * outer.period / TURN * rational.numerator
        if rational is not None and max(period / TURN, abs(rational.numerator)) <= MOST_TURNS:
            course = Demand(motion, 0.0, period)
        else:
            course = AnyPhaseCascade(outer.course, course)
    own = {name: getattr(links[0], name) for name in CoupledAxis.__dataclass_fields__}
    if not period <= LARGEST_SHARE * TURN:
        period = first.cycle.period
    return CascadedAxis(**own, motion=motion, period=period, course=course)


def axes_of(sections: Mapping[str, Values]) -> dict[str, CoupledAxis]:
    """
    Build the axes of a line as far as they can be used.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of the axes, by name.

    Returns
    -------
    dict[str, CoupledAxis]
        The axes, those in cascade joined to what they follow; what cannot be used is left out,
        its own node says why.

    """
    axes: dict[str, CoupledAxis | None] = {}
    for name, section in sections.items():
        try:
            axes[name] = build_axis(name, section)
        except ConfigurationError:
            axes[name] = None
    found = in_cascade(axes, [])
    return {name: axis for name, axis in found.items() if axis is not None}


def reach_of(axis: CoupledAxis) -> Reach:
    """
    Find between which positions an axis stays as it is configured.

    Parameters
    ----------
    axis : CoupledAxis
        The axis.

    Returns
    -------
    tuple[float, float]
        The lowest and the highest; infinite for one that accumulates, or that adds its motion to
        the position at which it stands.

    """
    if axis.layout.accumulates or axis.values['engage.slave'] == 'relative':
        return ANYWHERE
    y = axis.layout.course.values[0]
    return float(y.min()), float(y.max())


def ramp_room(axes: Iterable[CoupledAxis]) -> RampRoom:
    """
    Find the room that the limits of axes leave for the acceleration of the shaft.

    Parameters
    ----------
    axes : Iterable[CoupledAxis]
        The axes.

    Returns
    -------
    RampRoom
        The room.

    """
    return RampRoom(
        (axis.course if isinstance(axis, CascadedAxis) else axis.layout.course, axis.limits)
        for axis in axes)


def speed_problems(axis: CoupledAxis, omega: float) -> list[Problem]:
    """
    Check whether an axis keeps its limits at a steady shaft speed.

    Parameters
    ----------
    axis : CoupledAxis
        The axis.
    omega : float
        Speed of the shaft [rad/s].

    Returns
    -------
    list[Problem]
        One problem per limit that would break, with the figures.

    """
    problems = []
    for order, quantity in enumerate(QUANTITIES[1:], start=1):
        limit = axis.limits.of_order(order)
        if limit is None:
            continue
        bound = axis.bound_by(Limits(**{quantity: limit}))
        if bound is None or abs(omega) <= bound.omega * (1.0 + 1e-9):
            continue
        unit = rate_text(axis.unit, order)
        where = f'segment {bound.segment} at {bound.at / DEGREE:.4g} deg'
        if math.isnan(bound.at):
            where = bound.segment  # several cams, or axes in cascade, found on a grid
        if bound.omega == 0.0:
            rule = f'the acceleration steps in {where}: no jerk limit can be met'
            hint = 'take a law whose acceleration is continuous, or leave the jerk unlimited'
        else:
            # a product grows to infinity where a power would raise
            needed = limit * math.prod([abs(omega) / bound.omega] * order)
            rule = (f'at {abs(omega) / RPM:g} cycles/min {where} needs {needed:.6g} {unit}')
            # cut, not rounded: the figure given must itself be allowed
            most = math.floor(bound.omega / RPM * 100.0) / 100.0
            hint = (f'run at most {most:.2f} cycles/min, raise the limit, or give '
                    'the segment more angle or another law')
        problems.append(Problem(f'{axis.name}.limits.{quantity}', limit, rule, hint))
    return problems
