# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``check``: figures of document 001, every problem once, exit codes."""

import math

import pytest
import yaml

pytestmark = pytest.mark.timeout(60)

ROUNDED_ON_THE_SLIDE = 5e-5  # document 001 rounds to the figures that are compared here

BROKEN = {
    'feeder.feed.end_deg': lambda tree: tree['feeder']['feed'].update(end_deg=-10.0),
    'press.close.lift': lambda tree: tree['press']['close'].update(lift=float('nan')),
    'press.close.law': lambda tree: tree['press']['close'].update(law='wobble'),
    'knife.limits.velocity': lambda tree: tree['knife']['limits'].update(velocity=0.5),
    'knife.limits.speed': lambda tree: tree['knife']['limits'].update(speed=1.0),
    'master_shaft.speed_cpm': lambda tree: tree['master_shaft'].update(speed_cpm='fast'),
    'master_shaft.rate_hz': lambda tree: tree['master_shaft'].update(rate_hz=float('inf')),
    'feeder_drive.axis': lambda tree: tree['feeder_drive'].update(axis='feder'),
    'line.axes': lambda tree: tree['line'].update(axes=['feeder', 'press', 'knife', 'feeder']),
    'knife.cycle': lambda tree: tree['knife']['back'].update(lift=-0.07),
}


@pytest.fixture
def broken(tmp_path, machine_file):
    """Give a function that writes the machine file with some things broken."""
    def write(*paths):
        tree = yaml.safe_load(machine_file.read_text())
        for path in paths:
            BROKEN[path]({name: body['ros__parameters'] for name, body in tree.items()})
        file = tmp_path / 'broken.yaml'
        file.write_text(yaml.safe_dump(tree))
        return file
    return write


def segment(data, axis, name):
    """Find a segment in the JSON of a check."""
    return next(s for s in data['axes'][axis]['segments'] if s['name'] == name)


def test_cutting_machine_has_the_peaks_of_document_001(cam_motion, read_json, machine_file):
    done = cam_motion('check', machine_file, '--json')
    data = read_json(done.stdout)
    feed = segment(data, 'feeder', 'feed')
    assert (done.returncode, data['problems']) == (0, [])
    assert feed['law'] == 'modified_trapezoid'
    assert (feed['start_deg'], feed['end_deg'], feed['lift']) == (0.0, 80.0, 0.3)
    assert feed['peak_velocity'] == pytest.approx(9.0, rel=1e-12)
    assert feed['peak_acceleration'] == pytest.approx(329.95, rel=ROUNDED_ON_THE_SLIDE)
    assert feed['peak_jerk'] == pytest.approx(
        32.0 * math.pi ** 2 / (2.0 + math.pi) * 0.3 / (0.3 * 80.0 / 360.0) ** 3)
    assert segment(data, 'press', 'open')['peak_velocity'] == pytest.approx(-16 / 15)
    assert data['axes']['feeder']['advance'] == 0.3
    assert data['axes']['press']['advance'] == 0.0


def test_highest_speed_and_what_holds_it_back(cam_motion, read_json, machine_file):
    data = read_json(cam_motion('check', machine_file, '--json').stdout)
    feeder = data['axes']['feeder']
    peak = segment(data, 'feeder', 'feed')['peak_acceleration']
    assert feeder['max_speed_cpm'] == pytest.approx(200.0 * (400.0 / peak) ** 0.5, rel=1e-12)
    assert feeder['limited_by'] == 'feed: acceleration 400 m/s² at 10 deg'
    assert data['line'] == {'max_speed_cpm': feeder['max_speed_cpm'], 'axis': 'feeder'}


def test_constant_acceleration_has_270_and_infinite_jerk(cam_motion, read_json, tmp_path):
    file = tmp_path / 'slide.yaml'
    file.write_text(
        'master_shaft: {ros__parameters: {speed_cpm: 200.0}}\n'
        'feeder: {ros__parameters: {cycle: accumulate, segments: [feed, wait], feed: {law: '
        'constant_acceleration, end_deg: 80.0, lift: 0.3}, wait: {end_deg: 360.0}}}\n')
    done = cam_motion('check', file, '--json')
    data = read_json(done.stdout)
    feed = segment(data, 'feeder', 'feed')
    assert done.returncode == 0
    assert feed['peak_velocity'] == pytest.approx(9.0, rel=1e-12)
    assert feed['peak_acceleration'] == pytest.approx(270.0, rel=1e-12)
    assert feed['peak_jerk'] is None
    assert data['axes']['feeder']['max_speed_cpm'] is None
    assert data['axes']['feeder']['limited_by'] is None
    assert '∞' in cam_motion('check', file).stdout


def test_each_joint_tells_its_class_and_its_step(cam_motion, read_json, machine_file):
    data = read_json(cam_motion('check', machine_file, '--json').stdout)
    assert data['runs_at_set_speed'] and data['stepping'] == {}
    feeder = data['axes']['feeder']
    found = feeder['continuity']
    assert feeder['runs_at_set_speed']
    assert (found['class'], found['order'], found['at_deg']) == ('C2', 3, 0.0)
    assert [(j['before'], j['after'], j['class']) for j in found['joints']] == [
        ('wait', 'feed', 'C2'), ('feed', 'wait', 'C2')]
    jerk = segment(data, 'feeder', 'feed')['peak_jerk']
    assert [j['step'] for j in found['joints']] == pytest.approx([jerk, -jerk], rel=1e-12)
    assert found['joints'][0]['geometric_step'] == pytest.approx(
        jerk / (200.0 * math.pi / 30.0) ** 3, rel=1e-12)
    assert found['joints'][0]['inside']['class'] == 'C3'
    assert found['joints'][1]['inside'] is None
    text = cam_motion('check', machine_file).stdout
    assert 'feeder: class C2, the jerk steps' in text and 'feeder runs at 200 cycles/min' in text
    assert 'wait | feed' in text and '6.77 m/rad³' in text and '62194 m/s³' in text


def test_an_axis_beyond_its_limits_does_not_run(cam_motion, read_json, machine_file):
    data = read_json(cam_motion('check', machine_file, '--speed-cpm', 225, '--json').stdout)
    assert not data['runs_at_set_speed'] and not data['axes']['feeder']['runs_at_set_speed']
    assert data['axes']['knife']['runs_at_set_speed']
    done = cam_motion('check', machine_file, '--speed-cpm', 225)
    assert 'feeder does not run at 225 cycles/min' in done.stdout


def test_a_cam_whose_velocity_steps_is_refused_with_its_joints(cam_motion, read_json, tmp_path):
    file = tmp_path / 'step.yaml'
    file.write_text(
        'master_shaft: {ros__parameters: {speed_cpm: 60.0}}\n'
        'slide: {ros__parameters: {segments: [out, wait, back], '
        'out: {law: constant_velocity, end_deg: 90.0, lift: 0.5}, wait: {end_deg: 180.0}, '
        'back: {law: cubic, end_deg: 360.0, lift: -0.5}}}\n')
    done = cam_motion('check', file, '--json')
    data = read_json(done.stdout)
    assert done.returncode == 2 and data['axes'] == {} and not data['runs_at_set_speed']
    found = data['stepping']['slide']['cam']
    assert [joint['class'] for joint in found['joints']] == ['C0', 'C0', 'C1']
    # 0.5 m in a quarter of a second
    assert [joint['step'] for joint in found['joints'][:2]] == pytest.approx([2.0, -2.0])
    text = cam_motion('check', file).stdout
    assert 'slide: class C0, the velocity steps, first at 0 deg' in text


def test_another_speed_scales_the_peaks_and_can_break_limits(cam_motion, read_json, machine_file):
    at_100 = read_json(cam_motion('check', machine_file, '--json', '--speed-cpm', 100).stdout)
    assert segment(at_100, 'feeder', 'feed')['peak_velocity'] == pytest.approx(4.5, rel=1e-12)
    backwards = read_json(cam_motion('check', machine_file, '--json', '--speed-cpm=-100').stdout)
    assert segment(backwards, 'feeder', 'feed')['peak_velocity'] == pytest.approx(-4.5)
    done = cam_motion('check', machine_file, '--speed-cpm', 225)
    assert done.returncode == 2
    assert 'feeder.limits.acceleration' in done.stderr
    assert '! 417.59' in done.stdout


def test_every_problem_is_reported_once_with_its_rule(cam_motion, read_json, broken):
    file = broken(*BROKEN)
    done = cam_motion('check', file, '--json')
    problems = read_json(done.stdout)['problems']
    paths = [problem['path'] for problem in problems]
    assert done.returncode == 2
    # whether a limit is kept cannot be judged: the speed is broken too
    assert set(BROKEN) - {'knife.limits.velocity'} == set(paths)
    assert len({(p['path'], p['rule']) for p in problems}) == len(problems)
    assert all(p['rule'] for p in problems)


@pytest.mark.parametrize('path', BROKEN)
def test_a_single_problem_is_found_at_its_path(cam_motion, read_json, broken, path):
    done = cam_motion('check', broken(path), '--json')
    found = {problem['path'] for problem in read_json(done.stdout)['problems']}
    assert (done.returncode, found) == (2, {path})


def test_axes_that_can_be_built_are_reported_beside_problems(cam_motion, read_json, broken):
    data = read_json(cam_motion('check', broken('feeder.feed.end_deg'), '--json').stdout)
    assert list(data['axes']) == ['press', 'knife']


def test_people_read_path_value_rule_and_way_out(cam_motion, broken):
    done = cam_motion('check', broken('press.close.law'))
    assert 'press.close.law' in done.stderr
    assert "'wobble'" in done.stderr
    assert 'a law must be one that is known' in done.stderr
    assert 'modified_trapezoid' in done.stderr
    assert '\x1b' not in done.stderr + done.stdout


def test_tables_fit_a_narrow_terminal(cam_motion, machine_file):
    done = cam_motion('check', machine_file, columns='80')
    assert max(map(len, done.stdout.splitlines())) <= 80
    assert 'modified_trapezoid' in done.stdout
    assert '329.95' in done.stdout


@pytest.mark.parametrize('content', [
    None, b'', b'{', b'a: [1,', b'\x00\x01\x02\xff', b'just text', b'- 1\n- 2\n', b'line: 3\n',
    b'line: {ros__parameters: {axes: 7}}\n', b'a: &a\n  ros__parameters: *a\n',
    b'a: 2026-13-45\n', b'{[1]: 2}\n', b'\xef\xbb\xbf', b'a: !!python/object:os.system {}\n',
    b'x: {ros__parameters: {segments: [a], a: {end_deg: ' + b'9' * 5000 + b'}}}\n',
    b'x: {ros__parameters: {segments: [a], a: {end_deg: 1e308, lift: 1e308, law: cubic}}}\n',
    b'[' * 2000,
])
def test_no_file_however_bad_makes_a_traceback(cam_motion, read_json, tmp_path, content):
    file = tmp_path / 'bad.yaml'
    if content is not None:
        file.write_bytes(content)
    for arguments in ([], ['--json']):
        done = cam_motion('check', file, *arguments)
        assert done.returncode == 2, done.stderr
        assert 'Traceback' not in done.stderr
    assert len(read_json(done.stdout)['problems']) >= 1


def test_a_directory_is_one_clean_problem(cam_motion, tmp_path):
    done = cam_motion('check', tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith('1 problem')


@pytest.mark.parametrize('arguments', [
    [], ['fly'], ['check'], ['check', 'x.yaml', '--speed-cpm', 'nan'], ['laws', '--colour'],
    ['line', 'x.yaml', '--seconds', '-1'], ['record', 'x.yaml'],
])
def test_a_wrong_command_line_exits_with_2(cam_motion, arguments):
    done = cam_motion(*arguments)
    assert done.returncode == 2
    assert 'usage:' in done.stderr


STEPS = """
line: {ros__parameters: {master: master_shaft, axes: [ax]}}
master_shaft: {ros__parameters: {speed_cpm: 60.0}}
ax:
  ros__parameters:
    unit: m
    segments: [a, b, c, d]
    a: {end_deg: 60.0}
    b: {law: simple_harmonic, end_deg: 180.0, lift: 0.1}
    c: {end_deg: 240.0}
    d: {law: cycloidal, end_deg: 360.0, lift: -0.1}
"""


def test_a_law_whose_acceleration_steps_at_a_joint_is_warned_of(cam_motion, read_json, tmp_path):
    file = tmp_path / 'steps.yaml'
    file.write_text(STEPS)
    done = cam_motion('check', file, '--json')
    data = read_json(done.stdout)
    assert done.returncode == 0 and data['problems'] == [] and data['runs_at_set_speed']
    assert [(each['path'], each['value']) for each in data['warnings']] == [
        ('ax.b.law', 'simple_harmonic')] * 2
    assert ['at 60 deg' in each['rule'] or 'at 180 deg' in each['rule']
            for each in data['warnings']] == [True, True]
    assert '4.441 m/s² at 60 cycles/min' in data['warnings'][0]['rule']
    assert 'simple_harmonic is not legal from rest to rest' in data['warnings'][0]['rule']
    legal = data['warnings'][0]['hint'].partition(': ')[2].split(', ')
    assert {'modified_sine', 'polynomial_345', 'auto'} <= set(legal)
    assert not {'simple_harmonic', 'cubic', 'constant_velocity'} & set(legal)
    text = cam_motion('check', file)
    assert text.returncode == 0 and f'no problems in {file}, 2 warnings' in (
        ' '.join(text.stdout.split()))
    assert text.stdout.count('warning: ax.b.law') == 2 and text.stdout.count('legal there') == 1


def test_the_joints_of_a_refused_cam_have_the_unit_of_the_file(cam_motion, tmp_path):
    file = tmp_path / 'line.yaml'
    file.write_text(STEPS.replace('simple_harmonic', 'constant_velocity'))
    done = cam_motion('check', file)
    assert done.returncode == 2 and 'm/rad' in done.stdout and 'unit/' not in done.stdout


@pytest.mark.parametrize(('path', 'value', 'said'), [
    ('motor.breakdown_torque', 20.0, 'at rest it gives 59.2 N m at the cam shaft, and the static'),
    ('motor.breakdown_torque', 1.0, 'no periodic motion near 400 rpm'),
    ('nominal_rpm', 4000.0, '-89.7 % off the nominal 4000 rpm'),
])
def test_a_cam_drive_that_cannot_do_its_work_is_warned_of(
        cam_motion, read_json, tmp_path, machine_file, path, value, said):
    data = yaml.safe_load(machine_file.with_name('cam_press_drive.yaml').read_text())
    at = data['press_drive']['ros__parameters']
    *above, last = path.split('.')
    for key in above:
        at = at[key]
    at[last] = value
    file = tmp_path / 'press.yaml'
    file.write_text(yaml.safe_dump(data))
    found = read_json(cam_motion('check', file, '--json').stdout)
    assert any(said in each['rule'] for each in found['warnings']
               if each['path'] == 'press_drive')
    done = cam_motion('check', file)
    assert (done.returncode, done.stderr) == (0, '')
    assert 'warning: press_drive: ' in done.stdout and said in ' '.join(done.stdout.split())
