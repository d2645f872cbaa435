# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A master shaft that follows an encoder over the real topic."""

import math

from builtin_interfaces.msg import Time
from cam_motion.nodes.master_shaft import MasterShaft
from cam_motion.units import TURN
import pytest
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from std_srvs.srv import SetBool, Trigger

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

OMEGA = 10.0


@pytest.fixture
def encoder(world):
    """Turn an encoder at constant speed, measured at 200 Hz, until told to fall silent."""
    def encoder(joint='line', late=0.0):
        publisher = world.probe.create_publisher(JointState, 'encoder', qos_profile_sensor_data)
        zero = world.probe.get_clock().now().nanoseconds

        def measure():
            now = world.probe.get_clock().now().nanoseconds
            angle = OMEGA * (now - zero) * 1e-9
            seconds, rest = divmod(now + round(late * 1e9), 10**9)
            publisher.publish(JointState(
                header=Header(stamp=Time(sec=seconds, nanosec=rest)), name=['other', joint],
                position=[math.nan, angle % TURN]))
        timer = world.probe.create_timer(0.005, measure)
        return zero, timer
    return encoder


def make(world, **given):
    """Bring a master up that follows the encoder."""
    node = world.make(MasterShaft, {
        'encoder.topic': 'encoder', 'encoder.joint': 'line', 'rate_hz': 200.0, **given})
    node.trigger_configure()
    node.trigger_activate()
    assert node.active
    return node


@pytest.mark.parametrize('ratio, late', [(1.0, 0.0), (-0.5, 0.02)])
def test_the_shaft_is_where_the_encoder_is(world, encoder, ratio, late):
    zero, _ = encoder(late=late)
    node = make(world, **{'encoder.ratio': ratio, 'encoder.dead_time': late})
    shaft = world.points('shaft')
    assert world.spin_until(lambda: len(shaft) > 300)
    # angles are known up to whole turns of the encoder: it starts over after each
    for point in shaft[150:]:
        at = (node._ticker.stamp(point.sec * 10**9 + point.nanosec) - zero) * 1e-9
        turns = (point.position - ratio * OMEGA * at) / (ratio * TURN)
        assert abs(turns - round(turns)) < 2e-3
        assert point.velocity == pytest.approx(ratio * OMEGA, abs=0.05)
    assert node.state_text == 'following'
    refused = world.call(SetBool, 'master_shaft/run', data=False)
    assert not refused.success and 'encoder' in refused.message


def test_a_silent_encoder_brings_the_shaft_to_rest_until_reset(world, encoder):
    _, timer = encoder()
    node = make(world)
    shaft, states = world.points('shaft'), world.states('master_shaft')
    assert world.spin_until(lambda: len(shaft) > 100)
    assert not node.stopped
    timer.cancel()
    assert world.spin_until(lambda: node.state_text == 'stopped')
    assert world.spin_until(lambda: shaft[-1][1:3] == (0.0, 0.0))
    assert 'stopping' in states
    steps = [abs(two.velocity - one.velocity) for one, two in zip(shaft[20:], shaft[21:])]
    assert max(steps) <= 150.0 / 200.0 * 1.01 + 0.05
    assert 'silent' in node.health()[1]['reason']
    timer.reset()
    world.spin_for(0.3)
    assert shaft[-1][1:3] == (0.0, 0.0)
    assert world.call(Trigger, 'master_shaft/reset').success
    assert world.spin_until(lambda: node.state_text == 'following')


def test_nothing_is_published_before_the_encoder_is_heard(world, encoder):
    node = make(world, **{'encoder.joint': 'none'})
    encoder()
    shaft = world.points('shaft')
    assert world.spin_until(lambda: node.health()[1]['encoder_refused'] > 5)
    assert shaft == []
    assert node.stopped


def state_of(angle, world):
    """Write a measurement of now."""
    now = world.probe.get_clock().now().nanoseconds
    return JointState(header=Header(stamp=Time(sec=now // 10**9, nanosec=now % 10**9)),
                      name=['line'], position=[angle])


def test_an_encoder_that_jumps_is_not_followed(world):
    """One measurement that cannot be is left out; some in a row bring the shaft to rest."""
    node = make(world)
    jump, zero = [0.0], world.probe.get_clock().now().nanoseconds
    publisher = world.probe.create_publisher(JointState, 'encoder', qos_profile_sensor_data)

    def measure():
        now = world.probe.get_clock().now().nanoseconds
        publisher.publish(state_of((OMEGA * (now - zero) * 1e-9 + jump[0]) % TURN, world))
    world.probe.create_timer(0.005, measure)
    shaft = world.points('shaft')
    assert world.spin_until(lambda: len(shaft) > 100)
    publisher.publish(state_of((OMEGA * 1e-9 * (
        world.probe.get_clock().now().nanoseconds - zero) + 1.0) % TURN, world))
    assert world.spin_until(lambda: node.health()[1]['encoder_jumps'] > 0)
    assert world.spin_until(lambda: len(shaft) > 150)
    assert max(point.velocity for point in shaft) < 1.2 * OMEGA
    assert node.state_text == 'following'
    jump[0] = 1.0
    assert world.spin_until(lambda: node.state_text == 'stopped')
    assert max(point.velocity for point in shaft) < 1.2 * OMEGA
    level, values = node.health()
    assert level == b'\2' and 'jumped' in values['reason']
    assert world.call(Trigger, 'master_shaft/reset').success
    assert world.spin_until(lambda: node.state_text == 'following')


def test_a_master_says_that_its_encoder_turns_faster_than_an_axis_allows(world, encoder):
    encoder()
    node = make(world)
    node.obey('press', 0.5 * OMEGA)
    assert world.spin_until(lambda: 'press keeps its limits' in node.health()[1].get('reason', ''))
    assert node.health()[0] == b'\2'
    node.obey('press', 2.0 * OMEGA)
    assert node.health()[0] == b'\0'
