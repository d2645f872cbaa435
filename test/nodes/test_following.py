# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""An axis at run time: engaged, changed, left alone by its shaft, resumed; it never jumps."""

from itertools import pairwise
import math
import re
import signal

from cam_motion.io.axis import build_axis
from cam_motion.io.config import load_machine
from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.master_shaft import MasterShaft
from cam_motion.nodes.wire import pack_point
from cam_motion.runtime.point import Point
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.units import DEGREE, RPM, TURN
import pytest
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, Trigger
from trajectory_msgs.msg import JointTrajectoryPoint

pytestmark = [pytest.mark.ros, pytest.mark.timeout(120)]

PRESS = {
    'segments': ['wait', 'down', 'up'], 'wait.end_deg': 60.0,
    'down.law': 'cycloidal', 'down.end_deg': 180.0, 'down.lift': 0.05,
    'up.law': 'modified_trapezoid', 'up.end_deg': 360.0, 'up.lift': -0.05,
    'limits.velocity': 2.0, 'limits.acceleration': 60.0,
}
PERIOD_NS = 2_000_000
STEP = 1.02  # what the limits allow from tick to tick, and 2 % for the rounding of differences


class Turner:
    """A shaft turned by the test, tick by tick, as fast as the axis answers."""

    def __init__(self, world, answers, speed=60.0, phi=0.0, start_ns=0):
        self.world, self.answers = world, answers
        self.publisher = world.speaker(JointTrajectoryPoint, 'shaft')
        self.shaft = Shaft(speed * RPM, RampLimits(30.0, 300.0), RampLimits(150.0, 3000.0), phi)
        self.time_ns = start_ns

    def send(self, point):
        """Send one point."""
        self.publisher.publish(pack_point(*point))

    def turn(self, ticks):
        """Turn on for some ticks, each answered before the next."""
        for _ in range(ticks):
            count = len(self.answers)
            self.send(self.now())
            self.time_ns += PERIOD_NS
            assert self.world.spin_until(lambda: len(self.answers) > count)

    def now(self):
        """Give the point of the next tick."""
        return Point(*self.shaft.state(self.time_ns * 1e-9), *divmod(self.time_ns, 10**9))

    def until(self, condition, most=3000):
        """Turn until a condition holds."""
        for _ in range(most):
            if condition():
                return
            self.turn(1)
        raise AssertionError('it did not come to that')


@pytest.fixture
def axis(world):
    """Bring an axis up that follows a shaft turned by the test."""
    def axis(given=PRESS, speed=60.0, **options):
        # the test turns the shaft when it comes to it: that is no silence
        node = world.make(CamAxis, {'master_timeout': 60.0, **given})
        node.trigger_configure()
        node.trigger_activate()
        assert node.active
        setpoints = world.points('cam_axis/setpoint')
        turner = Turner(world, setpoints, speed, **options)
        assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
        return node, turner, setpoints
    return axis


def check_smooth(setpoints, limits=(2.0, 60.0)):
    """Check that nothing jumps from setpoint to setpoint."""
    for one, two in pairwise(setpoints):
        h = two.time - one.time
        assert h >= 0.0
        assert abs(two.position - one.position) <= limits[0] * h * STEP + 1e-12
        assert abs(two.velocity - one.velocity) <= limits[1] * h * STEP + 1e-9


def change(world, **values):
    """Set parameters of the axis together."""
    parameters = [Parameter(name.replace('__', '.'), value=value).to_parameter_msg()
                  for name, value in values.items()]
    return world.call(SetParametersAtomically, 'cam_axis/set_parameters_atomically',
                      parameters=parameters).result


def test_engaged_and_disengaged_by_its_service(world, axis):
    node, turner, setpoints = axis({**PRESS, 'engage_at_start': False, 'start_position': 0.01})
    states = world.states('cam_axis')
    turner.turn(3)
    assert setpoints[-1][:3] == (0.01, 0.0, 0.0)
    turner.shaft.run(turner.time_ns * 1e-9)
    turner.turn(200)
    answer = world.call(SetBool, 'cam_axis/engage', data=True)
    assert answer.success and 'over 90 deg' in answer.message and 'm/s' in answer.message
    turner.until(lambda: node.state_text == 'in_sync')
    turner.turn(5)
    exact = build_axis('axis', PRESS).profile
    shaft = turner.shaft.state((turner.time_ns - PERIOD_NS) * 1e-9)
    assert setpoints[-1][:3] == exact.at_speed(*shaft)
    assert world.call(SetBool, 'cam_axis/engage', data=False).success
    turner.until(lambda: node.state_text == 'disengaged')
    turner.turn(2)
    assert setpoints[-1][1:3] == (0.0, 0.0)
    check_smooth(setpoints)
    # what it was before the first command may have been told before anybody listened
    told = ['waiting', 'engaging', 'in_sync', 'disengaging', 'disengaged']
    assert world.spin_until(lambda: states[-5:] == told), states


def test_parameters_change_together_or_not_at_all(world, axis):
    node, turner, setpoints = axis()
    turner.shaft.run(0.0)
    turner.turn(300)
    assert change(world, phase_deg=40.0, scale=0.8, offset=0.002).successful
    turner.until(lambda: node.state_text == 'changing')
    turner.until(lambda: node.state_text == 'in_sync')
    turner.turn(1)
    exact = build_axis('axis', PRESS).profile
    shaft = turner.shaft.state((turner.time_ns - PERIOD_NS) * 1e-9)
    y = 0.8 * exact.sample(shaft.phi + 40.0 * DEGREE)[0] + 0.002
    assert setpoints[-1].position == pytest.approx(y, abs=1e-12)
    refused = change(world, phase_deg=0.0, scale=500.0)
    assert not refused.successful and 'cycles/min' in refused.reason
    assert node.get_parameter('phase_deg').value == 40.0
    refused = change(world, phase_deg=0.0, limits__velocity=-1.0)
    assert not refused.successful and 'limits.velocity' in refused.reason
    turner.turn(50)
    assert node.state_text == 'in_sync'
    check_smooth(setpoints)


def test_several_cams_added_exchanged_and_removed(world, axis):
    given = {
        'cams': ['main', 'wobble'], 'limits.velocity': 2.0, 'limits.acceleration': 60.0,
        **{f'main.{key}': value for key, value in PRESS.items() if 'limits' not in key},
        'wobble.segments': ['up', 'down'], 'wobble.ratio': 3.0,
        'wobble.up.law': 'cycloidal', 'wobble.up.end_deg': 180.0, 'wobble.up.lift': 0.002,
        'wobble.down.law': 'cycloidal', 'wobble.down.end_deg': 360.0, 'wobble.down.lift': -0.002,
    }
    node, turner, setpoints = axis(given)
    turner.shaft.run(0.0)
    turner.turn(300)
    layout = build_axis('axis', given).layout
    for active in (['main', 'wobble'], ['wobble'], ['main']):
        assert change(world, active=active).successful
        turner.turn(1)
        turner.until(lambda: node.state_text == 'in_sync' and node._follower.plan is None)
        turner.turn(1)
        phi = turner.shaft.state((turner.time_ns - PERIOD_NS) * 1e-9).phi
        y = sum(layout._cam(name).sample(phi)[0] for name in active)
        assert setpoints[-1].position == pytest.approx(y, abs=1e-12)
    assert not change(world, active=['other']).successful
    check_smooth(setpoints)


def test_a_silent_shaft_stops_the_axis_on_its_curve(world, axis):
    node, turner, setpoints = axis({**PRESS, 'master_timeout': 0.1})
    turner.shaft.run(0.0)
    turner.turn(600)
    last = turner.shaft.state((turner.time_ns - PERIOD_NS) * 1e-9)
    states = world.states('cam_axis')
    count = len(setpoints)
    assert world.spin_until(lambda: node.state_text == 'held')
    assert world.spin_until(lambda: states[-2:] == ['stopping_on_curve', 'held'])
    # on the curve to the last bit: the exact answer to the shaft's own ramp to rest
    exact = build_axis('axis', PRESS).profile
    ramp = Shaft(0.0, RampLimits(150.0, 3000.0), RampLimits(150.0, 3000.0))._motion
    motion = type(ramp)(setpoints[count - 1].time, last).ramped(
        setpoints[count - 1].time, 0.0, RampLimits(150.0, 3000.0))
    for setpoint in setpoints[count:]:
        assert setpoint[:3] == pytest.approx(
            exact.at_speed(*motion.state(setpoint.time)), abs=1e-9)
    assert setpoints[-1][1:3] == (0.0, 0.0)
    assert {round((two.time - one.time) * 1e9) for one, two in pairwise(setpoints)} == {PERIOD_NS}
    check_smooth(setpoints, (2.0, 250.0))
    # the shaft comes back: it is answered, but the axis stands until it is reset
    turner.turn(5)
    assert setpoints[-1][:3] == (setpoints[-6].position, 0.0, 0.0)
    refused = world.call(SetBool, 'cam_axis/engage', data=True)
    assert not refused.success and 'silent' in refused.message
    answer = world.call(Trigger, 'cam_axis/reset')
    assert answer.success and 'resumes over' in answer.message, answer
    turner.until(lambda: node.state_text == 'in_sync')
    turner.turn(1)
    shaft = turner.shaft.state((turner.time_ns - PERIOD_NS) * 1e-9)
    assert setpoints[-1][:3] == exact.at_speed(*shaft)


def test_a_second_master_is_not_followed(world, axis):
    node, turner, setpoints = axis()
    turner.shaft.run(0.0)
    turner.turn(300)
    for k in range(20):
        count = node._shaft.watch.refused
        turner.send(Point(1.0 + 0.01 * k, 3.0, 0.0, 900, k * PERIOD_NS))
        assert world.spin_until(lambda: node._shaft.watch.refused > count)
        turner.turn(3)
    check_smooth(setpoints)
    exact = build_axis('axis', PRESS).profile
    shaft = turner.shaft.state((turner.time_ns - PERIOD_NS) * 1e-9)
    assert setpoints[-1][:3] == exact.at_speed(*shaft)
    level, values = node.health()
    assert level == b'\2' and values['points_of_another_shaft'] == 20


@pytest.mark.parametrize('start_ns', [0, 10**12], ids=['time runs backwards', 'and forwards'])
def test_a_shaft_that_comes_back_elsewhere_is_a_fault_until_reset(world, axis, start_ns):
    node, turner, setpoints = axis({**PRESS, 'master_timeout': 0.1, 'resume.span_deg': 270.0},
                                   start_ns=5 * 10**11)
    turner.turn(20)
    position = setpoints[-1].position
    elsewhere = Turner(world, setpoints, phi=2.0, start_ns=start_ns)
    for _ in range(200):
        elsewhere.send(elsewhere.now())
        elsewhere.time_ns += PERIOD_NS
        if world.spin_until(lambda: node.state_text == 'fault', 0.02):
            break
    assert node.state_text == 'fault'
    assert world.spin_until(lambda: setpoints[-1][:3] == (position, 0.0, 0.0))
    elsewhere.turn(10)
    level, values = node.health()
    assert level == b'\2' and 'deg' in values['reason']
    answer = world.call(Trigger, 'cam_axis/reset')
    assert answer.success and ' deg, up to ' in answer.message, answer
    elsewhere.shaft.run(elsewhere.time_ns * 1e-9)
    elsewhere.until(lambda: node.state_text == 'in_sync')
    one = [point for point in setpoints if point.time >= start_ns * 1e-9]
    check_smooth([p for p in (one if start_ns else setpoints[-len(one) + 40:])
                  if p.time < 5e2 or start_ns])


def test_a_master_started_anew_at_the_same_angle_goes_on(world, axis):
    node, turner, setpoints = axis(start_ns=5 * 10**11)
    turner.turn(20)
    again = Turner(world, setpoints)
    again.turn(20)
    again.shaft.run(again.time_ns * 1e-9)
    again.turn(200)
    assert node.state_text == 'in_sync'
    assert node._shaft.watch.refused == 0


def test_the_shaft_may_run_backwards(world, axis):
    node, turner, setpoints = axis(speed=-60.0)
    turner.shaft.run(0.0)
    turner.turn(400)
    assert turner.shaft.state(turner.time_ns * 1e-9).omega == -TURN
    assert change(world, phase_deg=30.0).successful
    turner.until(lambda: node.state_text == 'changing')
    turner.until(lambda: node.state_text == 'in_sync')
    check_smooth(setpoints)


def test_an_axis_follows_another_axis(world):
    leader = {'cycle': 'accumulate', 'segments': ['gear'], 'unit': 'rad',
              'gear.law': 'constant_velocity', 'gear.end_deg': 360.0, 'gear.lift': 0.5 * TURN}
    for name, given in (('leader', leader), ('cam_axis', {**PRESS, 'follows': 'leader'})):
        node = world.make(CamAxis, {**given, 'master_timeout': 60.0}, name=name)
        node.trigger_configure()
        node.trigger_activate()
    setpoints = world.points('cam_axis/setpoint')
    turner = Turner(world, setpoints)
    assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
    assert world.spin_until(lambda: world.probe.count_subscribers('leader/setpoint') == 1)
    world.spin_for(0.2)
    turner.shaft.run(0.0)
    turner.turn(400)
    shaft = turner.shaft.state((turner.time_ns - PERIOD_NS) * 1e-9)
    exact = build_axis('axis', PRESS).profile.at_speed(*(0.5 * value for value in shaft))
    assert setpoints[-1][:3] == pytest.approx(exact, abs=1e-12)


def test_the_shaft_is_lost_and_a_cascade_comes_to_rest_together(world):
    """The follower waits for its leader to stop, and stays on the curve over it all the way."""
    nodes = {}
    for name, given in (('leader', PRESS), ('cam_axis', {**PRESS, 'follows': 'leader',
                                                         'ratio': 50.0})):
        nodes[name] = node = world.make(CamAxis, {**given, 'master_timeout': 0.5}, name=name)
        node.trigger_configure()
        node.trigger_activate()
    led, setpoints = world.points('leader/setpoint'), world.points('cam_axis/setpoint')
    turner = Turner(world, setpoints)
    assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
    assert world.spin_until(lambda: world.probe.count_subscribers('leader/setpoint') == 2)
    turner.shaft.run(0.0)
    turner.turn(250)
    assert turner.shaft.state(turner.time_ns * 1e-9).omega > 1.0
    assert world.spin_until(lambda: nodes['leader'].state_text == 'held')
    assert world.spin_until(lambda: led[-1].velocity == led[-1].acceleration == 0.0 and (
        setpoints[-1].time == led[-1].time))
    cam = build_axis('axis', PRESS).profile
    leads = {point.time: point for point in led}
    for point in setpoints:
        place = 50.0 * leads[point.time].position
        assert point.position == pytest.approx(cam.sample(place)[0], abs=1e-12)
    assert setpoints[-1][1:3] == (0.0, 0.0)
    check_smooth(led)
    assert all(b.time - a.time == pytest.approx(PERIOD_NS * 1e-9) for a, b in pairwise(led))


def test_the_dead_time_is_made_up_for(world, axis):
    node, turner, setpoints = axis({**PRESS, 'dead_time': 0.010})
    turner.shaft.run(0.0)
    turner.turn(400)
    late = turner.shaft.state((turner.time_ns - PERIOD_NS) * 1e-9 + 0.010)
    assert setpoints[-1][:3] == pytest.approx(
        build_axis('axis', PRESS).profile.at_speed(*late), abs=1e-9)


def test_the_master_obeys_what_the_axes_allow(world):
    slow = {**PRESS, 'limits.acceleration': 5.0}
    node = world.make(CamAxis, slow)
    node.trigger_configure()
    heard = world.listen(Float64, 'cam_axis/max_speed_cpm', node_latched())
    node.trigger_activate()
    master = world.make(MasterShaft, {
        'speed_cpm': 20.0, 'obey': ['cam_axis'], 'start_delay': 0.0, 'rate_hz': 200.0})
    master.sections = lambda: {'cam_axis': slow}  # as a parameter file gives them
    master.trigger_configure()
    master.trigger_activate()
    bound = build_axis('axis', slow).speed_bound.omega
    assert world.spin_until(lambda: heard and heard[-1].data == pytest.approx(bound / RPM))
    setpoints = world.points('cam_axis/setpoint')
    shaft = world.points('shaft')
    assert world.spin_until(lambda: shaft and shaft[-1].velocity == pytest.approx(20.0 * RPM))
    world.speaker(Float64, 'master_shaft/speed_cpm').publish(Float64(data=300.0))
    assert world.spin_until(lambda: shaft[-1].acceleration == 0.0 and (
        shaft[-1].velocity == pytest.approx(bound * (1.0 - 5e-4), rel=1e-9)))
    values = master.health()[1]
    assert re.fullmatch(
        r'cam_axis \(\w+ at [\d.]+ deg: acceleration\)', values['held_back_by'])
    assert master.get_parameter('speed_cpm').value == 300.0
    assert values['allowed_speed_cpm'] == pytest.approx(bound / RPM)
    assert max(abs(point.acceleration) for point in setpoints) <= 5.0


def test_the_master_keeps_the_limits_of_an_axis_that_follows_another(world):
    """What such an axis allows is a speed of what it follows: the shaft is held accordingly."""
    leader = {'cycle': 'accumulate', 'segments': ['gear'], 'unit': 'rad',
              'gear.law': 'constant_velocity', 'gear.end_deg': 360.0, 'gear.lift': 3.0 * TURN}
    follower = {**PRESS, 'follows': 'leader', 'limits.acceleration': 5.0}
    nodes = [world.make(CamAxis, leader, name='leader'),
             world.make(CamAxis, follower, name='cam_axis')]
    heard = world.listen(Float64, 'cam_axis/max_speed_cpm', node_latched())
    master = world.make(MasterShaft, {
        'speed_cpm': 300.0, 'obey': ['cam_axis'], 'start_delay': 0.5, 'rate_hz': 200.0})
    master.sections = lambda: {'leader': leader, 'cam_axis': follower}
    shaft, setpoints = world.points('shaft'), world.points('cam_axis/setpoint')
    for node in (*nodes, master):
        node.trigger_configure()
        node.trigger_activate()
    alone = build_axis('axis', {**PRESS, 'limits.acceleration': 5.0}).speed_bound.omega
    assert world.spin_until(lambda: shaft and shaft[-1].velocity > 1.0
                            and shaft[-1].acceleration == 0.0)
    # three turns of the axis per turn of the shaft
    assert shaft[-1].velocity == pytest.approx(alone / 3.0, rel=0.01)
    world.spin_for(1.0)
    assert max(abs(point.acceleration) for point in setpoints) <= 5.0
    assert heard[-1].data == math.inf
    assert master.health()[1]['held_back_by'] == 'cam_axis (behind leader: velocity)'
    # its own coupling and limits change while it runs; the way to another coupling is planned
    # for the speed allowed before, which only other limits raise
    for values, omega in (({'scale': 0.5}, alone / 3.0),
                          ({'limits__acceleration': 1.25}, alone / 3.0 / math.sqrt(2.0)),
                          ({'limits__acceleration': 2.5}, alone / 3.0)):
        assert change(world, **values).successful
        assert world.spin_until(lambda: nodes[1]._follower.plan is None)
        assert world.spin_until(lambda: shaft[-1].velocity == pytest.approx(omega, rel=0.01)
                                and shaft[-1].acceleration == 0.0), values
    count = len(setpoints)
    assert world.spin_until(lambda: len(setpoints) > count + 200)
    assert max(abs(point.acceleration) for point in setpoints[count:]) <= 2.5


def node_latched():
    """Give the quality of service of latched topics."""
    from cam_motion.nodes.qos import LATCHED
    return LATCHED


@pytest.mark.slow
@pytest.mark.timeout(240)
def test_axes_left_alone_by_a_killed_master_stop_together_and_resume(world, start, machine_file):
    axes = ('feeder', 'press', 'knife')
    shaft = world.points('shaft')
    setpoints = {axis: world.points(f'{axis}/setpoint') for axis in axes}
    states = {axis: world.states(axis) for axis in axes}
    options = ['--params-file', machine_file]
    # longer than a busy machine ever leaves a process alone
    processes = [start('cam_axis', *options, '-r', f'__node:={axis}', '-p', 'master_timeout:=2.0')
                 for axis in axes]
    master = start('master_shaft', *options)
    assert world.spin_until(lambda: shaft and shaft[-1][1:3] == (200.0 * RPM, 0.0), 60.0)
    assert world.spin_until(lambda: all(states[axis][-1:] == ['in_sync'] for axis in axes)), states
    world.spin_for(1.0)
    assert all(states[axis][-1] == 'in_sync' for axis in axes), states
    master.signal(signal.SIGKILL)
    assert world.spin_until(lambda: all(states[axis][-1:] == ['held'] for axis in axes)), (
        states, [process.said for process in processes])
    assert all(process.running for process in processes)
    machine = load_machine(machine_file)
    ends = []
    for axis in axes:
        end = setpoints[axis][-1]
        assert end[1:3] == (0.0, 0.0)
        phi = stop_angle(machine.diagram.axes[axis].profile, shaft, end)
        assert phi is not None, (axis, end, shaft[-3:], [process.said for process in processes])
        ends.append(phi)
    # one tick apart when killed between two deliveries; two when killed among late ticks
    assert max(ends) - min(ends) <= 2.0 * 200.0 * RPM * 0.002 * (1.0 + 1e-9)
    # a new master, started from its beginning: the axes wait for their reset, then come back
    count = len(shaft)
    start('master_shaft', *options)
    assert world.spin_until(lambda: len(shaft) > count + 100 and shaft[-1].velocity > 1.0, 60.0)
    assert all(setpoints[axis][-1][1:3] == (0.0, 0.0) for axis in axes)
    for axis in axes:
        heard = len(setpoints[axis])
        assert world.spin_until(lambda: len(setpoints[axis]) > heard)
        answer = world.call(Trigger, f'{axis}/reset')
        assert answer.success and 'deg' in answer.message, answer
    assert world.spin_until(lambda: all(states[axis][-1] == 'in_sync' for axis in axes))
    world.spin_for(1.0)
    at = {point[3:]: point for point in shaft[count:]}
    for axis in axes:
        profile, last = machine.diagram.axes[axis].profile, setpoints[axis][-1]
        exact = profile.at_speed(*at[last[3:]][:3])
        assert last[1:3] == pytest.approx(exact[1:], abs=1e-9)
        strokes = (last.position - exact[0]) / (profile.advance or math.inf)
        assert strokes == pytest.approx(round(strokes), abs=1e-9)


def stop_angle(profile, shaft, end):
    """Give the angle at which the axis brought the shaft to rest; None if it was none."""
    from cam_motion.runtime.shaft_motion import ShaftMotion, ShaftState
    limits = RampLimits(150.0, 3000.0)
    found = []
    for last in shaft[-3:]:
        motion = ShaftMotion(last.time, ShaftState(*last[:3])).ramped(last.time, 0.0, limits)
        y = profile.sample(motion.final.phi)[0]
        found.append((abs(y - end.position), motion.final.phi))
    miss, phi = min(found)
    return phi if miss <= 1e-9 else None
