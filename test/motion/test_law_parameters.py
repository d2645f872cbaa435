# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Laws refuse what they cannot use, with the place, the value and the rule."""

import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws import LawParameter, LAWS, make_law
import pytest

pytestmark = pytest.mark.timeout(60)

EIGHTHS = [0.125, 0.25, 0.125, 0.0, 0.125, 0.25, 0.125]


def problems(name, **parameters):
    """Give what is said about parameters that are not accepted."""
    with pytest.raises(ConfigurationError) as caught:
        make_law(name, **parameters)
    return caught.value.problems


@pytest.mark.parametrize('value', [
    [0.2, 0.2, 0.2, 0.0, 0.2, 0.2, 0.2],
    [0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1],
    EIGHTHS[:6],
    [*EIGHTHS, 0.0],
    [],
    [math.nan, *EIGHTHS[1:]],
    [math.inf, *EIGHTHS[1:]],
    [-0.125, 0.5, *EIGHTHS[2:]],
    [1.5, -0.5, 0.0, 0.0, 0.0, 0.0, 0.0],
    ['0.125', *EIGHTHS[1:]],
    [None, *EIGHTHS[1:]],
    [True, 0, 0, 0, 0, 0, 0],
    [False, 0.5, 0, 0, 0, 0.5, 0],
    [0.0, 0.0, 0.0, 0.5, 0.25, 0.0, 0.25],
    [0.25, 0.0, 0.25, 0.5, 0.0, 0.0, 0.0],
    '0.125, 0.25', 'sevenxx', 0.125, True, {'x1': 1.0}, {0.125},
], ids=repr)
def test_fractions_that_are_no_seven_stages_are_refused(value):
    problem, = problems('modified_trapezoid', fractions=value)
    assert problem.path == 'fractions'
    assert repr(problem.value) == repr(value)
    assert 'seven stage lengths' in problem.rule
    assert repr(value) in str(problem)


def test_a_wrong_sum_is_told():
    problem, = problems('modified_trapezoid', fractions=[0.3, 0.3, 0.0, 0.0, 0.3, 0.3, 0.0])
    assert problem.hint == 'they sum to 1.2'


@pytest.mark.parametrize('value', [0.0, 1.0, -0.1, 1.1, math.nan, math.inf, '0.5', True, 2,
                                   [0.5], 0.5j])
def test_a_split_without_two_ramps_is_refused(value):
    problem, = problems('constant_acceleration', ramp_up=value)
    assert (problem.path, repr(problem.value)) == ('ramp_up', repr(value))
    assert 'above 0 and below 1' in problem.rule


def test_ramps_that_overlap_are_refused_with_their_sum():
    problem, = problems('trapezoidal_velocity', ramp_up=0.7, ramp_down=0.4)
    assert (problem.path, problem.value, problem.hint) == (
        'ramp_down', 0.4, 'ramp_up + ramp_down is 1.1')
    assert [p.path for p in problems('trapezoidal_velocity', ramp_up=0.6)] == ['ramp_down']


def test_all_problems_are_told_at_once():
    found = problems('trapezoidal_velocity', ramp_up='a', ramp_down=2.0, ramp=0.1, cycle=3)
    assert [(p.path, p.value) for p in found] == [
        ('ramp', 0.1), ('cycle', 3), ('ramp_up', 'a'), ('ramp_down', 2.0)]
    assert 'it takes ramp_up, ramp_down' in str(found[0])


def test_an_unknown_law_is_answered_with_the_known_ones():
    problem, = problems('cycloid')
    assert (problem.path, problem.value) == ('law', 'cycloid')
    assert all(name in problem.hint for name in LAWS)


def test_a_law_without_parameters_says_so():
    problem, = problems('cubic', ramp_up=0.3)
    assert problem.hint == 'it takes none'


@pytest.mark.parametrize('fractions', [EIGHTHS, tuple(EIGHTHS), [0, 0.5, 0, 0, 0, 0.5, 0]])
def test_lists_tuples_and_integers_are_accepted(fractions):
    law = make_law('modified_trapezoid', fractions=fractions)
    assert law.parameters == {'fractions': tuple(float(x) for x in fractions)}


def test_fractions_may_miss_one_by_what_six_printed_digits_leave():
    law = make_law('modified_trapezoid', fractions=[0.1428571] * 7)
    assert law.curve.end == 1.0 and float(law(1.0)) == pytest.approx(1.0, abs=1e-14)


def test_defaults_are_filled_in():
    assert make_law('trapezoidal_velocity').parameters == {'ramp_up': 1 / 3, 'ramp_down': None}
    assert make_law('constant_acceleration').parameters == {'ramp_up': 0.5}
    assert make_law('modified_trapezoid').parameters == {'fractions': tuple(EIGHTHS)}


def test_ramps_that_fill_the_span_but_for_rounding_are_accepted():
    law = make_law('trapezoidal_velocity', ramp_up=0.9, ramp_down=0.1)
    assert law.curve.end == pytest.approx(1.0, abs=1e-15)
    law = make_law('trapezoidal_velocity', ramp_up=0.7000001, ramp_down=0.3000001)
    assert float(law(1.0)) == pytest.approx(1.0, abs=1e-14)


def test_a_parameter_of_its_own_is_checked_like_the_built_in_ones():
    pair = LawParameter('pair', (0.0, 1.0), 'two shares', count=2)
    assert pair.check(None) == (0.0, 1.0)
    assert pair.check([0, 1]) == (0.0, 1.0)
    with pytest.raises(ConfigurationError, match='pair: 3; two shares'):
        pair.check(3)


def test_a_problem_is_one_sentence_and_can_be_placed_below_a_parent():
    problem = Problem('feed.end_deg', 400.0, 'a cycle ends at 360 deg', 'correct it')
    below = problem.below('feeder')
    assert str(below) == 'feeder.feed.end_deg: 400.0; a cycle ends at 360 deg (correct it)'
    assert problem.below('') is problem
    assert Problem('', None, 'needed').below('a').path == 'a'
    assert str(Problem('a.b', None, 'needed')) == 'a.b: missing; needed'
    error = ConfigurationError(p for p in (problem, below))
    assert error.problems == (problem, below)
    assert str(error).splitlines() == [str(problem), str(below)]
