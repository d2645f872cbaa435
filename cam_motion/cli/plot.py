# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``plot``: timing diagram, cams and drives of a machine as picture files."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from pathlib import Path
import re
from typing import TYPE_CHECKING

from cam_motion.cli.options import add_config, add_json, finite_number
from cam_motion.cli.terminal import print_files, print_json, progress, save_figure
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.config import read_sections
from cam_motion.io.machine import build_machine, Machine
from cam_motion.io.summary import turning_drive, with_speed
from cam_motion.io.turn import repeats
from cam_motion.motion.diagram import TimingDiagram
from cam_motion.units import RPM

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = (
        'Draw the timing diagram, position to jerk of each axis, and torque over '
        'speed of each drive.')
    add_config(parser)
    parser.add_argument('-o', '--output', metavar='DIR', default='.', type=Path,
                        help='directory for the files (default: the current one)')
    parser.add_argument('--axis', metavar='NAME', help='draw this axis and its drives only')
    parser.add_argument('--format', choices=('png', 'svg', 'pdf'), default='png',
                        help='file format (default: png)')
    parser.add_argument(
        '--speed-cpm', type=finite_number, metavar='X', action='append', default=[],
        help='shaft speed instead of the configured one [cycles/min]; given again, torque over '
             'speed is drawn for each')
    add_json(parser, 'the files written')
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Draw the pictures and print what was written.

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
        When the machine file cannot be used or has no axis of the given name.

    """
    sections = read_sections(arguments.config)
    if arguments.speed_cpm and not turning_drive(sections):
        sections = with_speed(sections, arguments.speed_cpm[0])
    machine = build_machine(sections)
    axes = machine.diagram.axes
    if arguments.axis is not None and arguments.axis not in axes:
        raise ConfigurationError([Problem(
            '--axis', arguments.axis, 'must be an axis of the line',
            'known are: ' + ', '.join(axes))])
    speeds = [cpm * RPM for cpm in arguments.speed_cpm] or [machine.master.speed]
    files = []
    with progress() as bar:
        for name, draw in bar.track(_pictures(machine, arguments.axis, speeds),
                                    description='drawing'):
            file = re.sub(r'\W', '_', name) + f'.{arguments.format}'
            files.append(save_figure(draw(), arguments.output / file))
    if arguments.json:
        print_json({'files': [str(path) for path in files]})
    else:
        print_files(files)
    return 0


def _pictures(machine: Machine, only: str | None,
              speeds: list[float]) -> list[tuple[str, Callable[[], Figure]]]:
    """List the pictures to draw: name of the file and how to draw it."""
    from cam_motion.io.plots import profile_figure, timing_diagram, torque_curve, torque_figure
    axes = {name: axis for name, axis in machine.diagram.axes.items() if only in (None, name)}
    pictures: list[tuple[str, Callable[[], Figure]]] = [
        ('timing_diagram', partial(timing_diagram, TimingDiagram(axes)))]
    for name, axis in axes.items():
        pictures.append((f'cam_{name}', partial(profile_figure, axis, speeds[0])))
    for name, settings in machine.drives.items():
        if settings.axis in axes and repeats(axes[settings.axis]):
            curves = [torque_curve(settings, axes[settings.axis], omega) for omega in speeds]
            pictures.append((f'torque_{name}', partial(
                torque_figure, name, curves, motor=settings.motor)))
    return pictures
