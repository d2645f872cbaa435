# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Running the command line, in this process and as users do."""

from dataclasses import dataclass
import json
import os
from pathlib import Path
import subprocess
import sys

from cam_motion.cli import main
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def machine_file():
    """Give the machine file of the cutting machine."""
    return ROOT / 'config' / 'cutting_machine.yaml'


@dataclass
class Done:
    """What a command line left behind."""

    returncode: int
    stdout: str
    stderr: str


@pytest.fixture
def cam_motion(capsys, monkeypatch):
    """Give a function that carries out ``cam_motion`` in this process, for speed."""
    def run(*arguments, columns='120'):
        monkeypatch.setenv('COLUMNS', columns)
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as stop:  # argparse leaves this way
            code = stop.code
        return Done(code, *capsys.readouterr())
    return run


@pytest.fixture
def process(tmp_path):
    """Give a function that runs ``cam_motion`` as users do, and returns the finished process."""
    def run(*arguments, **environment):
        return subprocess.run(
            [sys.executable, '-m', 'cam_motion', *map(str, arguments)],
            capture_output=True, text=True, timeout=50, cwd=tmp_path, check=False,
            env={**os.environ, 'PYTHONPATH': str(ROOT), **environment})
    return run


@pytest.fixture
def read_json():
    """Give a function that reads JSON strictly, without NaN and Infinity."""
    def refuse(token):
        raise AssertionError(f'{token} is no JSON')

    def read(text):
        return json.loads(text, parse_constant=refuse)
    return read
