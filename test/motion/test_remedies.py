# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The way out of a joint that steps: it names what fits, and what it names does fit."""

from dataclasses import replace
import re

from cam_motion import CamProfile, segment
from cam_motion.errors import ConfigurationError
from cam_motion.motion.laws import make_law
from cam_motion.motion.laws.fitted import EndCondition, fitted, laws_meeting, misses, REST
from cam_motion.motion.remedies import laws_instead, to_change
import pytest

pytestmark = pytest.mark.timeout(60)

RUN = segment('run', 120.0, 0.1, 'constant_velocity')
STEPPING = {
    'a turn behind a line': [
        segment('up', 60.0, 0.05, 'acceleration_trapezoid_rv'), RUN,
        segment('turn', 200.0, 0.05, 'harmonic_combination_vt'),
        segment('back', 360.0, -0.2, 'auto')],
    'a polynomial told too little': [
        segment('up', 60.0, 0.05, 'polynomial', end_velocity=1.0), RUN,
        segment('back', 360.0, -0.15, 'auto')],
    'a line between dwells': [
        segment('wait', 60.0), segment('run', 180.0, 0.1, 'constant_velocity'),
        segment('rest', 240.0), segment('back', 360.0, -0.1, 'cycloidal')],
}
CHANGED = {'a turn behind a line': ('turn', 'from 2.66667 lifts per span to'),
           'a polynomial told too little': ('up', 'to 2 lifts per span'),
           'a line between dwells': ('run', 'from rest to rest')}


def law_of(text):
    """Read a law as the hint writes it."""
    name, _, told = text.partition(' (')
    pairs = re.findall(r'(\w+): ([^,)]+)', told)
    return make_law(name, **{key: float(value) for key, value in pairs})


@pytest.mark.parametrize('case', STEPPING)
def test_every_law_that_the_way_out_names_makes_the_joint_smooth(case):
    segments, (name, ends) = STEPPING[case], CHANGED[case]
    with pytest.raises(ConfigurationError) as caught:
        CamProfile(segments)
    hint = caught.value.problems[0].hint
    assert hint.startswith(f'give {name} a law that runs ') and ends in hint
    place = next(n for n, each in enumerate(segments) if each.name == name)
    named = re.split(r', (?![^(]*\))', hint.partition(': ')[2])
    assert len(named) >= 4 and segments[place].law.name not in named
    for text in named:
        law = law_of(text)
        changed = [*segments[:place], replace(segments[place], law=law), *segments[place + 1:]]
        cam = CamProfile(changed)
        where = cam.parts[place]
        assert not [jump for jump in cam.jumps(2) if jump.at in (where.start, where.end)], text


def test_neither_a_dwell_nor_a_line_is_the_one_to_change():
    wait, move = segment('wait', 90.0), segment('move', 180.0, 1.0, 'cubic')
    line = segment('line', 360.0, 1.0, 'constant_velocity')
    assert to_change([wait, move], 1) == 1 and to_change([move, wait], 1) == 0
    assert to_change([line, move], 1) == 1 and to_change([move, line], 1) == 0
    assert to_change([wait, line], 1) == 1 and to_change([move, move], 1) == 1


def test_laws_are_fitted_to_velocities_they_take():
    asked = EndCondition(0.75, 0.0), REST
    law = fitted('modified_sine_vv', asked)
    assert law.curve.end_values(1) == pytest.approx((0.75, 0.0), abs=1e-12)
    assert fitted('harmonic_combination_vt', asked).parameters['inflection'] == 0.5
    assert fitted('harmonic_combination_vt', (EndCondition(1.25), REST)).parameters[
        'inflection'] is None  # it runs straight at first
    assert fitted('modified_sine_vv', (REST, REST)) is None
    assert fitted('cycloidal', asked) is None and fitted('auto', asked) is None


@pytest.mark.parametrize('asked', [
    (REST, REST), (EndCondition(2.0, 0.0), REST), (REST, EndCondition(0.3, -1.0)),
    (EndCondition(), REST)])
def test_laws_that_meet_do_so_in_velocity_and_acceleration(asked):
    found = laws_meeting(asked)
    assert 'auto' in [law.name for law in found]
    assert not any(any(misses(law, asked, order)) for law in found if law.name != 'auto'
                   for order in (1, 2))
    if asked == (EndCondition(2.0, 0.0), REST):
        assert 'acceleration_trapezoid_vr' in [law.name for law in found]


def test_the_law_refused_is_not_recommended():
    cubic = segment('move', 180.0, 1.0, 'cubic')
    assert 'cubic' not in laws_instead(cubic, (REST, REST)).split(', ')
    smooth = segment('move', 180.0, 1.0, 'cycloidal')
    assert 'cycloidal' not in laws_instead(smooth, (REST, REST)).split(', ')
