# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``optimise``: before and after, what is pasted, and what is refused."""

from pathlib import Path

import pytest

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config'
DRIVEN = CONFIG / 'feeding_group.yaml'
SHEAR = CONFIG / 'flying_shear.yaml'
PROGRAMME = 1e-6


def test_without_a_file_it_is_a_movement_of_1_in_1_s(cam_motion, read_json):
    done = cam_motion('optimise', '--continuity', 1, '--json')
    data = read_json(done.stdout)
    assert done.returncode == 0
    assert data['minimise'] == {'rms_acceleration': 1.0}
    assert data['before']['law'] == 'polynomial_345'
    assert data['before']['rms_acceleration'] == pytest.approx(4.1404, abs=1e-4)
    assert data['after']['rms_acceleration'] == pytest.approx(12.0 ** 0.5, rel=PROGRAMME)
    assert data['after']['peak_acceleration'] == pytest.approx(6.0, rel=PROGRAMME)
    assert data['after']['cj'] is None and data['files'] == []
    assert data['law']['law'] == 'b_spline'
    assert data['law']['coefficients'][:2] == [0.0, 0.0]


def test_limits_are_in_the_units_of_the_movement(cam_motion, read_json):
    # 0.2 m in a quarter of a turn at 60 cycles/min: 0.25 s
    data = read_json(cam_motion(
        'optimise', '--lift', -0.2, '--span-deg', 90, '--continuity', 1, '--minimise',
        'peak_acceleration', '--max-velocity', 1.2, '--json').stdout)
    assert data['after']['cv'] == pytest.approx(1.5, rel=PROGRAMME)
    assert data['after']['peak_velocity'] == pytest.approx(1.2, rel=PROGRAMME)
    assert data['after']['peak_acceleration'] == pytest.approx(4.5 * 0.2 / 0.25 ** 2, rel=1e-6)


def test_what_it_writes_is_the_section_of_the_axis_with_the_figures_it_told(
        cam_motion, read_json, machine_file, tmp_path):
    out = tmp_path / 'new' / 'feeder.yaml'
    done = cam_motion('optimise', machine_file, 'feeder.feed', '-o', out, '--json')
    data = read_json(done.stdout)
    assert data['files'] == [str(out)]
    assert out.read_text().startswith('# feed of feeder: least RMS acceleration\nfeeder:\n')
    check = cam_motion('check', out, '--speed-cpm', 200, '--json')
    assert check.returncode == 0
    axis = read_json(check.stdout)['axes']['feeder']
    feed = axis['segments'][0]
    assert feed['law'] == 'b_spline'
    for name in ('velocity', 'acceleration', 'jerk'):
        assert feed[f'peak_{name}'] == pytest.approx(data['after'][f'peak_{name}'], rel=1e-12)
    # the limit of the axis is used to the last and kept: 400 m/s²
    assert data['after']['peak_acceleration'] == pytest.approx(400.0, rel=PROGRAMME)
    assert axis['runs_at_set_speed'] and axis['continuity']['class'] == 'C2'
    assert axis['limits'] == {'velocity': 10.0, 'acceleration': 400.0, 'jerk': None}
    assert data['after']['objective'] < data['before']['objective']


def test_the_drive_of_the_axis_makes_torques(cam_motion, read_json):
    data = read_json(cam_motion(
        'optimise', DRIVEN, 'feeder.feed', '--minimise', 'rms_torque', '--json').stdout)
    assert data['after']['rms_torque'] < data['before']['rms_torque']
    assert data['after']['objective'] == data['after']['rms_torque']
    simulated = read_json(cam_motion('simulate', DRIVEN, '--json').stdout)
    assert data['before']['peak_torque'] == pytest.approx(simulated['peak_torque'], rel=1e-9)
    # over the whole cycle of 360 deg, of which the movement takes 80
    assert data['before']['rms_torque'] * (80.0 / 360.0) ** 0.5 == pytest.approx(
        simulated['rms_torque'], rel=1e-6)


def test_a_family_keeps_its_name_and_its_parameters(cam_motion, read_json, machine_file):
    data = read_json(cam_motion(
        'optimise', machine_file, 'knife.back', '--law', 'scca', '--minimise',
        'rms_acceleration=1,peak_jerk=0.5', '--json').stdout)
    assert data['law']['law'] == 'scca'
    assert set(data['law']) == {'law', 'shares', 'constant_velocity', 'inflection'}
    assert data['minimise'] == {'rms_acceleration': 1.0, 'peak_jerk': 0.5}
    assert data['after']['objective'] < data['before']['objective']
    assert data['lift'] == -0.08 and data['span_deg'] == pytest.approx(60.0)


def test_neighbours_that_move_are_met(cam_motion, read_json, tmp_path):
    out = tmp_path / 'carriage.yaml'
    done = cam_motion('optimise', SHEAR, 'carriage.accelerate', '--minimise', 'peak_acceleration',
                      '-o', out, '--json')
    assert done.returncode == 0
    check = read_json(cam_motion('check', out, '--json').stdout)
    joints = check['axes']['carriage']['continuity']['joints']
    assert [joint['class'] for joint in joints[:2]] == ['C2', 'C2']
    assert read_json(done.stdout)['after']['ca'] < read_json(done.stdout)['before']['ca']


def test_a_movement_that_breaks_its_limit_is_brought_below_it(cam_motion, read_json,
                                                              machine_file, tmp_path):
    text = machine_file.read_text().replace('acceleration: 400.0', 'acceleration: 300.0')
    broken, out = tmp_path / 'broken.yaml', tmp_path / 'fixed.yaml'
    broken.write_text(text)
    assert cam_motion('check', broken).returncode == 2
    done = cam_motion('optimise', broken, 'feeder.feed', '-o', out, '--minimise', 'rms_jerk')
    assert done.returncode == 0, done.stderr
    assert cam_motion('check', out, '--speed-cpm', 200).returncode == 0
    free = read_json(cam_motion('optimise', broken, 'feeder.feed', '--ignore-limits',
                                '--minimise', 'rms_jerk', '--json').stdout)
    assert free['after']['peak_acceleration'] > 300.0


@pytest.mark.parametrize('columns', ['80', '120'])
def test_people_get_a_table_and_yaml_to_paste(cam_motion, machine_file, columns):
    done = cam_motion('optimise', machine_file, 'feeder.feed', '--law', 'trapezoidal_velocity',
                      columns=columns)
    table, yaml = done.stdout.split('to paste:')
    assert 'before' in table and 'after' in table
    assert 'RMS acceleration' in table and '4.2332' in table and '%' in table
    assert max(map(len, table.splitlines())) <= int(columns)
    assert 'law: trapezoidal_velocity' in yaml and 'ramp_up: 0.33' in yaml
    assert 'end_deg: 80.0' in yaml and 'lift: 0.3' in yaml


def test_before_and_after_are_drawn(cam_motion, tmp_path):
    picture = tmp_path / 'new' / 'feed.svg'
    done = cam_motion('optimise', '--picture', picture)
    assert done.returncode == 0 and f'wrote {picture}' in done.stdout
    assert all(text in picture.read_text() for text in ('polynomial_345', 'b_spline', 'jerk'))


@pytest.mark.parametrize(('arguments', 'words'), [
    (['{0}'], 'AXIS.SEGMENT'), (['{0}', 'feeder'], 'must be AXIS.SEGMENT'),
    (['{0}', 'robot.feed'], 'known are: feeder, press, knife'),
    (['{0}', 'feeder.feet'], 'known are: feed, wait'),
    (['{0}', 'feeder.wait'], 'moves nothing'), (['{0}', 'feeder.cam.feed'], 'several'),
    (['{0}', 'press.close', '--minimise', 'rms_torque'], 'needs a load'),
    (['{0}', 'feeder.feed', '--lift', '1'], '--lift'),
    (['{0}', 'feeder.feed', '-o', '{0}'], 'must not be the machine file itself'),
    (['{0}', 'feeder.feed', '--max-velocity', '4'], 'no curve of degree'),
    (['{0}', 'feeder.feed', '--max-velocity', '-4'], 'limits.velocity'),
    (['--lift', '0'], 'must not be 0'), (['--span-deg', '400'], 'at most 360'),
    (['--law', 'scca', '--continuity', '3'], 'take the spline'),
    (['--degree', '2'], 'must be from 3'), (['--picture', 'a.doc'], 'must end in'),
    (['nothing.yaml', 'a.b'], 'cannot be read'),
])
def test_what_cannot_be_done_is_said_with_exit_code_2(cam_motion, machine_file, arguments, words):
    done = cam_motion('optimise', *(each.format(machine_file) for each in arguments))
    assert (done.returncode, 'Traceback' in done.stderr) == (2, False)
    assert words in done.stderr


@pytest.mark.parametrize('arguments', [
    ['--minimise', 'beauty'], ['--minimise', 'rms_jerk,rms_jerk'], ['--minimise', 'rms_jerk=0'],
    ['--minimise', 'rms_jerk=nan'], ['--law', 'cubic'], ['--continuity', '4'],
    ['--max-jerk', 'inf'],
])
def test_a_wrong_command_line_shows_the_usage(cam_motion, arguments):
    done = cam_motion('optimise', *arguments)
    assert done.returncode == 2 and 'usage:' in done.stderr
