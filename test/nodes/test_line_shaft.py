# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A drive that turns the shaft, live: its points are those of the periodic motion, it rests."""

from itertools import pairwise
import signal
import time

from cam_motion.drive.live_shaft import LiveShaft
from cam_motion.drive.orbit import find_orbit
from cam_motion.drive.shaft_torque import Command
from cam_motion.io.config import load_machine, read_sections
from cam_motion.nodes import diagnostics
from cam_motion.nodes.drive_sim import DriveSim
from cam_motion.nodes.line import make_line
from cam_motion.nodes.master_shaft import MasterShaft
from cam_motion.nodes.runner import start as start_nodes
from cam_motion.units import TURN
import numpy as np
import pytest
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger

pytestmark = [pytest.mark.ros, pytest.mark.timeout(120)]

ON_ORBIT = 1e-6  # relative deviation of the speed from the periodic motion at the same angle
ROUNDING = 1e-9
SETTLED = 2.5  # s; a disturbance shrinks to a tenth in each revolution of 0.15 s
START = 60.0  # s; until a process that has just been started is heard


@pytest.fixture(scope='module')
def press_file(machine_file):
    """Give the path of the press's machine file."""
    return machine_file.parent / 'cam_press_drive.yaml'


@pytest.fixture(scope='module')
def press(press_file):
    """Build the press."""
    return load_machine(press_file)


@pytest.fixture
def drive(world, press_file):
    """Make the press drive alone, with parameters changed, and bring it up."""
    sections = read_sections(press_file)

    def drive(**changes):
        given = sections['press_drive']
        node = world.make(DriveSim, {**given, **{
            key.replace('__', '.'): value for key, value in changes.items()}}, name='press_drive')
        node.section = sections.get
        assert start_nodes([node]) == 0
        return node
    return drive


def speed_of(orbit, phi):
    """Give the speed of the periodic motion at an angle [rad/s]."""
    q = phi % TURN
    stretch = next(s for s in orbit.stretches if s.element.start <= q <= s.element.end)
    return float(stretch.omega(np.array([q]))[0])


def is_uniform(points, period=0.002):
    """Tell whether points come at one rate, each where speed and time lead to."""
    for a, b in pairwise(points):
        step = b.time - a.time
        gone = 0.5 * step * (a.velocity + b.velocity) + step ** 2 / 12.0 * (
            a.acceleration - b.acceleration)
        if abs(step - period) > ROUNDING or abs(b.position - a.position - gone) > 1e-4:
            return False
    return True


def test_a_line_follows_the_real_shaft_on_its_orbit(world, press_file, press):
    nodes = make_line(context=world.context,
                      cli_args=['--ros-args', '--params-file', str(press_file)])
    assert [node.get_name() for node in nodes] == ['press_drive', 'follower', 'line']
    for node in nodes:
        world.add(node)
    shaft, setpoints = world.points('shaft'), world.points('follower/setpoint')
    states = world.listen(JointState, 'press_drive/drive_state')
    told = world.states('press_drive')
    assert start_nodes(nodes) == 0
    assert world.spin_until(lambda: shaft and shaft[-1].time > SETTLED + 0.5)
    orbit = find_orbit(press.cam_drives['press_drive'].drive)
    settled = [point for point in shaft if point.time > SETTLED]
    assert max(abs(p.velocity / speed_of(orbit, p.position) - 1.0) for p in settled) < ON_ORBIT
    low, high = orbit.speeds
    assert (min(p.velocity for p in settled), max(p.velocity for p in settled)) == pytest.approx(
        (low, high), rel=1e-3)
    assert is_uniform(shaft)
    sample = press.diagram.axes['follower'].profile.sample
    by_time = {(p.sec, p.nanosec): p for p in shaft}
    for y in setpoints[-200:]:
        at = by_time[y.sec, y.nanosec]
        s, slope, bend, _ = sample(at.position)
        assert (y.position, y.velocity, y.acceleration) == pytest.approx(
            (s, slope * at.velocity, bend * at.velocity ** 2 + slope * at.acceleration),
            rel=ROUNDING, abs=ROUNDING)
    assert {tuple(state.name) for state in states} == {('motor', 'load', 'shaft')}
    ratio = 3.5525
    inertia = press.cam_drives['press_drive'].drive.fixed_inertia
    for state in states[-100:]:
        assert state.position[0] == pytest.approx(ratio * state.position[2])
        assert state.velocity[0] == pytest.approx(ratio * state.velocity[2])
    for state, point in zip(states, shaft):
        assert state.position[2] == point.position
        assert state.effort[2] == pytest.approx(
            state.effort[1] + inertia * point.acceleration, abs=1e-9)
    assert told[-1] == 'running'
    level, values = nodes[0].health()
    assert level == (diagnostics.WARN if values['missed_ticks'] else diagnostics.OK)
    assert nodes[2].health()[0] == level


def test_a_late_wake_up_costs_time_but_no_jump(world, drive):
    node = drive(start_delay=0.1, max_catch_up=0.05)
    shaft = world.points('shaft')
    assert world.spin_until(lambda: shaft and shaft[-1].velocity > 20.0)
    time.sleep(0.4)
    seen = len(shaft)
    assert world.spin_until(lambda: len(shaft) > seen + 200)
    level, values = node.health()
    assert level == diagnostics.WARN
    assert values['missed_ticks'] > 100
    assert values['dropped_s'] == pytest.approx(values['missed_ticks'] / 500.0)
    assert values['ticks'] >= len(shaft)
    assert is_uniform(shaft)


def test_the_motor_is_switched_and_the_brake_applied_by_services(world, drive):
    node = drive(run_at_start=False)
    shaft = world.points('shaft')
    states = world.listen(JointState, 'press_drive/drive_state')

    def run(on):
        return world.call(SetBool, 'press_drive/run', data=on).success

    def ask(name):
        return world.call(Trigger, f'press_drive/{name}').success

    world.spin_for(0.2)
    assert node.state_text == 'stopped'
    assert run(True)
    assert node.state_text == 'running'
    assert world.spin_until(lambda: shaft[-1].velocity > 30.0)
    assert run(False)
    assert node.state_text == 'coasting'
    assert ask('quick_stop')
    off = len(states) + 20  # later ones are those of a motor that is off, under the brake
    assert node.state_text == 'quick_stopping'
    assert node.health()[1]['motor_torque'] == 0.0 or world.spin_until(
        lambda: node.health()[1]['motor_torque'] == 0.0)
    assert not run(True)
    assert not ask('reset')
    assert world.spin_until(lambda: node.state_text == 'quick_stopped')
    assert shaft[-1].velocity == shaft[-1].acceleration == 0.0 or world.spin_until(
        lambda: shaft[-1].velocity == shaft[-1].acceleration == 0.0)
    assert not run(True)
    assert {state.effort[0] for state in states[off:]} == {0.0}
    assert any(state.effort[2] for state in states[off:])  # the brake, through the gearbox
    assert node.health()[1]['brake_torque'] != 0.0  # the brake holds the load
    assert ask('reset')
    assert run(True)
    assert world.spin_until(lambda: shaft[-1].velocity > 1.0)


def test_deactivated_in_motion_it_leaves_a_hold_point_and_goes_on_from_there(world, drive):
    node = drive(start_delay=0.0)
    shaft = world.points('shaft')
    assert world.spin_until(lambda: shaft and shaft[-1].velocity > 20.0)
    node.trigger_deactivate()
    assert world.spin_until(lambda: shaft[-1].velocity == 0.0)
    assert shaft[-1].position == shaft[-2].position
    held = len(shaft)
    node.trigger_activate()
    assert world.spin_until(lambda: shaft[-1].velocity > 1.0)
    assert shaft[held].position == pytest.approx(shaft[held - 1].position, abs=1e-3)


def test_a_motor_that_cannot_turn_the_load_is_reported(world, drive):
    node = drive(motor__breakdown_torque=6.0, start_delay=0.0)
    assert world.spin_until(lambda: node.state_text == 'stalled')
    level, values = node.health()
    assert level == diagnostics.WARN
    assert values['stops_under_power'] > 0


def test_another_master_beside_it_is_reported(world, drive):
    node = drive()
    assert node.health()[0] == diagnostics.OK
    world.make(MasterShaft).trigger_configure()
    assert world.spin_until(lambda: node.health()[0] == diagnostics.ERROR)
    assert 'another node' in node.health()[1]['reason']


def test_on_clock_the_points_are_those_of_the_core_to_the_bit(world, drive, press):
    node = drive(use_sim_time=True, start_delay=0.1, rate_hz=100.0, max_catch_up=0.05)
    shaft = world.points('shaft')
    clock = world.speaker(Clock, '/clock', QoSProfile(
        depth=1, reliability=ReliabilityPolicy.RELIABLE))
    for now in range(5 * 10**9, 5_600_000_000, 10**7):
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(now, 10**9)
        clock.publish(message)
        assert world.spin_until(lambda now=now: node.get_clock().now().nanoseconds == now)
        world.spin_for(0.01)
    assert world.spin_until(lambda: shaft and shaft[-1].time > 0.5)
    assert node.health()[1]['missed_ticks'] == 0
    settings = press.cam_drives['press_drive']
    core = LiveShaft(settings.drive, 500_000, settings.brake_torque)
    core.tell(10**8, Command.RUN)
    for point in shaft:
        state = core.state(point.sec * 10**9 + point.nanosec) if point.time >= 0.1 else (0, 0, 0)
        assert (point.position, point.velocity, point.acceleration) == tuple(state[:3])
    assert shaft[-1].velocity > 5.0


def test_the_mode_cannot_change_while_the_node_lives(world, drive):
    node = drive()
    node.trigger_deactivate()
    node.trigger_cleanup()
    result, = node.set_parameters([
        type(node.get_parameter('mode'))('mode', value='follow')])
    assert not result.successful
    assert 'parameters depend on it' in result.reason


@pytest.mark.slow
def test_drive_and_axis_as_processes_come_to_rest_together(world, start, press_file):
    shaft, setpoints = world.points('shaft'), world.points('follower/setpoint')
    common = ['--params-file', press_file]
    processes = [start('cam_axis', *common, '-r', '__node:=follower'),
                 start('drive_sim', *common, '-r', '__node:=press_drive')]
    said = lambda: ''.join(each.said for each in processes)  # noqa: E731
    assert world.spin_until(
        lambda: setpoints and shaft and shaft[-1].velocity > 40.0, START), said()
    for process in processes:
        process.signal(signal.SIGINT)
    assert world.spin_until(lambda: not any(p.running for p in processes)), said()
    assert [process.exit_code() for process in processes] == [0, 0], said()
    world.spin_for(0.3)
    assert shaft[-1].velocity == shaft[-1].acceleration == 0.0
    assert setpoints[-1].velocity == setpoints[-1].acceleration == 0.0
    braking = [p for p in shaft if p.time > shaft[-1].time - 0.1]
    assert all(b.velocity <= a.velocity for a, b in pairwise(braking))


@pytest.mark.slow
def test_what_cannot_be_used_ends_with_exit_code_2(start, press_file, tmp_path):
    text = press_file.read_text()
    rival = tmp_path / 'rival.yaml'
    rival.write_text(text + 'master_shaft: {ros__parameters: {speed_cpm: 60.0}}\n')
    wrong = tmp_path / 'wrong.yaml'
    wrong.write_text(text.replace('mass: 7.0', 'mass: -7.0').replace('arm: 0.18', 'arms: 0.18'))
    bare = tmp_path / 'bare.yaml'
    bare.write_text(text.replace('follower:', 'somebody:'))
    name = ['-r', '__node:=press_drive']
    runs = {
        'nothing else may': start('line', '--params-file', rival),
        'slider.mass': start('drive_sim', '--params-file', wrong, *name),
        'needs the cam of its axis': start('drive_sim', '--params-file', bare, *name),
        'brake.torque': start('drive_sim', '--params-file', press_file, *name,
                              '-p', 'brake.torque:=-1.0'),
    }
    for words, process in runs.items():
        assert process.exit_code(START) == 2, process.said
        assert words in process.said
        assert 'Traceback' not in process.said
