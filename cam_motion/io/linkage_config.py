# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A linkage as a machine file describes it, every problem at once."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io import linkage_parameters as tables
from cam_motion.io.axis import names_in, split_below, Values
from cam_motion.io.linkage_inputs import place_inputs
from cam_motion.io.linkage_loads import read_loads
from cam_motion.io.linkage_settings import InputDrive, LinkageCase, LinkageSettings
from cam_motion.io.parameters import check_values, is_of_every_node, ParameterSpec
from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.linkage import Body, Linkage, Loop, Point, Transmission, Vector
from cam_motion.mechanism.pose import SingularError
from cam_motion.units import DEGREE


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
    bare = {each: own.pop(each) for each in every if each in own and each not in taken}
    own, unlisted = _take_unlisted(own, taken)
    values, wrong = check_values(tables.LINKAGE, own)
    if any(problem.path in tables.PARTS for problem in wrong):  # not all names are known
        wrong, unlisted = [problem for problem in wrong if problem.path in taken], []
    problems += wrong + unlisted
    if any(problem.path in tables.PARTS for problem in problems):
        raise ConfigurationError(problems)
    parts: dict[str, dict[str, dict[str, Any]]] = {}
    for kind, table in tables.PARTS.items():
        parts[kind] = {}
        for each in names[kind]:
            spec = table if kind != 'motions' else _case_table(values['inputs'])
            parts[kind][each], wrong = check_values(spec, below[each])
            problems += [problem.below(each) for problem in wrong] if each not in bare else [
                Problem(each, bare[each], f'one of the {kind} must be a mapping',
                        f'write {each}: {{{table[0].name}: ...}}')]
    start, wrong = _start({**parts['inputs'], **parts['unknowns']},
                          {body['angle'] for body in parts['bodies'].values()},
                          {vector['variable'] for vector in parts['vectors'].values()})
    problems += [problem for problem in wrong if problem.path.partition('.')[0] not in bare]
    problems += [
        Problem(f'{each}.length', vector['length'],
                'exactly one of length and variable says how long a vector is')
        for each, vector in parts['vectors'].items()
        if (vector['length'] is None) == (vector['variable'] is None) and each not in bare
        and not any(problem.path.startswith(f'{each}.') for problem in problems)]
    if problems:
        raise ConfigurationError(problems)
    linkage = _linkage(name, parts, start)
    spools = {each: variable['spool_radius'] for each, variable in parts['inputs'].items()
              if variable['spool_radius'] is not None}
    drives = {each: InputDrive(variable['axis'], spools.get(each, 1.0),
                               start[each] if each in spools else 0.0)
              for each, variable in parts['inputs'].items() if variable['axis'] is not None}
    loads, problems = read_loads(parts['loads'], linkage)
    settings = LinkageSettings(name, Assembly(linkage), spools, {}, values, drives, loads.forces,
                               loads.torques)
    cases = {}
    for each in names['motions']:
        try:
            cases[each] = _case(settings, each, below[each])
        except ConfigurationError as error:
            problems += [problem.below(each) for problem in error.problems]
    if problems:
        raise ConfigurationError(problems)
    return replace(settings, cases=cases)


def _case_table(inputs: list[str]) -> tuple[ParameterSpec, ...]:
    """List what a motion may say: its duration, and of each input position and rate."""
    return (*tables.MOTION, *(
        ParameterSpec(f'{name}{suffix}', 'double', None, f'Of the input {name}.')
        for name in inputs for suffix in ('', '_deg', '_dot', '_crank')))


def _case(settings: LinkageSettings, name: str, given: Values) -> LinkageCase:
    """Build a motion, and go through it once."""
    duration = float(given['duration'])
    inputs, begin = place_inputs(settings, {
        key: float(value) for key, value in given.items() if key != 'duration'})
    case = LinkageCase(name, inputs, duration)
    end = {key: begin[key] + rate * duration for key, rate in case.inputs.rates.items()}
    try:
        settings.assembly.follow(begin, end)
    except SingularError as error:
        raise ConfigurationError([Problem(
            'duration', duration, f'on the way {error}', 'stop before it')]) from error
    return case


def _take_unlisted(own: Values, taken: Collection[str]) -> tuple[dict[str, Any], list[Problem]]:
    """Take out what describes a part that no list names, and say where it might be listed."""
    described: dict[str, dict[str, Any]] = {}
    for key, value in own.items():
        head, _, rest = key.partition('.')
        if rest and head not in taken and not is_of_every_node(key):
            described.setdefault(head, {})[rest] = value
    problems = []
    for head, given in described.items():
        kinds = [kind for kind, table in tables.PARTS.items()
                 if set(given) <= {spec.name for spec in table}]
        if kinds:  # else nobody can tell what it is meant to be
            own = {key: value for key, value in own.items() if not key.startswith(f'{head}.')}
            problems.append(Problem(head, given, 'is described but not listed',
                                    f'list it in {" or in ".join(kinds)}'))
    return dict(own), problems


def _start(variables: Mapping[str, Mapping[str, Any]], angles: Collection[str | None],
           lengths: Collection[str | None]) -> tuple[dict[str, float], list[Problem]]:
    """Read the start; whether a variable that is neither exists, the linkage will tell."""
    start, problems = {}, []
    for name, values in variables.items():
        given = {key: values[key] for key in ('start', 'start_deg') if values[key] is not None}
        if len(given) != 1:
            problems.append(Problem(
                f'{name}.start', None if not given else list(given.values()),
                'exactly one of start [m, rad] and start_deg names the branch'))
            continue
        if 'start_deg' in given and name in lengths and name not in angles:
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
