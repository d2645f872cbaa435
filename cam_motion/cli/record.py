# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``record``: record a line that runs elsewhere."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from time import monotonic

from cam_motion.cli.child import recorder, require_ros, START_WITHIN, stop_signals
from cam_motion.cli.options import add_config, add_json, check_new_bag, seconds
from cam_motion.cli.terminal import print_json
from cam_motion.io.config import load_machine

_LOOK_AGAIN = 0.05


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = (
        'Record every topic of a running machine into a rosbag2 bag. Ctrl-C ends it.')
    add_config(parser)
    parser.add_argument('-o', '--output', metavar='DIR', type=Path, required=True,
                        help='directory of the bag, which must not exist')
    parser.add_argument('--seconds', type=seconds, metavar='S',
                        help='stop after so much has been recorded (default: on Ctrl-C)')
    parser.add_argument('--storage', choices=('mcap', 'sqlite3'), default='mcap',
                        help='storage of the bag (default: mcap)')
    add_json(parser, 'a final summary')
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Record until asked to stop.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        Exit code of the recorder.

    Raises
    ------
    ConfigurationError
        When the machine file cannot be used, or the bag exists.
    CamMotionError
        When rclpy is missing.

    """
    load_machine(arguments.config)
    check_new_bag('--output', arguments.output)
    require_ros()
    with stop_signals() as asked:
        child = recorder(arguments.config, arguments.output, arguments.storage)
        length = math.inf if arguments.seconds is None else arguments.seconds
        began, begins = math.inf, monotonic() + START_WITHIN
        while not child.ended and not asked.wait(_LOOK_AGAIN):
            now = monotonic()
            if now > begins or (arguments.output / 'metadata.yaml').exists():
                began = min(began, now)
            if now >= began + length:
                break
        child.ask_to_stop()
        code = child.end()
    lasted = max(0.0, monotonic() - began)
    if arguments.json:
        print_json({
            'exit_code': code, 'seconds': round(lasted, 3), 'bag': str(arguments.output)})
    elif code == 0:
        print(f'recorded {lasted:.1f} s into {arguments.output}')
    return code
