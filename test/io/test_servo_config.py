# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Servo motors and servo drives in a configuration: what is built, and what is refused."""

from cam_motion.errors import ConfigurationError
from cam_motion.io.machine import build_drive, build_machine
from cam_motion.io.simulation import simulate
from cam_motion.units import RPM, TURN
import pytest

pytestmark = pytest.mark.timeout(60)

PLATE = {'motor.inertia': 0.00123, 'motor.rated_rpm': 3000.0, 'motor.max_rpm': 5000.0,
         'motor.rated_torque': 15.8, 'motor.peak_torque': 47.6}
CURVES = {'motor.inertia': 0.00123, 'motor.rated_rpm': 3000.0, 'motor.max_rpm': 5000.0,
          'motor.peak_curve_rpm': [0.0, 3000.0, 5000.0],
          'motor.peak_curve_torque': [47.6, 47.6, 15.8],
          'motor.continuous_curve_rpm': [0.0, 3000.0, 5000.0],
          'motor.continuous_curve_torque': [15.8, 15.8, 9.48]}
DRIVE = {'axis': 'feeder', 'radius': 0.134, 'gear_ratio': 9.0, 'efficiency': 0.95,
         'load_inertia': 1.164, 'resistance_force': 500.0}
SERVO = {**DRIVE, 'mode': 'servo', **PLATE}
FEEDER = {'cycle': 'accumulate', 'segments': ['feed', 'wait'], 'feed.law': 'modified_trapezoid',
          'feed.end_deg': 80.0, 'feed.lift': 0.3, 'wait.end_deg': 360.0}
ROUNDING = 1e-9


def problems_of(given):
    with pytest.raises(ConfigurationError) as error:
        build_drive('drive', given)
    return {problem.path: problem for problem in error.value.problems}


def simulated(drive, cpm):
    machine = build_machine({'feeder': FEEDER, 'drive': drive, 'master_shaft': {'speed_cpm': cpm}})
    return simulate(machine)['drive']


def test_a_plate_and_the_points_of_its_curves_make_the_same_motor():
    plate, curves = (build_drive('drive', {**DRIVE, **motor}).motor for motor in (PLATE, CURVES))
    for rpm in (0.0, 1000.0, 3000.0, 4000.0, 5000.0):
        for one in ('peak_torque', 'continuous_torque'):
            assert getattr(plate, one)(rpm * RPM) == pytest.approx(
                getattr(curves, one)(rpm * RPM), rel=ROUNDING)
    assert (plate.max_speed, plate.rated_speed) == (5000.0 * RPM, 3000.0 * RPM)


def test_the_rotor_is_added_to_what_else_is_on_the_motor_shaft():
    built = build_drive('drive', {**DRIVE, **PLATE, 'motor_inertia': 0.002})
    assert built.drive.motor_inertia == pytest.approx(0.00323)
    assert built.servo is None
    assert build_drive('drive', DRIVE).motor is None


def test_gains_follow_from_the_bandwidth_and_all_inertia():
    servo = build_drive('drive', {**SERVO, 'loop.bandwidth_hz': 20.0}).servo
    inertia = 0.00123 + 1.164 / 81.0
    assert servo.loop.velocity_gain == pytest.approx(20.0 * TURN * inertia)
    assert servo.loop.position_gain == pytest.approx(20.0 * TURN / 4.0)
    assert servo.loop.integral_time == pytest.approx(4.0 / (20.0 * TURN))
    assert (servo.substep_ns, servo.max_catch_up_ns) == (250_000, 50_000_000)


def test_a_servo_drive_needs_a_motor():
    wanting = problems_of({**DRIVE, 'mode': 'servo'})
    assert set(wanting) == {'motor.inertia', 'motor.rated_rpm', 'motor.max_rpm'}
    wanting = problems_of({name: value for name, value in SERVO.items() if 'torque' not in name})
    assert set(wanting) == {'motor.rated_torque', 'motor.peak_torque'}


@pytest.mark.parametrize('change, path, said', [
    ({'motor.max_rpm': 2000.0}, 'motor.rated_rpm', 'at most max_rpm, 2000'),
    ({'motor.corner_rpm': 6000.0}, 'motor.corner_rpm', 'at most max_rpm, 5000'),
    ({'motor.rated_torque': 50.0}, 'motor.standstill_torque', 'at most peak_torque, 47.6'),
    ({'motor.peak_torque': -1.0}, 'motor.peak_torque', 'above 0'),
    ({'motor.peak_curve_rpm': [0.0]}, 'motor.peak_curve_torque', 'needs this figure'),
    ({'loop.substep': 0.01}, 'loop.substep', 'must be at most 0.00159 s'),
    ({'loop.velocity_feed_forward': 1.5}, 'loop.velocity_feed_forward', 'at most 1'),
    ({'loop.bandwith_hz': 5.0}, 'loop.bandwith_hz', 'no such parameter'),
])
def test_what_makes_no_servo_drive_is_refused_with_its_place(change, path, said):
    problem = problems_of({**SERVO, **change})[path]
    assert said in str(problem)


@pytest.mark.parametrize('change, path', [
    ({'motor.peak_curve_rpm': [0.0, 5.0]}, 'motor.peak_curve_torque'),
    ({'motor.continuous_curve_rpm': [1.0, 2.0, 3.0]}, 'motor.continuous_curve_rpm'),
    ({'motor.peak_torque': 4.0}, 'motor.peak_torque'),
    ({'motor.continuous_curve_torque': [60.0, 1.0, 1.0]}, 'motor.continuous_curve_torque'),
    ({'motor.peak_curve_torque': [0.0, 1.0, 1.0]}, 'motor.peak_curve_torque'),
])
def test_points_that_make_no_curve_are_refused_with_their_place(change, path):
    assert path in problems_of({**DRIVE, **CURVES, **change})


def test_a_motor_adds_its_margins_to_the_figures_of_a_cycle():
    found = simulated({**DRIVE, **PLATE, 'motor.torque_constant': 0.6}, 60.0)
    # within the range of the held peak torque the least distance is that at the peak
    assert found['peak_torque_margin'] == pytest.approx(47.6 - found['peak_torque'], rel=ROUNDING)
    assert found['rms_torque_margin'] == pytest.approx(15.8 - found['rms_torque'], rel=ROUNDING)
    assert found['speed_margin_rpm'] == pytest.approx(5000.0 - found['peak_speed_rpm'])
    # one lift of 0.3 m per second
    assert found['mean_speed_rpm'] * RPM == pytest.approx(0.3 / 0.134 * 9.0, rel=1e-9)
    assert found['peak_current'] == pytest.approx(found['peak_torque'] / 0.6)
    assert 'servo' not in found
    assert 'peak_torque_margin' not in simulated(DRIVE, 60.0)


def test_the_continuous_torque_is_that_at_rms_speed_as_in_sizing():
    found = simulated({**DRIVE, **PLATE, 'motor.rated_rpm': 100.0}, 60.0)
    assert found['rms_speed_rpm'] > 2.0 * found['mean_speed_rpm']
    motor = build_drive('drive', {**DRIVE, **PLATE, 'motor.rated_rpm': 100.0}).motor
    bound = float(motor.continuous_torque(found['rms_speed_rpm'] * RPM))
    assert found['rms_torque_margin'] == pytest.approx(bound - found['rms_torque'], rel=ROUNDING)


def test_a_servo_drive_within_its_limits_costs_what_the_exact_motion_costs():
    found = simulated(SERVO, 60.0)
    live = found['servo']
    for name in ('peak_torque', 'rms_torque', 'peak_speed_rpm', 'motor_work_per_cycle'):
        assert live[name] == pytest.approx(found[name], rel=2e-3)
    assert live['saturated_s_per_cycle'] == 0.0 == live['saturations_per_cycle']
    assert live['catches_up'] is True
    assert live['peak_following_error'] < 1e-5


def test_a_motor_too_weak_is_told_by_its_margin_and_by_its_lag():
    found = simulated(SERVO, 100.0)
    assert found['peak_torque_margin'] < 0.0
    live = found['servo']
    assert live['peak_torque'] == 47.6
    assert live['peak_following_error'] > 0.05
    assert live['saturated_s_per_cycle'] > 0.1
    assert live['catches_up'] is True  # in the dwell


def test_a_motor_slower_than_the_mean_of_its_axis_falls_behind_for_good():
    found = simulated({**SERVO, 'motor.rated_rpm': 100.0, 'motor.max_rpm': 150.0}, 60.0)
    assert found['mean_speed_rpm'] == pytest.approx(192.4, abs=0.1)
    assert found['speed_margin_rpm'] < 0.0
    live = found['servo']
    assert live['catches_up'] is False
    assert live['peak_speed_rpm'] == pytest.approx(150.0, rel=0.01)
    assert live['saturated_s_per_cycle'] == pytest.approx(1.0)


def test_a_shaft_that_stands_has_no_cycle_to_simulate():
    with pytest.raises(ConfigurationError, match=r'master_shaft\.speed_cpm.*without a speed'):
        simulated(SERVO, 0.0)
