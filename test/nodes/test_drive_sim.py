# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The feeding group of document 001 as a node: torque and speed of its motor and its load."""

from itertools import pairwise
import math

from cam_motion.io.axis import build_axis
from cam_motion.nodes.drive_sim import DriveSim
from cam_motion.nodes.wire import pack_point
from cam_motion.runtime.point import Point
from cam_motion.units import RPM
import pytest
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectoryPoint

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

# Document 001: 300 mm in 80 degrees at 200 cycles/min; J = 1.164 kg m², 500 N on 134 mm rollers.
RADIUS, RATIO, INERTIA, FORCE = 0.134, 2.0, 1.164, 500.0
GROUP = {'axis': 'feeder', 'radius': RADIUS, 'gear_ratio': RATIO, 'load_inertia': INERTIA,
         'resistance_force': FORCE}
FEEDER = {
    'cycle': 'accumulate', 'segments': ['feed', 'wait'], 'feed.law': 'constant_acceleration',
    'feed.end_deg': 80.0, 'feed.lift': 0.3, 'wait.end_deg': 360.0,
}
OMEGA = 200.0 * RPM
PRINTED = 0.01  # the document's figures are rounded to two or three digits
ROUNDING = 1e-12


def heard(node):
    """Tell whether somebody receives the states of a drive."""
    states, = (p for p in node.publishers if p.topic_name.endswith('/drive_state'))
    return states.get_subscription_count() == 1


@pytest.fixture
def follow(world):
    """Send setpoints to a drive; give its answers."""
    def follow(setpoints, **changes):
        node = world.make(DriveSim, {**GROUP, **changes})
        node.trigger_configure()
        node.trigger_activate()
        assert node.active
        states = world.listen(JointState, 'drive_sim/drive_state')
        publisher = world.speaker(JointTrajectoryPoint, 'feeder/setpoint')
        assert world.spin_until(lambda: heard(node))
        for number, setpoint in enumerate(setpoints, start=1):
            publisher.publish(pack_point(*setpoint))
            assert world.spin_until(lambda: len(states) == number)
        assert {tuple(state.name) for state in states} == {('motor', 'load')}
        return states
    return follow


def cycle(count, period_ns=2_000_000):
    """Give setpoints of the feeder, from the begin of its movement, at constant speed."""
    profile = build_axis('feeder', FEEDER).profile
    for k in range(count):
        y, slope, bend, _ = profile.sample(OMEGA * k * period_ns * 1e-9)
        yield Point(y, slope * OMEGA, bend * OMEGA * OMEGA, *divmod(k * period_ns, 10**9))


def setpoint(velocity, acceleration=0.0, position=0.0):
    """Make a setpoint."""
    return Point(position, velocity, acceleration, 0, 0)


def test_the_figures_of_the_feeding_group_are_those_of_the_document(follow):
    states = follow(cycle(150, 500_000))
    load_torque = max(state.effort[1] for state in states)
    # 9 m/s and 270 m/s² on the belt
    assert max(state.velocity[1] for state in states) * RADIUS == pytest.approx(9.0, rel=PRINTED)
    assert load_torque == pytest.approx(INERTIA * 270.0 / RADIUS + 67.0, rel=PRINTED)
    # tau = 1/2: the motor turns twice as fast and needs half the torque
    assert max(state.velocity[0] for state in states) == pytest.approx(
        2.0 * 9.0 / RADIUS, rel=PRINTED)
    assert max(state.effort[0] for state in states) == pytest.approx(
        0.5 * load_torque, rel=ROUNDING)


def test_motor_and_load_balance_in_power(follow):
    for state in follow(cycle(100)):
        motor, load = (state.effort[k] * state.velocity[k] for k in (0, 1))
        assert motor == pytest.approx(load, rel=ROUNDING, abs=1e-9)
        assert state.position[0] == pytest.approx(RATIO * state.position[1], rel=ROUNDING)
        assert state.velocity[0] == pytest.approx(RATIO * state.velocity[1], rel=ROUNDING)


def test_the_stamps_are_uniform_and_begin_now(follow, world):
    states = follow(cycle(120))
    stamps = [each.header.stamp.sec * 10**9 + each.header.stamp.nanosec for each in states]
    assert {b - a for a, b in pairwise(stamps)} == {2_000_000}
    now = world.probe.get_clock().now().nanoseconds
    assert 0 <= now - stamps[0] < 60 * 10**9


def test_the_inertia_of_the_motor_is_added_on_its_own_shaft(follow):
    plain, = follow([setpoint(1.0, 10.0)])
    assert plain.effort[0] == pytest.approx(
        (INERTIA * 10.0 / RADIUS + 67.0) / RATIO, rel=ROUNDING)


def test_the_inertia_of_the_motor_feels_the_acceleration_of_the_motor(follow):
    heavy, = follow([setpoint(1.0, 10.0)], motor_inertia=0.05)
    through = (INERTIA * 10.0 / RADIUS + 67.0) / RATIO
    assert heavy.effort[0] == pytest.approx(
        through + 0.05 * RATIO * 10.0 / RADIUS, rel=ROUNDING)
    assert heavy.effort[1] == pytest.approx(INERTIA * 10.0 / RADIUS + 67.0, rel=ROUNDING)


def test_losses_follow_the_flow_of_power(follow):
    driving, braking, backward = follow(
        [setpoint(1.0, 10.0), setpoint(1.0, -100.0), setpoint(-1.0, -10.0)], efficiency=0.8)
    load = INERTIA * 10.0 / RADIUS + 67.0
    assert driving.effort[0] == pytest.approx(load / RATIO / 0.8, rel=ROUNDING)
    back = 67.0 - INERTIA * 100.0 / RADIUS
    assert back < 0.0
    assert braking.effort[0] == pytest.approx(back / RATIO * 0.8, rel=ROUNDING)
    # backward is the mirror image: power flows to the load again
    assert backward.effort[0] == pytest.approx(-load / RATIO / 0.8, rel=ROUNDING)
    for state in (driving, braking, backward):
        lost = state.effort[0] * state.velocity[0] - state.effort[1] * state.velocity[1]
        assert lost > 0.0


@pytest.mark.parametrize('resistance, torques', [
    ('in_motion', (67.0, 0.0, -67.0)), ('always', (67.0, 67.0, 67.0))])
def test_the_resistance_acts_in_motion_only_or_always(follow, resistance, torques):
    states = follow([setpoint(v) for v in (2.0, 0.0, -2.0)], resistance=resistance)
    assert [state.effort[1] for state in states] == pytest.approx(torques, rel=ROUNDING)
    assert [state.effort[0] for state in states] == pytest.approx(
        [torque / RATIO for torque in torques], rel=ROUNDING)


def test_setpoints_that_are_none_are_counted_and_left_out(world):
    node = world.make(DriveSim, GROUP)
    node.trigger_configure()
    node.trigger_activate()
    states = world.listen(JointState, 'drive_sim/drive_state')
    publisher = world.speaker(JointTrajectoryPoint, 'feeder/setpoint')
    assert world.spin_until(lambda: heard(node))
    publisher.publish(JointTrajectoryPoint(positions=[1.0, 2.0]))
    publisher.publish(JointTrajectoryPoint(
        positions=[math.nan], velocities=[1.0], accelerations=[1.0]))
    assert world.spin_until(lambda: node._mode.refused == 2)
    publisher.publish(pack_point(*setpoint(1.0)))
    assert world.spin_until(lambda: len(states) == 1)
    assert node.state_text == 'following'


def test_a_drive_follows_the_axis_of_its_own_namespace(world):
    node = world.make(DriveSim, GROUP, namespace='l1')
    node.trigger_configure()
    assert node.hardware_id == 'feeder'
    node.trigger_activate()
    states = world.listen(JointState, 'l1/drive_sim/drive_state')
    publisher = world.speaker(JointTrajectoryPoint, 'l1/feeder/setpoint')
    assert world.spin_until(lambda: heard(node))
    publisher.publish(pack_point(*setpoint(1.0)))
    assert world.spin_until(lambda: len(states) == 1)
