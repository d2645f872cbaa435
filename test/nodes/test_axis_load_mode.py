# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Drives whose load has parts, as nodes: the states they publish are those of the inverse."""

from math import isnan
from pathlib import Path

from cam_motion.io.config import load_machine, read_sections
from cam_motion.nodes.drive_sim import DriveSim
from cam_motion.nodes.wire import pack_point
from cam_motion.runtime.point import Point
from cam_motion.runtime.shaft_angle import FARTHEST, ShaftAngles
from diagnostic_msgs.msg import DiagnosticStatus
import pytest
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectoryPoint

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

SECOND = 10 ** 9
RATE = 500
PRESS = Path(__file__).resolve().parents[2] / 'config' / 'press_axis.yaml'
ROUNDING = 1e-12
# the loop holds a torque for a period of 0.25 ms, in which the motion goes on
OF_A_PERIOD = 0.01


@pytest.fixture(scope='module')
def machine():
    return load_machine(PRESS)


def points(machine, count, first=0.0):
    """Give points of the shaft and the setpoints that answer them."""
    profile, omega = machine.diagram.axes['press'].profile, machine.master.speed
    for k in range(count):
        stamp = divmod(k * SECOND // RATE, SECOND)
        phi = first + omega * k / RATE
        y, slope, bend, _ = profile.sample(phi)
        yield (Point(phi, omega, 0.0, *stamp),
               Point(y, slope * omega, bend * omega ** 2, *stamp))


def started(world, mode, **options):
    given = {**read_sections(PRESS)['press_drive'], 'mode': mode}
    if mode == 'follow':
        given = {key: value for key, value in given.items() if not key.startswith('loop.')}
    node = world.make(DriveSim, given, **options)
    node.trigger_configure()
    node.trigger_activate()
    assert node.active, [str(problem) for problem in node.problems]
    states = world.listen(JointState, 'drive_sim/drive_state')
    assert world.spin_until(lambda: all(
        p.get_subscription_count() for p in node.publishers if 'drive_state' in p.topic_name))
    return node, states


@pytest.mark.parametrize('mode', ['follow', 'servo'])
def test_the_state_is_that_of_the_inverse_at_the_same_instant(world, machine, mode):
    node, states = started(world, mode, own_process=False)
    given = list(points(machine, 300))
    for shaft, setpoint in given:
        node.note_shaft(shaft)
        node.answer(setpoint)
        world.spin_until(lambda: len(states) >= len(given), 0.0)
    assert world.spin_until(lambda: len(states) == len(given))
    drive = machine.drives['press_drive'].drive
    exact = [drive.follow(*setpoint[:3], shaft.position) for shaft, setpoint in given]
    off = [abs(state.effort[0] - one.motor_torque) for state, one in zip(states, exact)]
    most = max(abs(one.motor_torque) for one in exact)
    if mode == 'follow':
        assert max(off) <= ROUNDING * most
        assert max(abs(state.effort[1] - one.load_torque)
                   for state, one in zip(states, exact)) <= ROUNDING * 200.0
    else:
        # but where friction or the cut begins or ends within the period
        assert sorted(off)[-5] <= OF_A_PERIOD * most
    assert node.health()[0] == DiagnosticStatus.OK


def test_a_drive_in_a_process_of_its_own_hears_the_shaft_by_its_topic(world, machine):
    node, states = started(world, 'follow')
    shaft_topic = world.speaker(JointTrajectoryPoint, 'shaft')
    axis_topic = world.speaker(JointTrajectoryPoint, 'press/setpoint')
    assert world.spin_until(lambda: shaft_topic.get_subscription_count() == 1
                            and axis_topic.get_subscription_count() == 1)
    given = list(points(machine, 60, first=2.6))  # over 160 deg, where the cut begins
    for number, (shaft, setpoint) in enumerate(given, start=1):
        shaft_topic.publish(pack_point(*shaft))
        axis_topic.publish(pack_point(*setpoint))
        assert world.spin_until(lambda: len(states) == number)
    drive = machine.drives['press_drive'].drive
    exact = [drive.follow(*setpoint[:3], shaft.position).motor_torque
             for shaft, setpoint in given]
    assert [state.effort[0] for state in states] == pytest.approx(exact, rel=1e-9)
    assert max(exact) - min(exact) > 5.0


def test_without_a_shaft_what_acts_in_a_window_does_not_act_and_that_is_said(world, machine):
    node, states = started(world, 'follow', own_process=False)
    given = list(points(machine, 120, first=2.9))
    for _, setpoint in given:
        node.answer(setpoint)
        world.spin_until(lambda: len(states) >= len(given), 0.0)
    assert world.spin_until(lambda: len(states) == len(given))
    drive = machine.drives['press_drive'].drive
    assert [state.effort[0] for state in states] == pytest.approx(
        [drive.follow(*setpoint[:3]).motor_torque for _, setpoint in given], rel=1e-9)
    level, values = node.health()
    assert level == DiagnosticStatus.WARN
    assert 'angle of the shaft is not known' in values['reason']


def test_an_angle_is_that_of_the_same_tick_or_carried_on_from_the_nearest():
    angles = ShaftAngles()
    assert isnan(angles.at(0))
    for k in range(3):
        angles.note(Point(5.0 + k, 2.0, 4.0, 0, 10_000_000 * k))
    assert [angles.at(10_000_000 * k) for k in (0, 1, 2)] == [5.0, 6.0, 7.0]
    assert angles.at(25_000_000) == pytest.approx(7.0 + 2.0 * 0.005 + 2.0 * 0.005 ** 2)
    assert angles.at(15_000_000) == pytest.approx(6.0 + 2.0 * 0.005 + 2.0 * 0.005 ** 2)
    assert isnan(angles.at(20_000_000 + round(2.0 * FARTHEST * SECOND)))
    angles.note(Point(1.0, 0.0, 0.0, 0, 0))  # the time base begins anew
    assert angles.at(20_000_000) == 1.0
