# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The loads on a linkage, as a machine file describes them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from cam_motion.errors import Problem
from cam_motion.mechanism.linkage import Linkage

_ON_POINT = ('force_x', 'force_y')
_ALONG = {'rad': 'torque', 'm': 'force'}  # what acts along a variable, by its unit


@dataclass(frozen=True)
class Loads:
    """
    What acts on a linkage.

    Attributes
    ----------
    forces : Mapping[str, complex]
        Forces on points, x + j y [N].
    torques : Mapping[str, float]
        Torques on angles [N m] and forces along lengths [N].

    """

    forces: Mapping[str, complex] = field(default_factory=dict)
    torques: Mapping[str, float] = field(default_factory=dict)


def read_loads(given: Mapping[str, Mapping[str, Any]], linkage: Linkage,
               ) -> tuple[Loads, list[Problem]]:
    """
    Add up the loads on each point and along each variable.

    Parameters
    ----------
    given : Mapping[str, Mapping[str, Any]]
        Parameters of each load, by its name.
    linkage : Linkage
        What they act on.

    Returns
    -------
    tuple[Loads, list[Problem]]
        The sums, and everything that is wrong, paths from the names of the loads.

    """
    forces: dict[str, complex] = {}
    torques: dict[str, float] = {}
    problems: list[Problem] = []
    points = [point.name for point in linkage.points]
    for name, load in given.items():
        point, variable = load['point'], load['variable']
        if (point is None) == (variable is None):
            problems.append(Problem(
                name, None if point is None else [point, variable],
                'exactly one of point and variable says what a load acts on',
                'write point: with force_x: and force_y:, or variable: with torque: (of an angle) '
                'or force: (of a length)'))
            continue
        if point is not None:
            wrong = _unknown(f'{name}.point', point, 'point', points)
            allowed: Collection[str] = _ON_POINT
        else:
            wrong = _unknown(f'{name}.variable', variable, 'variable', linkage.variables)
            allowed = (_ALONG[linkage.unit(variable)],)
        wrong = wrong or _misplaced(name, load, allowed, 'point' if point else 'variable')
        problems += wrong
        if wrong:
            continue
        if point is not None:
            forces[point] = forces.get(point, 0.0) + complex(
                *(load[key] or 0.0 for key in _ON_POINT))
        else:
            torques[variable] = torques.get(variable, 0.0) + sum(load[key] for key in allowed)
    return Loads(forces, torques), problems


def _unknown(path: str, value: str, kind: str, known: Collection[str]) -> list[Problem]:
    return [] if value in known else [Problem(
        path, value, f'must be a {kind} of the linkage', 'known are: ' + ', '.join(known))]


def _misplaced(name: str, load: Mapping[str, Any], allowed: Collection[str], on: str,
               ) -> list[Problem]:
    """Find parts of a load that do not belong to what it acts on, and whether it has any."""
    told = [key for key in (*_ON_POINT, *_ALONG.values()) if load[key] is not None]
    wrong = [Problem(f'{name}.{key}', load[key], f'no part of a load on the {on} {load[on]}',
                     'it takes ' + ' and '.join(allowed)) for key in told if key not in allowed]
    if not told:
        wrong.append(Problem(f'{name}.{[*allowed][0]}', None, f'a load on the {on} {load[on]} '
                             'needs ' + ' or '.join(allowed)))
    return wrong
