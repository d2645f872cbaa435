# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The table formats by name, which one a file is in, and reading and writing any of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from cam_motion.errors import CamMotionError, ConfigurationError, Problem
from cam_motion.io.tables.table import CamTable, RawTable, TableOptions, to_cam
from cam_motion.motion.piece import Array

DERIVATIVE_DECIMALS = 3
"""Further digits of a derivative."""

_ENCODINGS = ('utf-8-sig', 'cp1252')  # the second takes any byte


@dataclass(frozen=True)
class Samples:
    """
    Points of a cam in the units of a file.

    Attributes
    ----------
    master, slave : ndarray, shape (n,)
        Both columns; the last point closes the cycle.
    velocity, acceleration : ndarray, shape (n,), or None
        Derivatives per unit of the master column.
    decimals : int
        Digits behind the point of the slave; its derivatives, which are small per degree, have
        `DERIVATIVE_DECIMALS` more for each order.
    name : str
        Name of the cam.
    cyclic : bool
        Whether it goes on after its end.

    """

    master: Array
    slave: Array
    velocity: Array | None
    acceleration: Array | None
    decimals: int
    name: str
    cyclic: bool


@dataclass(frozen=True)
class TableFormat:
    """
    A format of cam tables.

    Attributes
    ----------
    name, title : str
        Name for options, and for people.
    source : str
        Where the format is described.
    interpolation : str
        How its controller goes from point to point.
    detect : Callable[[str], str]
        Says by what a text shows that it is in this format; empty if it does not.
    read : Callable[[str, str, TableOptions], RawTable]
        Reads a text; takes the name of the file and the options.
    write : Callable[[Samples], str] | None
        Writes one; None for a format that is only read.
    columns : int
        How many columns a written file has.
    least, most : int
        Number of points that it may have.
    whole : bool
        Whether it holds integers only.
    angle_unit : str
        Unit of the master column when it is written, ``deg`` or ``share`` (0 to 1).
    steps : tuple[int, ...]
        Distances of master positions that it may have; empty: any.
    doubt : str
        What its description leaves open.

    """

    name: str
    title: str
    source: str
    interpolation: str
    detect: Callable[[str], str]
    read: Callable[[str, str, TableOptions], RawTable]
    write: Callable[[Samples], str] | None = None
    columns: int = 2
    least: int = 2
    most: int = 10_000
    whole: bool = False
    angle_unit: str = 'deg'
    steps: tuple[int, ...] = ()
    doubt: str = ''

    def written(self, samples: Samples) -> str:
        """
        Write points in this format.

        Parameters
        ----------
        samples : Samples
            The points.

        Returns
        -------
        str
            The text of the file.

        Raises
        ------
        CamMotionError
            When the format is only read.

        """
        if self.write is None:
            raise CamMotionError(f'{self.title} is only read')
        return self.write(samples)


FORMATS: dict[str, TableFormat] = {}
"""All formats by name, in the order in which they are looked for."""


def add_format(made: TableFormat) -> TableFormat:
    """
    Register a format.

    Parameters
    ----------
    made : TableFormat
        The format.

    Returns
    -------
    TableFormat
        The same.

    """
    FORMATS[made.name] = made
    return made


def detect_format(text: str) -> tuple[TableFormat, str]:
    """
    Find out in which format a text is.

    Parameters
    ----------
    text : str
        The text.

    Returns
    -------
    tuple[TableFormat, str]
        The format, and what shows it.

    """
    for each in FORMATS.values():
        if reason := each.detect(text):
            return each, f'known by {reason}'
    return FORMATS['csv'], 'without the mark of any other format'


def read_text(path: Path | str) -> str:
    """
    Read a text file in whatever encoding it is.

    Parameters
    ----------
    path : Path | str
        The file.

    Returns
    -------
    str
        Its text.

    Raises
    ------
    ConfigurationError
        When it cannot be read.

    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise ConfigurationError([Problem(
            str(path), None, f'cannot be read: {error.strerror or error}')]) from error
    if b'\0' in data[:4096]:
        if data[:2] in (b'\xff\xfe', b'\xfe\xff'):
            return data.decode('utf-16', errors='replace')
        raise ConfigurationError([Problem(
            str(path), 'bytes that are no text', 'a table is a text file',
            'export it as text, or CSV')])
    try:
        return data.decode(_ENCODINGS[0])
    except UnicodeDecodeError:
        return data.decode(_ENCODINGS[1], errors='replace')


def read_table(path: Path | str, options: TableOptions | None = None,
               name: str = '') -> tuple[CamTable, str]:
    """
    Read a cam table.

    Parameters
    ----------
    path : Path | str
        The file.
    options : TableOptions | None
        What the file does not say of itself.
    name : str
        Name of its format; empty: found out.

    Returns
    -------
    tuple[CamTable, str]
        The table, and in which format it was read and why.

    Raises
    ------
    ConfigurationError
        When it cannot be read, with the number of each wrong line.

    """
    options = options or TableOptions()
    text = read_text(path)
    if name:
        chosen, reason = FORMATS[name], 'as stated'
    else:
        chosen, reason = detect_format(text)
        reason += '; state --format for another'
    raw = chosen.read(text, str(path), options)
    return (to_cam(raw, options, str(path), chosen.name), f'{chosen.title} ({reason})')


def written_formats() -> tuple[str, ...]:
    """
    List the formats that can be written.

    Returns
    -------
    tuple[str, ...]
        Their names.

    """
    return tuple(name for name, each in FORMATS.items() if each.write)


def write_text(path: Path, text: str) -> Path:
    """
    Write a text file.

    Parameters
    ----------
    path : Path
        The file; its directory is made.
    text : str
        The text.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    CamMotionError
        When it cannot be written.

    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding='utf-8')
    except OSError as error:
        raise CamMotionError(f'{path}: cannot be written: {error.strerror or error}') from error
    return path
