# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Real processes asked to stop: they come to rest on their curves, hold there, and exit with 0."""

from itertools import pairwise
import math
import signal

from cam_motion.io.config import load_machine
from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.runner import bring_to_rest
from cam_motion.runtime.point import Point
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft_motion import ShaftMotion, ShaftState
import numpy as np
import pytest
from trajectory_msgs.msg import JointTrajectoryPoint

pytestmark = [pytest.mark.ros, pytest.mark.slow, pytest.mark.timeout(180)]

AXES = ('feeder', 'press', 'knife')
START = 60.0  # s; until a process that has just been started is heard
ROUNDING = 1e-9
STOP = RampLimits(150.0, 3000.0)  # of an axis that stops while the shaft goes on
# An axis that never dwells, so that a setpoint tells the angle it was made for.
BELT = """
belt:
  ros__parameters:
    cycle: accumulate
    segments: [go]
    go: {law: cycloidal, end_deg: 360.0, lift: 1.0}
master_shaft: {ros__parameters: {speed_cpm: 90.0, rate_hz: 100.0}}
"""


def exact(profile, shaft):
    """Give the setpoint that answers a shaft point."""
    y, slope, bend, _ = profile.sample(shaft[0])
    return y, slope * shaft[1], bend * shaft[1] * shaft[1] + slope * shaft[2]


@pytest.mark.parametrize('number, namespace', [(signal.SIGINT, ''), (signal.SIGTERM, '/l1')])
def test_a_line_ramps_down_and_holds_however_often_it_is_told(
        world, start, machine_file, number, namespace):
    arguments = ['-r', f'__ns:={namespace}'] if namespace else []
    shaft = world.points(f'{namespace}/shaft')
    setpoints = {axis: world.points(f'{namespace}/{axis}/setpoint') for axis in AXES}
    states = world.states(f'{namespace}/master_shaft')
    line = start('line', '--params-file', machine_file, *arguments)
    assert world.spin_until(lambda: shaft and shaft[-1].velocity > 15.0, START), line.said
    assert world.spin_until(lambda: all(setpoints.values()))
    line.signal(number)
    assert world.spin_until(lambda: shaft[-1].acceleration < 0.0)
    for another in (number, signal.SIGINT, signal.SIGTERM):
        line.signal(another)
    assert world.spin_until(lambda: not line.running)
    assert line.exit_code() == 0, line.said
    assert 'Traceback' not in line.said
    world.spin_until(lambda: states[-1:] == ['inactive'], 2.0)
    # what it said last may still be on its way
    world.spin_until(lambda: all(points[-1] == points[-2] for points in setpoints.values()), 2.0)
    assert shaft[-1][1:3] == (0.0, 0.0)
    for one, two in pairwise(shaft):
        h = two.time - one.time
        assert abs(two.velocity - one.velocity) <= 30.0 * h + ROUNDING
    machine = load_machine(machine_file)
    at = {point[3:]: point for point in shaft}
    for axis, points in setpoints.items():
        profile = machine.diagram.axes[axis].profile
        assert points[-1] == points[-2]  # the answer to the last tick, and the hold
        assert points[-1][1:3] == (0.0, 0.0)
        assert points[-1][3:] == shaft[-1][3:]
        assert all(point[:3] == exact(profile, at[point[3:]]) for point in points
                   if point[3:] in at)


def test_an_axis_told_to_stop_alone_stops_on_its_own_curve(world, start, tmp_path):
    path = tmp_path / 'belt.yaml'
    path.write_text(BELT)
    shaft, setpoints = world.points('shaft'), world.points('belt/setpoint')
    states = world.states('belt')
    master = start('master_shaft', '--params-file', path)
    axis = start('cam_axis', '--params-file', path, '-r', '__node:=belt')
    assert world.spin_until(
        lambda: shaft and setpoints and shaft[-1][1:3] == (3.0 * math.pi, 0.0), START), (
            master.said + axis.said)
    assert world.spin_until(lambda: setpoints[-1].velocity > 0.5)
    axis.signal(signal.SIGINT)
    assert world.spin_until(lambda: not axis.running)
    assert axis.exit_code() == 0, axis.said
    assert world.spin_until(lambda: len(setpoints) > 1 and setpoints[-1] == setpoints[-2])
    assert 'stopping_on_curve' in states
    # the master went on meanwhile, and goes on
    assert master.running
    count = len(shaft)
    assert world.spin_until(lambda: len(shaft) > count + 20)
    assert shaft[-1].velocity == 3.0 * math.pi
    check_stop_on_curve(load_belt(path), shaft, setpoints)
    master.signal(signal.SIGTERM)
    assert world.spin_until(lambda: not master.running)
    assert master.exit_code() == 0, master.said
    assert world.spin_until(lambda: shaft[-1][1:3] == (0.0, 0.0))


def load_belt(path):
    """Give the profile of the belt."""
    return load_machine(path).diagram.axes['belt'].profile


def check_stop_on_curve(profile, shaft, setpoints):
    """Check that setpoints follow the shaft, then a shaft of their own that ramps down."""
    at = {point[3:]: point for point in shaft}
    known = [s for s in setpoints if s[3:] in at]
    followed = [s for s in known if s[:3] == exact(profile, at[s[3:]])]
    own = setpoints[setpoints.index(followed[-1]) + 1:-1]
    assert len(own) > 5
    last = at[followed[-1][3:]]
    motion = ShaftMotion(last.time, ShaftState(*last[:3])).ramped(last.time, 0.0, STOP)
    for setpoint in own:
        expected = exact(profile, motion.state(setpoint.time))
        for value, right, scale in zip(setpoint[:3], expected, (1.0, 5.0, 100.0)):
            assert abs(value - right) <= ROUNDING * scale
    assert own[-1][1:3] == (0.0, 0.0) and setpoints[-1] == own[-1]
    angles = np.linspace(0.0, 2.0 * math.pi, 3601)
    omega = last.velocity
    peak = (np.abs(profile(angles, 2)).max() * omega * omega
            + np.abs(profile(angles, 1)).max() * STOP.acceleration)
    for one, two in pairwise([followed[-1], *own]):
        assert two.time - one.time == pytest.approx(0.01, abs=ROUNDING)
        assert abs(two.velocity - one.velocity) <= peak * 0.01


@pytest.mark.parametrize('alpha', [
    0.0, 20.0,
    -20.0,
], ids=['steady', 'speeding up', 'slowing down'])
def test_an_axis_whose_master_has_died_stops_on_its_own_curve(world, tmp_path, alpha):
    path = tmp_path / 'belt.yaml'
    path.write_text(BELT)
    node = world.make(CamAxis, cli_args=[
        '--ros-args', '--params-file', str(path), '-r', '__node:=belt'])
    node.trigger_configure()
    node.trigger_activate()
    setpoints = world.points('belt/setpoint')
    world.speaker(JointTrajectoryPoint, 'shaft')
    assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
    shaft = [Point(2.0 + 0.1 * k + 0.5 * alpha * (0.01 * k)**2, 10.0 + alpha * 0.01 * k, alpha,
                   0, 10_000_000 * k) for k in range(10)]
    for point in shaft:
        node.answer(point)
    bring_to_rest(world.executor, [node])
    assert world.spin_until(lambda: setpoints[-1][1:3] == (0.0, 0.0))
    world.spin_until(lambda: setpoints[-1] == setpoints[-2], 2.0)
    check_stop_on_curve(load_belt(path), shaft, setpoints)
