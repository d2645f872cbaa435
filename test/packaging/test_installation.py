# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""`pip install` must lay out what ros2 and a shell look for, as colcon does."""

import os
from pathlib import Path
import shutil
import subprocess
import sys

import pytest

NOT_THE_PACKAGE = shutil.ignore_patterns(
    '.*', 'build', 'install', 'log', 'out', '*.egg-info', '__pycache__', 'test')


@pytest.fixture(scope='module')
def commands(setup_arguments):
    """Return the names of the commands setup.py declares."""
    scripts = setup_arguments['entry_points']['console_scripts']
    return {script.split('=')[0].strip() for script in scripts}


@pytest.fixture(scope='module')
def prefix(root, tmp_path_factory):
    """Install a copy of the tree under a prefix of its own; return the prefix."""
    if sys.prefix == sys.base_prefix:
        pytest.skip('needs a virtual environment, as `make test` uses')
    place = tmp_path_factory.mktemp('installation')
    shutil.copytree(root, place / 'tree', ignore=NOT_THE_PACKAGE)
    subprocess.run(
        [sys.executable, '-m', 'pip', 'install', '--quiet', '--disable-pip-version-check',
         '--no-deps', '--no-build-isolation', '--ignore-installed', '--no-warn-script-location',
         '--prefix', str(place / 'prefix'), str(place / 'tree')],
        check=True, timeout=50)
    return place / 'prefix'


def installed(prefix):
    """Return the folder of the installed module."""
    return next(prefix.glob('lib/python*/site-packages/cam_motion'))


def names(folder, pattern='*'):
    """Return the relative paths of a folder's files."""
    files = {path.relative_to(folder) for path in folder.rglob(pattern) if path.is_file()}
    return {path for path in files if '__pycache__' not in path.parts}


@pytest.mark.timeout(60)
def test_the_module_is_whole(root, prefix):
    wanted = {path for kind in ('*.html', '*.py', '*.yaml', 'py.typed')
              for path in names(root / 'cam_motion', kind)}
    assert names(installed(prefix)) == wanted


@pytest.mark.timeout(60)
def test_the_ament_index_knows_the_package(prefix):
    assert (prefix / 'share/ament_index/resource_index/packages/cam_motion').is_file()


@pytest.mark.timeout(60)
def test_share_has_manifest_machines_and_launch_files(root, prefix):
    wanted = {Path('package.xml'), Path('README.md')}
    wanted |= {path.relative_to(root) for path in (root / 'config').glob('*.yaml')}
    wanted |= {path.relative_to(root) for path in (root / 'launch').glob('*.*')}
    assert names(prefix / 'share/cam_motion') == wanted


@pytest.mark.timeout(60)
def test_each_command_is_in_bin_and_where_ros2_run_looks(prefix, commands):
    library = prefix / 'lib/cam_motion'
    assert {path.name for path in library.iterdir()} == commands
    for name in commands:
        assert os.access(library / name, os.X_OK) and os.access(prefix / 'bin' / name, os.X_OK)


@pytest.mark.timeout(60)
@pytest.mark.parametrize('command', ['bin/cam_motion', 'lib/cam_motion/cam_motion'])
def test_an_installed_command_runs_the_installed_module(prefix, tmp_path, command):
    where = tmp_path / 'sitecustomize.py'
    where.write_text(
        'import atexit, sys\n'
        'atexit.register(lambda: print("FROM", sys.modules["cam_motion"].__file__))\n')
    path = os.pathsep.join([str(tmp_path), str(installed(prefix).parent)])
    result = subprocess.run(
        [prefix / command, '--help'], cwd=tmp_path, env={**os.environ, 'PYTHONPATH': path},
        stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=30)
    assert result.returncode == 0, result.stderr
    assert f'FROM {installed(prefix)}' in result.stdout


def test_scripts_are_executable_and_match_the_entry_points(root, commands):
    scripts = list((root / 'scripts').iterdir())
    assert {path.name for path in scripts} == commands
    for path in scripts:
        text = path.read_text()
        assert os.access(path, os.X_OK), path
        assert text.startswith('#!/bin/sh\n') and f'/../../bin/{path.name}"' in text, path


def test_scripts_import_what_the_entry_points_name(root, setup_arguments):
    for entry in setup_arguments['entry_points']['console_scripts']:
        name, _, target = entry.partition(' = ')
        module, _, function = target.partition(':')
        line = f'from {module} import {function}; sys.exit({function}())'
        assert line in (root / 'scripts' / name).read_text()


@pytest.mark.parametrize('present', [True, False], ids=['with bin/line', 'without'])
def test_a_script_becomes_its_command_or_else_python3(root, tmp_path, present):
    library, commands = tmp_path / 'lib/cam_motion', tmp_path / 'bin'
    library.mkdir(parents=True)
    commands.mkdir()
    shutil.copy(root / 'scripts/line', library)
    for name in ['python3', 'line'] if present else ['python3']:
        (commands / name).write_text(f'#!/bin/sh\necho {name} "$@"\n')
        (commands / name).chmod(0o755)
    result = subprocess.run(
        [library / 'line', 'one', 'two words'], capture_output=True, text=True, timeout=10,
        env={'PATH': f'{commands}:{os.defpath}'})
    first, _, rest = result.stdout.strip().partition(' ')
    assert first == ('line' if present else 'python3')
    assert rest.endswith('one two words')
