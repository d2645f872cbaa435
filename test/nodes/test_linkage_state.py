# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The umbrella as a node: joint states against the solver, markers, and what is refused."""

import math
from pathlib import Path
import signal

from cam_motion.io.bag import BagReader, read_joint_states, read_points
from cam_motion.io.config import read_sections
from cam_motion.io.linkage_config import build_linkage
from cam_motion.mechanism.linkage_motion import holding_efforts, move
from cam_motion.nodes.bag_recorder import BagRecorder
from cam_motion.nodes.line import make_line
from cam_motion.nodes.linkage_state import LinkageState
from cam_motion.nodes.runner import bring_to_rest
from cam_motion.nodes.runner import start as start_nodes
from cam_motion.nodes.wire import pack_point
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
import numpy as np
import pytest
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectoryPoint
from visualization_msgs.msg import Marker, MarkerArray

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

CONFIG = Path(__file__).resolve().parents[2] / 'config' / 'umbrella.yaml'
SECTION = read_sections(CONFIG)['umbrella']
SETTINGS = build_linkage('umbrella', SECTION)
SPOOL, START = 0.02, 0.8  # h2 = 0.8 m + 0.02 m times the angle of the crank
EXACT = 1e-12
PERIOD = 0.002
START_OF_PROCESS = 60.0  # s


def solved(h1, h2, h1_dot=0.0, h2_dot=0.0):
    """Solve straight from the start."""
    assembly = SETTINGS.assembly
    return move(assembly, assembly.at({'h1': h1, 'h2': h2}), {'h1': h1_dot, 'h2': h2_dot})


class Umbrella:
    """A node with somebody who turns its axes and listens to it."""

    def __init__(self, world, **changes):
        self.world = world
        self.node = world.make(LinkageState, {**SECTION, **changes}, name='umbrella')
        self.node.trigger_configure()
        self.node.trigger_activate()
        assert self.node.active
        self.states = world.listen(JointState, 'umbrella/joint_states')
        self.drawings = world.listen(MarkerArray, 'umbrella/markers')
        self.said = world.states('umbrella')
        self.axes = {axis: world.speaker(JointTrajectoryPoint, f'{axis}/setpoint')
                     for axis in ('slider', 'crank')}
        publishers = [p for p in self.node.publishers
                      if p.topic_name.endswith(('/joint_states', '/markers'))]
        assert world.spin_until(lambda: all(p.get_subscription_count() for p in publishers))
        self.tick = 0

    def tell(self, axis, tick, position, velocity=0.0):
        """Send a setpoint."""
        self.axes[axis].publish(pack_point(
            position, velocity, 0.0, *divmod(round(tick * PERIOD * 1e9), 10**9)))

    def go(self, h1, h2=START, h1_dot=0.0, h2_dot=0.0):
        """Send one tick."""
        self.tell('slider', self.tick, h1, h1_dot)
        self.tell('crank', self.tick, (h2 - START) / SPOOL, h2_dot / SPOOL)
        self.tick += 1
        self.world.spin_for(0.003)  # a queue holds ten

    def stay(self, condition, *inputs):
        """Send ticks until a condition holds."""
        def told():
            self.go(*inputs)
            return condition()
        assert self.world.spin_until(told), self.node.state_text


@pytest.fixture
def umbrella(world):
    """Make the node."""
    return lambda **changes: Umbrella(world, **changes)


def test_the_joint_states_are_those_of_the_solver_and_their_own_derivatives(world, umbrella):
    its = umbrella()
    times = np.arange(60) * PERIOD
    h1, h2 = 1.0 + 0.3 * np.sin(4.0 * times), START + 0.2 * np.sin(3.0 * times)
    h1_dot, h2_dot = 1.2 * np.cos(4.0 * times), 0.6 * np.cos(3.0 * times)
    # the crank is ahead of the slider, by more ticks or fewer
    for ticks in (range(5), *(range(k, min(k + 8, 60)) for k in range(5, 60, 8))):
        for tick in ticks:
            its.tell('crank', tick, (h2[tick] - START) / SPOOL, h2_dot[tick] / SPOOL)
        for tick in ticks:
            its.tell('slider', tick, h1[tick], h1_dot[tick])
        world.spin_until(lambda last=ticks[-1]: len(its.states) > last)
    assert len(its.states) == 60
    names = list(its.states[0].name)
    assert names[:6] == ['h1', 'h2', 'theta2', 'theta3', 'theta5', 'theta6']
    assert len(set(names)) == len(names) == len(its.states[0].position)
    stamps = [s.header.stamp.sec * 10**9 + s.header.stamp.nanosec for s in its.states]
    assert set(np.diff(stamps)) == {2_000_000}
    for tick, state in enumerate(its.states):
        motion = solved(h1[tick], h2[tick], h1_dot[tick], h2_dot[tick])
        for k, name in enumerate(names[:6]):
            assert state.position[k] == pytest.approx(motion.position[name], abs=EXACT)
            assert state.velocity[k] == pytest.approx(motion.velocity[name], abs=1e-11)
    positions = np.array([state.position for state in its.states])
    velocities = np.array([state.velocity for state in its.states])
    slopes = (positions[2:] - positions[:-2]) / (2.0 * PERIOD)
    third = 4.0 ** 3 * 3.0  # of the order of the third derivatives [rad/s³]
    assert np.abs(slopes - velocities[1:-1]).max() < third * PERIOD ** 2
    assert np.abs(velocities[:, :6]).max(axis=0).min() > 0.1


def test_the_markers_can_be_drawn_and_lie_where_the_linkage_is(world, umbrella):
    its = umbrella(markers_hz=0.0, frame_id='hall')
    for h1_dot in (0.0, -0.3, -0.3):
        its.go(1.0, 0.9, h1_dot)
    assert world.spin_until(lambda: len(its.drawings) == 3)
    still, *moving = its.drawings
    keys = [[(m.ns, m.id) for m in drawing.markers] for drawing in its.drawings]
    assert keys[0] == keys[1] == keys[2] and len(set(keys[0])) == len(keys[0])
    assert {ns for ns, _ in keys[0]} == {'links', 'slides', 'joints', 'names', 'velocities'}
    for drawing in its.drawings:
        for marker in drawing.markers:
            assert marker.header.frame_id == 'hall'
            if marker.action == Marker.DELETE:
                continue
            q, scale, kind = marker.pose.orientation, marker.scale, marker.type
            assert math.hypot(q.x, q.y, q.z, q.w) == pytest.approx(1.0, abs=1e-15)
            sizes = {Marker.LINE_LIST: [scale.x], Marker.ARROW: [scale.x, scale.y],
                     Marker.SPHERE: [scale.x, scale.y, scale.z],
                     Marker.TEXT_VIEW_FACING: [scale.z]}[kind]
            assert min(sizes) > 0.0 and marker.color.a == 1.0
            assert marker.lifetime.sec >= 1
            assert len(marker.points) == (2 if kind == Marker.ARROW else 2 * len(
                marker.points) // 2)
    arrows = [[m for m in each.markers if m.ns == 'velocities'] for each in (still, moving[-1])]
    assert {m.action for m in arrows[0]} == {Marker.DELETE}
    motion = solved(1.0, 0.9, -0.3)
    points = {m.text: m.pose.position for m in moving[-1].markers if m.ns == 'names'}
    assert set(points) == set('ABCGFED')
    for (name, place), arrow in zip(points.items(), arrows[1]):
        want = motion.points[name]
        assert complex(place.x, place.y) == pytest.approx(want.position, abs=EXACT)
        assert (arrow.action == Marker.ADD) is (abs(want.velocity) > 0.0)
        if arrow.action == Marker.ADD:
            foot, tip = (complex(p.x, p.y) for p in arrow.points)
            assert foot == pytest.approx(want.position, abs=EXACT)
            assert tip - foot == pytest.approx(0.2 * want.velocity, abs=EXACT)
    ends = {complex(round(p.x, 9), round(p.y, 9)) for m in moving[-1].markers
            if m.ns in ('links', 'slides') for p in m.points}
    joints = {complex(round(p.x, 9), round(p.y, 9)) for p in points.values()}
    assert joints <= ends


def test_inputs_out_of_range_are_refused_with_the_range_and_the_node_recovers(world, umbrella):
    its = umbrella(markers_hz=0.0)
    reports = world.listen(DiagnosticArray, '/diagnostics')
    its.stay(lambda: its.said[-1:] == ['following'], 2.0)
    its.stay(lambda: its.said[-1].startswith('held'), 2.3)
    for words in ('h1: 2.3', 'from 0.2 m to 2.2 m', 'link2 and link3 come into line'):
        assert words in its.said[-1]
    world.spin_for(0.1)
    count, drawn = len(its.states), len(its.drawings)
    for h1 in np.linspace(2.3, 2.5, 20):
        its.go(h1)
    assert world.spin_until(lambda: len(its.drawings) >= drawn + 20)
    # it is said once, and the last good position is kept, drawn in red
    assert [text[:4] for text in its.said].count('held') == 1
    assert len(its.states) == count
    assert its.node._tracker.pose['h1'] == its.states[-1].position[0] == 2.0
    links = [m for m in its.drawings[-1].markers if m.ns == 'links']
    assert {(m.color.r > 0.7, m.color.b < 0.2) for m in links} == {(True, True)}

    def reported():
        return [status for each in reports for status in each.status
                if status.name == 'umbrella' and status.level == DiagnosticStatus.ERROR]
    assert world.spin_until(reported)
    assert 'h1: 2.3' in {pair.key: pair.value for pair in reported()[-1].values}['reason']
    its.stay(lambda: its.said[-1] == 'following', 1.0, 1.1)
    assert world.spin_until(lambda: len(its.states) > count)
    # on the branch of the start as before
    motion = solved(1.0, 1.1)
    assert its.states[-1].position[2:6] == pytest.approx(
        [motion.position[f'theta{k}'] for k in (2, 3, 5, 6)], abs=EXACT)


def test_a_late_joiner_hears_the_state_and_deactivation_waits_anew(world, umbrella):
    its = umbrella()
    its.tell('crank', 0, 1.0)
    world.spin_for(0.05)
    assert world.states('umbrella') is not None and its.node.state_text == 'waiting'
    assert its.node.health()[1]['waiting_for'] == 'slider'
    its.tell('slider', 0, 1.0)
    late = []
    assert world.spin_until(lambda: its.states)
    late = world.states('umbrella')
    assert world.spin_until(lambda: late == ['following'])
    its.node.trigger_deactivate()
    its.go(1.1)
    world.spin_for(0.1)
    assert len(its.states) == 1
    its.node.trigger_activate()
    its.go(1.2)
    assert world.spin_until(lambda: len(its.states) == 2)
    assert its.states[-1].position[0] == 1.2


def test_a_linkage_that_is_held_says_so_again_after_it_was_deactivated(world, umbrella):
    its = umbrella()
    its.stay(lambda: its.said[-1:] == ['following'], 2.0)
    its.stay(lambda: its.said[-1].startswith('held'), 2.3)
    its.node.trigger_deactivate()
    its.node.trigger_activate()
    assert its.node.state_text == 'waiting' and 'reason' not in its.node.health()[1]
    its.stay(lambda: its.said[-1].startswith('held'), 2.3)
    its.stay(lambda: its.said[-1] == 'following', 2.0)


def test_a_crank_that_has_been_turning_for_a_day_is_followed_at_once(world):
    node = world.make(LinkageState, read_sections(CONFIG.with_name('slider_crank.yaml'))[
        'slider_crank'], name='slider_crank')
    node.trigger_configure()
    node.trigger_activate()
    states = world.listen(JointState, 'slider_crank/joint_states')
    motor = world.speaker(JointTrajectoryPoint, 'motor/setpoint')
    assert world.spin_until(lambda: any(
        p.topic_name.endswith('/joint_states') and p.get_subscription_count()
        for p in node.publishers))
    angle = math.radians(90.0) + math.tau * 86400
    motor.publish(pack_point(angle, 0.0, 0.0, 0, 0))
    assert world.spin_until(lambda: states)
    position = dict(zip(states[0].name, states[0].position))
    assert position['theta2'] == angle
    assert position['x'] == pytest.approx(math.sqrt(0.3 ** 2 - 0.1 ** 2), abs=1e-9)


def test_rates_and_efforts_are_as_configured(world, umbrella):
    its = umbrella(joint_states_hz=100.0, markers_hz=50.0, **{
        'loads': ['rain'], 'rain.point': 'D', 'rain.force_y': -10.0})
    for tick in range(50):
        its.go(1.0 + 0.001 * tick, 0.9)
    assert world.spin_until(lambda: len(its.states) == 10 and len(its.drawings) == 5)
    world.spin_for(0.05)
    assert (len(its.states), len(its.drawings)) == (10, 5)
    state = its.states[-1]
    h1 = state.position[0]
    want = holding_efforts(SETTINGS.assembly, SETTINGS.assembly.at({'h1': h1, 'h2': 0.9}),
                           {'D': -10.0j})
    assert list(state.effort[:2]) == pytest.approx([want['h1'], want['h2']], abs=1e-9)
    assert abs(want['h1']) > 1.0 and not any(state.effort[2:])


BROKEN = """
bars:
  ros__parameters:
    type: linkage
    inputs: [turn]
    turn: {start_deg: 60.0, axes: motor}
    unknowns: [theta3, x]
    theta3: {start_deg: -16.8}
    x: {start: x}
    bodies: [crank, rod]
    crank: {angle: turn}
    rod: {angel: theta3}
    vectors: [r]
    r: {length: -0.1, body: crank}
    loops: [ring]
    ring: {path: [r, l]}
    markers_hz: -1.0
"""


@pytest.mark.slow
def test_processes_follow_and_end_when_told(world, start, tmp_path):
    broken = tmp_path / 'broken.yaml'
    broken.write_text(BROKEN)
    bad = start('linkage_state', '--params-file', broken, '-r', '__node:=bars')
    nodes = [start('linkage_state', '--params-file', CONFIG, '-r', '__node:=umbrella',
                   '-r', f'__ns:=/{name}') for name in ('l1', 'l2')]
    states = [world.listen(JointState, f'/{name}/umbrella/joint_states') for name in ('l1', 'l2')]
    speakers = [(world.probe.create_publisher(
        JointTrajectoryPoint, f'/{name}/{axis}/setpoint', 10), position)
        for name in ('l1', 'l2') for axis, position in (('slider', 1.5), ('crank', 10.0))]
    told = 0

    def heard():
        nonlocal told
        told += 1
        for speaker, position in speakers:
            speaker.publish(pack_point(position, 0.0, 0.0, 0, told * 1_000_000))
        return all(states)
    assert world.spin_until(heard, START_OF_PROCESS), ''.join(node.said for node in nodes)
    for each in states:
        want = solved(1.5, 1.0).position
        assert each[0].position[2:6] == pytest.approx(
            [want[f'theta{k}'] for k in (2, 3, 5, 6)], abs=EXACT)
    for node, number in zip(nodes, (signal.SIGINT, signal.SIGTERM)):
        node.signal(number)
    assert world.spin_until(lambda: not any(node.running for node in (*nodes, bad)))
    for node in nodes:
        assert node.exit_code() == 0, node.said
        assert 'Traceback' not in node.said
    assert bad.exit_code() == 2
    for path in ('bars.turn.axes', 'bars.x.start', 'bars.rod.angle', 'bars.r.length',
                 'bars.markers_hz'):
        assert path in bad.complained


def test_a_line_with_the_umbrella_is_recorded(world, tmp_path):
    recorder = world.make(BagRecorder, {
        'output': str(tmp_path / 'bag'), 'machine': str(CONFIG)})
    recorder.trigger_configure()
    recorder.trigger_activate()
    nodes = [world.add(node) for node in make_line(
        context=world.context, cli_args=['--ros-args', '--params-file', str(CONFIG)])]
    assert [node.get_name() for node in nodes] == [
        'master_shaft', 'slider', 'crank', 'umbrella', 'line']
    states = world.listen(JointState, 'umbrella/joint_states')
    assert start_nodes(nodes) == 0
    assert world.spin_until(lambda: states and states[-1].position[0] < 1.999)
    bring_to_rest(world.executor, nodes)
    world.spin_for(0.2)
    recorder.trigger_deactivate()
    check_bag(tmp_path / 'bag')


def check_bag(path):
    """Compare the joint states in a bag with the setpoints in it."""
    with BagReader(path) as bag:
        joints = read_joint_states(bag, '/umbrella/joint_states')
        slider, crank = (read_points(bag, f'/{axis}/setpoint') for axis in ('slider', 'crank'))
        assert bag.topics['/umbrella/state'].count > 0
    assert list(joints.names[:2]) == ['h1', 'h2']
    assert len(joints.positions) > 150
    # the recorder may have found one topic later than the others
    for column, setpoints in ((0, slider.positions), (1, START + SPOOL * crank.positions)):
        assert set(joints.positions[-100:, column]) <= set(setpoints[:, 0])
    for row in joints.positions[::50]:
        want = solved(*row[:2]).position
        assert row[2:6] == pytest.approx([want[f'theta{k}'] for k in (2, 3, 5, 6)], abs=EXACT)
    assert not joints.velocities[-1].any()
