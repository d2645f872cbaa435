# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Cam tables: every format is read as its manual has it, and what is wrong is refused."""

from cam_motion.errors import ConfigurationError
from cam_motion.io.tables import RawTable, read_table, TableOptions
from cam_motion.io.tables.lint import lint
from cam_motion.io.tables.repair import import_table
from cam_motion.io.tables.table import to_cam
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from cam_motion.units import DEGREE, RPM, TURN
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

DEGREES = np.linspace(0.0, 360.0, 361)
OMEGA = 200.0 * RPM
ROUNDING = 1e-9


def press(law='modified_sine', lift=20.0):
    """Give a press: down, hold, up, rest."""
    return CamProfile([segment('down', 90.0, lift, law), segment('hold', 150.0),
                       segment('up', 270.0, -lift, law), segment('rest', 360.0)])


def positions(profile=None, degrees=DEGREES):
    """Give positions at angles, the last point one cycle after the first."""
    profile = profile or press()
    y = profile.curve(np.array(degrees) * DEGREE)
    y[-1] = y[0] + profile.advance
    return y


def table(*columns, lines=None, options=None, **raw):
    """Make a table of columns, the first in degrees."""
    lines = lines or tuple(range(1, len(columns[0]) + 1))
    return to_cam(RawTable(np.column_stack(columns), lines, 'deg', **raw),
                  options or TableOptions(), 'table.csv', 'csv')


def saved(tmp_path, text, name='table.txt', **options):
    """Write a text and read it as a table."""
    file = tmp_path / name
    file.write_text(text)
    return read_table(file, TableOptions(**options))


@pytest.mark.parametrize('text', [
    '0,0\n90,1.5\n180,2.5\n360,0\n', '0;0\n90;1.5\n180;2.5\n360;0\n',
    '0;0,0\n90;1,5\n180;2,5\n360;0,0\n', '0\t0\n90\t1,5\n180\t2,5\n360\t0\n',
    '0,0 0,0\n90,0 1,5\n180,0 2,5\n360,0 0,0\n', '0 0\n90 1.5\n180 2.5\n360 0\n',
    'angle [deg],position\n0, 0\n90, 1.5\n180, 2.5\n360, 0\n', '0|0|\n90|1.5|\n180|2.5\n360|0\n',
    '# a comment\n\nx;y\n0;0 # first\n90;1.5\n180;2.5\n360;0\n\n',
    '0,0\r\n90,1.5\r\n180,2.5\r\n360,0', '\ufeff0,0\n9e1,15E-1\n1.8D2,2.5\n+360,-0\n',
    '"0";"0"\n"90";"1,5"\n"180";"2,5"\n"360";"0"\n'])
def test_columns_are_read_however_they_are_divided(tmp_path, text):
    read, what = saved(tmp_path, text)
    assert read.angle == pytest.approx([0.0, TURN / 4, TURN / 2, TURN])
    assert read.position == pytest.approx([0.0, 1.5, 2.5, 0.0])
    assert read.cycle == 'return' and 'columns of numbers' in what


def test_units_are_told_by_options(tmp_path):
    text = ''.join(f'{x} {y}\n' for x, y in ((0.0, 0.0), (100.0, 5.0), (400.0, 20.0)))
    read, _ = saved(tmp_path, text, angle_unit='length', cycle_length=400.0, slave_scale=1e-3)
    assert read.angle == pytest.approx([0.0, TURN / 4, TURN])
    assert read.position == pytest.approx([0.0, 0.005, 0.020]) and read.cycle == 'accumulate'
    read, _ = saved(tmp_path, 'phi [rad]; y; v\n0;0;1\n3,14159265359;2;0\n6,28318530718;0;1\n')
    assert read.covers_cycle and read.velocity == pytest.approx([1.0, 0.0, 1.0])
    read, _ = saved(tmp_path, '0 0 1 2\n180 2 0 0\n360 0 1 2\n')
    assert read.velocity[0] == pytest.approx(1.0 / DEGREE)
    assert read.acceleration[0] == pytest.approx(2.0 / DEGREE**2)
    read, _ = saved(tmp_path, '0 0 1 2\n180 2 0 0\n360 0 1 2\n', per='rad')
    assert (read.velocity[0], read.acceleration[0]) == pytest.approx((1.0, 2.0))


def test_a_file_may_leave_out_the_last_point_and_start_anywhere(tmp_path):
    y = positions()
    text = ''.join(f'{x + 30:g} {value!r}\n' for x, value in zip(DEGREES[:-1], y.tolist()))
    read, _ = saved(tmp_path, text)
    assert read.covers_cycle and read.position[-1] == read.position[0]
    assert read.lines[-1] == 0 and read.start == pytest.approx(30.0 * DEGREE)
    made = import_table(read, 'press', 'mm')
    assert made.section['phase_deg'] == pytest.approx(-30.0)
    assert made.axis.layout.motion.sample(75.0 * DEGREE)[0] == pytest.approx(y[45], abs=1e-9)


@pytest.mark.parametrize(('text', 'places', 'words'), [
    ('0,0\n90,x\n180,2\n360\n', ['line 2', 'line 4'], ['numbers only', '2 to 4 columns']),
    ('0,0\n90,nan\n180,inf\n360,0\n', ['line 2', 'line 3'], ['finite', 'finite']),
    ('0,0,1\n90,1\n360,0,1\n', ['line 2'], ['as many columns as the first: 3']),
    ('1,2,3,4,5\n2,3,4,5,6\n', ['line 1', 'line 2'], ['this has 5', 'this has 5']),
    ('', ['table.txt'], ['at least two points']), ('0,1\n', ['table.txt'], ['two points']),
    ('words\nand more\n', ['table.txt'], ['two points']),
    ('0,0\n1_0,1\n٢٠,2\n360,0\n', ['line 2', 'line 3'], ['numbers only', 'numbers only']),
    ('TABLE_BEGIN;;\n0;0;SPLINE\n1;1;LINE\nTABLE_END;;\n', ['line 3'], ['X;Y;SPLINE']),
    ('TABLE_BEGIN;;\n0;0;SPLINE\n1;1;SPLINE\n', ['line 1'], ['without TABLE_END']),
    ('(dX := 0, dY := 0)\n(dX := 1, dY := a)\n', ['line 2'], ['finite numbers']),
    ('(dX := 0, dY := 0)\n', ['table.txt'], ['no two points']),
    ('Tabletype = 3\nFunctiontype = 1\nBegintable\n0 0\n1 1\nEndTable\n',
     ['Tabletype', 'Functiontype'], ['type 7', '4 (a line first)']),
])
def test_files_that_cannot_be_read_are_refused_line_by_line(tmp_path, text, places, words):
    with pytest.raises(ConfigurationError) as caught:
        saved(tmp_path, text)
    problems = caught.value.problems
    assert len(problems) == len(places)
    for problem, place, word in zip(problems, places, words):
        assert problem.path.endswith(place) and word in problem.rule


def test_rows_that_were_taken_for_a_heading_are_shown(tmp_path):
    with pytest.raises(ConfigurationError) as caught:
        saved(tmp_path, 'x;y\n0 deg;0 mm\n180 deg;1 mm\n360 deg;0 mm\n')
    problem, = caught.value.problems
    assert problem.value == 'rows of numbers: 0' and '360 deg; 0 mm' in problem.hint


def test_a_file_that_is_no_text_or_not_there_is_refused(tmp_path):
    (tmp_path / 'x.xlsx').write_bytes(b'PK\x03\x04\0\0\0')
    for name, words in (('x.xlsx', 'text file'), ('none', 'cannot be read')):
        with pytest.raises(ConfigurationError) as caught:
            read_table(tmp_path / name)
        assert words in str(caught.value)


def test_many_wrong_lines_are_counted(tmp_path):
    with pytest.raises(ConfigurationError) as caught:
        saved(tmp_path, '0,0\n' + '1,x\n' * 40 + '2,2\n')
    assert len(caught.value.problems) == 11 and caught.value.problems[-1].value == 30


TOKENS = ['0', '1', '2.5', '3,5', '-1', '360', '90', '1e308', 'nan', ';', ',', '\t', ' ', '//',
          '#', '\n', '\n', 'TABLE_BEGIN;;\n', 'TABLE_END;;\n', ';SPLINE', '(dX := 0, dY := 1)',
          'dV:=2', 'Begintable\n', 'EndTable\n', 'Tabletype = 7\n', 'Functiontype = 4\n', 'x']


@settings(max_examples=40, deadline=None)
@given(st.lists(st.sampled_from(TOKENS), max_size=30).map(''.join))
def test_any_text_is_a_table_or_refused(tmp_path_factory, text):
    file = tmp_path_factory.getbasetemp() / 'any.txt'
    file.write_text(text)
    try:
        read, _ = read_table(file)
        lint(read, OMEGA)
        import_table(read, 'x')
    except ConfigurationError as error:
        assert error.problems


@settings(max_examples=20, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 36), st.sampled_from([0.0, 1.0, -1.0, 0.3, 1e15, 1e-300]),
                          st.sampled_from([0.0, 1.0, 1e300])), min_size=2, max_size=14),
       st.sampled_from(['', 'return', 'accumulate']), st.booleans())
def test_any_points_are_a_cam_or_refused(rows, cycle, velocities):
    rows = sorted(rows)
    rows[0], rows[-1] = (0, *rows[0][1:]), (36, *rows[-1][1:])
    columns = np.array(rows, dtype=float).T[:3 if velocities else 2]
    try:
        made = table(columns[0] * 10.0, *columns[1:], options=TableOptions(cycle=cycle))
        lint(made, OMEGA)
        cam = import_table(made, 'x')
    except ConfigurationError as error:
        assert error.problems
    else:
        assert cam.axis.profile.jumps(1) == []


# Formats of controllers, as their manuals print them.

PRINTED = {
    'kollmorgen': ('CYCLIC;YES;\nTABLE_BEGIN;;\n0;0;SPLINE\n100;111;SPLINE\n200;222;SPLINE\n'
                   '300;333;SPLINE\nTABLE_END;;\n', [0, 111, 222, 333]),
    'lenze': ('10.0 20.0 // point 1\n20,0 30,0 // point 2\n\n33.3 44.4 // point 3\n',
              [20.0, 30.0, 44.4]),
    'sew': ('3\n0;0\n0,125;2,5\n1;0\n', [0.0, 2.5, 0.0]),
    'technosoft': ('0\t0\n16\t500\n32 -7\n', [0, 500, -7]),
    'inventor': ('0;0\n0.1;0.028\n0.2;0.104\n0.5;0.5\n1;1\n', [0, 0.028, 0.104, 0.5, 1]),
    'codesys': ('cam : ARRAY[0..1] OF SMC_CAMXYVA := [ (* two\n points *)\n (dX:=0, dY:=0, dV:=0, '
                'dA:=0),\n (dX := 360.0, dY := 10, dV := 0.0, dA := 0.0)];', [0, 10]),
}


@pytest.mark.parametrize('name', PRINTED)
def test_a_file_of_a_controller_is_known_by_its_marks(tmp_path, name):
    text, y = PRINTED[name]
    read, what = saved(tmp_path, text)
    assert read.format_name == name and 'known by' in what
    assert read.position == pytest.approx(y)


def test_a_third_column_of_lenze_is_no_part_of_the_cam(tmp_path):
    read, _ = saved(tmp_path, '10.0 20.0 1.0 // a\n20.0 30.0 2.5 // b\n30.0 25.0 1.0 // c\n')
    assert read.velocity is None and 'torque' in read.notes[0]


ZEBRA = """Tablename = EndlessNegative  # Table name
Table-ID  = 422  # Table-ID
Tabletype = 7  # Table type
Function type = {}  # Interpolation type
Lines = 6 # Number of lines
Begintable  # Beginning of table
15000     0                        # MasterPos[0] SlavePos[0]
450000    3400000                  # MasterPos[1] SlavePos[1]
900000    2400000
1350000   2000000
2700000   1300000
3400000   300000
EndTable  # End of table
"""


@pytest.mark.parametrize(('function', 'first'), [(5, 0), (4, 1)])
def test_lines_and_polynomials_in_turns_become_points_with_velocities(tmp_path, function, first):
    read, _ = saved(tmp_path, ZEBRA.format(function))
    # endlessly negative: once round in each cycle
    assert read.advance == pytest.approx(-360.0) and read.covers_cycle
    curve = read.curve()
    assert curve.jumps(1) == curve.jumps(2) == []
    for n, piece in enumerate(curve.pieces):
        straight = np.abs(piece.derivative.derivative(np.linspace(0.0, piece.length, 9))).max()
        assert (straight < ROUNDING) == (n % 2 == first)


@pytest.mark.parametrize(('text', 'name', 'words'), [
    ('4\n0;0\n1;1\n2;2\n', 'sew', '3 follow'), ('x\n0;0\n1;1\n', 'sew', 'number of points'),
    ('0 0\n3 1\n6 2\n', 'technosoft', '1, 2, 4 up to 128'),
    ('0 0\n4 1\n8 2\n16 3\n', 'technosoft', '1, 2, 4 up to 128'),
    ('0 0\n4 1.5\n8 2\n', 'technosoft', '32-bit integers'),
    ('0 0\n4 3000000000\n8 2\n', 'technosoft', '32-bit integers'),
    ('0.1;0\n1;1\n', 'inventor', 'first position must be 0'),
    ('0;0\n1;-1\n', 'inventor', 'must rise'),
    (ZEBRA.format(5).replace('Lines = 6', 'Lines = 7'), 'isg', '6 follow'),
    (ZEBRA.format(5).replace('2700000   1300000\n', ''), 'isg', 'must be even'),
    ('0;0\n', 'kollmorgen', 'no line TABLE_BEGIN'),
])
def test_what_breaks_the_rules_of_a_format_is_refused(tmp_path, text, name, words):
    file = tmp_path / 'table'
    file.write_text(text)
    with pytest.raises(ConfigurationError) as caught:
        read_table(file, name=name)
    assert words in str(caught.value)


@pytest.mark.parametrize('rows', [
    '0,0,000000\n100,0,176166\n200,1,5\n360,0,000000\n',
    '0,0,0,05\n90,5,1,20\n180,0,0,00\n',
])
def test_a_comma_for_columns_and_decimals_is_refused(tmp_path, rows):
    with pytest.raises(ConfigurationError) as caught:
        saved(tmp_path, rows)
    problem, = caught.value.problems
    assert 'a comma cannot stand between columns and before decimals' in problem.rule
    assert 'semicolons' in problem.hint and problem.path.endswith('line 1')


def test_columns_of_whole_numbers_may_stand_between_commas(tmp_path):
    made, _ = saved(tmp_path, '0,0,0\n90,100,5\n180,200,0\n360,0,0\n')
    assert made.velocity is not None and len(made.angle) == 4
