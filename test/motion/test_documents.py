# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The figures of the source documents 000, 001 and 002, corrected where they are misprinted."""

from math import inf, nan, pi, sqrt

from cam_motion import CamProfile, make_law, PointToPoint, segment
from cam_motion.errors import ConfigurationError
from cam_motion.units import DEGREE, RPM
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

EXACT = 1e-12
ELEVEN_DIGITS = 5e-11  # half a unit of the last digit of figures given to ten decimals
FIVE_DIGITS = 1e-5


@pytest.fixture(scope='module')
def exercise():
    """Make the cam of document 000: rise and return between dwells, in degrees."""
    return CamProfile([
        segment('low', 60.0),
        segment('rise', 120.0, 20.0, 'cycloidal'),
        segment('high', 180.0),
        segment('fall', 240.0, -20.0, 'modified_trapezoid'),
        segment('rest', 360.0),
    ])


@pytest.mark.parametrize(('at_deg', 'expected'), [
    (0.0, 0.0), (60.0, 0.0), (75.0, 1.8169011382), (90.0, 10.0), (120.0, 20.0), (150.0, 20.0),
    (210.0, 10.0), (240.0, 0.0), (300.0, 0.0),
])
def test_document_000_adds_the_lifts_before_a_segment(exercise, at_deg, expected):
    assert exercise.sample(at_deg * DEGREE)[0] == pytest.approx(expected, abs=ELEVEN_DIGITS)
    assert float(exercise(at_deg * DEGREE)) == pytest.approx(expected, abs=ELEVEN_DIGITS)


def test_document_000_peaks_of_the_rise_are_per_radian(exercise):
    rise = exercise.segment_peaks[1]
    assert rise.start_deg == pytest.approx(60.0)
    assert rise.velocity.value * DEGREE == pytest.approx(2.0 / 3.0, rel=EXACT)
    assert rise.velocity.at == pytest.approx(90.0 * DEGREE)
    # 2 pi * 20 deg / (60 deg)² is 2 rad/rad²
    assert rise.acceleration.value * DEGREE == pytest.approx(2.0, rel=EXACT)
    assert rise.acceleration.at == pytest.approx(75.0 * DEGREE)


def test_document_000_peaks_of_the_fall_follow_the_coefficients(exercise):
    fall, span = exercise.segment_peaks[3], pi / 3.0
    assert fall.velocity.value == pytest.approx(-2.0 * 20.0 / span, rel=EXACT)
    assert abs(fall.acceleration.value) == pytest.approx(
        8 * pi / (2 + pi) * 20.0 / span**2, rel=EXACT)
    assert abs(fall.jerk.value) == pytest.approx(
        32 * pi**2 / (2 + pi) * 20.0 / span**3, rel=EXACT)


@pytest.fixture(scope='module')
def feeder():
    """Make the feeder of document 001 with constant acceleration."""
    return CamProfile([
        segment('feed', 80.0, 0.3, 'constant_acceleration'), segment('wait', 360.0),
    ], accumulate=True)


def test_document_001_feeder_has_the_printed_peaks(feeder):
    peaks = feeder.segment_peaks[0]
    assert peaks.velocity.value == pytest.approx(0.42972, rel=FIVE_DIGITS)
    assert abs(peaks.acceleration.value) == pytest.approx(0.61553, rel=FIVE_DIGITS)


def test_document_001_feeder_reaches_9_m_per_s_and_270_m_per_s2_at_200_cycles_per_minute(feeder):
    _, velocity, acceleration = feeder.at_speed(20.0 * DEGREE, 200.0 * RPM)
    assert velocity == pytest.approx(4.5, rel=EXACT)
    assert acceleration == pytest.approx(270.0, rel=EXACT)
    assert feeder.at_speed(40.0 * DEGREE, 200.0 * RPM)[1] == pytest.approx(9.0, rel=EXACT)


shares = st.integers(1, 99).map(lambda n: n / 100.0)


@given(shares, shares)
def test_document_001_asymmetric_trapezoid_has_the_printed_accelerations(one, other):
    v, w = sorted((one, other))
    law = make_law('trapezoidal_velocity', ramp_up=v, ramp_down=1.0 - w)
    peak_speed = 2.0 / (1.0 - v + w)
    a = 2.0 / (v * (1.0 - v + w))
    b = 2.0 / ((1.0 - w) * (1.0 - v + w))
    least, greatest = law.curve.extremes(2)
    assert (least.value, greatest.value) == pytest.approx((-b, a), rel=EXACT)
    assert law.curve.peak(1).value == pytest.approx(peak_speed, rel=EXACT)
    xi = np.linspace(0.0, 1.0, 201)
    printed = np.where(
        xi < v, a * xi**2 / 2,
        np.where(xi < w, a * v * (xi - v / 2), 1.0 - b * (1.0 - xi) ** 2 / 2))
    assert law(xi) == pytest.approx(printed, rel=0, abs=EXACT)


def test_document_002_three_step_example():
    move = PointToPoint(make_law('trapezoidal_velocity', ramp_up=0.333), 5.0, 5.0, 10.0)
    assert float(move(2.5, 1)) == pytest.approx(2.9985007496, abs=ELEVEN_DIGITS)
    assert float(move(1.0)) == pytest.approx(5.9004506756, abs=ELEVEN_DIGITS)
    assert float(move(2.5)) == pytest.approx(10.0, rel=EXACT)
    # the document prints A = V / (t0 - t1), of the wrong sign
    assert float(move(0.5, 2)) == pytest.approx(2.9985007496 / 1.665, rel=1e-10)


def test_document_002_cycloidal_coefficients():
    law = make_law('cycloidal')
    power = law.curve.peak_power()
    assert (law.coefficients.cv, law.coefficients.ca) == pytest.approx((2.0, 2 * pi), rel=EXACT)
    assert power == pytest.approx((1.5 * pi * sqrt(3.0), 1.0 / 3.0), rel=1e-9)


def test_a_movement_in_time_stands_before_it_begins_and_after_it_ends():
    move = PointToPoint(make_law('cubic'), 2.0, 1.0, -3.0)
    t = np.array([[-5.0, 0.0], [2.0, 9.0]])
    assert move(t).tolist() == [[1.0, 1.0], [-2.0, -2.0]]
    assert move(t, 1) == pytest.approx(0.0, abs=EXACT)
    assert move(t, 2) == pytest.approx(np.array([[0.0, -4.5], [4.5, 0.0]]), abs=EXACT)
    assert float(move(1.0, 1)) == pytest.approx(-2.25)
    assert move(1.0).shape == ()


def test_a_movement_backwards_mirrors_the_one_forwards():
    forward = PointToPoint(make_law('trapezoidal_velocity', ramp_up=0.2), 3.0, 1.0, 4.0)
    back = PointToPoint(make_law('trapezoidal_velocity', ramp_up=0.2), 3.0, 5.0, -4.0)
    t = np.linspace(0.1, 2.9, 29)
    for order in range(3):
        assert back(t, order) + forward(t, order) == pytest.approx(
            6.0 if order == 0 else 0.0, abs=EXACT)


@pytest.mark.parametrize(('given_values', 'paths'), [
    ((0.0, 0.0, 1.0), ['duration']), ((-1.0, 0.0, 1.0), ['duration']),
    ((nan, 0.0, 1.0), ['duration']), ((inf, nan, -inf), ['duration', 'start', 'displacement']),
])
def test_a_movement_that_cannot_be_is_refused_with_all_problems(given_values, paths):
    with pytest.raises(ConfigurationError) as caught:
        PointToPoint(make_law('cubic'), *given_values)
    assert [problem.path for problem in caught.value.problems] == paths
