# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The command line: one module per verb, which parses its arguments and prints its results."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
import os
import sys

from cam_motion.cli import (
    advise,
    animate,
    change,
    check,
    contour,
    laws,
    line,
    linkage,
    optimise,
    plot,
    record,
    report,
    simulate,
    size,
    table,
)
from cam_motion.cli.terminal import print_problems
from cam_motion.errors import CamMotionError, ConfigurationError

BAD_CONFIGURATION = 2
"""Exit code when what the user gave cannot be used."""

_VERBS = (
    laws, advise, check, plot, optimise, simulate, size, linkage, contour, animate, line, change,
    record, report, table,
)


def build_parser() -> argparse.ArgumentParser:
    """
    Build the parser of the command line.

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
    for verb in _VERBS:
        verb.add_to(verbs)
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
    arguments = build_parser().parse_args(argv)
    try:
        code: int = arguments.run(arguments)
        sys.stdout.flush()
        return code
    except ConfigurationError as error:
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
