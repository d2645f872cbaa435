# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Reading machine files: what is understood, what is refused, and that nothing escapes."""

import copy
import json
import math
from pathlib import Path

from cam_motion.errors import ConfigurationError
from cam_motion.io.axis import build_axis
from cam_motion.io.config import load_machine, parse_sections, read_sections
from cam_motion.io.plain import to_json
from cam_motion.io.summary import check_sections
from cam_motion.io.summary_data import check_as_data
from hypothesis import example, given
from hypothesis import strategies as st
import pytest
import yaml

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config' / 'cutting_machine.yaml'
GOOD = yaml.safe_load(CONFIG.read_text())


def problems_of(text):
    """Give the problems of a machine file by path."""
    with pytest.raises(ConfigurationError) as caught:
        parse_sections(text)
    return {problem.path: problem.rule for problem in caught.value.problems}


def test_the_cutting_machine_is_that_of_document_001():
    machine = load_machine(CONFIG)
    feeder, press, knife = machine.diagram.axes.values()
    assert machine.master.speed == pytest.approx(200.0 * 2.0 * math.pi / 60.0)
    assert [s.end_deg for s in feeder.profile.segments] == [80, 360]
    assert [s.end_deg for s in press.profile.segments] == [90, 135, 305, 350, 360]
    assert [s.end_deg for s in knife.profile.segments] == [145, 225, 235, 295, 360]
    assert feeder.profile.advance == 0.3
    drive = machine.drives['feeder_drive'].drive
    assert (drive.load_inertia, drive.resistance_force * drive.radius) == (1.164, 67.0)


def test_numbers_are_read_as_ros_reads_them():
    values = parse_sections('a: {ros__parameters: {x: 1e3, y: 2, z: -1.5e-2, n: on, s: 1e}}')['a']
    assert values == {'x': 1000.0, 'y': 2, 'z': -0.015, 'n': True, 's': '1e'}
    assert isinstance(values['x'], float)
    assert isinstance(values['y'], int)


def test_namespaces_and_shared_sections():
    sections = parse_sections(
        '/**: {ros__parameters: {rate_hz: 250.0, speed_cpm: 10.0}}\n'
        '/plant/master_shaft: {ros__parameters: {speed_cpm: 20.0}}\n')
    assert sections['master_shaft'] == {'rate_hz': 250.0, 'speed_cpm': 20.0}


@pytest.mark.parametrize('text, path, words', [
    ('', 'configuration', 'no machine file'),
    ('[1, 2]', 'configuration', 'no machine file'),
    ('a: 1', 'a', 'no section'),
    ('a: {ros__parameters: {x: 1}, y: 2}', 'a.y', 'beside ros__parameters'),
    ('a: {ros__parameters: {x: 1, x: 2}}', 'x', 'stands twice'),
    ('a: {ros__parameters: {x: [1}}', 'configuration:1:28', 'no YAML'),
    ('a: {ros__parameters: {x: 2026-13-45}}', 'configuration', 'no YAML'),
])
def test_what_is_no_parameter_file_is_said(text, path, words):
    found = problems_of(text)
    assert words in found[path]


@pytest.mark.parametrize('content', [None, b'\xff\xfe\x00', 'directory'])
def test_what_cannot_be_read_is_said(tmp_path, content):
    file = tmp_path / 'machine.yaml'
    if content == 'directory':
        file.mkdir()
    elif content is not None:
        file.write_bytes(content)
    with pytest.raises(ConfigurationError) as caught:
        read_sections(file)
    assert caught.value.problems[0].path == str(file)


def places(tree, path=()):
    """List every place in a tree of mappings and lists."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree)
    for key, value in items:
        yield (*path, key)
        if isinstance(value, (dict, list)):
            yield from places(value, (*path, key))


NASTY = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=8),
    st.sampled_from([
        [], {}, [[]], 10 ** 400, -1, 0, 1e308, -1e308, 1e-320, math.nan, math.inf, '..', 'a/b',
        'feed', 'feeder', 'line', 'dwell', 'cubic', 'cycloidal', 'constant_velocity', '/**',
        ['feed', 'feed'], ['wait'], {'law': 'cubic'}, {'end_deg': 90.0}, [1, 2], [None],
    ]),
    st.lists(st.floats(), max_size=8),
    st.dictionaries(st.text(max_size=6), st.floats(), max_size=3),
)
EDITS = st.lists(
    st.tuples(st.sampled_from(list(places(GOOD))), st.sampled_from(['set', 'drop', 'add']),
              st.text(max_size=6), NASTY), min_size=1, max_size=5)


def edited(edits):
    """Apply edits to the good machine, as far as the places still exist."""
    tree = copy.deepcopy(GOOD)
    for path, kind, name, value in edits:
        parent = tree
        try:
            for key in path[:-1]:
                parent = parent[key]
            if kind == 'drop':
                del parent[path[-1]]
            elif kind == 'set' or not isinstance(parent, dict):
                parent[path[-1]] = value
            else:
                parent[name] = value
        except (LookupError, TypeError):
            continue
    return tree


@given(EDITS)
@example([(('feeder', 'ros__parameters', 'feed', 'end_deg'), 'set', '', 10 ** 400)])
@example([(('feeder', 'ros__parameters', 'feed', 'lift'), 'set', '', 1e308)])
@example([(('feeder', 'ros__parameters', 'feed', 'end_deg'), 'set', '', 1e-320)])
@example([(('master_shaft', 'ros__parameters', 'speed_cpm'), 'set', '', 1e200)])
@example([(('knife', 'ros__parameters', 'cut', 'lift'), 'set', '', 1e-320)])
@example([(('feeder', 'ros__parameters', 'limits', 'acceleration'), 'set', '', 1e-320)])
@pytest.mark.filterwarnings('ignore::RuntimeWarning')
def test_no_edit_of_a_machine_file_escapes_as_anything_but_problems(edits):
    """Whatever is broken: a list of problems, each once, and strictly valid JSON."""
    try:
        sections = parse_sections(yaml.safe_dump(edited(edits), allow_unicode=True))
    except ConfigurationError as error:
        assert error.problems
        return
    check = check_sections(sections)
    data = json.loads(to_json(check_as_data(check)), parse_constant=pytest.fail)
    assert len(data['problems']) == len(check.problems)
    told = [str(problem) for problem in check.problems]
    assert len(told) == len(set(told))


@pytest.mark.parametrize('name', ['limits', 'engage', 'change', 'resume', 'disengage'])
def test_a_segment_cannot_take_the_name_of_parameters_of_its_axis(name):
    with pytest.raises(ConfigurationError, match=f"segments: '{name}'"):
        build_axis('axis', {'segments': [name], f'{name}.end_deg': 360.0})
