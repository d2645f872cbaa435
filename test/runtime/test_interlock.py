# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Interlocks: identities of windows and gaps, what breaks them, and machine files with them."""

import math
from pathlib import Path

from cam_motion.errors import ConfigurationError
from cam_motion.io.config import read_sections
from cam_motion.io.machine import build_machine
from cam_motion.io.summary import check_sections
from cam_motion.io.summary_data import check_as_data
from cam_motion.motion.laws import make_law
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import Segment
from cam_motion.runtime.interlock import common_turns, Distance, Out, Side, Windows, windows
from cam_motion.runtime.motion_over_angle import CoupledCam, Standstill
from cam_motion.runtime.transition import Blend
from cam_motion.units import DEGREE, TURN
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ANGLE = 1e-9  # rad: to which crossings are found
CONFIG = Path(__file__).resolve().parents[2] / 'config'


def there_and_back(start, up, down, end, lift=1.0, law='cycloidal'):
    """Make a cam that goes up from start to up, and back from down to end [deg]."""
    rows = [('wait', 'dwell', start, 0.0), ('up', law, up, lift), ('hold', 'dwell', down, 0.0),
            ('down', law, end, -lift), ('rest', 'dwell', 360.0, 0.0)]
    before = (0.0, *(row[2] for row in rows))
    return CoupledCam(CamProfile([
        Segment(name, make_law(law), end_deg, lift)
        for (name, law, end_deg, lift), begin in zip(rows, before) if end_deg > begin]))


def judged(first, second):
    out = Out(Side.ABOVE, 0.5)
    return Windows('both', ('a', 'b'), (out, out)).judge({'a': first, 'b': second}, 0.0, TURN)


def test_the_window_of_a_symmetric_cam_is_that_between_its_middles():
    motion = there_and_back(20.0, 80.0, 200.0, 300.0)
    (start, end), = windows(Out(Side.ABOVE, 0.5), motion, 0.0, TURN)
    assert start == pytest.approx(50.0 * DEGREE, abs=ANGLE)
    assert end == pytest.approx(250.0 * DEGREE, abs=ANGLE)
    (zero, one), (two, turn) = windows(Out(Side.BELOW, 0.5), motion, 0.0, TURN)
    assert (zero, one, two, turn) == pytest.approx((0.0, start, end, TURN), abs=ANGLE)
    moving = windows(Out(Side.MOVING), motion, 0.0, TURN)
    assert np.ravel(moving) / DEGREE == pytest.approx([20.0, 80.0, 200.0, 300.0], abs=1e-4)


def test_a_peak_between_the_points_of_the_grid_is_not_missed():
    motion = there_and_back(10.0, 100.0, 100.0, 190.0, lift=1.0)
    (start, end), = windows(Out(Side.ABOVE, 1.0 - 1e-12), motion, 0.0, TURN)
    assert start < 100.0 * DEGREE < end < start + 0.01


def test_windows_apart_give_the_angle_between_them_also_across_the_end_of_the_cycle():
    first = there_and_back(20.0, 80.0, 200.0, 300.0)  # out from 50 to 250
    second = there_and_back(250.0, 290.0, 320.0, 360.0)  # out from 270 to 340
    verdict = judged(first, second)
    assert verdict.kept and verdict.margin == pytest.approx(20.0 * DEGREE, abs=ANGLE)
    assert verdict.at == pytest.approx(250.0 * DEGREE, abs=ANGLE)
    late = CoupledCam(second.profile, phase=-60.0 * DEGREE)  # out from 330 to 40
    verdict = judged(first, late)
    assert verdict.kept and verdict.margin == pytest.approx(10.0 * DEGREE, abs=ANGLE)


def test_an_overlap_is_told_with_its_angles():
    first = there_and_back(20.0, 80.0, 200.0, 300.0)
    second = CoupledCam(there_and_back(250.0, 290.0, 320.0, 360.0).profile, phase=30.0 * DEGREE)
    verdict = judged(first, second)  # out from 240 to 310
    assert not verdict.kept
    assert verdict.margin == pytest.approx(-10.0 * DEGREE, abs=ANGLE)
    assert 'from 240 to 250 deg: 10 deg' in verdict.text


@settings(max_examples=30, deadline=None)
@given(shift=st.floats(0.0, 360.0))
def test_the_verdict_of_two_windows_does_not_depend_on_where_the_cycle_is_cut(shift):
    first = there_and_back(20.0, 80.0, 100.0, 160.0)
    second = there_and_back(200.0, 240.0, 260.0, 300.0)
    turned = [CoupledCam(each.profile, phase=shift * DEGREE) for each in (first, second)]
    one, two = judged(first, second), judged(*turned)
    assert one.kept and two.kept
    assert two.margin == pytest.approx(one.margin, abs=1e-7)


def test_the_smallest_gap_lies_where_the_two_come_nearest():
    motion = there_and_back(0.0, 90.0, 90.0, 180.0, lift=0.3)
    gap = Distance('gap', ('a', 'b'), (-1.0, -1.0), 0.5, 0.15)
    verdict = gap.judge({'a': motion, 'b': Standstill(0.0)}, 0.0, TURN)
    assert verdict.kept and verdict.margin == pytest.approx(0.05, abs=1e-12)
    assert verdict.at == pytest.approx(90.0 * DEGREE, abs=1e-5)  # a maximum is flat
    verdict = gap.judge({'a': motion, 'b': Standstill(0.1)}, 0.0, TURN)
    assert not verdict.kept and '0.05 too near' in verdict.text


@settings(max_examples=20, deadline=None)
@given(start=st.floats(0.0, 6.0), span=st.floats(0.3, 6.0), lift=st.floats(0.1, 2.0))
def test_a_gap_over_one_common_transition_is_never_less_than_before_or_after(start, span, lift):
    gap = Distance('gap', ('a', 'b'), (1.0, -1.0), 3.0, 0.0)
    old = {'a': there_and_back(0.0, 90.0, 90.0, 180.0),
           'b': there_and_back(40.0, 90.0, 180.0, 250.0)}
    new = {'a': there_and_back(30.0, 70.0, 90.0, 300.0, lift),
           'b': there_and_back(20.0, 190.0, 200.0, 260.0, 0.5 * lift)}
    blends = {name: Blend(old[name], new[name], start, span) for name in old}
    least = min(gap.judge(each, start, start + span).margin for each in (old, new))
    assert gap.judge(blends, start, start + span, repeats=False).margin >= least - 1e-9


def test_turns_after_which_cams_stand_where_they_stood():
    assert common_turns([]) == common_turns([1.0, 2.0, -3.0]) == 1
    assert common_turns([0.5, 1.0 / 3.0]) == 6
    assert common_turns([math.pi]) == 24


# In a machine file

@pytest.fixture
def sections():
    return read_sections(CONFIG / 'cutting_machine_short.yaml')


def with_line(sections, **changes):
    changes = {key.replace('__', '.'): value for key, value in changes.items()}
    return {**sections, 'line': {**sections['line'], **changes}}


def test_a_machine_says_by_how_much_it_keeps_its_interlocks(sections):
    kept = build_machine(sections).interlocks
    assert list(kept) == ['belt_stands', 'cut_held']
    assert all(each.verdict.kept for each in kept.values())
    data = check_as_data(check_sections(sections))['interlocks']
    assert data['cut_held']['axes'] == ['knife', 'press']
    assert data['belt_stands']['margin_deg'] == pytest.approx(20.24, abs=0.01)


def test_a_machine_that_breaks_an_interlock_is_refused_with_axes_and_angle(sections):
    wrong = with_line(sections, belt_stands__second_above=-0.001)
    with pytest.raises(ConfigurationError) as caught:
        build_machine(wrong)
    problem, = caught.value.problems
    assert problem.path == 'line.belt_stands'
    assert 'feeder (moving) and press (above -0.001)' in problem.rule
    assert 'from 0 to 80 deg: 80 deg' in problem.rule


@pytest.mark.parametrize(('changes', 'path', 'words'), [
    ({'cut_held__kind': 'nearness'}, 'line.cut_held.kind', 'windows, distance'),
    ({'cut_held__first': 'saw'}, 'line.cut_held.first', 'must name an axis'),
    ({'cut_held__first': 'press'}, 'line.cut_held.second', 'another axis'),
    ({'cut_held__first_below': 0.1}, 'line.cut_held.first', 'exactly one of'),
    ({'cut_held__first_above': math.nan}, 'line.cut_held.first_above', 'a finite number'),
    ({'cut_held__least': 0.1}, 'line.cut_held.least', 'does not belong to kind windows'),
    ({'cut_held__axis': 'press'}, 'line.cut_held.axis', 'no such parameter'),
    ({'cut_held__kind': 'distance'}, 'line.cut_held.least', 'needs the least gap'),
    ({'belt_stands__first_moving': False, 'belt_stands__first_above': 0.1},
     'line.belt_stands.first', 'no lasting position'),
    ({'interlocks': ['cut_held', 'cut_held']}, 'line.interlocks', 'stands once'),
    ({'interlocks': ['cut_held', 'axes']}, 'line.interlocks', 'is the name of a parameter'),
])
def test_an_interlock_that_is_none_is_refused(sections, changes, path, words):
    with pytest.raises(ConfigurationError) as caught:
        build_machine(with_line(sections, **changes))
    found = {problem.path: str(problem) for problem in caught.value.problems}
    assert path in found and words in found[path], found


def test_an_interlock_needs_axes_whose_shaft_angle_is_known(sections):
    sections = {**sections, 'knife': {**sections['knife'], 'engage.master': 'relative'}}
    with pytest.raises(ConfigurationError, match='no shaft angle of it is known'):
        build_machine(sections)
