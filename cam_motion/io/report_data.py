# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A report as plain data, for JSON."""

from __future__ import annotations

from typing import Any

from cam_motion.io.comparison import AxisReport, QUANTITIES, TOLERANCE
from cam_motion.io.findings import findings, notes
from cam_motion.io.linkage_report import LinkageReport
from cam_motion.io.plain import finite
from cam_motion.io.report import DriveReport, Report
from cam_motion.motion.limits import QUANTITIES as DERIVATIVES
from cam_motion.units import RPM


def report_as_data(report: Report) -> dict[str, Any]:
    """
    Turn a report into plain data.

    Parameters
    ----------
    report : Report
        The report.

    Returns
    -------
    dict[str, Any]
        What ``cam_motion report --json`` prints, but for the files written.

    """
    recording, ticks = report.recording, report.ticks
    return {
        'bag': str(recording.path),
        'incomplete': recording.incomplete,
        'duration_s': report.duration,
        'cycles': report.cycles,
        'top_speed_cpm': finite(report.top_speed / RPM),
        'tolerance': TOLERANCE,
        'ticks': {
            'recorded': ticks.recorded, 'expected': ticks.expected, 'missed': ticks.missed,
            'irregular': ticks.irregular, 'holds': ticks.holds, 'repeated': ticks.repeated,
            'rate_hz': ticks.rate_hz,
            'gaps': [{'after_s': at, 'missed': count} for at, count in ticks.gaps],
            'missed_as_counted_by_master': _whole(recording.master_health.get('missed_ticks')),
            'late_as_counted_by_master': _whole(recording.master_health.get('late_ticks')),
        },
        'axes': {name: _axis(axis) for name, axis in report.axes.items()},
        'drives': {name: _drive(drive) for name, drive in report.drives.items()},
        'linkages': {name: _linkage(linkage) for name, linkage in report.linkages.items()},
        'messages': dict(recording.counts),
        'bag_files': [{'path': name, 'bytes': size} for name, size in recording.files.items()],
        'findings': findings(report),
        'notes': notes(report),
    }


def _axis(axis: AxisReport) -> dict[str, Any]:
    return {
        'unit': axis.axis.unit,
        'setpoints': axis.setpoints, 'holds': axis.holds, 'repeated': axis.repeated,
        'unpaired': axis.unpaired, 'unanswered': axis.unanswered, 'unheard': axis.unheard,
        'deviation': {name: finite(worst) for name, worst in zip(QUANTITIES, axis.deviations)},
        **({'elsewhere_s': dict(axis.elsewhere)} if axis.elsewhere else {}),
        'peak_velocity': finite(axis.peaks[0]),
        'peak_acceleration': finite(axis.peaks[1]),
        'limits': {name: axis.axis.limits.of_order(order)
                   for order, name in enumerate(DERIVATIVES[1:], start=1)},
    }


def _drive(drive: DriveReport) -> dict[str, Any]:
    followed = {} if drive.following_error is None else {
        'peak_following_error': finite(drive.following_error)}
    return {
        'states': drive.states,
        'peak_torque': finite(drive.peak_torque),
        'rms_torque': finite(drive.rms_torque),
        'peak_speed_rpm': finite(drive.peak_speed / RPM), **followed,
    }


def _linkage(linkage: LinkageReport) -> dict[str, Any]:
    return {'states': linkage.states, 'gap_m': finite(linkage.gap), 'slip': finite(linkage.slip),
            'inputs': {name: list(ends) for name, ends in linkage.travel.items()}}


def _whole(text: str | None) -> int | None:
    return int(text) if text is not None and text.isdecimal() else None
