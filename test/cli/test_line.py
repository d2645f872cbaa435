# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verbs ``line`` and ``record`` with real nodes: recording, signals, exit codes."""

import os
from pathlib import Path
import signal
import subprocess
import sys
import time

from cam_motion.io.recording import read_recording
import pytest

pytest.importorskip('rclpy')
pytestmark = [pytest.mark.ros, pytest.mark.slow, pytest.mark.timeout(120)]

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def start(domain, tmp_path):
    """Give a function that starts ``cam_motion`` in a ROS domain of its own."""
    running = []
    environment = {
        **os.environ, 'PYTHONPATH': str(ROOT), 'ROS_LOG_DIR': str(tmp_path / 'log'),
        'ROS_DOMAIN_ID': str(domain), 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}

    def run(*arguments):
        process = subprocess.Popen(
            [sys.executable, '-m', 'cam_motion', *map(str, arguments)], cwd=tmp_path, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment)
        running.append(process)
        return process
    yield run
    for process in running:
        if process.poll() is None:
            process.kill()
        process.communicate()


def children_of(process):
    """Give the process ids of the nodes that a process has started."""
    return [int(pid) for pid in Path(
        f'/proc/{process.pid}/task/{process.pid}/children').read_text().split()]


def wait_for(line, *words):
    """Read lines until one holds all words."""
    for text in line.stdout:
        if all(word in text for word in words):
            return text
    raise AssertionError(f'ended before {words}: {line.stderr.read()}')


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_a_recorded_line_begins_at_rest_and_reaches_its_speed(
        start, read_json, machine_file, tmp_path, storage):
    bag = tmp_path / 'bag'
    line = start('line', machine_file, '--seconds', '2', '--record', bag, '--storage', storage,
                 '--speed-cpm', '120', '--json')
    out, err = line.communicate(timeout=90)
    assert line.returncode == 0, err
    summary = read_json(out)
    assert summary['exit_code'] == 0
    assert summary['seconds'] == pytest.approx(2.0, abs=0.5)
    recording = read_recording(bag)
    assert not recording.incomplete
    assert recording.shaft.velocity[0] == 0.0 == recording.shaft.position[0]
    assert recording.shaft.velocity.max() == pytest.approx(120.0 * 6.283185307179586 / 60.0)
    assert all(len(track) > 500 for track in recording.setpoints.values())


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_line_cleanly(start, machine_file, number):
    line = start('line', machine_file)
    wait_for(line, 'cycles/min', 'feeder')
    nodes = children_of(line)
    assert nodes
    line.send_signal(number)
    _, err = line.communicate(timeout=40)
    assert line.returncode == 0, err
    assert not any(Path(f'/proc/{pid}').exists() for pid in nodes)


def test_a_line_that_dies_is_no_success(start, machine_file):
    line = start('line', machine_file)
    wait_for(line, 'cycles/min', 'feeder')
    os.kill(children_of(line)[0], signal.SIGKILL)
    _, err = line.communicate(timeout=40)
    assert line.returncode == 1
    assert 'line was ended by signal 9 (Killed)' in err


def test_record_stops_after_its_time(start, read_json, machine_file, tmp_path):
    began = time.monotonic()
    record = start('record', machine_file, '-o', tmp_path / 'bag', '--seconds', '3', '--json')
    out, err = record.communicate(timeout=60)
    assert record.returncode == 0, err
    assert read_json(out)['exit_code'] == 0
    assert time.monotonic() - began >= 3.0
    assert (tmp_path / 'bag' / 'metadata.yaml').exists()


def test_what_cannot_run_is_refused_before_anything_starts(start, machine_file, tmp_path):
    for arguments in (['line', machine_file, '--record', tmp_path],
                      ['record', machine_file, '-o', tmp_path],
                      ['line', machine_file, '--speed-cpm', '300'], ['line', 'nowhere.yaml']):
        refused = start(*arguments)
        out, err = refused.communicate(timeout=30)
        assert (refused.returncode, out) == (2, '')
        assert 'Traceback' not in err
    assert not (tmp_path / 'log').exists()
