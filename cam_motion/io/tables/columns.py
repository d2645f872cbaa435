# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Formats that are little more than columns: CSV, Lenze, SEW, Technosoft, Inventor."""

from __future__ import annotations

from dataclasses import replace
import re

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.tables.formats import add_format, DERIVATIVE_DECIMALS, Samples, TableFormat
from cam_motion.io.tables.table import (
    CUBIC,
    LINEAR,
    MOST_PROBLEMS,
    QUINTIC,
    RawTable,
    TableOptions,
)
from cam_motion.io.tables.text import COMMENT, number_in, read_rows, written
import numpy as np

MASTER_DECIMALS = 10
"""Digits of the master position: an angle must not be rounded like a position."""

_TECHNOSOFT_STEPS = tuple(2**k for k in range(8))
_RADIANS = re.compile(r'\brad', re.IGNORECASE)
_DEGREES = re.compile(r'deg|°', re.IGNORECASE)


def _lines(text: str) -> list[str]:
    return [line.strip() for line in text.splitlines() if line.strip()]


def _read_csv(text: str, source: str, options: TableOptions) -> RawTable:
    columns, lines, heading = read_rows(text, source, options.delimiter)
    head = heading[0] if heading else ''
    unit = 'rad' if _RADIANS.search(head) else 'deg'
    told = bool(options.angle_unit or options.cycle_length or _RADIANS.search(head)
                or _DEGREES.search(head))
    notes = () if told else (
        'the master column was taken as degrees: state --angle-unit if it is not',)
    return RawTable(columns, lines, unit, None,
                    QUINTIC if columns.shape[1] == 4 else CUBIC, notes)


def _write_csv(samples: Samples) -> str:
    columns = [('slave', samples.slave, samples.decimals)]
    for name, values in (('velocity', samples.velocity), ('acceleration', samples.acceleration)):
        if values is not None:
            columns.append((name, values, columns[-1][2] + DERIVATIVE_DECIMALS))
    rows = [','.join(['master', *(name for name, _, _ in columns)])]
    for n, master in enumerate(samples.master):
        rows.append(','.join([written(master, MASTER_DECIMALS), *(
            written(values[n], decimals) for _, values, decimals in columns)]))
    return f'# cam {samples.name}\n' + '\n'.join(rows) + '\n'


def _detect_lenze(text: str) -> str:
    rows = [line for line in _lines(text) if re.match(r'^[-+.\d]', line)]
    return '// comments after its points' if rows and any('//' in row for row in rows) and all(
        re.match(r'^\S+[ \t]+\S+', row) and ';' not in row for row in rows) else ''


def _read_lenze(text: str, source: str, options: TableOptions) -> RawTable:
    columns, lines, _ = read_rows(text, source, options.delimiter or ' ', most=3, header=False)
    notes = (() if columns.shape[1] == 2 else (
        'its third column is a torque at the motor, which is no part of the cam',))
    return RawTable(columns[:, :2], lines, '', None, LINEAR, notes)


def _write_lenze(samples: Samples) -> str:
    return ''.join(
        f'{written(x, MASTER_DECIMALS)} {written(y, samples.decimals)} // point {n}\n'
        for n, (x, y) in enumerate(zip(samples.master, samples.slave), start=1))


def _detect_sew(text: str) -> str:
    rows = _lines(text)
    return 'the number of its points in the first line' if (
        len(rows) > 2 and re.fullmatch(r'\d+', rows[0]) and int(rows[0]) == len(rows) - 1
        and all(re.match(r'^[^;\t]+[;\t][^;\t]+$', row) for row in rows[1:])) else ''


def _read_sew(text: str, source: str, options: TableOptions) -> RawTable:
    numbered = [(n, line) for n, line in enumerate(text.splitlines(), start=1) if line.strip()]
    count = number_in(numbered[0][1]) if numbered else None
    if count is None or count != int(count):
        raise ConfigurationError([Problem(
            f'{source}, line 1', numbered[0][1] if numbered else '',
            'the first line is the number of points')])
    rest = '\n'.join(text.splitlines()[numbered[0][0]:])
    columns, lines, _ = read_rows(rest, source, options.delimiter, first=numbered[0][0] + 1,
                                  most=2, header=False)
    if len(columns) != count:
        raise ConfigurationError([Problem(
            f'{source}, line {numbered[0][0]}', int(count),
            f'the first line must be the number of points: {len(columns)} follow')])
    return RawTable(columns, lines, '', None, CUBIC)


def _write_sew(samples: Samples) -> str:
    rows = [f'{written(x, MASTER_DECIMALS)};{written(y, samples.decimals)}'
            for x, y in zip(samples.master, samples.slave)]
    return f'{len(rows)}\n' + '\n'.join(rows) + '\n'


def _detect_technosoft(text: str) -> str:
    rows = [COMMENT.sub('', line) for line in _lines(text)]
    if len(rows) < 3 or not all(re.fullmatch(r'\s*\d+[ \t]+-?\d+\s*', row) for row in rows):
        return ''
    steps = set(np.diff([int(row.split()[0]) for row in rows]).tolist())
    return 'two columns of integers at equal steps of a power of two' if (
        len(steps) == 1 and steps <= set(_TECHNOSOFT_STEPS)) else ''


def _read_technosoft(text: str, source: str, options: TableOptions) -> RawTable:
    columns, lines, _ = read_rows(text, source, ' ', most=2, header=False)
    problems = [
        Problem(f'{source}, line {line}', row.tolist(), 'both columns are 32-bit integers, the '
                'first not below 0')
        for line, row in zip(lines, columns)
        if (row != np.round(row)).any() or abs(row).max() >= 2.0**31 or row[0] < 0.0]
    steps = np.diff(columns[:, 0])
    if steps[0] not in _TECHNOSOFT_STEPS or (steps != steps[0]).any():
        place = int(np.argmax(steps != steps[0])) + 1 if steps[0] in _TECHNOSOFT_STEPS else 1
        problems.append(Problem(
            f'{source}, line {lines[place]}', float(steps[place - 1]),
            'the points lie at equal steps of 1, 2, 4 up to 128'))
    if problems:
        raise ConfigurationError(problems[:MOST_PROBLEMS])
    return RawTable(columns, lines, '', None, LINEAR)


def _write_technosoft(samples: Samples) -> str:
    return ''.join(f'{round(x)}\t{round(y)}\n'
                   for x, y in zip(samples.master, samples.slave))


def _detect_inventor(text: str) -> str:
    rows = [re.split(r'[;|\t]', line) for line in _lines(text)]
    if len(rows) < 3 or any(len(row) != 2 for row in rows):
        return ''
    numbers = [tuple(number_in(cell) for cell in row) for row in rows]
    return 'two columns that rise from 0 to 1' if (
        numbers[0] == (0.0, 0.0) and numbers[-1] == (1.0, 1.0)) else ''


def _read_inventor(text: str, source: str, options: TableOptions) -> RawTable:
    columns, lines, _ = read_rows(text, source, options.delimiter, most=2, header=False)
    problems = [Problem(f'{source}, line {lines[0]}', value, f'the first {what} must be 0')
                for what, value in zip(('position', 'lift'), columns[0].tolist()) if value]
    if problems or not (columns[-1] > 0.0).all():
        raise ConfigurationError(problems or [Problem(
            f'{source}, line {lines[-1]}', columns[-1].tolist(), 'both columns must rise')])
    return RawTable(columns / columns[-1], lines, '', 1.0, LINEAR, (
        'a motion of Inventor is one rise from 0 to 1: --slave-scale is its lift',))


def _write_inventor(samples: Samples) -> str:
    return ''.join(f'{written(x, MASTER_DECIMALS)};{written(y, samples.decimals)}\n'
                   for x, y in zip(samples.master, samples.slave))


SEW = add_format(TableFormat(
    'sew', 'SEW curve point table',
    'SEW-EURODRIVE, MOVIKIT/MOVIRUN online help, Curve point table(s): the number of points, '
    'then master and slave separated by a semicolon or tab; 1024 points for linear or cubic',
    CUBIC, _detect_sew, _read_sew, _write_sew, most=1024,
    doubt='linear, cubic or spline is chosen in its program: state --interpolation'))

LENZE = add_format(TableFormat(
    'lenze', 'Lenze motion profile',
    'Lenze, Global Drive Cam Loader 1.1 EN (05/2005), 4.2.1 Data format of motion profile data',
    LINEAR, _detect_lenze, _read_lenze, _write_lenze,
    doubt='its description does not say how the controller interpolates'))

TECHNOSOFT = add_format(TableFormat(
    'technosoft', 'Technosoft cam table', 'Technosoft, EasyMotion Studio help, CAM Tables Edit',
    LINEAR, _detect_technosoft, _read_technosoft, _write_technosoft, most=8192, whole=True,
    steps=_TECHNOSOFT_STEPS, doubt='its description does not say how the drive interpolates'))

INVENTOR = add_format(TableFormat(
    'inventor', 'Inventor user motion',
    'Autodesk, Inventor 2022 help, Add Motion dialog box: position and lift from 0 to 1', LINEAR,
    _detect_inventor, _read_inventor, _write_inventor, angle_unit='share',
    doubt='its description does not say how the generator interpolates'))

CSV = add_format(TableFormat(
    'csv', 'columns of numbers', 'RFC 4180 and what programs make of it', CUBIC,
    lambda text: '', _read_csv, _write_csv))

CSV3, CSV4 = (
    add_format(replace(CSV, name=f'csv{columns}', title=f'columns of numbers, {columns} of them',
                       columns=columns, interpolation=interpolation))
    for columns, interpolation in ((3, CUBIC), (4, QUINTIC)))
