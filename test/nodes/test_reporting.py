# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a node tells of itself: its latched state, and its diagnostics once a second."""

from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.drive_sim import DriveSim
from cam_motion.nodes.master_shaft import MasterShaft
from cam_motion.nodes.qos import LATCHED
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
import pytest
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectoryPoint

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

FEEDER = {
    'segments': ['feed', 'back'], 'feed.law': 'cycloidal', 'feed.end_deg': 80.0,
    'feed.lift': 0.3, 'back.law': 'cycloidal', 'back.end_deg': 360.0, 'back.lift': -0.3,
}
MASTER_KEYS = {
    'speed_cpm', 'set_speed_cpm', 'angle_deg', 'cycles', 'ticks', 'missed_ticks', 'late_ticks',
    'worst_lateness_us', 'clock_restarts'}
AXIS_KEYS = {
    'setpoints', 'refused_points', 'points_of_another_shaft', 'missed_ticks', 'shaft_age_s',
    'position', 'velocity', 'acceleration', 'unit', 'worst_answer_us'}
DRIVE_KEYS = {'states', 'refused_points', 'motor_torque', 'motor_speed_rpm', 'peak_motor_torque'}


def bring_up(*nodes):
    """Configure and activate nodes."""
    for node in nodes:
        node.trigger_configure()
        node.trigger_activate()
        assert node.active


def reports_of(messages, name):
    """Give what one node has reported: stamps [s], and its last status with values by key."""
    mine = [message for message in messages if message.status[0].name == name]
    stamps = [m.header.stamp.sec + 1e-9 * m.header.stamp.nanosec for m in mine]
    last = mine[-1].status[0] if mine else None
    return stamps, last, {pair.key: pair.value for pair in last.values} if mine else {}


def test_a_late_joiner_learns_the_state(world):
    node = world.make(MasterShaft, {'run_at_start': False})
    bring_up(node)
    world.spin_for(0.3)
    for _ in range(2):
        states = world.listen(String, 'master_shaft/state', LATCHED)
        assert world.spin_until(lambda: states)
        assert [message.data for message in states] == ['stopped']


def test_every_node_reports_once_a_second_with_its_figures(world):
    reports = world.listen(DiagnosticArray, '/diagnostics')
    master = world.make(MasterShaft, {'speed_cpm': 90.0, 'start_delay': 0.0})
    axis = world.make(CamAxis, FEEDER, cli_args=['--ros-args', '-r', '__node:=feeder'])
    drive = world.make(DriveSim, {'axis': 'feeder', 'load_inertia': 1.0})
    bring_up(drive, axis, master)
    for name, keys in (('master_shaft', MASTER_KEYS), ('feeder', AXIS_KEYS),
                       ('drive_sim', DRIVE_KEYS)):
        assert world.spin_until(lambda: reports_of(reports, name)[2].keys() == keys), name
        assert world.spin_until(lambda: len(reports_of(reports, name)[0]) >= 4)
        stamps = reports_of(reports, name)[0]
        # a busy machine delays single reports, but none is left out and none comes twice
        assert 0.5 < (stamps[-1] - stamps[0]) / (len(stamps) - 1) < 2.0
    assert world.spin_until(
        lambda: reports_of(reports, 'master_shaft')[2]['speed_cpm'] == '90')
    _, status, values = reports_of(reports, 'master_shaft')
    assert status.message == 'running'
    assert values['set_speed_cpm'] == '90'
    assert int(values['ticks']) > 100
    assert 0.0 <= float(values['angle_deg']) < 360.0
    assert status.level == (DiagnosticStatus.WARN if int(values['missed_ticks'])
                            else DiagnosticStatus.OK)
    _, status, values = reports_of(reports, 'feeder')
    assert (status.message, values['unit'], values['refused_points']) == ('in_sync', 'm', '0')
    _, status, values = reports_of(reports, 'drive_sim')
    assert (status.message, status.hardware_id) == ('following', 'feeder')
    assert float(values['peak_motor_torque']) >= abs(float(values['motor_torque']))


def test_a_refused_point_is_a_warning(world):
    reports = world.listen(DiagnosticArray, '/diagnostics')
    bring_up(world.make(CamAxis, FEEDER), world.make(DriveSim, {'axis': 'cam_axis'}))
    world.speaker(JointTrajectoryPoint, 'shaft').publish(JointTrajectoryPoint(positions=[1.0]))
    assert world.spin_until(
        lambda: reports_of(reports, 'cam_axis')[2].get('refused_points') == '1')
    assert reports_of(reports, 'cam_axis')[1].level == DiagnosticStatus.WARN


def test_missed_ticks_are_counted_and_reported(world):
    reports = world.listen(DiagnosticArray, '/diagnostics')
    master = world.make(MasterShaft, {'max_catch_up': 0.002})
    points = world.points('shaft')
    bring_up(master)
    assert world.spin_until(lambda: points)
    # nobody spins meanwhile, as where the process is held up
    blocked_at = master.steady_now()
    while master.steady_now() < blocked_at + 0.2:
        pass
    assert world.spin_until(
        lambda: int(reports_of(reports, 'master_shaft')[2].get('missed_ticks', 0)) >= 90)
    assert reports_of(reports, 'master_shaft')[1].level == DiagnosticStatus.WARN
    stamps = [point.sec * 10**9 + point.nanosec for point in points]
    assert all(stamp % 2_000_000 == 0 for stamp in stamps)
    assert stamps == sorted(set(stamps))


def test_a_node_that_is_not_configured_reports_too(world):
    reports = world.listen(DiagnosticArray, '/diagnostics')
    for factory in (MasterShaft, CamAxis, DriveSim):
        world.make(factory)
    for name in ('master_shaft', 'cam_axis', 'drive_sim'):
        assert world.spin_until(lambda: reports_of(reports, name)[0])
        _, status, values = reports_of(reports, name)
        assert (status.message, status.level, values) == (
            'unconfigured', DiagnosticStatus.OK, {})
