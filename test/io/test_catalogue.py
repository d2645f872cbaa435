# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The catalogue: every figure has a source, what it becomes, and how mistakes are refused."""

import copy
import math
from pathlib import Path

from cam_motion.drive.motor import InductionMotor, KlossMotor
from cam_motion.errors import ConfigurationError
from cam_motion.io.catalogue import load_catalogue, own_catalogue
from cam_motion.io.config import load_machine
from cam_motion.units import RPM
import pytest
import yaml

PRESS = Path(__file__).resolve().parents[2] / 'config' / 'cam_press_drive.yaml'

GOOD = {
    'sources': {'sheet': {'title': 'A data sheet', 'publisher': 'A maker', 'year': 2020}},
    'induction_motors': {'M1': {
        'source': 'sheet', 'synchronous_rpm': 1500, 'rated_rpm': 1440, 'rated_torque': 10.0,
        'breakdown_torque': 28.0, 'inertia': 0.004}},
    'servo_motors': {'S1': {
        'source': 'sheet', 'rated_torque': 5.0, 'rated_rpm': 3000, 'peak_torque': 15.0,
        'max_rpm': 6000, 'inertia': 0.0002}},
    'gearboxes': {'G1': {'source': 'sheet', 'ratios': [3, 5], 'efficiency': 0.97,
                         'inertia': [0.0002, 0.0001], 'max_rpm': 6000}},
}


@pytest.fixture
def write(tmp_path):
    """Give a function that writes the good catalogue with some values changed."""
    def make(changes=(), name='catalogue.yaml'):
        data = copy.deepcopy(GOOD)
        for path, value in dict(changes).items():
            *above, last = path.split('.')
            at = data
            for key in above:
                at = at[key]
            if value is None:
                del at[last]
            else:
                at[last] = value
        file = tmp_path / name
        file.write_text(yaml.safe_dump(data, sort_keys=False))
        return file
    return make


def refused(*files):
    """Give the problems of a catalogue that is refused, as (path, rule and way out)."""
    with pytest.raises(ConfigurationError) as caught:
        load_catalogue(files)
    return [(problem.path, f'{problem.rule} {problem.hint}') for problem in
            caught.value.problems]


def test_the_catalogue_that_comes_along_names_a_source_for_every_entry():
    assert [path.stem for path in own_catalogue()] == [
        'gearboxes', 'induction_motors', 'servo_motors']
    found = load_catalogue()
    assert (len(found.motors), len(found.servos), len(found.gearboxes)) == (3, 101, 38)
    for one in (*found.motors, *found.servos, *found.gearboxes):
        assert len(one.source) > 20, one.name
    for path in own_catalogue():  # a publication that prints no figure here is a leftover
        tree = yaml.safe_load(path.read_text())
        used = {entry['source'] for section, entries in tree.items() if section != 'sources'
                for entry in entries.values()}
        assert used == set(tree['sources']), path
        assert all(about.keys() >= {'title', 'publisher'} for about in tree['sources'].values())


def test_the_motor_of_document_004_is_that_of_the_machine_file():
    found = {one.name: one for one in load_catalogue().motors}['NM 90L-4']
    drive = load_machine(PRESS).cam_drives['press_drive'].drive
    assert found.motor == drive.motor
    assert (found.rated_power, found.rated_torque) == (1500.0, 10.1)
    assert found.rated_speed == pytest.approx(1421.0 * RPM)
    # 2.7 times the rated torque; at rest what the curve gives
    assert found.motor.breakdown_torque == pytest.approx(2.7 * 10.1)
    assert found.starting_torque == found.motor.torque(0.0)


def test_data_sheets_that_print_ratios_are_taken_times_the_rated_torque():
    found = {one.name: one for one in load_catalogue().motors}
    big, small = found['Sg180L-4'], found['MTF3 80M-4']
    assert big.motor.breakdown_torque == pytest.approx(2.8 * 143.41)
    assert big.starting_torque == pytest.approx(2.7 * 143.41)
    assert small.motor.breakdown_torque == pytest.approx(3.4 * 5.0)
    assert small.starting_torque == pytest.approx(2.8 * 5.0)
    for one in (big, small):  # the curve goes through the rated point, and that at rest
        assert float(one.motor.torque(0.0)) == one.starting_torque
        assert float(one.motor.torque(one.rated_speed)) == pytest.approx(one.rated_torque)
        # what a maker rounds: rated power is rated torque times rated speed
        assert one.rated_torque * one.rated_speed == pytest.approx(one.rated_power, rel=0.01)


def test_rated_powers_of_servo_motors_agree_with_torque_and_speed():
    for one in load_catalogue().servos:
        motor = one.motor
        power = float(motor.continuous(motor.rated_speed)) * motor.rated_speed
        assert one.rated_power == pytest.approx(power, rel=0.03), one.name


def test_gearboxes_come_once_per_ratio_with_their_inertia_at_the_load(write):
    first, second = load_catalogue([write()]).gearboxes
    assert (first.name, first.gearbox.ratio, second.gearbox.ratio) == ('G1', 3.0, 5.0)
    assert first.gearbox.inertia == pytest.approx(0.0002 * 9.0)
    assert second.gearbox.inertia == pytest.approx(0.0001 * 25.0)
    assert first.max_speed == second.max_speed == pytest.approx(6000.0 * RPM)
    assert first.rated_torque == first.peak_torque == first.rated_speed == math.inf
    tp010 = [one for one in load_catalogue().gearboxes if one.name == 'TP010 MF'][0]
    assert (tp010.torque_limit(1000.0 / 3600.0), tp010.torque_limit(0.3)) == (172.0, 84.0)


def test_motors_take_the_curve_that_their_figures_allow(write):
    slip = {'induction_motors.M1.breakdown_slip': 0.2}
    curve = {**slip, 'induction_motors.M1.a': 2.5, 'induction_motors.M1.b': 1.0}
    [through_rated], [by_slip], [document] = (
        load_catalogue([write(changes)]).motors for changes in ({}, slip, curve))
    assert isinstance(through_rated.motor, KlossMotor)
    assert float(through_rated.motor.torque(1440.0 * RPM)) == pytest.approx(10.0)
    assert by_slip.motor == KlossMotor(1500.0 * RPM, 28.0, 0.2, 0.004)
    assert document.motor == InductionMotor(1500.0 * RPM, 28.0, 0.2, 2.5, 1.0, 0.004)
    assert through_rated.rated_power == pytest.approx(10.0 * 1440.0 * RPM)


def test_servo_motors_take_points_of_curves_instead_of_lines(write):
    [plate] = load_catalogue([write()]).servos
    assert plate.motor.peak_torque(3000.0 * RPM) == 15.0
    assert plate.motor.continuous_torque(0.0) == 5.0
    curves = {'servo_motors.S1.peak_curve': [[0, 15.0], [4000, 12.0], [6000, 6.0]],
              'servo_motors.S1.continuous_curve': [[0, 6.0], [6000, 3.0]]}
    [drawn] = load_catalogue([write(curves)]).servos
    assert drawn.motor.peak_torque(5000.0 * RPM) == pytest.approx(9.0)
    assert drawn.motor.continuous_torque(3000.0 * RPM) == pytest.approx(4.5)


def test_several_files_make_one_catalogue_but_no_name_stands_twice(write):
    other = write({'induction_motors': None, 'gearboxes': None,
                   'servo_motors': {'S2': GOOD['servo_motors']['S1']}}, 'other.yaml')
    found = load_catalogue([write(), other])
    assert [one.name for one in found.servos] == ['S1', 'S2']
    assert refused(write(), write(name='again.yaml')) == [
        (f'{section}.{name}', 'stands in the catalogue twice '
         'keep one of them, or give it another name') for section, name in (
            ('induction_motors', 'M1'), ('servo_motors', 'S1'), ('gearboxes', 'G1'))]


@pytest.mark.parametrize(('changes', 'path', 'said'), [
    ({'sources': None}, 'sources', 'no figure without a source'),
    ({'sources.sheet.title': ''}, 'sources.sheet.title', 'needs a title'),
    ({'sources.sheet.page': 3}, 'sources.sheet.page', 'no such key'),
    ({'servo_motors.S1.source': None}, 'servo_motors.S1.source', 'publication'),
    ({'servo_motors.S1.source': 'memory'}, 'servo_motors.S1.source', 'known are: sheet'),
    ({'servo_motors.S1.inertia': None}, 'servo_motors.S1.inertia', 'above 0'),
    ({'servo_motors.S1.inertia': -1e-4}, 'servo_motors.S1.inertia', 'above 0'),
    ({'servo_motors.S1.inertia': math.nan}, 'servo_motors.S1.inertia', 'finite'),
    ({'servo_motors.S1.peak_torque': 1.0}, 'servo_motors.S1.standstill_torque', 'peak_torque'),
    ({'servo_motors.S1.max_rpm': 2000}, 'servo_motors.S1.rated_speed', 'max_speed'),
    ({'servo_motors.S1.peak_torqe': 15.0}, 'servo_motors.S1.peak_torqe', 'peak_torque'),
    ({'servo_motors.S1.peak_curve': [[0, 15.0]]}, 'servo_motors.S1.continuous_curve', 'both'),
    ({'servo_motors.S1.peak_curve': [[0, 15.0]],
      'servo_motors.S1.continuous_curve': [[100, 5.0]]},
     'servo_motors.S1.continuous_curve.speeds', 'begin at 0'),
    ({'servo_motors.S1': 3}, 'servo_motors.S1', 'figures by name'),
    ({'servo_motors': [1]}, 'servo_motors', 'entries by name'),
    ({'induction_motors.M1.breakdown_torque': None}, 'induction_motors.M1.breakdown_torque', ''),
    ({'induction_motors.M1.breakdown_torque': 9.0}, 'induction_motors.M1.rated_torque',
     'below the breakdown'),
    ({'induction_motors.M1.rated_rpm': 1500}, 'induction_motors.M1.rated_rpm', 'synchronous'),
    ({'induction_motors.M1.starting_torque': 29.0}, 'induction_motors.M1.starting_torque',
     'below the breakdown torque'),
    ({'induction_motors.M1.starting_torque': 25.0, 'induction_motors.M1.breakdown_slip': 0.2,
      'induction_motors.M1.a': 2.5, 'induction_motors.M1.b': 1.0},
     'induction_motors.M1.starting_torque', 'give the torque at rest too'),
    ({'induction_motors.M1.a': 2.5}, 'induction_motors.M1.a', 'all three'),
    ({'gearboxes.G1.inertia': [0.1]}, 'gearboxes.G1.inertia', 'one per ratio'),
    ({'gearboxes.G1.ratios': []}, 'gearboxes.G1.ratios', 'at least one'),
    ({'gearboxes.G1.ratios': [0.0, 5]}, 'gearboxes.G1.ratios', 'above 0'),
    ({'gearboxes.G1.ratios': 5}, 'gearboxes.G1.ratios', 'list'),
    ({'gearboxes.G1.efficiency': 97}, 'gearboxes.G1.efficiency', 'at most 1'),
    ({'gearboxes.G1.peak_curve': [[0, 1]]}, 'gearboxes.G1.peak_curve', 'only servo motors'),
    ({'motors': {}}, 'motors', 'no such section'),
])
def test_a_mistake_is_refused_with_its_path_and_rule(write, changes, path, said):
    assert any(path == where and said in text for where, text in refused(write(changes)))


def test_all_mistakes_of_all_files_are_listed_at_once(write, tmp_path):
    other = tmp_path / 'other.yaml'
    other.write_text('servo_motors: [')
    found = refused(write({'servo_motors.S1.inertia': -1.0, 'servo_motors.S1.rated_torque': 'x',
                           'induction_motors.M1.source': 'none',
                           'gearboxes.G1.efficiency': 0}), other, tmp_path / 'missing.yaml')
    assert [path for path, _ in found[:4]] == [
        'induction_motors.M1.source', 'servo_motors.S1.rated_torque', 'servo_motors.S1.inertia',
        'gearboxes.G1.efficiency']
    assert 'no YAML' in found[4][1] and 'cannot be read' in found[5][1]
    assert len(found) == 6


@pytest.mark.parametrize('text', ['', '3', '- a\n', 'machine: {}\n', 'sources: {a: {title: b}}\n'])
def test_what_is_no_catalogue_is_said_to_be_none(tmp_path, text):
    file = tmp_path / 'no.yaml'
    file.write_text(text)
    assert [rule for _, rule in refused(file) if 'is no catalogue' in rule]
