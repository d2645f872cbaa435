# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The look-ahead of an axis as a topic: JointTrajectory messages for ros2_control."""

from itertools import pairwise
import math

from cam_motion.drive.inverse import FollowerDrive
from cam_motion.io.axis import build_axis
from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.line import make_line
from cam_motion.nodes.runner import bring_to_rest, start
from cam_motion.nodes.trajectory_output import TrajectoryCodec
from cam_motion.runtime.look_ahead import AheadPoint
from cam_motion.runtime.point import Point
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft_motion import ShaftMotion, ShaftState
from cam_motion.units import RPM, TURN
from hypothesis import given
from hypothesis import strategies as st
import pytest
from rclpy.serialization import deserialize_message
from trajectory_msgs.msg import JointTrajectory

pytestmark = [pytest.mark.ros, pytest.mark.timeout(120)]

FEEDER = {
    'cycle': 'accumulate', 'segments': ['feed', 'wait'], 'feed.law': 'modified_trapezoid',
    'feed.end_deg': 80.0, 'feed.lift': 0.3, 'wait.end_deg': 360.0, 'trajectory.rate_hz': 50.0,
    'trajectory.points': 4, 'trajectory.joint': 'belt',
}
SPEED = 200.0 * RPM
PERIOD_NS = 2_000_000
STEP = 0.02


def ns(stamp):
    """Give a stamp or a duration in nanoseconds."""
    return stamp.sec * 10**9 + stamp.nanosec


def rows(message):
    """Give the points of a message as numbers; all of one joint, with nothing missing."""
    assert all(len(p.positions) == len(p.velocities) == len(p.accelerations) == 1
               for p in message.points)
    return [AheadPoint(ns(p.time_from_start) / 1e9, p.positions[0], p.velocities[0],
                       p.accelerations[0]) for p in message.points]


@pytest.fixture
def feeder(world):
    """Bring an axis up that is handed the ticks of a steady shaft; give its messages too."""
    def feeder(given=FEEDER):
        node = world.make(CamAxis, given)
        node.trigger_configure()
        assert not node.problems
        messages = world.listen(JointTrajectory, 'cam_axis/trajectory')
        assert world.spin_until(lambda: world.probe.count_publishers('cam_axis/trajectory') == 1
                                and node.count_subscribers('~/trajectory') == 1)
        node.trigger_activate()
        return node, messages
    return feeder


def tick(node, k, omega=SPEED, phi=None):
    time_ns = k * PERIOD_NS
    node.answer(Point(omega * time_ns * 1e-9 if phi is None else phi, omega, 0.0,
                      *divmod(time_ns, 10**9)))


@given(st.integers(1, 40), st.booleans(), st.text('abcxyz_0123', min_size=1, max_size=20),
       st.integers(0, 2**31 * 10**9 - 1))
def test_packed_messages_are_what_ros_reads(count, with_effort, joint, stamp):
    points = [AheadPoint(0.5 * k, k + 0.25, -k, 2.0 * k) for k in range(count)]
    efforts = [k - 0.5 for k in range(count)] if with_effort else []
    message = deserialize_message(
        TrajectoryCodec(joint, with_effort).pack(stamp, points, efforts), JointTrajectory)
    assert (ns(message.header.stamp), message.header.frame_id) == (stamp, '')
    assert list(message.joint_names) == [joint] and rows(message) == points
    assert [list(p.effort) for p in message.points] == [
        [effort] for effort in efforts] or not with_effort


def test_messages_come_at_their_rate_with_exact_points(world, feeder):
    node, messages = feeder()
    for k in range(201):
        tick(node, k)
    assert world.spin_until(lambda: len(messages) == 21)
    exact = build_axis('axis', FEEDER).profile
    stamps = [ns(message.header.stamp) for message in messages]
    assert all(b - a == pytest.approx(20_000_000, abs=20_000) for a, b in pairwise(stamps))
    for number, message in enumerate(messages):
        assert list(message.joint_names) == ['belt']
        points = rows(message)
        times = [point.time for point in points]
        assert {0.0, STEP, 2 * STEP, 3 * STEP, 4 * STEP} <= {round(t, 9) for t in times}
        for point in points:
            if point.time > 4 * STEP:
                break
            phi = SPEED * (STEP * number + point.time)
            assert point[1:4] == pytest.approx(
                exact.at_speed(phi, SPEED, 0.0), rel=1e-4, abs=1e-4)
        # behind them the axis stops, in case no message follows
        assert times[-1] > 4 * STEP and points[-1][2:4] == (0.0, 0.0)
        assert not any(len(p.effort) for p in message.points)
    assert node.health()[1]['trajectories'] == 21


def test_a_dead_time_shifts_the_points(world, feeder):
    node, messages = feeder({**FEEDER, 'dead_time': 0.01})
    tick(node, 7)
    assert world.spin_until(lambda: messages)
    exact = build_axis('axis', FEEDER).profile
    phi = SPEED * (7 * PERIOD_NS * 1e-9 + 0.01)
    assert rows(messages[0])[0][1:4] == pytest.approx(exact.at_speed(phi, SPEED, 0.0))


def test_when_the_shaft_comes_to_rest_and_when_the_node_ceases_it_says_so(world, feeder):
    node, messages = feeder()
    ramp = ShaftMotion(0.0, ShaftState(0.0, 2.0, 0.0)).ramped(0.0, 0.0, RampLimits(80.0, 1e4))
    ticks = math.ceil(ramp.settled_at / 0.002) + 1
    for k in range(ticks):
        node.answer(Point(*ramp.state(0.002 * k), *divmod(k * PERIOD_NS, 10**9)))
    # one at the beginning, one every 20 ms, and one when it stands
    assert ticks % 10 > 1
    assert world.spin_until(lambda: len(messages) == 2 + (ticks - 1) // 10)
    stands = node._last.position
    assert {point[1:4] for point in rows(messages[-1])} == {(stands, 0.0, 0.0)}
    count = len(messages)
    node.trigger_deactivate()
    assert world.spin_until(lambda: len(messages) > count)
    assert {point[1:4] for point in rows(messages[-1])} == {(stands, 0.0, 0.0)}
    assert len(messages[-1].points) == 5


def test_without_a_rate_there_is_no_topic(world):
    node = world.make(CamAxis, {**FEEDER, 'trajectory.rate_hz': 0.0})
    node.trigger_configure()
    assert 'trajectories' not in node.health()[1]
    assert world.probe.count_publishers('cam_axis/trajectory') == 0


OUTER = {
    'follows': 'inner', 'ratio': TURN / 0.3, 'segments': ['up', 'down'], 'up.law': 'cycloidal',
    'up.end_deg': 180.0, 'up.lift': 0.05, 'down.law': 'cycloidal', 'down.end_deg': 360.0,
    'down.lift': -0.05, 'trajectory.rate_hz': 50.0, 'trajectory.points': 4,
}


def test_an_axis_that_follows_another_sees_ahead_through_it(world, feeder):
    inner = world.make(CamAxis, {**FEEDER, 'trajectory.rate_hz': 0.0}, name='inner')
    inner.trigger_configure()
    inner.trigger_activate()
    outer = world.make(CamAxis, OUTER, own_process=False)
    outer.source = lambda: inner.outputs
    inner.listeners.append(outer.answer)
    outer.trigger_configure()
    messages = world.listen(JointTrajectory, 'cam_axis/trajectory')
    assert world.spin_until(lambda: outer.count_subscribers('~/trajectory') == 1)
    outer.trigger_activate()
    for k in range(101):
        tick(inner, k)
    assert world.spin_until(lambda: len(messages) == 11)
    feed, cam = (build_axis('axis', g).layout.motion for g in (FEEDER, OUTER))
    for number, message in enumerate(messages):
        for point in rows(message):
            if point.time < 4 * STEP:
                at = feed.sample(SPEED * (STEP * number + point.time))[0]
                assert point.position == pytest.approx(cam.sample(at)[0], abs=1e-7)


def test_an_axis_that_follows_another_of_another_process_cannot_see_ahead(world):
    node = world.make(CamAxis, OUTER)
    node.trigger_configure()
    assert [problem.path for problem in node.problems] == ['trajectory.rate_hz']


def test_a_line_adds_the_effort_of_the_drive(world, machine_file, tmp_path):
    machine = tmp_path / 'machine.yaml'
    text = machine_file.read_text()
    machine.write_text(text.replace(
        'unit: m\n', 'unit: m\n    trajectory: {rate_hz: 50.0, effort: true}\n', 1))
    nodes = [world.add(node) for node in make_line(
        context=world.context,
        cli_args=['--ros-args', '--params-file', str(machine)])]
    messages = world.listen(JointTrajectory, 'feeder/trajectory')
    assert start(nodes) == 0
    assert world.spin_until(lambda: any(abs(p.velocities[0]) > 1.0 for message in messages
                                        for p in message.points))
    bring_to_rest(world.executor, nodes)
    drive = FollowerDrive(radius=0.134, gear_ratio=2.0, load_inertia=1.164,
                          resistance_force=500.0)
    for message in messages:
        for point in message.points:
            motion = point.positions[0], point.velocities[0], point.accelerations[0]
            force = drive.follow(*motion).motor_torque * 2.0 / 0.134
            assert list(point.effort) == pytest.approx([force])
    assert max(p.effort[0] for message in messages for p in message.points) > 1000.0
    assert list(messages[0].joint_names) == ['feeder']
