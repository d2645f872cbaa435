# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A report as tables for people."""

from __future__ import annotations

from cam_motion.cli.terminal import console, number, row, table
from cam_motion.io.comparison import TOLERANCE_TEXT
from cam_motion.io.findings import findings, notes
from cam_motion.io.report import Report
from cam_motion.units import rate_text, RPM
from rich.table import Table


def print_report(report: Report) -> None:
    """
    Print a report.

    Parameters
    ----------
    report : Report
        The report.

    """
    out = console()
    recording, ticks = report.recording, report.ticks
    size = sum(recording.files.values())
    out.print(f'{recording.path}: {sum(recording.counts.values())} messages on '
              f'{len(recording.counts)} topics, {size / 1e6:.2f} MB', style='bold')
    for name, bytes_ in recording.files.items():
        out.print(f'  {name}  {bytes_} B')
    out.print(f'duration {report.duration:.3f} s, {report.cycles:.3f} cycles, up to '
              f'{number(report.top_speed / RPM, 6)} cycles/min')
    out.print(f'ticks {ticks.recorded} recorded, {ticks.expected} expected, {ticks.missed} missed '
              f'(grid of {number(ticks.rate_hz)} Hz)')
    out.print()
    out.print(_axes_table(report))
    out.print(_peaks_table(report))
    if report.drives:
        out.print(_drives_table(report))
    if report.linkages:
        out.print(_linkages_table(report))
    out.print(_messages_table(report))
    for note in notes(report):
        out.print(f'note: {note}')
    found = findings(report)
    for finding in found:
        out.print(f'FINDING: {finding}', style='bold red')
    if not found:
        holds = _some_holds(report)
        which = 'compared ' if any(axis.elsewhere for axis in report.axes.values()) else ''
        out.print(f"every setpoint {which}is within {TOLERANCE_TEXT} of its axis' own peak, and "
                  f'every shaft tick is answered{holds}', style='bold')


def _some_holds(report: Report) -> str:
    holds = sum(axis.holds for axis in report.axes.values())
    return f' ({holds} hold setpoints at the end set aside)' if holds else ''


def _axes_table(report: Report) -> Table:
    made = table(
        'worst deviation from the exact curve, as a share of the own peak', [
            ('axis', 'left'), ('setpoints', 'right'), ('unanswered', 'right'), ('holds', 'right'),
            ('position', 'right'), ('velocity', 'right'), ('acceleration', 'right')])
    for name, axis in report.axes.items():
        row(made, name, str(axis.setpoints), str(axis.unanswered), str(axis.holds),
            *(number(worst, 2) for worst in axis.deviations))
    return made


def _peaks_table(report: Report) -> Table:
    made = table('peaks reached', [
        ('axis', 'left'), ('velocity', 'right'), ('limit', 'right'), ('', 'left'),
        ('acceleration', 'right'), ('limit', 'right'), ('', 'left')])
    for name, report_ in report.axes.items():
        cells = []
        for order, peak in enumerate(report_.peaks, start=1):
            limit = report_.axis.limits.of_order(order)
            cells += [number(peak), '' if limit is None else number(limit),
                      rate_text(report_.axis.unit, order)]
        row(made, name, *cells)
    return made


def _drives_table(report: Report) -> Table:
    followed = any(drive.following_error is not None for drive in report.drives.values())
    made = table('drives', [
        ('drive', 'left'), ('states', 'right'), ('peak torque\nN m', 'right'),
        ('RMS torque\nN m', 'right'), ('peak speed\nrpm', 'right'),
        *([('peak following error', 'right')] if followed else [])])
    machine = report.recording.machine
    for name, drive in report.drives.items():
        cells = [number(drive.peak_torque), number(drive.rms_torque),
                 number(drive.peak_speed / RPM)]
        if drive.following_error is not None:
            unit = machine.diagram.axes[machine.drives[name].axis].unit
            cells.append(f'{number(drive.following_error)} {unit}')
        row(made, name, str(drive.states), *cells, *[''] * (3 + followed - len(cells)))
    return made


def _linkages_table(report: Report) -> Table:
    made = table('linkages', [
        ('linkage', 'left'), ('states', 'right'), ('loops closed\nwithin m', 'right'),
        ('input', 'left'), ('from', 'right'), ('to', 'right'), ('', 'left')])
    for name, linkage in report.linkages.items():
        described = report.recording.machine.linkages[name].linkage
        cells = [name, str(linkage.states), number(linkage.gap, 2)]
        for variable, ends in linkage.travel.items():
            row(made, *cells, variable, *map(number, ends), described.unit(variable))
            cells = [''] * 3
        if not linkage.travel:
            row(made, *cells, '', '', '', '')
    return made


def _messages_table(report: Report) -> Table:
    made = table('messages', [('topic', 'left'), ('count', 'right')])
    for name, count in report.recording.counts.items():
        row(made, name, str(count))
    return made
