# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""The machine that a configuration describes: checked as a whole, every problem at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
import math
from typing import Any

from cam_motion.drive.inverse import FollowerDrive
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io import parameters
from cam_motion.io.parameters import check_values, is_of_every_node
from cam_motion.motion.diagram import Axis, TimingDiagram
from cam_motion.motion.laws import make_law
from cam_motion.motion.limits import Limits, QUANTITIES
from cam_motion.motion.profile import CamProfile, program_problems
from cam_motion.motion.segment import Segment
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.units import DEGREE, rate_text, RPM

SHORTEST_DEG = 1e-6
"""Least span of a segment [deg]: with less, nothing is left of an angle but its rounding."""

LARGEST_LIFT = 1e15
"""Largest magnitude of a lift, in the unit of its axis."""

Values = Mapping[str, Any]
"""Parameters of one node by flat name."""


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
        The drives by name.

    """

    master: MasterSettings
    diagram: TimingDiagram
    drives: Mapping[str, DriveSettings]


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


def build_axis(name: str, given: Values) -> Axis:
    """
    Check the parameters of an axis and compile its cam.

    Parameters
    ----------
    name : str
        Name of the axis.
    given : Mapping[str, Any]
        Parameters by flat name (``feed.end_deg``).

    Returns
    -------
    Axis
        The axis.

    Raises
    ------
    ConfigurationError
        With every problem, paths relative to the axis.

    """
    names = given.get('segments')
    names = [n for n in names if isinstance(n, str)] if isinstance(names, (list, tuple)) else []
    own, below = {}, {segment: {} for segment in names}  # type: ignore[var-annotated]
    for key, value in given.items():
        head, _, rest = key.partition('.')
        if rest and head in below:
            below[head][rest] = value
        else:
            own[key] = value
    values, problems = check_values(parameters.CAM_AXIS, own)
    problems += [
        Problem('segments', name, 'every segment has a name of its own')
        for name in dict.fromkeys(names) if names.count(name) > 1
    ]
    if not names and values['segments'] == []:
        problems.append(Problem('segments', [], 'a cam needs at least one segment'))
    segments = []
    for segment in names:
        built, wrong = _build_segment(segment, below[segment])
        segments.append(built)
        problems += [problem.below(segment) for problem in wrong]
    problems += _span_problems(segments)
    accumulate = values['cycle'] == 'accumulate'
    if problems and segments:
        # angles and lifts are looked at although a law or another parameter is wrong
        known = {problem.path for problem in problems}
        problems += [problem for problem in program_problems(tuple(segments), accumulate)
                     if problem.path not in known]
    if problems or not segments:
        raise ConfigurationError(problems)
    limits = Limits(*(values[f'limits.{quantity}'] for quantity in QUANTITIES[1:]))
    return Axis(name, CamProfile(segments, accumulate), values['unit'], limits)


def _span_problems(segments: list[Segment]) -> list[Problem]:
    """Find segments whose numbers no machine has, and with which the cam would overflow."""
    problems = []
    start = 0.0
    for segment in segments:
        if 0.0 < segment.end_deg - start < SHORTEST_DEG:
            problems.append(Problem(
                f'{segment.name}.end_deg', segment.end_deg, 'a segment must span at least '
                f'{SHORTEST_DEG:g} deg', 'leave the segment out'))
        if math.isfinite(segment.lift) and abs(segment.lift) > LARGEST_LIFT:
            problems.append(Problem(
                f'{segment.name}.lift', segment.lift,
                f'a lift must be at most {LARGEST_LIFT:g}', 'take a larger unit'))
        start = segment.end_deg
    return problems


def _build_segment(name: str, given: Values) -> tuple[Segment, list[Problem]]:
    """Build a segment with a stand-in (NaN, any law) for whatever is wrong, and say what is."""
    fixed = {spec.name for spec in parameters.SEGMENT}
    values, problems = check_values(
        parameters.SEGMENT, {k: v for k, v in given.items() if k in fixed})
    law = make_law('cubic')
    try:
        law = make_law(values['law'], **{k: v for k, v in given.items() if k not in fixed})
    except ConfigurationError as error:
        problems += error.problems
    if values['law'] != 'dwell' and 'lift' not in given:
        problems.append(Problem('lift', None, 'a segment with a law needs a lift'))
    wrong = {problem.path for problem in problems}
    end_deg, lift = (
        math.nan if key in wrong else values[key] for key in ('end_deg', 'lift'))
    return Segment(name, law, end_deg, lift), problems


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
    drives = {name: build(build_drive, name, 'drive') for name in dict.fromkeys(line['drives'])}
    problems += [
        Problem(f'{name}.axis', followed, 'a drive follows an axis of the line',
                'known are: ' + ', '.join(axes))
        for name in drives
        if isinstance(followed := sections.get(name, {}).get('axis'), str) and followed not in axes
    ]
    if master is not None:
        for axis in axes.values():
            problems += [] if axis is None else speed_problems(axis, master.speed)
    if problems:
        raise ConfigurationError(problems)
    return Machine(master, TimingDiagram(axes), drives)


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


def speed_problems(axis: Axis, omega: float) -> list[Problem]:
    """
    Check whether an axis keeps its limits at a steady shaft speed.

    Parameters
    ----------
    axis : Axis
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
        bound = Limits(**{quantity: limit}).highest_speed(axis.profile)
        if bound is None or abs(omega) <= bound.omega * (1.0 + 1e-9):
            continue
        unit = rate_text(axis.unit, order)
        where = f'segment {bound.segment} at {bound.at / DEGREE:.4g} deg'
        if bound.omega == 0.0:
            rule = f'the acceleration steps in {where}: no jerk limit can be met'
            hint = 'take a law whose acceleration is continuous, or leave the jerk unlimited'
        else:
            # a product grows to infinity where a power would raise
            needed = limit * math.prod([abs(omega) / bound.omega] * order)
            rule = (f'at {abs(omega) / RPM:g} cycles/min {where} needs {needed:.6g} {unit}')
            hint = (f'run at most {bound.omega / RPM:.6g} cycles/min, raise the limit, or give '
                    'the segment more angle or another law')
        problems.append(Problem(f'{axis.name}.limits.{quantity}', limit, rule, hint))
    return problems


__all__ = [
    'DriveSettings', 'Machine', 'MasterSettings', 'Values', 'build_axis', 'build_drive',
    'build_machine', 'build_master', 'guess_line', 'is_of_every_node', 'speed_problems',
]
