# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The master shaft as a node: its ticks are a grid, and its motion is the closed form."""

from itertools import pairwise

from cam_motion.nodes.master_shaft import MasterShaft
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.units import RPM
import pytest
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, Trigger

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

ACCELERATION, JERK = 30.0, 300.0  # rad/s², rad/s³
QUICK_ACCELERATION, QUICK_JERK = 150.0, 3000.0
ROUNDING = 1e-9
# No tick is given up, however busy the machine that runs the tests.
PATIENT = {'max_catch_up': 10.0, 'start_delay': 0.0, 'acceleration': ACCELERATION, 'jerk': JERK}


class Spy:
    """Notes the commands that a shaft is given."""

    def __init__(self, shaft):
        self._shaft = shaft
        self.commands = []

    def __getattr__(self, name):
        """Pass on, and note what changes the motion."""
        method = getattr(self._shaft, name)
        if name not in ('run', 'stop', 'quick_stop', 'stop_at_cycle_end', 'reset', 'set_speed'):
            return method

        def noted(t, *arguments):
            self.commands.append((t, name, arguments))
            return method(t, *arguments)
        return noted


def activate(world, node):
    """Bring a master up that is heard from its first tick on; give the points."""
    node.trigger_configure()
    points = world.points('shaft')
    assert world.spin_until(lambda: node._ticker.points.get_subscription_count() == 1)
    node.trigger_activate()
    return points


def time_ns(point):
    """Give the time of a point in nanoseconds."""
    return point.sec * 10**9 + point.nanosec


def check_replay(points, commands, speed):
    """Check that points are, to the last bit, what the closed form gives for the commands."""
    shaft = Shaft(speed, RampLimits(ACCELERATION, JERK),
                  RampLimits(QUICK_ACCELERATION, QUICK_JERK))
    waiting = list(commands)
    for point in points:
        t = time_ns(point) * 1e-9
        while waiting and waiting[0][0] <= t:
            at, name, arguments = waiting.pop(0)
            getattr(shaft, name)(at, *arguments)
        assert point[:3] == tuple(shaft.state(t)), t
    assert len(waiting) < len(commands), 'no command took effect'


def check_smooth(points, acceleration=ACCELERATION, jerk=JERK):
    """Check that neither angle nor speed nor acceleration jumps from tick to tick."""
    for one, two in pairwise(points):
        h = (time_ns(two) - time_ns(one)) * 1e-9
        assert abs(two.acceleration) <= acceleration * (1.0 + ROUNDING)
        assert abs(two.acceleration - one.acceleration) <= jerk * h + ROUNDING
        assert abs(two.velocity - one.velocity) <= acceleration * h + ROUNDING
        mean = 0.5 * h * (one.velocity + two.velocity)
        assert abs(two.position - one.position - mean) <= jerk * h**3 / 12.0 + ROUNDING


@pytest.mark.parametrize('rate', [300.0, 500.0, 1000.0])
def test_ticks_are_an_exact_grid_in_nanoseconds(world, rate):
    node = world.make(MasterShaft, {**PATIENT, 'rate_hz': rate})
    points = activate(world, node)
    assert world.spin_until(lambda: len(points) > rate)
    assert node._ticker.schedule.missed == 0
    assert [time_ns(point) for point in points] == [
        round(k * 10**9 / rate) for k in range(len(points))]


def test_the_motion_is_the_closed_form_of_the_commands_given(world):
    node = world.make(MasterShaft, {**PATIENT, 'speed_cpm': 150.0})
    node.trigger_configure()
    node._shaft = spy = Spy(node._shaft)
    points = world.points('shaft')
    node.trigger_activate()
    speed = world.speaker(Float64, 'master_shaft/speed_cpm')
    assert world.spin_until(lambda: points and points[-1].velocity > 60.0 * RPM)
    for cpm in (-40.0, 200.0, 10.0):  # each during the ramp before
        speed.publish(Float64(data=cpm))
        count = len(points)
        assert world.spin_until(lambda: len(points) > count + 100)
    assert world.call(SetBool, 'master_shaft/run', data=False).success
    assert world.spin_until(lambda: points[-1][1:3] == (0.0, 0.0))
    assert world.call(SetBool, 'master_shaft/run', data=True).success
    assert world.spin_until(lambda: points[-1].velocity == 10.0 * RPM)
    assert [name for _, name, _ in spy.commands] == [
        'run', 'set_speed', 'set_speed', 'set_speed', 'stop', 'run']
    check_replay(points, spy.commands, 150.0 * RPM)
    check_smooth(points)


def test_speed_commands_in_quick_succession_never_make_it_jump(world):
    node = world.make(MasterShaft, {**PATIENT, 'speed_cpm': 60.0, 'rate_hz': 1000.0})
    points = activate(world, node)
    speed = world.speaker(Float64, 'master_shaft/speed_cpm')
    for k in range(60):
        speed.publish(Float64(data=(-1.0)**k * (300.0 - 7.0 * k)))
        count = len(points)
        assert world.spin_until(lambda: len(points) > count + 7 * (k % 5))
    assert world.spin_until(lambda: points[-1].velocity > 1.0)  # the last command, in the end
    check_smooth(points)
    assert node._ticker.schedule.missed == 0


def test_a_set_speed_that_is_no_number_changes_nothing(world, monkeypatch):
    node = world.make(MasterShaft, {**PATIENT, 'speed_cpm': 60.0})
    points = activate(world, node)
    errors = []
    monkeypatch.setattr(node.get_logger(), 'error', errors.append)
    assert world.spin_until(lambda: points and points[-1].velocity == 60.0 * RPM)
    speed = world.speaker(Float64, 'master_shaft/speed_cpm')
    for value in (float('nan'), float('inf')):
        speed.publish(Float64(data=value))
    assert world.spin_until(lambda: len(errors) == 2)
    assert 'finite' in errors[0]
    count = len(points)
    assert world.spin_until(lambda: len(points) > count + 50)
    assert {point.velocity for point in points[count:]} == {60.0 * RPM}


def test_the_shaft_stands_for_the_start_delay(world):
    points = activate(world, world.make(MasterShaft, {**PATIENT, 'start_delay': 0.25}))
    assert world.spin_until(lambda: points and points[-1].velocity > 1.0)
    assert time_ns(points[0]) == 0
    turning = [point for point in points if point[:3] != (0.0, 0.0, 0.0)]
    # the tick at the end of the delay is the start of the ramp, the next one is the first to move
    assert time_ns(turning[0]) == 252_000_000
    assert all(point.velocity > 0.0 for point in turning)


def test_a_shaft_that_is_not_to_run_at_start_waits_to_be_told(world):
    node = world.make(MasterShaft, {**PATIENT, 'run_at_start': False})
    points = activate(world, node)
    assert world.spin_until(lambda: len(points) > 100)
    assert {point[:3] for point in points} == {(0.0, 0.0, 0.0)}
    assert node.state_text == 'stopped'
    assert world.call(SetBool, 'master_shaft/run', data=True).success
    assert node.state_text == 'running'
    assert world.spin_until(lambda: points[-1].velocity == 60.0 * RPM)


def test_joint_states_come_at_their_rate_with_the_time_of_their_ticks(world):
    node = world.make(MasterShaft, {**PATIENT, 'rate_hz': 500.0, 'joint_states_hz': 50.0})
    joints = world.listen(JointState, 'joint_states')
    points = world.points('shaft')
    node.trigger_configure()
    assert world.spin_until(lambda: [each.get_subscription_count() for each in (
        node._ticker.points, node._ticker.joint_states)] == [1, 1])
    before = node.get_clock().now().nanoseconds
    node.trigger_activate()
    assert world.spin_until(lambda: len(joints) > 60)
    after = node.get_clock().now().nanoseconds
    stamps = [each.header.stamp.sec * 10**9 + each.header.stamp.nanosec for each in joints]
    assert {b - a for a, b in pairwise(stamps)} == {20_000_000}
    assert before < stamps[0] and stamps[-1] < after
    for k, joint in enumerate(joints):
        assert list(joint.name) == ['master_shaft'] and not joint.effort
        assert (joint.position[0], joint.velocity[0]) == points[10 * k][:2]


def test_joint_states_can_be_switched_off(world):
    node = world.make(MasterShaft, {**PATIENT, 'joint_states_hz': 0.0})
    joints = world.listen(JointState, 'joint_states')
    points = activate(world, node)
    assert world.spin_until(lambda: len(points) > 300)
    assert joints == []


def test_a_shaft_deactivated_while_turning_leaves_a_hold_point_and_goes_on_from_there(world):
    node = world.make(MasterShaft, {**PATIENT, 'speed_cpm': 150.0})
    points = activate(world, node)
    for _ in range(2):
        assert world.spin_until(lambda: points and points[-1].velocity > 1.0)
        node.trigger_deactivate()
        world.spin_for(0.3)
        last, hold = points[-2:]
        assert hold == last._replace(velocity=0.0, acceleration=0.0)
        count = len(points)
        node.trigger_activate()
        assert world.spin_until(lambda: len(points) > count)
        # the pause takes no time of the machine, and no angle
        assert time_ns(points[count]) == time_ns(hold) + 2_000_000
        assert points[count][:3] == hold[:3]
    assert [time_ns(point) for point in points] == sorted(time_ns(point) for point in points)


def test_services_are_refused_while_the_node_is_inactive(world):
    node = world.make(MasterShaft)
    node.trigger_configure()
    for kind, name in ((SetBool, 'run'), (Trigger, 'stop_at_cycle_end'), (Trigger, 'quick_stop'),
                       (Trigger, 'reset')):
        answer = world.call(kind, f'master_shaft/{name}')
        assert not answer.success
        assert 'not active' in answer.message
