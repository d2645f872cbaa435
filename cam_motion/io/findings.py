# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a report has to be told aloud: findings, which fail it, and notes, which do not."""

from __future__ import annotations

from collections.abc import Iterator

from cam_motion.io.comparison import AxisReport, QUANTITIES, TOLERANCE, TOLERANCE_TEXT
from cam_motion.io.machine import DriveSettings
from cam_motion.io.report import DriveReport, Report
from cam_motion.units import rate_text, RPM, TURN
import numpy as np

# A torque so close to the peak torque is at it: the speed, on which that depends, goes on
# within a period of the control loop.
_AT_LIMIT = 0.995
_BEYOND = 1.0 + 1e-9


def findings(report: Report) -> list[str]:
    """
    Say what is wrong with a recorded run.

    Parameters
    ----------
    report : Report
        The report.

    Returns
    -------
    list[str]
        One sentence each; empty where every shaft tick has its setpoint, each within
        `TOLERANCE` of the exact curve, and no motor has come to its peak torque.

    """
    found = []
    if report.ticks.repeated:
        found.append(f'shaft: {_some(report.ticks.repeated, "point")} in motion repeat the time '
                     'of the one before')
    for name, setpoints in report.recording.setpoints.items():
        if setpoints is None:
            found.append(f'{name}: the bag has no setpoints of it')
    for name, axis in report.axes.items():
        found += [f'{name}: {text}' for text in _axis_findings(axis)]
    found += [f'{name}: its loops fail to close by {linkage.gap:.3g} m, and open at '
              f'{linkage.slip:.3g} m/s' for name, linkage in report.linkages.items()
              if not linkage.sound]
    for name, settings in report.recording.machine.drives.items():
        if name in report.drives and report.drives[name].states:
            unit = report.recording.machine.diagram.axes[settings.axis].unit
            found += [f'{name}: {text}'
                      for text in _drive_findings(settings, report.drives[name], unit)]
    return found


def _drive_findings(settings: DriveSettings, drive: DriveReport, unit: str) -> Iterator[str]:
    motor = settings.motor
    if motor is None:
        return
    peak = np.asarray(motor.peak_torque(drive.motor_speed))
    torque = np.abs(drive.motor_torque)
    if settings.servo is None:
        if np.any(beyond := torque > peak * _BEYOND):
            worst = int(np.argmax(np.where(beyond, torque - peak, -np.inf)))
            yield (f'{_some(int(beyond.sum()), "state")} beyond the motor: at '
                   f'{drive.motor_speed[worst] / RPM:.5g} rpm it would take '
                   f'{torque[worst]:.5g} N m, and the motor gives '
                   f'{peak[worst]:.5g} N m')
        return
    at_limit = (torque >= peak * _AT_LIMIT) & (torque > 0.0)
    if np.any(at_limit):
        error = ('' if drive.following_error is None else
                 f'; its axis was up to {drive.following_error:.5g} {unit} off its set position')
        yield (f'its motor was at its peak torque in {_some(int(at_limit.sum()), "state")}, with '
               f'{drive.peak_torque:.5g} N m{error}')


def _axis_findings(axis: AxisReport) -> Iterator[str]:
    rows = zip(QUANTITIES, axis.deviations, axis.comparison.deviations)
    for quantity, worst, deviations in rows:
        if not worst <= TOLERANCE:
            at = int(np.argmax(deviations))
            angle = axis.comparison.phi[at] % TURN / TURN * 360.0
            count = _some(int(np.sum(~(deviations <= TOLERANCE))), 'setpoint')
            yield (f'{quantity} off the exact curve by {worst:.3g} of its peak at {angle:.4g} deg '
                   f'({count} off by more than {TOLERANCE_TEXT})')
    if axis.unanswered:
        yield (f'{_some(axis.unanswered, "shaft tick")} without a setpoint, the first at '
               f'{axis.unanswered_at:.6g} s')
    if 'fault' in axis.elsewhere:
        yield 'it went into fault'
    if axis.unpaired:
        yield f'{_some(axis.unpaired, "setpoint")} for which the bag has no shaft point'
    if axis.repeated:
        yield f'{_some(axis.repeated, "setpoint")} repeat a tick without being a hold'


def notes(report: Report) -> list[str]:
    """
    Say what is worth knowing of a recorded run without being wrong.

    Parameters
    ----------
    report : Report
        The report.

    Returns
    -------
    list[str]
        One sentence each.

    """
    recording, ticks = report.recording, report.ticks
    found = []
    if recording.incomplete:
        found.append('the bag is incomplete: its recorder was cut off, the end may be missing')
    if ticks.missed:
        at, count = max(ticks.gaps, key=lambda gap: gap[1])
        said = recording.master_health.get('missed_ticks')
        found.append(
            f'{_some(ticks.missed, "shaft tick")} missed in {_some(len(ticks.gaps), "gap")}, the '
            f'longest of {count} behind {at:.6g} s'
            + (f'; the shaft itself counted {said}' if said is not None else ''))
    if ticks.irregular:
        found.append(f'{_some(ticks.irregular, "shaft tick")} off the grid of '
                     f'{ticks.rate_hz:g} Hz')
    for name, axis in report.axes.items():
        if axis.unheard:
            found.append(f'{name}: {_some(axis.unheard, "shaft tick")} before the recorder heard '
                         'the axis, or after it had left')
        if axis.elsewhere:
            times = ', '.join(f'{lasted:.3g} s {what.replace("_", " ")}'
                              for what, lasted in axis.elsewhere.items())
            found.append(f'{name}: not compared with the machine file for {times}')
        for order, peak in enumerate(axis.peaks, start=1):
            limit = axis.axis.limits.of_order(order)
            if limit is not None and peak > limit * (1.0 + TOLERANCE):
                unit = rate_text(axis.axis.unit, order)
                found.append(f'{name}: {QUANTITIES[order]} reached {peak:.6g} {unit}, beyond its '
                             f'limit of {limit:g} {unit}')
    missing = [
        *(name for name in recording.machine.drive_names if name not in report.drives),
        *(name for name in recording.machine.linkages
          if name not in report.linkages or not report.linkages[name].states)]
    found += [f'{name}: the bag has no states of it' for name in missing]
    for name, drive in report.drives.items():
        motor = None if name not in recording.machine.drives else (
            recording.machine.drives[name].motor)
        if motor is None or not drive.states:
            continue
        mean = float(np.mean(np.abs(drive.motor_speed)))
        allowed = float(motor.continuous_torque(mean))
        if drive.rms_torque > allowed * _BEYOND:
            found.append(f'{name}: an RMS torque of {drive.rms_torque:.5g} N m overheats the '
                         f'motor, which gives {allowed:.5g} N m for good at its mean speed of '
                         f'{mean / RPM:.5g} rpm')
    return found


def _some(count: int, noun: str) -> str:
    return f'{count} {noun}' if count == 1 else f'{count} {noun}s'
