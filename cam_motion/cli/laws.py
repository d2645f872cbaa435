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
from cam_motion.motion.laws import (
    Boundary,
    Coefficients,
    LAWS,
    LawType,
    make_law,
    Member,
    MotionLaw,
)

_LETTERS = {Boundary.REST: 'R', Boundary.CONSTANT_VELOCITY: 'V', Boundary.TURN: 'T',
            Boundary.MOTION: 'M'}
_WIDE = 150  # columns needed for coefficients and prose side by side, a law mostly on one line
_ROUNDING = 1e-9  # an acceleration of this share of the other sign's is none
_CAPTION = (
    'Real peaks for a lift h in a time T: velocity Cv h/T, acceleration Ca h/T²,\n'
    "jerk Cj h/T³. Power is max|s' s''|. Ca of both signs where they differ. Ends:\n"
    'R rest, V constant velocity, T turn, M motion, * any; a V end meets its own\n'
    'velocity. Cj is infinite where the acceleration steps, within or at a T end\n'
    'beside a dwell; in brackets the largest between the steps. Laws with\n'
    'parameters at their defaults; indented: members with a name of their own.')


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
    digits = 5 if wide else 4  # of two accelerations in one column
    prose = [('ends', 'left'), ('source', 'right'), ('what it is', 'full')]
    sources = list(dict.fromkeys(law.source for law in LAWS.values()))
    made = table(
        'Motion laws, normalised: lift 1 over span 1', [
            ('law', 'left'), ('Cv', 'right'), ('Ca', 'right'), ('Cj', 'right'),
            ('power', 'right'), ('RMS\nacc.', 'right'), *(prose if wide else []),
        ], _CAPTION)
    about = table('', [('law', 'left'), *prose])
    for law in LAWS.values():
        words = _ends(law), f'[{sources.index(law.source) + 1}]', _what(law)
        figures = ['by its', 'parameters', '', '', ''] if law.generic else (
            _figures(make_law(law.name), digits))
        row(made, law.name, *figures, *(words if wide else []))
        for member in law.members:
            row(made, f'  {member.name}', *_figures(
                make_law(law.name, **member.parameters), digits),
                *(['', '', _told(member)] if wide else []))
        row(about, law.name, *words)
        for member in law.members:
            row(about, f'  {member.name}', '', '', _told(member))
    out.print(made)
    if not wide:
        out.print(about)
    listed = table('', [('', 'right'), ('source', 'full')])
    for number_, source in enumerate(sources, start=1):
        row(listed, f'[{number_}]', source)
    out.print(listed)
    print_files(files)
    return 0


def _draw(path: Path) -> Path:
    from cam_motion.io.plots import laws_figure
    # what only its conditions or parameters give a shape has none to show
    shown = [make_law(law.name) for law in LAWS.values()
             if law.name != 'dwell' and not law.generic]
    return save_figure(laws_figure(shown), path)


def _figures(law: MotionLaw, digits: int) -> list[str]:
    found = law.coefficients
    cj = f'∞ [{number(found.cj_inside)}]' if math.isinf(found.cj) else number(found.cj)
    return [number(found.cv), _acceleration(found, digits), cj, number(found.power),
            number(found.rms_acceleration)]


def _acceleration(found: Coefficients, digits: int) -> str:
    """Write the peak, with the sign where there is one only, both where they differ."""
    least, greatest = found.ca_least, found.ca_greatest
    if math.isinf(found.ca) or number(greatest) == number(-least):
        return number(found.ca)
    told = [value for value in (greatest, least) if abs(value) > _ROUNDING * found.ca_inside]
    return '/'.join(('+' if value > 0.0 else '') + number(value, digits if told[1:] else 5)
                    for value in told)


def _ends(law: LawType) -> str:
    return '*' if law.any_ends else '-'.join(_LETTERS[end] for end in make_law(law.name).ends)


def _what(law: LawType) -> str:
    names = ', '.join(parameter.name for parameter in law.parameters)
    return f'{law.summary}; takes {names}' if names else law.summary


def _told(member: Member) -> str:
    return ', '.join(f'{key}: {_plain_text(value)}' for key, value in member.parameters.items())


def _plain_text(value: Any) -> str:
    if isinstance(value, tuple):
        return f'[{", ".join(map(_plain_text, value))}]'
    return number(value, 7)


def _as_data(law: LawType) -> dict[str, Any]:
    made = make_law(law.name)
    return {
        'name': law.name,
        **_coefficients_as_data(made),
        'ends': [end.value for end in made.ends],
        'summary': law.summary,
        'source': law.source,
        'parameters': [
            {'name': each.name, 'default': plain(each.default), 'rule': each.rule,
             'count': each.count} for each in law.parameters
        ],
        'by_parameters': law.generic,
        'members': [
            {'name': member.name, 'parameters': plain(member.parameters),
             **_coefficients_as_data(make_law(law.name, **member.parameters))}
            for member in law.members],
    }


def _coefficients_as_data(law: MotionLaw) -> dict[str, float | None]:
    return {key: finite(value) for key, value in asdict(law.coefficients).items()}
