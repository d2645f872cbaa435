# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The classic laws to and from turns and constant velocities, by identities and closed forms."""

import math
from math import pi, sqrt

from cam_motion.errors import ConfigurationError
from cam_motion.motion.continuity import continuity_of, curve_joints
from cam_motion.motion.laws import Boundary, laws_between, make_law
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-12
INTEGRATED = 1e-10  # of the third derivative of two formulas of one law
XI = np.linspace(0.0, 1.0, 401)
K = 1.0 - 2.0 / pi  # what a quarter sine loses against a rectangle
R, V, T = Boundary.REST, Boundary.CONSTANT_VELOCITY, Boundary.TURN
ENDS = {
    'acceleration_trapezoid_rt': (R, T), 'acceleration_trapezoid_tr': (T, R),
    'acceleration_trapezoid_rv': (R, V), 'acceleration_trapezoid_vr': (V, R),
    'harmonic_combination_rt': (R, T), 'harmonic_combination_tr': (T, R),
    'harmonic_combination_vt': (V, T), 'harmonic_combination_tv': (T, V),
    'modified_sine_vv': (V, V),
}


def assert_same(law, other):
    """Compare two laws in all derivatives, away from the joints."""
    xi = (np.arange(997) + 0.5) / 997
    for order in range(4):
        scale = abs(other.curve.peak(order).value) + 1.0
        assert law(xi, order) == pytest.approx(other(xi, order), abs=INTEGRATED * scale)


@pytest.mark.parametrize('name', ENDS)
def test_each_variant_ends_as_it_is_named_and_is_offered_there(name):
    law = make_law(name)
    assert law.ends == ENDS[name]
    assert name in laws_between(*ENDS[name])
    assert law.curve.end_values(0) == pytest.approx((0.0, 1.0), abs=ROUNDING)
    assert all(joint.continuity >= 3 for joint in curve_joints(law.curve))
    assert law(XI, 1).min() > -ROUNDING


@pytest.mark.parametrize(('name', 'back'), [
    ('acceleration_trapezoid_rt', 'acceleration_trapezoid_tr'),
    ('acceleration_trapezoid_rv', 'acceleration_trapezoid_vr'),
    ('harmonic_combination_rt', 'harmonic_combination_tr'),
    ('harmonic_combination_vt', 'harmonic_combination_tv')])
def test_a_variant_and_its_return_are_one_curve_turned_round(name, back):
    assert make_law(back)(XI) == pytest.approx(1.0 - make_law(name)(1.0 - XI), abs=ROUNDING)


few = settings(max_examples=20, deadline=None)
blends = st.integers(1, 26).map(lambda n: n / 100.0)
shares = st.integers(5, 95).map(lambda n: n / 100.0)
velocities = st.integers(-40, 60).map(lambda n: n / 20.0)


@few
@given(blends)
def test_the_trapezoid_to_a_turn_is_the_seven_stage_law_without_its_last_stage(blend):
    split = 0.5 * (1.0 + blend * K)
    assert_same(make_law('acceleration_trapezoid_rt', blend=blend), make_law(
        'modified_trapezoid',
        fractions=(blend, split - 2 * blend, blend, 0, blend, 1 - split - blend, 0)))


@few
@given(blends)
def test_the_trapezoid_to_a_turn_has_equal_plateaus_and_no_step_of_the_jerk_inside(blend):
    curve = make_law('acceleration_trapezoid_rt', blend=blend).curve
    least, greatest = curve.extremes(2)
    assert least.value == pytest.approx(-greatest.value, rel=ROUNDING)
    assert curve.jumps(3) == []
    # speed at the change of sign: a hump of two blends
    area = 0.5 * (1.0 + blend * K) - 2.0 * blend * K
    assert curve.peak(1).value == pytest.approx(greatest.value * area, rel=1e-11)


@few
@given(st.integers(1, 50).map(lambda n: n / 100.0))
def test_the_single_trapezoid_reaches_twice_the_mean_velocity(blend):
    curve = make_law('acceleration_trapezoid_rv', blend=blend).curve
    assert curve.end_values(1) == pytest.approx((0.0, 2.0), abs=ROUNDING)
    assert curve.peak(2).value == pytest.approx(2.0 / (1.0 - 2.0 * blend * K), rel=ROUNDING)
    assert curve(XI, 1) + curve(1.0 - XI, 1) == pytest.approx(2.0, abs=1e-11)


def test_with_half_its_span_blended_the_single_trapezoid_is_half_a_cycloid():
    law = make_law('acceleration_trapezoid_rv', blend=0.5)
    assert law(XI) == pytest.approx(XI - np.sin(pi * XI) / pi, abs=ROUNDING)


@few
@given(shares)
def test_the_harmonic_combination_to_a_turn_is_the_modified_sine_without_its_last_stage(share):
    assert_same(make_law('harmonic_combination_rt', inflection=share), make_law(
        'modified_trapezoid', fractions=(share / 4, 0, 3 * share / 4, 0, 1 - share, 0, 0)))


def test_by_default_its_jerk_runs_through_the_change_of_sign():
    law = make_law('harmonic_combination_rt')
    assert law.curve.jumps(3) == []
    assert law.parameters['inflection'] == pytest.approx(4.0 - 2.0 * sqrt(3.0), rel=ROUNDING)
    assert make_law('harmonic_combination_rt', inflection=0.5).curve.jumps(3) != []
    assert law.curve.end_values(3)[1] == pytest.approx(0.0, abs=1e-11)  # no jerk at the turn


def test_from_constant_velocity_to_a_turn_it_is_a_quarter_of_a_sine():
    law = make_law('harmonic_combination_vt')
    for order, expected in enumerate((np.sin(pi * XI / 2), pi / 2 * np.cos(pi * XI / 2),
                                      -pi ** 2 / 4 * np.sin(pi * XI / 2))):
        assert law(XI, order) == pytest.approx(expected, abs=ROUNDING)
    back = make_law('harmonic_combination_tv')
    assert back(XI) == pytest.approx(1.0 - np.cos(pi * XI / 2), abs=ROUNDING)


@few
@given(shares)
def test_with_a_straight_line_before_its_velocity_is_the_closed_form(share):
    curve = make_law('harmonic_combination_vt', inflection=share).curve
    velocity = 1.0 / (1.0 - (1.0 - share) * K)
    assert curve.end_values(1) == pytest.approx((velocity, 0.0), abs=ROUNDING)
    again = make_law('harmonic_combination_vt', start_velocity=velocity).curve
    assert again(XI) == pytest.approx(curve(XI), abs=1e-11)
    assert curve.jumps(1) == [] and curve.jumps(2) == []


@few
@given(velocities, velocities, shares)
def test_the_modified_sine_joins_any_two_velocities(start, end, share):
    curve = make_law('modified_sine_vv', start_velocity=start, end_velocity=end,
                     inflection=share).curve
    size = abs(curve.peak(2).value) + 1.0
    assert curve.end_values(0) == pytest.approx((0.0, 1.0), abs=ROUNDING * size)
    assert curve.end_values(1) == pytest.approx((start, end), abs=ROUNDING * size)
    assert curve.end_values(2) == pytest.approx((0.0, 0.0), abs=1e-13 * size)
    assert curve.jumps(1) == [] and curve.jumps(2) == []


def test_between_rests_and_on_a_line_the_modified_sine_is_what_it_must_be():
    assert_same(make_law('modified_sine_vv', start_velocity=0.0, end_velocity=0.0),
                make_law('modified_sine'))
    line = make_law('modified_sine_vv', start_velocity=1.0, end_velocity=1.0)
    assert line(XI) == pytest.approx(XI, abs=ROUNDING)
    assert_same(make_law('modified_sine_vv', start_velocity=0.0, end_velocity=0.0,
                         inflection=0.3), make_law('modified_sine', inflection=0.3))


@few
@given(velocities, shares)
def test_the_harmonic_combination_meets_any_velocity_with_two_humps(velocity, share):
    curve = make_law('harmonic_combination_vt', start_velocity=velocity, inflection=share).curve
    size = abs(curve.peak(2).value) + 1.0
    assert curve.end_values(1) == pytest.approx((velocity, 0.0), abs=ROUNDING * size)
    assert curve.end_values(2)[0] == pytest.approx(0.0, abs=ROUNDING * size)
    assert curve.end_values(0)[1] == pytest.approx(1.0, abs=ROUNDING * size)
    back = make_law('harmonic_combination_tv', end_velocity=velocity,
                    inflection=1.0 - share).curve
    assert back(XI) == pytest.approx(1.0 - curve(1.0 - XI), abs=ROUNDING * size)


def test_a_program_of_variants_runs_without_a_step_of_velocity_or_acceleration():
    velocity = 0.4 / 90.0  # per degree
    quarter = velocity * 60.0 * 2.0 / pi  # lift of a quarter sine that starts with it
    bend = -quarter * pi ** 2 / 4.0 / 60.0 ** 2  # at the turn, per degree²
    back = bend * 120.0 ** 2 / make_law('acceleration_trapezoid_tr').curve.end_values(2)[0]
    found = continuity_of(CamProfile([
        segment('start', 90.0, 0.2, 'acceleration_trapezoid_rv'),
        segment('along', 180.0, 0.4, 'constant_velocity'),
        segment('turn', 240.0, quarter, 'harmonic_combination_vt'),
        segment('back', 360.0, back, 'acceleration_trapezoid_tr'),
    ], accumulate=True))
    # at the turn the quarter sine has no jerk and the trapezoid stands on its plateau
    assert [each.joint.label for each in found.joints] == ['C2', 'C2', 'C2', 'C3']


@pytest.mark.parametrize(('name', 'parameters', 'path', 'words'), [
    ('acceleration_trapezoid_rt', {'blend': 0.0}, 'blend', 'above 0'),
    ('acceleration_trapezoid_rt', {'blend': 0.28}, 'blend', 'at most 0.27'),
    ('acceleration_trapezoid_rv', {'blend': 0.51}, 'blend', 'at most 0.5'),
    ('acceleration_trapezoid_vr', {'blend': 0.0}, 'blend', 'above 0'),
    ('harmonic_combination_rt', {'inflection': 1.0}, 'inflection', 'below 1'),
    ('harmonic_combination_tr', {'inflection': 0.0}, 'inflection', 'above 0'),
    ('harmonic_combination_vt', {'start_velocity': 1.0}, 'start_velocity', 'above 1'),
    ('harmonic_combination_vt', {'start_velocity': 0.0}, 'start_velocity', 'above 1'),
    ('harmonic_combination_tv', {'end_velocity': 2.0}, 'end_velocity', 'at most pi/2'),
    ('harmonic_combination_tv', {'inflection': 0.0}, 'inflection', 'above 0'),
    ('modified_sine_vv', {'inflection': 1.0}, 'inflection', 'below 1'),
    ('modified_sine_vv', {'start_velocity': math.nan}, 'start_velocity', 'lifts per span'),
])
def test_parameters_that_make_no_law_are_refused(name, parameters, path, words):
    with pytest.raises(ConfigurationError) as caught:
        make_law(name, **parameters)
    problem, = caught.value.problems
    assert problem.path == path and words in str(problem)


@pytest.mark.parametrize(('parameters', 'path', 'words'), [
    ({'coefficients': [0.0, 0.5, 1.0]}, 'coefficients', 'of degree 5'),
    ({'coefficients': [0.1, 0.0, 0.0, 1.0, 1.0, 1.0]}, 'coefficients', 'from 0'),
    ({'coefficients': [0.0, 0.0, 0.0, 1.0, 1.0, 0.9]}, 'coefficients', 'to 1'),
    ({'degree': 5.5}, 'degree', 'whole number'), ({'degree': 10.0}, 'degree', 'from 2 to 9'),
])
def test_coefficients_that_make_no_b_spline_are_refused(parameters, path, words):
    with pytest.raises(ConfigurationError) as caught:
        make_law('b_spline', **parameters)
    problem, = caught.value.problems
    assert problem.path == path and words in str(problem)


def test_the_shortest_b_spline_is_the_polynomial_345_and_rests_exactly():
    assert_same(make_law('b_spline'), make_law('polynomial_345'))
    curve = make_law('b_spline', coefficients=[0, 0, 0, .3, .2, .6, 1, 1, 1]).curve
    assert [curve.end_values(order)[0] for order in range(3)] == [0.0, 0.0, 0.0]
    assert curve.end_values(2)[1] == pytest.approx(0.0, abs=1e-12)
