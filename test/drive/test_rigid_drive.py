# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Motor, gearbox and load as one mass, and the set motion between setpoints."""

from cam_motion.drive.inverse import FollowerDrive
from cam_motion.drive.rigid_drive import RigidDrive
from cam_motion.drive.set_motion import SetMotion, Setpoint, stop_from
from hypothesis import assume, given
from hypothesis import strategies as st
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-9  # of differences of sums of terms of the same size

DRIVES = st.builds(
    FollowerDrive, radius=st.floats(0.01, 2.0), gear_ratio=st.floats(0.5, 30.0),
    efficiency=st.floats(0.3, 1.0), motor_inertia=st.floats(1e-4, 1.0),
    load_inertia=st.floats(0.0, 5.0), resistance_force=st.floats(0.0, 1e3),
    always_resists=st.booleans())
RIGID = st.builds(RigidDrive.of, DRIVES)
PULLED = st.builds(  # by a spring or a weight, and with friction at once
    RigidDrive, st.floats(1e-4, 1.0), st.floats(0.0, 5.0), st.floats(0.0, 100.0),
    st.floats(-100.0, 100.0), st.floats(0.3, 1.0))
SPEEDS = st.floats(-100.0, 100.0)
RATES = st.floats(-1e4, 1e4)
TORQUES = st.floats(-300.0, 300.0)
TIMES = st.floats(1e-5, 0.1)


def most(drive):
    """Give the largest torque by which a load resists."""
    return drive.friction + abs(drive.pull)


def behind_losses(drive, torque):
    """Give the torque of the motor against a torque that resists, or drives if negative."""
    return torque / drive.efficiency if torque > 0.0 else torque * drive.efficiency


@given(drive=DRIVES, velocity=SPEEDS, rate=RATES)
def test_the_torque_is_that_of_the_drive_it_is_reduced_from(drive, velocity, rate):
    state = drive.follow(0.0, velocity, rate)
    scale = drive.gear_ratio / drive.radius
    reduced = RigidDrive.of(drive)
    torque = reduced.torque(velocity * scale, rate * scale)
    size = (drive.motor_inertia + drive.load_inertia) * abs(rate * scale) + 1e3 * scale
    assert torque == pytest.approx(state.motor_torque, rel=ROUNDING, abs=1e-12 * size)
    assume(velocity != 0.0 and abs(state.load_torque) > 1e-6 * size)
    assert reduced.load_torque(torque, velocity * scale) * drive.gear_ratio == pytest.approx(
        state.load_torque, rel=1e-5)


@given(drive=RIGID | PULLED, velocity=SPEEDS.filter(bool), rate=RATES)
def test_the_acceleration_is_the_one_that_the_torque_was_computed_for(drive, velocity, rate):
    back = drive.acceleration(drive.torque(velocity, rate), velocity)
    assert back == pytest.approx(rate, rel=ROUNDING, abs=1e-9 * (1.0 + most(drive) / (
        drive.motor_inertia + drive.load_inertia)))


@given(drive=RIGID | PULLED, torque=TORQUES)
def test_at_rest_the_drive_starts_only_with_more_than_what_holds_it(drive, torque):
    rate = drive.acceleration(torque, 0.0)
    forwards, backwards = (sense * behind_losses(drive, sense * drive.pull + drive.friction)
                           for sense in (1.0, -1.0))
    slack = 1e-9 * (most(drive) + abs(torque))
    if rate > 0.0:
        assert torque > forwards - slack
    elif rate < 0.0:
        assert torque < backwards + slack
    else:
        assert backwards - slack <= torque <= forwards + slack


@given(drive=RIGID | PULLED, velocity=SPEEDS, torque=TORQUES, time=TIMES)
def test_work_goes_into_motion_and_losses(drive, velocity, torque, time):
    move = drive.move(0.0, velocity, torque, time)
    work = torque * (move.before + move.after)
    inertia = drive.motor_inertia + drive.load_inertia
    stored = 0.5 * inertia * (move.velocity ** 2 - velocity ** 2)
    taken = (drive.pull * (move.before + move.after)
             + drive.friction * (abs(move.before) + abs(move.after)))
    size = (inertia * (velocity ** 2 + move.velocity ** 2)
            + (abs(torque) + most(drive)) * (abs(move.before) + abs(move.after)))
    gear = work - stored - taken
    if drive.efficiency == 1.0:
        assert abs(gear) <= ROUNDING * size
    else:
        assert gear >= -ROUNDING * size  # a gearbox gives no power


@given(drive=RIGID | PULLED, velocity=SPEEDS, torque=TORQUES, time=TIMES, cut=st.floats(0.0, 1.0))
def test_a_move_may_be_cut_anywhere(drive, velocity, torque, time, cut):
    whole = drive.move(1.0, velocity, torque, time)
    first = drive.move(1.0, velocity, torque, cut * time)
    second = drive.move(first.position, first.velocity, torque, time - cut * time)
    inertia = drive.motor_inertia + drive.load_inertia
    quick = abs(velocity) + time * (abs(torque) + most(drive)) / (
        inertia * drive.efficiency)
    assert second.velocity == pytest.approx(whole.velocity, abs=ROUNDING * quick)
    assert second.position == pytest.approx(whole.position, abs=ROUNDING * (1.0 + quick))


def test_a_brake_brings_the_drive_to_rest_and_friction_keeps_it_there():
    drive = RigidDrive(1.0, 0.0, friction=2.0)
    move = drive.move(0.0, 1.0, -1.0, 5.0)
    assert move == pytest.approx((1.0 / 6.0, 0.0, 1.0 / 6.0, 0.0))


@given(drive=PULLED, torque=TORQUES)
def test_what_the_gearbox_holds_at_rest_lies_between_what_friction_allows(drive, torque):
    assume(drive.acceleration(torque, 0.0) == 0.0)
    held = drive.load_torque(torque, 0.0)
    assert drive.pull - drive.friction <= held <= drive.pull + drive.friction


def test_a_torque_beyond_friction_turns_the_drive_back():
    drive = RigidDrive(1.0, 0.0, friction=2.0)
    move = drive.move(0.0, 5.0, -3.0, 3.0)  # at rest after 1 s, then -1 rad/s² for 2 s
    assert move == pytest.approx((0.5, -2.0, 2.5, -2.0))


@given(st.lists(st.floats(-10.0, 10.0), min_size=6, max_size=6), st.integers(1, 50))
def test_polynomials_of_fifth_degree_are_met_everywhere(shape, milliseconds):
    span = milliseconds * 1_000_000

    def curve(time_ns):
        u = time_ns * 1e-9
        return Setpoint(
            time_ns + 7, sum(c * u ** k for k, c in enumerate(shape)),
            sum(k * c * u ** (k - 1) for k, c in enumerate(shape) if k),
            sum(k * (k - 1) * c * u ** (k - 2) for k, c in enumerate(shape) if k > 1))

    motion = SetMotion(curve(0), curve(span))
    for share in (0, span // 3, span // 2, span):
        wanted, got = curve(share), motion.at(share + 7)
        time = milliseconds * 1e-3
        for order in (0, 1, 2):  # a derivative loses as many figures as the time has powers
            assert got[order] == pytest.approx(wanted[order + 1], abs=1e-12 / time ** order)


@given(velocity=SPEEDS, rate=SPEEDS, milliseconds=st.integers(1, 500))
def test_a_stop_ends_at_rest_without_swinging_in_velocity(velocity, rate, milliseconds):
    start = Setpoint(5, 3.0, velocity, rate)
    rest = stop_from(start, milliseconds * 1_000_000)
    motion = SetMotion(start, rest)
    assert motion.at(rest.time_ns) == (rest.position, 0.0, 0.0, 0.0)
    assert motion.at(rest.time_ns + 10 ** 12) == (rest.position, 0.0, 0.0, 0.0)
    middle = motion.at(5 + milliseconds * 500_000)
    time = milliseconds * 1e-3
    assert middle.velocity == pytest.approx(
        velocity / 2.0 + rate * time / 8.0, abs=1e-9 * (1.0 + abs(velocity) + abs(rate)))


def test_setpoints_must_follow_one_another():
    with pytest.raises(ValueError, match='later'):
        SetMotion(Setpoint(5, 0.0), Setpoint(5, 0.0))


def test_the_smallest_speed_there_is_goes_on():
    move = RigidDrive(1.0, 0.0).move(0.0, 5e-324, 0.0, 0.0625)
    assert move.velocity == 5e-324
