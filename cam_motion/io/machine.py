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
from dataclasses import dataclass, field
from typing import Any

from cam_motion.drive.inverse import FollowerDrive
from cam_motion.drive.load import Part
from cam_motion.drive.orbit import find_orbit, NoOrbitError
from cam_motion.drive.servo_motor import ServoMotor
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io import parameters
from cam_motion.io.axis import build_axis, Values
from cam_motion.io.axis_limits import in_cascade, speed_problems
from cam_motion.io.cam_drive_config import build_cam_drive, cam_on_shaft, CamDriveSettings
from cam_motion.io.interlocks import build_interlocks, judge, JudgedInterlock, line_values
from cam_motion.io.line_parts import guess_line, rival_problems, shaft_drives
from cam_motion.io.linkage_line import build_linkages_of
from cam_motion.io.linkage_settings import LinkageSettings
from cam_motion.io.load_config import lever_problems, take_parts
from cam_motion.io.parameters import check_values
from cam_motion.io.servo_config import build_motor, build_servo, ServoSettings
from cam_motion.io.servo_parameters import FOLLOW_DRIVE, SERVO, SERVO_DRIVE
from cam_motion.io.tracks import take_tracks, TrackSettings
from cam_motion.io.turn import turn_profile
from cam_motion.motion.diagram import TimingDiagram
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.units import RPM


@dataclass(frozen=True)
class MasterSettings:
    """
    The settings of a master shaft.

    Attributes
    ----------
    name : str
        Name of its node.
    values, tracks : Mapping[str, Any]
        Every parameter of the table, checked, and the cam tracks by name.

    """

    name: str
    values: Values
    tracks: Mapping[str, TrackSettings] = field(default_factory=dict)

    @property
    def speed(self) -> float:
        """Set speed [rad/s]."""
        return float(self.values['speed_cpm']) * RPM

    @property
    def top_speed(self) -> float:
        """Speed at which the axes must keep their limits [rad/s]: the set speed."""
        return self.speed

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
class ShaftDrive:
    """
    A drive that turns the shaft itself, in the place of a master shaft.

    Attributes
    ----------
    name : str
        Name of its node.
    drive : CamDriveSettings
        The drive.

    """

    name: str
    drive: CamDriveSettings

    @property
    def values(self) -> Values:
        """Give every parameter, checked."""
        return self.drive.values

    @property
    def speed(self) -> float:
        """Give the speed that the drive is meant for [rad/s]."""
        return self.drive.drive.nominal_speed

    @property
    def top_speed(self) -> float:
        """Find the greatest speed of its periodic motion; the nominal one where it has none."""
        try:
            return find_orbit(self.drive.drive).speeds[1]
        except NoOrbitError:
            return self.speed


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
        Gearbox and load, and all inertia on the motor shaft.
    motor : ServoMotor | None
        The motor with its limits, where it is given.
    servo : ServoSettings | None
        How it follows with mode `servo`; None for a drive that follows exactly.
    parts : Mapping[str, Part]
        The parts of its load by name.

    """

    name: str
    axis: str
    drive: FollowerDrive
    motor: ServoMotor | None = None
    servo: ServoSettings | None = None
    parts: Mapping[str, Part] = field(default_factory=dict)


@dataclass(frozen=True)
class Machine:
    """
    A whole machine: one shaft, its axes, their drives.

    Attributes
    ----------
    master : MasterSettings or ShaftDrive
        What turns the shaft: the master shaft, or a drive in its place.
    diagram : TimingDiagram
        The axes.
    drives : Mapping[str, DriveSettings]
        The drives that follow an axis, by name.
    cam_drives : Mapping[str, CamDriveSettings]
        The drives that turn a cam shaft, by name.
    interlocks : Mapping[str, JudgedInterlock]
        What axes must never do at once, by name, and by how much that is kept.
    linkages : Mapping[str, LinkageSettings]
        The linkages that axes drive, by name.

    """

    master: MasterSettings | ShaftDrive
    diagram: TimingDiagram
    drives: Mapping[str, DriveSettings]
    cam_drives: Mapping[str, CamDriveSettings]
    interlocks: Mapping[str, JudgedInterlock] = field(default_factory=dict)
    linkages: Mapping[str, LinkageSettings] = field(default_factory=dict)

    @property
    def drive_names(self) -> tuple[str, ...]:
        """List all drives that tell their state, whatever their mode."""
        return (*self.cam_drives, *self.drives)


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
    rest, tracks, problems = take_tracks(given, parameters.MASTER_SHAFT)
    values, wrong = check_values(parameters.MASTER_SHAFT, rest)
    if problems or wrong:
        raise ConfigurationError(problems + wrong)
    return MasterSettings(name, values, tracks)


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
    follows_as_servo = given.get('mode') == SERVO
    table = SERVO_DRIVE if follows_as_servo else FOLLOW_DRIVE
    own, parts, in_parts = take_parts(given, table)
    values, problems = check_values(table, own)
    problems += in_parts
    if problems:
        raise ConfigurationError(problems)
    motor = build_motor(values)
    drive = FollowerDrive(
        radius=values['radius'], gear_ratio=values['gear_ratio'],
        efficiency=values['efficiency'],
        motor_inertia=values['motor_inertia'] + (0.0 if motor is None else motor.inertia),
        load_inertia=values['load_inertia'], resistance_force=values['resistance_force'],
        always_resists=values['resistance'] == 'always', parts=tuple(parts.values()))
    servo = None
    if follows_as_servo and motor is not None:
        servo = build_servo(values, drive, motor)
    return DriveSettings(name, values['axis'], drive, motor, servo, parts)


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

    def turn(name: str, given: Values) -> CamDriveSettings:
        axis = axes.get(str(given.get('axis')))
        if axis is None:
            return build_cam_drive(name, given, {})
        try:
            cam_on_shaft(axis)
        except ConfigurationError as error:
            problems.extend(problem.below(name) for problem in error.problems)
        return build_cam_drive(name, given, {axis.name: axis.profile})

    def follow(name: str, given: Values) -> DriveSettings:
        settings = build_drive(name, given)
        axis = axes.get(settings.axis)
        if settings.parts and axis is not None:
            if found := lever_problems(settings.parts, turn_profile(axis)):
                raise ConfigurationError(found)
        return settings

    given = sections.get('line', guess_line(sections))
    line, wrong = line_values(given)
    problems += [problem.below('line') for problem in wrong]
    turning = shaft_drives(sections, line['drives'])
    named = [*line['axes'], *line['drives'], *line['linkages'],
             *({line['master']} - set(turning))]
    problems += [
        Problem(f'line.{key}', name, 'every node has a name of its own')
        for key in ('axes', 'drives', 'linkages') for name in dict.fromkeys(line[key])
        if named.count(name) > 1
    ]
    if not line['axes'] and not wrong:
        problems.append(Problem('line.axes', [], 'a line needs at least one axis'))
    problems += rival_problems(sections, line['master'], turning)
    axes = in_cascade({
        name: build(build_axis, name, 'axis') for name in dict.fromkeys(line['axes'])}, problems)
    drives, cam_drives = {}, {}
    for name in dict.fromkeys(line['drives']):
        if name in turning:
            cam_drives[name] = build(turn, name, 'drive')
        else:
            drives[name] = build(follow, name, 'drive')
    problems += [
        Problem(f'{name}.axis', followed, 'a drive follows an axis of the line',
                'known are: ' + ', '.join(axes))
        for name in (*drives, *cam_drives)
        if isinstance(followed := sections.get(name, {}).get('axis'), str) and followed not in axes
    ]
    master: MasterSettings | ShaftDrive | None
    if turning:
        found = cam_drives[turning[0]]
        master = None if found is None else ShaftDrive(turning[0], found)
    elif line['master'] in sections:
        master = build(build_master, line['master'], 'master shaft')
    else:
        master = build_master(line['master'], {})
    limited = [axis for axis in axes.values() if axis is not None
               and any(axis.limits.of_order(order) for order in (1, 2, 3))]
    if master is not None and limited:
        speed = master.top_speed
        problems += [problem for axis in limited for problem in speed_problems(axis, speed)]
    linkages, wrong = build_linkages_of(line, sections, axes)
    problems += wrong
    interlocks, wrong = build_interlocks(given, axes)
    problems += [problem.below('line') for problem in wrong]
    sound = {name: axis for name, axis in axes.items() if axis is not None}
    judged = judge({name: each for name, each in interlocks.items()
                    if set(each.axes) <= set(sound)}, sound)
    problems += [Problem(f'line.{name}', each.interlock.axes, each.verdict.text)
                 for name, each in judged.items() if not each.verdict.kept]
    if problems or master is None:
        raise ConfigurationError(problems)
    return Machine(master, TimingDiagram(sound), drives, cam_drives, judged, linkages)
