# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Laws made to fit what lies before and behind them: velocity and acceleration at both ends."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
import math
from typing import Any, NamedTuple

from cam_motion.errors import ConfigurationError
from cam_motion.motion.laws.law import LAWS, make_law, MotionLaw
from cam_motion.motion.laws.parameters import LARGEST_VALUE

FITS = 1e-9
"""How far (relative) an end may be from what is asked of it: as far as a joint may step."""

_BY_NEIGHBOURS = 'auto'
_IN_UNITS_OF_THE_AXIS = ('auto', 'spline')  # their velocities are not in lifts per span
_MIDDLE = {'inflection': 0.5}  # for laws that cannot begin with every velocity without it


class EndCondition(NamedTuple):
    """
    What is asked of a law at one end.

    ``velocity`` [lifts per span] and ``acceleration`` [lifts per span²]; None where anything goes.
    """

    velocity: float | None = None
    acceleration: float | None = None


REST = EndCondition(0.0, 0.0)
"""A dwell."""

Conditions = tuple[EndCondition, EndCondition]
"""What is asked at the start and at the end."""


def fitted(name: str, conditions: Conditions) -> MotionLaw | None:
    """
    Make a law so that it meets what is asked of its ends, as far as its parameters allow.

    Parameters
    ----------
    name : str
        A name in `LAWS`.
    conditions : tuple[EndCondition, EndCondition]
        What is asked of its start and of its end.

    Returns
    -------
    MotionLaw | None
        The law: its velocities, and accelerations where it takes them, are those asked for, all
        other parameters their defaults. None where the law takes no such parameters, where all
        that it would be told is to stand still, or where it cannot be told so.

    """
    known = {parameter.name for parameter in LAWS[name].parameters}
    if name in _IN_UNITS_OF_THE_AXIS:
        return None
    told: dict[str, Any] = {
        f'{end}_{quantity}': value
        for end, condition in zip(('start', 'end'), conditions)
        for quantity, value in condition._asdict().items()
        if value is not None and f'{end}_{quantity}' in known}
    if not any(told.values()) or any(abs(value) > LARGEST_VALUE for value in told.values()):
        return None
    for more in ({}, _MIDDLE if 'inflection' in known else {}):
        try:
            return make_law(name, **told, **more)
        except ConfigurationError:
            continue
    return None


def misses(law: MotionLaw, conditions: Conditions, order: int) -> tuple[bool, bool]:
    """
    Tell at which ends a law does not do what is asked of it.

    Parameters
    ----------
    law : MotionLaw
        The law, normalised.
    conditions : tuple[EndCondition, EndCondition]
        What is asked.
    order : int
        1 for the velocity, 2 for the acceleration.

    Returns
    -------
    tuple[bool, bool]
        Whether it misses at its start, and at its end.

    """
    largest = abs(law.curve.peak(order).value)

    def miss(has: float, asked: float | None) -> bool:
        return asked is not None and (
            math.isinf(asked) or abs(has - asked) > FITS * max(largest, abs(asked)))
    start, end = law.curve.end_values(order)
    return miss(start, conditions[0][order - 1]), miss(end, conditions[1][order - 1])


def laws_meeting(conditions: Conditions) -> list[MotionLaw]:
    """
    List the laws that join two ends without a step of velocity or acceleration.

    Parameters
    ----------
    conditions : tuple[EndCondition, EndCondition]
        What is asked of the start and of the end.

    Returns
    -------
    list[MotionLaw]
        The laws in the order of the registry, parameters as in `fitted`; ``auto`` is among
        them, for a cam fits it. Those that take their shape from points are where their
        defaults meet what is asked.

    """
    found = []
    for name in LAWS:
        if name == 'dwell':
            continue
        made = fitted(name, conditions)
        if name == _BY_NEIGHBOURS:
            found.append(_default(name))
        else:
            made = made or _default(name)
            if not any(misses(made, conditions, 1) + misses(made, conditions, 2)):
                found.append(made)
    return found


def told_to(law: MotionLaw) -> str:
    """
    Write the parameters of a law that are not its defaults, as a configuration does.

    Parameters
    ----------
    law : MotionLaw
        The law.

    Returns
    -------
    str
        ``start_velocity: 1, inflection: 0.4``, with as many digits as a joint needs.

    """
    defaults = {parameter.name: parameter.default for parameter in LAWS[law.name].parameters}
    return ', '.join(f'{name}: {_value_text(value)}' for name, value in law.parameters.items()
                     if value != defaults[name])


def scaled_condition(velocity: float, acceleration: float, span: float,
                     lift: float) -> EndCondition:
    """
    Say what a neighbour does in lifts and spans of the segment that meets it.

    Parameters
    ----------
    velocity, acceleration : float
        What the neighbour does [unit/rad, unit/rad²], or per s and s².
    span : float
        Span of the segment [rad], or how long it lasts [s].
    lift : float
        Its lift [unit].

    Returns
    -------
    EndCondition
        The condition; without a lift only rest can be asked for, all else is infinite.

    """
    if not lift:
        return EndCondition(*(math.copysign(math.inf, x) if x else 0.0
                              for x in (velocity, acceleration)))
    # zero, not minus zero: people read it
    return EndCondition(velocity * span / lift + 0.0, acceleration * span ** 2 / lift + 0.0)


def _value_text(value: Any) -> str:
    if isinstance(value, Sequence):
        return f'[{", ".join(map(_value_text, value))}]'
    return f'{value:.12g}'


@cache
def _default(name: str) -> MotionLaw:
    return make_law(name)
