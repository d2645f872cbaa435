# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``contour``: figures, files, and exit code 2 for a cam that cannot be made."""

from pathlib import Path

import pytest

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config'
DISCS = CONFIG / 'cam_disc.yaml'
PICTURE = b'\x89PNG'


@pytest.fixture
def small(tmp_path):
    """Give a machine file whose press cam is too small."""
    path = tmp_path / 'small.yaml'
    path.write_text(DISCS.read_text().replace('base_radius: 0.040', 'base_radius: 0.020'))
    return path


def test_json_holds_the_figures_of_a_disc(cam_motion, read_json):
    done = cam_motion('contour', DISCS, 'press_cam', '--json')
    assert done.returncode == 0
    data = read_json(done.stdout)
    assert list(data) == ['press_cam']
    cam = data['press_cam']
    assert cam['base_radius'] == 0.04 and not cam['undercuts']
    assert cam['pressure_angle_deg']['at_deg'] == pytest.approx(57.1166, abs=1e-3)
    assert cam['smallest_base_radius']['binding'] == 'pressure_angle'
    assert cam['smallest_base_radius']['value'] == pytest.approx(0.0271953756, abs=1e-9)
    assert cam['contact_force']['lift_off_at_deg'] == pytest.approx(150.0, abs=1e-6)
    assert 'files' not in cam


def test_the_table_is_for_people(cam_motion):
    done = cam_motion('contour', DISCS)
    assert done.returncode == 0
    for text in ('press_cam: press, translating roller, counterclockwise',
                 'tucker_cam: tucker, swinging flat, clockwise', 'least width of the face',
                 '25.2546  deg  57.117 deg', 'lift-off speed', '752.831  rpm',
                 'smallest base circle: 27.195376 mm (pressure_angle at 53.5888 deg)',
                 'groove: the roller cannot lift off'):
        assert text in done.stdout


def test_the_cam_of_a_drive_shows_its_periodic_motion(cam_motion, read_json):
    done = cam_motion('contour', CONFIG / 'cam_press_drive.yaml', '--json')
    force = read_json(done.stdout)['press_drive']['contact_force']
    assert force['least_on_orbit']['value'] == pytest.approx(774.149, abs=1e-2)
    done = cam_motion('contour', CONFIG / 'cam_press_drive.yaml')
    assert 'least in the periodic motion' in done.stdout


def test_a_directory_gets_every_file_of_a_disc(cam_motion, read_json, tmp_path):
    done = cam_motion('contour', DISCS, 'valve_cam', '-o', tmp_path / 'out', '--json',
                      '--tolerance', '1e-5', '--at', '40')
    files = read_json(done.stdout)['valve_cam']['files']
    assert set(files) == {'csv', 'dxf', 'png'}
    for kind, held in files.items():
        assert Path(held['file']) == tmp_path / 'out' / f'valve_cam.{kind}'
        assert Path(held['file']).stat().st_size > 1000
    assert files['csv']['deviation'] <= 1e-5 and files['dxf']['spline_deviation'] <= 1e-5
    assert Path(files['png']['file']).read_bytes().startswith(PICTURE)


def test_one_file_of_one_disc_with_its_deviation(cam_motion, tmp_path):
    done = cam_motion('contour', DISCS, 'tucker_cam', '-o', tmp_path / 'a' / 'cam.dxf')
    assert done.returncode == 0
    assert 'mm off the exact contour; spline of' in done.stdout
    assert 'wrote' in done.stdout and (tmp_path / 'a' / 'cam.dxf').exists()


def test_a_cam_that_breaks_its_limits_shows_its_figures_and_leaves_with_2(cam_motion, small):
    done = cam_motion('contour', small, 'press_cam')
    assert done.returncode == 2
    assert 'greatest pressure angle' in done.stdout
    assert 'press_cam.limits.pressure_angle_deg' in done.stderr
    assert 'take a base_radius of at least 0.0271954 m' in done.stderr
    done = cam_motion('check', small)
    assert done.returncode == 2 and 'press_cam.limits.pressure_angle_deg' in done.stderr


def test_check_tells_of_the_discs(cam_motion, read_json):
    done = cam_motion('check', DISCS)
    assert done.returncode == 0
    assert 'cam disc press_cam: pressure angle -18.62 to 25.25 deg' in done.stdout
    data = read_json(cam_motion('check', DISCS, '--json').stdout)
    assert data['cam_discs']['press_cam']['lift_off_rpm'] == pytest.approx(752.8314, abs=1e-3)


@pytest.mark.parametrize(('arguments', 'said'), [
    (('nobody',), 'known are: press_cam, valve_cam'),
    (('-o', 'cam.dxf'), 'one file holds one disc'),
    (('press_cam', '-o', 'cam.step'), 'must be a directory, or end in .csv'),
    (('press_cam', '-o', 'cam.csv', '--tolerance', '0'), 'tolerance'),
    (('--tolerance', '-1'), 'tolerance'), (('--tolerance', '1'), 'at most 0.01'),
])
def test_wrong_arguments_are_refused(cam_motion, tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    done = cam_motion('contour', DISCS, *arguments)
    assert done.returncode == 2 and said in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_what_nothing_limits_and_nobody_needs_is_said_so(cam_motion, read_json):
    drive = CONFIG / 'cam_press_drive.yaml'
    said = cam_motion('contour', drive).stdout
    assert 'smallest base circle: not limited' in said
    preload, = (line for line in said.splitlines() if 'preload needed at 400 rpm' in line)
    assert preload.split()[-1] == 'none'
    stiffness, = (line for line in said.splitlines() if 'stiffness needed at 400 rpm' in line)
    assert '4006.62' in stiffness
    cam = read_json(cam_motion('contour', drive, '--json').stdout)['press_drive']
    assert cam['smallest_base_radius']['value'] == 0.0
    assert cam['contact_force']['preload_needed'] == {'value': 0.0, 'at_deg': None}
    assert cam['contact_force']['stiffness_needed']['value'] == pytest.approx(4006.62, abs=0.01)


def test_radii_of_curvature_and_from_the_shaft_have_names_of_their_own(cam_motion):
    said = cam_motion('contour', DISCS, 'press_cam').stdout
    assert 'least radius of curvature' in said and 'farthest from the shaft' in said
    assert 'radius of the contour' not in said
    assert 'least radius of curvature' in cam_motion('check', DISCS).stdout


def test_a_machine_without_discs_is_told_so(cam_motion):
    done = cam_motion('contour', CONFIG / 'cutting_machine.yaml')
    assert done.returncode == 2 and 'holds no cam disc' in done.stderr


def test_what_is_wrong_with_an_axis_is_said_first(cam_motion, tmp_path):
    path = tmp_path / 'wrong.yaml'
    path.write_text(DISCS.read_text().replace('law: polynomial_345, end_deg: 80.0',
                                              'law: polynomial_346, end_deg: 80.0'))
    done = cam_motion('contour', path)
    assert done.returncode == 2
    assert done.stderr.index('valve.open.law') < done.stderr.index('valve_cam.profile')
