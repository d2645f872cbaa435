# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The outcome of a check as plain data, for JSON."""

from __future__ import annotations

from typing import Any

from cam_motion.drive.servo_cycle import LimitFigures
from cam_motion.errors import Problem
from cam_motion.io.contour_data import disc_as_data
from cam_motion.io.interlocks import JudgedInterlock
from cam_motion.io.linkage_data import range_as_data
from cam_motion.io.plain import finite, plain
from cam_motion.io.summary import AxisSummary, bound_text, CheckSummary, SegmentSummary
from cam_motion.motion.continuity import Continuity, Joint
from cam_motion.motion.limits import QUANTITIES
from cam_motion.runtime.interlock import Windows
from cam_motion.units import DEGREE, RPM


def check_as_data(check: CheckSummary) -> dict[str, Any]:
    """
    Turn the outcome of a check into plain data.

    Parameters
    ----------
    check : CheckSummary
        The outcome.

    Returns
    -------
    dict[str, Any]
        What ``cam_motion check --json`` prints; infinite figures are None.

    """
    line = check.line_bound
    omega = (check.speed_cpm or 0.0) * RPM
    return {
        'problems': [problem_as_data(problem) for problem in check.problems],
        'warnings': [problem_as_data(warning) for warning in check.warnings],
        'speed_cpm': check.speed_cpm,
        'runs_at_set_speed': check.runs_at_set_speed,
        'line': {
            'max_speed_cpm': finite(line[1].omega / RPM) if line else None,
            'axis': line[0] if line else None,
        },
        'axes': {name: _axis_as_data(axis, omega) for name, axis in check.axes.items()},
        'stepping': {name: {cam: continuity_as_data(each, omega) for cam, each in cams.items()}
                     for name, cams in check.stepping.items()},
        'drives': {name: margins_as_data(margins) for name, margins in check.margins.items()},
        'interlocks': {name: judged_as_data(each) for name, each in check.interlocks.items()},
        'linkages': {name: {each: range_as_data(settings, each)
                            for each in settings.linkage.inputs}
                     for name, settings in check.linkages.items()},
        'cam_discs': {name: disc_as_data(each) for name, each in check.cam_discs.items()},
    }


def judged_as_data(judged: JudgedInterlock) -> dict[str, Any]:
    """
    Turn a judged interlock into plain data.

    Parameters
    ----------
    judged : JudgedInterlock
        The interlock, and by how much it is kept.

    Returns
    -------
    dict[str, Any]
        Its axes, whether it is kept, the least margin, in degrees between windows, and where.

    """
    verdict = judged.verdict
    angle = isinstance(judged.interlock, Windows)
    return {
        'axes': list(judged.interlock.axes), 'kept': verdict.kept,
        'margin_deg' if angle else 'margin': finite(verdict.margin / (DEGREE if angle else 1.0)),
        'at_deg': verdict.at / DEGREE, 'text': verdict.text,
    }


def margins_as_data(margins: LimitFigures) -> dict[str, float]:
    """
    Turn what a drive leaves of its motor's limits into plain data.

    Parameters
    ----------
    margins : LimitFigures
        The figures.

    Returns
    -------
    dict[str, float]
        The same, speeds in rpm.

    """
    return {
        'peak_torque_margin': margins.peak_torque_margin,
        'rms_torque_margin': margins.rms_torque_margin,
        'speed_margin_rpm': margins.speed_margin / RPM,
        'mean_speed_rpm': margins.mean_speed / RPM,
        'rms_speed_rpm': margins.rms_speed / RPM,
    }


def problem_as_data(problem: Problem) -> dict[str, Any]:
    """
    Turn a problem into plain data.

    Parameters
    ----------
    problem : Problem
        The problem.

    Returns
    -------
    dict[str, Any]
        Its path, value, rule and hint.

    """
    return {'path': problem.path, 'value': plain(problem.value), 'rule': problem.rule,
            'hint': problem.hint}


def continuity_as_data(continuity: Continuity, omega: float) -> dict[str, Any]:
    """
    Turn the continuity of a cam into plain data.

    Parameters
    ----------
    continuity : Continuity
        The joints.
    omega : float
        Set speed of the shaft [rad/s].

    Returns
    -------
    dict[str, Any]
        Class of the cam and where it is lowest, and the same for each joint.

    """
    return {
        **_joint_as_data(continuity.weakest, omega),
        'joints': [{
            'before': each.before.name, 'after': each.after.name,
            **_joint_as_data(each.joint, omega),
            'inside': None if each.inside is None else _joint_as_data(each.inside, omega),
        } for each in continuity.joints],
    }


def _joint_as_data(joint: Joint, omega: float) -> dict[str, Any]:
    return {
        'class': joint.label, 'at_deg': joint.at / DEGREE, 'order': joint.order,
        'geometric_step': joint.step, 'step': finite(joint.step_at(omega))}


def _axis_as_data(summary: AxisSummary, omega: float) -> dict[str, Any]:
    axis, bound = summary.axis, summary.bound
    cams = {cam: continuity_as_data(each, omega) for cam, each in summary.continuity.items()}
    return {
        'unit': axis.unit,
        'max_speed_cpm': finite(bound.omega / RPM) if bound else None,
        'limited_by': bound_text(bound, axis.unit) if bound else None,
        'advance': axis.profile.advance,
        'limits': {name: axis.limits.of_order(order)
                   for order, name in enumerate(QUANTITIES[1:], start=1)},
        'segments': [_segment_as_data(segment) for segment in summary.segments],
        'runs_at_set_speed': summary.runs_at(omega),
        'continuity': next(iter(cams.values())) if len(cams) == 1 else cams,
    }


def _segment_as_data(segment: SegmentSummary) -> dict[str, Any]:
    data: dict[str, Any] = {
        'name': segment.name, 'law': segment.law, 'start_deg': segment.start_deg,
        'end_deg': segment.end_deg, 'lift': segment.lift,
    }
    rows = list(zip(QUANTITIES[1:], segment.geometric, segment.physical))
    data |= {f'peak_{name}': finite(physical) for name, _, physical in rows}
    data |= {f'peak_{name}_deg': peak.at / DEGREE for name, peak, _ in rows}
    data |= {f'geometric_{name}': finite(peak.value) for name, peak, _ in rows}
    return data
