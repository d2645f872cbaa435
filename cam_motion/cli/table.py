# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``table``: cam tables of other systems, judged, taken over and written."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cam_motion.cli.options import add_config, add_json, finite_number
from cam_motion.cli.table_output import (
    export_as_data,
    finding_as_data,
    import_as_data,
    print_export,
    print_findings,
    print_import,
)
from cam_motion.cli.terminal import print_files, print_json, save_figure
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.axis import build_axis, CoupledAxis
from cam_motion.io.config import read_sections, section_yaml
from cam_motion.io.tables import (
    CamTable,
    CYCLES,
    FORMATS,
    INTERPOLATIONS,
    read_table,
    TableOptions,
    write_text,
    written_formats,
)
from cam_motion.io.tables.export import (
    CamToExport,
    export_cam,
    ExportedTable,
    ExportOptions,
)
from cam_motion.io.tables.finding import Finding, NOTE
from cam_motion.io.tables.lint import lint
from cam_motion.io.tables.repair import import_table, ImportedCam
from cam_motion.io.tables.text import DELIMITERS
from cam_motion.units import DEGREE, RPM, TURN

DEFAULT_CPM = 60.0
"""Speed at which the harm of a finding is told [cycles/min]."""


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = (
        'Cam tables of other systems: say what is wrong with one, make an axis of '
        'it, repaired within a stated deviation, or write a cam as one and say how '
        'far the target will be off. Formats: ' + '; '.join(
            f'{name}: {each.title}' for name, each in FORMATS.items()) + '.')
    actions = parser.add_subparsers(dest='action', metavar='ACTION', required=True)
    judge = actions.add_parser(
        'lint', help='say what is wrong with a table, where and how badly',
        description='Look for jumps, corners, wrong and missing points, rounding, unequal ends '
                    'and columns that contradict the positions. Exit code 1 if there are any.')
    _add_table(judge)
    judge.add_argument('-o', '--plot', metavar='PICTURE', type=Path,
                       help='draw points and second differences into this file')
    add_json(judge)
    judge.set_defaults(run=run_lint)
    take = actions.add_parser(
        'import', help='make an axis of a table',
        description='Write the section of an axis for a machine file, its cam a spline through '
                    'the points of the table, or within a deviation of them.')
    _add_table(take)
    _add_repair(take)
    take.add_argument('-o', '--output', metavar='FILE', type=Path,
                      help='write the YAML here (default: standard output)')
    take.add_argument('--plot', metavar='PICTURE', type=Path,
                      help='draw points, curve and second differences into this file')
    add_json(take)
    take.set_defaults(run=run_import)
    give = actions.add_parser(
        'export', help='write the cam of an axis as a table',
        description='Write the cam of an axis as a table, with the largest deviation that the '
                    "target's points, interpolation and rounding cause, exact.")
    add_config(give)
    give.add_argument('axis', metavar='AXIS', help='name of the axis')
    give.add_argument('--cam', metavar='NAME', help='which of its cams (default: the first in '
                                                    'use)')
    give.add_argument('--segment', metavar='NAME', help='this segment alone, not the whole cycle')
    give.add_argument('--format', choices=written_formats(), required=True,
                      help='format of the file')
    _add_target(give, '')
    add_json(give)
    give.set_defaults(run=run_export)
    change = actions.add_parser(
        'convert', help='write a table in another format',
        description='Make a cam of a table, repaired if wanted, and write it as another table.')
    _add_table(change)
    _add_repair(change)
    change.add_argument('--to', choices=written_formats(), required=True,
                        help='format of the new file')
    _add_target(change, 'to-')
    add_json(change)
    change.set_defaults(run=run_convert)


def _add_table(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('file', metavar='FILE', help='the table')
    parser.add_argument('--format', choices=tuple(FORMATS), default='',
                        help='its format (default: found out)')
    parser.add_argument('--angle-unit', choices=('deg', 'rad', 'length'), default='',
                        help='unit of the master column (default: what the format says, or deg)')
    parser.add_argument('--cycle-length', type=_above_zero, metavar='X',
                        help='what the master column counts in one cycle')
    parser.add_argument('--slave-scale', type=_not_zero, metavar='X', default=1.0,
                        help='units of the axis per unit of the slave column (default: 1)')
    parser.add_argument('--per', choices=('master', 'rad'), default='master',
                        help='what velocities and accelerations are by: the unit of the master '
                             'column (default), or radians')
    parser.add_argument('--cycle', choices=CYCLES, default='',
                        help='whether it comes back (default: what its ends say)')
    parser.add_argument('--interpolation', choices=INTERPOLATIONS, default='',
                        help='how its controller interpolates (default: what the format says)')
    parser.add_argument('--delimiter', choices=tuple(DELIMITERS), default='',
                        help='what stands between columns (default: found out)')
    parser.add_argument('--drop', type=_line_numbers, metavar='LINE,...', default=[],
                        help='lines whose points are left out')
    parser.add_argument('--unit', default='m', help='unit of the axis (default: m)')
    parser.add_argument('--speed-cpm', type=_above_zero, metavar='X', default=DEFAULT_CPM,
                        help='speed at which the harm is told (default: 60) [cycles/min]')


def _add_repair(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--repair', type=_above_zero, metavar='TOL',
                        help='smooth it: the curve may be so far from the points [unit]')
    parser.add_argument('--degree', type=int, choices=(3, 5), default=5,
                        help='degree of the spline (default: 5)')
    parser.add_argument('--axis', metavar='NAME', default='axis',
                        help='name of the axis (default: axis)')


def _add_target(parser: argparse.ArgumentParser, prefix: str) -> None:
    count = parser.add_mutually_exclusive_group()
    count.add_argument('-n', '--points', type=int, metavar='N',
                       help='number of points, the closing one included (default: 361)')
    count.add_argument('--tolerance', type=_above_zero, metavar='T',
                       help='the fewest points with which the position is off by no more [unit]')
    parser.add_argument('--decimals', type=int, choices=range(16), metavar='N',
                        help='digits behind the point of the positions (default: a ten-millionth '
                             'of the stroke, at least 6)')
    parser.add_argument(f'--{prefix}cycle-length', type=_above_zero, metavar='X',
                        dest='target_length', help='what the master column is to count in one '
                                                   'cycle (default: 360)')
    parser.add_argument(f'--{prefix}slave-scale', type=_not_zero, metavar='X', default=1.0,
                        dest='target_scale', help='units of the axis per unit of the slave '
                                                  'column (default: 1)')
    parser.add_argument(f'--{prefix}interpolation', choices=INTERPOLATIONS, default='',
                        dest='target_interpolation',
                        help='how the target interpolates (default: what the format says)')
    parser.add_argument('-o', '--output', metavar='FILE', type=Path,
                        help='write it here (default: standard output)')


def _above_zero(text: str) -> float:
    value = finite_number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f'{text!r}: must be above 0')
    return value


def _not_zero(text: str) -> float:
    value = finite_number(text)
    if value == 0.0:
        raise argparse.ArgumentTypeError(f'{text!r}: must not be 0')
    return value


def _line_numbers(text: str) -> list[int]:
    try:
        return [int(part) for part in text.split(',')]
    except ValueError as error:
        raise argparse.ArgumentTypeError(f'{text!r}: write line numbers, 12,13') from error


def _read(arguments: argparse.Namespace) -> tuple[CamTable, str, list[Finding]]:
    table, what = read_table(arguments.file, TableOptions(
        arguments.angle_unit, arguments.cycle_length, arguments.slave_scale, arguments.per,
        arguments.cycle, arguments.interpolation, DELIMITERS.get(arguments.delimiter, '')),
        arguments.format)
    if arguments.drop:
        table = table.without(arguments.drop)
    return table, what, lint(table, arguments.speed_cpm * RPM, arguments.unit)


def _draw(arguments: argparse.Namespace, table: CamTable, findings: list[Finding],
          made: ImportedCam | None = None) -> list[Path]:
    if arguments.plot is None:
        return []
    from cam_motion.io.plots import table_figure
    return [save_figure(table_figure(table, findings, arguments.unit, made), arguments.plot)]


def run_lint(arguments: argparse.Namespace) -> int:
    """
    Say what is wrong with a table.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0 for a good table, 1 where something is wrong.

    """
    table, what, findings = _read(arguments)
    files = _draw(arguments, table, findings)
    if arguments.json:
        print_json({'format': table.format_name, 'points': len(table.angle),
                    'cycle': table.cycle, 'notes': list(table.notes),
                    'findings': [finding_as_data(each) for each in findings],
                    'files': [str(file) for file in files]})
    else:
        print_findings(table, what, findings, arguments.speed_cpm, arguments.unit)
        print_files(files)
    return 1 if any(each.severity != NOTE for each in findings) else 0


def _import(arguments: argparse.Namespace) -> tuple[ImportedCam, str, list[Finding]]:
    table, what, findings = _read(arguments)
    return import_table(table, arguments.axis, arguments.unit, arguments.repair,
                        arguments.degree), what, findings


def run_import(arguments: argparse.Namespace) -> int:
    """
    Make an axis of a table.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0.

    """
    made, what, findings = _import(arguments)
    table = made.table
    how = (f'repaired within {arguments.repair:g} {arguments.unit}' if arguments.repair else
           'through every point')
    text = section_yaml(arguments.axis, made.section, [
        f'Cam table {Path(arguments.file).name}, {len(table.angle)} points, {how}: '
        f'{made.points} points,', f'largest deviation {made.deviation:.3g} {arguments.unit}, '
        f'class C{made.after.continuity}.'])
    files = [] if arguments.output is None else [write_text(arguments.output, text)]
    files += _draw(arguments, table, findings, made)
    if arguments.json:
        print_json({**import_as_data(made, findings), 'files': [str(file) for file in files]})
        return 0
    print_import(made, what, findings, arguments.speed_cpm, arguments.unit,
                 to_stderr=arguments.output is None)
    if arguments.output is None:
        print(text, end='')
    print_files(files)
    return 0


def run_export(arguments: argparse.Namespace) -> int:
    """
    Write the cam of an axis as a table.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0.

    """
    axis = _axis(read_sections(arguments.config), arguments.config, arguments.axis)
    cam = _cam(axis, arguments.cam, arguments.segment)
    made = export_cam(cam, arguments.format, _target(arguments))
    _give(arguments, made, axis.unit, cam)
    return 0


def run_convert(arguments: argparse.Namespace) -> int:
    """
    Write a table in another format.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0.

    """
    taken, _, findings = _import(arguments)
    cam = _cam(taken.axis, None, None)
    made = export_cam(cam, arguments.to, _target(arguments))
    _give(arguments, made, arguments.unit, cam, import_as_data(taken, findings))
    return 0


def _target(arguments: argparse.Namespace) -> ExportOptions:
    return ExportOptions(
        arguments.points, arguments.tolerance, arguments.decimals, arguments.target_length,
        arguments.target_scale, arguments.target_interpolation)


def _axis(sections: Mapping[str, Any], config: str, name: str) -> CoupledAxis:
    if name not in sections:
        known = [each for each, values in sections.items()
                 if 'segments' in values or 'cams' in values]
        raise ConfigurationError([Problem('AXIS', name, f'must be an axis of {config}',
                                          'known are: ' + ', '.join(known))])
    try:
        return build_axis(name, sections[name])
    except ConfigurationError as error:
        raise ConfigurationError(problem.below(name) for problem in error.problems) from error


def _cam(axis: CoupledAxis, name: str | None, segment: str | None) -> CamToExport:
    """Give a cam with its scale and offset; phase and ratio are the coupling's business."""
    layout = axis.layout
    chosen = layout.active[0] if name is None else name
    if chosen not in layout.cams:
        raise ConfigurationError([Problem('--cam', chosen, f'must be a cam of {axis.name}',
                                          'known are: ' + ', '.join(layout.cams))])
    profile, coupling = layout.cams[chosen], layout.couplings[chosen]
    title = axis.name if name is None else f'{axis.name}_{chosen}'
    if segment is None:
        curve = profile.curve.scaled(0.0, TURN, coupling.scale, coupling.offset)
        left = {'ratio': (coupling.ratio, 1.0), 'phase_deg': (coupling.phase / DEGREE, 0.0)}
        note = ', '.join(f'{key} {value:g}' for key, (value, plain) in left.items()
                         if value != plain)
        return CamToExport(
            title, curve, profile.advance * coupling.scale,
            note=note and f'{note} of the axis are no part of the table: set them in the target')
    start = 0.0
    for each in profile.segments:
        if each.name == segment:
            curve = each.law.curve.scaled(0.0, TURN, each.gain * coupling.scale)
            return CamToExport(f'{title}_{segment}', curve, each.lift * coupling.scale, False,
                               (each.end_deg - start) * DEGREE)
        start = each.end_deg
    raise ConfigurationError([Problem(
        '--segment', segment, f'must be a segment of {axis.name}',
        'known are: ' + ', '.join(each.name for each in profile.segments))])


def _give(arguments: argparse.Namespace, made: ExportedTable, unit: str, cam: CamToExport,
          more: Mapping[str, Any] | None = None) -> None:
    files = [] if arguments.output is None else [write_text(arguments.output, made.text)]
    if arguments.json:
        taken = {} if more is None else {'import': more}
        print_json({**export_as_data(made, unit), **taken, 'files': [str(f) for f in files]})
        return
    print_export(made, unit, cam, to_stderr=arguments.output is None)
    if arguments.output is None:
        print(made.text, end='')
    print_files(files)
