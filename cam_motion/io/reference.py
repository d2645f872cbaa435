# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
The tables of README and doc/parameters.md, from the data that the program itself uses.

``python -m cam_motion.io.reference README.md doc/parameters.md`` brings files up to date: each
block between ``<!-- generated: NAME -->`` and ``<!-- end -->`` is written anew.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
import re
import sys

from cam_motion.io.axis_parameters import CAM, CAM_AXIS, SEGMENT
from cam_motion.io.cam_disc_parameters import CAM_DISC, SWING_PARTS
from cam_motion.io.cam_drive_parameters import CAM_DRIVE, PARTS
from cam_motion.io.format_parameters import INTERLOCK, STAGED
from cam_motion.io.interface import INTERFACE
from cam_motion.io.linkage_parameters import LINKAGE
from cam_motion.io.linkage_parameters import PARTS as LINKAGE_PARTS
from cam_motion.io.parameters import (
    BAG_RECORDER,
    DRIVE_SIM,
    LINE,
    MASTER_SHAFT,
    ParameterSpec,
    REQUIRED,
)
from cam_motion.io.servo_parameters import FOLLOW_DRIVE, SERVO_DRIVE
from cam_motion.io.track_parameters import AXIS_TRACK

_BLOCK = re.compile(r'(<!-- generated: (\w+) -->\n).*?(<!-- end -->)', re.DOTALL)


TABLES: dict[str, tuple[ParameterSpec, ...]] = {
    'master_shaft': MASTER_SHAFT, 'cam_axis': CAM_AXIS, 'cam': CAM, 'segment': SEGMENT,
    'drive_sim': DRIVE_SIM, 'linkage_state': LINKAGE, 'bag_recorder': BAG_RECORDER, 'line': LINE,
}
"""All tables by executable; ``segment`` is what stands below each segment of an axis."""


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
    parts = {f'below a part of the load, type `{kind}`': [
        spec for spec in table if spec.name != 'type'] for kind, table in PARTS.items()}
    swinging = {f'below a part of the load of a swinging follower, type `{kind}`': [
        spec for spec in table if spec.name != 'type'] for kind, table in SWING_PARTS.items()}
    titled = {
        **{_title(name): table for name, table in TABLES.items()},
        'below each track of a shaft or an axis': AXIS_TRACK,
        'below each interlock of a `line`': INTERLOCK,
        '`cam_axis` while it runs, for a change of format': STAGED,
        '`drive_sim`': FOLLOW_DRIVE,
        '`drive_sim` with `mode: servo`': SERVO_DRIVE,
        '`drive_sim` with `mode: line_shaft`': CAM_DRIVE, **parts,
        'a section with `type: cam_disc`': CAM_DISC, **swinging,
        **{f'below each name in `{kind}` of a linkage': table
           for kind, table in LINKAGE_PARTS.items()}}
    return '\n'.join(
        f'**{title}**\n\n' + _table(
            ('parameter', 'default', 'unit', 'what it does'), map(_row, table))
        for title, table in titled.items())


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
