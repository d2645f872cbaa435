# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The machine that a configuration describes: checked as a whole, every problem at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from cam_motion.drive.inverse import FollowerDrive
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io import parameters
from cam_motion.io.axis import build_axis, speed_problems, Values
from cam_motion.io.cam_drive_config import build_cam_drive, CamDriveSettings
from cam_motion.io.parameters import check_values
from cam_motion.motion.diagram import TimingDiagram
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.units import RPM

LINE_SHAFT = 'line_shaft'
"""Mode of a drive that turns a cam shaft, against one that follows an axis."""


@dataclass(frozen=True)
class MasterSettings:
    """
    The settings of a master shaft.

    Attributes
    ----------
    name : str
        Name of its node.
    values : Mapping[str, Any]
        Every parameter of the table, checked.

    """

    name: str
    values: Values

    @property
    def speed(self) -> float:
        """Set speed [rad/s]."""
        return float(self.values['speed_cpm']) * RPM

    def shaft(self) -> Shaft:
        """
        Make the shaft.

        Returns
        -------
        Shaft
            At rest at angle 0.

        """
        values = self.values
        return Shaft(
            self.speed,
            RampLimits(values['acceleration'], values['jerk']),
            RampLimits(values['quick_stop_acceleration'], values['quick_stop_jerk']),
        )


@dataclass(frozen=True)
class DriveSettings:
    """
    A drive and the axis that it moves.

    Attributes
    ----------
    name : str
        Name of its node.
    axis : str
        Name of the axis.
    drive : FollowerDrive
        The drive.

    """

    name: str
    axis: str
    drive: FollowerDrive


@dataclass(frozen=True)
class Machine:
    """
    A whole machine: one shaft, its axes, their drives.

    Attributes
    ----------
    master : MasterSettings
        The master shaft.
    diagram : TimingDiagram
        The axes.
    drives : Mapping[str, DriveSettings]
        The drives that follow an axis, by name.
    cam_drives : Mapping[str, CamDriveSettings]
        The drives that turn a cam shaft, by name.

    """

    master: MasterSettings
    diagram: TimingDiagram
    drives: Mapping[str, DriveSettings]
    cam_drives: Mapping[str, CamDriveSettings]


def build_master(name: str, given: Values) -> MasterSettings:
    """
    Check the parameters of a master shaft.

    Parameters
    ----------
    name : str
        Name of the node.
    given : Mapping[str, Any]
        Parameters by flat name.

    Returns
    -------
    MasterSettings
        The settings.

    Raises
    ------
    ConfigurationError
        With every problem, paths relative to the node.

    """
    values, problems = check_values(parameters.MASTER_SHAFT, given)
    if problems:
        raise ConfigurationError(problems)
    return MasterSettings(name, values)


def build_drive(name: str, given: Values) -> DriveSettings:
    """
    Check the parameters of a drive.

    Parameters
    ----------
    name : str
        Name of the node.
    given : Mapping[str, Any]
        Parameters by flat name.

    Returns
    -------
    DriveSettings
        The drive.

    Raises
    ------
    ConfigurationError
        With every problem, paths relative to the node.

    """
    values, problems = check_values(parameters.DRIVE_SIM, given)
    if problems:
        raise ConfigurationError(problems)
    drive = FollowerDrive(
        radius=values['radius'], gear_ratio=values['gear_ratio'],
        efficiency=values['efficiency'], motor_inertia=values['motor_inertia'],
        load_inertia=values['load_inertia'], resistance_force=values['resistance_force'],
        always_resists=values['resistance'] == 'always')
    return DriveSettings(name, values['axis'], drive)


def build_machine(sections: Mapping[str, Values]) -> Machine:
    """
    Check a whole configuration and build the machine.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node, by node name and flat parameter name.

    Returns
    -------
    Machine
        The machine.

    Raises
    ------
    ConfigurationError
        With every problem of every node, paths starting with the node's name.

    """
    problems: list[Problem] = []

    def build(make: Any, name: str, role: str) -> Any:
        if name not in sections:
            problems.append(Problem(
                name, None, f'the {role} needs a section of its own',
                f'write {name}: with ros__parameters: below it'))
            return None
        try:
            return make(name, sections[name])
        except ConfigurationError as error:
            problems.extend(problem.below(name) for problem in error.problems)
            return None

    line, wrong = check_values(parameters.LINE, sections.get('line', guess_line(sections)))
    problems += [problem.below('line') for problem in wrong]
    problems += [
        Problem(f'line.{key}', name, 'every node has a name of its own')
        for key in ('axes', 'drives') for name in dict.fromkeys(line[key])
        if [line['master'], *line['axes'], *line['drives']].count(name) > 1
    ]
    if not line['axes'] and not wrong:
        problems.append(Problem('line.axes', [], 'a line needs at least one axis'))
    if line['master'] in sections:
        master = build(build_master, line['master'], 'master shaft')
    else:
        master = build_master(line['master'], {})
    axes = {name: build(build_axis, name, 'axis') for name in dict.fromkeys(line['axes'])}
    profiles = {name: axis.profile for name, axis in axes.items() if axis is not None}
    drives, cam_drives = {}, {}
    for name in dict.fromkeys(line['drives']):
        if sections.get(name, {}).get('mode') == LINE_SHAFT:
            cam_drives[name] = build(
                lambda name, given: build_cam_drive(name, given, profiles), name, 'drive')
        else:
            drives[name] = build(build_drive, name, 'drive')
    problems += [
        Problem(f'{name}.axis', followed, 'a drive follows an axis of the line',
                'known are: ' + ', '.join(axes))
        for name in (*drives, *cam_drives)
        if isinstance(followed := sections.get(name, {}).get('axis'), str) and followed not in axes
    ]
    if master is not None:
        for axis in axes.values():
            problems += [] if axis is None else speed_problems(axis, master.speed)
    if problems:
        raise ConfigurationError(problems)
    return Machine(master, TimingDiagram(axes), drives, cam_drives)


def guess_line(sections: Mapping[str, Values]) -> Values:
    """
    Make up the section of the line where a file has none, from what the others hold.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.

    Returns
    -------
    Mapping[str, Any]
        Names of the axes (sections with segments), drives (with an axis) and of the master.

    """
    masters = [name for name, values in sections.items() if 'speed_cpm' in values]
    return {
        'master': masters[0] if masters else 'master_shaft',
        'axes': [name for name, values in sections.items() if 'segments' in values],
        'drives': [name for name, values in sections.items()
                   if 'axis' in values and 'segments' not in values],
    }
