# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The motion law: a normalised rise s(xi), and the registry of all laws by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
import math
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws.boundary import Boundary
from cam_motion.motion.laws.parameters import LawParameter
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import JOINT_TOLERANCE, Piecewise
from numpy.typing import ArrayLike

Builder = Callable[..., Piecewise]


@dataclass(frozen=True)
class Coefficients:
    """
    The characteristic values of a law between neighbours that move as its own ends do.

    A real movement of lift h in time T has the peaks ``cv h/T``, ``ca h/T²``, ``cj h/T³``. An
    acceleration at an end counts as a step all the same: so it is at a dwell, where most of
    these laws stand; at a turn of the same acceleration `cj_inside` holds.

    Attributes
    ----------
    cv, ca, cj : float
        Largest magnitudes of s', s'', s''' [-]; infinite where the derivative before steps.
    ca_inside, cj_inside : float
        Largest magnitudes of s'' and s''' between the steps [-].
    power : float
        Largest magnitude of s' s'' [-]: the power that an inertia takes.
    rms_acceleration : float
        Root mean square of s'' [-]: what heats a servo motor.
    ca_least, ca_greatest : float
        Least and greatest value of s'' between the steps, with their signs [-].

    """

    cv: float
    ca: float
    cj: float
    ca_inside: float
    cj_inside: float
    power: float
    rms_acceleration: float
    ca_least: float
    ca_greatest: float


@dataclass(frozen=True)
class MotionLaw:
    """
    A normalised rise s(xi) for 0 <= xi <= 1, with s(0) = 0 and s(1) = 1 (a dwell stays at 0).

    Attributes
    ----------
    name : str
        Name in the registry.
    parameters : Mapping[str, Any]
        The law's parameters, defaults filled in.
    curve : Piecewise
        The rise as an exact curve.

    """

    name: str
    parameters: Mapping[str, Any]
    curve: Piecewise

    def __call__(self, xi: ArrayLike, order: int = 0) -> Array:
        """
        Evaluate the law.

        Parameters
        ----------
        xi : array_like, any shape
            Normalised time or angle [-], within 0 to 1.
        order : int
            Order of the derivative with respect to xi.

        Returns
        -------
        ndarray, shape of xi
            Values [-].

        Raises
        ------
        DomainError
            When xi leaves the range 0 to 1.

        """
        return self.curve(xi, order)

    @cached_property
    def coefficients(self) -> Coefficients:
        """Compute the law's characteristic values, exact to rounding."""
        curve = self.curve
        steps_velocity = bool(curve.jumps(1))
        ca = abs(curve.peak(2).value)
        least, greatest = (each.value for each in curve.extremes(2))
        # beside a velocity that hardly changes an acceleration is rounding, too
        some = max(ca, JOINT_TOLERANCE * abs(curve.peak(1).value))
        steps_acceleration = steps_velocity or bool(curve.jumps(2)) or any(
            abs(end) > JOINT_TOLERANCE * some for end in curve.end_values(2)
        )
        cj_inside = abs(curve.peak(3).value)
        return Coefficients(
            cv=abs(curve.peak(1).value),
            ca=math.inf if steps_velocity else ca,
            cj=math.inf if steps_acceleration else cj_inside,
            ca_inside=ca,
            cj_inside=cj_inside,
            power=math.inf if steps_velocity else abs(curve.peak_power().value),
            rms_acceleration=math.inf if steps_velocity else curve.rms(2),
            ca_least=least, ca_greatest=greatest,
        )

    @cached_property
    def ends(self) -> tuple[Boundary, Boundary]:
        """Tell what the law does at its start and at its end."""
        peaks = (abs(self.curve.peak(1).value), abs(self.curve.peak(2).value))
        (v0, v1), (a0, a1) = self.curve.end_values(1), self.curve.end_values(2)
        return Boundary.of(v0, a0, *peaks), Boundary.of(v1, a1, *peaks)


@dataclass(frozen=True)
class Member:
    """
    A member of a family that catalogues know by a name of its own.

    Attributes
    ----------
    name : str
        The name.
    parameters : Mapping[str, Any]
        The parameters of the family that make it.

    """

    name: str
    parameters: Mapping[str, Any]


@dataclass(frozen=True)
class LawType:
    """
    A family of laws as the registry knows it.

    Attributes
    ----------
    name : str
        Name in configurations, snake case.
    summary : str
        What it is, in one line.
    source : str
        Where the formula stands.
    parameters : tuple[LawParameter, ...]
        The parameters that it takes.
    build : Callable[..., Piecewise]
        Makes the rise from the parameters; raises `ConfigurationError` where they do not fit
        together.
    any_ends : bool
        Whether its parameters or neighbours can give its ends any velocity and acceleration.
    members : tuple[Member, ...]
        Those of its members that have names of their own.
    generic : bool
        Whether its defaults are just one member of many, with another name: its coefficients
        say nothing of the family.

    """

    name: str
    summary: str
    source: str
    parameters: tuple[LawParameter, ...]
    build: Builder
    any_ends: bool = False
    members: tuple[Member, ...] = ()
    generic: bool = False


LAWS: dict[str, LawType] = {}
"""All registered laws by name."""


def register(
    name: str, summary: str, source: str, *parameters: LawParameter, any_ends: bool = False,
    members: Sequence[Member] = (), generic: bool = False
) -> Callable[[Builder], Builder]:
    """
    Register the decorated builder as a law.

    Parameters
    ----------
    name, summary, source : str
        See `LawType`.
    *parameters : LawParameter
        The parameters of the builder, in order.
    any_ends, generic : bool
        See `LawType`.
    members : Sequence[Member]
        See `LawType`.

    Returns
    -------
    Callable
        A decorator that returns the builder unchanged.

    """
    def enter(build: Builder) -> Builder:
        LAWS[name] = LawType(name, summary, source, parameters, build, any_ends, tuple(members),
                             generic or any_ends)
        return build
    return enter


def make_law(name: str, **parameters: Any) -> MotionLaw:
    """
    Make a motion law by name.

    Parameters
    ----------
    name : str
        A name in `LAWS`.
    **parameters : Any
        The law's parameters; those left out take their defaults.

    Returns
    -------
    MotionLaw
        The law.

    Raises
    ------
    ConfigurationError
        When the name is unknown, or a parameter is unknown, of the wrong type, or out of range;
        all problems are listed, with paths relative to the segment.

    """
    if name not in LAWS:
        from difflib import get_close_matches
        close = ', '.join(get_close_matches(str(name), list(LAWS), n=3))
        raise ConfigurationError([Problem(
            'law', name, 'a law must be one that is known',
            (f'did you mean {close}? ' if close else '') + 'known are: ' + ', '.join(LAWS)
        )])
    law = LAWS[name]
    known = {parameter.name: parameter for parameter in law.parameters}
    problems = [
        Problem(key, value, f'the law {name} has no such parameter',
                'it takes ' + (', '.join(known) or 'none'))
        for key, value in parameters.items() if key not in known
    ]
    values: dict[str, Any] = {}
    for key, parameter in known.items():
        try:
            values[key] = parameter.check(parameters.get(key))
        except ConfigurationError as error:
            problems += error.problems
    if problems:
        raise ConfigurationError(problems)
    return MotionLaw(name, values, law.build(**values))


def laws_between(start: Boundary, end: Boundary) -> list[str]:
    """
    List the laws that join two boundary conditions without a step of velocity or acceleration.

    Parameters
    ----------
    start, end : Boundary
        What the neighbours do where the law starts and where it ends.

    Returns
    -------
    list[str]
        Names, in the order of the registry; the dwell is no law between two positions.

    """
    return [name for name, law in LAWS.items() if name != 'dwell' and (
        law.any_ends or _default_ends(name) == (start, end))]


@cache
def _default_ends(name: str) -> tuple[Boundary, Boundary]:
    return make_law(name).ends
