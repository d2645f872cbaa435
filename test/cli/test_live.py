# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The display of a running line, and children that do not behave."""

from dataclasses import replace
from io import StringIO
from pathlib import Path

from cam_motion.cli.child import Child, stop_signals
from cam_motion.cli.live import Display, plain_line, render
from cam_motion.cli.overload import overloads
from cam_motion.cli.session import _recorded_topics
from cam_motion.cli.watch import Snapshot
from cam_motion.io.bag import BagWriter
from cam_motion.io.config import load_machine
import pytest
from rich.console import Console

pytestmark = pytest.mark.timeout(60)

CONFIGS = Path(__file__).resolve().parents[2] / 'config'
MACHINE = load_machine(CONFIGS / 'cutting_machine.yaml')
SEEN = Snapshot(
    time=12.5, speed_cpm=200.0, phi=33.25 * 6.283185307179586,
    axes={'feeder': (9.9, 3.25), 'press': (0.02, -0.0), 'knife': None},
    drives={'feeder_drive': (-1466.6, 1282.04)},
    health={'missed_ticks': '3', 'late_ticks': '17'})


def test_a_plain_line_says_everything():
    line = plain_line(MACHINE, SEEN)
    for part in ('12.50 s', '200 cycles/min', 'cycle 33 at  90.0 deg',
                 'feeder 9.9000 m 3.2500 m/s', 'press 0.0200 m 0.0000 m/s', 'knife - m - m/s',
                 'feeder_drive -1466.6 N m 1282.0 rpm', 'ticks missed 3, late 17'):
        assert part in line


SERVO = load_machine(CONFIGS / 'feeding_group_servo.yaml')
OVERLOADED = Snapshot(
    time=3.0, drives={'feeder_drive': (47.6, 1500.0)}, states={'feeder_drive': 'silent'},
    drive_health={'feeder_drive': {
        'saturations': '2', 'saturated_s': '0.35', 'peak_following_error': '0.104',
        'thermal_load_pct': '132.4', 'dropped_s': '0'}})


def test_a_drive_that_comes_to_its_limits_says_so():
    said = 'saturated for 0.35 s, up to 0.104 m off its set motion, motor too warm: 132.4 %'
    assert overloads(SERVO, OVERLOADED)['feeder_drive'].startswith(said)
    line = plain_line(SERVO, OVERLOADED)
    assert f'feeder_drive 47.6 N m 1500.0 rpm silent ({said}' in line
    console = Console(width=120, file=StringIO())
    console.print(render(SERVO, OVERLOADED, 'servo.yaml'))
    assert f'feeder_drive: {said}' in console.file.getvalue()


def test_a_drive_within_its_limits_says_nothing():
    well = {'saturations': '0', 'saturated_s': '0', 'peak_following_error': '2e-06',
            'thermal_load_pct': '89', 'dropped_s': '0', 'stops_under_power': '0'}
    seen = replace(OVERLOADED, states={'feeder_drive': 'following'},
                   drive_health={'feeder_drive': well})
    assert overloads(SERVO, seen) == {}
    assert plain_line(SERVO, seen).count('(') == 0
    assert 'following' not in plain_line(SERVO, seen)


def test_a_motor_that_does_not_get_its_load_round_is_named():
    press = load_machine(CONFIGS / 'cam_press_drive.yaml')
    seen = Snapshot(time=1.0, drives={'press_drive': (3.0, 0.0)},
                    states={'press_drive': 'stalled'},
                    drive_health={'press_drive': {'stops_under_power': '3'}})
    assert 'press_drive 3.0 N m 0.0 rpm stalled (stops under power: 3)' in plain_line(press, seen)


def test_a_linkage_is_shown_with_its_state_and_on_a_plain_line_unless_it_follows():
    machine = load_machine(CONFIGS / 'umbrella.yaml')
    reason = 'h1: 2.3; the linkage can be assembled from 0.2 m to 2.2 m'
    held = f'held: {reason}'
    console = Console(width=100, file=StringIO())
    console.print(render(machine, Snapshot(time=1.0, states={'umbrella': held}), 'umbrella.yaml'))
    assert f'umbrella: {reason}' in console.file.getvalue()
    assert held in plain_line(machine, Snapshot(time=1.0, states={'umbrella': held}))
    following = plain_line(machine, Snapshot(time=1.0, states={'umbrella': 'following'}))
    assert 'umbrella' not in following


def test_a_drive_that_turns_the_shaft_and_stalls_is_shown_to():
    machine = load_machine(CONFIGS / 'cam_press_drive.yaml')
    drives = {'press_drive': (4.6, 0.0)}
    for state, shown in (('stalled', True), ('running', False)):
        seen = Snapshot(time=1.0, drives=drives, states={'press_drive': state})
        assert (state in plain_line(machine, seen)) == shown
        console = Console(width=100, file=StringIO())
        console.print(render(machine, seen, 'press'))
        assert state in console.file.getvalue()


def test_the_table_fits_a_narrow_terminal():
    console = Console(width=80, record=True, file=open('/dev/null', 'w', encoding='utf-8'))
    with console.file:
        console.print(render(MACHINE, SEEN, 'machine.yaml'))
    text = console.export_text()
    assert max(map(len, text.splitlines())) <= 80
    for part in ('200.0', 'cycles/min', '90.0', '33', '3.2500', '-1466.6', 'missed 3'):
        assert part in text


def test_where_there_is_no_terminal_waiting_is_said_once_and_lines_come_slowly(capsys):
    with Display(MACHINE, 'machine.yaml') as display:
        for seen in (Snapshot(), Snapshot(), SEEN, SEEN, SEEN):
            display.show(seen)
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == ['waiting', '12.50']


@pytest.fixture
def module(tmp_path, monkeypatch):
    """Give a function that makes a module to run as a child."""
    monkeypatch.setenv('PYTHONPATH', str(tmp_path))

    def make(code):
        (tmp_path / 'some_child.py').write_text(code)
        return 'some_child'
    return make


def test_the_exit_code_and_the_lines_of_a_child_are_passed_on(module):
    lines = []
    child = Child(module('import sys; print("one", flush=True); sys.stderr.write("two\\n"); '
                         'sys.exit(sys.argv[1] == "x" and 3)'), ['x'], lines.append)
    assert child.end(20.0) == 3
    assert lines == ['one', 'two']


def test_a_child_that_does_not_stop_is_killed(module, capsys):
    started = []
    child = Child(module('import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); '
                         'print("ready", flush=True); time.sleep(60)'), [], started.append)
    while not started and not child.ended:
        pass
    child.ask_to_stop()
    assert child.end(0.3) == 1
    assert child.ended
    assert 'was killed' in capsys.readouterr().err


def test_stop_signals_are_events_and_handlers_come_back():
    import signal
    before = signal.getsignal(signal.SIGTERM)
    with stop_signals() as asked:
        signal.raise_signal(signal.SIGTERM)
        signal.raise_signal(signal.SIGINT)
        assert asked.wait(1.0)
    assert signal.getsignal(signal.SIGTERM) is before


def test_topics_with_messages_are_seen_in_a_bag_that_is_being_written(tmp_path):
    assert _recorded_topics(tmp_path / 'bag') == set()
    with BagWriter(tmp_path / 'bag') as writer:
        full = writer.add_topic('/shaft', 'std_msgs/msg/String')
        writer.add_topic('/feeder/setpoint', 'std_msgs/msg/String')
        assert _recorded_topics(tmp_path / 'bag') == set()
        writer.write(full, 1, b'\0\1\0\0\1\0\0\0\0')
        writer.flush()
        assert _recorded_topics(tmp_path / 'bag') == {'shaft'}
