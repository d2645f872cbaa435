# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A linkage in a line: which axes drive it, and that their cams keep within its range."""

import copy
from pathlib import Path

from cam_motion.errors import ConfigurationError
from cam_motion.io.config import flatten, load_machine
from cam_motion.io.line_parts import guess_line
from cam_motion.io.linkage_line import build_driven, linkage_table
from cam_motion.io.machine import build_machine
from cam_motion.io.parameters import check_values
from cam_motion.io.summary import check_sections
from cam_motion.nodes.line_topics import topics_of
import pytest
import yaml

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config' / 'umbrella.yaml'
TREE = yaml.safe_load(CONFIG.read_text(encoding='utf-8'))


def edited(changes):
    """Give the sections of the umbrella's line, some parameters changed; None takes them away."""
    tree = copy.deepcopy(TREE)
    for path, value in changes.items():
        node, *above, last = path.split('.')
        place = tree[node]['ros__parameters']
        for key in above:
            place = place[key]
        if value is None:
            del place[last]
        else:
            place[last] = value
    return {name: flatten(body['ros__parameters']) for name, body in tree.items()}


def test_the_umbrella_is_a_line_with_a_linkage():
    machine = load_machine(CONFIG)
    settings = machine.linkages['umbrella']
    assert settings.axes == ('slider', 'crank')
    slider, crank = settings.drives['h1'], settings.drives['h2']
    assert (slider.factor, slider.offset) == (1.0, 0.0)
    assert (crank.factor, crank.offset) == (0.02, 0.8)


@pytest.mark.parametrize('name', ['four_bar', 'slider_crank'])
def test_the_other_linkages_are_lines_too(name):
    machine = load_machine(CONFIG.parent / f'{name}.yaml')
    assert list(machine.linkages) == [name]
    assert machine.diagram.axes['motor'].profile.advance == pytest.approx(6.283185307179586)


@pytest.mark.parametrize('changes, path, words', [
    ({'umbrella.h1.axis': 'slide'}, 'umbrella.h1.axis', ('slider, crank',)),
    ({'slider.unit': 'mm'}, 'umbrella.h1.axis', ('mm', 'the unit m')),
    ({'crank.unit': 'deg'}, 'umbrella.h2.axis', ('deg', 'the unit rad')),
    ({'umbrella.h1.axis': None, 'umbrella.h2.axis': None}, 'umbrella.h1.axis', ('at least one',)),
    ({'slider.down.lift': -1.85, 'slider.up.lift': 1.85, 'slider.limits.lowest': 0.1},
     'umbrella.h1', ('at shaft angle', 'from 0.2 m to 2.2 m', 'link2 and link3')),
    ({'crank.offset': 36.0, 'crank.limits.highest': 40.0}, 'umbrella.h2',
     ('at shaft angle 0 deg', '1.49666 m', 'link5 and link6')),
    ({'line.linkages': ['umbrela']}, 'umbrela', ('a section of its own',)),
    ({'line.linkages': ['umbrella', 'slider']}, 'line.linkages', ('a name of its own',)),
    ({'umbrella.markers_hz': -1.0}, 'umbrella.markers_hz', ('at least 0',)),
    ({'umbrella.loads': ['rain'], 'umbrella.rain': {'point': 'Z'}}, 'umbrella.rain.point',
     ('A, B, C',)),
])
def test_what_cannot_drive_a_linkage_is_refused(changes, path, words):
    sections = edited(changes)
    with pytest.raises(ConfigurationError) as caught:
        build_machine(sections)
    said = {problem.path: str(problem) for problem in caught.value.problems}
    assert path in said, said
    for word in words:
        assert word in said[path]
    paths = [problem.path for problem in check_sections(sections).problems]
    assert len(paths) == len(set(paths)) and path in paths


def test_problems_of_the_section_and_of_its_parts_come_together():
    with pytest.raises(ConfigurationError) as caught:
        build_driven('umbrella', edited({
            'umbrella.markers_hz': -1.0, 'umbrella.frame_id': 7, 'umbrella.h1.axes': 'slider',
            'umbrella.L2.length': -1.0})['umbrella'])
    assert {problem.path for problem in caught.value.problems} >= {
        'markers_hz', 'frame_id', 'h1.axes', 'L2.length'}


def test_a_line_without_a_section_finds_its_linkages():
    sections = edited({})
    del sections['line']
    assert guess_line(sections)['linkages'] == ['umbrella']
    assert list(build_machine(sections).linkages) == ['umbrella']


def test_the_table_knows_every_parameter_of_the_file():
    given = {key: value for key, value in edited({})['umbrella'].items()
             if not key.startswith(('sliding.', 'opening.', 'both.'))}
    values, problems = check_values(linkage_table(given), given)
    assert problems == [] and values['tip.path'] == ['d4', 'L6', 'stretch', 'L5']


def test_the_topics_of_a_line_hold_those_of_its_linkages():
    topics = {topic.name: topic.type_name for topic in topics_of(edited({}))}
    assert topics['umbrella/joint_states'] == 'sensor_msgs/msg/JointState'
    assert topics['umbrella/markers'] == 'visualization_msgs/msg/MarkerArray'
    assert 'umbrella/state' in topics
