# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Induction motors by their torque over speed."""

from math import inf, nan

from cam_motion.drive.motor import InductionMotor, KlossMotor
from cam_motion.errors import ConfigurationError
from cam_motion.units import RPM
from hypothesis import assume, given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

SYNCHRONOUS = 1500.0 * RPM
ROUNDING = 1e-13
STEP = 1e-4  # of the speed, for differences [rad/s]
DIFFERENCE = 1e-7  # what a central difference over this step may miss, relative to the peak

NM_90L_4 = {'synchronous_speed': SYNCHRONOUS, 'breakdown_torque': 27.27,
            'breakdown_slip': 0.315, 'a': 1.587, 'b': 1.416, 'inertia': 0.0028}
MOTORS = [
    InductionMotor(**NM_90L_4),
    KlossMotor.from_rated(SYNCHRONOUS, 1421.0 * RPM, 10.1, 27.27, 0.0028),
]
motors = pytest.mark.parametrize('motor', MOTORS, ids=lambda motor: type(motor).__name__)


def at_slip(motor, slip):
    return motor.torque((1.0 - slip) * motor.synchronous_speed)


@motors
def test_there_is_no_torque_at_the_synchronous_speed(motor):
    assert motor.torque(motor.synchronous_speed) == 0.0


@motors
def test_the_greatest_torque_stands_at_the_breakdown_slip(motor):
    greatest = at_slip(motor, motor.breakdown_slip)
    assert greatest == pytest.approx(27.27, rel=ROUNDING)
    slips = np.linspace(0.0, 1.0, 100_001)
    assert np.max(at_slip(motor, slips)) <= greatest * (1.0 + ROUNDING)
    speed = (1.0 - motor.breakdown_slip) * motor.synchronous_speed
    assert motor.slope(speed) == pytest.approx(0.0, abs=1e-12)


@given(slip=st.floats(1e-6, 1.0))
def test_the_curve_is_the_printed_one_away_from_the_synchronous_speed(slip):
    motor = MOTORS[0]
    printed = 27.27 / (1.0 + (0.315 - slip) ** 2 * (1.587 / slip - 1.416 * slip ** 2))
    assert at_slip(motor, slip) == pytest.approx(printed, rel=1e-9)  # slips near 0 are rounded


@motors
@given(share=st.floats(-2.0, 3.0))
def test_the_slope_is_the_derivative_of_the_torque(motor, share):
    speed = share * SYNCHRONOUS
    assume(abs(speed) > 2.0 * STEP)  # at standstill the curve of InductionMotor has a kink
    difference = (motor.torque(speed + STEP) - motor.torque(speed - STEP)) / (2.0 * STEP)
    peak = motor.breakdown_torque / (motor.breakdown_slip * SYNCHRONOUS)
    assert motor.slope(speed) == pytest.approx(difference, abs=DIFFERENCE * peak)


@motors
@given(share=st.floats(1.0, 5.0, exclude_min=True))
def test_faster_than_synchronous_the_motor_brakes(motor, share):
    assert motor.torque(share * SYNCHRONOUS) < 0.0


@motors
@given(share=st.floats(-5.0, 0.0))
def test_turned_backwards_the_motor_still_pulls_forwards(motor, share):
    assert 0.0 < motor.torque(share * SYNCHRONOUS) < motor.breakdown_torque


@motors
def test_the_curve_has_no_pole_and_no_step(motor):
    torque = motor.torque(np.linspace(-5.0, 5.0, 1_000_001) * SYNCHRONOUS)
    assert np.all(np.isfinite(torque))
    assert np.max(np.abs(torque)) < 20.0 * motor.breakdown_torque
    assert np.max(np.abs(np.diff(torque))) < 1e-2 * motor.breakdown_torque


@motors
def test_arrays_and_floats_give_the_same(motor):
    speeds = np.linspace(-200.0, 400.0, 7)
    for function in (motor.torque, motor.slope):
        assert function(speeds) == pytest.approx([float(function(x)) for x in speeds.tolist()],
                                                 rel=ROUNDING)


@given(rated=st.floats(0.5, 0.999), torque=st.floats(0.05, 0.95))
def test_a_motor_from_rated_figures_passes_its_rated_point_and_its_breakdown(rated, torque):
    motor = KlossMotor.from_rated(SYNCHRONOUS, rated * SYNCHRONOUS, torque * 30.0, 30.0, 0.01)
    assert motor.torque(rated * SYNCHRONOUS) == pytest.approx(torque * 30.0, rel=1e-9)
    assert at_slip(motor, motor.breakdown_slip) == pytest.approx(30.0, rel=ROUNDING)
    assert motor.breakdown_slip > 1.0 - rated  # the working side, not the one beyond breakdown


@pytest.mark.parametrize(('name', 'value', 'rule'), [
    ('synchronous_speed', 0.0, 'above 0'), ('synchronous_speed', inf, 'finite'),
    ('breakdown_torque', -27.27, 'above 0'), ('breakdown_torque', nan, 'finite'),
    ('breakdown_slip', 0.0, 'between 0 and 1'), ('breakdown_slip', 1.0, 'between 0 and 1'),
    ('breakdown_slip', nan, 'between 0 and 1'), ('a', 0.0, 'above 0'),
    ('inertia', -0.0028, 'above 0'), ('b', 1.6, 'must be finite from standstill'),
])
def test_an_induction_motor_refuses_nonsense_by_name(name, value, rule):
    with pytest.raises(ConfigurationError) as refused:
        InductionMotor(**{**NM_90L_4, name: value})
    problem, = refused.value.problems
    assert problem.path == name
    assert problem.value is value
    assert rule in problem.rule


def test_a_curve_with_a_pole_beyond_the_synchronous_speed_is_refused():
    with pytest.raises(ConfigurationError, match='must be finite from standstill to twice'):
        InductionMotor(**{**NM_90L_4, 'a': 0.3, 'b': 0.1})


def test_all_that_is_wrong_is_told_at_once():
    with pytest.raises(ConfigurationError) as refused:
        InductionMotor(-1.0, 0.0, 2.0, 1.587, 1.416, 0.0)
    assert {problem.path for problem in refused.value.problems} == {
        'synchronous_speed', 'breakdown_torque', 'breakdown_slip', 'inertia'}


@pytest.mark.parametrize('name', ['synchronous_speed', 'breakdown_torque', 'breakdown_slip',
                                  'inertia'])
@pytest.mark.parametrize('value', [0.0, -1.0, nan, inf])
def test_a_kloss_motor_refuses_nonsense_by_name(name, value):
    figures = {'synchronous_speed': SYNCHRONOUS, 'breakdown_torque': 27.0,
               'breakdown_slip': 0.3, 'inertia': 0.003}
    with pytest.raises(ConfigurationError) as refused:
        KlossMotor(**{**figures, name: value})
    assert [problem.path for problem in refused.value.problems] == [name]


@pytest.mark.parametrize(('rated_rpm', 'torque', 'path', 'rule'), [
    (1500.0, 10.0, 'rated_speed', 'below the synchronous speed of 1500 rpm'),
    (0.0, 10.0, 'rated_speed', 'below the synchronous speed of 1500 rpm'),
    (1421.0, 30.0, 'rated_torque', 'below the breakdown torque of 27 N m'),
    (1421.0, 0.0, 'rated_torque', 'below the breakdown torque of 27 N m'),
])
def test_a_rated_point_off_the_curve_is_refused(rated_rpm, torque, path, rule):
    with pytest.raises(ConfigurationError) as refused:
        KlossMotor.from_rated(SYNCHRONOUS, rated_rpm * RPM, torque, 27.0, 0.003)
    problem, = refused.value.problems
    assert problem.path == path
    assert rule in problem.rule


@pytest.mark.parametrize('b', [0.0, 5e-324, 1e-300, -1e-300, 1e-20])
def test_a_constant_too_small_to_matter_is_no_trouble(b):
    tiny, plain = (InductionMotor(157.08, 27.27, 0.315, 1.587, each, 0.0028) for each in (b, 0.0))
    assert tiny.torque(150.0) == plain.torque(150.0)


@given(st.floats(1.5, 5.0), st.floats(0.01, 0.08), st.floats(0.5, 0.99))
def test_a_curve_bent_to_the_torque_at_rest_keeps_breakdown_and_the_rated_point(
        ratio, slip, share):
    rated = (1.0 - slip) * 1500.0 * RPM
    kloss = KlossMotor.from_rated(1500.0 * RPM, rated, 5.0, 5.0 * ratio, 0.0026)
    # a motor gives more at rest than Kloss' curve; far below it the bent one would have a pole
    assume(share * 5.0 * ratio > 0.9 * float(kloss.torque(0.0)) and kloss.breakdown_slip < 0.6)
    bent = kloss.started_with(share * 5.0 * ratio, rated)
    assert float(bent.torque(0.0)) == pytest.approx(share * 5.0 * ratio, rel=1e-9)
    assert float(bent.torque(rated)) == pytest.approx(5.0, rel=1e-9)
    speeds = np.linspace(0.0, 1500.0 * RPM, 4001)
    torques = bent.torque(speeds)
    breakdown = (1.0 - kloss.breakdown_slip) * 1500.0 * RPM
    assert float(bent.torque(breakdown)) == pytest.approx(5.0 * ratio, rel=1e-12)
    assert np.max(torques) <= 5.0 * ratio * (1.0 + 1e-12)


def test_a_torque_at_rest_out_of_reach_is_refused():
    kloss = KlossMotor(1500.0 * RPM, 17.0, 0.25, 0.0026)
    for torque, said in ((17.0, 'below the breakdown torque'), (-1.0, 'below the breakdown'),
                         (0.3, 'out of the reach')):
        with pytest.raises(ConfigurationError, match=said):
            kloss.started_with(torque)
    # what the curve gives anyway bends nothing
    same = kloss.started_with(float(kloss.torque(0.0)))
    assert abs(same.b) < 1e-12 and same.a == pytest.approx(2.0)
