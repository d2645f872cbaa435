# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
The command line: one module per verb, which declares its arguments and prints its results.

Only the module of the verb that is asked for is imported: all of them would cost a second.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib import import_module
import os
import sys

from cam_motion.errors import CamMotionError, ConfigurationError

BAD_CONFIGURATION = 2
"""Exit code when what the user gave cannot be used."""

_VERBS = {
    'laws': 'list the motion laws with their coefficients',
    'advise': 'which motion law a movement should have, and which filter',
    'check': 'check a machine file; peaks, and the highest speed',
    'plot': 'draw timing diagram, cams and drives',
    'optimise': 'find the best law for a movement',
    'simulate': 'simulate the drives of a machine',
    'size': 'choose motor, gear ratio and flywheel from a catalogue',
    'linkage': 'angles, velocities and points of a planar linkage',
    'contour': 'contour, pressure angle, curvature and contact force of disc cams',
    'animate': 'film a mechanism or the axes of a machine',
    'line': 'run the machine (needs ROS 2)',
    'format': 'change the format of a running machine (needs ROS 2)',
    'record': 'record a running machine (needs ROS 2)',
    'report': 'compare a recorded run with the exact curves',
    'table': 'judge, take over and write cam tables of other systems',
}


def build_parser(verb: str | None = None) -> argparse.ArgumentParser:
    """
    Build the parser of the command line.

    Parameters
    ----------
    verb : str | None
        The verb whose arguments it understands; the others are known by name only.

    Returns
    -------
    argparse.ArgumentParser
        It sets ``run``, the function that carries out the verb.

    """
    parser = argparse.ArgumentParser(
        prog='cam_motion',
        description='The electronic line shaft for ROS 2: timing diagrams in YAML become a '
                    'synchronised packaging machine.',
        epilog='Exit codes: 0 done, 1 something failed or was found wrong, 2 a bad '
               'configuration or command line.')
    verbs = parser.add_subparsers(dest='verb', metavar='VERB', required=True)
    for name, what in _VERBS.items():
        own = verbs.add_parser(name, help=what)
        if name == verb:
            import_module(f'cam_motion.cli.{name}').add_to(own)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """
    Carry out a command line.

    Parameters
    ----------
    argv : Sequence[str] | None
        The arguments; None takes those of the process.

    Returns
    -------
    int
        Exit code: 0 done, 1 something failed or was found wrong, 2 a bad configuration.

    """
    argv = sys.argv[1:] if argv is None else argv
    try:
        arguments = build_parser(next(iter(argv), None)).parse_args(argv)
        code: int = arguments.run(arguments)
        sys.stdout.flush()
        return code
    except ConfigurationError as error:
        from cam_motion.cli.terminal import print_problems
        print_problems(error.problems)
        return BAD_CONFIGURATION
    except CamMotionError as error:
        print(f'cam_motion: {error}', file=sys.stderr)
        return 1
    except BrokenPipeError:
        # the reader (head, less) has left: nobody is there to be told, and nothing is wrong
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        print('cam_motion: interrupted', file=sys.stderr)
        return 1
