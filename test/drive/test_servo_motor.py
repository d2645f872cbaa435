# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Servo motors by peak and continuous torque over speed."""

from math import inf, nan

from cam_motion.drive.servo_motor import ServoMotor, TorqueLimit
from cam_motion.errors import ConfigurationError
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

PLATE = {'standstill_torque': 60.0, 'rated_torque': 50.0, 'rated_speed': 210.0,
         'peak_torque': 180.0, 'corner_speed': 200.0, 'max_speed': 400.0, 'inertia': 0.01,
         'torque_constant': 1.5}
MOTOR = ServoMotor.from_plate(**PLATE)
ROUNDING = 1e-12


def paths(error):
    return [problem.path for problem in error.value.problems]


@pytest.mark.parametrize(('speed', 'peak', 'continuous'), [
    (0.0, 180.0, 60.0), (200.0, 180.0, 60.0 - 10.0 * 200.0 / 210.0), (210.0, 173.5, 50.0),
    (400.0, 50.0, 26.25), (400.1, 0.0, 0.0)])
def test_the_curves_go_through_the_figures_of_the_plate(speed, peak, continuous):
    for turned in (speed, -speed):
        assert MOTOR.peak_torque(turned) == pytest.approx(peak, rel=ROUNDING)
        assert MOTOR.continuous_torque(turned) == pytest.approx(continuous, rel=ROUNDING)


@given(st.lists(st.floats(-500.0, 500.0), min_size=1, max_size=8))
def test_an_array_gives_what_its_floats_give(speeds):
    for curve in (MOTOR.peak_torque, MOTOR.continuous_torque):
        assert curve(np.array(speeds)) == pytest.approx(
            [curve(speed) for speed in speeds], rel=ROUNDING)


@given(st.floats(-500.0, 500.0))
def test_the_motor_gives_for_good_at_most_what_it_gives_for_a_moment(speed):
    assert 0.0 <= MOTOR.continuous_torque(speed) <= MOTOR.peak_torque(speed) <= 180.0


def test_rated_power_is_kept_at_the_largest_speed():
    assert MOTOR.continuous_torque(400.0) * 400.0 == pytest.approx(50.0 * 210.0, rel=ROUNDING)


def test_without_a_corner_the_peak_is_held_to_rated_speed():
    motor = ServoMotor.from_plate(**{**PLATE, 'corner_speed': None})
    assert motor.peak_torque(210.0) == 180.0 > motor.peak_torque(211.0)


def test_a_motor_may_be_rated_at_its_largest_speed():
    motor = ServoMotor.from_plate(**{**PLATE, 'corner_speed': 210.0, 'max_speed': 210.0})
    assert (motor.peak_torque(210.0), motor.continuous_torque(210.0)) == (180.0, 50.0)


def test_current_is_torque_over_its_constant_where_that_is_known():
    assert MOTOR.current(30.0) == 20.0
    assert MOTOR.current(np.array([30.0, -3.0])).tolist() == [20.0, -2.0]
    assert ServoMotor.from_plate(**{**PLATE, 'torque_constant': None}).current(30.0) is None


def test_a_curve_of_one_point_is_flat():
    flat = TorqueLimit([0.0], [3.0])
    assert flat(1e9) == 3.0
    assert flat(np.array([-1.0, 0.0])).tolist() == [3.0, 3.0]


@pytest.mark.parametrize(('speeds', 'torques', 'wrong'), [
    ([], [], ['speeds']), ([1.0], [1.0], ['speeds']), ([0.0, 5.0, 5.0], [1.0] * 3, ['speeds']),
    ([0.0, nan], [1.0, 1.0], ['speeds']), ([0.0, inf], [1.0, 1.0], ['speeds']),
    ([0.0], [-1.0], ['torques']), ([0.0], [nan], ['torques']), ([0.0], [1.0, 2.0], ['torques']),
    ([2.0, 1.0], [inf], ['speeds', 'torques', 'torques'])])
def test_points_that_make_no_curve_are_refused_all_at_once(speeds, torques, wrong):
    with pytest.raises(ConfigurationError) as error:
        TorqueLimit(speeds, torques)
    assert paths(error) == wrong


def test_figures_that_make_no_motor_are_refused_all_at_once():
    with pytest.raises(ConfigurationError) as error:
        ServoMotor(TorqueLimit([0.0], [1.0]), TorqueLimit([0.0], [2.0]), 0.0, nan, 1.0, -1.0)
    assert paths(error) == ['inertia', 'max_speed', 'torque_constant', 'continuous.torques']


def test_curves_are_compared_between_their_points_too():
    continuous = TorqueLimit([0.0, 100.0], [2.0, 2.0])
    with pytest.raises(ConfigurationError, match='at 477.465 rpm it is 2 N m against 1 N m'):
        ServoMotor(TorqueLimit([0.0, 50.0, 100.0], [3.0, 1.0, 3.0]), continuous, 0.1, 99.0, 9.0)


def test_a_motor_without_torque_at_rest_is_refused():
    with pytest.raises(ConfigurationError) as error:
        ServoMotor(TorqueLimit([0.0], [0.0]), TorqueLimit([0.0], [0.0]), 0.1, 99.0, 100.0)
    assert paths(error) == ['rated_speed', 'peak.torques']


@pytest.mark.parametrize(('change', 'wrong'), [
    ({'rated_torque': 61.0}, ['rated_torque']),
    ({'standstill_torque': 181.0}, ['standstill_torque']),
    ({'max_speed': 205.0}, ['rated_speed']),
    ({'max_speed': 150.0}, ['rated_speed', 'corner_speed']),
    ({'peak_torque': nan, 'rated_speed': -1.0}, ['rated_speed', 'peak_torque'])])
def test_a_plate_that_makes_no_motor_is_refused_all_at_once(change, wrong):
    with pytest.raises(ConfigurationError) as error:
        ServoMotor.from_plate(**{**PLATE, **change})
    assert paths(error) == wrong
