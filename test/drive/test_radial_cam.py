# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The radial cam: pressure angle and curvature, against geometry and document 004."""

from math import atan, inf, nan, pi, sqrt

from cam_motion import CamProfile, segment
from cam_motion.errors import ConfigurationError
from cam_motion.mechanism.radial_cam import RadialCam
from cam_motion.units import DEGREE, TURN
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(30)

ROUNDING = 1e-12
GRID = 1e-9  # a grid of a million points misses an extreme by the square of its spacing


@pytest.fixture(scope='module')
def cam(press_profile):
    return RadialCam(press_profile, 0.04, 0.012)


def dwell_cam(base_radius, roller_radius, lift=0.02):
    return RadialCam(CamProfile([
        segment('low', 90.0), segment('rise', 180.0, lift, 'cycloidal'),
        segment('high', 270.0), segment('fall', 360.0, -lift, 'cycloidal'),
    ]), base_radius, roller_radius)


def test_the_pressure_angle_on_the_documents_grid_is_the_printed_one(cam):
    on_grid = cam.pressure_angle(np.linspace(0.0, TURN, 401))
    assert f'{np.max(on_grid) / DEGREE:.4f}' == '25.2536'


def test_the_exact_pressure_angle_lies_above_every_grid(cam):
    q = np.linspace(0.0, TURN, 1_000_001)
    angles = cam.pressure_angle(q)
    least, greatest = cam.pressure_angles
    assert 0.0 <= greatest.value - np.max(angles) < GRID
    assert 0.0 <= np.min(angles) - least.value < GRID
    assert greatest.at == pytest.approx(q[np.argmax(angles)], abs=1e-5)
    assert least.at == pytest.approx(q[np.argmin(angles)], abs=1e-5)
    assert cam.max_pressure_angle == greatest


def test_the_pressure_angle_is_stationary_where_it_is_greatest(cam):
    for peak in cam.pressure_angles:
        s, s1, s2, _ = cam.profile.sample(peak.at)
        assert peak.value == pytest.approx(atan(s1 / (cam.base + s)), rel=ROUNDING)
        assert s2 * (cam.base + s) - s1 * s1 == pytest.approx(0.0, abs=1e-6 * s1 * s1)


def test_a_dwell_is_an_arc_of_pitch_radius_less_the_roller():
    cam = dwell_cam(0.05, 0.01)
    assert cam.pitch_radius(0.5) == pytest.approx(0.06)
    assert cam.contour_radius(0.5) == pytest.approx(0.05, rel=ROUNDING)
    assert cam.contour_radius(1.25 * pi) == pytest.approx(0.07, rel=ROUNDING)
    assert cam.pressure_angle([0.5, 1.25 * pi]).tolist() == [0.0, 0.0]


def test_a_symmetric_cam_has_the_same_pressure_angle_up_and_down():
    least, greatest = dwell_cam(0.05, 0.01).pressure_angles
    assert least.value == pytest.approx(-greatest.value, rel=ROUNDING)


def curvature_of(points):
    """Give the curvature in the middle of five neighbours on a plane curve, to fourth order."""
    first = (points[0] - 8 * points[1] + 8 * points[3] - points[4]) / 12.0
    second = (-points[0] + 16 * points[1] - 30 * points[2] + 16 * points[3] - points[4]) / 12.0
    return (first.real * second.imag - first.imag * second.real) / abs(first) ** 3


@given(share=st.floats(0.01, 0.99), piece=st.integers(0, 3))
def test_the_curvature_is_that_of_the_path_drawn_on_the_disc(cam, share, piece):
    breaks = cam.profile.curve.breaks
    q = breaks[piece] + share * (breaks[piece + 1] - breaks[piece])
    around = q + 1e-3 * np.arange(-2.0, 3.0)
    path = cam.pitch_radius(around) * np.exp(1j * around)
    assert cam.pitch_curvature(q) == pytest.approx(curvature_of(path), rel=1e-6, abs=1e-5)


@given(q=st.floats(0.0, TURN))
def test_the_contour_radius_is_the_documents_formula(cam, q):
    s, s1, s2, _ = cam.profile.sample(q)
    r = cam.base + s
    printed = (r * r + s1 * s1) ** 1.5 / (r * r + 2.0 * s1 * s1 - r * s2) - 0.012
    assert cam.contour_radius(q) == pytest.approx(printed, rel=1e-9)


def test_the_steps_of_the_acceleration_count_from_both_sides(cam):
    curve = cam.profile.curve
    least, greatest = cam.pitch_curvatures
    # at 0 the rise begins with its greatest s'': the flattest place, seen from the right only
    assert least.at == 0.0
    s2 = curve(0.0, 2)
    assert least.value == pytest.approx((cam.base - s2) / cam.base ** 2, rel=ROUNDING)
    q = np.linspace(0.0, TURN, 1_000_001)
    assert 0.0 <= greatest.value - np.max(cam.pitch_curvature(q)) < 1e-6 * greatest.value


def test_the_documents_cam_does_not_undercut(cam):
    assert not cam.undercuts
    q = np.linspace(0.0, TURN, 1_000_001)
    radii = cam.contour_radius(q)
    assert cam.least_contour_radius.value == pytest.approx(np.min(radii[radii > 0.0]), abs=GRID)
    assert cam.least_contour_radius.value > 0.012


def test_a_roller_larger_than_the_tightest_bend_of_its_path_undercuts():
    # the roller moves inwards with the disc, so that the path of its centre stays the same
    path = dwell_cam(0.03, 0.001)
    tightest = 1.0 / path.pitch_curvatures[1].value
    for roller, undercuts in ((0.999 * tightest, False), (1.001 * tightest, True)):
        cam = dwell_cam(0.031 - roller, roller)
        assert cam.undercuts is undercuts
        assert cam.least_contour_radius.value == pytest.approx(tightest - roller, abs=ROUNDING)


def test_a_hollow_path_never_undercuts():
    cam = dwell_cam(0.03, 0.001, 0.03)
    least, greatest = cam.pitch_curvatures
    assert least.value < 0.0 < greatest.value
    hollow = cam.contour_radius(least.at)
    assert hollow == pytest.approx(1.0 / least.value - 0.001, rel=1e-9)
    assert hollow < 0.0 < cam.least_contour_radius.value and not cam.undercuts


def test_shapes_are_kept(cam):
    q = np.linspace(0.0, 12.0, 6).reshape(2, 3)
    for found in (cam.pitch_radius(q), cam.pressure_angle(q), cam.contour_radius(q)):
        assert found.shape == (2, 3)
    assert float(cam.pressure_angle(sqrt(2.0))) == pytest.approx(
        float(cam.pressure_angle(sqrt(2.0) + 3 * TURN)), rel=1e-12)


@pytest.mark.parametrize(('base_radius', 'roller_radius', 'paths'), [
    (0.0, 0.01, ['base_radius']), (-0.04, nan, ['base_radius', 'roller_radius']),
    (0.04, inf, ['roller_radius']), (0.04, 0.0, ['roller_radius']),
])
def test_radii_that_make_no_cam_are_refused(press_profile, base_radius, roller_radius, paths):
    with pytest.raises(ConfigurationError) as refused:
        RadialCam(press_profile, base_radius, roller_radius)
    assert [problem.path for problem in refused.value.problems] == paths
    assert 'must be a finite number above 0' in str(refused.value)


def test_a_travel_into_the_shaft_is_refused():
    with pytest.raises(ConfigurationError, match='base_radius: 0.02; the follower goes 0.02 m'):
        dwell_cam(0.02, 0.01, -0.02)


def test_a_travel_that_does_not_return_is_refused():
    belt = CamProfile([segment('feed', 360.0, 0.1, 'cycloidal')], accumulate=True)
    with pytest.raises(ConfigurationError, match='profile: 0.1; .* must return'):
        RadialCam(belt, 0.04, 0.012)
