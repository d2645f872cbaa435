# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The recorder as a process: what it has kept when it is killed, and when all stop together."""

from pathlib import Path
import signal
import time

from cam_motion.io.bag import BagReader, read_joint_states, read_points
from cam_motion.io.config import load_machine
from cam_motion.nodes.bag_recorder import BagRecorder
from cam_motion.nodes.wire import pack_point
from diagnostic_msgs.msg import DiagnosticArray
from mcap.reader import make_reader
import pytest
from rosbags.rosbag2 import Reader
from trajectory_msgs.msg import JointTrajectoryPoint

pytestmark = [pytest.mark.ros, pytest.mark.slow, pytest.mark.timeout(240)]

START = 60.0  # s; until a process that has just been started is heard
LOST = 1.5  # s; what a killed recorder may have lost at most
AXES = ('feeder', 'press', 'knife')
TYPES = {
    '/shaft': 'trajectory_msgs/msg/JointTrajectoryPoint',
    '/joint_states': 'sensor_msgs/msg/JointState',
    '/feeder/setpoint': 'trajectory_msgs/msg/JointTrajectoryPoint',
    '/press/setpoint': 'trajectory_msgs/msg/JointTrajectoryPoint',
    '/knife/setpoint': 'trajectory_msgs/msg/JointTrajectoryPoint',
    '/feeder_drive/drive_state': 'sensor_msgs/msg/JointState',
    '/master_shaft/state': 'std_msgs/msg/String', '/line/state': 'std_msgs/msg/String',
    '/diagnostics': 'diagnostic_msgs/msg/DiagnosticArray',
}


@pytest.fixture
def heard(world):
    """Say how many messages the recorder with a bag says to have written."""
    messages = world.listen(DiagnosticArray, '/diagnostics')

    def heard(bag):
        counts = [0]
        for message in messages:
            values = {pair.key: pair.value for pair in message.status[0].values}
            if values.get('bag', '').endswith(bag):
                counts.append(int(values['messages']))
        return counts[-1]
    return heard


def test_a_recorder_beside_a_line(world, start, machine_file, tmp_path, heard):
    shaft = world.points('shaft')
    line = start('line', '--params-file', machine_file, '-p', 'master_shaft:rate_hz:=200.0')

    def recorder(name):
        return start('bag_recorder', '--params-file', machine_file,
                     '-p', f'output:={tmp_path / name}')
    first = recorder('killed')
    assert world.spin_until(
        lambda: heard('killed') > 2000 and shaft[-1].velocity > 15.0, START), first.said
    killed_at = time.time()
    first.signal(signal.SIGKILL)
    assert first.exit_code() == -signal.SIGKILL
    check_killed_bag(tmp_path / 'killed', killed_at)

    # what it has recorded is not overwritten
    before = contents(tmp_path / 'killed')
    refused = recorder('killed')
    last = recorder('stopped')
    assert world.spin_until(lambda: not refused.running, START)
    assert refused.exit_code() == 2, refused.said
    assert 'output' in refused.complained and 'Traceback' not in refused.said
    assert contents(tmp_path / 'killed') == before

    # all stop together, the recorder told first
    assert world.spin_until(lambda: heard('stopped') > 500, START), last.said
    last.signal(signal.SIGINT)
    line.signal(signal.SIGINT)
    assert world.spin_until(lambda: not (last.running or line.running))
    assert (last.exit_code(), line.exit_code()) == (0, 0), last.said + line.said
    check_stopped_bag(tmp_path / 'stopped', machine_file)


def test_a_recorder_told_to_stop_waits_while_a_resting_machine_still_speaks(world, tmp_path):
    node = world.make(BagRecorder, {'output': str(tmp_path / 'bag'), 'topics': ['shaft']})
    node.trigger_configure()
    shaft = world.probe.create_publisher(JointTrajectoryPoint, 'shaft', 10)
    node.trigger_activate()
    assert world.spin_until(lambda: shaft.get_subscription_count() > 0)
    shaft.publish(pack_point(1.0, 5.0, -30.0, 0, 0))
    assert world.spin_until(lambda: node._last_shaft is not None)
    node.begin_stop()
    # slowing down, then at rest: the answers to the last points may still be on their way
    for step in range(1, 12):
        speed = max(0.0, 5.0 - step)
        shaft.publish(pack_point(1.0, speed, -30.0 if speed else 0.0, step, 0))
        world.spin_for(0.05)
        assert not node.stopped
    assert world.spin_until(lambda: node.stopped)
    node.trigger_deactivate()
    with BagReader(tmp_path / 'bag') as reader:
        assert read_points(reader, '/shaft').velocities[-1, 0] == 0.0


def contents(folder):
    """Give the files of a bag by name."""
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def check_killed_bag(bag, killed_at):
    """Open a bag with two libraries that are not ours; it must reach to near the end."""
    file, = Path(bag).glob('*.mcap')
    with Reader(bag) as reader:
        assert TYPES.items() <= {c.topic: c.msgtype for c in reader.connections}.items()
        times = {connection.topic: stamp for connection, stamp, _ in reader.messages()}
        assert len(list(reader.messages())) == reader.message_count > 1000
    assert killed_at - LOST < times['/shaft'] * 1e-9 < killed_at + LOST
    assert killed_at - LOST < times['/knife/setpoint'] * 1e-9
    with file.open('rb') as stream:
        found = [message.log_time for _, _, message in make_reader(
            stream, validate_crcs=True).iter_messages(topics=['/shaft'])]
    assert max(found) == times['/shaft']


def check_stopped_bag(bag, machine_file):
    """Check that the end of the line's motion is in the bag, to the hold setpoints."""
    machine = load_machine(machine_file)
    with BagReader(bag) as reader:
        shaft = read_points(reader, '/shaft')
        for axis in AXES:
            points = read_points(reader, f'/{axis}/setpoint')
            position, velocity, acceleration = (
                getattr(points, name)[:, 0] for name in (
                    'positions', 'velocities', 'accelerations'))
            assert list(velocity[-2:]) == list(acceleration[-2:]) == [0.0, 0.0]
            y = machine.diagram.axes[axis].profile.sample(float(shaft.positions[-1, 0]))[0]
            assert list(position[-2:]) == [y, y]
        assert abs(shaft.velocities).max() > 15.0
        assert (shaft.velocities[-1, 0], shaft.accelerations[-1, 0]) == (0.0, 0.0)
        drive = read_joint_states(reader, '/feeder_drive/drive_state')
        assert list(drive.velocities[-1]) == [0.0, 0.0]
