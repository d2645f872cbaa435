# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The command line as a process of its own: exit codes, streams, pipes that close early."""

import subprocess
import sys

import pytest

pytestmark = pytest.mark.timeout(60)


def test_a_good_file_exits_with_0_and_says_nothing_on_stderr(process, machine_file):
    done = process('check', machine_file)
    assert (done.returncode, done.stderr) == (0, '')
    assert 'highest speed 220.2 cycles/min' in done.stdout


def test_a_missing_file_exits_with_2_and_json_stays_on_stdout(process, read_json):
    done = process('check', 'nowhere.yaml', '--json')
    data = read_json(done.stdout)
    assert (done.returncode, done.stderr) == (2, '')
    assert [problem['path'] for problem in data['problems']] == ['nowhere.yaml']
    assert data['axes'] == {}


def test_a_wrong_verb_exits_with_2(process):
    done = process('fly')
    assert done.returncode == 2
    assert 'usage: cam_motion' in done.stderr


@pytest.mark.parametrize('arguments', [['check', '--json'], ['check'], ['laws']])
def test_a_reader_that_leaves_is_no_error(machine_file, arguments):
    verb, *options = arguments
    source = [] if verb == 'laws' else [str(machine_file)]
    writer = subprocess.Popen(
        [sys.executable, '-m', 'cam_motion', verb, *source, *options],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=machine_file.parents[1])
    writer.stdout.close()
    stderr = writer.stderr.read()
    writer.stderr.close()
    assert writer.wait(30) == 0
    assert stderr == b''


@pytest.mark.parametrize('verb', [['line'], ['record', '-o', 'bag']])
def test_without_rclpy_the_live_verbs_name_the_ways_to_get_it(process, machine_file, verb):
    """A site of its own hides rclpy, as on a machine without ROS."""
    blocked = 'import sys, runpy; sys.modules["rclpy"] = None; sys.argv[0] = "cam_motion"; ' \
              'from cam_motion.cli import main; sys.exit(main())'
    done = subprocess.run(
        [sys.executable, '-c', blocked, verb[0], str(machine_file), *verb[1:]],
        capture_output=True, text=True, timeout=50, cwd=machine_file.parents[1], check=False)
    assert done.returncode == 1
    assert len(done.stderr.splitlines()) == 1
    assert 'ROS 2 Jazzy' in done.stderr
    assert 'make' in done.stderr


def test_verbs_without_ros_do_not_import_it(machine_file):
    code = 'import sys; from cam_motion.cli import main; main(["check", sys.argv[1]]); ' \
           'sys.exit(any(m in sys.modules for m in ("rclpy", "matplotlib", "rosbags")))'
    done = subprocess.run([sys.executable, '-c', code, str(machine_file)], timeout=50,
                          cwd=machine_file.parents[1], capture_output=True, check=False)
    assert done.returncode == 0


@pytest.mark.parametrize('verb', ['laws', 'check', 'line'])
def test_a_verb_does_not_wait_for_what_only_others_need(machine_file, verb):
    code = 'import sys; from cam_motion.cli import build_parser; build_parser(sys.argv[1]); ' \
           'sys.exit(any(m in sys.modules for m in ("scipy", "cam_motion.cli.size")))'
    done = subprocess.run([sys.executable, '-c', code, verb], timeout=50,
                          cwd=machine_file.parents[1], capture_output=True, check=False)
    assert done.returncode == 0
