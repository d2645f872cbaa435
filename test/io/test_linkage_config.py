# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Linkages in machine files: the umbrella as described, every problem at its path, pictures."""

import copy
from dataclasses import replace
from pathlib import Path

from cam_motion.errors import ConfigurationError
from cam_motion.io.config import flatten, read_sections
from cam_motion.io.linkage_config import build_linkage
from cam_motion.io.plots.linkage import linkage_figure, run_case
from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.planar import four_bar, slider_crank
from cam_motion.mechanism.umbrella import Umbrella
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest
import yaml

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config' / 'umbrella.yaml'
GOOD = yaml.safe_load(CONFIG.read_text())['umbrella']['ros__parameters']


@pytest.fixture(scope='module')
def umbrella():
    return build_linkage('umbrella', read_sections(CONFIG)['umbrella'])


def edited(path, value):
    """Give the parameters of the umbrella with one of them changed; None takes it away."""
    tree = copy.deepcopy(GOOD)
    *above, last = path.split('.')
    place = tree
    for key in above:
        place = place[key]
    if value is None:
        del place[last]
    else:
        place[last] = value
    return flatten(tree)


def test_the_file_describes_the_umbrella_of_document_003(umbrella):
    assert umbrella.linkage == Umbrella().linkage()


def test_the_cases_of_the_document(umbrella):
    sliding, opening, both = umbrella.cases.values()
    assert sliding.inputs.rates == {'h1': -0.3}
    crank = -2.0 * np.pi * umbrella.spools['h2']
    assert opening.inputs.values['h1'] == 0.8
    assert opening.inputs.rates == pytest.approx({'h2': crank})
    assert both.inputs.rates == pytest.approx({'h1': -0.2, 'h2': crank})


def test_the_closing_words_of_the_document_on_the_velocities_hold(umbrella):
    times = np.linspace(0.0, 1.0, 21)
    sliding, opening, _ = (
        run_case(umbrella, case, times * case.duration) for case in umbrella.cases.values())
    for each in sliding:  # links 3, 5 and 6 move as a unit
        assert each.velocity['theta5'] == pytest.approx(each.velocity['theta3'], abs=1e-12)
    for each in opening:  # links 2 and 3 are not affected by the crank
        assert each.velocity['theta2'] == each.velocity['theta3'] == 0.0
    for name in ('theta5', 'theta6'):  # slow at first, rapid at the end
        speeds = [abs(each.velocity[name]) for each in opening]
        assert speeds[0] < 0.3 and speeds[-1] == max(speeds) > 1.9 * speeds[0]


@pytest.mark.parametrize('path, value, problem', [
    ('type', 'crane', 'type'), ('inputs', 'h1', 'inputs'), ('unknowns', [1], 'unknowns'),
    ('loops', ['rib', 'tip', 'type'], 'loops'), ('points', [*'ABCGFED', 'L2'], 'points'),
    ('L2.length', -1.0, 'L2.length'), ('L2.length', None, 'L2.length'),
    ('slide.length', 1.0, 'slide.length'), ('L2.body', 'link9', 'L2.body'),
    ('L2.colour', 'red', 'L2.colour'), ('link2.angle', None, 'link2.angle'),
    ('rib.path', ['d1', '-L9'], 'rib.path'), ('B.from', 'Q', 'B.from'),
    ('h1.start', None, 'h1.start'), ('h1.start_deg', 3.0, 'h1.start'),
    ('theta2.start_deg', None, 'theta2.start'), ('theta2.start_deg', 90.0, 'unknowns'),
    ('theta2.spool_radius', 1.0, 'theta2.spool_radius'), ('h2.spool_radius', 0.0,
                                                          'h2.spool_radius'),
    ('sliding.duration', None, 'sliding.duration'), ('sliding.duration', 60.0,
                                                     'sliding.duration'),
    ('sliding.h1', 2.5, 'sliding.h1'), ('sliding.h3', 2.5, 'sliding.h3'),
    ('sliding.h1_crank', 1.0, 'sliding.h1_crank'), ('h1', {'start_deg': 1.0}, 'h1.start_deg'),
    ('turned', 1.0, 'turned'), ('L2', None, 'L2.length'), ('link2', 'theta2', 'link2'),
    ('rib', ['d1'], 'rib'), ('theta2', -16.3, 'theta2'), ('sliding', 5.0, 'sliding'),
    ('what', {'angel': 'theta2'}, 'what.angel'),
])
def test_a_problem_is_said_at_its_path(path, value, problem):
    with pytest.raises(ConfigurationError) as caught:
        build_linkage('umbrella', edited(path, value))
    assert [each.path for each in caught.value.problems] == [problem]
    assert all(each.rule for each in caught.value.problems)


@pytest.mark.parametrize('load, problem', [
    ({}, 'w'), ({'point': 'D', 'variable': 'h1', 'force': 1.0}, 'w'),
    ({'point': 'D'}, 'w.force_x'), ({'point': 'Z', 'force_x': 1.0}, 'w.point'),
    ({'point': 'D', 'force_x': 1.0, 'torque': 1.0}, 'w.torque'),
    ({'variable': 'h9', 'force': 1.0}, 'w.variable'), ({'variable': 'theta2'}, 'w.torque'),
    ({'variable': 'theta2', 'force': 1.0}, 'w.force'),
    ({'variable': 'h1', 'torque': 1.0}, 'w.torque'),
])
def test_a_load_that_acts_on_nothing_is_said_at_its_path(load, problem):
    with pytest.raises(ConfigurationError) as caught:
        build_linkage('umbrella', flatten({**GOOD, 'loads': ['w'], 'w': load}))
    assert [each.path for each in caught.value.problems] == [problem]


def test_loads_add_up_on_what_they_act_on():
    found = build_linkage('umbrella', flatten({
        **GOOD, 'loads': ['a', 'b', 'c', 'd'], 'a': {'point': 'D', 'force_x': 1.0},
        'b': {'point': 'D', 'force_y': -2.0}, 'c': {'variable': 'theta2', 'torque': 5.0},
        'd': {'variable': 'h1', 'force': -3.0}}))
    assert found.forces == {'D': 1.0 - 2.0j}
    assert found.torques == {'theta2': 5.0, 'h1': -3.0}
    assert found.loaded and not build_linkage('umbrella', flatten(GOOD)).loaded


def problem_with(changes):
    """Give the one problem of the umbrella with other parameters."""
    with pytest.raises(ConfigurationError) as caught:
        build_linkage('umbrella', flatten({**GOOD, **changes}))
    problem, = caught.value.problems
    return problem


@pytest.mark.parametrize('key, lists, where', [
    ('link2', {'bodies': ['link3', 'link5', 'link6']}, 'list it in bodies'),
    ('L6', {'vectors': [name for name in GOOD['vectors'] if name != 'L6']}, 'list it in vectors'),
    ('spare', {'spare': {'path': ['d1']}}, 'list it in loops or in points'),
])
def test_what_is_described_but_not_listed_is_said_to_be_so(key, lists, where):
    problem = problem_with(lists)
    assert (problem.path, problem.rule) == (key, 'is described but not listed')
    assert problem.hint == where


@pytest.mark.parametrize('key, hint', [
    ('L2', 'write L2: {length: ...}'), ('link2', 'write link2: {angle: ...}'),
    ('rib', 'write rib: {path: ...}'), ('theta2', 'write theta2: {start: ...}'),
    ('both', 'write both: {duration: ...}')])
@pytest.mark.parametrize('value', [None, 'abc', 1.0])
def test_a_part_that_is_no_mapping_is_told_how_it_is_written(key, hint, value):
    problem = problem_with({key: value})
    assert (problem.path, problem.value, problem.hint) == (key, value, hint)
    assert 'must be a mapping' in problem.rule


def test_an_unknown_too_many_is_counted_and_not_taken_for_a_length():
    with pytest.raises(ConfigurationError) as caught:
        build_linkage('umbrella', flatten({
            **GOOD, 'unknowns': [*GOOD['unknowns'], 'theta7'], 'theta7': {'start_deg': 1.0}}))
    first, second = caught.value.problems
    assert (first.path, first.value) == ('unknowns', 'theta7')
    assert 'neither the angle of a body nor the length' in first.rule
    assert '2 loops, 5 unknowns' in second.rule


def test_problems_are_said_all_at_once():
    values = {**edited('L2.length', -1.0), 'd1.turn_deg': 'left', 'link5.angel': 'theta5',
              'tip.path': 'd4'}
    with pytest.raises(ConfigurationError) as caught:
        build_linkage('umbrella', values)
    assert {each.path for each in caught.value.problems} == {
        'L2.length', 'd1.turn_deg', 'link5.angel', 'tip.path'}


VALUES = st.one_of(
    st.none(), st.floats(), st.integers(), st.text(max_size=4), st.booleans(), st.just([]),
    st.sampled_from(['h1', 'theta2', 'link2', 'frame', ['h1'], ['L2', '-L2'], 1e308, -1e6]))


@given(st.lists(st.tuples(st.sampled_from(sorted(flatten(GOOD))), VALUES), max_size=3))
@settings(max_examples=60, deadline=None)
def test_no_edit_escapes_as_anything_but_problems(edits):
    values = flatten(GOOD) | dict(edits)
    for motion in ('sliding', 'opening', 'both'):  # they are gone through, which takes time
        values = {key: each for key, each in values.items() if not key.startswith(motion)}
    values.pop('motions')
    try:
        build_linkage('umbrella', values)
    except ConfigurationError as error:
        assert error.problems


@pytest.mark.slow
def test_a_picture_holds_the_curves_of_its_case(umbrella):
    figure = linkage_figure(umbrella, umbrella.cases['opening'])
    drawing, *panels = figure.axes
    labels = [[line.get_label() for line in panel.lines] for panel in panels]
    assert labels == [['theta2', 'theta3', 'theta5', 'theta6'],
                      ['omega2', 'omega3', 'omega5', 'omega6'], ['F', 'E']]
    assert drawing.get_title(loc='left') == 'umbrella: opening'
    assert panels[0].get_title(loc='left') == (
        'h1 = 0.8 m\nh2 from 1.2 to 0.2952 m, crank −6.283 rad/s, spool radius 0.02 m')


@pytest.mark.parametrize('linkage', [four_bar(0.1, 0.3, 0.25, 0.35), slider_crank(0.1, 0.3)],
                         ids=lambda linkage: linkage.name)
def test_the_commonest_linkages_are_descriptions_too(linkage):
    sections = read_sections(CONFIG.with_name(f'{linkage.name}.yaml'))
    found = build_linkage(linkage.name, sections[linkage.name])
    assert replace(found.linkage, start=linkage.start) == linkage
    assert found.assembly.start.values == pytest.approx(Assembly(linkage).start.values, abs=1e-12)
    last = run_case(found, found.cases['turn'], np.linspace(0.0, 1.0, 25))[-1]
    assert last.position['theta2'] == pytest.approx(2.0 * np.pi)
