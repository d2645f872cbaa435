# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Rows of numbers in a text file: delimiters, decimal commas, headers, comments."""

from __future__ import annotations

import math
import re

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.tables.table import MOST_PROBLEMS
from cam_motion.motion.piece import Array
import numpy as np

DELIMITERS = {'semicolon': ';', 'comma': ',', 'tab': '\t', 'space': ' ', 'bar': '|'}
"""What can stand between columns, by name."""

COMMENT = re.compile(r'(#|//|%|\(\*).*$')
"""A comment, up to the end of its line."""

_NUMBER = r'[-+]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eEdD][-+]?\d+)?'
_ONE_NUMBER = re.compile(rf'^{_NUMBER}$', re.ASCII)
_SPACED_COMMAS = re.compile(rf'^\s*{_NUMBER}(?:\s+{_NUMBER})+\s*$')
_NOT_FINITE = re.compile(r'^[-+]?(nan|inf|infinity|1\.?#\w*)$', re.IGNORECASE)


def number_in(text: str) -> float | None:
    """
    Read a number, with a decimal point or comma.

    Parameters
    ----------
    text : str
        What stands there.

    Returns
    -------
    float | None
        The number, NaN or infinite where that is written; None where it is none.

    """
    text = text.strip().strip('"\'')
    if _NOT_FINITE.match(text):
        return math.nan
    if not _ONE_NUMBER.match(text):
        return None
    return float(re.sub('[dD]', 'e', text.replace(',', '.')))


def delimiter_of(lines: list[str]) -> str:
    """
    Find out what stands between the columns.

    Parameters
    ----------
    lines : list[str]
        Lines without comments.

    Returns
    -------
    str
        The delimiter; a space stands for any white space.

    """
    rows = [line for line in lines if re.search(r'\d', line)][-20:]
    for mark in (';', '|', '\t'):
        if rows and sum(mark in row for row in rows) > len(rows) / 2:
            return mark
    if rows and all(_SPACED_COMMAS.match(row) and ', ' not in row for row in rows):
        return ' '
    return ',' if rows and sum(',' in row for row in rows) > len(rows) / 2 else ' '


def split(line: str, delimiter: str) -> list[str]:
    """
    Divide a line into its columns.

    Parameters
    ----------
    line : str
        A line without its comment.
    delimiter : str
        What stands between columns.

    Returns
    -------
    list[str]
        The columns; empty ones at the end are left out.

    """
    cells = line.split() if delimiter == ' ' else [cell.strip() for cell in line.split(delimiter)]
    while cells and not cells[-1]:
        cells.pop()
    return cells


def read_rows(text: str, source: str, delimiter: str = '', first: int = 1, least: int = 2,
              most: int = 4, header: bool = True) -> tuple[Array, tuple[int, ...], list[str]]:
    """
    Read the rows of numbers of a text.

    Parameters
    ----------
    text : str
        The text.
    source : str
        Name of the file, for what is wrong.
    delimiter : str
        What stands between columns; empty: found out.
    first : int
        Line of the file at which the text begins.
    least, most : int
        Columns that a row may have.
    header : bool
        Whether lines that are no numbers may stand before the first row.

    Returns
    -------
    tuple[ndarray, tuple[int, ...], list[str]]
        Numbers of shape (n, m), the line of each row, and the cells of the last header line.

    Raises
    ------
    ConfigurationError
        When a line is no row, with its number, or there are fewer than two rows.

    """
    lines = [COMMENT.sub('', line).rstrip() for line in text.splitlines()]
    mark = delimiter or delimiter_of(lines)
    rows: list[list[float]] = []
    numbers: list[int] = []
    heading: list[str] = []
    problems = []
    if mark == ',' and (shown := _decimal_comma(lines)) is not None:
        raise ConfigurationError([Problem(
            f'{source}, line {first + shown}', lines[shown].strip(),
            'a comma cannot stand between columns and before decimals as well: which it is '
            'where, nobody can tell',
            'write decimal points, or semicolons between the columns')])

    def wrong(place: int, line: str, rule: str, hint: str = '') -> None:
        problems.append(Problem(f'{source}, line {place}', line.strip(), rule, hint))

    for place, line in enumerate(lines, start=first):
        cells = split(line, mark)
        if not cells:
            continue
        values = [number_in(cell) for cell in cells]
        if None in values:
            if header and not rows and values.count(None) > len(values) / 2:
                heading = cells
                continue
            wrong(place, line, 'a row holds numbers only',
                  'comments begin with # or //; state --delimiter if the columns are cut wrongly')
            continue
        row = [value for value in values if value is not None]
        if not all(map(math.isfinite, row)):
            wrong(place, line, 'every number must be finite')
        elif not least <= len(row) <= most:
            wrong(place, line, f'a row has {least} to {most} columns: this has {len(row)}',
                  'state --delimiter if the columns are cut wrongly')
        elif rows and len(row) != len(rows[0]):
            wrong(place, line, f'every row has as many columns as the first: {len(rows[0])}')
        else:
            rows.append(row)
            numbers.append(place)
    if problems:
        rest = len(problems) - MOST_PROBLEMS
        more = [Problem(source, rest, 'more lines are wrong')] if rest > 0 else []
        raise ConfigurationError(problems[:MOST_PROBLEMS] + more)
    if len(rows) < 2:
        hint = f'{"; ".join(heading)!r} is no row: a row holds numbers only' if heading else ''
        raise ConfigurationError([Problem(
            source, f'rows of numbers: {len(rows)}', 'a table needs at least two points', hint)])
    return np.array(rows), tuple(numbers), heading


def _decimal_comma(lines: list[str]) -> int | None:
    """Find a line that shows decimals behind the delimiter, 100,0,176166: no number is 0176."""
    if any('.' in line for line in lines if re.match(r'\s*[-+]?\d', line)):
        return None
    return next((place for place, line in enumerate(lines) if line.count(',') > 1 and any(
        re.fullmatch(r'0\d+', cell) for cell in split(line, ',')[1:])), None)


def written(value: float, decimals: int) -> str:
    """
    Write a number with so many decimals at most.

    Parameters
    ----------
    value : float
        The number.
    decimals : int
        Digits behind the point.

    Returns
    -------
    str
        The number without zeros at its end.

    """
    text = f'{value:.{decimals}f}'
    text = text.rstrip('0').rstrip('.') if '.' in text else text
    return '0' if text == '-0' else text
