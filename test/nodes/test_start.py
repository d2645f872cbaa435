# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""How processes begin and end: told to end during their imports, and with their work done."""

import signal
import subprocess
import sys

import pytest

pytestmark = pytest.mark.timeout(60)

# the module of the node is imported for as long as it takes to be told to end
SLOW = """
import sys, time
from cam_motion import start
assert 'numpy' not in sys.modules and 'rclpy' not in sys.modules
def slow(name):
    print(name, flush=True)
    time.sleep(40.0)
start.import_module = slow
start.master_shaft()
"""


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_before_a_node_is_there_ends_it_without_a_word(number):
    with subprocess.Popen([sys.executable, '-c', SLOW], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE) as process:
        assert process.stdout.readline() == 'cam_motion.nodes.master_shaft\n'
        process.send_signal(number)
        out, err = process.communicate(timeout=30)
    assert (process.returncode, out, err) == (0, '', '')


@pytest.mark.parametrize('verb', ['line', 'record'])
def test_a_verb_that_goes_on_until_it_is_told_obeys_as_early(verb):
    code = SLOW.replace('start.master_shaft()', f"""
sys.argv = ['cam_motion', {verb!r}]
import importlib
importlib.import_module = slow
start.command_line()""")
    with subprocess.Popen([sys.executable, '-c', code], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE) as process:
        assert process.stdout.readline() == f'cam_motion.cli.{verb}\n'
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert (process.returncode, out, err) == (0, '', '')


def test_what_is_torn_down_at_the_end_cannot_spoil_the_exit_code():
    """As threads of DDS can, which the interpreter does not know."""
    code = 'import atexit, os, sys; from cam_motion.start import leave; ' \
           'atexit.register(os.abort); print("done"); sys.stderr.write("said"); leave(3)'
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, timeout=30,
                          check=False)
    assert (done.returncode, done.stdout, done.stderr) == (3, 'done\n', 'said')
