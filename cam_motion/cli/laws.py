# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``laws``: the catalogue of motion laws with their coefficients."""

from __future__ import annotations

import argparse
from dataclasses import asdict
import math
from pathlib import Path
from typing import Any

from cam_motion.cli.options import add_json
from cam_motion.cli.terminal import (
    console,
    number,
    print_files,
    print_json,
    row,
    save_figure,
    table,
)
from cam_motion.io.plain import finite, plain
from cam_motion.motion.laws import Boundary, LAWS, LawType, make_law

_LETTERS = {Boundary.REST: 'R', Boundary.CONSTANT_VELOCITY: 'V', Boundary.TURN: 'T',
            Boundary.MOTION: 'M'}
_WIDE = 150  # columns needed for coefficients and prose side by side, a law mostly on one line


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = 'List the motion laws with their coefficients.'
    parser.add_argument('-o', '--output', metavar='DIR', type=Path,
                        help='draw them on one sheet, laws.png in this directory')
    parser.add_argument('--format', choices=('png', 'svg', 'pdf'), default='png',
                        help='format of the sheet (default: png)')
    add_json(parser, 'the list')
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Print the catalogue.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0.

    """
    files = [_draw(arguments.output / f'laws.{arguments.format}')] if arguments.output else []
    if arguments.json:
        print_json([_as_data(law) for law in LAWS.values()])
        return 0
    out = console()
    # a narrow terminal gets ends and what each law is as a list of its own
    wide = out.width >= _WIDE
    prose = [('ends', 'left'), ('what it is', 'full')]
    made = table(
        'Motion laws, normalised: lift 1 over span 1', [
            ('law', 'left'), ('Cv', 'right'), ('Ca', 'right'), ('Cj', 'right'),
            ('power', 'right'), ('RMS acc.', 'right'), *(prose if wide else []),
        ],
        'Real peaks for a lift h in a time T: velocity Cv h/T, acceleration\n'
        "Ca h/T², jerk Cj h/T³. Power is max|s' s''|. Where a law steps between\n"
        'two dwells, what follows is infinite; in brackets the largest between\n'
        'the steps. Ends: R rest, V constant velocity, T turn, M motion, and * for\n'
        'any. Laws with parameters are shown at their defaults.')
    for law in LAWS.values():
        found = make_law(law.name).coefficients
        ca = _finite(found.ca, found.ca_inside) if wide else number(found.ca)
        row(made, law.name, number(found.cv), ca, _finite(found.cj, found.cj_inside),
            number(found.power), number(found.rms_acceleration),
            *([_ends(law), _what(law)] if wide else []))
    out.print(made)
    if not wide:
        made = table('', [('law', 'left'), *prose])
        for law in LAWS.values():
            row(made, law.name, _ends(law), _what(law))
        out.print(made)
    print_files(files)
    return 0


def _draw(path: Path) -> Path:
    from cam_motion.io.plots import laws_figure
    # what only its conditions give a shape has none to show
    shown = [make_law(law.name) for law in LAWS.values()
             if law.name != 'dwell' and not law.any_ends]
    return save_figure(laws_figure(shown), path)


def _finite(value: float, inside: float) -> str:
    return f'∞ [{number(inside)}]' if math.isinf(value) else number(value)


def _ends(law: LawType) -> str:
    return '*' if law.any_ends else '-'.join(_LETTERS[end] for end in make_law(law.name).ends)


def _what(law: LawType) -> str:
    names = ', '.join(parameter.name for parameter in law.parameters)
    return f'{law.summary}; takes {names}' if names else law.summary


def _as_data(law: LawType) -> dict[str, Any]:
    made = make_law(law.name)
    return {
        'name': law.name,
        **{key: finite(value) for key, value in asdict(made.coefficients).items()},
        'ends': [end.value for end in made.ends],
        'summary': law.summary,
        'source': law.source,
        'parameters': [
            {'name': each.name, 'default': plain(each.default), 'rule': each.rule,
             'count': each.count} for each in law.parameters
        ],
    }
