# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The linter of cam tables: good ones are clean, and each fault is found where it is."""

import math

from cam_motion.io.tables import RawTable, TableOptions
from cam_motion.io.tables.lint import lint
from cam_motion.io.tables.outliers import resolution_of
from cam_motion.io.tables.table import to_cam
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from cam_motion.units import DEGREE, RPM
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

DEGREES = np.linspace(0.0, 360.0, 361)
OMEGA = 200.0 * RPM


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


def belt():
    """Give a belt that is fed once per cycle."""
    return CamProfile([segment('feed', 120.0, 300.0, 'modified_sine'), segment('wait', 360.0)],
                      accumulate=True)


def table(*columns, lines=None, options=None, **raw):
    """Make a table of columns, the first in degrees."""
    lines = lines or tuple(range(1, len(columns[0]) + 1))
    return to_cam(RawTable(np.column_stack(columns), lines, 'deg', **raw),
                  options or TableOptions(), 'table.csv', 'csv')


def found(*columns, **more):
    """Give what is wrong with a table."""
    return lint(table(*columns, **more), OMEGA, 'mm')


@pytest.mark.parametrize('law', ['modified_sine', 'modified_trapezoid', 'polynomial_345',
                                 'cycloidal', 'constant_acceleration', 'simple_harmonic'])
@pytest.mark.parametrize('count', [73, 361])
def test_a_good_table_is_clean(law, count):
    degrees = np.linspace(0.0, 360.0, count)
    assert found(degrees, positions(press(law), degrees)) == []


def test_a_good_belt_and_a_good_table_of_four_columns_are_clean():
    assert found(DEGREES, positions(belt())) == []
    v, a = (press().curve(DEGREES * DEGREE, order) * DEGREE**order for order in (1, 2))
    assert found(DEGREES, positions(), v, a, interpolation='quintic') == []


def faulty(change, *columns):
    """Give columns with a change."""
    made = [np.array(column) for column in (columns or (DEGREES, positions()))]
    change(*made)
    return made


def jump(x, y):
    """Let the position jump after 99 degrees and come back after 199."""
    y[100:200] += 1.0


def outlier(x, y):
    """Move one point."""
    y[60] += 0.5


FAULTS = {'jump': (jump, [100, 200], 1.0), 'outlier': (outlier, [61], 0.5)}


@pytest.mark.parametrize('name', FAULTS)
def test_a_place_that_is_not_smooth_is_found_where_it_is(name):
    change, lines, size = FAULTS[name]
    listed = found(*faulty(change))
    assert [each.code for each in listed] == [name] * len(lines)
    assert [each.line for each in listed] == lines
    for each in listed:
        assert abs(each.value) == pytest.approx(size, rel=0.05)
        assert each.angle_deg == pytest.approx(each.line - 1)
    step = DEGREE
    assert f'{listed[0].value * (OMEGA / step) ** 2:.5g} mm/s²' in listed[0].harm


def test_a_corner_is_told_with_the_step_of_its_velocity():
    y = positions() + 0.1 * np.maximum(0.0, 10.0 - np.abs(DEGREES - 315.0))
    listed = found(DEGREES, y)
    assert [each.code for each in listed] == ['velocity_step'] * 3
    assert [each.line for each in listed] == [306, 316, 326]
    assert [each.value for each in listed] == pytest.approx(
        [0.1 / DEGREE, -0.2 / DEGREE, 0.1 / DEGREE], rel=1e-6)


@pytest.mark.parametrize('every', [5, 10, 20])
def test_lines_between_fewer_points_are_a_staircase(every):
    y = np.interp(DEGREES, DEGREES[::every], positions()[::every])
    each, = found(DEGREES, y)
    assert each.code == 'staircase' and 'linear interpolation of fewer points' in each.text
    assert (each.line - 1) % every == 0


def test_linear_interpolation_of_the_controller_is_a_note():
    each, = found(DEGREES, positions(), interpolation='linear')
    assert (each.code, each.severity) == ('linear_interpolation', 'note')


def test_unequal_ends_are_told_with_the_jump_at_the_seam():
    y = positions()
    y[-1] += 0.1
    each, = found(DEGREES, y)
    assert each.code == 'unequal_ends' and each.line == 361
    assert each.value == pytest.approx(0.1)
    assert f'{0.1 * OMEGA / DEGREE:.5g} mm/s' in each.harm


def test_columns_whose_ends_differ_are_told():
    v, a = (press().curve(DEGREES * DEGREE, order) * DEGREE**order for order in (1, 2))
    a[-1] += 0.005 * a.max()
    each, = found(DEGREES, positions(), v, a, interpolation='quintic')
    assert (each.code, each.line) == ('unequal_end_acceleration', 361)
    assert each.value == pytest.approx(-0.005 * a.max() / DEGREE**2)


def test_angles_that_fall_or_stand_twice_are_errors_with_their_lines():
    x = DEGREES.copy()
    x[50] = x[49]
    x[70], x[71] = x[71], x[70]
    listed = found(x, positions())
    assert [(each.code, each.severity, each.line) for each in listed] == [
        ('duplicate_angle', 'error', 51), ('falling_angle', 'error', 72)]


def test_a_table_turned_round_is_one_error():
    each, = found(DEGREES[::-1], positions())
    assert (each.code, each.line) == ('falling_angle', 2) and 'turn the order' in each.hint


def test_a_turn_that_counts_two_pi_is_taken_for_radians():
    each, = found(DEGREES * DEGREE, positions())
    assert each.code == 'open_cycle' and '--angle-unit rad' in each.hint


def test_a_table_that_ends_early_is_an_error():
    each, = found(DEGREES[:200], positions()[:200])
    assert (each.code, each.severity, each.value) == ('open_cycle', 'error', pytest.approx(161.0))


def test_too_few_points_are_told_with_what_a_spline_misses():
    degrees = np.linspace(0.0, 360.0, 17)
    each, = found(degrees, positions(None, degrees))
    assert each.code == 'too_few_points' and each.value > 0.2


@pytest.mark.parametrize('decimals', [1, 2, 3])
def test_rounded_positions_show_in_the_second_difference(decimals):
    each, = found(DEGREES, np.round(positions(), decimals))
    assert each.code == 'rounded_positions' and f'rounded to {10.0**-decimals:g} mm' in each.text
    # at most what rounding explains: half a unit at each of three points
    assert each.value <= 1.5 * 2.0 * 10.0**-decimals / DEGREE**2
    assert found(DEGREES, np.round(positions(), 6)) == []


def test_the_resolution_of_numbers_is_found():
    assert resolution_of(np.array([1.25, 3.5])) == 0.01
    assert resolution_of(np.array([10.0, 3.0])) == 1.0
    assert resolution_of(np.array([math.pi])) is None


SCALES = [(1.0, 1.0, 'per radian', '--per rad'), (DEGREE / 1000.0, 1.0, 'wrong scale', 'divide'),
          (-DEGREE, DEGREE**2, 'its sign', 'turn its sign'),
          (360.0 * DEGREE, DEGREE**2, 'per cycle', 'divide it by 360')]


@pytest.mark.parametrize(('first', 'second', 'words', 'hint'), SCALES)
def test_a_column_in_a_wrong_unit_is_named(first, second, words, hint):
    v, a = (press().curve(DEGREES * DEGREE, order) for order in (1, 2))
    listed = found(DEGREES, positions(), first * v, second * a, interpolation='quintic')
    assert listed[0].code == 'velocity_contradicts'
    assert words in listed[0].text and hint in listed[0].hint
    per_radian = TableOptions(per='rad')
    if words == 'per radian':
        assert found(DEGREES, positions(), v, a, interpolation='quintic',
                     options=per_radian) == []
        listed = found(DEGREES, positions(), v * DEGREE, a * DEGREE**2, interpolation='quintic',
                       options=per_radian)
        assert 'per degree' in listed[0].text and listed[1].code == 'acceleration_contradicts'


def test_one_wrong_velocity_is_told_with_what_the_positions_give():
    v = press().curve(DEGREES * DEGREE, 1) * DEGREE
    v[30] = 0.0
    each, = found(DEGREES, positions(), v, interpolation='cubic')
    assert (each.code, each.line) == ('velocity_contradicts', 31)
    assert 'the velocity 0 contradicts the positions' in each.text


@pytest.mark.parametrize('decimals', [8, 6, 3])
@pytest.mark.parametrize('count', [361, 3601, 20001])
def test_rounding_alone_is_no_wrong_point(count, decimals):
    degrees = np.linspace(0.0, 360.0, count)
    wrong = found(degrees, np.round(positions(degrees=degrees), decimals))
    assert {each.code for each in wrong} <= {'rounded_positions'}


def test_a_table_of_many_points_is_judged_as_one_of_few():
    noise = {}
    for count in (361, 3601, 40001):
        degrees = np.linspace(0.0, 360.0, count)
        resolution = 10.0 ** -2 * (361.0 / count) ** 2
        digits = round(-math.log10(resolution))
        wrong = found(degrees, np.round(positions(degrees=degrees), digits))
        only, = wrong
        assert only.code == 'rounded_positions'
        step = 2.0 * math.pi / (count - 1)
        noise[count] = only.value / (10.0 ** -digits / step ** 2)
    # half a unit at each of three points: up to two units of the last digit
    assert all(0.8 < value <= 2.2 for value in noise.values())


def test_rounded_angles_are_named_and_no_point_is_blamed():
    degrees = np.linspace(0.0, 360.0, 1401)
    only, = found(np.round(degrees, 3), positions(degrees=degrees))
    assert only.code == 'rounded_angles' and 'more digits' in only.hint
    assert only.value == pytest.approx(
        np.abs(np.round(degrees, 3) - degrees).max() * DEGREE
        * abs(press().curve.peak(1).value), rel=1e-3)
    # angles that somebody chose are not rounded, nor are whole degrees
    assert found(DEGREES, positions()) == []


def test_a_line_that_repeats_the_one_before_is_left_out_with_a_note():
    degrees = np.insert(DEGREES, 101, DEGREES[100])
    made = table(degrees, np.insert(positions(), 101, positions()[100]))
    assert len(made.angle) == 361 and lint(made, OMEGA, 'mm') == []
    assert made.notes[-1] == 'left out, as they repeat the line before: line 102'
    moved = np.insert(positions(), 101, positions()[100] + 1.0)
    only, = found(degrees, moved)
    assert only.code == 'duplicate_angle' and only.hint.endswith('--drop 102')
