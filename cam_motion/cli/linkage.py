# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``linkage``: angles, velocities and points of a planar linkage, and its range."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
import re

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
from cam_motion.io.config import read_sections
from cam_motion.io.linkage_config import build_linkage, linkage_names
from cam_motion.io.linkage_data import effort_texts, motion_as_data, range_text
from cam_motion.io.linkage_inputs import place_inputs
from cam_motion.io.linkage_settings import LinkageSettings
from cam_motion.mechanism.linkage_motion import LinkageMotion, move
from cam_motion.units import DEGREE

_ROUNDING = 1e-13


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = (
        'Solve a planar linkage of vector loops on the branch of its start: angles, '
        'velocities, accelerations, points, and how far each input goes. Exit code 2 '
        'for inputs out of range.')
    add_config(parser)
    parser.add_argument(
        '--at', type=_assignments, default={}, metavar='NAME=X,...',
        help='inputs in SI, for an input h: h (or h_deg), h_dot, h_ddot, and h_crank where a '
             'spool winds it (default: the start, at rest)')
    parser.add_argument('--name', metavar='NAME', help='section of the linkage, if there are more')
    parser.add_argument('--all', action='store_true',
                        help='as JSON: accelerations, transmission angles, ranges and the '
                             'certificate too')
    parser.add_argument('-o', '--output', metavar='DIR', type=Path,
                        help='draw the motions of the machine file into this directory')
    parser.add_argument('--urdf', metavar='FILE', type=Path,
                        help='write a URDF whose joints are the published joint states')
    add_json(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Solve the linkage and print the result.

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
        When the machine file cannot be used, or an input is unknown or out of range.

    """
    settings = _load(arguments.config, arguments.name)
    try:
        inputs, pose = place_inputs(settings, arguments.at)
    except ConfigurationError as error:
        raise ConfigurationError(problem.below('--at') for problem in error.problems) from error
    motion = move(settings.assembly, pose, inputs.rates, inputs.accelerations)
    files = [] if arguments.output is None else _draw(settings, arguments.output)
    if arguments.urdf is not None:
        files.append(_write_urdf(settings, arguments.urdf))
    if arguments.json:
        written = {'files': [str(file) for file in files]} if files else {}
        print_json({**motion_as_data(settings, motion, arguments.all), **written})
        return 0
    _print(settings, motion)
    print_files(files)
    return 0


def _assignments(text: str) -> dict[str, float]:
    """Read ``name=number,name=number``."""
    given: dict[str, float] = {}
    for part in filter(None, text.split(',')):
        name, equals, value = part.partition('=')
        name = name.strip()
        if not equals or not name:
            raise argparse.ArgumentTypeError(f'{part!r}: write NAME=NUMBER')
        if name in given:
            raise argparse.ArgumentTypeError(f'{name} stands twice')
        given[name] = finite_number(value)
    return given


def _load(config: str, name: str | None) -> LinkageSettings:
    sections = read_sections(config)
    known = linkage_names(sections)
    if name is None and len(known) != 1:
        raise ConfigurationError([Problem(
            config, known or None, 'holds one section with type: linkage' if not known else
            'holds more than one linkage', 'describe the linkage' if not known else
            'choose one with --name')])
    chosen = known[0] if name is None else name
    if chosen not in known:
        raise ConfigurationError([Problem('--name', name, 'must be a section with type: linkage',
                                          'known are: ' + ', '.join(known))])
    try:
        return build_linkage(chosen, sections[chosen])
    except ConfigurationError as error:
        raise ConfigurationError(problem.below(chosen) for problem in error.problems) from error


def _draw(settings: LinkageSettings, folder: Path) -> list[Path]:
    from cam_motion.io.plots import linkage_figure
    if not settings.cases:
        raise ConfigurationError([Problem(
            f'{settings.name}.motions', None, 'names the motions to draw', 'describe one')])
    files = []
    with progress() as bar:
        for name, case in bar.track(settings.cases.items(), description='drawing'):
            file = re.sub(r'\W', '_', f'linkage_{settings.name}_{name}') + '.png'
            files.append(save_figure(linkage_figure(settings, case), folder / file))
    return files


def _write_urdf(settings: LinkageSettings, file: Path) -> Path:
    from cam_motion.io.linkage_urdf import linkage_urdf
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(linkage_urdf(settings), encoding='utf-8')
    except OSError as error:
        raise ConfigurationError([Problem(
            '--urdf', str(file), f'cannot be written: {error.strerror}')]) from error
    return file


def _rounded(value: float) -> float:
    """Give 0 for what is rounding beside the figures of any linkage."""
    return value if abs(value) > _ROUNDING else 0.0


def _print(settings: LinkageSettings, motion: LinkageMotion) -> None:
    linkage, pose, out = settings.linkage, motion.pose, console()
    variables = table(f'{settings.name} at {pose.text}', [
        ('', 'left'), ('', 'left'), ('position', 'right'), ('', 'left'), ('velocity', 'right'),
        ('', 'left'), ('acceleration', 'right'), ('', 'left')])
    for name in linkage.variables:
        turns = name in linkage.angles
        value = motion.position[name]
        shown = math.remainder(value, math.tau) / DEGREE if turns else value
        unit = linkage.unit(name)
        row(variables, name, 'input' if name in linkage.inputs else '', number(shown, 8),
            'deg' if turns else 'm', number(_rounded(motion.velocity[name]), 6),
            f'{unit}/s', number(_rounded(motion.acceleration[name]), 6), f'{unit}/s²')
    out.print(variables)
    if motion.points:
        points = table('points', [('', 'left'), *((heading, 'right') for heading in (
            'x\nm', 'y\nm', 'vx\nm/s', 'vy\nm/s', 'ax\nm/s²', 'ay\nm/s²'))])
        for name, point in motion.points.items():
            row(points, name, *(number(_rounded(value), 6) for each in (
                point.position, point.velocity, point.acceleration)
                for value in (each.real, each.imag)))
        out.print(points)
    for name, angle in motion.transmission.items():
        out.print(f'transmission angle {name}: {number(angle / DEGREE)} deg')
    for text in effort_texts(settings, pose):
        out.print(text)
    for name in linkage.inputs:
        out.print(range_text(settings, name, pose))
    proof = pose.certificate
    out.print(f'on the branch of the start: {proof.steps} certified steps, Kantorovich number '
              f'at most {number(proof.kantorovich, 3)} of 0.5')
