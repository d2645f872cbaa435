# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The linkages of a line: which axes drive them, and whether these keep within their range."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.axis import CoupledAxis, names_in, Values
from cam_motion.io.axis_limits import CascadedAxis
from cam_motion.io.interlocks import motions_of
from cam_motion.io.linkage_config import build_linkage
from cam_motion.io.linkage_parameters import LINKAGE, PARTS
from cam_motion.io.linkage_settings import LinkageSettings
from cam_motion.io.parameters import ParameterSpec
from cam_motion.mechanism.pose import SingularError
from cam_motion.runtime.interlock import common_turns
from cam_motion.units import DEGREE, TURN

_MOMENTS = 360  # of each turn at which the linkage is looked at


def linkage_table(given: Values) -> tuple[ParameterSpec, ...]:
    """
    List the parameters of a linkage, which depend on the names in its lists.

    Parameters
    ----------
    given : Mapping[str, Any]
        What is given, by flat name.

    Returns
    -------
    tuple[ParameterSpec, ...]
        Those of the section, then those below each name, motions apart.

    """
    taken = {spec.name for spec in LINKAGE}
    below = [replace(spec, name=f'{name}.{spec.name}')
             for kind, table in PARTS.items() if kind != 'motions'
             for name in dict.fromkeys(names_in(given, kind)) if name not in taken
             for spec in table]
    return (*LINKAGE, *below)


def build_linkages_of(line: Values, sections: Mapping[str, Values],
                      axes: Mapping[str, CoupledAxis | None],
                      ) -> tuple[dict[str, LinkageSettings], list[Problem]]:
    """
    Check the linkages of a line.

    Parameters
    ----------
    line : Mapping[str, Any]
        Parameters of the line, checked.
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.
    axes : Mapping[str, CoupledAxis | None]
        The axes of the line; None for one that could not be built.

    Returns
    -------
    tuple[dict[str, LinkageSettings], list[Problem]]
        Those that are sound, by name, and everything that is wrong, paths from the node's name.

    """
    found, problems = {}, []
    for name in dict.fromkeys(line['linkages']):
        if name not in sections:
            problems.append(Problem(name, None, 'the linkage needs a section of its own',
                                    f'write {name}: with ros__parameters: below it'))
            continue
        try:
            found[name] = build_driven(name, sections[name])
        except ConfigurationError as error:
            problems += [problem.below(name) for problem in error.problems]
            continue
        problems += [each.below(name) for each in drive_problems(found[name], axes)]
    return found, problems


def build_driven(name: str, given: Values) -> LinkageSettings:
    """
    Check a linkage that axes drive.

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
    settings = build_linkage(name, given)
    if not settings.drives:
        raise ConfigurationError([Problem(
            f'{settings.linkage.inputs[0]}.axis', None, 'at least one input needs an axis that '
            'drives it', 'name an axis of the line')])
    return settings


def drive_problems(settings: LinkageSettings, axes: Mapping[str, CoupledAxis | None],
                   ) -> list[Problem]:
    """
    Check that the axes of a line can drive a linkage, all the way round.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.
    axes : Mapping[str, CoupledAxis | None]
        The axes of the line; None for one that could not be built.

    Returns
    -------
    list[Problem]
        Axes that are unknown or have another unit, and where the linkage cannot follow; paths
        relative to its section.

    """
    problems = []
    for name, drive in settings.drives.items():
        unit = 'rad' if name in settings.spools else settings.linkage.unit(name)
        axis = axes.get(drive.axis)
        if drive.axis not in axes:
            problems.append(Problem(f'{name}.axis', drive.axis, 'must name an axis of the line',
                                    'known are: ' + ', '.join(axes)))
        elif axis is not None and axis.unit != unit:
            problems.append(Problem(
                f'{name}.axis', drive.axis, f'the axis moves in {axis.unit}, and '
                + ('the crank of a spool turns' if name in settings.spools else 'the input is')
                + f' in {unit}', f'give the axis the unit {unit}'))
    driving = {name: axis for name in settings.axes if (axis := axes.get(name)) is not None}
    if problems or len(driving) < len(settings.axes):
        return problems
    return _cycle_problems(settings, driving)


def _cycle_problems(settings: LinkageSettings, axes: Mapping[str, CoupledAxis]) -> list[Problem]:
    """Go once through the cycle of the axes, from the start."""
    motions = motions_of(axes)
    turns = common_turns([axis.layout.couplings[cam].ratio for axis in axes.values()
                          if not isinstance(axis, CascadedAxis) for cam in axis.layout.active])
    pose = settings.assembly.start
    for k in range(_MOMENTS * turns + 1):
        phi = k * TURN / _MOMENTS
        inputs = {name: drive.offset + drive.factor * motions[drive.axis].sample(phi)[0]
                  for name, drive in settings.drives.items()}
        try:
            pose = settings.assembly.follow(pose, inputs)
        except SingularError as error:
            return [replace(problem, rule=f'at shaft angle {phi / DEGREE:g} deg: {problem.rule}')
                    for problem in settings.assembly.range_problems(inputs, error, pose)]
    return []
