# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Stops of the master shaft by its services: where it comes to rest, and what it then refuses."""

from itertools import pairwise
import math

from cam_motion.nodes.master_shaft import MasterShaft
from cam_motion.units import RPM, TURN
import pytest
from std_srvs.srv import SetBool, Trigger

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

AT_CYCLE_END = 1e-9  # rad
ROUNDING = 1e-9
SETTINGS = {'max_catch_up': 10.0, 'start_delay': 0.0, 'acceleration': 60.0, 'jerk': 900.0}


@pytest.fixture
def turning(world):
    """Make a shaft that has reached its set speed [cycles/min]; give its points."""
    def turning(speed_cpm):
        node = world.make(MasterShaft, {**SETTINGS, 'speed_cpm': speed_cpm})
        node.trigger_configure()
        node.trigger_activate()
        points = world.points('shaft')
        assert world.spin_until(lambda: points and points[-1].velocity == speed_cpm * RPM)
        return points
    return turning


def rests(points):
    """Say whether the shaft stands."""
    return points[-1][1:3] == (0.0, 0.0)


def check_changes(points, acceleration, jerk):
    """Check the changes from tick to tick against limits."""
    for one, two in pairwise(points):
        h = two.time - one.time
        assert abs(two.velocity - one.velocity) <= acceleration * h + ROUNDING
        assert abs(two.acceleration - one.acceleration) <= jerk * h + ROUNDING


@pytest.mark.parametrize('speed', [150.0, -80.0])
def test_it_comes_to_rest_at_the_end_of_a_cycle(world, turning, speed):
    points = turning(speed)
    states = world.states('master_shaft')
    begin = len(points)
    answer = world.call(Trigger, 'master_shaft/stop_at_cycle_end')
    assert answer.success and 'end of a cycle' in answer.message
    assert world.spin_until(lambda: rests(points))
    cycles = points[-1].position / TURN
    assert abs(points[-1].position - round(cycles) * TURN) <= AT_CYCLE_END
    assert math.copysign(1.0, round(cycles)) == math.copysign(1.0, speed)
    check_changes(points[begin:], 60.0, 900.0)
    # not past the end and back: the angle changes in one sense only
    assert all(speed * point.velocity >= 0.0 for point in points)
    assert world.spin_until(lambda: states[-1:] == ['stopped'])
    assert 'stopping_at_cycle_end' in states


def test_after_a_stop_at_the_cycle_end_it_runs_again(world, turning):
    points = turning(120.0)
    assert world.call(Trigger, 'master_shaft/stop_at_cycle_end').success
    assert world.spin_until(lambda: rests(points))
    assert world.call(SetBool, 'master_shaft/run', data=True).success
    assert world.spin_until(lambda: points[-1].velocity == 120.0 * RPM)
    check_changes(points, 60.0, 900.0)


def test_a_shaft_that_stands_cannot_stop_at_the_cycle_end(world, turning):
    points = turning(60.0)
    assert world.call(SetBool, 'master_shaft/run', data=False).success
    assert world.spin_until(lambda: rests(points))
    answer = world.call(Trigger, 'master_shaft/stop_at_cycle_end')
    assert not answer.success
    assert 'not running' in answer.message and 'stopped' in answer.message


def test_a_controlled_stop_comes_to_rest_and_stays_there(world, turning):
    points = turning(150.0)
    states = world.states('master_shaft')
    answer = world.call(SetBool, 'master_shaft/run', data=False)
    assert answer.success and 'stops' in answer.message
    assert world.spin_until(lambda: rests(points) and states[-1:] == ['stopped'])
    assert 'stopping' in states
    standing = points[-1].position
    count = len(points)
    assert world.spin_until(lambda: len(points) > count + 100)
    assert {point[:3] for point in points[count:]} == {(standing, 0.0, 0.0)}
    check_changes(points, 60.0, 900.0)


def test_a_quick_stop_is_latched_until_it_is_reset(world, turning):
    points = turning(200.0)
    states = world.states('master_shaft')
    begin = len(points)
    assert world.call(Trigger, 'master_shaft/quick_stop').success
    answer = world.call(Trigger, 'master_shaft/reset')
    assert not answer.success and 'still turning' in answer.message
    assert world.spin_until(lambda: rests(points))
    check_changes(points[begin:], 150.0, 3000.0)
    assert min(point.acceleration for point in points[begin:]) < -60.0 * (1.0 + ROUNDING)
    assert world.spin_until(lambda: states[-1:] == ['quick_stopped'])
    assert 'quick_stopping' in states
    answer = world.call(SetBool, 'master_shaft/run', data=True)
    assert not answer.success and 'reset' in answer.message
    count = len(points)
    assert world.spin_until(lambda: len(points) > count + 50)
    assert rests(points)
    assert world.call(Trigger, 'master_shaft/reset').success
    assert world.spin_until(lambda: states[-1:] == ['stopped'])
    assert rests(points)
    assert world.call(SetBool, 'master_shaft/run', data=True).success
    assert world.spin_until(lambda: points[-1].velocity == 200.0 * RPM)


def test_a_command_during_the_start_delay_takes_its_place(world):
    node = world.make(MasterShaft, {**SETTINGS, 'start_delay': 1.0})
    node.trigger_configure()
    node.trigger_activate()
    points = world.points('shaft')
    assert world.call(SetBool, 'master_shaft/run', data=False).success
    assert world.spin_until(lambda: points and points[-1].time > 1.5)
    assert {point[:3] for point in points} == {(0.0, 0.0, 0.0)}


def test_begin_stop_brings_a_slow_ramp_to_rest_by_the_quick_stop(world):
    slow = {**SETTINGS, 'speed_cpm': 60.0, 'acceleration': 1.0, 'jerk': 100.0}
    node = world.make(MasterShaft, slow)
    node.trigger_configure()
    node.trigger_activate()
    points = world.points('shaft')
    # from here on the ordinary stop would take 4 s
    assert world.spin_until(lambda: points and points[-1].velocity > 4.0)
    node.begin_stop()
    assert not node.stopped
    assert world.spin_until(lambda: node.stopped)
    assert world.spin_until(lambda: rests(points))
    stop = [point for point in points if point.acceleration < 0.0]
    assert stop[-1].time - stop[0].time < 1.0  # of the machine's time
    check_changes(points, 150.0, 3000.0)


def test_the_state_is_told_without_joint_states_too(world):
    node = world.make(MasterShaft, {'joint_states_hz': 0.0, 'start_delay': 0.0})
    states = world.states('master_shaft')
    node.trigger_configure()
    node.trigger_activate()
    assert world.spin_until(lambda: 'running' in states)
    assert world.call(SetBool, 'master_shaft/run', data=False).success
    assert world.spin_until(lambda: states[-1] == 'stopped')
