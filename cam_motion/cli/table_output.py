# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What the verb ``table`` prints, for people and for machines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
import math
from typing import Any

from cam_motion.cli.terminal import console, number, row
from cam_motion.cli.terminal import table as new_table
from cam_motion.io.plain import finite
from cam_motion.io.tables import CamTable
from cam_motion.io.tables.export import CamToExport, ExportedTable
from cam_motion.io.tables.finding import ERROR, Finding
from cam_motion.io.tables.repair import CurveFigures, ImportedCam
from cam_motion.motion.limits import QUANTITIES
from cam_motion.motion.piecewise import Peak
from cam_motion.units import DEGREE, rate_text, RPM


def finding_as_data(finding: Finding) -> dict[str, Any]:
    """
    Give a finding as plain data.

    Parameters
    ----------
    finding : Finding
        The finding.

    Returns
    -------
    dict[str, Any]
        What goes into JSON.

    """
    return {
        'code': finding.code, 'severity': finding.severity, 'line': finding.line or None,
        'angle_deg': finite(finding.angle_deg), 'value': finite(finding.value),
        'text': finding.text, 'harm': finding.harm, 'way_out': finding.hint,
    }


def _peaks(figures: CurveFigures) -> dict[str, Any]:
    return {
        'class': f'C{figures.continuity}',
        **{f'{name}_per_rad': {'value': finite(peak.value), 'at_deg': peak.at / DEGREE}
           for name, peak in zip(QUANTITIES[1:], figures.peaks)},
    }


def import_as_data(made: ImportedCam, findings: Sequence[Finding]) -> dict[str, Any]:
    """
    Give an imported cam as plain data.

    Parameters
    ----------
    made : ImportedCam
        The cam.
    findings : Sequence[Finding]
        What was wrong with its table.

    Returns
    -------
    dict[str, Any]
        What goes into JSON.

    """
    table = made.table
    return {
        'axis': made.axis.name, 'format': table.format_name, 'notes': list(table.notes),
        'points': {'table': len(table.angle), 'spline': made.points},
        'tolerance': made.tolerance,
        'deviation': {'value': made.deviation, 'line': table.lines[made.deviation_at] or None},
        'before': _peaks(made.before), 'after': _peaks(made.after),
        'findings': [finding_as_data(each) for each in findings],
        'section': dict(made.section),
    }


def export_as_data(made: ExportedTable, unit: str) -> dict[str, Any]:
    """
    Give a written table as plain data.

    Parameters
    ----------
    made : ExportedTable
        The table.
    unit : str
        Unit of the axis.

    Returns
    -------
    dict[str, Any]
        What goes into JSON.

    """
    return {
        'format': made.target.name, 'points': made.points, 'unit': unit,
        'interpolation': made.interpolation,
        'deviation': {f'{name}{"_per_rad" if order else ""}': {
            'value': peak.value, 'at_deg': peak.at / DEGREE}
            for order, (name, peak) in enumerate(zip(QUANTITIES, made.deviations))},
        'velocity_step_per_rad': made.steps[0], 'acceleration_step_per_rad': made.steps[1],
        'doubt': made.target.doubt,
    }


def print_findings(table: CamTable, what: str, findings: Sequence[Finding], speed_cpm: float,
                   unit: str) -> None:
    """
    Print what is wrong with a table.

    Parameters
    ----------
    table : CamTable
        The table.
    what : str
        In which format it was read, and why.
    findings : Sequence[Finding]
        What is wrong.
    speed_cpm : float
        Speed at which the harm is told [cycles/min].
    unit : str
        Unit of the axis.

    """
    _head(table, what, unit)
    out = console()
    if not findings:
        out.print('nothing is wrong with it')
        return
    made = new_table(f'what is wrong, at {number(speed_cpm)} cycles/min', [
        ('', 'left'), ('line', 'right'), ('angle\ndeg', 'right'),
        ('what, what comes of it, and the way out', 'full')])
    for each in findings:
        where = '' if math.isnan(each.angle_deg) else number(round(each.angle_deg, 6), 7)
        row(made, each.severity, str(each.line or ''), where,
            f'{each.text}\n→ {each.harm}\n  {each.hint}',
            style='bold' if each.severity == ERROR else None)
    out.print(made)


def _head(table: CamTable, what: str, unit: str, to_stderr: bool = False) -> None:
    out = console(stderr=to_stderr)
    columns = 2 + (table.velocity is not None) + (table.acceleration is not None)
    out.print(f'{table.source}: {what}')
    out.print(f'{len(table.angle)} points, {columns} columns, stroke {number(table.stroke)} '
              f'{unit}, cycle: {table.cycle}, interpolation: {table.interpolation}')
    for note in table.notes:
        out.print(f'note: {note}')


def print_import(made: ImportedCam, what: str, findings: Sequence[Finding], speed_cpm: float,
                 unit: str, to_stderr: bool = False) -> None:
    """
    Print what became of an imported table.

    Parameters
    ----------
    made : ImportedCam
        The cam.
    what : str
        In which format it was read, and why.
    findings : Sequence[Finding]
        What is wrong with the table.
    speed_cpm : float
        Speed of the physical figures [cycles/min].
    unit : str
        Unit of the axis.
    to_stderr : bool
        Whether standard output is left to the YAML.

    """
    _head(made.table, what, unit, to_stderr)
    out = console(stderr=to_stderr)
    if findings:
        codes = ', '.join(dict.fromkeys(each.code for each in findings))
        out.print(f'{len(findings)} found in the table: {codes} (see table lint)')
    how = 'through every point' if made.tolerance is None else (
        f'within {number(made.tolerance)} {unit}')
    line = made.table.lines[made.deviation_at]
    out.print(f'spline {how}: {made.points} points, largest deviation '
              f'{number(made.deviation, 3)} {unit}' + (f' at line {line}' if line else ''))
    shown = new_table(f'peaks at {number(speed_cpm)} cycles/min', [
        ('', 'left'), ('class', 'left'),
        *((f'{name}\n{rate_text(unit, order)}', 'right')
          for order, name in enumerate(QUANTITIES[1:], start=1))])
    for title, figures in (('the table as its controller interpolates it', made.before),
                           ('the spline', made.after)):
        row(shown, title, f'C{figures.continuity}' if figures.continuity >= 0 else 'jumps',
            *(number(value) for value in _physical(figures.peaks, speed_cpm)))
    out.print(shown)


def _physical(peaks: Iterable[Peak], speed_cpm: float) -> list[float]:
    return [peak.value * (speed_cpm * RPM) ** order for order, peak in enumerate(peaks, start=1)]


def print_export(made: ExportedTable, unit: str, cam: CamToExport, to_stderr: bool = False
                 ) -> None:
    """
    Print how far a written table is off.

    Parameters
    ----------
    made : ExportedTable
        The table.
    unit : str
        Unit of the axis.
    cam : CamToExport
        The cam.
    to_stderr : bool
        Whether standard output is left to the table.

    """
    out = console(stderr=to_stderr)
    out.print(f'{cam.name} as {made.target.title}: {made.points} points, {made.interpolation} '
              'interpolation')
    for note in filter(None, (made.target.doubt, cam.note)):
        out.print(f'note: {note}')
    shown = new_table("what the target's curve differs by, at most", [
        ('', 'left'), ('deviation', 'right'), ('', 'left'), ('at\ndeg', 'right'),
        ('of the peak', 'right')])
    for order, (name, peak) in enumerate(zip(QUANTITIES, made.deviations)):
        own = (abs(cam.curve.extremes(0)[1].value - cam.curve.extremes(0)[0].value)
               if order == 0 else abs(cam.curve.peak(order).value))
        own *= (math.tau / cam.span) ** order
        row(shown, name, number(peak.value, 4), rate_text(unit, order, 'rad'),
            number(peak.at / DEGREE), f'{abs(peak.value) / own:.2g}' if own else '')
    out.print(shown)
    for name, order, step in zip(QUANTITIES[1:], (1, 2), made.steps):
        if step:
            out.print(f'its {name} steps at the points by up to {number(step, 4)} '
                      f'{rate_text(unit, order, "rad")}')
            break
