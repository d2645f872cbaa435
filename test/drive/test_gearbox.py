# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The gearbox: what goes in comes out, but for the loss."""

from math import inf, nan

from cam_motion.drive.gearbox import Gearbox
from cam_motion.errors import ConfigurationError
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-13

gearboxes = st.builds(Gearbox, ratio=st.floats(0.01, 100.0), efficiency=st.floats(0.05, 1.0))
torques = st.floats(-1e4, 1e4)
speeds = st.floats(-1e3, 1e3)


@given(box=gearboxes, torque=torques, speed=speeds)
def test_power_in_is_power_out_and_loss_in_both_directions(box, torque, speed):
    at_motor = torque * speed
    at_load = float(box.gain(torque, speed)) * torque * speed / box.ratio
    power_in, power_out = (at_motor, at_load) if at_motor >= 0.0 else (-at_load, -at_motor)
    loss = (1.0 - box.efficiency) * power_in
    assert power_in >= power_out >= 0.0
    assert power_in == pytest.approx(power_out + loss, rel=ROUNDING, abs=1e-200)


@given(box=gearboxes, torque=torques, speed=speeds)
def test_the_motors_torque_is_found_again_from_the_loads(box, torque, speed):
    load = float(box.gain(torque, speed)) * torque
    again = box.motor_torque(load, speed / box.ratio)
    if torque * speed / box.ratio != 0.0:
        assert again == pytest.approx(torque, rel=ROUNDING)


def test_losses_help_the_brake():
    box = Gearbox(4.0, 0.8)
    assert float(box.gain(10.0, 1.0)) == pytest.approx(4.0 * 0.8)
    assert float(box.gain(-10.0, 1.0)) == pytest.approx(4.0 / 0.8)
    assert float(box.gain(-10.0, -1.0)) == pytest.approx(4.0 * 0.8)
    assert float(box.gain(10.0, -1.0)) == pytest.approx(4.0 / 0.8)


def test_a_motor_that_starts_from_rest_drives():
    assert float(Gearbox(4.0, 0.8).gain(10.0, 0.0)) == pytest.approx(3.2)


def test_arrays_decide_on_the_direction_one_by_one():
    gain = Gearbox(2.0, 0.5).gain(np.array([1.0, -1.0, 0.0]), np.array([3.0, 3.0, 3.0]))
    assert gain.tolist() == [1.0, 4.0, 1.0]


@pytest.mark.parametrize(('name', 'value', 'rule'), [
    ('efficiency', 1.2, 'must be above 0 and at most 1'),
    ('efficiency', 0.0, 'must be above 0 and at most 1'),
    ('efficiency', -0.9, 'must be above 0 and at most 1'),
    ('efficiency', 90.0, 'must be above 0 and at most 1'),
    ('efficiency', nan, 'must be above 0 and at most 1'),
    ('ratio', 0.0, 'must be a finite number above 0'),
    ('ratio', -3.5, 'must be a finite number above 0'),
    ('ratio', inf, 'must be a finite number above 0'),
    ('inertia', -0.001, 'must be at least 0 kg m²'),
    ('inertia', nan, 'must be at least 0 kg m²'),
])
def test_nonsense_is_refused_by_name_value_and_rule(name, value, rule):
    with pytest.raises(ConfigurationError) as refused:
        Gearbox(**{name: value})
    problem, = refused.value.problems
    assert problem.path == name
    assert problem.value is value
    assert problem.rule == rule


def test_all_that_is_wrong_is_told_at_once():
    with pytest.raises(ConfigurationError) as refused:
        Gearbox(0.0, 1.2, -1.0)
    assert [problem.path for problem in refused.value.problems] == [
        'ratio', 'efficiency', 'inertia']
    assert 'write 0.9 for 90 %' in str(refused.value)
