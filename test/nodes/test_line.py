# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The whole machine on one executor: its topics, its setpoints, and what it refuses to start."""

import sys

from cam_motion.io.config import load_machine
from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.line import make_line
from cam_motion.nodes.line_topics import topics_of
from cam_motion.nodes.runner import bring_to_rest, start
import numpy as np
import pytest
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import String

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

POINT = 'trajectory_msgs/msg/JointTrajectoryPoint'
STATE = 'std_msgs/msg/String'
CONTRACT = {
    '/shaft': POINT, '/joint_states': 'sensor_msgs/msg/JointState',
    '/feeder/setpoint': POINT, '/press/setpoint': POINT, '/knife/setpoint': POINT,
    **{f'/{axis}/{name}': 'std_msgs/msg/Float64' for axis in ('feeder', 'press', 'knife')
       for name in ('max_speed_cpm', 'format_change')},
    '/feeder_drive/drive_state': 'sensor_msgs/msg/JointState',
    '/master_shaft/state': STATE, '/feeder/state': STATE, '/press/state': STATE,
    '/knife/state': STATE, '/feeder_drive/state': STATE, '/line/state': STATE,
    '/diagnostics': 'diagnostic_msgs/msg/DiagnosticArray',
}
SERVICES = {
    '/master_shaft/run': 'std_srvs/srv/SetBool',
    '/master_shaft/stop_at_cycle_end': 'std_srvs/srv/Trigger',
    '/master_shaft/quick_stop': 'std_srvs/srv/Trigger',
    '/master_shaft/reset': 'std_srvs/srv/Trigger',
    **{f'/{axis}/engage': 'std_srvs/srv/SetBool' for axis in ('feeder', 'press', 'knife')},
    **{f'/{axis}/reset': 'std_srvs/srv/Trigger' for axis in ('feeder', 'press', 'knife')},
}
AXES = ('feeder', 'press', 'knife')
OF_THE_PEAK = 1e-9  # what the recorded setpoints may differ from the exact curve


@pytest.fixture
def line(world, machine_file):
    """Make the nodes of the cutting machine, with parameters of the line or a master changed."""
    def line(*arguments, config=machine_file, **changes):
        nodes = make_line(
            context=world.context,
            cli_args=['--ros-args', '--params-file', str(config), *arguments],
            parameter_overrides=[Parameter(n, value=v) for n, v in changes.items()])
        return [world.add(node) for node in nodes]
    return line


def edited(machine_file, tmp_path, *replacements):
    """Write the machine file with some of its text replaced."""
    text = machine_file.read_text()
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new, 1)
    path = tmp_path / 'edited.yaml'
    path.write_text(text)
    return path


def test_a_line_offers_the_topics_and_services_of_the_contract(world, line):
    nodes = line()
    assert start(nodes) == 0

    def offered():
        return {name: types[0] for name, types in world.probe.get_topic_names_and_types()
                if world.probe.count_publishers(name)}
    assert world.spin_until(lambda: CONTRACT.items() <= offered().items())
    services = {name: types[0] for name, types in world.probe.get_service_names_and_types()}
    assert SERVICES.items() <= services.items()
    own = {name for name in offered() if not name.endswith('transition_event')}
    assert own - {'/rosout', '/parameter_events'} == set(CONTRACT)
    infos = world.probe.get_subscriptions_info_by_topic('/master_shaft/speed_cpm')
    assert [info.topic_type for info in infos] == ['std_msgs/msg/Float64']
    sections = {'line': {'axes': list(AXES), 'drives': ['feeder_drive']}}
    expected = {t.name if t.name.startswith('/') else f'/{t.name}': t.type_name
                for t in topics_of(sections)}
    assert expected == CONTRACT


def test_every_axis_answers_every_tick_once_and_exactly(world, line, machine_file):
    nodes = line()
    shaft = world.points('shaft')
    setpoints = {axis: world.points(f'{axis}/setpoint') for axis in AXES}
    states = world.listen(JointState, 'feeder_drive/drive_state')
    nodes[0].trigger_configure()
    assert world.spin_until(lambda: nodes[0]._ticker.points.get_subscription_count() == 1)
    nodes[0].trigger_cleanup()
    assert start(nodes) == 0
    assert world.spin_until(lambda: shaft and shaft[-1].position > 12.0)
    bring_to_rest(world.executor, nodes)
    # the last setpoint comes twice: as the answer to the last tick, and to hold
    assert world.spin_until(lambda: all(
        len(each) > 1 and each[-1] == each[-2] for each in setpoints.values()))
    machine = load_machine(machine_file)
    phi, omega, alpha = np.array([point[:3] for point in shaft]).T
    by_time = {point[3:]: k for k, point in enumerate(shaft)}
    for axis, points in setpoints.items():
        *answers, hold = points
        assert hold == answers[-1]
        assert len({point[3:] for point in answers}) == len(answers)
        # the first few may have gone before the topics had found each other
        assert [point[3:] for point in answers] == [
            point[3:] for point in shaft[-len(answers):]]
        assert len(answers) > 500
        where = [by_time[point[3:]] for point in answers]
        profile = machine.diagram.axes[axis].profile
        y, slope, bend = (profile(phi[where], order) for order in (0, 1, 2))
        w, a = omega[where], alpha[where]
        recorded = np.array([point[:3] for point in answers]).T
        for one, other in zip(recorded, (y, slope * w, bend * w * w + slope * a)):
            assert np.abs(other).max() > 0.0
            assert np.abs(one - other).max() <= OF_THE_PEAK * np.abs(other).max()
    drive = machine.drives['feeder_drive'].drive
    followed = {point[3:]: drive.follow(*point[:3]) for point in setpoints['feeder']}
    torques = {state.motor_torque for state in followed.values()}
    assert len(states) > 500
    assert {state.effort[0] for state in states} <= torques


@pytest.mark.parametrize('change, path, words', [
    (('speed_cpm: 200.0', 'speed_cpm: 400.0'), 'feeder.limits.acceleration',
     ('400 cycles/min', 'segment feed', 'run at most')),
    (('velocity: 2.0', 'velocity: 0.2'), 'press.limits.velocity', ('segment close', 'm/s')),
])
def test_a_speed_above_the_limits_is_refused_with_the_figures(
        line, machine_file, tmp_path, change, path, words):
    nodes = line(config=edited(machine_file, tmp_path, change))
    assert start(nodes) == 2
    problems = {problem.path: str(problem) for node in nodes for problem in node.problems}
    assert path in problems
    for word in words:
        assert word in problems[path]
    assert not any(node.active for node in nodes)


@pytest.mark.parametrize('change, node, path', [
    (('axes: [feeder, press, knife]', 'axes: [feeder, press, knive]'), 'knive', 'segments'),
    (('axis: feeder', 'axis: feader'), 'line', 'feeder_drive.axis'),
    (('lift: 0.300', 'lift: -.nan'), 'feeder', 'feed.lift'),
])
def test_what_does_not_fit_together_is_refused(
        line, machine_file, tmp_path, change, node, path):
    nodes = line(config=edited(machine_file, tmp_path, change))
    assert start(nodes) == 2
    found = {(each.get_name(), problem.path) for each in nodes for problem in each.problems}
    assert (node, path) in found
    # each problem is said by one node only
    said = [f'{n}.{p}' if n != 'line' else p for n, p in found]
    assert len(said) == len(set(said))


@pytest.fixture
def line_in(world, monkeypatch):
    """Make a line in a namespace, from the file that stands on the command line."""
    def line_in(namespace, config):
        arguments = ['--ros-args', '--params-file', str(config), '-r', f'__ns:=/{namespace}']
        monkeypatch.setattr(sys, 'argv', ['line', *arguments])
        nodes = make_line(context=world.context, cli_args=arguments)
        return {world.add(node).get_name(): node for node in nodes}
    return line_in


def test_a_machine_file_applies_in_any_namespace(world, line_in, machine_file):
    for name in ('l1', 'l2'):
        nodes = line_in(name, machine_file)
        assert set(nodes) == {'master_shaft', *AXES, 'feeder_drive', 'line'}
        assert {node.get_namespace() for node in nodes.values()} == {f'/{name}'}
        assert start(list(nodes.values())) == 0
    setpoints = [world.points(f'{name}/knife/setpoint') for name in ('l1', 'l2')]
    assert world.spin_until(lambda: all(setpoints))


TWO_LINES = """
/l1/line: {ros__parameters: {axes: [belt]}}
/l2/line: {ros__parameters: {axes: [belt]}}
/l1/belt:
  ros__parameters:
    {cycle: accumulate, segments: [go], go: {law: cycloidal, end_deg: 360.0, lift: 1.0}}
/l2/belt:
  ros__parameters:
    {cycle: accumulate, segments: [run], run: {law: cubic, end_deg: 360.0, lift: 2.0}}
"""


def test_one_file_may_hold_a_line_for_each_of_two_namespaces(line_in, tmp_path):
    path = tmp_path / 'two_lines.yaml'
    path.write_text(TWO_LINES)
    for name, advance in (('l1', 1.0), ('l2', 2.0)):
        nodes = line_in(name, path)
        assert start(list(nodes.values())) == 0
        assert nodes['belt'].axis.profile.advance == pytest.approx(advance, rel=1e-12)


def test_an_empty_list_of_drives_may_be_written_out(line, machine_file, tmp_path):
    nodes = line(config=edited(
        machine_file, tmp_path, ('drives: [feeder_drive]', 'drives: []')))
    assert start(nodes) == 0


def test_a_line_with_one_axis_needs_no_drive(world, line, machine_file, tmp_path):
    nodes = line(config=edited(
        machine_file, tmp_path, ('axes: [feeder, press, knife]', 'axes: [press]'),
        ('    drives: [feeder_drive]\n', '')))
    assert [node.get_name() for node in nodes] == ['master_shaft', 'press', 'line']
    assert start(nodes) == 0
    setpoints = world.points('press/setpoint')
    assert world.spin_until(lambda: len(setpoints) > 10)
    texts = world.listen(String, 'line/state', nodes[-1]._state.qos_profile)
    assert world.spin_until(lambda: [message.data for message in texts] == ['active'])


def test_a_part_that_is_not_active_does_not_hold_up_the_others(world, line):
    nodes = line()
    assert start(nodes) == 0
    press = next(node for node in nodes if node.get_name() == 'press')
    assert isinstance(press, CamAxis)
    press.trigger_deactivate()
    press.trigger_cleanup()
    knife = world.points('knife/setpoint')
    silent = world.points('press/setpoint')
    assert world.spin_until(lambda: len(knife) > 200)
    assert silent == []
    press.trigger_configure()
    press.trigger_activate()
    assert world.spin_until(lambda: len(silent) > 50)
    known = {point[3:] for point in knife}
    assert {point[3:] for point in silent[:-5]} <= known
