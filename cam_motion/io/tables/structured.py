# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Formats with a structure of their own: Kollmorgen KAS, CODESYS, and ISG/TwinCAT CNC."""

from __future__ import annotations

import re

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.tables.columns import MASTER_DECIMALS
from cam_motion.io.tables.formats import add_format, DERIVATIVE_DECIMALS, Samples, TableFormat
from cam_motion.io.tables.table import CUBIC, MOST_PROBLEMS, QUINTIC, RawTable, TableOptions
from cam_motion.io.tables.text import number_in, read_rows, written
import numpy as np

_BEGIN, _END = re.compile(r'^\s*TABLE_BEGIN', re.I), re.compile(r'^\s*TABLE_END', re.I)
_NODE = re.compile(r'\(([^()]*\bdX\s*:=[^()]*)\)', re.I)
_FIELD = re.compile(r'\bd([XYVA])\s*:=\s*([^,\s]+)', re.I)
_ST_COMMENT = re.compile(r'\(\*.*?\*\)|//[^\n]*', re.S)
_KEYWORD = re.compile(r'^\s*([\w -]+?)\s*=\s*(.*?)\s*$')
_ISG_PER_DEGREE = 1e4
_ZEBRA = {4: 'line first', 5: 'polynomial first'}
_ISG_TWO_COLUMNS = 7.0


def _missing(source: str, what: str, hint: str = '') -> ConfigurationError:
    return ConfigurationError([Problem(source, None, what, hint)])


def _between(text: str, begin: re.Pattern[str], end: re.Pattern[str], source: str,
             names: tuple[str, str]) -> tuple[list[str], int]:
    """Give the lines of a table, and the number of the first of them."""
    lines = text.splitlines()
    first = next((n for n, line in enumerate(lines) if begin.match(line)), None)
    if first is None:
        raise _missing(source, f'has no line {names[0]}')
    last = next((n for n, line in enumerate(lines) if n > first and end.match(line)), None)
    if last is None:
        raise _missing(f'{source}, line {first + 1}', f'{names[0]} without {names[1]}',
                       'the file may have been cut off')
    return lines[first + 1:last], first + 2


def _read_kollmorgen(text: str, source: str, options: TableOptions) -> RawTable:
    rows, first = _between(text, _BEGIN, _END, source, ('TABLE_BEGIN', 'TABLE_END'))
    problems, numbers = [], []
    for place, row in enumerate(rows, start=first):
        cells = row.split(';')
        kind = cells[2].strip().upper() if len(cells) > 2 else ''
        if row.strip() and kind != 'SPLINE':
            problems.append(Problem(f'{source}, line {place}', row.strip(),
                                    'a row is X;Y;SPLINE: nothing else can be imported'))
        numbers.append(';'.join(cells[:2]))
    if problems:
        raise ConfigurationError(problems[:MOST_PROBLEMS])
    columns, lines, _ = read_rows('\n'.join(numbers), source, ';', first, most=2, header=False)
    cyclic = re.search(r'^\s*CYCLIC\s*;\s*(\w+)', text, re.I | re.M)
    notes = () if cyclic and cyclic[1].upper() == 'YES' else (
        'the file says that the cam is not cyclic',)
    return RawTable(columns, lines, '', None, CUBIC, notes)


def _write_kollmorgen(samples: Samples) -> str:
    rows = [f'{written(x, MASTER_DECIMALS)};{written(y, samples.decimals)};SPLINE'
            for x, y in zip(samples.master, samples.slave)]
    return '\n'.join([f'CYCLIC;{"YES" if samples.cyclic else "NO"};', 'TABLE_BEGIN;;', *rows,
                      'TABLE_END;;']) + '\n'


def _read_codesys(text: str, source: str, options: TableOptions) -> RawTable:
    bare = _ST_COMMENT.sub(lambda found: re.sub(r'[^\n]', ' ', found[0]), text)
    rows, lines, problems = [], [], []
    for node in _NODE.finditer(bare):
        line = bare.count('\n', 0, node.start(1)) + 1
        given = {key.upper(): number_in(value) for key, value in _FIELD.findall(node[1])}
        values = [given.get(key, 0.0) for key in 'XYVA']
        if any(value is None or not np.isfinite(value) for value in values):
            problems.append(Problem(f'{source}, line {line}', node[0],
                                    'dX, dY, dV and dA must be finite numbers'))
            continue
        rows.append(values)
        lines.append(line)
    if problems:
        raise ConfigurationError(problems[:MOST_PROBLEMS])
    if len(rows) < 2:
        raise _missing(source, 'has no two points (dX := ..., dY := ..., dV := ..., dA := ...)')
    return RawTable(np.array(rows, dtype=float), tuple(lines), 'deg', None, QUINTIC)


def _write_codesys(samples: Samples) -> str:
    name = re.sub(r'\W', '_', samples.name)
    zeros = np.zeros_like(samples.slave)
    v, a = (zeros if each is None else each
            for each in (samples.velocity, samples.acceleration))
    nodes = [
        '    (' + ', '.join(f'd{key} := {written(value, digits)}' for key, value, digits in (
            ('X', samples.master[n], MASTER_DECIMALS), ('Y', samples.slave[n], samples.decimals),
            ('V', v[n], samples.decimals + DERIVATIVE_DECIMALS),
            ('A', a[n], samples.decimals + 2 * DERIVATIVE_DECIMALS))) + ')'
        for n in range(len(samples.master))]
    return (f'VAR_GLOBAL CONSTANT\n  {name}_nElements : INT := {len(nodes)};\n'
            f'  {name}_xStart : LREAL := {written(samples.master[0], MASTER_DECIMALS)};\n'
            f'  {name}_xEnd : LREAL := {written(samples.master[-1], MASTER_DECIMALS)};\n'
            f'END_VAR\nVAR_GLOBAL\n  {name} : ARRAY[0..{len(nodes) - 1}] OF SMC_CAMXYVA := [\n'
            + ',\n'.join(nodes) + '\n  ];\nEND_VAR\n')


def _read_isg(text: str, source: str, options: TableOptions) -> RawTable:
    rows, first = _between(text, re.compile(r'^\s*begintable', re.I),
                           re.compile(r'^\s*endtable', re.I), source, ('Begintable', 'EndTable'))
    head: dict[str, str] = {}
    for line in text.splitlines()[:first - 1]:
        if found := _KEYWORD.match(line.partition('#')[0]):
            head[found[1].lower().replace(' ', '').replace('-', '')] = found[2]
    kind, function = (number_in(head.get(key, '')) for key in ('tabletype', 'functiontype'))
    problems = []
    if kind != _ISG_TWO_COLUMNS:
        problems.append(Problem(
            f'{source}, Tabletype', head.get('tabletype'), 'only type 7, two columns of integers '
            'in 0.0001 deg or mm, is read', 'write master and slave of each point'))
    if function not in _ZEBRA:
        problems.append(Problem(
            f'{source}, Functiontype', head.get('functiontype'), 'must be 4 (a line first) or 5 '
            '(a polynomial first)'))
    if problems:
        raise ConfigurationError(problems)
    columns, lines, _ = read_rows('\n'.join(rows), source, options.delimiter or ' ', first,
                                  most=2, header=False)
    declared = number_in(head.get('lines', ''))
    if declared is not None and declared != len(columns):
        problems.append(Problem(f'{source}, Lines', head['lines'],
                                f'must be the number of points: {len(columns)} follow'))
    if len(columns) % 2:
        problems.append(Problem(f'{source}, line {lines[-1]}', len(columns),
                                'lines and polynomials alternate: their number must be even'))
    if problems:
        raise ConfigurationError(problems)
    master, slave = columns.T / _ISG_PER_DEGREE
    # both axes turn: the slave goes the shorter way round from point to point
    slave = np.unwrap(slave, period=360.0)
    master = np.append(master, master[0] + 360.0)
    slave = np.append(slave, np.unwrap([slave[-1], slave[0]], period=360.0)[1])
    slopes = np.diff(slave) / np.diff(master)
    # the segment from the last point to the first is called the first one
    line_first = function == 4.0
    straight = slopes[1::2] if line_first else slopes[::2]
    at = (np.roll(np.repeat(straight, 2), 1) if line_first else np.repeat(straight, 2))
    velocity = np.append(at, at[0])
    return RawTable(
        np.column_stack([master, slave, velocity, np.zeros_like(velocity)]), (*lines, 0), 'deg',
        None, QUINTIC, ('straight lines and polynomials of degree 5 in turns, as points with '
                        'velocity and without acceleration',))


KOLLMORGEN = add_format(TableFormat(
    'kollmorgen', 'Kollmorgen KAS cam profile', 'Kollmorgen Automation Suite, KAS IDE help, '
    'Import Cam Profile: CSV with at least 4 spline segments', CUBIC,
    lambda text: 'TABLE_BEGIN' if re.search(r'^\s*TABLE_BEGIN', text, re.I | re.M) else '',
    _read_kollmorgen, _write_kollmorgen, least=5,
    doubt='its spline is taken to be cubic with a continuous acceleration; positions are scaled '
          'to its Master and Slave scale on import'))

CODESYS = add_format(TableFormat(
    'codesys', 'CODESYS cam of SMC_CAMXYVA points in structured text',
    'CODESYS SoftMotion, SMC_CAMXYVA (Lenze PLC Designer SoftMotion manual 5.2 EN, 5.7.2): dV is '
    'dY/dX, dA is d²Y/dX²; initialised as IEC 61131-3 has it', QUINTIC,
    lambda text: 'SMC_CAMXYVA points' if _NODE.search(_ST_COMMENT.sub('', text)) else '',
    _read_codesys, _write_codesys, columns=4))

ISG = add_format(TableFormat(
    'isg', 'ISG or TwinCAT CNC cam table', 'ISG kernel documentation, cam tables, File format of '
    'the cam tables (ASCII interpreter) and Table format (zebra)', QUINTIC,
    lambda text: 'Begintable' if re.search(r'^\s*begintable', text, re.I | re.M) else '',
    _read_isg))
