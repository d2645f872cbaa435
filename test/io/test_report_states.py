# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The report of a run whose axes were not on the curve of their machine file all the time."""

from pathlib import Path
import struct

from cam_motion.io.axis import build_axis
from cam_motion.io.axis_states import durations, OTHER, spells_of, within
from cam_motion.io.bag import BagWriter
from cam_motion.io.config import read_sections
from cam_motion.io.findings import findings, notes
from cam_motion.io.machine import build_machine
from cam_motion.io.recording import read_recording
from cam_motion.io.report import make_report
from cam_motion.io.report_data import report_as_data
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config'
POINT, TEXT = 'trajectory_msgs/msg/JointTrajectoryPoint', 'std_msgs/msg/String'
EPOCH = 10 ** 18
PERIOD_NS = 2_000_000
OMEGA = 20.0
SECOND = 10 ** 9


def point(values, time_ns):
    """Serialise a JointTrajectoryPoint of one joint (CDR, little endian)."""
    return struct.pack('<4B I4xd I4xd I4xd I iI', 0, 1, 0, 0, 1, values[0], 1, values[1], 1,
                       values[2], 0, *divmod(time_ns, SECOND))


def text(words):
    """Serialise a String."""
    return struct.pack('<4B I', 0, 1, 0, 0, len(words) + 1) + words.encode() + b'\0'


@pytest.fixture
def report_of(tmp_path):
    """Give a function that records 3 s at 20 rad/s and reports on it."""
    sections = read_sections(CONFIG / 'cutting_machine.yaml')
    machine = build_machine(sections)

    def write(states, setpoint):
        with BagWriter(tmp_path / 'bag', custom_data={
                'machine': (CONFIG / 'cutting_machine.yaml').read_text()}) as writer:
            topics = {name: writer.add_topic(f'/{name}', kind) for name, kind in (
                ('shaft', POINT), ('press/state', TEXT),
                *((f'{axis}/setpoint', POINT) for axis in machine.diagram.axes))}
            waiting = [(0.0, 'waiting'), (0.0, 'in_sync'), *states]
            for tick in range(1500):
                time_ns = tick * PERIOD_NS
                shaft = (OMEGA * time_ns * 1e-9, OMEGA, 0.0)
                writer.write(topics['shaft'], EPOCH + time_ns, point(shaft, time_ns))
                for name, axis in machine.diagram.axes.items():
                    values = axis.profile.at_speed(*shaft)
                    if name == 'press':
                        values = setpoint(time_ns * 1e-9, shaft, values)
                    if values is not None:
                        writer.write(topics[f'{name}/setpoint'], EPOCH + time_ns + 1000,
                                     point(values, time_ns))
                while waiting and waiting[0][0] * 1e9 <= time_ns:
                    writer.write(topics['press/state'], EPOCH + time_ns + 2000,
                                 text(waiting.pop(0)[1]))
        return make_report(read_recording(tmp_path / 'bag'))
    return write


def test_a_run_without_incidents_is_reported_as_ever(report_of):
    report = report_of([], lambda t, shaft, values: values)
    assert findings(report) == [] and report.axes['press'].elsewhere == {}
    assert 'elsewhere_s' not in report_as_data(report)['axes']['press']
    assert len(report.axes['press'].comparison.phi) == 1500


def test_a_changed_format_is_told_and_not_held_against_the_axis(report_of):
    new = build_axis('press', read_sections(CONFIG / 'cutting_machine_short.yaml')['press'])
    report = report_of(
        [(1.0, 'changing'), (1.5, 'in_sync')],
        lambda t, shaft, values: values if t < 1.0 else new.profile.at_speed(*shaft))
    assert findings(report) == []
    told, = [note for note in notes(report) if note.startswith('press')]
    assert told == ('press: not compared with the machine file for 0.5 s changing, 1.5 s in sync '
                    'on other couplings')
    assert 400 < len(report.axes['press'].comparison.phi) < 500
    assert report_as_data(report)['axes']['press']['elsewhere_s']['changing'] == (
        pytest.approx(0.5, abs=1e-6))


def test_what_is_wrong_beside_the_incident_is_still_found(report_of):
    report = report_of(
        [(1.0, 'stopping_on_curve'), (1.2, 'held'), (1.5, 'waiting'), (1.6, 'engaging'),
         (2.0, 'in_sync')],
        lambda t, shaft, values: None if 1.0 <= t <= 1.5 else (
            values[0] + 1e-6 * (abs(t - 2.5) < 1e-3), *values[1:]))
    found = findings(report)
    assert len(found) == 1 and '1 setpoint off by more' in found[0]
    assert report.axes['press'].elsewhere == pytest.approx(
        {'stopping_on_curve': 0.2, 'held': 0.3, 'waiting': 0.1, 'engaging': 0.4}, abs=1e-6)


def test_a_fault_is_a_finding(report_of):
    report = report_of([(2.0, 'fault')], lambda t, shaft, values: values)
    assert findings(report) == ['press: it went into fault']


def test_spells():
    states = [(0, 'unconfigured'), (1, 'waiting'), (2, 'in_sync'), (5, 'inactive')]
    assert spells_of(states) == ()
    states = [(0, 'disengaged'), (1, 'waiting'), (2, 'engaging'), (4, 'in_sync'),
              (7, 'changing'), (8, 'in_sync')]
    assert [spell[:2] + (spell.what,) for spell in spells_of(states)][:4] == [
        (0, 1, 'disengaged'), (1, 2, 'waiting'), (2, 4, 'engaging'), (7, 8, 'changing')]
    assert spells_of(states)[-1].what == OTHER
    assert spells_of(states[:4], relative=True)[-1].what == OTHER
    assert durations(spells_of(states), 10 * SECOND)['engaging'] == pytest.approx(2e-9)
    stamps = np.array([0, SECOND, 2 * SECOND])
    spells = spells_of([(SECOND, 'changing'), (SECOND + 1, 'in_sync')])[:1]
    assert within(spells, stamps).tolist() == [False, True, False]
