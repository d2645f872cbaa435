# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
The tables of README, written from the data that the program itself uses.

``python -m cam_motion.io.reference README.md`` brings a file up to date: each block between
``<!-- generated: NAME -->`` and ``<!-- end -->`` is written anew.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
import re
import sys

from cam_motion.io.interface import INTERFACE
from cam_motion.io.parameters import ParameterSpec, REQUIRED, TABLES

_BLOCK = re.compile(r'(<!-- generated: (\w+) -->\n).*?(<!-- end -->)', re.DOTALL)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ['---'] * len(head), *rows]
    return ''.join('| ' + ' | '.join(line) + ' |\n' for line in lines)


def interface_table() -> str:
    """
    Write the table of topics and services.

    Returns
    -------
    str
        Markdown.

    """
    return _table(
        ('executable', '', 'name', 'type', 'what it carries'),
        ((e.node, e.kind, f'`{e.name}`', f'`{e.type_name}`', e.meaning) for e in INTERFACE))


def parameter_tables() -> str:
    """
    Write a table of parameters for each executable.

    Returns
    -------
    str
        Markdown.

    """
    return '\n'.join(
        f'**{_title(name)}**\n\n' + _table(
            ('parameter', 'default', 'unit', 'what it does'), map(_row, table))
        for name, table in TABLES.items())


def _title(name: str) -> str:
    return 'below each segment of an axis' if name == 'segment' else f'`{name}`'


def _row(spec: ParameterSpec) -> Sequence[str]:
    default = 'required' if spec.default is REQUIRED else f'`{_plain(spec.default)}`'
    choices = f' One of {", ".join(f"`{c}`" for c in spec.choices)}.' if spec.choices else ''
    return (f'`{spec.name}`', 'none' if spec.default is None else default, spec.unit,
            spec.meaning + choices)


def _plain(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


BLOCKS: dict[str, Callable[[], str]] = {
    'interface': interface_table, 'parameters': parameter_tables,
}


def refreshed(text: str) -> str:
    """
    Write the generated blocks of a text anew.

    Parameters
    ----------
    text : str
        Markdown with marked blocks.

    Returns
    -------
    str
        The same text, its blocks up to date.

    """
    return _BLOCK.sub(lambda m: f'{m[1]}{BLOCKS[m[2]]()}{m[3]}', text)


def main() -> None:
    """Bring the files named on the command line up to date."""
    for name in sys.argv[1:]:
        path = Path(name)
        path.write_text(refreshed(path.read_text(encoding='utf-8')), encoding='utf-8')


if __name__ == '__main__':
    main()
