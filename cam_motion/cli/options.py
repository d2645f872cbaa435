# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Options that several verbs share."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from cam_motion.errors import ConfigurationError, Problem

_LARGEST = 1e30  # of a number that no machine needs, and whose powers still are numbers


def add_config(parser: argparse.ArgumentParser) -> None:
    """
    Add the machine file.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.add_argument('config', metavar='CONFIG',
                        help='machine file: a ROS 2 parameter file in YAML')


def add_json(parser: argparse.ArgumentParser, what: str = 'the result') -> None:
    """
    Add ``--json``.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.
    what : str
        What is printed as JSON.

    """
    parser.add_argument('--json', action='store_true', help=f'print {what} as JSON')


def add_speed(parser: argparse.ArgumentParser) -> None:
    """
    Add ``--speed-cpm``.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.add_argument('--speed-cpm', type=finite_number, metavar='X',
                        help='shaft speed instead of the configured one [cycles/min]')


def finite_number(text: str) -> float:
    """
    Read a finite number.

    Parameters
    ----------
    text : str
        What the user wrote.

    Returns
    -------
    float
        The number.

    Raises
    ------
    argparse.ArgumentTypeError
        When it is no finite number, or so large or small that its powers are none.

    """
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f'{text!r}: must be a finite number')
    if value and not 1.0 / _LARGEST <= abs(value) <= _LARGEST:
        raise argparse.ArgumentTypeError(
            f'{text!r}: must be 0, or from {1.0 / _LARGEST:g} to {_LARGEST:g} in magnitude')
    return value


def seconds(text: str) -> float:
    """
    Read a duration.

    Parameters
    ----------
    text : str
        What the user wrote.

    Returns
    -------
    float
        The duration [s].

    Raises
    ------
    argparse.ArgumentTypeError
        When it is no finite number above 0.

    """
    value = finite_number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f'{text!r}: must be above 0 s')
    return value


def check_new_bag(option: str, path: Path) -> None:
    """
    Make sure that a bag can be made where the user wants it.

    Parameters
    ----------
    option : str
        The option that named it.
    path : Path
        Directory of the bag.

    Raises
    ------
    ConfigurationError
        When something is there already.

    """
    if path.exists():
        raise ConfigurationError([Problem(
            option, str(path), 'must not exist: a bag is never overwritten',
            'choose another directory or remove this one')])
