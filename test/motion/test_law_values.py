# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The laws against closed forms, printed tables and each other."""

import math
from math import pi, sqrt

from cam_motion.errors import ConfigurationError
from cam_motion.motion.laws import LAWS, make_law
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

CLOSED_FORM = 1e-12  # both sides are exact: only rounding is left
ROUNDING_IN_SOURCE = 6e-5  # half a unit of the last of five printed digits (relative)
EQUAL_MEMBERS = 2e-12  # two formulas of the same law, rounded differently
INF = math.inf


def coefficients(law, **parameters):
    """Give Cv, Ca, Cj, power and RMS acceleration of a law."""
    found = make_law(law, **parameters).coefficients
    return found.cv, found.ca, found.cj, found.power, found.rms_acceleration


E = 0.2
TRAPEZOID = (1 / (1 - E), 1 / (E * (1 - E)), INF, 1 / (E * (1 - E) ** 2),
             sqrt(2 * E) / (E * (1 - E)))
CLOSED_FORMS = [
    # name, parameters, (Cv, Ca, Cj, power, rms of acceleration)
    ('dwell', {}, (0.0, 0.0, 0.0, 0.0, 0.0)),
    ('constant_velocity', {}, (1.0, 0.0, 0.0, 0.0, 0.0)),  # between lines of its velocity
    ('constant_acceleration', {}, (2.0, 4.0, INF, 8.0, 4.0)),
    ('constant_acceleration', {'ramp_up': 1 / 3}, (2.0, 6.0, INF, 12.0, sqrt(18.0))),
    ('trapezoidal_velocity', {'ramp_up': E}, TRAPEZOID),
    ('trapezoidal_velocity', {}, (1.5, 4.5, INF, 6.75, 4.5 * sqrt(2 / 3))),
    ('trapezoidal_velocity', {'ramp_up': 0.2, 'ramp_down': 0.4},
     (1 / 0.7, 1 / 0.14, INF, 1 / 0.098, sqrt(0.2 / 0.14**2 + 0.4 / 0.28**2))),
    ('trapezoidal_velocity', {'ramp_up': 0.0, 'ramp_down': 0.0}, (1.0, 0.0, 0.0, 0.0, 0.0)),
    ('cubic', {}, (1.5, 6.0, INF, 2 * sqrt(3.0), sqrt(12.0))),
    ('cycloidal', {}, (2.0, 2 * pi, 4 * pi**2, 1.5 * pi * sqrt(3.0), pi * sqrt(2.0))),
]


@pytest.mark.parametrize(('law', 'parameters', 'expected'), CLOSED_FORMS)
def test_coefficients_are_the_closed_forms(law, parameters, expected):
    assert coefficients(law, **parameters) == pytest.approx(expected, rel=CLOSED_FORM)


def test_the_modified_trapezoid_of_eighths_has_its_closed_forms():
    found = make_law('modified_trapezoid').coefficients
    assert found.cv == pytest.approx(2.0, rel=CLOSED_FORM)
    assert found.ca == pytest.approx(8 * pi / (2 + pi), rel=CLOSED_FORM)
    assert found.cj == pytest.approx(32 * pi**2 / (2 + pi), rel=CLOSED_FORM)
    assert found.cj_inside == found.cj


# Stages of the modified trapezoid and what tables print for them: Cv, Ca, Cj inside, power, RMS.
PRINTED = {
    'eighths': ((1 / 8, 1 / 4, 1 / 8, 0, 1 / 8, 1 / 4, 1 / 8),
                (2.0, 4.8881, 61.426, 8.0900, 4.2332)),
    'sixteenths': ((1 / 16, 3 / 8, 1 / 16, 0, 1 / 16, 3 / 8, 1 / 16),
                   (2.0, 4.3997, 110.58, 8.0657, 4.1155)),
    'skewed 40 to 60': ((.1, .2, .1, 0, .15, .3, .15), (2.0, 6.110, 95.98, 10.11, 4.3205)),
    'seven equal parts': ((1 / 7,) * 7, (1.75, 5.3888, 59.253, 7.2333, 4.0735)),
    'simple harmonic': ((0, 0, 1 / 2, 0, 1 / 2, 0, 0), (1.5708, 4.9348, 15.503, 3.8758, 3.4894)),
    'modified sine': ((1 / 8, 0, 3 / 8, 0, 3 / 8, 0, 1 / 8),
                      (1.7596, 5.5280, 69.466, 5.4578, 3.9089)),
    'modified constant velocity 50': ((1 / 16, 0, 3 / 16, 1 / 2, 3 / 16, 0, 1 / 16),
                                      (1.2753, 8.0127, 201.38, 5.73, 4.01)),
}
FEW_DIGITS = {'skewed 40 to 60': 5e-4, 'modified constant velocity 50': 1e-3}


@pytest.mark.parametrize('member', PRINTED)
def test_members_of_the_modified_trapezoid_have_the_printed_coefficients(member):
    fractions, expected = PRINTED[member]
    found = make_law('modified_trapezoid', fractions=fractions).coefficients
    values = (found.cv, found.ca, found.cj_inside, found.power, found.rms_acceleration)
    assert values == pytest.approx(expected, rel=FEW_DIGITS.get(member, ROUNDING_IN_SOURCE))


def test_the_skewed_member_has_a_smaller_deceleration():
    law = make_law('modified_trapezoid', fractions=PRINTED['skewed 40 to 60'][0])
    least, greatest = law.curve.extremes(2)
    assert (least.value, greatest.value) == pytest.approx((-4.073, 6.110), rel=2e-4)


def test_the_jerk_is_infinite_exactly_where_the_acceleration_steps():
    finite = [name for name in LAWS if math.isfinite(make_law(name).coefficients.cj)]
    assert {'dwell', 'cycloidal', 'modified_trapezoid'} <= set(finite)
    assert not {'cubic', 'constant_acceleration', 'trapezoidal_velocity'} & set(finite)
    harmonic = make_law('modified_trapezoid', fractions=(0, 0, .5, 0, .5, 0, 0)).coefficients
    assert harmonic.cj == INF and harmonic.cj_inside == pytest.approx(pi**3 / 2)


def test_laws_that_end_at_a_velocity_are_judged_between_neighbours_of_that_velocity():
    moving = [make_law(name) for name in LAWS if any(end.moves for end in make_law(name).ends)]
    assert len(moving) == 6
    for law in moving:
        found = law.coefficients
        assert all(map(math.isfinite, (found.ca, found.power, found.rms_acceleration)))
    found = make_law('acceleration_trapezoid_rv').coefficients
    assert found.ca == pytest.approx(2 / (1 - 0.25 * (1 - 2 / pi)), rel=CLOSED_FORM)
    assert (found.ca_greatest, found.ca_least) == pytest.approx((found.ca, 0.0), abs=1e-12)
    with_a_turn = make_law('harmonic_combination_vt').coefficients
    assert with_a_turn.ca == pytest.approx(pi**2 / 4, rel=CLOSED_FORM) and with_a_turn.cj == INF


def test_both_signs_of_the_acceleration_are_told():
    found = make_law('double_harmonic').coefficients
    assert (found.ca_greatest, found.ca_least) == pytest.approx((5.5517, -pi**2), rel=1e-5)
    assert found.ca == -found.ca_least


def test_members_with_names_have_the_coefficients_of_the_catalogue():
    printed = {'MT 1/16': (2, 4.3997), 'MT 40/60': (2, 6.110),
               'MT of seven equal parts': (1.75, 5.3888), 'MCV20': (1.5275, 5.9986),
               'MCV33': (1.4041, 6.6166), 'MCV50': (1.2753, 8.0127),
               'cycloidal CV50': (1.3333, 8.3776)}
    named = {member.name: make_law(name, **member.parameters).coefficients
             for name, law in LAWS.items() for member in law.members}
    assert named.keys() == printed.keys()
    for name, (cv, ca) in printed.items():
        assert (named[name].cv, named[name].ca) == pytest.approx((cv, ca), rel=ROUNDING_IN_SOURCE)


def test_summaries_claim_nothing_that_another_law_refutes():
    rests = {name: make_law(name).coefficients for name in LAWS}
    # MCV20 and MCV33 take less power than the modified sine, the 3-4-5 less than Freudenstein's
    assert 'least' not in LAWS['modified_sine'].summary
    assert 'torque' not in LAWS['freudenstein_13'].summary
    assert rests['freudenstein_13'].cj < rests['gutman_13'].cj
    assert rests['freudenstein_13'].ca > rests['gutman_13'].ca > rests['freudenstein_135'].ca


def test_the_cubic_has_the_least_rms_acceleration_of_all():
    least = make_law('cubic').coefficients.rms_acceleration
    others = [law.coefficients.rms_acceleration for law in map(make_law, LAWS)
              if law.name not in ('dwell', 'cubic') and not any(end.moves for end in law.ends)]
    assert all(value >= least for value in others)


E4 = 0.25
MEMBERS = {
    'cycloidal': ((.25, 0, .25, 0, .25, 0, .25), 'cycloidal', {}),
    'constant acceleration': ((0, .5, 0, 0, 0, .5, 0), 'constant_acceleration', {}),
    'trapezoidal velocity': ((0, E4, 0, 1 - 2 * E4, 0, E4, 0), 'trapezoidal_velocity',
                             {'ramp_up': E4}),
    'asymmetric trapezoidal velocity': ((0, .3, 0, .2, 0, .5, 0), 'trapezoidal_velocity',
                                        {'ramp_up': .3, 'ramp_down': .5}),
}


@pytest.mark.parametrize('order', range(4))
@pytest.mark.parametrize('name', MEMBERS)
def test_degenerate_members_agree_with_the_law_they_are(name, order):
    fractions, law, parameters = MEMBERS[name]
    member = make_law('modified_trapezoid', fractions=fractions)
    other = make_law(law, **parameters)
    xi = (np.arange(997) + 0.5) / 997
    scale = abs(other.curve.peak(order).value) + 1.0
    assert member(xi, order) == pytest.approx(other(xi, order), rel=0, abs=EQUAL_MEMBERS * scale)


def test_the_simple_harmonic_member_is_half_a_cosine():
    member = make_law('modified_trapezoid', fractions=(0, 0, .5, 0, .5, 0, 0))
    xi = np.linspace(0.0, 1.0, 101)
    assert member(xi) == pytest.approx(0.5 - 0.5 * np.cos(pi * xi), abs=EQUAL_MEMBERS)
    assert member(xi, 2) == pytest.approx(0.5 * pi**2 * np.cos(pi * xi), abs=1e-11)


@given(st.lists(st.integers(0, 20), min_size=7, max_size=7).filter(
    lambda n: sum(n[:3]) > 0 and sum(n[4:]) > 0))
def test_the_modified_trapezoid_has_the_plateaus_of_the_printed_formula(parts):
    x1, x2, x3, x4, x5, x6, x7 = fractions = [part / sum(parts) for part in parts]
    k1 = 2 * x1 / pi + x2 + 2 * x3 / pi
    k2 = 2 * x5 / pi + x6 + 2 * x7 / pi
    t = x1 + x2 + x3 + x4
    m1 = ((2 * x1 / pi) ** 2 + x2 * (x1 + x2 / 2)
          + (2 * x3 / pi) * (x1 + x2 + x3 - 2 * x3 / pi))
    m2 = ((2 * x5 / pi) * (t + 2 * x5 / pi) + x6 * (t + x5 + x6 / 2)
          + (2 * x7 / pi) * (1 - 2 * x7 / pi))
    v = 1 / (m2 / k2 - m1 / k1)
    law = make_law('modified_trapezoid', fractions=fractions)
    assert law.coefficients.cv == pytest.approx(v, rel=CLOSED_FORM)
    least, greatest = law.curve.extremes(2)
    assert greatest.value == pytest.approx(v / k1, rel=CLOSED_FORM)
    assert least.value == pytest.approx(-v / k2, rel=CLOSED_FORM)
    if x2 > 0.0:
        assert law(x1 + x2 / 2, 2) == pytest.approx(v / k1, rel=CLOSED_FORM)
    if x4 > 0.0:
        assert law(t - x4 / 2, 1) == pytest.approx(v, rel=CLOSED_FORM)
        assert law(t - x4 / 2, 2) == 0.0


def test_a_law_misspelt_is_answered_with_those_that_are_like_it():
    with pytest.raises(ConfigurationError) as caught:
        make_law('modifed_sine')
    problem, = caught.value.problems
    assert problem.hint.startswith('did you mean modified_sine')
    assert 'known are: cycloidal' in problem.hint
