# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What the tests of packaging look at: the tree, its files and the arguments of setup.py."""

import os
from pathlib import Path
import runpy
import subprocess

import pytest
import setuptools

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope='session')
def root():
    """Return the root of the repository."""
    return ROOT


@pytest.fixture(scope='session')
def files():
    """Return the files of the repository, without what git ignores."""
    listed = subprocess.run(
        ['git', 'ls-files', '-z', '--cached', '--others', '--exclude-standard'],
        cwd=ROOT, capture_output=True, text=True, timeout=20)
    if listed.returncode:
        pytest.skip('not a git checkout')
    paths = [ROOT / name for name in listed.stdout.split('\0') if name]
    return [path for path in paths if path.is_file()]


@pytest.fixture(scope='session')
def setup_arguments():
    """Return what setup.py passes to setuptools."""
    arguments = {}
    before, genuine = os.getcwd(), setuptools.setup
    try:
        os.chdir(ROOT)
        setuptools.setup = lambda **given: arguments.update(given)
        runpy.run_path('setup.py')
    finally:
        setuptools.setup = genuine
        os.chdir(before)
    return arguments
