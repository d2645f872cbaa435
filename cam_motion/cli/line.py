# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``line``: run a machine, watch it, record it, stop it cleanly."""

from __future__ import annotations

import argparse
from pathlib import Path
import sys

from cam_motion.cli.child import require_ros, stop_signals
from cam_motion.cli.live import Display
from cam_motion.cli.options import add_config, add_json, add_speed, check_new_bag, seconds
from cam_motion.cli.session import Session
from cam_motion.cli.terminal import print_json
from cam_motion.cli.watch import LineWatch
from cam_motion.io.config import read_sections
from cam_motion.io.machine import build_machine
from cam_motion.io.summary import with_speed


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = (
        'Check the machine file, then run the whole machine, with a live display. '
        'Ctrl-C stops it cleanly.')
    add_config(parser)
    add_speed(parser)
    parser.add_argument('--seconds', type=seconds, metavar='S',
                        help='stop after this time (default: on Ctrl-C)')
    parser.add_argument('--record', metavar='DIR', type=Path,
                        help='record into this bag, which must not exist')
    parser.add_argument('--storage', choices=('mcap', 'sqlite3'), default='mcap',
                        help='storage of the bag (default: mcap)')
    add_json(parser, 'a final summary')
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Run a machine until it is asked to stop.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        Exit code of the line, or of the recorder if only that one failed.

    Raises
    ------
    ConfigurationError
        When the machine file cannot be used, or the bag exists.
    CamMotionError
        When rclpy is missing or the recorder does not begin.

    """
    sections = read_sections(arguments.config)
    if arguments.speed_cpm is not None:
        sections = with_speed(sections, arguments.speed_cpm)
    machine = build_machine(sections)
    if arguments.record is not None:
        check_new_bag('--record', arguments.record)
    require_ros()
    display = Display(machine, arguments.config, quiet=arguments.json)
    with stop_signals() as asked, LineWatch(machine) as watch, display:
        session = Session(arguments, machine, watch, display, asked)
        try:
            session.begin()
            session.go_on()
        finally:
            code = session.end()
    if arguments.json:
        print_json(session.summary(code))
        return code
    if arguments.record is not None:
        print(f'recorded into {arguments.record}')
    for name, text in session.overloads.items():
        print(f'warning: {name}: {text}', file=sys.stderr)
    return code
