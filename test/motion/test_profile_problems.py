# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A cam that cannot be is refused: every problem at once, each with its place and value."""

import math

from cam_motion import CamProfile, segment
from cam_motion.errors import ConfigurationError
import pytest

pytestmark = pytest.mark.timeout(60)


def problems(*segments, accumulate=False):
    """Give (path, value) of everything that is wrong with a cam, and the text."""
    with pytest.raises(ConfigurationError) as caught:
        CamProfile(segments, accumulate)
    return [(problem.path, problem.value) for problem in caught.value.problems], str(caught.value)


def test_a_cam_needs_segments():
    found, text = problems()
    assert found == [('segments', [])]
    assert 'at least one segment' in text


def test_every_problem_of_a_broken_cam_is_told_at_once():
    found, text = problems(
        segment('feed', 80.0, 0.3, 'cubic'), segment('back', 70.0, -0.1, 'cubic'),
        segment('far', 400.0, 0.1, 'cubic'), segment('rest', 350.0, 0.5),
    )
    assert found == [
        ('back.end_deg', 70.0), ('far.end_deg', 400.0), ('rest.end_deg', 350.0),
        ('rest.end_deg', 350.0), ('rest.lift', 0.5), ('cycle', 'return'),
    ]
    for words in ('it starts at 80 deg', 'a cycle ends at 360 deg', 'a dwell has no lift',
                  'the last segment must end at 360 deg', 'they sum to 0.8'):
        assert words in text


@pytest.mark.parametrize('bad', [math.nan, math.inf, -math.inf])
def test_angles_and_lifts_must_be_finite(bad):
    found, _ = problems(segment('a', bad, 1.0, 'cubic'), segment('b', 360.0, bad, 'cubic'))
    assert [path for path, _ in found] == ['a.end_deg', 'b.lift']
    assert all(value is bad for _, value in found)


@pytest.mark.parametrize('angles', [(0.0, 360.0), (-10.0, 360.0), (100.0, 100.0, 360.0)])
def test_angles_must_rise_from_above_zero(angles):
    found, text = problems(*(segment(f's{n}', angle) for n, angle in enumerate(angles)))
    assert len(found) == 1 and 'angles must rise' in text


def test_the_cycle_must_close_unless_it_accumulates():
    parts = segment('a', 90.0, 0.3, 'cubic'), segment('b', 360.0)
    found, text = problems(*parts)
    assert found == [('cycle', 'return')]
    assert 'they sum to 0.3' in text and 'accumulate' in text
    assert CamProfile(parts, accumulate=True).advance == 0.3


def test_a_step_of_the_velocity_is_told_with_its_place_and_amount():
    found, text = problems(segment('wait', 90.0), segment('run', 180.0, 1.0, 'constant_velocity'),
                           segment('rest', 270.0), segment('back', 360.0, -1.0, 'cubic'))
    assert found == [('run.law', 'constant_velocity'), ('rest.law', 'dwell')]
    assert '0.63662 per rad at 90 deg' in text and '-0.63662 per rad at 180 deg' in text


def test_a_step_at_the_seam_is_told_at_zero_degrees():
    found, text = problems(segment('rest', 270.0), segment('up', 300.0, 1.0, 'cubic'),
                           segment('down', 360.0, -1.0, 'constant_velocity'))
    assert found == [('rest.law', 'dwell'), ('down.law', 'constant_velocity')]
    assert 'at 0 deg' in text


def test_rounding_of_a_joint_does_not_put_a_step_into_another_segment():
    found, _ = problems(segment('w', 39.6, 1.0, 'cubic'), segment('up', 314.6, 1.0, 'cubic'),
                        segment('down', 360.0, -2.0, 'constant_velocity'))
    assert found == [('w.law', 'cubic'), ('down.law', 'constant_velocity')]


def test_the_parameters_of_a_law_are_checked_with_the_segment():
    with pytest.raises(ConfigurationError, match='ramp_up: 2.0'):
        segment('a', 90.0, 1.0, 'trapezoidal_velocity', ramp_up=2.0)
    with pytest.raises(ConfigurationError, match='known are'):
        segment('a', 90.0, 1.0, 'parabola')


def test_a_segment_without_a_law_is_a_dwell():
    rest = segment('rest', 90.0)
    assert rest.is_dwell and rest.lift == 0.0 and rest.end == pytest.approx(0.5 * math.pi)
    assert not segment('move', 90.0, 1.0, 'cubic').is_dwell
