# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``simulate``: its figures, its pictures, and how it refuses what cannot work."""

from pathlib import Path

import pytest
import yaml

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config'
PRESS, FEEDING = CONFIG / 'cam_press_drive.yaml', CONFIG / 'feeding_group.yaml'


@pytest.fixture
def broken(tmp_path):
    """Give a function that writes the press drive's configuration with some values changed."""
    def write(changes, section='press_drive'):
        data = yaml.safe_load(PRESS.read_text())
        for path, value in changes.items():
            *above, last = path.split('.')
            at = data[section]['ros__parameters']
            for key in above:
                at = at[key]
            at[last] = value
        file = tmp_path / 'broken.yaml'
        file.write_text(yaml.safe_dump(data, allow_unicode=True))
        return file
    return write


def test_press_drive_by_its_motion_and_by_the_documents_definitions(cam_motion, read_json):
    done = cam_motion('simulate', PRESS, '--json')
    assert done.returncode == 0, done.stderr
    data = read_json(done.stdout)
    assert set(data) == {'orbit', 'start_up', 'document', 'warnings', 'drives'}
    assert data['drives'] == {'press_drive': {
        key: value for key, value in data.items() if key != 'drives'}}
    assert data['warnings'] == []
    # the periodic motion, by two solvers that agree to 1e-8
    # where the force is least is a flat place
    assert data['orbit'].pop('min_contact_force_deg') == pytest.approx(322.872, abs=0.01)
    assert data['start_up'].pop('min_contact_force_deg') == pytest.approx(340.344, abs=0.01)
    assert data['orbit'] == pytest.approx({
        'fluctuation_pct': 5.76756715, 'stability_pct': 84.06723792,
        'running_cost_pct': 9.45952673, 'period_s': 0.14506626, 'min_speed_rpm': 401.04650223,
        'max_speed_rpm': 424.11677083, 'min_contact_force': 774.14855577,
        'mean_speed_rpm': 60.0 / data['orbit']['period_s'],
        'motor_work_per_cycle': 76.38384606, 'drawn_work_per_cycle': 79.09396822,
        'peak_gearbox_torque': 68.38390280}, rel=1e-8)
    assert data['start_up'] == pytest.approx({
        'first_crossing_s': 0.65131034, 'settled_s': 0.74384388,
        'min_contact_force': 514.194993,
        'followed_s': 3.00054909, 'start_torque': 80.71275, 'static_load_peak': 72.42114},
        rel=1e-6)
    # printed in document 004, to its digits
    printed = {'steady_state_time_s': 0.6513, 'stability_pct': 84.0363,
               'fluctuation_pct': 5.8038, 'running_cost_pct': 9.4831,
               'min_contact_force': 514.2013, 'max_pressure_angle_deg': 25.2536,
               'max_torque_estimate': 70.6292}
    assert {key: round(value, 4) for key, value in data['document'].items()} == printed


def test_feeding_group_by_document_001(cam_motion, read_json):
    done = cam_motion('simulate', FEEDING, '--json')
    assert done.returncode == 0, done.stderr
    data = read_json(done.stdout)
    assert set(data) == {'peak_torque', 'rms_torque', 'peak_speed_rpm', 'inertia_ratio',
                         'regenerated_energy_per_cycle', 'motor_work_per_cycle', 'drives'}
    assert data['peak_torque'] == pytest.approx(391.765, abs=5e-4)
    assert data['peak_speed_rpm'] == pytest.approx(641.371, abs=5e-4)
    # without losses what remains is the work against the resistance, 500 N over 0.3 m
    assert data['motor_work_per_cycle'] == pytest.approx(500.0 * 0.3, rel=1e-12)
    assert data['rms_torque'] == pytest.approx(147.111076, rel=1e-8)
    assert data['regenerated_energy_per_cycle'] == pytest.approx(582.471466, rel=1e-8)
    assert data['inertia_ratio'] is None  # the document gives no inertia of the motor


def test_tables_name_figures_and_units_and_say_why_definitions_differ(cam_motion):
    done = cam_motion('simulate', PRESS)
    assert done.returncode == 0, done.stderr
    for said in ('press_drive', 'periodic motion', 'start-up from rest', '774.149', '514.201',
                 'lost again until 0.7438 s'):
        assert said in ' '.join(done.stdout.split())
    assert 'wrote' not in done.stdout


def test_pictures_of_a_cam_drive_are_written_and_listed(cam_motion, read_json, tmp_path):
    done = cam_motion('simulate', PRESS, '--no-document', '--json', '-o', tmp_path / 'out')
    assert done.returncode == 0, done.stderr
    data = read_json(done.stdout)
    names = ['cam', 'load', 'motor', 'start_up', 'orbit', 'flywheel']
    assert data['files'] == [str(tmp_path / 'out' / f'{name}_press_drive.png') for name in names]
    assert all(Path(file).read_bytes().startswith(b'\x89PNG') for file in data['files'])
    assert 'document' not in data


def test_pictures_of_a_drive_that_follows_are_written_and_said(cam_motion, tmp_path):
    done = cam_motion('simulate', FEEDING, '--output', tmp_path)
    assert done.returncode == 0, done.stderr
    assert [file.name for file in tmp_path.iterdir()] == ['torque_feeder_drive.png']
    assert f'wrote {tmp_path / "torque_feeder_drive.png"}' in done.stdout


def test_a_place_that_cannot_be_written_is_said(cam_motion, tmp_path):
    (tmp_path / 'file').write_text('')
    done = cam_motion('simulate', FEEDING, '-o', tmp_path / 'file')
    assert (done.returncode, 'cannot be written' in done.stderr) == (1, True)
    assert 'Traceback' not in done.stderr


@pytest.mark.parametrize(('changes', 'path', 'rule'), [
    ({'motor.inertia': -0.0028}, 'press_drive.motor.inertia', 'above 0'),
    ({'gearbox.inertia': -1e-3}, 'press_drive.gearbox.inertia', 'at least 0'),
    ({'cam.inertia': -0.02}, 'press_drive.cam.inertia', 'at least 0'),
    ({'flywheel': -0.01}, 'press_drive.flywheel', 'at least 0'),
    ({'gearbox.efficiency': 1.2}, 'press_drive.gearbox.efficiency', '1'),
    ({'gearbox.efficiency': 0.0}, 'press_drive.gearbox.efficiency', 'above 0'),
    ({'gearbox.ratio': 0.0}, 'press_drive.gearbox.ratio', 'above 0'),
    ({'lever.arm': 0.1}, 'press_drive.lever.height', 'within the arm of 0.1 m'),
    ({'lever.window_deg': [150.0, 0.0]}, 'press_drive.lever.window_deg', 'rising'),
    ({'spring.type': 'rubber'}, 'press_drive.spring.type', 'spring'),
    ({'spring': {'stiffness': 1.0}}, 'press_drive.spring.type', ''),
    ({'spring': 3.0}, 'press_drive.spring', ''),
    ({'load': ['ghost']}, 'press_drive.ghost.type', ''),
    ({'load': ['cam', 'slidre', 'spring', 'lever']}, 'press_drive.slider', 'instead of slidre'),
    ({'motor.breakdown_torque': 1e12}, 'press_drive.motor.breakdown_torque', '1e+06'),
    ({'load': 'cam'}, 'press_drive.load', ''),
    ({'motor.breakdown_slip': None}, 'press_drive.motor.a', 'together'),
    ({'motor.rated_rpm': 1500.0}, 'press_drive.motor.rated_rpm', 'synchronous speed of 1500 rpm'),
    ({'motor.starting_torque': 20.0}, 'press_drive.motor.starting_torque', 'leave a and b out'),
    ({'motor.breakdown_slip': 1.0}, 'press_drive.motor.breakdown_slip', ''),
    ({'motor.b': 3.0}, 'press_drive.motor.b', 'finite'),
    ({'motor.synchronous_rpm': float('nan')}, 'press_drive.motor.synchronous_rpm', 'finite'),
    ({'axis': 'ghost'}, 'press_drive.axis', 'follower'),
    ({'nominal_rpm': 0.0}, 'press_drive.nominal_rpm', 'above 0'),
    ({'base_radius': -0.04}, 'press_drive.base_radius', 'above 0'),
])
def test_a_broken_configuration_is_refused_with_path_and_rule(
        cam_motion, broken, changes, path, rule):
    done = cam_motion('simulate', broken(changes), '--no-document')
    assert done.returncode == 2, done.stderr
    assert path in done.stderr
    assert rule in done.stderr
    assert 'Traceback' not in done.stderr


@pytest.mark.parametrize(('changes', 'said'), [
    # 30 N m at the cam shaft against a load of 72: it never comes round
    ({'motor.breakdown_torque': 9.0, 'flywheel': 0.0}, ('no periodic motion', 'N m')),
    ({'motor.breakdown_torque': 1.0}, ('no periodic motion', 'stronger motor')),
    # runs on once it runs, by its flywheel, but cannot lift the load from rest
    ({'motor.breakdown_torque': 13.0, 'flywheel': 0.2}, ('the motor stalls', 'deg')),
])
def test_a_motor_too_weak_is_refused_with_its_figures(cam_motion, broken, changes, said):
    done = cam_motion('simulate', broken(changes), '--no-document', '--json')
    assert (done.returncode, done.stdout) == (1, ''), done.stderr
    assert done.stderr.startswith('cam_motion: press_drive: ')
    assert len(done.stderr.strip().splitlines()) == 1
    assert all(text in done.stderr for text in said), done.stderr
    assert 'Traceback' not in done.stderr


@pytest.mark.parametrize(('changes', 'said'), [
    ({'spring.stiffness': 3000.0}, 'lifts off its cam: the contact force falls to -86.58 N at 15'),
    ({'motor.breakdown_torque': 20.0},
     'at rest it gives 59.2 N m at the cam shaft, and the static load takes up to 72.42 N m'),
    ({'nominal_rpm': 4000.0}, 'turns at 413.6 rpm on average, -89.7 % off the nominal 4000 rpm'),
    ({'gearbox.ratio': 1e6}, 'the start-up is not over within'),
])
def test_what_a_user_must_mind_is_said_with_figures(cam_motion, read_json, broken, changes, said):
    file = broken(changes)
    data = read_json(cam_motion('simulate', file, '--no-document', '--json').stdout)
    assert [text for text in data['warnings'] if said in text]
    done = cam_motion('simulate', file, '--no-document')
    assert done.returncode == 0
    assert 'warning: ' in done.stdout and said in ' '.join(done.stdout.split())


def test_a_start_up_is_followed_until_it_is_over(cam_motion, read_json, broken):
    data = read_json(cam_motion(
        'simulate', broken({'flywheel': 0.4}), '--no-document', '--json').stdout)
    start = data['start_up']
    assert 3.0 < start['first_crossing_s'] <= start['settled_s'] < start['followed_s'] < 60.0
    assert data['warnings'] == []
    never = read_json(cam_motion(
        'simulate', broken({'gearbox.ratio': 1e6}), '--no-document', '--json').stdout)
    assert never['start_up']['settled_s'] is None and never['start_up']['followed_s'] >= 60.0


def test_a_stall_says_the_torques_that_decide(cam_motion, broken):
    done = cam_motion('simulate', broken({'motor.breakdown_torque': 5.0}), '--no-document')
    assert done.returncode == 1
    assert 'gives 14.8 N m' in done.stderr and 'exceed the 72.42 N m' in done.stderr


def test_the_document_s_running_cost_counts_from_the_rated_speed(cam_motion, read_json, broken):
    file = broken({'gearbox.ratio': 3.79684375, 'flywheel': 0.075})
    data = read_json(cam_motion('simulate', file, '--json').stdout)
    assert data['document']['running_cost_pct'] == pytest.approx(10.0013, abs=5e-5)


def test_the_picture_of_a_cam_that_does_not_return_is_refused(cam_motion, broken, tmp_path):
    file = broken({'cycle': 'accumulate', 'back': {'end_deg': 360.0}}, 'follower')
    done = cam_motion('simulate', file, '--no-document', '-o', tmp_path)
    assert done.returncode == 2, done.stdout
    assert 'must return' in done.stderr
    assert 'Traceback' not in done.stderr
