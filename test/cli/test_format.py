# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``format``: refused before anything is touched, refused by the line, carried out."""

from pathlib import Path
import signal
import subprocess
import sys
import warnings

import pytest
import yaml

with warnings.catch_warnings():
    # The first message imports a parser that imports a deprecated module.
    warnings.simplefilter('ignore', DeprecationWarning)
    pytest.importorskip('rosidl_generator_py')

pytest.importorskip('rclpy')
pytestmark = [pytest.mark.ros, pytest.mark.slow, pytest.mark.timeout(120)]

ROOT = Path(__file__).resolve().parents[2]
SHORT = ROOT / 'config' / 'cutting_machine_short.yaml'


@pytest.fixture(scope='module')
def line(reserved_domain, tmp_path_factory):
    """Run the cutting machine, in a ROS domain of its own."""
    with reserved_domain() as domain, pytest.MonkeyPatch.context() as patch:
        patch.setenv('ROS_DOMAIN_ID', str(domain))
        patch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
        patch.setenv('ROS_LOG_DIR', str(tmp_path_factory.mktemp('log')))
        process = subprocess.Popen(
            [sys.executable, '-m', 'cam_motion.start', 'line', '--ros-args', '-r', '__ns:=/hall',
             '--params-file', str(ROOT / 'config' / 'cutting_machine.yaml')], cwd=ROOT,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            yield process
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(20.0)
            except subprocess.TimeoutExpired:
                process.kill()


@pytest.fixture
def altered(tmp_path):
    """Give a function that writes the short format with other values, by dotted path."""
    def write(**changes):
        tree = yaml.safe_load(SHORT.read_text())
        for path, value in changes.items():
            node, *keys, last = path.split('__')
            place = tree[node]['ros__parameters']
            for key in keys:
                place = place[key]
            if value is None:
                del place[last]
            else:
                place[last] = value
        file = tmp_path / f'format_{len(list(tmp_path.iterdir()))}.yaml'
        file.write_text(yaml.safe_dump(tree, sort_keys=False))
        return file
    return write


def test_a_file_that_breaks_an_interlock_is_refused_without_a_line(cam_motion, altered):
    done = cam_motion('format', altered(line__cut_held__second_below=0.013))
    assert done.returncode == 2
    assert 'line.cut_held' in done.stderr and 'out of rest at once' in done.stderr


def test_without_a_line_it_says_so(cam_motion, line, monkeypatch):
    monkeypatch.setattr('cam_motion.nodes.format_client.FOUND_WITHIN', 0.5)
    done = cam_motion('format', SHORT)  # the line is in a namespace
    assert done.returncode == 1 and 'no axis is running here' in done.stderr


def test_a_dry_run_and_refusals_change_nothing_and_the_change_itself_is_told(
        cam_motion, line, altered, read_json):
    ask = ('format', '--namespace', '/hall')
    done = cam_motion(*ask, '--dry', '--at-deg', '270', SHORT)
    assert done.returncode == 0 and 'all axes would change' in done.stdout, done.stderr
    assert '0.3' in done.stdout and 'interlock cut_held: kept on the way' in done.stdout
    refusals = {
        # the same stroke elsewhere: the belt has to go there
        'interlock belt_stands would be broken on the way': (
            '--at-deg', '150', altered(feeder__feed__lift=0.3, feeder__offset=0.05)),
        'knife.dead_time': (altered(knife__dead_time=0.1),),
        'has an axis knife too': (altered(
            line__axes=['feeder', 'press'], line__interlocks=['belt_stands'],
            line__cut_held=None),),
        'slow down': ('--at-deg', '200', altered(
            knife__change={'longest_deg': 2.0, 'span_deg': 2.0})),
    }
    for words, arguments in refusals.items():
        done = cam_motion(*ask, *arguments)
        assert done.returncode in (1, 2) and words in done.stderr, (words, done)
    done = cam_motion(*ask, '--json', '--at-deg', '270', SHORT)
    assert done.returncode == 0, done.stderr
    data = read_json(done.stdout)
    assert data['outcome'] == 'changed' and data['at_deg'] == pytest.approx(270.0)
    assert data['axes']['feeder']['differences'] == {'feed.lift': [0.3, 0.2]}
    assert data['start_deg'] % 360.0 == pytest.approx(270.0)
    done = cam_motion(*ask, SHORT)
    assert done.returncode == 0 and 'nothing to change' in done.stdout
