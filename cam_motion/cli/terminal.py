# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What all verbs print alike: tables, problems, progress, JSON."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
import math
import os
from pathlib import Path
import sys
from typing import Any, TYPE_CHECKING

from cam_motion.errors import CamMotionError, Problem
from cam_motion.io.plain import to_json
from cam_motion.units import RPM
from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Files and pipes have no width: wide enough for every table without folding.
_WIDTH_OF_A_FILE = 120


class _Output(Console):
    """A console that never cuts the figures of a table: a narrow terminal folds its lines."""

    def print(self, *objects: Any, **options: Any) -> None:  # noqa: A003 (as rich names it)
        before = self.width
        self.width = max(before, *map(_least_width, objects), 0)
        try:
            super().print(*objects, **options)
        finally:
            self.width = before

    def on_broken_pipe(self) -> None:
        raise  # noqa: PLE0704 (rich calls this in its handler, and would end with exit code 1)


def _least_width(thing: object) -> int:
    """Find the width that a table needs for its figures; prose is folded to a few words."""
    if not isinstance(thing, Table):
        return 0
    return 2 * len(thing.columns) + 1 + sum(
        max(max(map(cell_len, str(cell).split('\n' if column.no_wrap else None)), default=0)
            for cell in (column.header, *column.cells))
        for column in thing.columns)


def console(stderr: bool = False) -> Console:
    """
    Give a console for readable output.

    Parameters
    ----------
    stderr : bool
        Whether it writes to standard error.

    Returns
    -------
    Console
        As wide as the terminal, without markup, so that names may hold brackets.

    """
    stream = sys.stderr if stderr else sys.stdout
    width = None if stream.isatty() or 'COLUMNS' in os.environ else _WIDTH_OF_A_FILE
    return _Output(file=stream, width=width, markup=False, highlight=False, emoji=False)


def print_json(data: Any) -> None:
    """
    Print plain data as JSON.

    Parameters
    ----------
    data : Any
        Plain data.

    """
    sys.stdout.write(to_json(data) + '\n')


def table(title: str, columns: Sequence[tuple[str, str]], caption: str = '') -> Table:
    """
    Make an empty table in the common style.

    Parameters
    ----------
    title : str
        Its title.
    columns : Sequence[tuple[str, str]]
        Heading of each column and how it stands: ``left``, ``right``, or ``full`` for prose,
        the one kind that is folded.
    caption : str
        What stands below.

    Returns
    -------
    Table
        To be filled by `row`.

    """
    made = Table(
        title=Text(title, style='bold'), caption=Text(caption) if caption else None,
        title_justify='left', caption_justify='left', box=box.SIMPLE_HEAD, pad_edge=False,
        header_style='', padding=(0, 1, 0, 0))
    for heading, justify in columns:
        made.add_column(
            Text(heading), overflow='fold', no_wrap=justify != 'full',
            justify='left' if justify == 'full' else justify)  # type: ignore[arg-type]
    return made


def row(to: Table, *cells: str, style: str | None = None) -> None:
    """
    Add a row of plain text to a table.

    Parameters
    ----------
    to : Table
        The table.
    *cells : str
        The texts; brackets in them are no markup.
    style : str | None
        Style of the row.

    """
    to.add_row(*(Text(cell) for cell in cells), style=style)


def number(value: float, digits: int = 5) -> str:
    """
    Write a number for people.

    Parameters
    ----------
    value : float
        The number.
    digits : int
        Significant digits.

    Returns
    -------
    str
        The number; infinity as ∞, and a plain 0 whatever its sign.

    """
    if math.isinf(value):
        return '∞' if value > 0 else '-∞'
    if 10.0 ** digits <= abs(value) < 1e9:
        return f'{value:.0f}'  # a few digits too many are easier to read than an exponent
    text = f'{value:.{digits}g}' if value else '0'
    return text.replace('e-0', 'e-').replace('e+0', 'e+')


def speed(omega: float) -> str:
    """
    Write a highest shaft speed so that it can be set as written.

    Parameters
    ----------
    omega : float
        The speed [rad/s].

    Returns
    -------
    str
        Cycles per minute, rounded down to a hundredth.

    """
    cpm = omega / RPM
    return number(math.floor(cpm * 100.0) / 100.0 if math.isfinite(cpm) else cpm, 9)


def print_problems(problems: Iterable[Problem], source: str = '') -> None:
    """
    Print problems one by one on standard error.

    Parameters
    ----------
    problems : Iterable[Problem]
        The problems.
    source : str
        The file that they are in.

    """
    listed = tuple(problems)
    out = console(stderr=True)
    count = '1 problem' if len(listed) == 1 else f'{len(listed)} problems'
    lines = [Text(f'{count} in {source}:' if source else f'{count}:', style='bold')]
    for place, problem in enumerate(listed, start=1):
        value = 'missing' if problem.value is None else repr(problem.value)
        lines.append(Text(f'{place:3}. {problem.path}', style='bold'))
        lines += [Text(f'     {name:<8} {text}') for name, text in (
            ('value', _short(value)), ('rule', problem.rule), ('way out', problem.hint)) if text]
    for line in lines:
        # a file is searched by line: only a terminal gets its lines folded
        out.print(line, soft_wrap=not out.is_terminal)


def _short(text: str, longest: int = 200) -> str:
    return text if len(text) <= longest else text[:longest - 1] + '…'


def progress() -> Progress:
    """
    Give a progress bar on standard error, silent where that is no terminal.

    Returns
    -------
    Progress
        To be used as a context.

    """
    out = console(stderr=True)
    return Progress(
        TextColumn('{task.description}', markup=False), BarColumn(), TimeRemainingColumn(),
        console=out, transient=True, disable=not out.is_terminal)


def print_files(files: Iterable[Path]) -> None:
    """
    Print which files were written, one per line.

    Parameters
    ----------
    files : Iterable[Path]
        The files.

    """
    for path in files:
        sys.stdout.write(f'wrote {path} ({path.stat().st_size / 1024:.0f} KiB)\n')


def save_figure(figure: Figure, path: Path) -> Path:
    """
    Write a figure to a file.

    Parameters
    ----------
    figure : Figure
        The figure.
    path : Path
        The file; its suffix tells the format.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    CamMotionError
        When it cannot be written.

    """
    from cam_motion.io.plots import save
    try:
        return save(figure, path)
    except OSError as error:
        raise CamMotionError(f'{path}: cannot be written: {error.strerror or error}') from error
