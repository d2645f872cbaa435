# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The catalogue of laws against the field's table of coefficients, and its families."""

import math
from math import pi, sqrt

from cam_motion.errors import ConfigurationError
from cam_motion.motion.laws import Boundary, LAWS, laws_between, make_law
from cam_motion.motion.laws.inflection import INFLECTION
from hypothesis import example, given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

CLOSED_FORM = 1e-12  # both sides are exact: only rounding is left
LAST_DIGIT = 0.51  # of the last digit printed in the table
EQUAL_MEMBERS = 2e-12  # two formulas of the same law, rounded differently
SYMMETRY = 1e-11  # rounding of a polynomial of degree 11 with coefficients of thousands
NO_ROUND = 1e-10  # the same in its third derivative
XI = np.linspace(0.0, 1.0, 401)

# The field's table: Cv, Ca, Cj between steps, power, RMS acceleration; None where it has no value.
FIELD = [
    ('simple_harmonic', {}, '1.5708', '4.9348', '15.503', '3.8758', '3.4894'),
    ('cycloidal', {}, '2', '6.2832', '39.478', '8.1621', '4.4429'),
    ('cubic', {}, '1.5', '6', '12', '3.4641', '3.4641'),
    ('polynomial_345', {}, '1.875', '5.7735', '60', '6.6943', '4.1404'),
    ('polynomial_4567', {}, '2.1875', '7.5132', '52.5', '10.7502', '5.0452'),
    ('polynomial_5_to_9', {}, '2.4609', '9.3720', '78.75', '15.436', '5.9367'),
    ('polynomial_6_to_11', {}, '2.7070', '11.2666', '108.28', '20.669', '6.7979'),
    ('polynomial_8', {}, '1.7767', '5.2683', '36.585', '5.8621', None),
    ('polynomial_8_return', {}, '1.7767', '5.2683', '36.585', '5.8621', None),
    ('modified_sine', {}, '1.7596', '5.5280', '69.466', '5.4578', '3.9089'),
    ('universal', {}, '2', '4.8881', '61.426', '8.0900', '4.2332'),
    ('modified_constant_velocity', {'constant_velocity': 0.2},
     '1.5275', '5.9986', None, '5.14', '3.79'),
    ('modified_constant_velocity', {'constant_velocity': 1 / 3},
     '1.4041', '6.6166', None, '5.21', '3.82'),
    ('modified_constant_velocity', {}, '1.2753', '8.0127', '201.38', '5.73', '4.01'),
    ('cycloidal_constant_velocity', {}, '1.3333', '8.3776', None, '7.2552', '4.1888'),
    ('smooth_trapezoidal_velocity', {}, '1.5', '7.0686', '66.62', '6.8868', '4.0810'),
    ('double_harmonic', {}, '2.0405', '9.8696', '42.4', '9.8948', '4.9348'),
    ('double_harmonic_return', {}, '2.0405', '9.8696', '42.4', '9.8948', '4.9348'),
    ('gutman_13', {}, '2', '5.1302', '59.218', '8.1249', '4.2477'),
    ('freudenstein_13', {}, '2', '5.3856', '50.758', '7.9175', '4.3106'),
    ('freudenstein_135', {}, '2', '5.0603', '59.615', '7.8501', '4.2518'),
    ('polynomial', {'end_velocity': 1.0}, '1.5120', '3.9402', '36', None, None),
    ('polynomial', {'start_velocity': 0.5, 'end_velocity': 0.5},
     '1.4375', '2.8868', '30', None, None),
    ('polynomial', {'end_velocity': 2.0}, '2', '3.0', '12', None, None),
]


@pytest.mark.parametrize('row', FIELD, ids=lambda row: f'{row[0]} {row[1] or ""}'.strip())
def test_coefficients_agree_with_every_digit_of_the_field_s_table(row):
    name, parameters, *printed = row
    law = make_law(name, **parameters)
    found = (*(abs(law.curve.peak(n).value) for n in (1, 2, 3)),
             abs(law.curve.peak_power().value), law.curve.rms(2))
    for value, digits in zip(found, printed):
        if digits is not None:
            unit = 10.0 ** -len(digits.partition('.')[2])
            assert value == pytest.approx(float(digits), rel=1e-12, abs=LAST_DIGIT * unit)


CLOSED_FORMS = {  # Cv, Ca, Cj
    'simple_harmonic': (pi / 2, pi**2 / 2, math.inf),
    'polynomial_345': (15 / 8, 10 / sqrt(3.0), 60.0),
    'polynomial_4567': (35 / 16, 84 * sqrt(5.0) / 25, 52.5),
    'modified_sine': (4 * pi / (4 + pi), 4 * pi**2 / (4 + pi), 16 * pi**3 / (4 + pi)),
    'gutman_13': (2.0, None, 6 * pi**2),
    'freudenstein_13': (2.0, None, 4 * pi**2 * 36 / 28),
    'cycloidal_constant_velocity': (4 / 3, 8 * pi / 3, 32 * pi**2 / 3),
    'smooth_trapezoidal_velocity': (1.5, 2.25 * pi, 6.75 * pi**2),
    'double_harmonic': (None, pi**2, math.inf),
}


@pytest.mark.parametrize('name', CLOSED_FORMS)
def test_coefficients_are_the_closed_forms(name):
    found = make_law(name).coefficients
    for value, expected in zip((found.cv, found.ca, found.cj), CLOSED_FORMS[name]):
        if expected is not None:
            assert value == pytest.approx(expected, rel=CLOSED_FORM)


@pytest.mark.parametrize(('name', 'expected'), [
    ('polynomial_345', (10, -15, 6)), ('polynomial_4567', (35, -84, 70, -20)),
    ('polynomial_5_to_9', (126, -420, 540, -315, 70)),
    ('polynomial_6_to_11', (462, -1980, 3465, -3080, 1386, -252))])
def test_coefficients_of_the_polynomials_are_whole_numbers(name, expected):
    piece, = make_law(name).curve.pieces
    assert piece.coefficients == (0,) * len(expected) + expected


UNIVERSAL = {  # T1 to T6, and the law that it is
    'constant_acceleration': (0.0, 0.5, 0.5, 0.5, 0.5, 1.0),
    'simple_harmonic': (0.0, 0.0, 0.5, 0.5, 1.0, 1.0),
    'cycloidal': (0.25, 0.25, 0.5, 0.5, 0.75, 0.75),
    'modified_trapezoid': (0.125, 0.375, 0.5, 0.5, 0.625, 0.875),
    'modified_sine': (0.125, 0.125, 0.5, 0.5, 0.875, 0.875),
    'modified_constant_velocity': (1 / 16, 1 / 16, 0.25, 0.75, 15 / 16, 15 / 16),
    'cycloidal_constant_velocity': (0.125, 0.125, 0.25, 0.75, 0.875, 0.875),
    'smooth_trapezoidal_velocity': (1 / 6, 1 / 6, 1 / 3, 2 / 3, 5 / 6, 5 / 6),
}
SHARES = {
    'constant_acceleration': (0.0, 1.0, 0.0), 'modified_trapezoid': (0.25, 0.5, 0.25),
    'simple_harmonic': (0.0, 0.0, 1.0), 'modified_sine': (0.25, 0.0, 0.75),
    'cycloidal': (0.5, 0.0, 0.5),
}


def assert_same(law, other):
    """Compare two laws in all derivatives, away from the joints."""
    xi = (np.arange(997) + 0.5) / 997
    for order in range(4):
        scale = abs(other.curve.peak(order).value) + 1.0
        assert law(xi, order) == pytest.approx(
            other(xi, order), rel=0, abs=EQUAL_MEMBERS * scale)


@pytest.mark.parametrize('name', UNIVERSAL)
def test_the_universal_curve_is_each_member_of_its_table(name):
    assert_same(make_law('universal', joints=UNIVERSAL[name]), make_law(name))


@pytest.mark.parametrize('name', SHARES)
def test_the_family_of_shares_is_each_of_its_members(name):
    assert_same(make_law('scca', shares=SHARES[name]), make_law(name))


def test_without_constant_velocity_the_modified_sine_and_the_cycloidal_law_are_left():
    for modified, plain in (('modified_constant_velocity', 'modified_sine'),
                            ('cycloidal_constant_velocity', 'cycloidal')):
        assert_same(make_law(modified, constant_velocity=0.0), make_law(plain))


SYMMETRIC = [name for name, law in LAWS.items()
             if any(parameter is INFLECTION for parameter in law.parameters)]


@pytest.mark.parametrize('name', [*SYMMETRIC, 'cubic', 'universal', 'polynomial', 'auto',
                                  'flexible_polynomial', 'spline', 'smooth_trapezoidal_velocity',
                                  'b_spline', 'modified_sine_vv'])
def test_symmetric_laws_are_symmetric(name):
    law = make_law(name)
    assert law(1.0 - XI) == pytest.approx(1.0 - law(XI), abs=SYMMETRY)
    assert float(law(0.5)) == pytest.approx(0.5, abs=SYMMETRY)


@pytest.mark.parametrize('name', ['double_harmonic', 'polynomial_8'])
def test_a_law_from_rest_to_a_turn_has_a_return_that_mirrors_it(name):
    law, back = make_law(name), make_law(f'{name}_return')
    assert back(XI) == pytest.approx(1.0 - law(1.0 - XI), abs=EQUAL_MEMBERS)
    assert law.ends == (Boundary.REST, Boundary.TURN)
    assert back.ends == (Boundary.TURN, Boundary.REST)


def test_every_law_ends_as_its_kind_says():
    both_rest = {*SYMMETRIC, 'dwell', 'modified_trapezoid', 'universal', 'polynomial', 'auto',
                 'flexible_polynomial', 'spline', 'smooth_trapezoidal_velocity', 'b_spline'
                 } - {'simple_harmonic'}
    both_turn = {'simple_harmonic', 'cubic', 'constant_acceleration', 'trapezoidal_velocity'}
    for name in LAWS:
        ends = make_law(name).ends
        assert (ends == (Boundary.REST,) * 2) == (name in both_rest)
        assert (ends == (Boundary.TURN,) * 2) == (name in both_turn)
    assert make_law('constant_velocity').ends == (Boundary.CONSTANT_VELOCITY,) * 2
    moving = make_law('polynomial', end_velocity=1.0, end_acceleration=-2.0)
    assert moving.ends == (Boundary.REST, Boundary.MOTION)


def test_laws_between_two_conditions_are_those_that_fit_and_those_that_fit_any():
    flexible = ['b_spline', 'polynomial', 'auto', 'flexible_polynomial', 'spline']
    resting = laws_between(Boundary.REST, Boundary.REST)
    assert {'modified_sine', 'polynomial_345', 'cycloidal', *flexible} <= set(resting)
    assert not {'dwell', 'cubic', 'double_harmonic', 'constant_velocity'} & set(resting)
    assert laws_between(Boundary.REST, Boundary.TURN) == [
        'double_harmonic', 'polynomial_8', 'acceleration_trapezoid_rt',
        'harmonic_combination_rt', *flexible]
    assert laws_between(Boundary.REST, Boundary.CONSTANT_VELOCITY) == [
        'acceleration_trapezoid_rv', *flexible]
    assert laws_between(Boundary.TURN, Boundary.CONSTANT_VELOCITY) == [
        'harmonic_combination_tv', *flexible]
    assert laws_between(*(Boundary.CONSTANT_VELOCITY,) * 2) == [
        'constant_velocity', 'modified_sine_vv', *flexible]


inflections = st.integers(2, 98).map(lambda n: n / 100.0)


@settings(max_examples=40)
@given(st.sampled_from(SYMMETRIC), inflections)
@example('freudenstein_135', 0.37)  # its jerk has a fivefold zero in the middle of each half
def test_a_moved_inflection_keeps_the_velocity_and_trades_the_accelerations(name, inflection):
    law, plain = make_law(name, inflection=inflection), make_law(name)
    assert law.curve.end == 1.0
    assert float(law(inflection)) == pytest.approx(inflection, abs=SYMMETRY)
    assert float(law(1.0)) == pytest.approx(1.0, abs=SYMMETRY)
    assert law.coefficients.cv == pytest.approx(plain.coefficients.cv, rel=CLOSED_FORM * 10)
    least, greatest = law.curve.extremes(2)
    ca = plain.coefficients.ca
    assert greatest.value == pytest.approx(ca / (2.0 * inflection), rel=NO_ROUND)
    assert least.value == pytest.approx(-ca / (2.0 - 2.0 * inflection), rel=NO_ROUND)
    assert law.curve.jumps(1) == [] and law.curve.jumps(2) == []
    assert law.ends == plain.ends
    backwards = make_law(name, inflection=1.0 - inflection)
    assert law(XI) == pytest.approx(1.0 - backwards(1.0 - XI), abs=SYMMETRY)


def test_a_moved_inflection_is_the_modified_trapezoid_with_unequal_halves():
    law = make_law('scca', inflection=0.4)
    assert_same(law, make_law('modified_trapezoid', fractions=(.1, .2, .1, 0, .15, .3, .15)))


@given(st.lists(st.integers(0, 40), min_size=6, max_size=6).map(sorted).filter(
    lambda n: n[2] > 0 and n[3] < 40))
def test_the_universal_curve_rests_at_both_ends_with_any_joints(parts):
    law = make_law('universal', joints=[part / 40 for part in parts])
    assert law.curve.end_values(0) == pytest.approx((0.0, 1.0), abs=CLOSED_FORM)
    assert law.curve.end_values(1) == pytest.approx((0.0, 0.0), abs=CLOSED_FORM)
    assert law.curve.jumps(1) == []


@given(st.integers(0, 99).map(lambda n: n / 100.0), st.integers(0, 20), st.integers(0, 20),
       st.integers(1, 20))
def test_the_family_of_shares_runs_at_constant_velocity_in_the_middle(hold, b, c, d):
    total = b + c + d
    law = make_law('scca', shares=[b / total, c / total, d / total], constant_velocity=hold)
    middle = 0.5 + 0.49 * hold * np.linspace(-1.0, 1.0, 11)
    assert law(middle, 1) == pytest.approx(law.coefficients.cv, rel=1e-11)
    assert law(1.0 - XI) == pytest.approx(1.0 - law(XI), abs=SYMMETRY)


@pytest.mark.parametrize(('name', 'parameters', 'path', 'words'), [
    ('polynomial_345', {'inflection': 0.0}, 'inflection', 'above 0 and below 1'),
    ('modified_sine', {'inflection': 1.0}, 'inflection', 'above 0 and below 1'),
    ('cycloidal', {'inflection': math.nan}, 'inflection', 'above 0 and below 1'),
    ('universal', {'joints': [0.5, 0.4, 0.6, 0.6, 0.7, 0.8]}, 'joints', 'never fall'),
    ('universal', {'joints': [0.0, 0.0, 0.0, 0.6, 0.7, 0.8]}, 'joints', 'not all be 0'),
    ('universal', {'joints': [0.1, 0.2, 0.3, 1.0, 1.0, 1.0]}, 'joints', 'not all be 1'),
    ('universal', {'joints': [0.1, 0.2, 0.3]}, 'joints', 'six joints'),
    ('scca', {'shares': [0.2, 0.2, 0.2]}, 'shares', 'they sum to 0.6'),
    ('scca', {'constant_velocity': 1.0}, 'constant_velocity', 'take the law constant_velocity'),
    ('modified_constant_velocity', {'constant_velocity': 1.0}, 'constant_velocity', 'below 1'),
    ('smooth_trapezoidal_velocity', {'ramp_up': 0.0}, 'ramp_up', 'above 0'),
    ('smooth_trapezoidal_velocity', {'ramp_up': 0.3, 'ramp_down': 0.0}, 'ramp_down', 'above 0'),
    ('smooth_trapezoidal_velocity', {'ramp_up': 0.7, 'ramp_down': 0.4}, 'ramp_down', 'is 1.1'),
])
def test_parameters_that_make_no_law_are_refused(name, parameters, path, words):
    with pytest.raises(ConfigurationError) as caught:
        make_law(name, **parameters)
    problem, = caught.value.problems
    assert problem.path == path and words in str(problem)
