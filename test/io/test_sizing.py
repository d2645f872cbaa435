# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Sizing of a machine: what is tried of its own parts, and that their limits count."""

import copy
from pathlib import Path

from cam_motion.drive.sizing_forward import Wishes
from cam_motion.io.catalogue import Catalogue, load_catalogue
from cam_motion.io.config import load_machine
from cam_motion.io.simulation import simulate
from cam_motion.io.sizing import CONFIGURED, Options, OTHER_RATIO, size
from cam_motion.units import RPM
import pytest
import yaml

pytestmark = pytest.mark.timeout(60)

PRESS = yaml.safe_load(
    (Path(__file__).resolve().parents[2] / 'config' / 'cam_press_drive.yaml').read_text())
FEW = Options(ratios=(3.5525, 3.8), flywheels=(0.06,), wishes=Wishes(fluctuation_pct=50.0))


@pytest.fixture
def press(tmp_path):
    """Give a function that loads the press with some parameters of its drive changed."""
    def make(changes=()):
        data = copy.deepcopy(PRESS)
        for path, value in dict(changes).items():
            *above, last = path.split('.')
            at = data['press_drive']['ros__parameters']
            for key in above:
                at = at[key]
            at[last] = value
            if value is None:
                del at[last]
        file = tmp_path / 'press.yaml'
        file.write_text(yaml.safe_dump(data))
        return load_machine(file)
    return make


@pytest.fixture(scope='module')
def motors():
    """Give the induction motors that come along, without gearboxes."""
    return Catalogue(motors=load_catalogue().motors)


def sized(machine, catalogue, options=FEW):
    """Size the press; give all candidates, those that fit first."""
    sizing = size(machine, catalogue, options)['press_drive'].sizing
    return [*sizing.ranked, *sizing.rejected]


def test_limits_of_the_machine_s_own_gearbox_reject_as_the_simulation_does(press, motors):
    machine = press({'gearbox.rated_torque': 20.0, 'gearbox.max_rpm': 1000.0})
    orbit = simulate(machine, document=False)['press_drive']['orbit']
    assert orbit['gearbox_torque_margin'] < 0.0 > orbit['gearbox_speed_margin_rpm']
    for one in sized(machine, motors):
        broken = {check.rule: check for check in one.broken}
        assert {'gearbox_peak_torque', 'gearbox_rms_torque', 'gearbox_speed'} <= set(broken)
        assert broken['gearbox_peak_torque'].bound == 20.0
        assert broken['gearbox_speed'].bound == pytest.approx(1000.0)
        if (one.motor, one.ratio) == (CONFIGURED, 3.5525):
            assert broken['gearbox_speed'].value == pytest.approx(
                1000.0 - orbit['gearbox_speed_margin_rpm'], rel=1e-6)
    assert not any(check.rule.startswith('gearbox') for one in sized(press(), motors)
                   for check in one.checks)


def test_the_machine_s_own_motor_is_tried_beside_those_of_the_catalogue(press, motors):
    machine = press({'motor.breakdown_torque': 40.0})
    own = [one for one in sized(machine, motors) if one.motor == CONFIGURED]
    assert {one.ratio for one in own if not one.broken} == {3.5525, 3.8}
    orbit = simulate(machine, document=False)['press_drive']['orbit']
    [same] = [one for one in own if one.ratio == 3.5525]
    for name in ('fluctuation_pct', 'stability_pct', 'motor_work_per_cycle', 'max_speed_rpm'):
        assert same.figures[name] == pytest.approx(orbit[name], rel=1e-5), name
    assert same.rated_power == pytest.approx(10.1 * 1421.0 * RPM)
    bound = next(check.bound for check in same.checks if check.rule == 'rms_torque')
    assert bound == 10.1


def test_an_own_motor_without_rated_figures_counts_by_its_curve_at_nominal_speed(press, motors):
    machine = press({'motor.rated_torque': None, 'motor.rated_rpm': None})
    drive = machine.cam_drives['press_drive'].drive
    [own] = [one for one in sized(machine, motors)
             if (one.motor, one.ratio) == (CONFIGURED, 3.5525)]
    torque = float(drive.motor.torque(3.5525 * 400.0 * RPM))
    assert own.rated_power == pytest.approx(torque * 1421.0 * RPM)
    # a motor whose nominal speed lies above the synchronous one has no torque to count by
    fast = press({'motor.rated_torque': None, 'motor.rated_rpm': None, 'nominal_rpm': 500.0})
    assert not [one for one in sized(fast, motors) if one.motor == CONFIGURED]


def test_the_own_gearbox_is_as_configured_with_its_own_ratio_only(press, motors):
    names = {one.ratio: one.gearbox for one in sized(press(), motors)}
    assert names == {3.5525: CONFIGURED, 3.8: OTHER_RATIO}


def test_a_motor_of_the_catalogue_starts_as_one_with_the_same_figures_in_the_file(press, motors):
    slow = {'nominal_rpm': 220.0}
    options = FEW._replace(ratios=(7.0,))
    [found] = [one for one in sized(press(slow), motors, options) if one.motor == 'MTF3 80M-4']
    figures = {'motor.rated_rpm': 1445.0, 'motor.rated_torque': 5.0, 'motor.a': None,
               'motor.breakdown_torque': 17.0, 'motor.starting_torque': 14.0, 'motor.b': None,
               'motor.breakdown_slip': None, 'motor.inertia': 0.00261, 'gearbox.ratio': 7.0}
    simulated = simulate(press({**slow, **figures}), document=False)['press_drive']
    assert found.figures['start_torque'] == pytest.approx(14.0 * 7.0 * 0.9)
    assert simulated['start_up']['start_torque'] == pytest.approx(14.0 * 7.0 * 0.9)
    assert found.figures['static_load_peak'] == simulated['start_up']['static_load_peak']
    for name in ('fluctuation_pct', 'stability_pct', 'motor_work_per_cycle'):
        assert found.figures[name] == pytest.approx(simulated['orbit'][name], rel=1e-5), name
