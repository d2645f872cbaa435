# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``size``: what it ranks, what it says of the rest, and how it refuses."""

from pathlib import Path

import pytest
import yaml

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config'
PRESS, FEEDING = CONFIG / 'cam_press_drive.yaml', CONFIG / 'feeding_group.yaml'
CUTTING = CONFIG / 'cutting_machine.yaml'
FEW = ('--ratios', '3.5525,3.8', '--flywheels', '0.06,0.1')


@pytest.fixture
def small(tmp_path):
    """Write a catalogue of few motors, so that sizing takes no time."""
    source = {'source': 'sheet'}
    file = tmp_path / 'small.yaml'
    file.write_text(yaml.safe_dump({
        'sources': {'sheet': {'title': 'A data sheet', 'publisher': 'A maker'}},
        'servo_motors': {
            name: {**source, 'rated_torque': torque, 'rated_rpm': 2000, 'peak_torque': 4 * torque,
                   'max_rpm': 2000, 'inertia': 0.034}
            for name, torque in (('weak', 10.0), ('strong', 120.0))},
        'induction_motors': {
            name: {**source, 'synchronous_rpm': 1500, 'rated_rpm': 1421,
                   'rated_torque': torque, 'breakdown_torque': 2.7 * torque,
                   'starting_torque': 2.5 * torque, 'inertia': 0.0028}
            for name, torque in (('slight', 2.0), ('right', 10.1))},
    }))
    return file


def test_the_press_is_sized_by_periodic_motions(cam_motion, read_json):
    done = cam_motion('size', PRESS, *FEW, '--json')
    assert (done.returncode, done.stderr) == (0, '')
    data = read_json(done.stdout)
    assert data['drives'] == {'press_drive': {
        key: value for key, value in data.items() if key != 'drives'}}
    assert (data['method'], data['objective']) == ('forward', 'power')
    assert data['candidates'] == len(data['ranked']) + len(data['rejected']) == 4 * 2 * 2
    best = data['ranked'][0]
    assert (best['motor'], best['ratio'], best['flywheel']) == ('NM 90L-4', 3.8, 0.1)
    assert best['fluctuation_pct'] < 5.0 and 'broke' not in best
    # the document's own choice fluctuates by 5.77 %, as simulate says, and 5 % are wanted
    [own] = [one for one in data['rejected'] if (one['motor'], one['ratio'], one['flywheel'])
             == ('NM 90L-4', 3.5525, 0.06)]
    assert own['broke'] == [{
        'rule': 'fluctuation', 'value': pytest.approx(5.76756715, rel=1e-5), 'bound': 5.0,
        'unit': '%', 'by_pct': pytest.approx(15.351343, rel=1e-4)}]
    assert own['margins']['fluctuation'] == pytest.approx(-15.351343, rel=1e-4)
    smallest = data['smallest_flywheel']
    assert (smallest['motor'], smallest['ratio']) == ('NM 90L-4', 3.8)
    assert smallest['fluctuation_pct'] == pytest.approx(5.0, rel=1e-6)
    assert 0.06 < smallest['flywheel'] < 0.1
    assert 'Middle East Technical University' in data['sources']['NM 90L-4']


def test_the_feeding_group_is_sized_by_inverse_dynamics(cam_motion, read_json, small):
    done = cam_motion('size', FEEDING, '--catalogue', small, '--ratios', '2,5', '--json')
    assert (done.returncode, done.stderr) == (0, '')
    data = read_json(done.stdout)
    assert (data['method'], data['smallest_flywheel']) == ('inverse', None)
    [best] = data['ranked']
    assert (best['motor'], best['gearbox'], best['ratio']) == ('strong', 'other ratio', 5.0)
    assert best['flywheel'] is None
    assert best['inertia_ratio'] == pytest.approx(1.164 / 25.0 / 0.034)
    assert set(best['margins']) == {'peak_torque', 'rms_torque', 'speed', 'inertia_ratio'}
    assert data['rejections'] == {'rms_torque': 3, 'peak_torque': 2}
    for one in data['rejected']:
        for check in one['broke']:
            assert check['value'] > check['bound']
            assert check['by_pct'] == pytest.approx(
                100.0 * (check['value'] / check['bound'] - 1.0))


def test_the_catalogue_that_comes_along_has_a_motor_for_the_feeding_group(cam_motion):
    done = cam_motion('size', FEEDING, '--ratios', '5')
    assert done.returncode == 0, done.stdout + done.stderr
    assert 'FKM 96.20A' in done.stdout and 'sales440/fxm-fkm-converter' in done.stdout
    assert 'smallest flywheel' not in done.stdout


def test_a_machine_without_a_fitting_candidate_says_what_rejects_and_the_nearest_miss(
        cam_motion, read_json, small):
    done = cam_motion('size', CUTTING, '--catalogue', small)
    assert (done.returncode, done.stderr) == (1, '')
    said = ' '.join(done.stdout.split())
    assert 'feeder_drive: 26 candidates by inverse dynamics, 0 keep every rule' in said
    assert 'Nothing fits: peak_torque rejects the most, 26 of 26. The nearest miss: str' in said
    assert 'rms_torque: ' in said and ' allowed: off by ' in said
    done = cam_motion('size', CUTTING, '--catalogue', small, '--json')
    data = read_json(done.stdout)
    assert (done.returncode, data['ranked'], data['candidates']) == (1, [], 26)
    assert list(data['rejections'].values()) == sorted(data['rejections'].values(), reverse=True)
    assert next(iter(data['rejections'])) == 'peak_torque'


@pytest.mark.parametrize('columns', ['80', '120'])
@pytest.mark.parametrize('arguments', [(PRESS, *FEW), (FEEDING, '--ratios', '2,5')])
def test_tables_show_names_and_headings_whole(cam_motion, small, columns, arguments):
    done = cam_motion('size', *arguments, '--catalogue', small, columns=columns)
    assert done.returncode == 0, done.stderr
    assert all(len(line.rstrip()) <= int(columns) for line in done.stdout.splitlines())
    for said in ('as configured', 'gearbox', 'margin', 'rejected', 'rms_torque', 'broken by'):
        assert said in done.stdout
    if arguments[0] == PRESS:
        assert 'right' in done.stdout and 'flywheel' in done.stdout
        assert ('work' in done.stdout) == (columns == '120')
        assert 'smallest flywheel for a fluctuation of 5 %: 0.0' in done.stdout


def test_top_shows_the_best_and_all_shows_every_rejected_one(cam_motion, small):
    arguments = ('size', PRESS, '--catalogue', small, '--ratios', '3.5,3.6,3.7', '--flywheels',
                 '0.1:0.4:3')
    one = cam_motion(*arguments, '--top', '1').stdout
    every = cam_motion(*arguments, '--all').stdout
    assert '1 of 12, ranked by: smallest rated power' in one
    assert '12 of 12' in every
    assert 'rejected, the nearest miss first' not in one
    assert 'rejected, the nearest miss first' in every
    listed = ' '.join(every.split())
    assert 'slight, ratio 3.7, flywheel 0.4 kg m²' in listed
    assert 'starts_from_rest: ' in listed and 'N m, at least ' in listed


def test_without_a_periodic_motion_the_torques_say_why(cam_motion, read_json, small):
    done = cam_motion('size', PRESS, '--catalogue', small, '--ratios', '1', '--flywheels', '0',
                      '--json')
    data = read_json(done.stdout)
    assert done.returncode == 1
    [slight] = [one for one in data['rejected'] if one['motor'] == 'slight']
    first = slight['broke'][0]
    assert first['rule'] == 'periodic_motion' and first['value'] < first['bound']
    assert first['by_pct'] == pytest.approx(100.0 * (1.0 - first['value'] / first['bound']))
    assert 'fluctuation_pct' not in slight
    # nothing of the catalogue turns it: the search is made for the configured drive
    assert data['smallest_flywheel']['motor'] == 'as configured'
    assert data['smallest_flywheel']['flywheel'] == pytest.approx(0.07144, rel=1e-3)
    text = cam_motion('size', PRESS, '--catalogue', small, '--ratios', '1', '--flywheels', '0',
                      '--all').stdout
    assert 'periodic_motion: none; the motor gives up to' in ' '.join(text.split())


@pytest.mark.parametrize(('wanted', 'said'), [
    ('25', 'a fluctuation of 25 % needs no flywheel'), ('0.01', 'none up to 2.8 kg m²; ')])
def test_a_fluctuation_held_anyway_or_out_of_reach_is_said(cam_motion, small, wanted, said):
    done = cam_motion('size', PRESS, '--catalogue', small, *FEW, '--fluctuation', wanted)
    assert said in done.stdout


def test_objectives_order_differently(cam_motion, read_json, small):
    tried = ('--catalogue', small, '--ratios', '3.6,3.7', '--flywheels', '0.08,0.2', '--json')
    best = {objective: read_json(cam_motion(
        'size', PRESS, *tried, '--objective', objective).stdout)['ranked'][0]
        for objective in ('flywheel', 'fluctuation', 'energy', 'margin')}
    assert best['flywheel']['flywheel'] == 0.08
    assert best['fluctuation']['flywheel'] == 0.2
    assert best['energy']['motor_work_per_cycle'] <= min(
        one['motor_work_per_cycle'] for one in best.values())
    assert best['margin']['least_margin_pct'] >= max(
        one['least_margin_pct'] for one in best.values())


def test_several_processes_find_the_same(cam_motion, small):
    arguments = ('size', PRESS, '--catalogue', small, *FEW, '--json')
    alone, shared = cam_motion(*arguments), cam_motion(*arguments, '--workers', '2')
    assert (shared.returncode, shared.stdout) == (alone.returncode, alone.stdout)


def test_a_servo_motor_of_the_machine_file_is_a_candidate_and_does_what_simulate_says(
        cam_motion, read_json, small):
    machine = CONFIG / 'feeding_group_servo.yaml'
    found = read_json(cam_motion(
        'size', machine, '--catalogue', small, '--ratios', '9', '--json').stdout)
    [own] = [one for one in found['ranked'] + found['rejected']
             if one['motor'] == 'as configured']
    exact = read_json(cam_motion('simulate', machine, '--json').stdout)
    for name in ('peak_torque', 'rms_torque', 'peak_speed_rpm', 'inertia_ratio',
                 'motor_work_per_cycle', 'regenerated_energy_per_cycle'):
        assert own[name] == pytest.approx(exact[name], rel=1e-9), name


@pytest.mark.parametrize('arguments', [
    (PRESS, *FEW), (PRESS, '--ratios', '0.2', '--flywheels', '0'), (FEEDING, '--ratios', '2,5')])
def test_a_picture_is_drawn_and_said(cam_motion, small, tmp_path, arguments):
    done = cam_motion('size', *arguments, '--catalogue', small, '-o', tmp_path / 'out')
    [file] = (tmp_path / 'out').iterdir()
    assert file.read_bytes().startswith(b'\x89PNG') and file.name.startswith('size_')
    assert f'wrote {file}' in done.stdout


@pytest.mark.parametrize(('arguments', 'said'), [
    (('--drive', 'ghost'), 'feeder_drive'), (('--objective', 'flywheel'), 'inverse'),
    (('--objective', 'beauty'), 'invalid choice'), (('--ratios', '0'), 'above 0'),
    (('--ratios', '3:4:99999999'), 'at most 10000'),
    (('--ratios', '3,x'), 'finite'), (('--ratios', '1:5:0'), 'whole number'),
    (('--flywheels=-1',), 'at least 0'), (('--fluctuation', '0'), 'above 0'),
    (('--inertia-ratio', 'nan'), 'finite'), (('--top', '0'), 'above 0'),
    (('--workers', '-1'), 'above 0'), (('--catalogue', 'missing.yaml'), 'cannot be read'),
])
def test_a_bad_command_line_is_refused(cam_motion, arguments, said):
    done = cam_motion('size', FEEDING, *arguments)
    assert done.returncode == 2 and done.stdout == ''
    assert said in done.stderr and 'Traceback' not in done.stderr


def test_a_catalogue_without_the_kind_of_motor_that_is_needed_is_refused(cam_motion, tmp_path):
    file = tmp_path / 'none.yaml'
    file.write_text('sources: {}\nservo_motors: {}\n')
    for machine, kind in ((FEEDING, 'servo_motors'), (PRESS, 'induction_motors')):
        done = cam_motion('size', machine, '--catalogue', file)
        assert done.returncode == 2 and kind in done.stderr
