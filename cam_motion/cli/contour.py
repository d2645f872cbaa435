# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``contour``: figures of the disc cams of a machine, drawings and tables of points."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
import re
from typing import Any

from cam_motion.cli.options import add_config, add_json, finite_number
from cam_motion.cli.terminal import (
    console,
    number,
    print_files,
    print_json,
    progress,
    row,
    save_figure,
    table,
)
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.cam_disc_config import build_cam_discs, CamDiscSettings
from cam_motion.io.cam_disc_parameters import CAM_DISC
from cam_motion.io.config import read_sections
from cam_motion.io.contour import (
    bore_problems,
    contour_figures,
    ContourFigures,
    disc_problems,
)
from cam_motion.io.contour_csv import write_csv
from cam_motion.io.contour_data import figures_as_data, needed, smallest_text
from cam_motion.io.contour_dxf import write_dxf
from cam_motion.io.machine import build_machine
from cam_motion.motion.piecewise import Peak
from cam_motion.units import DEGREE, MM, RPM

_DRAWN = ('csv', 'dxf', 'png')  # what goes into a directory


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = (
        'Figures of the disc cams of a machine file (type: cam_disc, and the cam of '
        'a drive that turns the shaft), and their contours as CSV, DXF and pictures. '
        'Exit code 2 where a contour is undercut, breaks a limit or lets its '
        'follower lift off; its figures are printed all the same.')
    add_config(parser)
    parser.add_argument('name', metavar='NAME', nargs='?', help='one disc (default: all)')
    parser.add_argument('-o', '--output', metavar='PATH', type=Path,
                        help='directory for CSV, DXF and picture of each disc, or one file of one '
                             'disc: .csv, .dxf, .png, .svg, .pdf')
    parser.add_argument('--tolerance', type=_tolerance, metavar='X',
                        help='largest distance of the written contour from the exact one [m]')
    parser.add_argument('--at', type=finite_number, metavar='DEG', default=0.0,
                        help='shaft angle at which the follower is drawn (default: 0)')
    add_json(parser, 'the figures')
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Print the figures of discs and write what is wanted.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0.

    Raises
    ------
    ConfigurationError
        When the machine file cannot be used, or a disc breaks its limits; the latter after its
        figures have been printed.

    """
    discs = _load(arguments.config, arguments.name)
    kinds = _kinds(arguments.output, discs)
    wrong = {name: [each.below(name) for each in disc_problems(settings)]
             for name, settings in discs.items()}
    data: dict[str, Any] = {}
    files: list[Path] = []
    with progress() as bar:
        for name, settings in bar.track(discs.items(), description='contours'):
            figures = contour_figures(settings)
            sound = not settings.disc.undercuts and not bore_problems(settings)
            written = _write(settings, kinds, arguments) if sound else {}
            files += [Path(each['file']) for each in written.values()]
            if arguments.json:
                data[name] = figures_as_data(settings, figures) | (
                    {'files': written} if kinds else {})
            else:
                _print(settings, figures, written)
    if arguments.json:
        print_json(data)
    else:
        print_files(files)
    if problems := [each for found in wrong.values() for each in found]:
        raise ConfigurationError(problems)
    return 0


def _tolerance(text: str) -> float:
    """Read a tolerance by the rule of the machine file."""
    value = finite_number(text)
    spec = next(spec for spec in CAM_DISC if spec.name == 'tolerance')
    if (problem := spec.check(value)) is not None:
        raise argparse.ArgumentTypeError(f'{text!r}: {problem.rule}')
    return value


def _load(config: str, name: str | None) -> dict[str, CamDiscSettings]:
    sections = read_sections(config)
    discs, problems = build_cam_discs(sections)
    if problems:
        try:
            build_machine(sections)  # an axis may be what is really wrong
        except ConfigurationError as error:
            problems = [*error.problems, *problems]
        raise ConfigurationError(problems)
    if not discs:
        raise ConfigurationError([Problem(
            config, None, 'holds no cam disc', 'describe one in a section with type: cam_disc')])
    if name is None:
        return discs
    if name not in discs:
        raise ConfigurationError([Problem('NAME', name, 'must be a cam disc',
                                          'known are: ' + ', '.join(discs))])
    return {name: discs[name]}


def _kinds(output: Path | None, discs: Mapping[str, CamDiscSettings]) -> tuple[str, ...]:
    """Tell what is to be written."""
    if output is None:
        return ()
    kind = output.suffix.removeprefix('.').lower()
    if not kind:
        return _DRAWN
    from cam_motion.io.plots import FORMATS
    if kind not in ('csv', 'dxf', *FORMATS):
        raise ConfigurationError([Problem(
            '--output', str(output), 'must be a directory, or end in .csv, .dxf, .'
            + ', .'.join(FORMATS))])
    if len(discs) > 1:
        raise ConfigurationError([Problem(
            '--output', str(output), 'one file holds one disc', 'name one of ' + ', '.join(discs)
            + ', or give a directory')])
    return (kind,)


def _write(settings: CamDiscSettings, kinds: tuple[str, ...], arguments: argparse.Namespace,
           ) -> dict[str, dict[str, Any]]:
    """Write the files of a disc; tell of each what it holds."""
    written: dict[str, dict[str, Any]] = {}
    output, tolerance = arguments.output, arguments.tolerance
    at = arguments.at * DEGREE
    for kind in kinds:
        path = output if len(kinds) == 1 else output / (
            re.sub(r'\W', '_', settings.name) + f'.{kind}')
        if kind == 'csv':
            line = write_csv(settings, path, tolerance)
            held = {'points': line.angles.size - 1, 'deviation': line.deviation}
        elif kind == 'dxf':
            drawing = write_dxf(settings, path, tolerance, at)
            held = {'points': drawing.polyline.angles.size - 1,
                    'deviation': drawing.polyline.deviation,
                    'spline_nodes': drawing.spline.angles.size - 1,
                    'spline_deviation': drawing.spline.deviation}
        else:
            from cam_motion.io.plots import contour_figure
            save_figure(contour_figure(settings, at), path)
            held = {}
        written[kind] = {'file': str(path), **held}
    return written


def _print(settings: CamDiscSettings, figures: ContourFigures,
           written: Mapping[str, Mapping[str, Any]]) -> None:
    disc, out = settings.disc, console()
    follower = settings.kind.replace('_', ' ')
    turns = 'counterclockwise' if disc.sense > 0 else 'clockwise'
    shown = table(f'{settings.name}: {settings.axis}, {follower}, {turns}', [
        ('', 'left'), ('', 'right'), ('', 'left'), ('at', 'right')])

    def figure(name: str, value: float, unit: str, at: Peak | None = None) -> None:
        row(shown, name, number(value, 6), unit,
            '' if at is None else f'{number(at.at / DEGREE)} deg')

    def need(name: str, peak: Peak | None, unit: str, factor: float = 1.0) -> None:
        if peak is not None and needed(peak) is None:
            row(shown, name, 'none', '', '')
        elif peak is not None:
            figure(name, peak.value / factor, unit, peak)

    _geometry(settings, figures, figure)
    if figures.force is not None:
        shown.add_section()
        _forces(settings, figures, figure, need)
    out.print(shown)
    for name, text in _remarks(settings, figures):
        out.print(f'{name}: {text}')
    for kind, held in written.items():
        if 'points' in held:
            spline = '' if 'spline_nodes' not in held else (
                f"; spline of {held['spline_nodes']} nodes, "
                f"at most {number(held['spline_deviation'] / MM, 4)} mm off")
            out.print(f"{kind}: {held['points']} points, chords at most "
                      f"{number(held['deviation'] / MM, 4)} mm off the exact contour{spline}")
    out.print()


def _geometry(settings: CamDiscSettings, figures: ContourFigures,
              figure: Callable[..., None]) -> None:
    disc = settings.disc
    figure('base circle, radius', disc.base_radius / MM, 'mm')
    figure('farthest from the shaft', disc.farthest / MM, 'mm')
    if (pivot := disc.follower.pivot) is not None:
        figure('from the contour to the bearing', (abs(pivot) - disc.farthest) / MM, 'mm')
    back, out = figures.pressure_angles
    figure('greatest pressure angle', out.value / DEGREE, 'deg', out)
    figure('least pressure angle', back.value / DEGREE, 'deg', back)
    least, hollow = figures.least_radius, figures.hollow_radius
    figure('least radius of curvature', least.value / MM, 'mm', least)
    if hollow is not None:
        figure('tightest hollow of the contour', hollow.value / MM, 'mm', hollow)
    if not disc.follower.is_flat:
        path = least.value + disc.follower.roller_radius
        figure("the same of the roller's path", path / MM, 'mm', least)
    if figures.face is not None:
        low, high = figures.face
        figure('face touched from', low.value / MM, 'mm', low)
        figure('face touched to', high.value / MM, 'mm', high)
        figure('least width of the face', (high.value - low.value) / MM, 'mm')


def _forces(settings: CamDiscSettings, figures: ContourFigures,
            figure: Callable[..., None], need: Callable[..., None]) -> None:
    force, swings = figures.force, settings.disc.follower.swings
    if force is None:
        return
    speed = f'at {number(settings.speed / RPM)} rpm'
    figure(f'least contact force {speed}', force.least.value, 'N', force.least)
    figure(f'greatest contact force {speed}', force.greatest.value, 'N', force.greatest)
    if force.orbit_least is not None and force.orbit_greatest is not None:
        figure('least in the periodic motion', force.orbit_least.value, 'N', force.orbit_least)
        figure('greatest in the periodic motion', force.orbit_greatest.value, 'N',
               force.orbit_greatest)
    if force.lift_off is not None and not settings.groove:
        figure('lift-off speed', force.lift_off.value / RPM, 'rpm', force.lift_off)
    need(f'spring stiffness needed {speed}', force.stiffness, 'N m/rad' if swings else 'N/m')
    need(f'preload needed {speed}', force.preload, *(('deg', DEGREE) if swings else ('mm', MM)))


def _remarks(settings: CamDiscSettings, figures: ContourFigures) -> list[tuple[str, str]]:
    found = []
    offset, force = figures.offset, figures.force
    found.append(('smallest base circle', smallest_text(figures.smallest_base)))
    if offset is not None:
        found.append(('for the limits of the pressure angle',
                      f'base circle {number(offset.base_radius / MM, 8)} mm with the offset '
                      f'{number(offset.offset / MM, 8)} mm'))
    if settings.groove:
        found.append(('groove', 'the roller cannot lift off'))
    elif force is not None and force.lift_off is None:
        found.append(('lift-off', 'at no speed'))
    return found
