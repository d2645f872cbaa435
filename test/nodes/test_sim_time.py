# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""On /clock the shaft follows simulated time: tick for tick, and on when that time starts over."""

from itertools import pairwise

from cam_motion.nodes.master_shaft import MasterShaft
from diagnostic_msgs.msg import DiagnosticArray
import pytest
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

MS = 1_000_000  # ns
PERIOD = 10 * MS
BEGIN = 100_000 * MS
# no two of these add up to the last tenth of a period, in which a tick may come early
IRREGULAR = [4, 32, 2, 10, 28, 14, 6, 54, 40, 8, 20, 2, 100, 16, 44]  # ms


class Simulator:
    """Publishes /clock step by step, and waits until the shaft has taken each."""

    def __init__(self, world):
        self.world = world
        self.node = world.make(MasterShaft, {
            'use_sim_time': True, 'rate_hz': 100.0, 'joint_states_hz': 100.0,
            'start_delay': 0.05, 'speed_cpm': 60.0})
        self.points = world.points('shaft')
        self.joints = world.listen(JointState, 'joint_states')
        self.node.trigger_configure()
        self.node.trigger_activate()
        assert world.spin_until(lambda: [each.get_subscription_count() for each in (
            self.node._ticker.points, self.node._ticker.joint_states)] == [1, 1])
        self.clock = world.speaker(Clock, '/clock', QoSProfile(
            depth=1, reliability=ReliabilityPolicy.RELIABLE))
        self.now = 0

    def publish(self, now):
        """Publish a time [ns] and let everything happen that is due."""
        self.now = now
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(now, 10**9)
        self.clock.publish(message)
        assert self.world.spin_until(lambda: self.node.get_clock().now().nanoseconds == now)
        count, quiet = len(self.points), 0
        while quiet < 4:
            self.world.executor.spin_once(timeout_sec=0.004)
            quiet = quiet + 1 if count == len(self.points) else 0
            count = len(self.points)

    def go(self, *steps):
        """Step on by some milliseconds each."""
        for step in steps:
            self.publish(self.now + step * MS)

    @property
    def stamps(self):
        """Stamps of the joint states, one per tick [ns]."""
        return [each.header.stamp.sec * 10**9 + each.header.stamp.nanosec for each in self.joints]

    @property
    def times(self):
        """Times of the shaft points on the machine's time base [ns]."""
        return [point.sec * 10**9 + point.nanosec for point in self.points]


@pytest.fixture
def simulator(world):
    """Give a shaft on simulated time, before the first /clock."""
    return Simulator(world)


def test_there_is_no_tick_before_the_first_clock(simulator, world):
    world.spin_for(0.5)
    assert simulator.points == []
    assert simulator.node.active and simulator.node.state_text == 'stopped'
    simulator.publish(BEGIN)
    simulator.go(*[10] * 5)
    assert simulator.points


def test_time_that_stands_still_makes_no_tick(simulator, world):
    simulator.publish(BEGIN)
    simulator.go(*[10] * 20)
    count = len(simulator.points)
    world.spin_for(0.3)
    for _ in range(3):
        simulator.publish(simulator.now)
    assert len(simulator.points) == count


@pytest.mark.parametrize('steps', [[10] * 60, IRREGULAR * 2], ids=['regular', 'irregular'])
def test_ticks_follow_simulated_time_exactly(simulator, world, steps):
    simulator.publish(BEGIN)
    simulator.go(10, 10)
    assert simulator.points
    for step in steps:
        simulator.go(step)
        # everything that is due, and nothing that is not
        assert world.spin_until(lambda: simulator.now - PERIOD < simulator.stamps[-1])
        assert simulator.stamps[-1] <= simulator.now
    stamps = simulator.stamps
    assert {b - a for a, b in pairwise(stamps)} == {PERIOD}
    assert simulator.times == [k * PERIOD for k in range(len(stamps))]
    assert simulator.node._ticker.schedule.missed == 0
    assert simulator.points[-1].velocity > 0.0


def test_a_late_wake_up_does_not_shift_the_grid(simulator, world):
    simulator.publish(BEGIN + 4 * MS)  # the timer was due at BEGIN, a multiple of its period
    simulator.go(18)
    assert world.spin_until(lambda: len(simulator.stamps) == 3)
    assert simulator.stamps == [BEGIN, BEGIN + PERIOD, BEGIN + 2 * PERIOD]


def test_services_work_between_the_steps(simulator, world):
    simulator.publish(BEGIN)
    simulator.go(*[50] * 20)
    assert simulator.points[-1].velocity > 0.0
    assert world.call(SetBool, 'master_shaft/run', data=False).success
    simulator.go(*[50] * 20)
    assert simulator.points[-1][1:3] == (0.0, 0.0)


def test_ticks_left_out_by_a_jump_forward_are_counted(simulator):
    simulator.publish(BEGIN)
    simulator.go(10, 10)
    before = len(simulator.points)
    simulator.go(2500)
    missed = simulator.node._ticker.schedule.missed
    assert missed >= 140  # all but those of the last second
    assert len(simulator.points) - before + missed == 250
    assert simulator.times[-1] == (len(simulator.points) + missed - 1) * PERIOD


@pytest.fixture
def looped(simulator):
    """Give a shaft whose simulated time has started over, as a looped bag does."""
    simulator.publish(BEGIN)
    simulator.go(*[20] * 30)
    simulator.before = len(simulator.points)
    simulator.publish(BEGIN)
    simulator.go(*[20] * 30)
    return simulator


def test_time_that_starts_over_continues_the_time_base(looped, world):
    times = looped.times
    assert len(times) > looped.before + 50
    assert times == [k * PERIOD for k in range(len(times))]
    for one, two in pairwise(looped.points):
        assert abs(two.velocity - one.velocity) <= 30.0 * PERIOD * 1e-9 * (1.0 + 1e-9)
        assert two.position >= one.position
    reports = world.listen(DiagnosticArray, '/diagnostics')
    assert world.spin_until(lambda: reports)
    values = {pair.key: pair.value for pair in reports[-1].status[0].values}
    assert values['clock_restarts'] == '1'
    assert values['missed_ticks'] == '0'


def test_stamps_are_those_of_the_clock_after_it_has_started_over(looped):
    again = looped.stamps[looped.before:]
    assert looped.now - PERIOD < again[-1] <= looped.now
    assert BEGIN <= again[0]
