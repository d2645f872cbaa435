# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Every node alone as a process: with the plain machine file, remapped, or badly configured."""

import signal

from cam_motion.io.bag import BagReader
from diagnostic_msgs.msg import DiagnosticArray
import pytest
from sensor_msgs.msg import JointState

pytestmark = [pytest.mark.ros, pytest.mark.slow, pytest.mark.timeout(240)]

START = 60.0  # s; until a process that has just been started is heard
BROKEN = """
line:
  ros__parameters: {master: master_shaft, axes: [feeder, press], drives: [feeder_drive]}
master_shaft:
  ros__parameters: {speed_cmp: 200.0, rate_hz: 0.5, jerk: .nan}
feeder:
  ros__parameters:
    cycle: acumulate
    segments: [feed, wait]
    feed: {law: modified_trapezium, end_deg: 80.0, lift: 0.3}
    wait: {end_deg: 350.0}
    limits: {velocity: -1.0}
press:
  ros__parameters:
    segments: [close, open]
    close: {law: cycloidal, end_deg: 135.0, lift: 0.02}
    open: {law: cycloidal, end_deg: 360.0, lift: -0.03}
feeder_drive:
  ros__parameters: {axis: feeder, efficiency: 1.5}
"""
PROBLEMS = [
    'master_shaft.speed_cmp', 'master_shaft.rate_hz', 'master_shaft.jerk', 'feeder.cycle',
    'feeder.feed.law', 'feeder.wait.end_deg', 'feeder.limits.velocity', 'press.cycle',
    'feeder_drive.efficiency',
]


def test_every_node_runs_alone_in_a_namespace_and_ends_when_told(
        world, start, machine_file, tmp_path):
    common = ['--params-file', machine_file, '-r', '__ns:=/l1', '-r', 'shaft:=/plant/line_shaft']
    shaft = world.points('/plant/line_shaft')
    setpoints = world.points('/l1/knife/setpoint')
    drive_states = world.listen(JointState, '/l1/motor/drive_state')
    reports = world.listen(DiagnosticArray, '/diagnostics')
    nodes = {
        'master': start('master_shaft', *common, '-p', 'rate_hz:=100.0'),
        # four processes that start at once may hold each other up: that is no silence
        'axis': start('cam_axis', *common, '-r', '__node:=knife', '-p', 'master_timeout:=20.0'),
        # no section bears this name: the parameters come one by one
        'drive': start('drive_sim', *common, '-r', '__node:=motor', '-p', 'axis:=knife',
                       '-p', 'radius:=0.05', '-p', 'load_inertia:=1'),
        'recorder': start('bag_recorder', *common, '-p', f'output:={tmp_path / "bag"}'),
    }

    def recorded():
        return [int(pair.value) for report in reports for pair in report.status[0].values
                if report.status[0].name == 'bag_recorder' and pair.key == 'messages']
    assert world.spin_until(
        lambda: shaft and setpoints and drive_states and any(recorded()) and all(
            abs(series[-1][1]) > 0.1 for series in (shaft, setpoints)), START), (
                ''.join(node.said for node in nodes.values()))
    assert world.spin_until(lambda: world.probe.count_subscribers('/l1/knife/setpoint') == 3)
    count = recorded()[-1]
    assert world.spin_until(lambda: recorded()[-1] > count + 300)
    heard = {point[3:] for point in shaft}
    assert all(point[3:] in heard for point in setpoints[:-5] if point[3:] >= min(heard))
    assert list(drive_states[-1].name) == ['motor', 'load']
    for name, number in (('recorder', signal.SIGINT), ('drive', signal.SIGTERM),
                         ('master', signal.SIGINT), ('axis', signal.SIGTERM)):
        nodes[name].signal(number)
        if name == 'master':  # so that the axis hears it come to rest
            assert world.spin_until(lambda: shaft[-1][1:3] == (0.0, 0.0))
    assert world.spin_until(lambda: not any(node.running for node in nodes.values()))
    for name, node in nodes.items():
        assert (name, node.exit_code()) == (name, 0), node.said
        assert 'Traceback' not in node.said
    assert world.spin_until(lambda: setpoints[-1] == setpoints[-2])
    assert setpoints[-1][1:3] == (0.0, 0.0)
    with BagReader(tmp_path / 'bag') as bag:
        counts = {topic: info.count for topic, info in bag.topics.items()}
    for topic in ('/plant/line_shaft', '/l1/knife/setpoint', '/l1/knife/state', '/diagnostics'):
        assert counts[topic] > 0, topic


@pytest.fixture
def ended(world, start):
    """Start nodes at once and wait for all to end on their own; give exit codes and errors."""
    def ended(*commands):
        processes = [start(*command) for command in commands]
        assert world.spin_until(lambda: not any(p.running for p in processes), START)
        return [(process.exit_code(), process.complained) for process in processes]
    return ended


def test_a_bad_configuration_is_refused_with_every_path_and_exit_code_2(ended, tmp_path):
    broken = tmp_path / 'broken.yaml'
    broken.write_text(BROKEN)
    missing = tmp_path / 'no_such_file.yaml'
    (line, line_said), (axis, axis_said), (absent, absent_said) = ended(
        ('line', '--params-file', broken),
        ('cam_axis', '--params-file', broken, '-r', '__node:=feeder'),
        ('line', '--params-file', missing))
    assert (line, axis, absent) == (2, 2, 2), line_said + axis_said + absent_said
    for path in PROBLEMS:
        assert path in line_said
        assert (path in axis_said) is path.startswith('feeder.')
    for hint in ('did you mean speed_cpm?', 'modified_trapezoid', 'one of return, accumulate'):
        assert hint in line_said
    assert str(missing) in absent_said
    assert absent_said.count('The configuration cannot be used') == 1
    for said in (line_said, axis_said, absent_said):
        assert 'Traceback' not in said


def test_wrong_arguments_and_names_are_refused_with_exit_code_2(ended, tmp_path):
    no_yaml = tmp_path / 'no_yaml.yaml'
    no_yaml.write_text('line: [')
    commands = [
        ('line', '--params-file', no_yaml),
        ('master_shaft', '-r', '__node:=two words'),
        ('drive_sim',),
        ('line', '-p', 'axes:=nothing'),
    ]
    for command, (code, said) in zip(commands, ended(*commands)):
        assert (command, code) == (command, 2), said
        assert 'Traceback' not in said
        assert 'cannot be used' in said
