# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``report``: a recorded run beside the exact curves."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from cam_motion.cli.options import add_json
from cam_motion.cli.terminal import print_files, print_json, progress, save_figure

if TYPE_CHECKING:
    from cam_motion.io.report import Report
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
        'Compare every recorded setpoint with the exact curve at the recorded shaft '
        'angle. Exit code 0 if each shaft tick has its setpoint, each setpoint is '
        "within 1e-9 of its axis' own peak, and no motor was at or beyond its peak torque, "
        'else 1.')
    parser.add_argument('bag', metavar='BAG', type=Path, help='bag directory, .mcap or .db3 file')
    parser.add_argument('--config', metavar='CONFIG', type=Path,
                        help='machine file (default: the one that the bag carries)')
    parser.add_argument('-o', '--output', metavar='DIR', type=Path,
                        help='draw pictures into this directory')
    add_json(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Print the report of a bag.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0 where the recording is as it must be, else 1.

    """
    # the bag library takes its time to load: not before it is needed
    from cam_motion.cli.report_tables import print_report
    from cam_motion.io.findings import findings
    from cam_motion.io.recording import read_recording
    from cam_motion.io.report import make_report
    from cam_motion.io.report_data import report_as_data
    files = []
    with progress() as bar:
        task = bar.add_task('reading the bag', total=None)
        recording = read_recording(arguments.bag, arguments.config)
        bar.update(task, description='comparing')
        report = make_report(recording)
        bar.remove_task(task)
        if arguments.output is not None:
            for name, draw in bar.track(_pictures(report), description='drawing'):
                files.append(save_figure(draw(), arguments.output / name))
    if arguments.json:
        print_json(report_as_data(report) | {'files': [str(path) for path in files]})
    else:
        print_report(report)
        print_files(files)
    return 1 if findings(report) else 0


def _pictures(report: Report) -> list[tuple[str, Callable[[], Figure]]]:
    from cam_motion.io.plots import recorded_figure, recorded_torque_figure, shaft_figure
    pictures: list[tuple[str, Callable[[], Figure]]] = [
        ('shaft_speed.png', partial(shaft_figure, report))]
    if report.axes:
        pictures.append(('recorded_versus_exact.png', partial(recorded_figure, report)))
    names = [name for name, drive in report.drives.items() if drive.states]
    for name in names:
        file = 'torque_over_speed.png' if len(names) == 1 else f'torque_over_speed_{name}.png'
        pictures.append((file, partial(recorded_torque_figure, report, name)))
    return pictures
