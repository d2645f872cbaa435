# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``table``: what it prints, what it writes, and its exit codes."""

import json

from cam_motion.io.tables import FORMATS
from cam_motion.motion.laws import make_law
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

DEGREES = np.linspace(0.0, 360.0, 181)


@pytest.fixture
def press(tmp_path):
    """Give a function that writes the table of a press, with so many decimals and a change."""
    def write(decimals=9, change=None):
        law = make_law('modified_sine')
        y = 20.0 * np.concatenate([
            law(np.linspace(0.0, 1.0, 61)), np.ones(30), 1.0 - law(np.linspace(0.0, 1.0, 61)),
            np.zeros(29)])
        if change is not None:
            change(y)
        y[-1] = y[0] if change is None else y[-1]
        file = tmp_path / 'press.csv'
        file.write_text('angle [deg];lift [mm]\n' + ''.join(
            f'{x:g};{value:.{decimals}f}\n' for x, value in zip(DEGREES, y)).replace('.', ','))
        return file
    return write


def test_a_good_table_is_said_to_be_good(cam_motion, press):
    done = cam_motion('table', 'lint', press())
    assert done.returncode == 0 and 'nothing is wrong' in done.stdout
    assert '181 points, 2 columns, stroke 20' in done.stdout


def test_a_wrong_point_is_told_with_line_angle_harm_and_way_out(cam_motion, read_json, press):
    def change(y):
        y[30] += 0.5
    file = press(change=change)
    done = cam_motion('table', 'lint', file, '--unit', 'mm', '--speed-cpm', '200')
    assert done.returncode == 1
    for words in ('beside the curve', ' 32 ', '--drop 32', 'mm/s²', 'at 200 cycles/min'):
        assert words in done.stdout
    data = read_json(cam_motion('table', 'lint', file, '--json').stdout)
    finding, = data['findings']
    assert (finding['code'], finding['line']) == ('outlier', 32)
    assert finding['angle_deg'] == pytest.approx(60.0)
    assert cam_motion('table', 'lint', file, '--drop', '32').returncode == 0
    assert cam_motion('table', 'lint', file, '--drop', '1').returncode == 2


def test_an_import_is_a_machine_file_that_check_takes(cam_motion, read_json, press, tmp_path):
    yaml = tmp_path / 'new' / 'press.yaml'
    done = cam_motion('table', 'import', press(2), '--unit', 'mm', '--repair', '0.01', '--axis',
                      'press', '-o', yaml)
    assert done.returncode == 0 and f'wrote {yaml}' in done.stdout
    assert 'spline within 0.01 mm' in done.stdout and 'C4' in done.stdout
    check = read_json(cam_motion('check', yaml, '--json').stdout)
    assert not check['problems'] and list(check['axes']) == ['press']
    data = read_json(cam_motion('table', 'import', press(2), '--repair', '0.01',
                                '--json').stdout)
    assert data['deviation']['value'] <= 0.01
    assert data['points']['spline'] < data['points']['table'] == 181
    assert [each['code'] for each in data['findings']] == ['rounded_positions']
    assert data['after']['class'] == 'C4'
    assert data['section']['curve']['law'] == 'spline'


def test_the_yaml_goes_to_standard_output_by_itself(cam_motion, press, tmp_path):
    done = cam_motion('table', 'import', press(), '--axis', 'press')
    assert done.stdout.startswith('# Cam table press.csv, 181 points, through every point')
    assert 'peaks at' in done.stderr
    file = tmp_path / 'again.yaml'
    file.write_text(done.stdout)
    assert cam_motion('check', file).returncode == 0


def test_a_cam_of_a_machine_is_exported_with_its_deviation(
        cam_motion, read_json, machine_file, tmp_path):
    file = tmp_path / 'knife.csv'
    done = cam_motion('table', 'export', machine_file, 'knife', '--format', 'kollmorgen', '-n',
                      '181', '-o', file, '--slave-scale', '0.001')
    assert done.returncode == 0 and '181 points, cubic interpolation' in done.stdout
    lines = file.read_text().splitlines()
    assert lines[:3] == ['CYCLIC;YES;', 'TABLE_BEGIN;;', '0;0;SPLINE'] and len(lines) == 184
    data = read_json(cam_motion('table', 'export', machine_file, 'knife', '--format', 'codesys',
                                '--tolerance', '1e-4', '--json').stdout)
    assert abs(data['deviation']['position']['value']) <= 1e-4
    assert data['points'] < 40 and data['interpolation'] == 'quintic'
    printed = cam_motion('table', 'export', machine_file, 'feeder', '--format', 'lenze')
    assert printed.stdout.startswith('0 0 // point 1') and 'deviation' in printed.stderr
    again = tmp_path / 'feeder.txt'
    again.write_text(printed.stdout)
    # 0.3 m of belt per cycle, where the machine file has a modified trapezoid
    assert read_json(cam_motion('table', 'lint', again, '--json').stdout)['cycle'] == 'accumulate'


def test_a_segment_is_exported_by_itself(cam_motion, machine_file):
    done = cam_motion('table', 'export', machine_file, 'knife', '--format', 'inventor',
                      '--segment', 'cut', '-n', '11')
    assert done.stdout.splitlines()[0] == '0;0' and done.stdout.splitlines()[10] == '1;1'


def test_a_table_is_converted(cam_motion, read_json, press, tmp_path):
    file = tmp_path / 'press.txt'
    done = cam_motion('table', 'convert', press(3), '--repair', '0.001', '--to', 'sew', '-n',
                      '361', '-o', file, '--json')
    data = read_json(done.stdout)
    assert data['import']['deviation']['value'] <= 0.001
    assert file.read_text().splitlines()[0] == '361' == str(data['points'])
    assert abs(data['deviation']['position']['value']) < 1e-3


@pytest.mark.parametrize(('arguments', 'words'), [
    (['lint', 'none.csv'], 'cannot be read'),
    (['import', 'FILE', '--repair', '-1'], 'above 0'),
    (['import', 'FILE', '--slave-scale', '0'], 'must not be 0'),
    (['lint', 'FILE', '--speed-cpm', '1e300'], 'from 1e-30 to 1e+30'),
    (['lint', 'FILE', '--speed-cpm', '1e-300'], 'from 1e-30 to 1e+30'),
    (['lint', 'FILE', '--drop', 'x'], 'line numbers'),
    (['export', 'CONFIG', 'nobody', '--format', 'csv'], 'feeder, press, knife'),
    (['export', 'CONFIG', 'knife', '--format', 'isg'], 'invalid choice'),
    (['export', 'CONFIG', 'knife', '--format', 'inventor'], '--segment'),
    (['export', 'CONFIG', 'knife', '--format', 'csv', '--segment', 'x'], 'cut, dwell'),
    (['export', 'CONFIG', 'knife', '--format', 'csv', '--cam', 'x'], 'known are: cam'),
    (['export', 'CONFIG', 'knife', '--format', 'csv', '-n', '1'], 'nearest is 2'),
    ([], 'required: ACTION'),
])
def test_what_cannot_be_done_exits_with_2(cam_motion, press, machine_file, arguments, words):
    known = {'FILE': press(), 'CONFIG': machine_file}
    done = cam_motion('table', *(known.get(each, each) for each in arguments))
    assert done.returncode == 2 and words in done.stderr


def test_a_table_that_makes_no_cam_exits_with_2(cam_motion, tmp_path):
    file = tmp_path / 'x.csv'
    file.write_text('0 0\n90 1\n90 2\n180 0\n')
    done = cam_motion('table', 'import', file)
    assert done.returncode == 2 and 'x.csv, line 3' in done.stderr and 'twice' in done.stderr
    assert cam_motion('table', 'lint', file).returncode == 1


def test_the_cams_of_tables_among_the_configurations_run(cam_motion, machine_file, read_json):
    done = cam_motion('check', machine_file.with_name('table_cam.yaml'), '--json')
    assert done.returncode == 0 and set(read_json(done.stdout)['axes']) == {'press', 'belt'}


def test_every_format_is_named_in_the_help(cam_motion):
    said = cam_motion('table', '--help').stdout
    assert all(name in said for name in FORMATS)


def test_points_curve_and_second_differences_are_drawn(cam_motion, press, tmp_path):
    first, second = tmp_path / 'lint.svg', tmp_path / 'import.svg'
    assert cam_motion('table', 'lint', press(2), '-o', first).returncode == 1
    done = cam_motion('table', 'import', press(2), '--repair', '0.01', '--plot', second, '--json')
    assert json.loads(done.stdout)['files'] == [str(second)]
    assert 'second differences of the table' in first.read_text()
    assert 'rounded positions' in first.read_text()
    for words in ('spline through', 'tolerance', 'acceleration of the spline'):
        assert words in second.read_text()
