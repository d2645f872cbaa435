# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A node that is told to end while it is still being imported."""

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
