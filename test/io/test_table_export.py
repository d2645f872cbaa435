# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Cam tables repaired and written: within the bounds that are stated, there and back."""

from dataclasses import replace
import math

from cam_motion.errors import CamMotionError, ConfigurationError
from cam_motion.io.axis import build_axis
from cam_motion.io.config import read_sections, section_yaml
from cam_motion.io.tables import (
    export,
    FORMATS,
    RawTable,
    read_table,
    Samples,
    TableOptions,
    write_text,
    written_formats,
)
from cam_motion.io.tables.export import (
    CamToExport,
    decimals_for,
    export_cam,
    ExportOptions,
)
from cam_motion.io.tables.lint import lint
from cam_motion.io.tables.repair import figures_of, import_table
from cam_motion.io.tables.table import to_cam
from cam_motion.motion.laws import make_law
from cam_motion.motion.piecewise import Peak
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from cam_motion.units import DEGREE, RPM, TURN
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest
import yaml

pytestmark = pytest.mark.timeout(60)

DEGREES = np.linspace(0.0, 360.0, 361)
OMEGA = 200.0 * RPM
ROUNDING = 1e-9


def press(law='modified_sine', lift=20.0):
    """Give a press: down, hold, up, rest."""
    return CamProfile([segment('down', 90.0, lift, law), segment('hold', 150.0),
                       segment('up', 270.0, -lift, law), segment('rest', 360.0)])


def belt():
    """Give a belt that is fed once per cycle."""
    return CamProfile([segment('feed', 120.0, 300.0, 'modified_sine'), segment('wait', 360.0)],
                      accumulate=True)


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


@pytest.mark.parametrize('decimals', [1, 2, 3])
def test_a_repair_holds_its_tolerance_and_takes_the_noise_away(decimals):
    unit = 10.0**-decimals
    made = import_table(table(DEGREES, np.round(positions(), decimals)), 'press', 'mm', unit)
    own = made.axis.profile(made.table.angle) + made.section.get('offset', 0.0)
    assert np.abs(own - made.table.position).max() <= unit
    assert made.deviation == pytest.approx(np.abs(own - made.table.position).max(), abs=1e-12)
    assert made.points < 80 and made.after.continuity == 4
    assert abs(made.after.peaks[1].value) < 0.95 * abs(made.before.peaks[1].value)


@settings(max_examples=2, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.01, 0.1]), st.booleans())
def test_a_repair_holds_its_tolerance_with_any_noise(seed, tolerance, accumulate):
    rng = np.random.default_rng(seed)
    y = positions(belt() if accumulate else press())
    noisy = y + rng.uniform(-0.9, 0.9, len(y)) * tolerance
    noisy[-1] = noisy[0] + (300.0 if accumulate else 0.0)
    made = import_table(table(DEGREES, noisy), 'x', 'mm', tolerance)
    assert made.deviation <= tolerance
    assert made.after.continuity >= 2 and made.axis.profile.jumps(1) == []


def test_without_repair_the_spline_passes_through_every_point():
    made = import_table(table(DEGREES, positions() + 3.0), 'press', 'mm')
    assert made.deviation < ROUNDING and made.points == 361
    assert made.section['offset'] == 3.0 and 'angles_deg' not in made.section['curve']
    cubic = import_table(table(DEGREES, positions()), 'press', 'mm', degree=3)
    assert cubic.after.continuity == 2


def test_unequal_ends_are_closed_half_way_or_refused():
    y = positions()
    y[-1] = 0.1
    with pytest.raises(ConfigurationError, match='more than 0.05'):
        import_table(table(DEGREES, y), 'press', 'mm', 0.05)
    made = import_table(table(DEGREES, y), 'press', 'mm', 0.06)
    assert made.deviation <= 0.06 and made.axis.profile.jumps(0) == []


def test_what_makes_no_cam_is_refused_with_its_lines():
    x = DEGREES.copy()
    x[50] = x[49]
    with pytest.raises(ConfigurationError, match='line 51.*stands twice'):
        import_table(table(x, positions()), 'press')
    with pytest.raises(ConfigurationError, match='covers 199 of 360'):
        import_table(table(DEGREES[:200], positions()[:200]), 'press', 'm', 0.1)


def test_peaks_of_a_table_that_is_interpolated_linearly_are_infinite():
    figures = figures_of(table(DEGREES, positions(), interpolation='linear').curve(), 0.0)
    assert figures.continuity == 0 and math.isinf(figures.peaks[1].value)
    y = positions()
    y[-1] = 0.1
    assert figures_of(table(DEGREES, y).curve(), 0.0).continuity == -1


@pytest.mark.parametrize(('degree', 'continuity'), [(3, 2), (5, 4)])
def test_the_class_of_a_table_of_many_points_is_that_of_its_spline(degree, continuity):
    degrees = np.linspace(0.0, 360.0, 5001)
    y = np.round(positions(press('polynomial_345'), degrees), 9)
    made = import_table(table(degrees, y), 'press', 'mm', degree=degree)
    assert made.after.continuity == continuity
    assert math.isfinite(made.after.peaks[2].value)


def test_the_section_is_a_machine_file_that_makes_the_same_cam(tmp_path):
    v, a = (press().curve(DEGREES[::5] * DEGREE, order) * DEGREE**order for order in (1, 2))
    four = table(DEGREES[::5], positions()[::5], v, a, interpolation='quintic')
    noisy = table(DEGREES, np.round(positions(), 2))
    for made in (import_table(noisy, 'press', 'mm', 0.01), import_table(four, 'press', 'mm')):
        file = tmp_path / 'press.yaml'
        write_text(file, section_yaml('press', made.section, ['a remark']))
        assert all(len(line) <= 99 for line in file.read_text().splitlines())
        axis = build_axis('press', read_sections(file)['press'])
        at = np.linspace(0.0, TURN, 777)
        assert (axis.profile(at) == made.axis.profile(at)).all()
    assert 'velocities' in made.section['curve']
    with pytest.raises(CamMotionError, match='cannot be written'):
        write_text(tmp_path / 'press.yaml' / 'x', '')


def test_any_reader_of_yaml_finds_numbers_and_texts(tmp_path):
    made = import_table(table(DEGREES, 1e-20 * np.round(positions() * 10.0)), 'press', 'no')
    read = yaml.safe_load(section_yaml('press', made.section))['press']['ros__parameters']
    assert read['unit'] == 'no'
    assert read['curve']['positions'] == made.section['curve']['positions']


def test_a_segment_of_a_machine_file_may_be_a_table():
    given = {
        'segments': ['feed', 'wait'], 'cycle': 'accumulate', 'feed.law': 'spline',
        'feed.end_deg': 90.0, 'feed.positions': [2, 4.0, 10, 12.0], 'wait.end_deg': 360.0,
        'feed.angles_deg': [0, 30, 60.0, 90]}
    axis = build_axis('belt', given)
    assert axis.profile.advance == 10.0 and axis.profile.jumps(2) == []
    assert axis.profile([30.0 * DEGREE, TURN]) == pytest.approx([2.0, 10.0])
    for change, words in (({'feed.lift': 9.0}, 'leave it out'), ({'feed.positions': []}, 'lift'),
                          ({'feed.angles_deg': [0, 30, 60, 80]}, 'from 0 to 90 deg'),
                          ({'feed.positions': [2, 'x', 3, 4]}, 'positions')):
        with pytest.raises(ConfigurationError, match=words):
            build_axis('belt', {**given, **change})


def cam(profile=None):
    """Give a cam to export."""
    profile = profile or press()
    return CamToExport('press', profile.curve, profile.advance)


@pytest.mark.parametrize('name', [name for name in written_formats() if name != 'inventor'])
@pytest.mark.parametrize('make', [press, belt])
def test_what_is_exported_comes_back_and_deviates_by_what_was_said(tmp_path, name, make):
    length, scale = (4096.0, 1e-3) if FORMATS[name].steps else (None, 1.0)
    made = export_cam(cam(make()), name, ExportOptions(
        65 if FORMATS[name].steps else 73, None, 4, length, scale))
    file = write_text(tmp_path / 'table', made.text)
    read, _ = read_table(file, TableOptions(
        cycle_length=length, slave_scale=scale, interpolation=made.interpolation),
        '' if name[:3] != 'csv' else 'csv')
    assert read.format_name == ('csv' if name[:3] == 'csv' else name)
    assert read.cycle == ('return' if make is press else 'accumulate')
    assert len(read.angle) == made.points
    # a dense grid never finds more than what was said, and hardly less
    theirs, at = read.curve(), np.linspace(0.0, TURN, 20011)[1:-1]
    for order, peak in enumerate(made.deviations):
        off = np.abs(theirs(at, order) - make().curve(at, order)).max()
        assert off <= abs(peak.value) * (1.0 + 1e-9) + 1e-9
        assert off >= 0.85 * abs(peak.value) - 1e-6


def test_lines_between_360_points_miss_by_the_figure_of_theory():
    profile = CamProfile([segment('up', 180.0, 1.0, 'cycloidal'),
                          segment('down', 360.0, -1.0, 'cycloidal')])
    made = export_cam(cam(profile), 'csv', ExportOptions(
        361, decimals=12, interpolation='linear'))
    assert abs(made.deviations[0].value) == pytest.approx(
        TURN / (8.0 * 180.0**2), rel=1e-3)
    assert made.steps[0] > 0.0


def test_rounding_alone_is_half_a_unit():
    made = export_cam(cam(), 'csv', ExportOptions(361, decimals=2))
    assert 0.0045 < abs(made.deviations[0].value) < 0.01


@pytest.mark.parametrize(('name', 'tolerance'), [
    ('lenze', 0.05), ('kollmorgen', 0.01), ('codesys', 0.001), ('csv4', 0.001)])
def test_the_fewest_points_that_hold_a_tolerance_are_found(name, tolerance):
    made = export_cam(cam(), name, ExportOptions(tolerance=tolerance))
    assert abs(made.deviations[0].value) <= tolerance
    fewer = export_cam(cam(), name, ExportOptions(made.points - 1))
    assert abs(fewer.deviations[0].value) > tolerance


def test_a_tolerance_hardly_above_rounding_is_decided_soon(monkeypatch):
    tried = []

    def counted(*arguments):
        tried.append(arguments[-1])
        return replace(finished(*arguments), deviations=(Peak(1.0, 0.0),) * 3)
    finished = export._finished
    monkeypatch.setattr(export, '_finished', counted)
    with pytest.raises(ConfigurationError, match='with 1024 points it deviates by 1'):
        export_cam(cam(), 'sew', ExportOptions(tolerance=0.01))
    assert len(tried) < 12 and tried[-1] == 1024 and tried == sorted(tried)


def test_a_rise_is_exported_by_itself():
    law = make_law('modified_sine')
    rise = CamToExport('up', law.curve.scaled(0.0, TURN, -0.25), -0.25, False, 90.0 * DEGREE)
    made = export_cam(rise, 'inventor', ExportOptions(101, interpolation='cubic'))
    assert made.text.startswith('0;0\n') and made.text.endswith('1;1\n')
    assert abs(made.deviations[0].value) < 1e-6
    # per radian of the shaft, of which the rise has a quarter turn
    own = export_cam(replace(rise, span=TURN), 'inventor', ExportOptions(
        101, interpolation='cubic'))
    assert made.deviations[1].value == pytest.approx(4.0 * own.deviations[1].value)


@pytest.mark.parametrize(('name', 'options', 'words'), [
    ('isg', {}, 'only read'), ('inventor', {}, 'one rise'), ('sew', {'points': 2000}, '1024'),
    ('kollmorgen', {'points': 3}, 'nearest is 5'), ('technosoft', {}, '--cycle-length'),
    ('technosoft', {'cycle_length': 1001.5}, 'none of these divides'),
    ('technosoft', {'cycle_length': 4096.0, 'points': 100}, 'nearest is 129'),
    ('csv', {'tolerance': 1e-9, 'decimals': 3}, 'rounding alone costs 0.0005'),
    ('sew', {'tolerance': 1e-9, 'decimals': 12}, 'cannot hold it'),
])
def test_what_a_format_cannot_hold_is_refused(name, options, words):
    with pytest.raises(ConfigurationError) as caught:
        export_cam(cam(), name, ExportOptions(**options))
    assert words in str(caught.value)


def test_a_format_that_is_only_read_writes_nothing():
    empty = np.zeros(2)
    with pytest.raises(CamMotionError, match='only read'):
        FORMATS['isg'].written(Samples(empty, empty, None, None, 3, 'x', True))


# All of it in a row.


@pytest.mark.parametrize('name', ['codesys', 'kollmorgen', 'lenze'])
def test_a_table_goes_all_the_way_round(tmp_path, name):
    start = write_text(tmp_path / 'start.csv', ''.join(
        f'{x:g};{y:.3f}\n' for x, y in zip(DEGREES, positions())))
    first, _ = read_table(start)
    assert [each.code for each in lint(first, OMEGA)] == ['rounded_positions']
    made = import_table(first, 'press', 'mm', 1e-3)
    shift = made.section.get('offset', 0.0)
    exported = export_cam(CamToExport(
        'press', made.axis.profile.curve.scaled(0.0, TURN, 1.0, shift)), name,
        ExportOptions(361, decimals=9))
    again, _ = read_table(write_text(tmp_path / 'again', exported.text),
                          TableOptions(interpolation=exported.interpolation))
    assert [each.code for each in lint(again, OMEGA, 'mm') if each.severity != 'note'] == []
    back = import_table(again, 'press', 'mm')
    at = np.linspace(0.0, TURN, 5001)
    off = np.abs(back.axis.profile(at) + back.section.get('offset', 0.0)
                 - made.axis.profile(at) - shift).max()
    assert off < 1e-6
    # within the tolerance of the table that it began with
    own = back.axis.profile(first.angle) + back.section.get('offset', 0.0)
    assert np.abs(own - first.position).max() < 1e-3 + 1e-6


def test_a_repair_that_cannot_be_that_close_is_refused_with_what_can():
    made = table(DEGREES, np.round(positions(), 6))
    for tolerance in (1e-3, 1e-6, 1e-8, 1e-10, 1e-13):
        try:
            taken = import_table(made, 'press', 'mm', tolerance)
        except ConfigurationError as error:
            problem, = error.problems
            assert tolerance <= 1e-8 and problem.path == '--repair'
            assert 'or more' in problem.hint
        else:
            assert taken.deviation <= tolerance * (1.0 + 1e-9)
    with pytest.raises(ConfigurationError, match='no curve was found that close'):
        import_table(made, 'press', 'mm', 1e-13)


@pytest.mark.parametrize('lift, scale, decimals', [
    (20.0, 1.0, 6), (0.02, 1.0, 9), (0.3, 1.0, 8), (0.02, 0.001, 6), (1e-12, 1.0, 15)])
def test_positions_are_written_with_the_digits_that_their_stroke_asks_for(lift, scale, decimals):
    cam = CamToExport('press', CamProfile([
        segment('down', 180.0, lift, 'modified_sine'),
        segment('up', 360.0, -lift, 'modified_sine')]).curve)
    assert decimals_for(cam, FORMATS['csv'], scale) == decimals
    made = export_cam(cam, 'csv', ExportOptions(slave_scale=scale))
    assert made.samples.decimals == decimals
    assert export_cam(cam, 'csv', ExportOptions(decimals=3)).samples.decimals == 3
