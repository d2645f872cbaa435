# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a report says of a servo drive: set against actual positions of the same instants."""

from dataclasses import replace
from pathlib import Path
import struct

from cam_motion.cli import main
from cam_motion.io.bag import BagWriter
from cam_motion.io.bag.series import JointStateSeries
from cam_motion.io.config import load_machine
from cam_motion.io.findings import findings, notes
from cam_motion.io.recording import read_recording
from cam_motion.io.report import make_report
from cam_motion.io.report_data import report_as_data
from cam_motion.units import RPM
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config' / 'feeding_group_servo.yaml'
MACHINE = load_machine(CONFIG)
POINT = 'trajectory_msgs/msg/JointTrajectoryPoint'
STATE = 'sensor_msgs/msg/JointState'


def point(values, time_ns):
    return struct.pack('<4B I4xd I4xd I4xd I iI', 0, 1, 0, 0, 1, values[0], 1, values[1], 1,
                       values[2], 0, *divmod(time_ns, 10 ** 9))


@pytest.fixture
def bag_of(tmp_path):
    """Write a bag whose actual positions are off the setpoints as told, tick by tick."""
    def write(errors, ticks=200):
        path = tmp_path / 'bag'
        with BagWriter(path, custom_data={'machine': CONFIG.read_text()}) as writer:
            shaft, setpoint, actual = (writer.add_topic(name, POINT) for name in (
                '/shaft', '/feeder/setpoint', '/feeder_drive/actual'))
            writer.add_topic('/feeder_drive/drive_state', STATE)
            omega = MACHINE.master.speed
            for tick in range(ticks):
                time_ns = tick * 2_000_000
                now = (omega * time_ns * 1e-9, omega, 0.0)
                values = MACHINE.diagram.axes['feeder'].profile.at_speed(*now)
                for topic, sample in ((shaft, now), (setpoint, values)):
                    writer.write(topic, 10 ** 18 + time_ns, point(sample, time_ns))
                if tick in errors:
                    real = (values[0] - errors[tick], *values[1:])
                    writer.write(actual, 10 ** 18 + time_ns, point(real, time_ns))
        return path
    return write


def test_the_worst_following_error_is_found_though_states_are_missing(
        bag_of, capsys, monkeypatch):
    monkeypatch.setenv('COLUMNS', '120')
    path = bag_of({tick: 1e-4 * (tick - 60) for tick in range(0, 100, 3)})
    report = make_report(read_recording(path))
    assert report.drives['feeder_drive'].following_error == pytest.approx(60e-4, rel=1e-9)
    told = report_as_data(report)['drives']['feeder_drive']
    assert told['peak_following_error'] == pytest.approx(60e-4, rel=1e-9)
    assert main(['report', str(path)]) == 0
    said = capsys.readouterr().out
    assert 'peak following error' in said and '0.006 m' in said


def test_without_actual_positions_nothing_is_said_of_them(bag_of):
    report = make_report(read_recording(bag_of({})))
    assert report.drives['feeder_drive'].following_error is None
    assert 'peak_following_error' not in report_as_data(report)['drives']['feeder_drive']


@pytest.fixture
def report_of(bag_of):
    """Report a run in which the motor has had given speeds [rpm] and torques."""
    recording = read_recording(bag_of(dict.fromkeys(range(100), 1e-3)))

    def report(speeds, torques, mode='servo'):
        ticks = np.arange(len(speeds)) * 2_000_000
        states = JointStateSeries(
            names=('motor', 'load'), header_stamps_ns=ticks, stamps_ns=ticks,
            positions=np.zeros((len(speeds), 2)),
            velocities=np.array([[speed * RPM, 0.0] for speed in speeds]),
            efforts=np.array([[torque, 0.0] for torque in torques]))
        settings = MACHINE.drives['feeder_drive']
        machine = replace(recording.machine, drives={'feeder_drive': replace(
            settings, servo=settings.servo if mode == 'servo' else None)})
        return make_report(replace(
            recording, machine=machine, drives={'feeder_drive': states}))
    return report


def test_a_motor_at_its_peak_torque_is_a_finding(report_of):
    overloaded = report_of([0.0, 1000.0, 2000.0, 0.0], [3.0, 47.6, -47.5, 47.0])
    found, = findings(overloaded)
    assert found == ('feeder_drive: its motor was at its peak torque in 2 states, with 47.6 N m; '
                     'its axis was up to 0.001 m off its set position')
    assert findings(report_of([0.0, 1000.0], [3.0, 47.0])) == []


def test_beyond_the_corner_the_peak_torque_is_that_of_the_speed(report_of):
    assert len(findings(report_of([4000.0], [31.7]))) == 1  # half way from 47.6 down to 15.8
    assert findings(report_of([4000.0], [30.0])) == []


def test_a_drive_that_follows_may_ask_for_more_than_its_motor_gives(report_of):
    found, = findings(report_of([100.0, 3000.0], [47.6, -60.0], 'follow'))
    assert found == ('feeder_drive: 1 state beyond the motor: at 3000 rpm it would take 60 N m, '
                     'and the motor gives 47.6 N m')


def test_a_motor_that_is_warm_for_good_is_a_note_and_no_finding(report_of):
    warm = report_of([1000.0] * 10, [20.0] * 10)
    assert findings(warm) == []
    said = 'overheats the motor, which gives 15.8 N m for good'
    assert any(said in note for note in notes(warm))
    assert not any('overheats' in note for note in notes(report_of([1000.0] * 10, [15.0] * 10)))
