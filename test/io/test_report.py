# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The report: bags made here, right, wrong and incomplete, and what is found in them."""

import json
import math
from pathlib import Path
import struct

from cam_motion.cli import main
from cam_motion.errors import ConfigurationError
from cam_motion.io.bag import BagError, BagWriter
from cam_motion.io.config import load_machine
from cam_motion.io.findings import findings, notes
from cam_motion.io.plots import recorded_figure, recorded_torque_figure, shaft_figure
from cam_motion.io.recording import read_recording, RecordingError
from cam_motion.io.report import make_report
from cam_motion.runtime.ticks import TickSchedule
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config' / 'cutting_machine.yaml'
MACHINE = load_machine(CONFIG)
TICKS = 1050
POINT = 'trajectory_msgs/msg/JointTrajectoryPoint'
STATE = 'sensor_msgs/msg/JointState'


def point(values, time_ns):
    """Serialise a JointTrajectoryPoint of one joint (CDR, little endian)."""
    return struct.pack('<4B I4xd I4xd I4xd I iI', 0, 1, 0, 0, 1, values[0], 1, values[1], 1,
                       values[2], 0, *divmod(time_ns, 10 ** 9))


def state(drive, time_ns):
    """Serialise a JointState with the joints motor and load."""
    head = struct.pack('<4B iI I1s3x I I6s2x I5s3x', 0, 1, 0, 0, *divmod(time_ns, 10 ** 9), 1,
                       b'\0', 2, 6, b'motor\0', 5, b'load\0')
    rows = [(drive.motor_position, drive.load_position),
            (drive.motor_velocity, drive.load_velocity),
            (drive.motor_torque, drive.load_torque)]
    for row in rows:
        head += struct.pack('<I', 2)
        head += b'\0' * (-(len(head) - 4) % 8) + struct.pack('<2d', *row)
    return head


def run_of(first=0, last=TICKS):
    """Give (time [ns], shaft state) of each tick: stand, run up, stop."""
    shaft = MACHINE.master.shaft()
    shaft.run(0.0)
    schedule = TickSchedule(500.0, 0.05)
    stopped = False
    for tick in range(first, last):
        t = schedule.time_ns(tick) * 1e-9
        if t >= 1.2 and not stopped:
            shaft.stop(t)
            stopped = True
        yield schedule.time_ns(tick), shaft.state(t)


@pytest.fixture
def write_bag(tmp_path):
    """Give a function that writes a bag; ``change`` may alter or drop (None) any message."""
    def write(change=lambda topic, tick, values: values, config=True, holds=True, topics=None,
              first=0, last=TICKS, name='bag'):
        path = tmp_path / name
        custom = {'machine': CONFIG.read_text()} if config else None
        with BagWriter(path, custom_data=custom) as writer:
            wanted = topics or ['shaft', *(f'{a}/setpoint' for a in MACHINE.diagram.axes)]
            handles = {topic: writer.add_topic(f'/{topic}', POINT) for topic in wanted}
            drive = writer.add_topic('/feeder_drive/drive_state', STATE)

            def put(topic, tick, time_ns, values):
                values = change(topic, tick, values)
                if values is not None and topic in handles:
                    writer.write(handles[topic], 10 ** 18 + time_ns, point(values, time_ns))

            for tick, (time_ns, now) in enumerate(run_of(first, last), start=first):
                put('shaft', tick, time_ns, now)
                for axis in MACHINE.diagram.axes.values():
                    setpoint = axis.profile.at_speed(*now)
                    put(f'{axis.name}/setpoint', tick, time_ns, setpoint)
                    if axis.name == 'feeder':
                        figures = MACHINE.drives['feeder_drive'].drive.follow(*setpoint)
                        writer.write(drive, 10 ** 18 + time_ns, state(figures, time_ns))
            for axis in MACHINE.diagram.axes.values() if holds else ():
                hold = (axis.profile.at_speed(*now)[0], 0.0, 0.0)
                put(f'{axis.name}/setpoint', last, time_ns, hold)
        return path
    return write


@pytest.fixture
def report_of(write_bag):
    """Give a function that writes a bag and reports on it."""
    return lambda *args, **options: make_report(read_recording(write_bag(*args, **options)))


def altered(topic, tick, **columns):
    """Make a change of one message: {position|velocity|acceleration}=function."""
    names = ('position', 'velocity', 'acceleration')

    def change(at, number, values):
        if (at, number) != (topic, tick):
            return values
        return tuple(columns.get(name, float)(value) for name, value in zip(names, values))
    return change


def dropped(topic, *ticks):
    """Make a change that drops messages."""
    return lambda at, number, values: None if at == topic and number in ticks else values


def test_a_correct_bag_has_no_findings(report_of):
    report = report_of()
    assert (findings(report), notes(report)) == ([], [])
    assert (report.ticks.recorded, report.ticks.expected, report.ticks.missed) == (
        TICKS, TICKS, 0)
    assert report.duration == pytest.approx((TICKS - 1) / 500.0)
    for axis in report.axes.values():
        assert (axis.setpoints, axis.holds, axis.unanswered, axis.unpaired) == (TICKS, 1, 0, 0)
        assert max(axis.deviations) <= 1e-12
    shaft = MACHINE.master.shaft()
    assert report.top_speed == pytest.approx(shaft.speed)
    assert report.axes['feeder'].peaks[0] == pytest.approx(9.0, rel=0.01)


def test_drive_figures_are_those_of_the_states(report_of):
    drive = report_of().drives['feeder_drive']
    feeder = MACHINE.diagram.axes['feeder'].profile
    torques = [MACHINE.drives['feeder_drive'].drive.follow(*feeder.at_speed(*now)).motor_torque
               for _, now in run_of()]
    assert drive.states == TICKS
    assert drive.peak_torque == pytest.approx(max(map(abs, torques)), rel=1e-12)
    assert 0.0 < drive.rms_torque < drive.peak_torque
    assert drive.peak_speed == pytest.approx(2.0 * 9.0 / 0.134, rel=0.01)


@pytest.mark.parametrize('column, slip', [
    ('position', 1e-6), ('velocity', 1e-5), ('acceleration', 1e-3)])
def test_one_wrong_setpoint_among_all_is_found(report_of, column, slip):
    report = report_of(altered('press/setpoint', 444, **{column: lambda value: value + slip}))
    found = findings(report)
    assert len(found) == 1
    assert found[0].startswith(f'press: {column} off the exact curve')
    assert '(1 setpoint off by more than 1e-9)' in found[0]
    assert max(report.axes['feeder'].deviations) <= 1e-12


def test_the_term_with_the_shaft_acceleration_is_missed_when_left_out(report_of):
    axis = MACHINE.diagram.axes['knife']
    states = dict(enumerate(now for _, now in run_of()))

    def without_alpha(topic, tick, values):
        if topic != 'knife/setpoint' or tick not in states:
            return values
        return axis.profile.at_speed(states[tick].phi, states[tick].omega, 0.0)
    found = findings(report_of(without_alpha))
    assert [text.split(' off')[0] for text in found] == ['knife: acceleration']


def test_a_value_that_is_no_number_is_a_finding(report_of):
    found = findings(report_of(altered('knife/setpoint', 300, velocity=lambda _: math.nan)))
    assert found[0].startswith('knife: velocity off the exact curve by inf')


def test_an_unanswered_tick_is_a_finding(report_of):
    report = report_of(dropped('feeder/setpoint', 250, 251))
    assert report.axes['feeder'].unanswered == 2
    assert findings(report) == ['feeder: 2 shaft ticks without a setpoint, the first at 0.5 s']


def test_a_missed_tick_is_counted_but_no_finding_when_none_was_left_unanswered(report_of):
    def drop(topic, tick, values):
        return None if tick in (100, 101, 500) else values
    report = report_of(drop)
    assert (report.ticks.recorded, report.ticks.expected) == (TICKS - 3, TICKS)
    assert report.ticks.gaps == ((pytest.approx(0.198), 2), (pytest.approx(0.998), 1))
    assert findings(report) == []
    assert '3 shaft ticks missed in 2 gaps, the longest of 2 behind 0.198 s' in notes(report)


def test_a_setpoint_without_its_shaft_point_is_a_finding(report_of):
    found = findings(report_of(dropped('shaft', 333)))
    assert found == [f'{axis}: 1 setpoint for which the bag has no shaft point'
                     for axis in MACHINE.diagram.axes]


@pytest.mark.parametrize('columns', [
    {'position': lambda value: value + 1e-3}, {'velocity': lambda _: 0.1},
    {'acceleration': lambda _: -1e-6}])
def test_only_exact_holds_are_set_aside(report_of, columns):
    found = findings(report_of(altered('press/setpoint', TICKS, **columns)))
    assert 'press: 1 setpoint repeat a tick without being a hold' in found


def test_a_recorder_that_begins_and_ends_while_the_line_runs_is_no_finding(report_of):
    def late(topic, tick, values):
        heard = topic == 'shaft' or 120 <= tick < 400
        return values if heard else None
    report = report_of(late, first=100, last=402, holds=False)
    assert findings(report) == []
    assert report.axes['knife'].unheard == 22
    assert report.axes['knife'].unanswered == 0


def test_an_axis_that_falls_silent_is_a_finding(report_of):
    silent = dropped('knife/setpoint', *range(300, TICKS + 1))
    assert findings(report_of(silent)) == [
        f'knife: {TICKS - 300} shaft ticks without a setpoint, the first at 0.6 s']


def test_an_axis_that_was_not_recorded_is_a_finding(report_of):
    found = findings(report_of(topics=['shaft', 'feeder/setpoint', 'press/setpoint']))
    assert found == ['knife: the bag has no setpoints of it']


def test_bags_that_hold_no_run_are_said(write_bag, tmp_path):
    with pytest.raises(RecordingError, match='holds no shaft'):
        read_recording(write_bag(topics=['feeder/setpoint'], name='without'))
    with pytest.raises(RecordingError, match='no shaft point was recorded'):
        read_recording(write_bag(dropped('shaft', *range(TICKS)), name='empty'))
    with pytest.raises(ConfigurationError, match='--config'):
        read_recording(write_bag(config=False, name='bare'))
    recording = read_recording(tmp_path / 'bare', CONFIG)
    assert recording.setpoints.keys() == MACHINE.diagram.axes.keys()
    with pytest.raises(BagError, match='does not exist'):
        read_recording(tmp_path / 'nowhere')


def test_a_cut_off_bag_is_read_as_far_as_it_goes(write_bag):
    path = write_bag()
    file = next(path.glob('*.mcap'))
    file.write_bytes(file.read_bytes()[:-5000])
    recording = read_recording(path)
    assert recording.incomplete
    assert 'the bag is incomplete' in notes(make_report(recording))[0]


def test_verb_exits_with_0_or_1_and_its_json_says_the_same(write_bag, capsys, tmp_path):
    assert main(['report', str(write_bag()), '--json', '-o', str(tmp_path / 'out')]) == 0
    data = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert data['ticks']['recorded'] == data['ticks']['expected'] == TICKS
    assert data['axes']['knife']['deviation']['acceleration'] <= 1e-9
    assert data['messages']['/shaft'] == TICKS
    assert [Path(file).name for file in data['files']] == [
        'shaft_speed.png', 'recorded_versus_exact.png', 'torque_over_speed.png']
    assert all(Path(file).stat().st_size > 10_000 for file in data['files'])
    wrong = write_bag(dropped('press/setpoint', 99), name='wrong')
    assert main(['report', str(wrong)]) == 1
    assert 'FINDING: press: 1 shaft tick without a setpoint' in capsys.readouterr().out
    assert main(['report', str(tmp_path / 'nowhere')]) == 1
    assert 'does not exist' in capsys.readouterr().err


def test_pictures_show_the_recorded_figures(report_of):
    report = report_of(altered('press/setpoint', 444, position=lambda value: value + 1e-6))
    panels = recorded_figure(report).axes
    assert [panels[3 * row].get_ylabel() for row in range(4)] == [
        'feeder\ny [m]', 'press\ny [m]', 'knife\ny [m]', 'deviation / peak\n[−]']
    assert panels[4].get_ylabel() == 'ẏ [m/s]'
    assert panels[11].get_xlabel() == 'shaft angle φ [deg]'
    worst = max(line.get_ydata().max() for line in panels[9].lines if line.get_marker() == '.')
    assert worst == pytest.approx(5e-5, rel=1e-6)
    plane = recorded_torque_figure(report, 'feeder_drive').axes[0]
    assert np.array_equal(plane.lines[-1].get_ydata(), report.drives['feeder_drive'].motor_torque)
    upper, lower = shaft_figure(report).axes
    assert upper.get_ylabel() == 'speed ω [cycles/min]'
    assert upper.lines[0].get_ydata().max() == pytest.approx(200.0)
    assert lower.get_xlabel() == 'time on the machine [s]'
