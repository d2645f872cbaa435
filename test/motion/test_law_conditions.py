# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Polynomials that meet boundary values and points, against the conditions they were given."""

import math

from cam_motion.errors import ConfigurationError
from cam_motion.motion.laws import Boundary, make_law
from cam_motion.motion.laws.with_conditions import MOST_CONDITIONS
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-12
MET = 1e-9  # a condition is met to this share of the largest value of its derivative
PRINTED = 1e-11  # the printed coefficients are exact decimal fractions; the point is rounded
XI = np.linspace(0.0, 1.0, 201)
LISTS = ('positions', 'velocities', 'accelerations', 'jerks')


def refusal(name, **parameters):
    """Give what is said about conditions that are not accepted."""
    with pytest.raises(ConfigurationError) as caught:
        make_law(name, **parameters)
    return caught.value.problems


values = st.integers(-400, 400).map(lambda n: n / 40.0)


@given(values, values, values, values)
def test_the_polynomial_has_the_boundary_values_it_was_given(v0, a0, v1, a1):
    curve = make_law('polynomial', start_velocity=v0, start_acceleration=a0,
                     end_velocity=v1, end_acceleration=a1).curve
    slack = 1e-13 * (sum(map(abs, curve.pieces[0].coefficients)) + 1.0)
    assert curve.end_values(0) == pytest.approx((0.0, 1.0), abs=slack)
    assert curve.end_values(1) == pytest.approx((v0, v1), abs=5 * slack)
    assert curve.end_values(2) == pytest.approx((a0, a1), abs=20 * slack)


def test_the_polynomial_at_rest_is_345_and_at_the_mean_velocity_a_line():
    for name in ('polynomial', 'auto', 'flexible_polynomial'):
        assert make_law(name)(XI) == pytest.approx(make_law('polynomial_345')(XI), abs=ROUNDING)
    line = make_law('polynomial', start_velocity=1.0, end_velocity=1.0)
    assert line(XI).tolist() == XI.tolist() and line.curve.peak(2).value == 0.0
    assert line.ends == (Boundary.CONSTANT_VELOCITY,) * 2


def test_the_polynomial_tells_what_it_does_at_its_ends():
    whole = make_law('polynomial', start_velocity=0.5, end_acceleration=-3.0)
    assert whole.ends == (Boundary.CONSTANT_VELOCITY, Boundary.TURN)


@pytest.mark.parametrize('value', [math.nan, math.inf, -1e13, '1', True, [1.0]])
def test_a_boundary_value_that_is_no_number_is_refused(value):
    problem, = refusal('polynomial', end_velocity=value)
    assert problem.path == 'end_velocity' and 'lifts per span' in problem.rule


@pytest.mark.parametrize(('name', 'conditions'), [
    ('cubic', {'accelerations': []}),
    ('polynomial_4567', {'jerks': [0.0, 0.0, 1.0, 0.0]}),
    ('constant_velocity', {'velocities': [], 'accelerations': []}),
])
def test_known_laws_follow_from_their_conditions(name, conditions):
    assert make_law('flexible_polynomial', **conditions)(XI) == pytest.approx(
        make_law(name)(XI), abs=ROUNDING)


def test_the_eighth_degree_polynomial_follows_from_its_conditions():
    # Kloomok and Muffley: from rest to a turn without jerk, and one point of their curve between
    printed = make_law('polynomial_8')
    law = make_law(
        'flexible_polynomial', positions=[0.5, float(printed(0.5))], velocities=[0, 0, 1, 0],
        accelerations=[0, 0, 1, -5.2683], jerks=[0, 36.5853, 1, 0])
    assert law.curve.pieces[0].coefficients == pytest.approx(
        printed.curve.pieces[0].coefficients, abs=PRINTED)


shares = st.lists(st.integers(1, 15), min_size=0, max_size=3, unique=True)


@given(shares, shares, shares, st.randoms(use_true_random=False))
def test_the_degree_is_one_less_than_the_conditions_and_all_are_met(p, v, a, random):
    def pairs(places):
        return [number for n in places for number in (n / 16, random.randint(-20, 20) / 10)]
    given_values = {'positions': pairs(p), 'velocities': [0.0, 0.0, 1.0, 0.0, *pairs(v)],
                    'accelerations': [0.0, 0.0, 1.0, 0.0, *pairs(a)]}
    try:
        law = make_law('flexible_polynomial', **given_values)
    except ConfigurationError as error:
        # points and derivatives between them do not always determine a polynomial
        problem, = error.problems
        assert problem.path == 'law' and ('of its own' in problem.rule or 'rounding'
                                          in problem.rule)
        return
    piece, = law.curve.pieces
    assert len(piece.coefficients) == 6 + len(p) + len(v) + len(a)
    for order, name in enumerate(LISTS[:3]):
        scale = max(1.0, abs(law.curve.peak(order).value))
        listed = given_values[name]
        for x, value in zip(listed[::2], listed[1::2]):
            assert float(law(x, order)) == pytest.approx(value, abs=MET * scale)


def test_the_path_through_points_is_the_one_that_was_computed_by_hand():
    # s(1/2) = 3/4 without further conditions: s = 2 xi - xi²
    law = make_law('flexible_polynomial', positions=[0.5, 0.75], velocities=[], accelerations=[])
    assert law.curve.pieces[0].coefficients == (0.0, 2.0, -1.0)


@pytest.mark.parametrize(('conditions', 'path', 'words'), [
    ({'positions': [0.5]}, 'positions', 'pairs of a share of the span'),
    ({'velocities': [1.5, 0.0]}, 'velocities', 'pairs of a share of the span'),
    ({'accelerations': 'fast'}, 'accelerations', 'pairs of a share of the span'),
    ({'positions': [0.5, math.nan]}, 'positions', 'pairs of a share of the span'),
    ({'positions': [0.0, 0.0]}, 'law', 'always there'),
    ({'positions': [0.3, 0.2, 0.3, 0.4]}, 'law', 'contradict'),
    ({'jerks': [1.0, 0.0, 1.0, 1.0]}, 'law', 's′′′(1) = 1'),
    ({'positions': [x for n in range(15) for x in (n / 20 + 0.1, 0.5)]}, 'law',
     f'at most {MOST_CONDITIONS}'),
    ({'positions': [0.3, 0.0, 0.3 + 1e-15, 1.0]}, 'law', 'only rounding tells them apart'),
])
def test_conditions_that_make_no_polynomial_are_refused(conditions, path, words):
    problem, = refusal('flexible_polynomial', **conditions)
    assert problem.path == path and words in str(problem)


def test_all_lists_that_are_wrong_are_told_at_once():
    assert [p.path for p in refusal('flexible_polynomial', positions=[1.0], jerks=[2.0, 1.0])] == [
        'positions', 'jerks']
