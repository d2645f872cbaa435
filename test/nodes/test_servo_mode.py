# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A servo drive as a node: what it publishes, what it does without setpoints, how it ends."""

from itertools import pairwise
import signal

from cam_motion.io.axis import build_axis
from cam_motion.io.config import load_machine
from cam_motion.io.interface import INTERFACE
from cam_motion.nodes.drive_sim import DriveSim
from cam_motion.nodes.line_topics import topics_of
from cam_motion.nodes.wire import pack_point
from cam_motion.runtime.point import Point
from cam_motion.units import RPM
from diagnostic_msgs.msg import DiagnosticArray
import pytest
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectoryPoint

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

SECOND = 10 ** 9
RADIUS, RATIO = 0.134, 9.0
SERVO = {
    'mode': 'servo', 'axis': 'feeder', 'radius': RADIUS, 'gear_ratio': RATIO, 'efficiency': 0.95,
    'load_inertia': 1.164, 'resistance_force': 500.0, 'motor.inertia': 0.00123,
    'motor.rated_rpm': 3000.0, 'motor.max_rpm': 5000.0, 'motor.rated_torque': 15.8,
    'motor.peak_torque': 47.6, 'motor.torque_constant': 0.6,
    'setpoint_timeout': 30.0,  # unless a test is about silence, it shall not come between
}
FEEDER = {'cycle': 'accumulate', 'segments': ['feed', 'wait'], 'feed.law': 'modified_trapezoid',
          'feed.end_deg': 80.0, 'feed.lift': 0.3, 'wait.end_deg': 360.0}
FOLLOWS = 1e-5  # peak following error of this drive at 60 cycles/min [m]
START = 60.0  # s; until a process that has just been started is heard


def cycle(count, cpm=60.0, period_ns=2_000_000, start_ns=0):
    """Give setpoints of the feeder, from the begin of its movement."""
    profile, omega = build_axis('feeder', FEEDER).profile, cpm * RPM
    for k in range(count):
        y, slope, bend, _ = profile.sample(omega * k * period_ns * 1e-9)
        yield Point(y, slope * omega, bend * omega ** 2,
                    *divmod(start_ns + k * period_ns, SECOND))


class Driven:
    """A servo drive in-process, what it publishes, and a hand that gives it setpoints."""

    def __init__(self, world, **changes):
        self.world = world
        self.node = world.make(DriveSim, {**SERVO, **changes}, own_process=False)
        self.node.trigger_configure()
        self.node.trigger_activate()
        assert self.node.active
        self.states = world.listen(JointState, 'drive_sim/drive_state')
        self.actual = world.points('drive_sim/actual')
        assert world.spin_until(lambda: {
            p.topic_name.rsplit('/', 1)[1]: p.get_subscription_count()
            for p in self.node.publishers}.items() >= {'drive_state': 1, 'actual': 1}.items())

    def give(self, setpoints):
        """Hand setpoints over; wait until everything that follows is heard."""
        given = list(setpoints)
        wanted = len(self.actual) + len(given)
        for point in given:
            self.node.answer(point)
        assert self.world.spin_until(
            lambda: len(self.actual) >= wanted and len(self.states) >= wanted)
        return given

    @property
    def figures(self):
        """Return what the node tells in its diagnostics."""
        return self.node.health()[1]


def test_every_setpoint_is_answered_with_what_the_axis_really_does(world):
    driven = Driven(world)
    given = driven.give(cycle(400))
    assert len(driven.states) == len(driven.actual) == 400
    for point, actual, state in zip(given, driven.actual, driven.states):
        assert (actual.sec, actual.nanosec) == (point.sec, point.nanosec)
        assert actual.position == pytest.approx(point.position, abs=FOLLOWS)
        assert state.position[1] * RADIUS == pytest.approx(actual.position, abs=1e-12)
        assert state.position[0] == pytest.approx(RATIO * state.position[1], rel=1e-12)
        assert state.velocity[0] == pytest.approx(RATIO * state.velocity[1], rel=1e-12)
        assert tuple(state.name) == ('motor', 'load')
    stamps = [s.header.stamp.sec * SECOND + s.header.stamp.nanosec for s in driven.states]
    assert {b - a for a, b in pairwise(stamps)} == {2_000_000}
    figures = driven.figures
    assert figures['states'] == 400
    assert figures['saturations'] == 0.0 == figures['dropped_s']
    assert figures['motor_current'] == pytest.approx(figures['motor_torque'] / 0.6)
    assert 0.0 < figures['peak_following_error'] < FOLLOWS


def test_setpoints_by_topic_are_followed_as_those_handed_over(world):
    driven = Driven(world)
    given = driven.give(cycle(60))
    alone = world.make(DriveSim, SERVO, name='alone')
    alone.trigger_configure()
    alone.trigger_activate()
    actual = world.points('alone/actual')
    publisher = world.speaker(JointTrajectoryPoint, 'feeder/setpoint')
    assert world.spin_until(lambda: any(
        p.topic_name == '/alone/actual' and p.get_subscription_count() for p in alone.publishers))
    for number, point in enumerate(given, start=1):
        publisher.publish(pack_point(*point))
        assert world.spin_until(lambda: len(actual) == number)
    assert actual == driven.actual


def test_a_motor_too_weak_lags_and_says_so(world):
    driven = Driven(world)
    driven.give(cycle(300, cpm=100.0))
    assert max(abs(state.effort[0]) for state in driven.states) == 47.6
    figures = driven.figures
    assert figures['saturations'] > 0 and figures['saturated_s'] > 0.1
    assert figures['peak_following_error'] > 0.05
    assert driven.node.health()[0] != b'\x00'


def test_lost_setpoints_are_integrated_over_within_the_budget_and_counted_beyond(world):
    driven = Driven(world)
    points = list(cycle(500))
    driven.give(points[:20] + points[40:60])  # 42 ms between two
    assert driven.figures['dropped_s'] == 0.0
    driven.give(points[160:170])  # 202 ms
    assert driven.figures['dropped_s'] == pytest.approx(0.152)
    assert driven.actual[-1].position == pytest.approx(points[169].position, abs=1e-3)


def test_a_time_base_that_begins_anew_is_followed_from_its_first_setpoint_on(world):
    driven = Driven(world)
    driven.give(cycle(30, start_ns=100 * SECOND))
    driven.give(cycle(30))
    assert driven.actual[30].position == 0.0
    assert driven.figures['dropped_s'] == 0.0
    stamps = [s.header.stamp.sec * SECOND + s.header.stamp.nanosec for s in driven.states]
    # the stamps begin anew at the present: 100 s are not taken back
    assert stamps[0] <= stamps[30] <= world.probe.get_clock().now().nanoseconds
    assert {b - a for a, b in pairwise(stamps[30:])} == {2_000_000}


def test_without_setpoints_the_axis_comes_to_rest_and_goes_on_when_they_come_again(world):
    driven = Driven(world, setpoint_timeout=0.1, stop_time=0.05)
    states = world.states('drive_sim')
    driven.give([Point(0.002 * k, 1.0, 0.0, 0, 2_000_000 * k) for k in range(50)])
    assert world.spin_until(lambda: driven.node.state_text == 'silent')
    assert world.spin_until(lambda: abs(driven.actual[-1].velocity) < 1e-9)
    rest = driven.actual[-1]
    assert rest.position == pytest.approx(0.098 + 0.5 * 0.05, abs=1e-4)
    assert 'silent' in states
    silent = len(driven.actual)
    assert world.spin_until(lambda: len(driven.actual) > silent)  # it goes on telling
    ahead_ns = driven.actual[-1].sec * SECOND + driven.actual[-1].nanosec + 20_000_000
    driven.node.answer(Point(rest.position, 0.0, 0.0, *divmod(ahead_ns, SECOND)))
    assert driven.node.state_text == 'following'
    assert driven.figures['dropped_s'] == 0.0


def test_the_node_has_the_topics_of_the_table(world):
    world.make(DriveSim, SERVO, name='drive_sim').trigger_configure()
    rows = {(row.kind, row.name): row.type_name for row in INTERFACE
            if row.node == 'drive_sim: servo'}
    assert set(rows) == {('publishes', '~/actual')}

    def types():
        return dict(world.probe.get_publisher_names_and_types_by_node('drive_sim', '/'))

    assert world.spin_until(lambda: '/drive_sim/actual' in types())
    assert types()['/drive_sim/actual'] == [rows['publishes', '~/actual']]


def test_the_topics_of_a_line_hold_what_its_servo_drives_tell():
    sections = {'feeder': FEEDER, 'drive': SERVO, 'other': {'axis': 'feeder'}}
    names = {topic.name for topic in topics_of(sections)}
    assert 'drive/actual' in names
    assert 'other/actual' not in names


def test_another_mode_needs_another_start(world):
    driven = Driven(world)
    refused = driven.node.refuse_change('mode', 'follow')
    assert 'when the node is started' in refused


@pytest.mark.slow
def test_a_process_runs_on_the_plain_machine_file_and_ends_when_told(
        world, start, machine_file):
    file = machine_file.with_name('feeding_group_servo.yaml')
    assert load_machine(file).drives['feeder_drive'].servo is not None
    actual = world.points('/feeder_drive/actual')
    setpoints = world.points('/feeder/setpoint')
    reports = world.listen(DiagnosticArray, '/diagnostics')
    common = ['--params-file', file]
    drive = start('drive_sim', *common, '-r', '__node:=feeder_drive',
                  '-p', 'setpoint_timeout:=2.0')
    axis = start('cam_axis', *common, '-r', '__node:=feeder')
    master = start('master_shaft', *common)
    assert world.spin_until(
        lambda: any(point.velocity > 2.0 for point in actual), START), drive.said

    def dropped():
        return [float(pair.value) for report in reports for status in report.status
                if status.name.endswith('feeder_drive') for pair in status.values
                if pair.key == 'dropped_s']

    assert world.spin_until(dropped, START)
    # a process that wakes up late integrates what it can and says what it has dropped
    before = dropped()[-1]
    drive.signal(signal.SIGSTOP)
    world.spin_for(2.5)
    drive.signal(signal.SIGCONT)
    assert world.spin_until(lambda: dropped()[-1] > before + 0.1, START)

    def errors():
        at = {(point.sec, point.nanosec): point.position for point in setpoints}
        return [at[real.sec, real.nanosec] - real.position for real in actual
                if (real.sec, real.nanosec) in at]

    assert world.spin_until(lambda: len(errors()) > 100, START)
    assert max(map(abs, errors())) < 1e-3
    assert 'no setpoint of' not in drive.said  # it slept, the setpoints did not
    for process in (master, axis, drive):
        process.signal(signal.SIGINT)
        assert process.exit_code() == 0, process.said
