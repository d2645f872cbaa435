# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
What the tests of the nodes share: a ROS world of their own, and processes that always end.

Every test has a context and a domain to itself. Waits are for conditions and generous, about ten
times what a quiet machine needs; nothing asserts how long something took.
"""

import itertools
import os
from pathlib import Path
import resource
import signal
import subprocess
import sys
import time
import warnings

from cam_motion.nodes.executor import make_executor
from cam_motion.nodes.qos import LATCHED, SETPOINTS
from cam_motion.nodes.wire import unpack_point
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import HistoryPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectoryPoint

with warnings.catch_warnings():
    # The first message imports a parser that imports a deprecated module.
    warnings.simplefilter('ignore', DeprecationWarning)
    import rosidl_generator_py  # noqa: F401

ROOT = Path(__file__).resolve().parents[2]
MACHINE = ROOT / 'config' / 'cutting_machine.yaml'
PATIENCE = 30.0  # s
CPU_SECONDS = 60  # that a process may use before it is killed
DEEP = QoSProfile(depth=20000)
_counter = itertools.count()


@pytest.fixture(scope='session', autouse=True)
def surroundings(tmp_path_factory):
    """Keep discovery on this machine and logs out of the way."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
        patch.setenv('ROS_LOG_DIR', str(tmp_path_factory.mktemp('ros_log')))
        yield


class World:
    """A context with its executor, the nodes of a test, and a probe that listens and asks."""

    def __init__(self, domain):
        self.domain = domain
        self.context = Context()
        rclpy.init(args=[], context=self.context, domain_id=domain,
                   signal_handler_options=SignalHandlerOptions.NO)
        self.executor = make_executor(self.context)
        self.nodes = []
        self.probe = self.add(Node('probe', context=self.context))

    def add(self, node):
        """Spin a node from now on."""
        self.nodes.append(node)
        self.executor.add_node(node)
        return node

    def make(self, factory, given=None, **options):
        """Make a node from parameters by flat name, and spin it."""
        overrides = [Parameter(name, value=value) for name, value in (given or {}).items()]
        return self.add(factory(context=self.context, parameter_overrides=overrides, **options))

    def spin_until(self, condition, seconds=PATIENCE):
        """Spin until a condition holds; say whether it came to."""
        deadline = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > deadline:
                return False
            self.executor.spin_once(timeout_sec=0.05)
        return True

    def spin_for(self, seconds):
        """Spin for a while."""
        self.spin_until(lambda: False, seconds)

    def listen(self, kind, topic, qos=DEEP):
        """Collect the messages of a topic."""
        messages = []
        self.probe.create_subscription(kind, topic, messages.append, qos)
        return messages

    def points(self, topic):
        """Collect the points of a topic, unpacked."""
        points = []
        self.probe.create_subscription(
            JointTrajectoryPoint, topic, lambda data: points.append(unpack_point(data)),
            DEEP, raw=True)
        return points

    def states(self, node):
        """Collect the states that a node tells."""
        texts = []
        latched = QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=100,
                             reliability=LATCHED.reliability, durability=LATCHED.durability)
        self.probe.create_subscription(
            String, f'{node}/state', lambda message: texts.append(message.data), latched)
        return texts

    def speaker(self, kind, topic, qos=SETPOINTS):
        """Make a publisher and wait until somebody listens."""
        publisher = self.probe.create_publisher(kind, topic, qos)
        assert self.spin_until(lambda: publisher.get_subscription_count() > 0)
        return publisher

    def call(self, kind, service, seconds=PATIENCE, **fields):
        """Call a service and give its response."""
        client = self.probe.create_client(kind, service)
        assert self.spin_until(client.service_is_ready, seconds), f'no service {service}'
        future = client.call_async(kind.Request(**fields))
        assert self.spin_until(future.done, seconds), f'no answer from {service}'
        self.probe.destroy_client(client)
        return future.result()

    def change(self, node, label, seconds=PATIENCE):
        """Ask a node for a transition, as `ros2 lifecycle set` does."""
        number = getattr(Transition, f'TRANSITION_{label.upper()}')
        return self.call(ChangeState, f'{node}/change_state', seconds,
                         transition=Transition(id=number)).success

    def state(self, node):
        """Ask a node for its lifecycle state."""
        return self.call(GetState, f'{node}/get_state').current_state.label

    def close(self):
        """End everything, whatever has happened."""
        try:
            self.executor.shutdown()
            for node in reversed(self.nodes):
                node.destroy_node()
        finally:
            rclpy.try_shutdown(context=self.context)


@pytest.fixture
def world(domain):
    """Give a ROS world of its own."""
    world = World(domain)
    try:
        yield world
    finally:
        world.close()


class Process:
    """A node in a process of its own."""

    def __init__(self, domain, folder, module, arguments):
        stem = f'{next(_counter)}_{module}'
        self.files = [open(folder / f'{stem}.{end}', 'w') for end in ('out', 'err')]
        self.popen = subprocess.Popen(
            [sys.executable, '-m', 'cam_motion.start', module, '--ros-args',
             *map(str, arguments)],
            cwd=folder, stdin=subprocess.DEVNULL, stdout=self.files[0], stderr=self.files[1],
            env={**os.environ, 'ROS_DOMAIN_ID': str(domain), 'PYTHONPATH': os.pathsep.join(
                filter(None, [str(ROOT), os.environ.get('PYTHONPATH')]))})
        resource.prlimit(self.popen.pid, resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS))

    def signal(self, number):
        """Send a signal."""
        self.popen.send_signal(number)

    def exit_code(self, seconds=PATIENCE):
        """Wait for the end; give the exit code."""
        return self.popen.wait(seconds)

    @property
    def running(self):
        """Tell whether it is still running."""
        return self.popen.poll() is None

    @property
    def said(self):
        """Return what it has written so far, both streams."""
        return ''.join(Path(file.name).read_text(errors='replace') for file in self.files)

    @property
    def complained(self):
        """Return what it has written to its standard error."""
        return Path(self.files[1].name).read_text(errors='replace')

    def close(self):
        """Kill it, if it is still there."""
        if self.running:
            self.signal(signal.SIGKILL)
        self.popen.wait(PATIENCE)
        for file in self.files:
            file.close()


@pytest.fixture
def start(domain, tmp_path):
    """Start nodes as processes: name of the module, then arguments behind --ros-args."""
    processes = []

    def start(module, *arguments):
        processes.append(Process(domain, tmp_path, module, arguments))
        return processes[-1]
    try:
        yield start
    finally:
        for process in processes:
            process.close()


@pytest.fixture(scope='session')
def machine_file():
    """Give the path of the cutting machine's parameter file."""
    return MACHINE
