# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``linkage``: the umbrella's figures, its range, and what is refused."""

import json
import math
from pathlib import Path

from cam_motion.mechanism.umbrella import Umbrella
import pytest

pytestmark = pytest.mark.timeout(60)

UMBRELLA = Path(__file__).resolve().parents[2] / 'config' / 'umbrella.yaml'
CLOSED_FORM = 1e-12

SLIDER_CRANK = """
bars:
  ros__parameters:
    type: linkage
    inputs: [turn]
    turn: {start_deg: 60.0}
    unknowns: [theta3, x]
    theta3: {start_deg: -16.8}
    x: {start: 0.337}
    bodies: [crank, rod]
    crank: {angle: turn}
    rod: {angle: theta3}
    vectors: [r, l, s]
    r: {length: 0.1, body: crank}
    l: {length: 0.3, body: rod}
    s: {variable: x}
    loops: [ring]
    ring: {path: [r, l, -s]}
"""


def test_json_holds_angles_velocities_and_points(cam_motion, read_json):
    done = cam_motion('linkage', UMBRELLA, '--json', '--at',
                      'h1=1.0,h2=0.8,h1_dot=-0.3,h2_dot=0.1')
    data = read_json(done.stdout)
    assert done.returncode == 0
    assert list(data) == ['angles_deg', 'omega', 'points']
    assert list(data['angles_deg']) == ['theta2', 'theta3', 'theta5', 'theta6']
    assert list(data['omega']) == ['omega2', 'omega3', 'omega5', 'omega6']
    assert set(data['points']) == set('ABCDEFG')
    assert all(list(point) == ['x', 'y', 'vx', 'vy'] for point in data['points'].values())
    closed = Umbrella()
    assert list(data['angles_deg'].values()) == pytest.approx(
        [math.degrees(angle) for angle in closed.angles(1.0, 0.8)], rel=CLOSED_FORM)
    assert list(data['omega'].values()) == pytest.approx(
        list(closed.angular_velocities(1.0, 0.8, -0.3, 0.1)), rel=CLOSED_FORM)
    assert data['points']['A'] == {'x': 0.0, 'y': 0.0, 'vx': 0.0, 'vy': 0.0}
    assert data['points']['B'] == pytest.approx({'x': 0.0, 'y': -1.0, 'vx': 0.0, 'vy': 0.3})


def test_the_crank_winds_the_spool(cam_motion, read_json):
    by_crank, by_rate = (
        read_json(cam_motion('linkage', UMBRELLA, '--json', '--at', each).stdout)
        for each in ('h2_crank=-5.0', 'h2_dot=-0.1'))
    assert by_crank == by_rate
    assert by_crank['omega']['omega2'] == by_crank['omega']['omega3'] == 0.0


def test_everything_else_is_told_with_all(cam_motion, read_json):
    data = read_json(cam_motion('linkage', UMBRELLA, '--json', '--all').stdout)
    assert data['ranges']['h1']['low'] == pytest.approx(0.2, abs=1e-7)
    assert data['ranges']['h2']['high'] == pytest.approx(math.sqrt(2.24), abs=1e-7)
    assert data['transmission_deg']['rib_angle'] == pytest.approx(53.130102354156)
    assert data['certificate']['kantorovich'] < 0.5


@pytest.mark.parametrize('at, paths', [
    ('h1=2.5', ['--at.h1']), ('h1=2.2', ['--at.h1']), ('h1=0.2', ['--at.h1']),
    ('h2=1.5,h1=0.1', ['--at.h2', '--at.h1']), ('h3=1.0', ['--at.h3']),
    ('h2_dot=0.1,h2_crank=1.0', ['--at.h2_crank']), ('h1_deg=3', ['--at.h1_deg']),
])
def test_an_input_that_cannot_be_used_exits_with_2(cam_motion, at, paths):
    done = cam_motion('linkage', UMBRELLA, '--at', at, '--json')
    assert (done.returncode, done.stdout) == (2, '')
    assert f'{len(paths)} problem' in done.stderr
    assert all(path in done.stderr for path in paths)


def test_a_refusal_uses_the_words_of_the_question(cam_motion, tmp_path):
    file = tmp_path / 'five.yaml'
    file.write_text(FIVE_BAR)
    said = cam_motion('linkage', file, '--at', 'a_deg=250').stderr
    assert '--at.a_deg' in said and '250.0' in said and '4.36' not in said


def test_a_refusal_states_the_range_and_names_the_singular_position(cam_motion):
    said = cam_motion('linkage', UMBRELLA, '--at', 'h1=2.5').stderr
    assert 'from 0.2 m to 2.2 m' in said and 'link2 and link3 come into line' in said


def test_efforts_that_hold_loads_are_those_of_virtual_work(cam_motion, read_json, tmp_path):
    file = tmp_path / 'bars.yaml'
    loads = '    loads: [gas, brake, wind]\n    gas: {variable: x, force: -500.0}\n' \
        '    brake: {variable: theta3, torque: 3.0}\n    wind: {point: P, force_y: 2.0}\n' \
        '    points: [P]\n    P: {path: [r]}\n'
    file.write_text(SLIDER_CRANK + loads)
    at = ('--at', 'turn=1.0,turn_dot=1.0')
    data = read_json(cam_motion('linkage', file, '--json', *at).stdout)
    power = (-500.0 * data['lengths']['x']['rate'] + 3.0 * data['omega']['omega3']
             + 2.0 * data['points']['P']['vy'])
    assert data['efforts'] == pytest.approx({'turn': -power})
    said = cam_motion('linkage', file, *at).stdout
    assert f'turn holds the loads with {-power:.6g} N m' in said
    # a spool winds an input: what its crank holds too
    text = UMBRELLA.read_text() + '\n    loads: [rain]\n    rain: {point: E, force_y: -10.0}\n'
    file.write_text(text)
    data = read_json(cam_motion('linkage', file, '--json').stdout)
    assert data['efforts']['h2'] != 0.0
    assert data['crank_torques'] == pytest.approx({'h2': 0.02 * data['efforts']['h2']})
    assert 'N m at the crank of its spool' in cam_motion('linkage', file).stdout


FIVE_BAR = """
five:
  ros__parameters:
    type: linkage
    inputs: [a, b]
    a: {start_deg: 120.0}
    b: {start_deg: 60.0}
    unknowns: [c, d]
    c: {start_deg: 32.0}
    d: {start_deg: 148.0}
    bodies: [left, right, l2, r2]
    left: {angle: a}
    right: {angle: b}
    l2: {angle: c}
    r2: {angle: d}
    vectors: [A, B, C, D, G]
    A: {length: 1.0, body: left}
    B: {length: 1.0, body: right}
    C: {length: 1.2, body: l2}
    D: {length: 1.2, body: r2}
    G: {length: 1.0}
    loops: [ring]
    ring: {path: [A, C, -D, -B, -G]}
"""


def test_ranges_are_those_at_the_position_asked_for(cam_motion, read_json, tmp_path):
    file = tmp_path / 'five.yaml'
    file.write_text(FIVE_BAR)
    said = cam_motion('linkage', file, '--at', 'a_deg=170,b_deg=100').stdout
    assert 'a: turns through, nothing stops it' in said
    data = read_json(cam_motion(
        'linkage', file, '--at', 'a_deg=170,b_deg=100', '--json', '--all').stdout)
    said = cam_motion('check', file).stdout  # which speaks of the start
    assert 'five, a: above -90.5352 deg' in said and '(with b = 60 deg)' in said
    low, at, high = (math.degrees(each) for each in (
        data['ranges']['b']['low'], data['inputs']['b'], data['ranges']['b']['high']))
    assert low < at < high and data['ranges']['a']['low'] is None
    assert (low, high) == pytest.approx((73.5595, 276.441), abs=1e-3)


@pytest.mark.parametrize('at', ['h1', 'h1=', 'h1=x', 'h1=nan', 'h1=1,h1=2', '=1'])
def test_a_broken_assignment_exits_with_2(cam_motion, at):
    done = cam_motion('linkage', UMBRELLA, '--at', at)
    assert done.returncode == 2 and 'usage:' in done.stderr


def test_people_read_tables_and_the_range(cam_motion):
    out = cam_motion('linkage', UMBRELLA, '--at', 'h1_dot=-0.3').stdout
    for words in ('theta5', '-81.912307', '-0.0875', 'h1: above 0.2 m and below 2.2 m',
                  'transmission angle rib_angle: 53.13 deg', 'certified steps'):
        assert words in out


def test_lengths_that_loops_determine_are_told_and_cranks_read_degrees(
        cam_motion, read_json, tmp_path):
    file = tmp_path / 'bars.yaml'
    file.write_text(SLIDER_CRANK)
    data = read_json(
        cam_motion('linkage', file, '--json', '--at', 'turn_deg=90,turn_dot=2.0').stdout)
    assert data['angles_deg']['turn'] == 90.0
    assert data['omega']['omega_turn'] == 2.0
    assert data['lengths']['x'] == pytest.approx({'value': math.sqrt(0.08), 'rate': -0.2})
    assert 'turns through' in cam_motion('linkage', file).stdout
    done = cam_motion('linkage', file, '--output', tmp_path)
    assert done.returncode == 2 and 'bars.motions' in done.stderr


def test_a_file_of_several_linkages_needs_a_name(cam_motion, tmp_path):
    file = tmp_path / 'two.yaml'
    file.write_text(SLIDER_CRANK + SLIDER_CRANK.replace('bars:', 'more:'))
    assert cam_motion('linkage', file).returncode == 2
    assert cam_motion('linkage', file, '--name', 'more').returncode == 0
    done = cam_motion('linkage', file, '--name', 'other')
    assert done.returncode == 2 and 'bars, more' in done.stderr


def test_a_machine_without_a_linkage_is_said(cam_motion, machine_file):
    done = cam_motion('linkage', machine_file)
    assert done.returncode == 2 and 'type: linkage' in done.stderr


def test_check_takes_a_file_of_linkages_and_one_with_a_line(
        cam_motion, read_json, machine_file, tmp_path):
    done = cam_motion('check', UMBRELLA, '--json')
    assert done.returncode == 0
    assert list(read_json(done.stdout)['linkages']['umbrella']) == ['h1', 'h2']
    file = tmp_path / 'both.yaml'
    file.write_text(machine_file.read_text() + SLIDER_CRANK.replace('0.337', '3.37'))
    done = cam_motion('check', file, '--json')
    problem, = read_json(done.stdout)['problems']
    assert (done.returncode, problem['path']) == (2, 'bars.unknowns')
    assert 'linkage umbrella, h2: above 0.282843 m' in cam_motion('check', UMBRELLA).stdout


@pytest.mark.slow
def test_the_motions_are_drawn(cam_motion, tmp_path):
    done = cam_motion('linkage', UMBRELLA, '--output', tmp_path, '--json')
    files = [Path(file) for file in json.loads(done.stdout)['files']]
    assert [file.name for file in files] == [
        f'linkage_umbrella_{name}.png' for name in ('sliding', 'opening', 'both')]
    assert all(file.read_bytes()[:4] == b'\x89PNG' for file in files)


def test_the_urdf_is_written_where_it_is_told(cam_motion, tmp_path):
    file = tmp_path / 'new' / 'umbrella.urdf'
    done = cam_motion('linkage', UMBRELLA, '--urdf', file, '--json')
    assert json.loads(done.stdout)['files'] == [str(file)]
    assert '<joint name="theta2" type="continuous">' in file.read_text()
    done = cam_motion('linkage', UMBRELLA, '--urdf', tmp_path)
    assert done.returncode == 2 and '--urdf' in done.stderr
