# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The reference of what --json prints is what --json prints."""

from pathlib import Path
import re

from cam_motion.drive.sizing import RULES
from cam_motion.drive.sizing_forward import Wishes
from cam_motion.io.catalogue import load_catalogue
from cam_motion.io.config import read_sections
from cam_motion.io.machine import build_machine
from cam_motion.io.simulation import simulate
from cam_motion.io.sizing import Options, size, sizing_as_data
import pytest

pytestmark = pytest.mark.timeout(60)

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / 'doc' / 'json.md').read_text(encoding='utf-8')


def keys(title, whole=False):
    """Read the keys of a section: the first column of its tables, or every name in it."""
    section = re.search(rf'^#+ {re.escape(title)}\n(.*?)(?=^#|\Z)', TEXT,
                        re.DOTALL | re.MULTILINE)[1]
    return set(re.findall(r'`(\w+)`' if whole else r'^\| `(\w+)`', section, re.MULTILINE))


def machine_of(name, changes):
    """Build a machine of the configurations that come along, some parameters changed."""
    sections = {node: dict(given) for node, given in read_sections(
        ROOT / 'config' / f'{name}.yaml').items()}
    for node, more in changes.items():
        sections[node].update(more)
    return build_machine(sections)


@pytest.fixture(scope='module')
def press():
    return machine_of('cam_press_drive', {'press_drive': {
        'gearbox.rated_torque': 100.0, 'gearbox.max_rpm': 3000.0}})


@pytest.fixture(scope='module')
def feeder():
    return machine_of('feeding_group_servo', {'feeder_drive': {'motor.torque_constant': 0.6}})


def test_the_keys_of_simulate(press, feeder):
    follows = simulate(feeder)['feeder_drive']
    assert set(follows) == keys('simulate: a drive that follows an axis')
    assert set(follows['servo']) == keys('`servo`')
    turns = simulate(press)['press_drive']
    assert set(turns) == keys('simulate: a drive that turns a cam shaft')
    for part in ('orbit', 'start_up', 'document'):
        assert set(turns[part]) == keys(f'`{part}`')


@pytest.mark.parametrize(('name', 'title'), [
    ('press', 'a candidate that turns a cam shaft'),
    ('feeder', 'a candidate that follows an axis')])
def test_the_keys_of_size(request, name, title):
    machine = request.getfixturevalue(name)
    options = Options(ratios=(3.5525,), flywheels=(0.06,), wishes=Wishes(0.1))
    [sized] = size(machine, load_catalogue(), options).values()
    data = sizing_as_data(sized)
    assert set(data) == keys('size: a drive')
    candidates = [*data['ranked'], *data['rejected']]
    found = {key for one in candidates for key in one}
    assert found == keys('every candidate') | keys(title, whole=True) - {'simulate'}
    assert {rule for one in candidates for rule in one['margins']} <= keys('rules') == set(RULES)
    assert {key for one in candidates for broken in one.get('broke', ()) for key in broken} == {
        'rule', 'value', 'bound', 'unit', 'by_pct'}
    if name == 'press':
        assert set(data['smallest_flywheel']) == keys('`smallest_flywheel`')
