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
from cam_motion.io.report import Report
from cam_motion.units import rate_text, TURN
import numpy as np


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
        `TOLERANCE` of the exact curve.

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
    return found


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
    return found


def _some(count: int, noun: str) -> str:
    return f'{count} {noun}' if count == 1 else f'{count} {noun}s'
