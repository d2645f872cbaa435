# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A linkage as a machine file describes it, every problem at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
import math
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io import linkage_parameters as tables
from cam_motion.io.axis import names_in, split_below, Values
from cam_motion.io.parameters import check_values, ParameterSpec
from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.linkage import Body, Linkage, Loop, Point, Transmission, Vector
from cam_motion.mechanism.pose import SingularError
from cam_motion.units import DEGREE


@dataclass(frozen=True)
class LinkageInputs:
    """
    What the inputs of a linkage do at one moment.

    Attributes
    ----------
    values, rates, accelerations : Mapping[str, float]
        Inputs and their derivatives by time [m, rad]; those left out stand at the start.

    """

    values: Mapping[str, float] = field(default_factory=dict)
    rates: Mapping[str, float] = field(default_factory=dict)
    accelerations: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class LinkageCase:
    """
    A motion to look at: all inputs at constant rates.

    Attributes
    ----------
    name : str
        Its name.
    inputs : LinkageInputs
        Where it begins, and the rates.
    duration : float
        How long it takes [s].

    """

    name: str
    inputs: LinkageInputs
    duration: float


@dataclass(frozen=True)
class InputDrive:
    """
    What an axis makes of an input: offset + factor · position of the axis.

    Attributes
    ----------
    axis : str
        Name of the axis.
    factor : float
        Change of the input per unit of the axis: the radius of a spool, else 1.
    offset : float
        The input where the axis is at zero [m, rad]: with a spool the start, else 0.

    """

    axis: str
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class LinkageSettings:
    """
    A linkage with what a machine file says of it.

    Attributes
    ----------
    name : str
        Name of its section.
    assembly : Assembly
        The linkage on the branch of its start.
    spools : Mapping[str, float]
        Radius of the spool that winds an input, by input [m].
    cases : Mapping[str, LinkageCase]
        Motions to look at.
    values : Mapping[str, Any]
        Every parameter of the section itself, checked.
    drives : Mapping[str, InputDrive]
        The axes that drive inputs, by input; other inputs stay at the start.
    forces : Mapping[str, complex]
        Forces on points that the inputs hold, x + j y, by point [N].

    """

    name: str
    assembly: Assembly
    spools: Mapping[str, float]
    cases: Mapping[str, LinkageCase]
    values: Values = field(default_factory=dict)
    drives: Mapping[str, InputDrive] = field(default_factory=dict)
    forces: Mapping[str, complex] = field(default_factory=dict)

    @property
    def linkage(self) -> Linkage:
        """Give the linkage itself."""
        return self.assembly.linkage

    @property
    def axes(self) -> tuple[str, ...]:
        """List the axes that drive inputs, each once."""
        return tuple(dict.fromkeys(drive.axis for drive in self.drives.values()))


def linkage_names(sections: Mapping[str, Values]) -> list[str]:
    """
    Find the sections that describe a linkage.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.

    Returns
    -------
    list[str]
        Names of the sections with ``type: linkage``.

    """
    return [name for name, values in sections.items() if values.get('type') == tables.TYPE]


def rate_name(angle: str) -> str:
    """
    Name the angular velocity of an angle.

    Parameters
    ----------
    angle : str
        Name of the angle (``theta2``).

    Returns
    -------
    str
        The same with omega for theta (``omega2``), or with ``omega_`` before it.

    """
    return angle.replace('theta', 'omega') if 'theta' in angle else f'omega_{angle}'


def build_linkages(sections: Mapping[str, Values],
                   ) -> tuple[dict[str, LinkageSettings], list[Problem]]:
    """
    Check all linkages of a machine file.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.

    Returns
    -------
    tuple[dict[str, LinkageSettings], list[Problem]]
        Those that are sound, and everything that is wrong with the others.

    """
    found, problems = {}, []
    for name in linkage_names(sections):
        try:
            found[name] = build_linkage(name, sections[name])
        except ConfigurationError as error:
            problems += [problem.below(name) for problem in error.problems]
    return found, problems


def build_linkage(name: str, given: Values) -> LinkageSettings:
    """
    Check the description of a linkage and assemble it.

    Parameters
    ----------
    name : str
        Name of its section.
    given : Mapping[str, Any]
        Parameters by flat name.

    Returns
    -------
    LinkageSettings
        The linkage.

    Raises
    ------
    ConfigurationError
        With every problem, paths relative to the section.

    """
    names = {kind: names_in(given, kind) for kind in tables.PARTS}
    taken = {spec.name for spec in tables.LINKAGE}
    problems: list[Problem] = []
    every: list[str] = []
    for kind, listed in names.items():
        problems += [Problem(kind, each, 'every part has a name of its own, other than the keys '
                             'of the section')
                     for k, each in enumerate(listed) if each in {*taken, *every, *listed[:k]}]
        every += listed
    own, below = split_below(given, every)
    values, wrong = check_values(tables.LINKAGE, own)
    if any(problem.path in tables.PARTS for problem in wrong):  # not all names are known
        wrong = [problem for problem in wrong if problem.path in taken]
    problems += wrong
    if any(problem.path in tables.PARTS for problem in problems):
        raise ConfigurationError(problems)
    parts: dict[str, dict[str, dict[str, Any]]] = {}
    for kind, table in tables.PARTS.items():
        parts[kind] = {}
        for each in names[kind]:
            spec = table if kind != 'motions' else _case_table(values['inputs'])
            parts[kind][each], wrong = check_values(spec, below[each])
            problems += [problem.below(each) for problem in wrong]
    start, wrong = _start({**parts['inputs'], **parts['unknowns']},
                          [body['angle'] for body in parts['bodies'].values()])
    problems += wrong
    problems += [
        Problem(f'{each}.length', vector['length'],
                'exactly one of length and variable says how long a vector is')
        for each, vector in parts['vectors'].items()
        if (vector['length'] is None) == (vector['variable'] is None)
        and not any(problem.path.startswith(f'{each}.') for problem in problems)]
    if problems:
        raise ConfigurationError(problems)
    linkage = _linkage(name, parts, start)
    spools = {each: variable['spool_radius'] for each, variable in parts['inputs'].items()
              if variable['spool_radius'] is not None}
    drives = {each: InputDrive(variable['axis'], spools.get(each, 1.0),
                               start[each] if each in spools else 0.0)
              for each, variable in parts['inputs'].items() if variable['axis'] is not None}
    forces, problems = _forces(parts['loads'], parts['points'])
    settings = LinkageSettings(name, Assembly(linkage), spools, {}, values, drives, forces)
    cases = {}
    for each in names['motions']:
        try:
            cases[each] = _case(settings, each, below[each])
        except ConfigurationError as error:
            problems += [problem.below(each) for problem in error.problems]
    if problems:
        raise ConfigurationError(problems)
    return replace(settings, cases=cases)


def read_inputs(settings: LinkageSettings, given: Mapping[str, float]) -> LinkageInputs:
    """
    Read what the inputs do, in the words of people.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.
    given : Mapping[str, float]
        For an input ``h``: ``h`` [m, rad] or ``h_deg`` [deg], ``h_dot``, ``h_ddot``, and where a
        spool winds it ``h_crank``, the angular velocity of its crank [rad/s].

    Returns
    -------
    LinkageInputs
        The same in SI.

    Raises
    ------
    ConfigurationError
        With every name that says nothing, or says it twice.

    """
    known, problems = _keys(settings), []
    found: tuple[dict[str, float], ...] = ({}, {}, {})
    for key, value in given.items():
        if key not in known:
            problems.append(Problem(key, value, 'says nothing about an input',
                                    'known are: ' + ', '.join(known)))
            continue
        name, order, factor = known[key]
        if not math.isfinite(value):
            problems.append(Problem(key, value, 'must be a finite number'))
        if name in found[order]:
            problems.append(Problem(key, value, 'is given in another way too', 'leave one out'))
        found[order][name] = value * factor
    if problems:
        raise ConfigurationError(problems)
    return LinkageInputs(*found)


def _keys(settings: LinkageSettings) -> dict[str, tuple[str, int, float]]:
    """Tell for every key that is understood: its input, the derivative, the factor to SI."""
    known: dict[str, tuple[str, int, float]] = {}
    for name in settings.linkage.inputs:
        known |= {name: (name, 0, 1.0), f'{name}_dot': (name, 1, 1.0),
                  f'{name}_ddot': (name, 2, 1.0)}
        if name in settings.linkage.angles:
            known[f'{name}_deg'] = (name, 0, DEGREE)
        if name in settings.spools:
            known[f'{name}_crank'] = (name, 1, settings.spools[name])
    return known


def _case_table(inputs: list[str]) -> tuple[ParameterSpec, ...]:
    """List what a motion may say: its duration, and of each input position and rate."""
    return (*tables.MOTION, *(
        ParameterSpec(f'{name}{suffix}', 'double', None, f'Of the input {name}.')
        for name in inputs for suffix in ('', '_deg', '_dot', '_crank')))


def _case(settings: LinkageSettings, name: str, given: Values) -> LinkageCase:
    """Build a motion, and go through it once."""
    duration = float(given['duration'])
    case = LinkageCase(name, read_inputs(settings, {
        key: float(value) for key, value in given.items() if key != 'duration'}), duration)
    begin = settings.assembly.at(case.inputs.values)
    end = {key: begin[key] + rate * duration for key, rate in case.inputs.rates.items()}
    try:
        settings.assembly.follow(begin, end)
    except SingularError as error:
        raise ConfigurationError([Problem(
            'duration', duration, f'on the way {error}', 'stop before it')]) from error
    return case


def _forces(loads: Mapping[str, Mapping[str, Any]], points: Mapping[str, Any],
            ) -> tuple[dict[str, complex], list[Problem]]:
    """Add up the forces on each point."""
    forces: dict[str, complex] = {}
    problems = []
    for name, load in loads.items():
        point = load['point']
        if point not in points:
            problems.append(Problem(f'{name}.point', point, 'must be a point of the linkage',
                                    'known are: ' + ', '.join(points)))
        forces[point] = forces.get(point, 0.0) + complex(load['force_x'], load['force_y'])
    return forces, problems


def _start(variables: Mapping[str, Mapping[str, Any]], angles: list[str | None],
           ) -> tuple[dict[str, float], list[Problem]]:
    """Read the start; with a body whose angle is not known, nobody can tell the lengths."""
    start, problems = {}, []
    for name, values in variables.items():
        given = {key: values[key] for key in ('start', 'start_deg') if values[key] is not None}
        if len(given) != 1:
            problems.append(Problem(
                f'{name}.start', None if not given else list(given.values()),
                'exactly one of start [m, rad] and start_deg names the branch'))
            continue
        if 'start_deg' in given and name not in angles and None not in angles:
            problems.append(Problem(f'{name}.start_deg', given['start_deg'],
                                    'the variable is a length', 'write start: in m'))
        start[name] = given.get('start', 0.0) + given.get('start_deg', 0.0) * DEGREE
        if values.get('spool_radius') is not None and name in angles:
            problems.append(Problem(f'{name}.spool_radius', values['spool_radius'],
                                    'a spool winds a length, not an angle', 'leave it out'))
    return start, problems


def _linkage(name: str, parts: Mapping[str, Mapping[str, Mapping[str, Any]]],
             start: Mapping[str, float]) -> Linkage:
    return Linkage(
        name,
        tuple(Body(each, body['angle']) for each, body in parts['bodies'].items()),
        tuple(Vector(each, vector['variable'] if vector['length'] is None else vector['length'],
                     vector['body'], vector['turn_deg'] * DEGREE)
              for each, vector in parts['vectors'].items()),
        tuple(Loop(each, tuple(loop['path'])) for each, loop in parts['loops'].items()),
        tuple(Point(each, tuple(point['path']), point['from'])
              for each, point in parts['points'].items()),
        tuple(parts['inputs']), tuple(parts['unknowns']), start,
        tuple(Transmission(each, tuple(pair['first']), tuple(pair['second']))
              for each, pair in parts['transmissions'].items()))
