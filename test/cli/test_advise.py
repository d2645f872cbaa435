# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``advise``: tables with reasons, JSON, pictures, and what is refused."""

from pathlib import Path

import pytest

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config'
ALONE = ('--lift', 0.3, '--span-deg', 80, '--speed-cpm', 100)


def test_a_movement_on_its_own_is_advised_upon(cam_motion):
    done = cam_motion('advise', *ALONE, columns='200')
    assert done.returncode == 0
    lines = done.stdout.splitlines()
    assert lines[0].startswith('movement: 0.3 m over 80 deg, 0.1333 s at 100 cycles/min')
    first = next(line for line in lines if line.lstrip().startswith('1 '))
    assert 'modified_sine' in first and 'least power, RMS acceleration' in first
    assert '+76 %' in first  # its jerk, against the cycloidal law's 4 pi²
    assert any(line.startswith('not constant_velocity') for line in lines)


def test_a_narrow_terminal_gets_the_reasons_as_a_list_of_their_own(cam_motion):
    done = cam_motion('advise', *ALONE, '--by', 'peak_jerk')
    lines = [line for line in done.stdout.splitlines() if line.startswith('  1  cycloidal')]
    assert len(lines) == 2
    assert '4996' in lines[0] and 'least jerk' in lines[1]
    assert all(len(line) <= 120 for line in done.stdout.splitlines())


def test_the_kind_of_an_end_follows_from_its_velocity(cam_motion):
    done = cam_motion('advise', '--lift', 0.1, '--span-deg', 90, '--speed-cpm', 60,
                      '--end-velocity', 0.4)
    assert done.returncode == 0
    text = ' '.join(done.stdout.split())
    assert 'from rest to constant velocity' in text and 'with end_velocity: 1' in text


def test_json_holds_laws_and_filters(cam_motion, read_json):
    done = cam_motion('advise', CONFIG / 'feeding_group.yaml', 'feeder.feed', '--frequency-hz', 12,
                      '--damping', 0.01, '--by', 'rms_torque', '--json')
    assert done.returncode == 0
    [data] = read_json(done.stdout)['movements']
    assert (data['movement'], data['by'], data['frequency_hz']) == (
        'feeder.feed', 'rms_torque', pytest.approx(12.0))
    best = data['ranking'][0]
    assert best['law'] == 'modified_sine' and best['score'] == best['figures']['rms_torque']
    assert [each['place'] for each in data['ranking']] == [*range(1, len(data['ranking']) + 1)]
    assert {each['law'] for each in data['stepping']} >= {'cubic', 'simple_harmonic'}
    assert [each['law'] for each in data['ranking'] if each['configured']] == [
        'modified_trapezoid']
    assert data['filters_over'] == 'modified_trapezoid'
    kinds = {each['kind']: each for each in data['filters']}
    assert kinds['zv']['residual'] < 1e-12 < kinds['none']['residual']
    assert set(kinds['zv']['residual_by_frequency_error_pct']) == {'-20', '-10', '+10', '+20'}
    assert 'jerk of the cam steps' in kinds['polydyne']['reason']


def test_slosh_is_told_as_the_height_of_the_wave(cam_motion):
    done = cam_motion('advise', '--lift', 0.3, '--span-deg', 180, '--speed-cpm', 60,
                      '--container-width', 0.08, '--fill-height', 0.1, '--damping', 0.005)
    assert done.returncode == 0
    assert 'filters for 3.122 Hz' in done.stdout  # g k tanh(k h), k = pi / 0.08
    assert 'Largest height of the wave at the wall' in done.stdout
    assert 'ends later by what the filter takes' in done.stdout


def test_pictures_are_written(cam_motion, tmp_path, read_json):
    done = cam_motion('advise', *ALONE, '--frequency-hz', 12, '-o', tmp_path, '--json')
    files = [Path(file) for file in read_json(done.stdout)['files']]
    assert [file.name for file in files] == ['advice_movement.png', 'filters_movement.png']
    assert all(file.stat().st_size > 20000 for file in files)


@pytest.mark.parametrize('arguments, paths', [
    ((), ['--lift', '--span-deg', '--speed-cpm']),
    (('--lift', 0.3, '--span-deg', 400, '--speed-cpm', -1), ['--span-deg', '--speed-cpm']),
    ((*ALONE, '--frequency-hz', -3), ['--frequency-hz']),
    ((*ALONE, '--container-width', 0.1), ['--fill-height']),
    ((*ALONE, '--by', 'peak_torque'), ['--by']),
    ((*ALONE, '--start', 'motion'), ['--start-velocity', '--start-acceleration']),
    ((CONFIG / 'feeding_group.yaml', '--end-velocity', 1), ['--end-velocity']),
    ((CONFIG / 'feeding_group.yaml', '--lift', 0.3), ['--lift']),
    ((CONFIG / 'feeding_group.yaml', 'feeder.wait'), ['feeder.wait']),
])
def test_what_cannot_be_used_is_refused_with_its_path(cam_motion, arguments, paths):
    done = cam_motion('advise', *arguments)
    assert done.returncode == 2 and done.stdout == ''
    found = [line.split('. ', 1)[1] for line in done.stderr.splitlines()
             if line[:3].strip().isdigit() and '. ' in line]
    assert found == paths
