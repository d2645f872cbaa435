# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a check of a configuration finds: problems, peaks, and the highest speed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
import math
from typing import Any

from cam_motion.drive.servo_cycle import limit_figures, LimitFigures
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io import parameters
from cam_motion.io.axis import build_axis, CoupledAxis, ONLY_CAM, stepping_cams, Values
from cam_motion.io.axis_limits import in_cascade
from cam_motion.io.cam_disc_config import CamDiscSettings
from cam_motion.io.cam_drive_parameters import CAM_DRIVE
from cam_motion.io.contour import check_discs
from cam_motion.io.interlocks import JudgedInterlock, line_values
from cam_motion.io.joint_warnings import joint_warnings
from cam_motion.io.line_parts import guess_line, shaft_drives
from cam_motion.io.linkage_config import build_linkages, linkage_names
from cam_motion.io.linkage_settings import LinkageSettings
from cam_motion.io.machine import build_machine, Machine
from cam_motion.io.parameters import check_values
from cam_motion.io.turn import repeats, turn_profile
from cam_motion.motion.continuity import Continuity, continuity_of
from cam_motion.motion.diagram import Axis, TimingDiagram
from cam_motion.motion.limits import QUANTITIES, SpeedBound
from cam_motion.motion.piecewise import Peak
from cam_motion.motion.profile import CamProfile
from cam_motion.units import DEGREE, rate_text, RPM

SLACK = 1e-9
"""How far (relative) a peak may exceed its limit by rounding."""


@dataclass(frozen=True)
class SegmentSummary:
    """
    The figures of one segment.

    Attributes
    ----------
    name, law : str
        Names of the segment and of its law.
    start_deg, end_deg : float
        Shaft angles at which it starts and ends [deg].
    lift : float
        Change of position [unit].
    geometric : tuple[Peak, Peak, Peak]
        Signed peaks of y', y'', y''' [unit/rad, /rad², /rad³] and where they occur [rad].
    physical : tuple[float, float, float]
        The same as velocity, acceleration and jerk at the set speed [unit/s, /s², /s³].

    """

    name: str
    law: str
    start_deg: float
    end_deg: float
    lift: float
    geometric: tuple[Peak, Peak, Peak]
    physical: tuple[float, float, float]


@dataclass(frozen=True)
class AxisSummary:
    """
    The figures of one axis.

    Attributes
    ----------
    axis : Axis
        The axis.
    segments : tuple[SegmentSummary, ...]
        Its segments in order.
    bound : SpeedBound | None
        The highest shaft speed within its limits; None where nothing limits it.
    continuity : Mapping[str, Continuity]
        How smoothly each of its cams runs.
    warnings : tuple[Problem, ...]
        Joints at which the acceleration steps, paths relative to the axis.

    """

    axis: Axis
    segments: tuple[SegmentSummary, ...]
    bound: SpeedBound | None
    continuity: Mapping[str, Continuity]
    warnings: tuple[Problem, ...] = ()

    def runs_at(self, omega: float) -> bool:
        """
        Tell whether the axis keeps its limits at a steady shaft speed.

        Parameters
        ----------
        omega : float
            The speed [rad/s].

        Returns
        -------
        bool
            Whether it does.

        """
        return self.bound is None or abs(omega) <= self.bound.omega * (1.0 + SLACK)


@dataclass(frozen=True)
class CheckSummary:
    """
    The outcome of a check.

    Attributes
    ----------
    problems : tuple[Problem, ...]
        Everything that is wrong.
    speed_cpm : float | None
        Shaft speed for which the physical figures hold [cycles/min]; None if it is unknown.
    axes : Mapping[str, AxisSummary]
        The axes that could be built, in the order of the line.
    margins : Mapping[str, LimitFigures]
        What the drives with a given motor leave of its limits, where the machine is sound.
    interlocks : Mapping[str, JudgedInterlock]
        By how much the interlocks are kept, likewise.
    linkages : Mapping[str, LinkageSettings]
        The linkages that are sound.
    stepping : Mapping[str, Mapping[str, Continuity]]
        The joints of cams that are refused only because their velocity steps, by axis and cam.
    cam_discs : Mapping[str, CamDiscSettings]
        The cam discs that can be built.
    units : Mapping[str, str]
        Units of the axes in `stepping`.
    of_drives : tuple[Problem, ...]
        What to mind of drives that turn a cam shaft, where the machine is sound.

    """

    problems: tuple[Problem, ...]
    speed_cpm: float | None
    axes: Mapping[str, AxisSummary]
    margins: Mapping[str, LimitFigures] = field(default_factory=dict)
    interlocks: Mapping[str, JudgedInterlock] = field(default_factory=dict)
    linkages: Mapping[str, LinkageSettings] = field(default_factory=dict)
    stepping: Mapping[str, Mapping[str, Continuity]] = field(default_factory=dict)
    cam_discs: Mapping[str, CamDiscSettings] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    of_drives: tuple[Problem, ...] = ()

    @property
    def warnings(self) -> tuple[Problem, ...]:
        """List what is to be known of what is sound, paths of the whole configuration."""
        return (*(warning.below(name) for name, axis in self.axes.items()
                  for warning in axis.warnings), *self.of_drives)

    @property
    def runs_at_set_speed(self) -> bool:
        """Tell whether the machine is sound and every axis keeps its limits at the set speed."""
        return not self.problems and self.speed_cpm is not None and all(
            axis.runs_at(self.speed_cpm * RPM) for axis in self.axes.values())

    @property
    def line_bound(self) -> tuple[str, SpeedBound] | None:
        """Find the axis that holds the whole line back, and its bound; None where nothing does."""
        return TimingDiagram({name: each.axis for name, each in self.axes.items()}).speed_bound()


def check_sections(sections: Mapping[str, Values], speed_cpm: float | None = None) -> CheckSummary:
    """
    Check a whole configuration, and report whatever of it can be built.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.
    speed_cpm : float | None
        Shaft speed to take instead of the configured one [cycles/min].

    Returns
    -------
    CheckSummary
        All problems, and the figures of every axis that is sound in itself.

    """
    linkages, wrong = build_linkages(sections)
    if linkage_names(sections) == list(sections):  # a file of linkages only has no line
        return CheckSummary(tuple(wrong), None, {}, linkages=linkages)
    line, turning = _line(sections), turning_drive(sections)
    if speed_cpm is not None and not turning:
        sections = with_speed(sections, speed_cpm)
    problems: tuple[Problem, ...] = ()
    margins: Mapping[str, LimitFigures] = {}
    interlocks: Mapping[str, JudgedInterlock] = {}
    of_drives: tuple[Problem, ...] = ()
    try:
        machine = build_machine(sections)
        margins, interlocks = _margins(machine), machine.interlocks
        of_drives = _warnings(machine)
    except ConfigurationError as error:
        problems = error.problems
    if speed_cpm is None:
        speed_cpm = _set_speed(sections, line['master'], turning)
    built: dict[str, CoupledAxis | None] = {}
    stepping = {}
    for name in line['axes'] or guess_line(sections)['axes']:
        given = sections.get(name, {})
        try:
            built[name] = build_axis(name, given)
        except ConfigurationError:  # its problems are among those above
            if found := stepping_cams(given):
                stepping[name] = found
    axes = {name: summarise_axis(axis, speed_cpm * RPM)
            for name, axis in in_cascade(built, []).items() if axis is not None}
    wrong = [each for each in wrong if each not in problems]  # of linkages beside the line
    discs, of_discs = check_discs(sections)
    return CheckSummary((*problems, *wrong, *of_discs), speed_cpm, axes, margins, interlocks,
                        linkages, stepping, discs,
                        {name: str(sections[name].get('unit', 'm')) for name in stepping},
                        of_drives)


def _warnings(machine: Machine) -> tuple[Problem, ...]:
    """Say what to mind of the drives, if anything."""
    found: list[Problem] = []
    for name, drive in machine.drives.items():
        try:
            turn_profile(machine.diagram.axes[drive.axis], name)
        except ConfigurationError as error:
            found += error.problems
    if machine.cam_drives:
        from cam_motion.io.cam_drive_findings import findings
        found += [Problem(name, None, text) for name, drive in machine.cam_drives.items()
                  for text in findings(drive)]
    return tuple(found)


def _margins(machine: Machine) -> dict[str, LimitFigures]:
    """Compare the drives that have a motor with its limits, at the set speed."""
    omega = machine.master.speed
    return {
        name: limit_figures(drive.drive, drive.motor, turn_profile(axis), omega)
        for name, drive in machine.drives.items() if drive.motor is not None and omega
        and repeats(axis := machine.diagram.axes[drive.axis])}


def _set_speed(sections: Mapping[str, Values], master: str, turning: str) -> float:
    """Read the set speed of a line, nominal where a drive turns the shaft [cycles/min]."""
    if turning:
        nominal, _ = check_values(CAM_DRIVE, sections[turning])
        if nominal['nominal_rpm'] is not None:
            return float(nominal['nominal_rpm'])
    values, _ = check_values(parameters.MASTER_SHAFT, sections.get(master, {}))
    return float(values['speed_cpm'])


def with_speed(sections: Mapping[str, Values], speed_cpm: float) -> dict[str, Values]:
    """
    Give a configuration another shaft speed.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.
    speed_cpm : float
        The speed [cycles/min].

    Returns
    -------
    dict[str, Mapping[str, Any]]
        The configuration, the set speed of its master replaced.

    Raises
    ------
    ConfigurationError
        When a drive turns the shaft: no setting says how fast.

    """
    master = _line(sections)['master']
    if turning := turning_drive(sections):
        raise ConfigurationError([Problem(
            'speed_cpm', speed_cpm, f'{turning} turns the shaft: its motor and its load make '
            'the speed', 'give it another motor.synchronous_rpm or gearbox.ratio')])
    return {**sections, master: {**sections.get(master, {}), 'speed_cpm': speed_cpm}}


def turning_drive(sections: Mapping[str, Values]) -> str:
    """
    Find the drive that turns the shaft itself.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.

    Returns
    -------
    str
        Its name; empty where a master shaft turns it.

    """
    return next(iter(shaft_drives(sections, _line(sections)['drives'])), '')


def _line(sections: Mapping[str, Values]) -> dict[str, Any]:
    line, _ = line_values(sections.get('line', guess_line(sections)))
    return line


def summarise_axis(axis: Axis, omega: float) -> AxisSummary:
    """
    Gather the figures of an axis.

    Parameters
    ----------
    axis : Axis
        The axis.
    omega : float
        Shaft speed for the physical figures [rad/s].

    Returns
    -------
    AxisSummary
        Its figures.

    """
    cams = axis.layout.cams if isinstance(axis, CoupledAxis) else {ONLY_CAM: axis.profile}
    continuity = {name: continuity_of(profile) for name, profile in cams.items()}
    return AxisSummary(axis, tuple(_segments(axis.profile, omega)), axis.speed_bound, continuity,
                       joint_warnings(cams, continuity, axis.unit, omega))


def _segments(profile: CamProfile, omega: float) -> list[SegmentSummary]:
    found, start_deg = [], 0.0
    for segment, _, velocity, acceleration, jerk in profile.segment_peaks:
        found.append(SegmentSummary(
            segment.name, segment.law.name, start_deg, segment.end_deg, segment.lift,
            (velocity, acceleration, jerk),
            (velocity.value * omega, acceleration.value * omega * omega,
             jerk.value * omega * omega * omega)))
        start_deg = segment.end_deg
    return found


def bound_text(bound: SpeedBound, unit: str) -> str:
    """
    Say what holds a shaft back.

    Parameters
    ----------
    bound : SpeedBound
        The bound.
    unit : str
        Unit of the axis' position.

    Returns
    -------
    str
        Segment, quantity, limit and angle: ``feed: acceleration 400 m/s² at 10 deg``. Of an
        axis behind another one only what is known.

    """
    if math.isnan(bound.limit):
        return f'{bound.segment}: its limits'
    rate = rate_text(unit, QUANTITIES.index(bound.quantity))
    where = '' if math.isnan(bound.at) else f' at {bound.at / DEGREE:.6g} deg'
    return f'{bound.segment}: {bound.quantity} {bound.limit:g} {rate}{where}'
