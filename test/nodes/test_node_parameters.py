# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Parameters of the nodes: what they teach, what they accept, what they refuse and why."""

import math

from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.drive_sim import DriveSim
from cam_motion.nodes.master_shaft import MasterShaft
from cam_motion.units import RPM
import pytest
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType, ParameterValue
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.exceptions import ParameterAlreadyDeclaredException
from rclpy.parameter import Parameter

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

FEEDER = {
    'cycle': 'accumulate', 'segments': ['feed', 'wait'], 'feed.law': 'cycloidal',
    'feed.end_deg': 80.0, 'feed.lift': 0.3, 'wait.end_deg': 360.0,
}
DOUBLE = ParameterType.PARAMETER_DOUBLE


def set_parameter(world, node, name, value, kind=DOUBLE):
    """Set a parameter as `ros2 param set` does."""
    field = {DOUBLE: 'double_value', ParameterType.PARAMETER_INTEGER: 'integer_value',
             ParameterType.PARAMETER_STRING: 'string_value'}.get(kind)
    given = ParameterValue(type=kind, **({field: value} if field else {}))
    return world.call(SetParameters, f'{node}/set_parameters', parameters=[
        ParameterMessage(name=name, value=given)]).results[0]


def activated(world, node):
    """Bring a node up."""
    node.trigger_configure()
    node.trigger_activate()
    assert node.active
    return node


def describe(world, node, name):
    """Describe a parameter as `ros2 param describe` does."""
    answer = world.call(DescribeParameters, f'{node}/describe_parameters', names=[name])
    return answer.descriptors[0]


def test_every_parameter_is_described_with_its_unit_and_rule(world):
    for factory in (MasterShaft, CamAxis, DriveSim):
        node = world.make(factory)
        name = node.get_name()
        declared = [spec for spec in node.table if node.has_parameter(spec.name)]
        assert len(declared) >= 5
        answer = world.call(DescribeParameters, f'{name}/describe_parameters',
                            names=[spec.name for spec in declared])
        for spec, descriptor in zip(declared, answer.descriptors):
            assert spec.meaning in descriptor.description
            assert spec.unit in descriptor.description
            assert descriptor.additional_constraints == spec.rule


def test_a_descriptor_carries_the_range(world):
    world.make(MasterShaft)
    rate = describe(world, 'master_shaft', 'rate_hz')
    assert 'Hz' in rate.description
    assert 'at least 1 and at most 5000' in rate.additional_constraints
    assert (rate.floating_point_range[0].from_value,
            rate.floating_point_range[0].to_value) == (1.0, 5000.0)
    assert describe(world, 'master_shaft', 'speed_cpm').floating_point_range == []


def test_whole_numbers_are_accepted_where_a_double_is_meant(world):
    node = activated(world, world.make(
        MasterShaft, {'speed_cpm': 120, 'rate_hz': 250, 'start_delay': 0}))
    answer = world.call(GetParameters, 'master_shaft/get_parameters',
                        names=['speed_cpm', 'rate_hz'])
    assert [value.type for value in answer.values] == [DOUBLE, DOUBLE]
    assert [value.double_value for value in answer.values] == [120.0, 250.0]
    assert node._shaft.speed == 120.0 * RPM
    axis = world.make(CamAxis, {**FEEDER, 'feed.end_deg': 80, 'wait.end_deg': 360, 'feed.lift': 1})
    activated(world, axis)


@pytest.mark.parametrize('given, path, rule', [
    ({'speed_cmp': 100.0}, 'speed_cmp', 'did you mean speed_cpm?'),
    ({'rate_hz': 0.5}, 'rate_hz', 'at least 1'),
    ({'rate_hz': 'fast'}, 'rate_hz', 'must be a finite number'),
    ({'speed_cpm': math.nan}, 'speed_cpm', 'must be a finite number'),
    ({'jerk': math.inf}, 'jerk', 'must be a finite number'),
    ({'acceleration': 0.0}, 'acceleration', 'above 0'),
    ({'run_at_start': 1}, 'run_at_start', 'true or false'),
])
def test_a_parameter_that_cannot_be_used_is_refused_with_its_rule(world, given, path, rule):
    node = world.make(MasterShaft, given)
    node.trigger_configure()
    assert world.state('master_shaft') == 'unconfigured'
    assert [problem.path for problem in node.problems] == [path]
    assert rule in str(node.problems[0])


def test_all_problems_are_found_at_once(world):
    wrong = {'speed_cmp': 1.0, 'rate_hz': -1.0, 'jerk': 0.0, 'autostart': 'yes'}
    node = world.make(MasterShaft, wrong)
    node.trigger_configure()
    assert {problem.path for problem in node.problems} == set(wrong)


def test_a_structural_change_is_refused_while_configured(world):
    axis = activated(world, world.make(CamAxis, FEEDER))
    result = set_parameter(world, 'cam_axis', 'feed.lift', 0.4)
    assert not result.successful
    assert 'feed.lift' in result.reason and 'unconfigured' in result.reason
    assert axis.get_parameter('feed.lift').value == 0.3
    assert world.state('cam_axis') == 'active'
    axis.trigger_deactivate()
    axis.trigger_cleanup()
    assert set_parameter(world, 'cam_axis', 'feed.lift', 0.4).successful
    axis.trigger_configure()
    assert axis.axis.profile.advance == pytest.approx(0.4, rel=1e-12)


def test_a_change_is_checked_while_unconfigured(world):
    world.make(DriveSim, {'axis': 'feeder'})
    result = set_parameter(world, 'drive_sim', 'efficiency', 1.5)
    assert not result.successful and 'efficiency' in result.reason
    result = set_parameter(world, 'drive_sim', 'load_inertia', math.nan)
    assert not result.successful
    assert set_parameter(world, 'drive_sim', 'efficiency', 0.5).successful


@pytest.mark.parametrize('value', [math.nan, math.inf, -math.inf])
def test_a_set_speed_that_is_not_finite_is_refused(world, value):
    node = activated(world, world.make(MasterShaft, {'speed_cpm': 30.0}))
    result = set_parameter(world, 'master_shaft', 'speed_cpm', value)
    assert not result.successful and result.reason
    assert node.get_parameter('speed_cpm').value == 30.0
    assert node._shaft.speed == 30.0 * RPM


def test_the_set_speed_changes_while_the_shaft_turns(world):
    node = activated(world, world.make(MasterShaft, {'speed_cpm': 30.0, 'start_delay': 0.0}))
    points = world.points('shaft')
    assert world.spin_until(lambda: points and points[-1].velocity == 30.0 * RPM)
    assert set_parameter(world, 'master_shaft', 'speed_cpm', -45.0).successful
    assert node.get_parameter('speed_cpm').value == -45.0
    assert world.spin_until(lambda: points[-1].velocity == -45.0 * RPM)


@pytest.mark.parametrize('name, value, kind', [
    ('speed_cpm', None, ParameterType.PARAMETER_NOT_SET),
    ('speed_cpm', 3, ParameterType.PARAMETER_INTEGER),
    ('speed_cpm', 'fast', ParameterType.PARAMETER_STRING),
    ('feed.lift', 1.0, DOUBLE),
])
def test_a_senseless_change_ends_nothing(world, name, value, kind):
    node = activated(world, world.make(MasterShaft, {'speed_cpm': 30.0, 'start_delay': 0.0}))
    result = set_parameter(world, 'master_shaft', name, value, kind)
    assert not result.successful and result.reason
    assert node.get_parameter('speed_cpm').value == 30.0
    assert world.state('master_shaft') == 'active'


def test_a_segment_can_be_added_while_unconfigured(world):
    axis = world.make(CamAxis, FEEDER)
    names = world.call(ListParameters, 'cam_axis/list_parameters').result.names
    assert {'feed.law', 'wait.end_deg', 'stop_acceleration'} <= set(names)
    with pytest.raises(ParameterAlreadyDeclaredException):
        axis.declare_parameter('feed.law', 'dwell')
    axis.declare_parameter('rest.end_deg', 360.0)
    changes = [Parameter('segments', value=['feed', 'wait', 'rest']),
               Parameter('wait.end_deg', value=200.0)]
    assert all(result.successful for result in axis.set_parameters(changes))
    activated(world, axis)
    assert [segment.name for segment in axis.axis.profile.segments] == ['feed', 'wait', 'rest']
