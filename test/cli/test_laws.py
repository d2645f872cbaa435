# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``laws``: every law of the registry, with the coefficients of the documents."""

import math

from cam_motion.motion.laws import LAWS
import pytest

pytestmark = pytest.mark.timeout(60)

CONTRACT = {'name', 'cv', 'ca', 'cj', 'power', 'rms_acceleration'}


def test_json_lists_every_law_once_with_the_keys_of_the_contract(cam_motion, read_json):
    done = cam_motion('laws', '--json')
    laws = read_json(done.stdout)
    assert done.returncode == 0
    assert [law['name'] for law in laws] == list(LAWS)
    assert all(law.keys() >= CONTRACT | {'cj_inside', 'summary', 'source', 'parameters'}
               for law in laws)


def test_coefficients_are_those_of_the_documents(cam_motion, read_json):
    laws = {law['name']: law for law in read_json(cam_motion('laws', '--json').stdout)}
    assert laws['modified_trapezoid']['cv'] == pytest.approx(2.0, rel=1e-12)
    assert laws['modified_trapezoid']['ca'] == pytest.approx(8 * math.pi / (2 + math.pi))
    assert laws['modified_trapezoid']['cj'] == pytest.approx(32 * math.pi ** 2 / (2 + math.pi))
    assert laws['cycloidal']['power'] == pytest.approx(1.5 * math.pi * math.sqrt(3.0))
    assert (laws['constant_acceleration']['cv'], laws['constant_acceleration']['ca']) == (2, 4)
    assert (laws['cubic']['cv'], laws['cubic']['ca'], laws['cubic']['cj_inside']) == (1.5, 6, 12)


def test_infinite_coefficients_are_null(cam_motion, read_json):
    laws = {law['name']: law for law in read_json(cam_motion('laws', '--json').stdout)}
    assert laws['cubic']['cj'] is None
    assert laws['constant_acceleration']['cj'] is None
    # what ends at a velocity meets that velocity
    assert laws['constant_velocity']['ca'] == laws['constant_velocity']['power'] == 0.0
    assert None not in (laws['modified_sine_vv'][key] for key in CONTRACT)


def test_json_tells_families_and_their_members(cam_motion, read_json):
    laws = {law['name']: law for law in read_json(cam_motion('laws', '--json').stdout)}
    assert [name for name, law in laws.items() if law['by_parameters']] == [
        'universal', 'scca', 'b_spline', 'polynomial', 'auto', 'flexible_polynomial', 'spline']
    members = {each['name']: each for each in laws['modified_constant_velocity']['members']}
    assert list(members) == ['MCV20', 'MCV33', 'MCV50']
    assert members['MCV20']['power'] == pytest.approx(5.1414, abs=5e-5)
    assert members['MCV20']['parameters'] == {'constant_velocity': 0.2}
    assert laws['double_harmonic']['ca_least'] == pytest.approx(-math.pi ** 2)


@pytest.mark.parametrize('columns', ['80', '120'])
def test_table_shows_infinite_jerk_with_the_jerk_inside_in_brackets(cam_motion, columns):
    done = cam_motion('laws', columns=columns)
    cubic = next(line for line in done.stdout.splitlines() if line.split()[:1] == ['cubic'])
    assert '∞ [12]' in cubic
    assert max(map(len, done.stdout.splitlines())) <= int(columns)
    assert all(law in done.stdout for law in LAWS)
    double = next(line.split() for line in done.stdout.splitlines() if 'double_harmonic ' in line)
    assert double[2] == '+5.552/-9.87'
    polynomial = next(line.split() for line in done.stdout.splitlines() if ' auto ' in line)
    assert polynomial == ['auto', 'by', 'its', 'parameters']
    assert '  MCV20' in done.stdout and '  MT 40/60' in done.stdout
    assert ' [15]  R. L. Norton' in done.stdout
    assert any(line.split()[:3] == ['scca', 'R-R', '[15]'] for line in done.stdout.splitlines())


def test_json_tells_what_each_law_does_at_its_ends(cam_motion, read_json):
    ends = {law['name']: law['ends'] for law in read_json(cam_motion('laws', '--json').stdout)}
    assert ends['modified_sine'] == ['rest', 'rest']
    assert ends['double_harmonic'] == ['rest', 'turn']
    assert ends['constant_velocity'] == ['constant velocity'] * 2


def test_laws_of_the_contract_are_there(cam_motion, read_json):
    names = {law['name'] for law in read_json(cam_motion('laws', '--json').stdout)}
    assert names >= {
        'dwell', 'constant_acceleration', 'trapezoidal_velocity', 'cubic', 'cycloidal',
        'modified_trapezoid', 'modified_sine', 'simple_harmonic', 'polynomial_345',
        'polynomial_4567'}


def test_all_laws_are_drawn_on_one_sheet(cam_motion, tmp_path):
    done = cam_motion('laws', '-o', str(tmp_path / 'new'), '--format', 'svg')
    sheet = tmp_path / 'new' / 'laws.svg'
    assert done.returncode == 0 and f'wrote {sheet}' in done.stdout
    text = sheet.read_text()
    assert all(law in text for law in ('modified_sine', 'polynomial_6_to_11', 'Cj 39.478'))
    assert 'flexible_polynomial' not in text and 'scca' not in text
    assert 's‴/80' in text and 'harmonic_combination_vt  V-T' in text
