# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The axes of a line change their format together at one shaft angle, or none of them does."""

from itertools import pairwise
import json
import math
import signal

from cam_motion.io.axis import build_axis
from cam_motion.io.config import read_sections
from cam_motion.io.format_change import FormatError, plan_format
from cam_motion.io.machine import build_machine
from cam_motion.nodes import staging
from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.format_client import FormatClient
from cam_motion.nodes.parameters import values_of
from cam_motion.nodes.staging import BUSY, own_values
from cam_motion.nodes.wire import pack_point
from cam_motion.runtime.point import Point
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.units import DEGREE, RPM, TURN
import pytest
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter
from std_msgs.msg import Float64
from std_srvs.srv import SetBool
from trajectory_msgs.msg import JointTrajectoryPoint

pytestmark = [pytest.mark.ros, pytest.mark.timeout(240)]

PERIOD_NS = 2_000_000
STEP = 1.02  # what the limits allow from tick to tick, and 2 % for the rounding of differences
BUSY_MACHINE = 20.0  # s: what a shaft may be silent for while other tests keep the machine busy
AXES = ('feeder', 'press', 'knife')


@pytest.fixture(scope='module')
def formats(machine_file):
    """Give the parameters of the axes in the two formats of the cutting machine."""
    return [{axis: sections[axis] for axis in AXES} for sections in map(
        read_sections, (machine_file, machine_file.with_name('cutting_machine_short.yaml')))]


@pytest.fixture
def machine(world, formats):
    """Bring the axes of the cutting machine up, turned by the test tick by tick."""
    return Turned(world, [
        world.make(CamAxis, formats[0][axis], name=axis) for axis in AXES])


class Turned:
    """Axes on a shaft that goes on when all of them have answered."""

    def __init__(self, world, nodes):
        self.world, self.nodes = world, {node.get_name(): node for node in nodes}
        for node in nodes:
            node.trigger_configure()
            node.trigger_activate()
        self.setpoints = {name: world.points(f'{name}/setpoint') for name in self.nodes}
        self.shafts = world.speaker(JointTrajectoryPoint, 'shaft')
        self.orders = world.speaker(Float64, 'format_change')
        assert world.spin_until(lambda: all(
            node._setpoints.get_subscription_count() == 1 for node in nodes)
            and self.shafts.get_subscription_count() == self.orders.get_subscription_count()
            == len(nodes))
        self.shaft = Shaft(60.0 * RPM, RampLimits(30.0, 300.0), RampLimits(150.0, 3000.0))
        self.shaft.run(0.0)
        self.time_ns, self.angles = 0, []

    def turn(self, ticks=1):
        for _ in range(ticks):
            count = len(self.angles) + 1
            state = self.shaft.state(self.time_ns * 1e-9)
            self.angles.append(state.phi)
            self.shafts.publish(pack_point(*Point(*state, *divmod(self.time_ns, 10**9))))
            self.time_ns += PERIOD_NS
            assert self.world.spin_until(
                lambda: all(len(each) >= count for each in self.setpoints.values()))

    def order(self, angle):
        """Ask and tell in one breath; every axis hears both."""
        for _ in range(2):
            self.orders.publish(Float64(data=angle))

    def until(self, condition, most=2500):
        for _ in range(most):
            if condition():
                return
            self.turn()
        raise AssertionError('it did not come to that')

    def put(self, axis, **values):
        parameters = [Parameter(key, value=value).to_parameter_msg()
                      for key, value in values.items()]
        while True:
            result = self.world.call(SetParametersAtomically, f'{axis}/set_parameters_atomically',
                                     parameters=parameters).result
            if result.reason != BUSY:
                return result
            self.turn()

    def stage(self, axis, given, at=270.0, span=90.0):
        return self.put(axis, staged=json.dumps(given), staged_at_deg=at, staged_span_deg=span)

    @property
    def states(self):
        return {node.state_text for node in self.nodes.values()}

    def check_smooth(self):
        for name, points in self.setpoints.items():
            limits = self.nodes[name].axis.limits
            for one, two in pairwise(points):
                h = two.time - one.time
                assert abs(two.position - one.position) <= limits.velocity * h * STEP + 1e-12
                assert abs(two.velocity - one.velocity) <= limits.acceleration * h * STEP + 1e-9


def parameters_of(node):
    return own_values(values_of(node))


def test_all_axes_change_at_the_same_angle_and_their_parameters_tell_the_truth(machine, formats):
    told = {axis: machine.world.listen(Float64, f'{axis}/format_change') for axis in AXES}
    machine.turn(200)
    for axis in AXES:
        result = machine.stage(axis, formats[1][axis])
        assert result.successful, result.reason
    before = {axis: parameters_of(node) for axis, node in machine.nodes.items()}
    start = machine.angles[-1] // TURN * TURN + TURN + 270.0 * DEGREE
    machine.order(start)
    assert machine.world.spin_until(
        lambda: all(each and each[-1].data == start for each in told.values()))
    machine.until(lambda: machine.states != {'in_sync'})
    assert machine.angles[-2] <= start < machine.angles[-1]
    assert machine.states == {'changing'}
    machine.until(lambda: machine.states == {'in_sync'})
    assert machine.angles[-1] == pytest.approx(start + 90.0 * DEGREE, abs=0.03)
    machine.turn(50)
    shaft = machine.shaft.state((machine.time_ns - PERIOD_NS) * 1e-9)
    for axis, node in machine.nodes.items():
        new = build_axis(axis, formats[1][axis])
        y, velocity, acceleration = new.profile.at_speed(*shaft)
        last = machine.setpoints[axis][-1]
        assert last[1:3] == pytest.approx((velocity, acceleration), abs=1e-12)
        if axis != 'feeder':
            assert last.position == pytest.approx(y, abs=1e-12)
        assert {**before[axis], **formats[1][axis]} == parameters_of(node)
        assert node.axis.values == new.values
        assert node.get_parameter('staged').value == ''
        assert math.isnan(told[axis][-1].data)
    machine.check_smooth()


def test_a_format_may_have_other_segments_and_cams(machine, formats):
    machine.turn(100)
    one = {'unit': 'm', 'segments': ['out', 'back'], 'out.law': 'cycloidal', 'out.end_deg': 200.0,
           'out.lift': 0.01, 'back.law': 'cycloidal', 'back.end_deg': 360.0, 'back.lift': -0.01}
    two = {'unit': 'm', 'cams': ['slow', 'fast'], 'active': ['fast'], 'fast.ratio': 2.0, **{
        f'{cam}.{key}': value for cam in ('slow', 'fast') for key, value in one.items()
        if key != 'unit'}}
    node = machine.nodes['press']
    for given in (one, two, formats[0]['press']):
        result = machine.stage('press', given)
        assert result.successful, result.reason
        machine.order(machine.angles[-1] + 1.0)
        machine.until(lambda: node.state_text == 'changing')
        machine.until(lambda: node.state_text == 'in_sync')
        machine.turn(2)
        assert parameters_of(node).items() >= given.items()
        axis = build_axis('press', parameters_of(node))  # nothing of the format before is left
        shaft = machine.shaft.state((machine.time_ns - PERIOD_NS) * 1e-9)
        assert machine.setpoints['press'][-1].position == pytest.approx(
            axis.layout.motion.sample(shaft.phi)[0], abs=1e-12)
        assert machine.put('press', scale=1.0).successful != ('cams' in given)
    machine.check_smooth()


def test_what_an_axis_refuses_it_says_and_nothing_changes(machine, formats):
    machine.turn(100)
    node = machine.nodes['press']
    before, bound = parameters_of(node), node._follower.speed_bound
    wrong = {
        'slow down': {'close.lift': 2.0, 'open.lift': -2.0},
        'does not close|sum': {'open.lift': -0.3}, 'close.law': {'close.law': 'square'},
        'no part of a format': {'unit': 'mm'}, 'no such parameter': {'colour': 'red'}}
    for words, changes in wrong.items():
        result = machine.stage('press', {**formats[1]['press'], **changes})
        assert not result.successful
        assert any(word in result.reason for word in words.split('|')), result.reason
    for text in ('[1, 2]', '{', 'hello'):
        assert 'staged' in machine.put('press', staged=text).reason
    mixed = machine.put('press', staged='', scale=0.5)
    assert not mixed.successful and 'together' in mixed.reason
    machine.order(machine.angles[-1] + 1.0)
    machine.turn(500)
    assert machine.states == {'in_sync'}
    assert (parameters_of(node), node._follower.speed_bound) == (before, bound)
    assert node.get_parameter('staged').value == ''
    machine.check_smooth()


@pytest.mark.parametrize('how', ['engage', 'scale'])
def test_a_format_that_is_only_staged_gives_way_to_what_the_axis_is_told(machine, formats, how):
    """Whoever staged it may be dead; alive, they get no answer, and no axis changes."""
    machine.turn(100)
    assert machine.stage('press', formats[1]['press']).successful
    assert 'another format is staged' in machine.stage('press', formats[0]['press']).reason
    if how == 'scale':
        assert machine.put('press', scale=0.5).successful
    else:
        assert machine.world.call(SetBool, 'press/engage', data=False).success
    node = machine.nodes['press']
    assert machine.world.spin_until(lambda: node.get_parameter('staged').value == '')
    assert node.get_parameter('scale').value == (0.5 if how == 'scale' else 1.0)
    told = machine.world.listen(Float64, 'press/format_change')
    machine.order(machine.angles[-1] + 20.0)
    machine.turn(50)
    assert not any(math.isfinite(each.data) for each in told)


def test_a_format_that_is_never_ordered_lapses(machine, formats, monkeypatch):
    monkeypatch.setattr(staging, '_LAPSES_AFTER', 0.05)
    machine.turn(100)
    assert machine.stage('press', formats[1]['press']).successful
    node = machine.nodes['press']
    assert machine.world.spin_until(lambda: node.get_parameter('staged').value == '')
    assert machine.stage('press', formats[1]['press']).successful


def test_an_axis_that_has_said_it_is_ready_does_nothing_else(machine, formats):
    machine.turn(100)
    assert machine.stage('press', formats[1]['press']).successful
    start = machine.angles[-1] + 20.0
    told = machine.world.listen(Float64, 'press/format_change')
    machine.orders.publish(Float64(data=start))
    assert machine.world.spin_until(lambda: told and told[-1].data == start)
    answer = machine.world.call(SetBool, 'press/engage', data=False)
    assert not answer.success and 'NaN' in answer.message
    assert 'NaN' in machine.put('press', scale=0.5).reason
    machine.orders.publish(Float64(data=math.nan))
    assert machine.world.spin_until(lambda: math.isnan(told[-1].data))
    assert machine.put('press', scale=0.5).successful


def test_revoked_before_the_angle_no_axis_changes(machine, formats):
    machine.turn(100)
    before = {axis: parameters_of(node) for axis, node in machine.nodes.items()}
    told = {axis: machine.world.listen(Float64, f'{axis}/format_change') for axis in AXES}
    for axis in AXES:
        assert machine.stage(axis, formats[1][axis]).successful
    machine.order(machine.angles[-1] + 2.0)
    assert machine.world.spin_until(lambda: all(
        each and math.isfinite(each[-1].data) for each in told.values()))
    assert 'scheduled' in machine.put('press', staged='').reason
    machine.orders.publish(Float64(data=math.nan))
    assert machine.world.spin_until(lambda: all(
        math.isnan(each[-1].data) for each in told.values()))
    machine.turn(600)
    assert machine.states == {'in_sync'}
    assert {axis: parameters_of(node) for axis, node in machine.nodes.items()} == before
    assert all(node.get_parameter('staged').value == '' for node in machine.nodes.values())
    machine.check_smooth()


def test_an_angle_asked_for_and_never_ordered_passes_without_a_change(machine, formats):
    machine.turn(100)
    before = {axis: parameters_of(node) for axis, node in machine.nodes.items()}
    told = {axis: machine.world.listen(Float64, f'{axis}/format_change') for axis in AXES}
    for axis in AXES:
        assert machine.stage(axis, formats[1][axis]).successful
    start = machine.angles[-1] + 2.0
    machine.orders.publish(Float64(data=start))
    assert machine.world.spin_until(lambda: all(
        each and each[-1].data == start for each in told.values()))
    machine.turn(600)
    assert machine.angles[-1] > start + 1.0 and machine.states == {'in_sync'}
    assert machine.put('press', staged='').successful
    assert machine.world.spin_until(lambda: math.isnan(told['press'][-1].data))
    machine.orders.publish(Float64(data=start + 20.0))  # another angle is another question
    assert machine.world.spin_until(lambda: all(
        told[axis][-1].data == start + 20.0 for axis in AXES if axis != 'press'))
    machine.turn(100)
    assert machine.states == {'in_sync'} and math.isnan(told['press'][-1].data)
    machine.orders.publish(Float64(data=math.nan))
    assert machine.world.spin_until(lambda: all(
        math.isnan(each[-1].data) for each in told.values()))
    assert {axis: parameters_of(node) for axis, node in machine.nodes.items()} == before
    machine.check_smooth()


# Across processes, by the one who asks them all

@pytest.fixture
def line(world, start, machine_file, monkeypatch):
    """Start the axes of the cutting machine, each in a process, and a shaft in another one."""
    monkeypatch.setenv('ROS_DOMAIN_ID', str(world.domain))
    processes = {axis: start('cam_axis', '-r', f'__node:={axis}', '--params-file', machine_file,
                             '-p', f'master_timeout:={BUSY_MACHINE}')
                 for axis in AXES}
    start('master_shaft', '--params-file', machine_file, '-p', 'rate_hz:=200.0', '-p',
          'speed_cpm:=60.0')
    points = {name: world.points(f'{name}/setpoint') for name in AXES} | {
        'shaft': world.points('shaft')}
    states = {axis: world.states(axis) for axis in AXES}
    assert world.spin_until(lambda: all(points.values()) and all(
        each and each[-1] == 'in_sync' for each in states.values()), 90.0)
    return points, states, processes


def planned(client, machine_file):
    sections = read_sections(machine_file.with_name('cutting_machine_short.yaml'))
    sections |= {axis: {**sections[axis], 'master_timeout': BUSY_MACHINE} for axis in AXES}
    running = {axis: client.parameters(axis) for axis in client.find(list(AXES))}
    return plan_format(build_machine(sections), sections, running, 60.0 * RPM)


def angles_of(points, axis):
    angle = {(point.sec, point.nanosec): point.position for point in points['shaft']}
    return [(angle[p.sec, p.nanosec], p) for p in points[axis] if (p.sec, p.nanosec) in angle]


def check_unchanged(points, states, given, axes):
    for axis in axes:
        assert states[axis][-1] == 'in_sync' and 'changing' not in states[axis]
        profile = build_axis(axis, given[axis]).profile
        for phi, point in angles_of(points, axis):
            assert point.position == pytest.approx(profile(phi), abs=1e-12)


def test_processes_change_together_from_one_shaft_angle_on(world, line, machine_file, formats):
    points, states, _ = line
    with FormatClient() as client:
        plan = planned(client, machine_file)
        assert set(plan.axes) == set(AXES)
        client.stage(plan)
        begin = client.take_over(plan)
        assert client.wait(plan, begin)
        assert not planned(client, machine_file).axes
        for axis in AXES:
            assert client.parameters(axis).items() >= formats[1][axis].items()
    assert world.spin_until(lambda: all(each[-2:] == ['changing', 'in_sync']
                                        for each in states.values()))
    old, new = ({axis: build_axis(axis, each[axis]) for axis in AXES} for each in formats)
    for axis in AXES:
        rows = angles_of(points, axis)
        assert rows[0][0] < begin and rows[-1][0] > begin + plan.span
        offset = 0.0
        for phi, point in rows:
            if phi <= begin:
                assert point.position == pytest.approx(old[axis].profile(phi), abs=1e-12)
            elif phi >= begin + plan.span:
                exact = new[axis].profile(phi)
                offset = offset or (point.position - exact if axis == 'feeder' else 0.0)
                assert point.position == pytest.approx(exact + offset, abs=1e-9)
        for (_, one), (_, two) in pairwise(rows):
            h = two.time - one.time
            assert abs(two.position - one.position) <= new[axis].limits.velocity * h * STEP


def test_one_process_that_refuses_keeps_all_from_changing(world, line, machine_file, formats):
    points, states, _ = line
    with FormatClient() as client:
        plan = planned(client, machine_file)
        # what the knife alone cannot do, unseen by whoever asks
        bad = {**plan.axes['knife'].given, 'limits.acceleration': 0.1}
        plan.axes['knife'] = plan.axes['knife'].__class__(bad, {}, plan.axes['knife'].plan)
        with pytest.raises(FormatError, match='nothing has changed: knife: .*slow down'):
            client.stage(plan)
        world.spin_for(1.5)
        assert world.call(SetParametersAtomically, 'press/set_parameters_atomically', parameters=[
            Parameter('scale', value=1.0).to_parameter_msg()]).result.successful  # none is staged
        for axis in AXES:
            assert client.parameters(axis).items() >= formats[0][axis].items()
    check_unchanged(points, states, formats[0], AXES)


def test_one_who_asks_and_dies_leaves_all_as_they_were(world, line, machine_file, formats):
    points, states, _ = line
    with FormatClient() as client:
        plan = planned(client, machine_file)
        client.stage(plan)
        start = plan.start(client.shaft().position, plan.speed)
        client._orders.publish(Float64(data=start))
        assert client._until(lambda: not client._silent(plan, start), 20.0)
    assert world.spin_until(lambda: points['shaft'][-1].position > start + plan.span, 60.0)
    check_unchanged(points, states, formats[0], AXES)


def test_an_axis_that_hangs_after_it_has_agreed_keeps_the_others_from_changing(
        world, line, machine_file, formats):
    points, states, processes = line
    others = [axis for axis in AXES if axis != 'knife']
    with FormatClient() as client:
        plan = planned(client, machine_file)
        client.stage(plan)
        processes['knife'].signal(signal.SIGSTOP)
        with pytest.raises(FormatError, match='knife did not answer in time'):
            client.take_over(plan)
        client.revoke(plan)
        world.spin_for(1.0)
        for axis in others:
            assert client.parameters(axis).items() >= formats[0][axis].items()
    check_unchanged(points, states, formats[0], others)
