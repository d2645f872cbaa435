# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Cam tracks as topics: latched, told when they change, switched off when the node ceases."""

from types import SimpleNamespace

from cam_motion.io.axis import build_axis
from cam_motion.io.config import read_sections
from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.drive_sim import DriveSim
from cam_motion.nodes.line_topics import topics_of
from cam_motion.nodes.master_shaft import MasterShaft
from cam_motion.nodes.qos import LATCHED
from cam_motion.nodes.wire import pack_point
from cam_motion.runtime.cam_switch import CamSwitch, CamTrack
from cam_motion.runtime.point import Point
from cam_motion.units import DEGREE, RPM, TURN
import pytest
from std_msgs.msg import Bool
from trajectory_msgs.msg import JointTrajectoryPoint

pytestmark = [pytest.mark.ros, pytest.mark.timeout(120)]

GLUE = {'tracks': ['glue'], 'glue.on_deg': [90.0, 300.0], 'glue.off_deg': [180.0, 30.0],
        'glue.on_compensation': -0.01}
FEEDER = {
    'cycle': 'accumulate', 'segments': ['feed', 'wait'], 'feed.law': 'cycloidal',
    'feed.end_deg': 180.0, 'feed.lift': 0.3, 'wait.end_deg': 360.0,
    'tracks': ['cut', 'half'], 'cut.on_deg': [200.0], 'cut.duration': 0.05,
    'half.source': 'position', 'half.on_at': [0.15], 'half.off_at': [0.3], 'half.modulo': 0.3,
}
SPEED = 60.0 * RPM
PERIOD_NS = 2_000_000


def up(world, factory, given, **options):
    node = world.make(factory, given, **options)
    node.trigger_configure()
    assert not node.problems, node.problems
    node.trigger_activate()
    return node


def told(messages):
    return [message.data for message in messages]


def diagnosed(node):
    level, values = node.health()
    return level, {name: value for name, value in values.items() if '.' in name}


def turn(world, publisher, answers, ticks, first=0):
    """Turn the shaft at a constant speed, each tick answered before the next."""
    for tick in range(first, first + ticks):
        count, time_ns = len(answers), tick * PERIOD_NS
        publisher.publish(pack_point(
            SPEED * time_ns * 1e-9, SPEED, 0.0, *divmod(time_ns, 10**9)))
        assert world.spin_until(lambda: len(answers) > count)


def test_a_track_of_the_shaft_switches_at_its_angles(world):
    node = world.make(MasterShaft, {
        **GLUE, 'speed_cpm': 120.0, 'start_delay': 0.0, 'max_catch_up': 10.0})
    node.trigger_configure()
    glue, points = world.listen(Bool, 'master_shaft/glue'), world.points('shaft')
    assert world.spin_until(lambda: node._ticker.points.get_subscription_count() == 1)
    node.trigger_activate()
    assert world.spin_until(lambda: points and points[-1].position > 2 * TURN)
    node.trigger_deactivate()
    world.spin_until(lambda: not glue[-1].data)
    switch = CamSwitch(CamTrack([90 * DEGREE, 300 * DEGREE], [180 * DEGREE, 30 * DEGREE],
                                on_compensation=-0.01))
    answers = [switch.answer(p.time, *p[:3]) for p in points]
    changes = [b for a, b in zip([None, *answers], answers) if a is not b]
    assert told(glue)[:len(changes)] == changes and len(changes) > 6
    assert diagnosed(node)[1]['glue.count'] == switch.count
    assert told(glue)[-1] is False


def test_tracks_of_an_axis_over_the_shaft_and_over_its_position(world):
    node = up(world, CamAxis, FEEDER)
    cut, half = world.listen(Bool, 'cam_axis/cut'), world.listen(Bool, 'cam_axis/half')
    setpoints = world.points('cam_axis/setpoint')
    shaft = world.speaker(JointTrajectoryPoint, 'shaft')
    assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
    ticks = 1100  # two turns and a bit
    turn(world, shaft, setpoints, ticks)
    assert world.spin_until(lambda: len(cut) >= 5 and len(half) >= 5)
    # off at first; then in each turn on and off
    assert told(cut) == told(half) == [False, True, False, True, False]
    assert diagnosed(node) == (b'\0', {
        'cut.on': False, 'cut.count': 2, 'cut.unseen': 0,
        'half.on': False, 'half.count': 2, 'half.unseen': 0})


def test_a_duration_ends_on_time_when_the_shaft_is_lost(world):
    """No tick comes any more, but what the track has opened is shut."""
    node = up(world, CamAxis, {**FEEDER, 'cut.duration': 1.0})
    cut = world.listen(Bool, 'cam_axis/cut')
    setpoints, shaft = world.points('cam_axis/setpoint'), world.speaker(
        JointTrajectoryPoint, 'shaft')
    assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
    for _ in range(2):  # the second time the shaft comes back at another time and angle
        turn(world, shaft, setpoints, 280)  # to 201.6 degrees
        assert world.spin_until(lambda: cut and told(cut)[-1])
        assert world.spin_until(lambda: node.state_text == 'held')
        assert world.spin_until(lambda: not told(cut)[-1])
        assert not diagnosed(node)[1]['cut.on']
    assert told(cut) == [False, True, False, True, False]


def test_late_ticks_do_not_put_off_the_end_of_a_duration(world, monkeypatch):
    """Those of a shaft that is brought to rest come when its silence has been noticed."""
    node = up(world, CamAxis, {**FEEDER, 'cut.duration': 1.0})

    def answer(first, last):
        for tick in range(first, last):
            time_ns = tick * PERIOD_NS
            node.answer(Point(SPEED * time_ns * 1e-9, SPEED, 0.0, *divmod(time_ns, 10**9)))
    on = round(200.0 / 360.0 * 500) + 1
    answer(0, on + 1)
    assert diagnosed(node)[1]['cut.on']
    begun, clock = node.steady_clock.now().nanoseconds, SimpleNamespace()
    monkeypatch.setattr(CamAxis, 'tick_clock', property(
        lambda _: SimpleNamespace(now=lambda: clock)))
    clock.nanoseconds = begun + 600_000_000
    answer(on + 1, on + 50)
    for after_ms, still in ((950, True), (1010, False)):
        clock.nanoseconds = begun + after_ms * 1_000_000
        node.outputs._tracks._expire()
        assert diagnosed(node)[1]['cut.on'] is still


def test_who_comes_late_is_told_the_state(world):
    node = up(world, CamAxis, FEEDER)
    setpoints, shaft = world.points('cam_axis/setpoint'), world.speaker(
        JointTrajectoryPoint, 'shaft')
    assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
    turn(world, shaft, setpoints, 200)  # to 144 degrees: more than half is fed
    half = world.listen(Bool, 'cam_axis/half', LATCHED)
    assert world.spin_until(lambda: half) and told(half) == [True]
    node.trigger_deactivate()
    assert world.spin_until(lambda: told(half) == [True, False])
    node.trigger_activate()
    turn(world, shaft, setpoints, 5, first=200)
    assert world.spin_until(lambda: told(half) == [True, False, True])


def test_a_window_between_two_ticks_is_reported(world):
    cam = {key: value for key, value in FEEDER.items() if key.split('.')[0] not in (
        'tracks', 'cut', 'half')}
    node = up(world, CamAxis, {
        **cam, 'tracks': ['short'], 'short.on_deg': [90.1], 'short.off_deg': [90.2]})
    for tick in range(300):
        time_ns = tick * PERIOD_NS
        node.answer(Point(SPEED * time_ns * 1e-9, SPEED, 0.0, *divmod(time_ns, 10**9)))
    level, values = diagnosed(node)
    assert (level, values['short.unseen'], values['short.count']) == (b'\1', 1, 0)


def test_tracks_go_over_to_another_format_and_only_then(world):
    node = up(world, CamAxis, FEEDER)
    half = world.listen(Bool, 'cam_axis/half')
    setpoints, shaft = world.points('cam_axis/setpoint'), world.speaker(
        JointTrajectoryPoint, 'shaft')
    assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
    turn(world, shaft, setpoints, 200)
    node.outputs.take(node.axis)
    turn(world, shaft, setpoints, 10, first=200)
    assert diagnosed(node)[1]['half.count'] == 1
    node.outputs.take(build_axis(
        'cam_axis', {**FEEDER, 'half.on_at': [0.01], 'half.off_at': [0.02]}))
    turn(world, shaft, setpoints, 10, first=210)
    assert world.spin_until(lambda: told(half) == [False, True, False])


def test_a_drive_that_turns_the_shaft_has_tracks_too(world, machine_file):
    sections = read_sections(machine_file.with_name('cam_press_drive.yaml'))
    node = world.make(DriveSim, {
        **sections['press_drive'], 'tracks': ['glue'], 'glue.on_deg': [90.0],
        'glue.off_deg': [180.0], 'start_delay': 0.0, 'max_catch_up': 10.0}, name='press_drive')
    node.section = sections.get
    node.trigger_configure()
    assert not node.problems
    glue = world.listen(Bool, 'press_drive/glue')
    assert world.spin_until(lambda: node._mode._ticker.tracks._outputs[
        'glue'].publisher.get_subscription_count() == 1)
    node.trigger_activate()
    assert world.spin_until(lambda: len(glue) >= 3)
    assert told(glue)[:3] == [False, True, False]


@pytest.mark.parametrize('given, path', [
    ({'tracks': ['speed_cpm']}, 'tracks'), ({'tracks': ['glue']}, 'glue.on_deg'),
    ({'tracks': ['glue'], 'glue.on_deg': [10.0], 'glue.of_deg': [20.0]}, 'glue.of_deg')])
def test_a_track_that_cannot_be_keeps_the_node_from_starting(world, given, path):
    node = world.make(MasterShaft, given)
    node.trigger_configure()
    assert path in [problem.path for problem in node.problems]


def test_a_line_has_the_topics_of_its_tracks(machine_file):
    sections = read_sections(machine_file)
    sections['master_shaft'] = {**sections['master_shaft'], **GLUE}
    sections['press'] = {**sections['press'], 'tracks': ['blow'], 'trajectory.rate_hz': 50.0}
    topics = {topic.name: topic for topic in topics_of(sections)}
    for name in ('master_shaft/glue', 'press/blow'):
        assert topics[name].type_name == 'std_msgs/msg/Bool' and topics[name].qos is LATCHED
    assert topics['press/trajectory'].type_name == 'trajectory_msgs/msg/JointTrajectory'
    assert 'feeder/trajectory' not in topics
