# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""An axis answers every shaft point once, to the last bit on its curve, whoever sends it."""

import math

from builtin_interfaces.msg import Duration
from cam_motion.io.axis import build_axis
from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.qos import SETPOINTS
from cam_motion.nodes.wire import pack_point
from cam_motion.runtime.point import Point
import pytest
from rclpy.qos import QoSProfile
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectoryPoint

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

KNIFE = {
    'segments': ['wait', 'cut', 'back'], 'wait.end_deg': 145.0,
    'cut.law': 'modified_trapezoid', 'cut.end_deg': 225.0, 'cut.lift': 0.08,
    'back.law': 'cycloidal', 'back.end_deg': 360.0, 'back.lift': -0.08,
}
FEEDER = {
    'cycle': 'accumulate', 'segments': ['feed', 'wait'], 'feed.law': 'modified_trapezoid',
    'feed.end_deg': 80.0, 'feed.lift': 0.3, 'wait.end_deg': 360.0,
}
COUNT = 500


def shaft_point(k):
    """Make the k-th point of a shaft that turns irregularly, forward and backward."""
    return Point(0.11 * k - 7.0 + math.sin(k), 20.0 * math.cos(0.1 * k), 35.0 * math.sin(0.3 * k),
                 k // 7 - 3, (k * 131_071) % 10**9)


def message_of(point, **changes):
    """Write a point as a message object, as any other program would."""
    return JointTrajectoryPoint(**{
        'positions': [point.position], 'velocities': [point.velocity],
        'accelerations': [point.acceleration],
        'time_from_start': Duration(sec=point.sec, nanosec=point.nanosec), **changes})


def exact(profile, point):
    """Give the setpoint that answers a shaft point."""
    y, slope, bend, _ = profile.sample(point.position)
    omega, alpha = point.velocity, point.acceleration
    return Point(y, slope * omega, bend * omega * omega + slope * alpha, point.sec, point.nanosec)


def active_axis(world, given, **options):
    """Bring an axis up."""
    node = world.make(CamAxis, given, **options)
    node.trigger_configure()
    node.trigger_activate()
    assert node.active
    return node


def send(world, publisher, messages, received):
    """Publish messages no faster than they are answered; the queues of setpoints are short."""
    for message in messages:
        count = len(received)
        publisher.publish(message)
        assert world.spin_until(lambda: len(received) > count)


@pytest.mark.parametrize('given', [KNIFE, FEEDER], ids=['returning', 'accumulating'])
@pytest.mark.parametrize('how', ['as bytes', 'as messages', 'with effort'])
def test_every_shaft_point_is_answered_once_and_exactly(world, given, how):
    node = active_axis(world, given)
    setpoints = world.points('cam_axis/setpoint')
    publisher = world.speaker(JointTrajectoryPoint, 'shaft')
    assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
    points = [shaft_point(k) for k in range(COUNT)]
    write = {'as bytes': lambda point: pack_point(*point), 'as messages': message_of,
             'with effort': lambda point: message_of(point, effort=[3.0])}[how]
    send(world, publisher, map(write, points), setpoints)
    world.spin_for(0.2)
    profile = build_axis('axis', given).profile
    assert setpoints == [exact(profile, point) for point in points]
    assert max(abs(setpoint.acceleration) for setpoint in setpoints) > 1.0
    assert node.state_text == 'in_sync'


def test_the_acceleration_of_the_shaft_is_not_dropped(world):
    node = active_axis(world, FEEDER)
    setpoints = world.points('cam_axis/setpoint')
    publisher = world.speaker(JointTrajectoryPoint, 'shaft')
    assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
    points = [Point(0.5, 10.0, alpha, 0, 0) for alpha in (0.0, 30.0)]
    send(world, publisher, map(message_of, points), setpoints)
    _, slope, bend, _ = build_axis('axis', FEEDER).profile.sample(0.5)
    assert slope > 0.1
    # y' omega twice; y'' omega^2 without and y'' omega^2 + y' alpha with acceleration
    assert [s.velocity for s in setpoints] == [slope * 10.0] * 2
    assert [s.acceleration for s in setpoints] == [bend * 100.0, bend * 100.0 + slope * 30.0]


def test_points_that_are_none_are_counted_and_left_out(world, monkeypatch):
    node = active_axis(world, KNIFE)
    setpoints = world.points('cam_axis/setpoint')
    publisher = world.speaker(JointTrajectoryPoint, 'shaft')
    warnings = []
    monkeypatch.setattr(node.get_logger(), 'warning', lambda text, **_: warnings.append(text))
    good = Point(1.0, 2.0, 3.0, 4, 5)
    wrong = [
        message_of(good, positions=[]), message_of(good, positions=[1.0, 2.0]),
        message_of(good, velocities=[]), message_of(good, accelerations=[]),
        message_of(good, positions=[math.nan]), message_of(good, velocities=[math.inf]),
        message_of(good, accelerations=[-math.inf]), JointTrajectoryPoint(),
    ]
    for number, message in enumerate(wrong, start=1):
        publisher.publish(message)
        assert world.spin_until(lambda: node._shaft.refused == number)
    assert setpoints == []
    assert len(warnings) == len(wrong)
    send(world, publisher, [message_of(good)], setpoints)
    assert len(setpoints) == 1 and setpoints[0][3:] == (4, 5)


def test_a_hold_setpoint_is_left_behind_and_nothing_while_inactive(world):
    node = active_axis(world, KNIFE)
    setpoints = world.points('cam_axis/setpoint')
    publisher = world.speaker(JointTrajectoryPoint, 'shaft')
    points = [Point(3.0 + 0.01 * k, 15.0, 2.0, 1, k) for k in range(10)]
    send(world, publisher, map(message_of, points), setpoints)
    last = setpoints[-1]
    assert last.velocity != 0.0 != last.acceleration
    node.trigger_deactivate()
    assert world.spin_until(lambda: len(setpoints) == 11)
    assert setpoints[-1] == last._replace(velocity=0.0, acceleration=0.0)
    for point in points:
        publisher.publish(message_of(point))
    world.spin_for(0.3)
    assert len(setpoints) == 11
    node.trigger_activate()
    send(world, publisher, [message_of(points[0])], setpoints)
    # it stands where it is: the shaft has moved on meanwhile
    assert setpoints[-1] == setpoints[-2]._replace(sec=points[0].sec, nanosec=points[0].nanosec)
    assert node.state_text == 'held'
    still = points[-1]._replace(velocity=0.0, acceleration=0.0)
    node.trigger_deactivate()
    assert world.spin_until(lambda: len(setpoints) == 13)
    node.trigger_activate()
    send(world, publisher, [message_of(still)], setpoints)
    assert setpoints[-1].position == last.position
    assert node.state_text == 'held'
    assert world.call(Trigger, 'cam_axis/reset').success
    assert node.state_text == 'in_sync'


def test_activated_again_where_it_stands_on_its_curve_an_axis_goes_on(world):
    node = active_axis(world, KNIFE)
    setpoints = world.points('cam_axis/setpoint')
    publisher = world.speaker(JointTrajectoryPoint, 'shaft')
    still = Point(3.0, 0.0, 0.0, 1, 0)
    send(world, publisher, [message_of(still)], setpoints)
    node.trigger_deactivate()
    assert world.spin_until(lambda: len(setpoints) == 2)
    node.trigger_activate()
    assert node.state_text == 'held'
    send(world, publisher, [message_of(still)], setpoints)
    assert node.state_text == 'in_sync'


def test_an_axis_that_has_heard_no_shaft_leaves_no_setpoint_behind(world):
    node = active_axis(world, KNIFE)
    setpoints = world.points('cam_axis/setpoint')
    assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
    assert node.stopped
    node.trigger_deactivate()
    world.spin_for(0.2)
    assert setpoints == []


def test_namespace_node_name_and_topics_can_be_remapped(world):
    node = active_axis(world, KNIFE, namespace='hall/two', cli_args=[
        '--ros-args', '-r', '__node:=blade', '-r', 'shaft:=/other/line_shaft',
        '-r', '~/setpoint:=commands'])
    assert (node.get_name(), node.get_namespace()) == ('blade', '/hall/two')
    setpoints = world.points('hall/two/commands')
    publisher = world.speaker(JointTrajectoryPoint, '/other/line_shaft')
    assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
    send(world, publisher, [message_of(shaft_point(70))], setpoints)
    assert len(setpoints) == 1
    states = world.states('hall/two/blade')
    assert world.spin_until(lambda: states[-1:] == ['in_sync'])


OVERRIDES = {
    'qos_overrides./cam_axis/setpoint.publisher.depth': 77,
    'qos_overrides./cam_axis/setpoint.publisher.reliability': 'best_effort',
}


def offered(world, topic):
    """Give reliability and depth that the node itself offers on a topic."""
    infos = world.probe.get_publishers_info_by_topic(topic)
    return [info.qos_profile.reliability.name.lower() for info in infos]


def test_the_quality_of_service_of_the_setpoints_can_be_overridden(world):
    before = SETPOINTS.depth, SETPOINTS.reliability
    try:
        node = active_axis(world, {**KNIFE, **OVERRIDES})
        assert world.spin_until(lambda: offered(world, '/cam_axis/setpoint') == ['best_effort'])
        assert node.get_parameter(next(iter(OVERRIDES))).value == 77
        setpoints = world.points('cam_axis/setpoint')  # which asks for reliability
        publisher = world.speaker(JointTrajectoryPoint, 'shaft')
        eager = []
        world.probe.create_subscription(
            JointTrajectoryPoint, 'cam_axis/setpoint', eager.append,
            QoSProfile(depth=10, reliability=node._setpoints.qos_profile.reliability))
        assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
        send(world, publisher, [message_of(shaft_point(1))], eager)
        assert setpoints == []
        # the parameters are declared anew whenever the node is configured
        node.trigger_deactivate()
        node.trigger_cleanup()
        node.trigger_configure()
        assert world.spin_until(lambda: offered(world, '/cam_axis/setpoint') == ['best_effort'])
    finally:
        SETPOINTS.depth, SETPOINTS.reliability = before


def test_an_override_of_one_topic_leaves_the_others_alone(world):
    before = SETPOINTS.depth, SETPOINTS.reliability
    try:
        active_axis(world, {**KNIFE, **OVERRIDES})
        assert (SETPOINTS.depth, SETPOINTS.reliability) == before
        active_axis(world, FEEDER, namespace='other')
        assert world.spin_until(lambda: offered(world, '/other/cam_axis/setpoint'))
        assert offered(world, '/other/cam_axis/setpoint') == ['reliable']
    finally:
        SETPOINTS.depth, SETPOINTS.reliability = before
