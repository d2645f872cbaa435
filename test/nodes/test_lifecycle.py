# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The life of a node through its lifecycle services: it says what fails, and outlives mistakes."""

import os
import subprocess
import sys

from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.drive_sim import DriveSim
from cam_motion.nodes.line import make_line
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.master_shaft import MasterShaft
from cam_motion.nodes.runner import _spin
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
import pytest
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.parameter import Parameter

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

FEEDER = {
    'cycle': 'accumulate', 'segments': ['feed', 'wait'], 'feed.law': 'cycloidal',
    'feed.end_deg': 80.0, 'feed.lift': 0.3, 'wait.end_deg': 360.0,
}
BROKEN = {**FEEDER, 'feed.law': 'cycloydal', 'wait.end_deg': 350.0, 'cyle': 'return'}


def entities(node):
    """Count what a node holds: publishers, subscriptions, services, timers and managed ones."""
    return [len(list(each)) for each in (
        node.publishers, node.subscriptions, node.services, node.timers, node._managed_entities)]


def errors_of(node, monkeypatch):
    """Collect the errors that a node logs."""
    lines = []
    logger = node.get_logger()
    monkeypatch.setattr(logger, 'error', lambda text, **_: lines.append(text))
    return lines


def test_every_transition_is_carried_out_and_tells_its_state(world):
    world.make(CamAxis, FEEDER, namespace='axis')
    states = world.states('axis/cam_axis')
    walk = [('configure', 'inactive'), ('activate', 'active'), ('deactivate', 'inactive'),
            ('activate', 'active'), ('deactivate', 'inactive'), ('cleanup', 'unconfigured'),
            ('configure', 'inactive'), ('inactive_shutdown', 'finalized')]
    assert world.state('axis/cam_axis') == 'unconfigured'
    for label, reached in walk:
        assert world.change('axis/cam_axis', label)
        assert world.state('axis/cam_axis') == reached
    assert world.spin_until(lambda: states and states[-1] == 'finalized')
    # a late joiner may miss what came before it
    expected = ['unconfigured', 'inactive', 'waiting', 'inactive', 'waiting', 'inactive',
                'unconfigured', 'inactive', 'finalized']
    assert expected[-len(states):] == states


@pytest.mark.parametrize('label', ['unconfigured_shutdown', 'active_shutdown'])
def test_a_node_shuts_down_from_either_end(world, label):
    node = world.make(MasterShaft)
    if label == 'active_shutdown':
        assert world.change('master_shaft', 'configure')
        assert world.change('master_shaft', 'activate')
    assert world.change('master_shaft', label)
    assert world.state('master_shaft') == 'finalized'
    assert (node.active, node.state_text) == (False, 'finalized')


def test_a_bad_configuration_is_said_in_full_and_can_be_mended(world, monkeypatch):
    node = world.make(CamAxis, BROKEN, namespace='axis')
    errors = errors_of(node, monkeypatch)
    before = entities(node)
    assert not world.change('axis/cam_axis', 'configure')
    assert world.state('axis/cam_axis') == 'unconfigured'
    assert {p.path for p in node.problems} == {'feed.law', 'wait.end_deg', 'cyle'}
    assert len(errors) == len(node.problems)
    for path, hint in (('feed.law', 'cycloidal'), ('wait.end_deg', '360'), ('cyle', 'cycle')):
        assert any(f'cam_axis.{path}' in line and hint in line for line in errors), path
    assert entities(node) == before
    node.undeclare_parameter('cyle')
    results = node.set_parameters(
        [Parameter('feed.law', value='cycloidal'), Parameter('wait.end_deg', value=360.0)])
    assert all(result.successful for result in results)
    assert world.change('axis/cam_axis', 'configure')
    assert node.problems == ()
    assert world.change('axis/cam_axis', 'activate')
    assert world.state('axis/cam_axis') == 'active'


class Faulty(ManagedNode):
    """A node with a bug in one of its transitions."""

    faulty = 'configure'

    def configure(self, values):
        """Fail, if so told."""
        self._fail('configure')

    def activate(self):
        """Fail, if so told."""
        self._fail('activate')

    def deactivate(self):
        """Fail, if so told."""
        self._fail('deactivate')

    def _fail(self, where):
        if self.faulty == where:
            raise ZeroDivisionError(f'in {where}')


@pytest.mark.parametrize('where', ['configure', 'activate', 'deactivate'])
def test_a_bug_in_a_transition_is_logged_and_marks_the_node_as_failed(world, monkeypatch, where):
    node = world.make(lambda **given: Faulty('faulty', **given))
    node.faulty = where
    errors = errors_of(node, monkeypatch)
    for label in ('configure', 'activate', 'deactivate'):
        assert world.change('faulty', label) is (label != where)
        if label == where:
            break
    assert world.state('faulty') == 'unconfigured'
    assert node.failed and not node.active
    assert f'ZeroDivisionError: in {where}' in '\n'.join(errors)
    node.faulty = ''
    assert world.change('faulty', 'configure')


def test_a_transition_that_is_not_allowed_ends_nothing(world, monkeypatch):
    node = world.make(MasterShaft)
    errors = errors_of(node, monkeypatch)
    client = world.probe.create_client(ChangeState, 'master_shaft/change_state')
    assert world.spin_until(client.service_is_ready)
    client.call_async(ChangeState.Request(
        transition=Transition(id=Transition.TRANSITION_ACTIVATE)))
    patience = iter(range(300))  # turns of at most 0.1 s
    _spin(world.executor, lambda: errors or next(patience, None) is None, [node])
    assert len(errors) == 1 and 'transition' in errors[0].lower()
    assert world.state('master_shaft') == 'unconfigured'
    assert world.change('master_shaft', 'configure')
    assert world.state('master_shaft') == 'inactive'


@pytest.mark.parametrize('factory, given', [
    (MasterShaft, {}), (CamAxis, FEEDER), (DriveSim, {'axis': 'feeder'})])
def test_nothing_is_left_behind_by_configuring_again_and_again(world, factory, given):
    node = world.make(factory, given)
    before = entities(node)
    held = []
    for _ in range(4):
        assert node.trigger_configure() is TransitionCallbackReturn.SUCCESS
        assert node.trigger_activate() is TransitionCallbackReturn.SUCCESS
        world.spin_for(0.05)
        held.append(entities(node))
        assert node.trigger_deactivate() is TransitionCallbackReturn.SUCCESS
        assert node.trigger_cleanup() is TransitionCallbackReturn.SUCCESS
        assert entities(node) == before
    assert held == held[:1] * 4


def test_nothing_is_left_behind_by_a_configuration_that_breaks_half_way(world, monkeypatch):
    node = world.make(MasterShaft)
    before = entities(node)

    def break_down(*_, **__):
        raise RuntimeError('no service today')
    with monkeypatch.context() as patch:
        patch.setattr(node, 'create_service', break_down)
        assert node.trigger_configure() is TransitionCallbackReturn.ERROR
    assert node.failed
    assert entities(node) == before


def test_a_line_without_autostart_waits_for_each_of_its_nodes(world, machine_file):
    nodes = make_line(context=world.context, parameter_overrides=[
        Parameter('autostart', value=False)],
        cli_args=['--ros-args', '--params-file', str(machine_file)])
    for node in nodes:
        world.add(node)
        assert node.get_parameter('autostart').value is False
    for node in reversed(nodes):
        assert world.change(node.get_name(), 'configure')
        assert world.change(node.get_name(), 'activate')
    ticks = world.points('shaft')
    assert world.spin_until(lambda: len(ticks) > 10)


def test_nothing_is_imported_or_looked_for_by_the_first_command(domain):
    """What a first command, and its line in the log, would import is there before the shaft."""
    code = (
        'import inspect, sys; sys.argv[1:] = []\n'
        'import rclpy; from rclpy.parameter import Parameter\n'
        'from cam_motion.nodes.cam_axis import CamAxis\n'
        'rclpy.init()\n'
        f'given = {FEEDER!r}\n'
        'node = CamAxis(parameter_overrides=[Parameter(n, value=v) for n, v in given.items()])\n'
        'node.trigger_configure(); node.trigger_activate()\n'
        'node._follower.answer(1.0, 5.0, 0.0)\n'
        'modules = set(sys.modules); known = len(inspect.modulesbyfile)\n'
        'node._follower.disengage(); node.get_logger().info("told")\n'
        'more = set(sys.modules) - modules\n'
        'assert not more, more\n'
        'assert 100 < known <= len(inspect.modulesbyfile) < known + 50\n'
        'node.destroy_node(); rclpy.shutdown()\n')
    done = subprocess.run(
        [sys.executable, '-c', code], capture_output=True, text=True, timeout=60, check=False,
        env={**os.environ, 'ROS_DOMAIN_ID': str(domain)})
    assert done.returncode == 0, done.stderr
