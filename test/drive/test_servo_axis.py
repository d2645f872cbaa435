# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A servo drive in motion: what it follows, what it cannot, and that both are told honestly."""

from dataclasses import replace
from math import inf, nan

from cam_motion.drive.inverse import FollowerDrive
from cam_motion.drive.servo_axis import ServoAxis
from cam_motion.drive.servo_cycle import limit_figures
from cam_motion.drive.servo_loop import ServoLoop
from cam_motion.drive.servo_motor import ServoMotor, TorqueLimit
from cam_motion.drive.set_motion import Setpoint
from cam_motion.errors import ConfigurationError
from cam_motion.motion.laws import make_law
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import Segment
from cam_motion.units import RPM, TURN
from hypothesis import given
from hypothesis import settings as budget
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

SECOND = 10 ** 9
ROUNDING = 1e-9

STRONG = ServoMotor(TorqueLimit([0.0], [1e6]), TorqueLimit([0.0], [1e6]), 1e-3, 1e6, 1e6)
PLATE = {'standstill_torque': 15.8, 'rated_torque': 15.8, 'rated_speed': 3000.0 * RPM,
         'peak_torque': 47.6, 'max_speed': 5000.0 * RPM, 'inertia': 12.3e-4}
MOTOR = ServoMotor.from_plate(**PLATE)
FEEDING_GROUP = FollowerDrive(
    radius=0.134, gear_ratio=9.0, efficiency=0.95, motor_inertia=12.3e-4, load_inertia=1.164,
    resistance_force=500.0)
FREE = FollowerDrive(motor_inertia=1e-3, load_inertia=5e-3)


def cam(law='modified_trapezoid', lift=0.3, rise=80.0, accumulate=True):
    back = [] if accumulate else [Segment('back', make_law(law), 270.0, -lift)]
    return CamProfile([Segment('feed', make_law(law), rise, lift), *back,
                       Segment('wait', make_law('dwell'), 360.0, 0.0)], accumulate)


FEED = cam()


def loop_of(drive, hertz=50.0, **gains):
    inertia = drive.motor_inertia + drive.load_inertia / drive.gear_ratio ** 2
    return ServoLoop.for_bandwidth(hertz * TURN, inertia, **gains)


def axis_of(drive=FEEDING_GROUP, motor=MOTOR, hertz=50.0, substep_ns=250_000, **gains):
    return ServoAxis(drive, motor, loop_of(drive, hertz, **gains), substep_ns)


def setpoints(profile, cpm, rate, cycles, first=-60.0):
    """Give the setpoints of a cam at a rate, from a shaft angle [deg] on."""
    omega = cpm * RPM
    for k in range(round(cycles * 60.0 / cpm * rate) + 1):
        time_ns = k * SECOND // rate
        phi = first * TURN / 360.0 + omega * time_ns * 1e-9
        y, slope, bend, _ = profile.sample(phi)
        yield Setpoint(time_ns, y, slope * omega, bend * omega * omega)


def smooth_setpoints(rate, lift=0.3):
    """Give the setpoints of a rise by a polynomial of fifth degree in 0.25 s, and of a wait."""
    for k in range(rate // 2 + 1):
        time_ns = k * SECOND // rate
        u = min(time_ns / 250_000_000, 1.0)
        yield Setpoint(time_ns, lift * u ** 3 * (10.0 - u * (15.0 - 6.0 * u)),
                       lift * 30.0 * (u * (1.0 - u)) ** 2 / 0.25,
                       lift * 60.0 * u * (1.0 - u * (3.0 - 2.0 * u)) / 0.25 ** 2)


def drive_through(axis, points):
    points = iter(points)
    return [axis.start(next(points)), *(axis.follow(point) for point in points)]


@pytest.mark.parametrize('always', [False, True])
@pytest.mark.parametrize('efficiency', [1.0, 0.9])
def test_an_axis_that_shall_stand_stands_exactly(always, efficiency):
    axis = axis_of(replace(FEEDING_GROUP, always_resists=always, efficiency=efficiency))
    states = drive_through(axis, (Setpoint(k * 2_000_000, 0.7) for k in range(200)))
    assert {(s.position, s.velocity, s.acceleration) for s in states} == {
        (states[0].position, 0.0, 0.0)}
    assert abs(states[-1].following_error) <= 1e-15
    assert axis.tally.motor_work == 0.0


@pytest.mark.parametrize('efficiency', [1.0, 0.8])
def test_there_is_no_error_where_the_feed_forward_is_exact(efficiency):
    # constant acceleration, which a torque that stands for a period can give
    drive = replace(FEEDING_GROUP, efficiency=efficiency)
    axis = axis_of(drive)
    points = [Setpoint(t, 2.0 * (t * 1e-9) ** 2, 4.0 * t * 1e-9, 4.0)
              for t in range(0, SECOND // 2, 3_700_000)]
    states = drive_through(axis, points)
    assert max(abs(s.following_error) for s in states) < 1e-12
    for point, state in list(zip(points, states))[1:]:
        exact = drive.follow(*point[1:])
        assert state.drive == pytest.approx(exact, rel=1e-6)


def test_the_torque_becomes_that_of_the_inverse_as_the_substep_shrinks():
    # where the sense of motion and of the flow of power do not change within a substep
    drive = replace(FEEDING_GROUP, resistance_force=0.0, efficiency=1.0)
    points = list(setpoints(FEED, 60.0, 1000, 1))
    exact = np.array([drive.follow(*point[1:]).motor_torque for point in points])
    worst, error = [], []
    for substep_ns in (500_000, 250_000, 125_000):
        axis = axis_of(drive, hertz=50.0, substep_ns=substep_ns)
        states = drive_through(axis, points)
        worst.append(np.max(np.abs([s.drive.motor_torque for s in states] - exact)))
        error.append(axis.tally.peak_error)
    assert worst[0] / worst[1] == pytest.approx(2.0, abs=0.3)  # half a substep old
    assert worst[1] / worst[2] == pytest.approx(2.0, abs=0.3)
    assert worst[2] < 0.01 * np.max(exact)
    assert error[0] / error[1] == pytest.approx(4.0, abs=0.5)
    assert error[1] / error[2] == pytest.approx(4.0, abs=0.5)


def test_without_velocity_feed_forward_the_axis_lags_by_velocity_over_gain():
    axis = axis_of(FREE, STRONG, hertz=20.0, velocity_feed_forward=0.0)
    states = drive_through(
        axis, (Setpoint(k * 2_000_000, 0.02 * k, 10.0) for k in range(2000)))
    assert states[-1].following_error == pytest.approx(10.0 / (0.25 * 20.0 * TURN), rel=1e-9)
    assert states[-1].velocity == pytest.approx(10.0, rel=1e-9)


@pytest.mark.parametrize('substep_ns', [100_000, 250_000, 700_000])
def test_the_rate_of_setpoints_does_not_show(substep_ns):
    # a motion of fifth degree whose ends fall on setpoints of every rate: one set motion for all
    found = {}
    for rate in (100, 200, 500, 1000):
        states = drive_through(axis_of(substep_ns=substep_ns), smooth_setpoints(rate))
        found[rate] = {s.time_ns: s for s in states}
    common = set.intersection(*(set(states) for states in found.values()))
    assert len(common) == 51  # every 10 ms
    for time_ns in common:
        for states in found.values():
            at, finest = states[time_ns], found[1000][time_ns]
            assert at.position == pytest.approx(finest.position, abs=1e-9)
            assert at.velocity == pytest.approx(finest.velocity, abs=1e-6)
            # not the torque: in sticking friction rounding decides when it is reversed


def test_at_any_rate_the_axis_runs_alike_on_the_cutting_machines_feed():
    positions = {}
    for rate in (100, 250, 500, 1000):
        states = drive_through(axis_of(), setpoints(FEED, 60.0, rate, 1))
        positions[rate] = {s.time_ns: s.position for s in states}
    for rate, worst in ((500, 2e-7), (250, 3e-6), (100, 5e-6)):  # what is between setpoints [m]
        assert max(abs(position - positions[1000][time])
                   for time, position in positions[rate].items()
                   if time in positions[1000]) < worst


def test_late_setpoints_are_followed_over_their_gap():
    # 5 setpoints lost: the set motion between the others is the same polynomial
    points = list(smooth_setpoints(500))
    whole = drive_through(axis_of(), points)
    some = drive_through(axis_of(), points[:40] + points[45:])
    assert some[-1].position == pytest.approx(whole[-1].position, abs=1e-9)
    assert some[60].position == pytest.approx(whole[65].position, abs=1e-9)


def test_beyond_the_budget_time_is_dropped_and_counted():
    points = list(setpoints(FEED, 60.0, 500, 1))
    axis = axis_of()
    axis.start(points[0])
    for point in points[1:100]:
        state = axis.follow(point, 50_000_000)
    assert axis.tally.dropped_ns == 0
    late = axis.follow(points[180], 50_000_000)
    assert axis.tally.dropped_ns == 162_000_000 - 50_000_000
    assert axis.tally.time_ns + axis.tally.dropped_ns == points[180].time_ns
    assert late.time_ns == points[180].time_ns
    assert abs(late.following_error) < abs(state.following_error) + 1e-3


def test_dropped_time_leaves_an_axis_at_rest_at_rest():
    axis = axis_of()
    axis.start(Setpoint(0, 0.7))
    state = axis.follow(Setpoint(10 * SECOND, 0.7), 50_000_000)
    assert (state.velocity, state.acceleration) == (0.0, 0.0)
    assert axis.tally.dropped_ns == 9_950_000_000


def test_a_silent_stream_ends_in_standstill():
    axis = axis_of(FREE, MOTOR)
    axis.start(Setpoint(0, 0.0, 20.0))
    axis.follow(Setpoint(2_000_000, 0.04, 20.0))
    axis.come_to_rest(100_000_000)
    states = [axis.advance(2_000_000 + k * 7_000_000) for k in range(1, 60)]
    assert [s.time_ns for s in states] == [2_000_000 + k * 7_000_000 for k in range(1, 60)]
    assert all(a.position < b.position + 1e-6 for a, b in zip(states, states[1:]))
    assert states[-1].position == pytest.approx(0.04 + 20.0 * 0.1 / 2.0, abs=1e-6)
    assert abs(states[-1].velocity) < 1e-6
    again = axis.follow(Setpoint(states[-1].time_ns - 1_000_000, states[-1].position))
    assert again.time_ns == states[-1].time_ns  # a setpoint already passed moves nothing
    assert axis.follow(Setpoint(SECOND, states[-1].position)).velocity == pytest.approx(
        0.0, abs=1e-6)


def test_a_motor_too_weak_lags_is_counted_and_recovers():
    axis = axis_of()
    states = drive_through(axis, setpoints(FEED, 100.0, 500, 3))
    tally = axis.tally
    assert tally.peak_torque == 47.6
    assert 0.05 < tally.peak_error < 0.15
    assert tally.saturations == 3 * 2  # speeding up and braking
    assert 0.4 < tally.saturated_ns / SECOND < 0.7
    waits = [s for s, point in zip(states, setpoints(FEED, 100.0, 500, 3))
             if point.time_ns % 600_000_000 > 550_000_000 or point.time_ns == 0]
    assert max(abs(s.following_error) for s in waits) < 1e-4  # in every dwell it has caught up
    overrun = -min(s.following_error for s in states)
    assert overrun < 0.15 * tally.peak_error


def test_a_set_speed_beyond_the_motor_is_cut_to_its_largest_speed():
    motor = ServoMotor.from_plate(**{**PLATE, 'rated_speed': 40.0, 'max_speed': 50.0})
    axis = axis_of(FREE, motor)
    states = drive_through(
        axis, (Setpoint(k * 2_000_000, 0.12 * k, 60.0) for k in range(500)))
    assert states[-1].drive.motor_velocity == pytest.approx(50.0, rel=1e-6)
    assert states[-1].following_error == pytest.approx(10.0 * 0.998, rel=1e-2)
    assert axis.tally.saturated_ns == pytest.approx(axis.tally.time_ns, rel=0.01)


def test_braking_feeds_energy_back():
    axis = axis_of(FREE, STRONG)
    drive_through(axis, smooth_setpoints(500, lift=10.0))
    top = 10.0 * 1.875 / 0.25  # the peak velocity of the polynomial
    kinetic = 0.5 * 6e-3 * top ** 2
    assert axis.tally.regenerated_energy == pytest.approx(kinetic, rel=1e-4)
    assert axis.tally.motor_work == pytest.approx(0.0, abs=1e-4 * kinetic)


def test_thermal_load_compares_rms_and_continuous_torque_at_rms_speed():
    axis = axis_of()
    drive_through(axis, setpoints(FEED, 60.0, 500, 3))
    tally = axis.tally
    # over a time short against the time constant the running means are plain means
    assert tally.running_rms_torque == pytest.approx(tally.rms_torque, rel=0.02)
    limits = limit_figures(FEEDING_GROUP, MOTOR, FEED, 60.0 * RPM)
    assert tally.running_speed == pytest.approx(limits.rms_speed, rel=0.02)
    assert tally.thermal_load == pytest.approx(tally.running_rms_torque / 15.8, rel=1e-9)


SERVOS = st.tuples(
    st.builds(FollowerDrive, radius=st.floats(0.02, 1.0), gear_ratio=st.floats(1.0, 20.0),
              efficiency=st.sampled_from([1.0, 0.7]), motor_inertia=st.floats(1e-4, 1e-2),
              load_inertia=st.floats(0.0, 2.0), resistance_force=st.floats(0.0, 500.0),
              always_resists=st.booleans()),
    st.floats(1.0, 100.0), st.floats(50.0, 500.0))


@budget(max_examples=25, deadline=None)
@given(servo=SERVOS, law=st.sampled_from(['cycloidal', 'constant_acceleration']),
       cpm=st.floats(30.0, 200.0), lift=st.floats(-0.3, 0.3))
def test_any_drive_keeps_its_limits_and_its_energy(servo, law, cpm, lift):
    drive, peak, fastest = servo
    motor = ServoMotor.from_plate(
        standstill_torque=peak / 3.0, rated_torque=peak / 4.0, rated_speed=0.7 * fastest,
        peak_torque=peak, max_speed=fastest, inertia=1e-4)
    axis = axis_of(drive, motor)
    profile = cam(law, lift, accumulate=False)
    points = setpoints(profile, cpm, 250, 0.5)
    first = axis.start(next(points))
    inertia = drive.motor_inertia + drive.load_inertia / drive.gear_ratio ** 2
    before = first
    for point in points:
        state = axis.follow(point)
        assert abs(state.drive.motor_torque) <= peak
        # at the sample of the loop the torque was within the curve at the speed of then
        change = 0.00025 * 3.0 * (peak + drive.resistance_force * drive.radius) / (
            inertia * drive.efficiency)
        slower = max(0.0, abs(state.drive.motor_velocity) - change)
        assert abs(state.drive.motor_torque) <= motor.peak(slower) * (1.0 + ROUNDING)
        before = state
    work = axis.tally.motor_work
    stored = 0.5 * inertia * (before.drive.motor_velocity ** 2 - first.drive.motor_velocity ** 2)
    if drive.always_resists:
        stored += drive.resistance_force * (before.position - first.position)
        lost = work - stored
        if drive.efficiency == 1.0:
            assert abs(lost) <= 1e-9 * (abs(work) + 2.0 * axis.tally.regenerated_energy + 1.0)
    assert work - stored >= -1e-9 * (abs(work) + 2.0 * axis.tally.regenerated_energy + 1.0)
    assert axis.tally.saturated_ns <= axis.tally.time_ns


def test_gains_follow_from_bandwidth_and_inertia_unless_given():
    loop = ServoLoop.for_bandwidth(400.0, 0.5)
    assert (loop.position_gain, loop.velocity_gain, loop.integral_time) == (100.0, 200.0, 0.01)
    given_gains = ServoLoop.for_bandwidth(400.0, 0.5, position_gain=7.0, integral_time=inf)
    assert (given_gains.position_gain, given_gains.integral_time) == (7.0, inf)


def test_gains_that_make_no_loop_are_refused_all_at_once():
    with pytest.raises(ConfigurationError) as error:
        ServoLoop(0.0, nan, -1.0, 1.5, 0.5)
    assert [problem.path for problem in error.value.problems] == [
        'position_gain', 'velocity_gain', 'integral_time', 'velocity_feed_forward']


def test_a_substep_too_long_for_the_gains_is_refused():
    with pytest.raises(ConfigurationError, match='must be at most 0.00159 s'):
        axis_of(hertz=50.0, substep_ns=2_000_000)


def test_a_drive_without_inertia_is_refused():
    with pytest.raises(ConfigurationError, match='needs an inertia'):
        ServoAxis(FollowerDrive(), MOTOR, ServoLoop(1.0, 1.0, 1.0))
