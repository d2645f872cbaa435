# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``plot``: which files it writes."""

from pathlib import Path

import pytest

pytestmark = pytest.mark.timeout(60)

SIGNATURES = {'png': b'\x89PNG', 'svg': b'<?xml', 'pdf': b'%PDF'}


def test_writes_a_picture_per_axis_and_drive_and_the_timing_diagram(
        cam_motion, read_json, machine_file, tmp_path):
    done = cam_motion('plot', machine_file, '-o', tmp_path / 'out', '--json')
    names = ['timing_diagram', 'cam_feeder', 'cam_press', 'cam_knife', 'torque_feeder_drive']
    assert done.returncode == 0, done.stderr
    files = read_json(done.stdout)['files']
    assert files == [str(tmp_path / 'out' / f'{name}.png') for name in names]
    assert all(Path(file).read_bytes().startswith(SIGNATURES['png']) for file in files)


@pytest.mark.parametrize('kind', ['svg', 'pdf'])
def test_one_axis_in_other_formats(cam_motion, machine_file, tmp_path, kind):
    done = cam_motion('plot', machine_file, '--output', tmp_path, '--axis', 'press',
                      '--format', kind)
    written = sorted(file.name for file in tmp_path.iterdir())
    assert done.returncode == 0, done.stderr
    assert written == [f'cam_press.{kind}', f'timing_diagram.{kind}']
    assert all((tmp_path / name).read_bytes().startswith(SIGNATURES[kind]) for name in written)
    assert all(str(tmp_path / name) in done.stdout for name in written)


def test_an_unknown_axis_and_an_unwritable_place_are_said(cam_motion, machine_file, tmp_path):
    done = cam_motion('plot', machine_file, '--axis', 'sword')
    assert (done.returncode, 'feeder, press, knife' in done.stderr) == (2, True)
    (tmp_path / 'file').write_text('')
    done = cam_motion('plot', machine_file, '-o', tmp_path / 'file', '--axis', 'press')
    assert done.returncode == 1
    assert 'cannot be written' in done.stderr
    assert 'Traceback' not in done.stderr
