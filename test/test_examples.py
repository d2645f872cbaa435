# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The examples run as a user runs them, and print what the README shows and the sources say."""

import os
from pathlib import Path
import re
import subprocess
import sys

import pytest

pytestmark = pytest.mark.timeout(60)

ROOT = Path(__file__).resolve().parents[1]
README = ROOT / 'README.md'
EXAMPLES = sorted((ROOT / 'examples').glob('[0-9][0-9]_*.py'))

# What the source documents give, to be found in the output in this order.
FIGURES = {
    '01_one_cam.py': [  # document 000
        'at  75.0 deg:  1.8169011382 deg', 'at  90.0 deg: 10.0000000000 deg',
        'at 150.0 deg: 20.0000000000 deg', 'at 210.0 deg: 10.0000000000 deg',
        'at 240.0 deg:  0.0000000000 deg',
        'rise: velocity +0.666667 deg/deg, acceleration +2.000000 rad/rad² at 75.0 deg',
    ],
    '02_timing_diagram.py': [  # document 001; Ca = 8 pi / (2 + pi) of the modified trapezoid
        'feeder feed :  +9.000 m/s,  +329.95 m/s²', 'press  press:  +1.067 m/s,   +69.52 m/s²',
        'press  lift :  -1.067 m/s,   -69.52 m/s²', 'knife  cut  :  +2.400 m/s,   +87.99 m/s²',
        'knife  back :  -3.200 m/s,  -156.42 m/s²',
        'highest speed 220.21 cycles/min: the acceleration of feeder, feed',
    ],
}


def is_live(example):
    """Say whether an example starts nodes."""
    return 'import rclpy' in example.read_text(encoding='utf-8')


def output_of(example, folder, domain):
    """Run an example from another folder and return what it prints."""
    path = os.pathsep.join(filter(None, [str(ROOT), os.environ.get('PYTHONPATH')]))
    environment = os.environ | {
        'PYTHONPATH': path, 'PYTHONIOENCODING': 'utf-8', 'MPLBACKEND': 'Agg',
        'ROS_DOMAIN_ID': str(domain), 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
    }
    if not is_live(example):
        environment['PYTHONWARNINGS'] = 'error'
    done = subprocess.run([sys.executable, str(example)], capture_output=True, encoding='utf-8',
                          env=environment, cwd=folder, timeout=50, check=False)
    assert done.returncode == 0, done.stderr
    if not is_live(example):
        assert done.stderr == ''  # nodes log there
    return done.stdout


def shown(readme, example):
    """Give the text block that follows the example's path in a README; None without one."""
    found = re.search(
        re.escape(example) + r'(?:(?!examples/\d\d_).)*?^```text\n(.*?)^```$',
        readme, re.DOTALL | re.MULTILINE)
    return found and found.group(1)


def test_the_course_is_numbered_without_a_gap():
    assert [int(path.name[:2]) for path in EXAMPLES] == list(range(1, len(EXAMPLES) + 1))
    assert set(FIGURES) <= {path.name for path in EXAMPLES}


@pytest.mark.parametrize('example', [
    pytest.param(path, marks=[pytest.mark.ros] if is_live(path) else []) for path in EXAMPLES
], ids=lambda path: path.stem)
def test_an_example_prints_what_the_readme_shows_and_the_sources_say(
        example, domain, tmp_path):
    if is_live(example):
        pytest.importorskip('rclpy')
    printed = output_of(example, tmp_path, domain)
    assert printed.strip()
    place = -1
    for line in FIGURES.get(example.name, []):
        assert line in printed
        assert printed.index(line) > place
        place = printed.index(line)
    readme = README.read_text(encoding='utf-8') if README.exists() else ''
    block = shown(readme, f'examples/{example.name}')
    if block is not None:
        assert printed == block


@pytest.mark.parametrize('example', EXAMPLES, ids=lambda path: path.stem)
def test_an_example_says_in_its_first_sentence_what_it_shows(example):
    lines = example.read_text(encoding='utf-8').splitlines()
    code = [line for line in lines if line.strip() and not line.startswith('#')]
    assert code[0].startswith('"""') and code[0].endswith('."""')


def test_the_text_block_of_an_example_is_found_in_a_readme():
    readme = ('See `examples/01_a.py`:\n\n```python\nprint(1)\n```\n\n```text\none\n1\n```\n\n'
              'and [examples/02_b.py](examples/02_b.py), then examples/03_c.py\n```text\n3\n```\n')
    assert shown(readme, 'examples/01_a.py') == 'one\n1\n'
    assert shown(readme, 'examples/02_b.py') is None
    assert shown(readme, 'examples/03_c.py') == '3\n'
    assert shown(readme, 'examples/04_d.py') is None
