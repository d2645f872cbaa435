# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Disc cams: the contour as envelope, curvature and pressure angle against plain geometry."""

from math import atan2, inf, nan, pi

from cam_motion import CamProfile, segment
from cam_motion.errors import ConfigurationError, DomainError
from cam_motion.mechanism.cam_disc import CamDisc, CLOCKWISE, COUNTERCLOCKWISE
from cam_motion.mechanism.cam_flat import SwingingFlat, TranslatingFlat
from cam_motion.mechanism.cam_pose import follower_pose
from cam_motion.mechanism.cam_roller import SwingingRoller, TranslatingRoller
from cam_motion.units import DEGREE, TURN
from hypothesis import assume, given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-12
SLOPE = 1e-7  # of central differences
BEND = 1e-4  # of second differences
STEP = 1e-4
SENSES = (COUNTERCLOCKWISE, CLOCKWISE)
HARMONIC = (0.0, 0.0, 0.5, 0.0, 0.5, 0.0, 0.0)
LAWS = ('cycloidal', 'polynomial_345', 'modified_sine', 'polynomial_4567')


def profile_of(lift, law='cycloidal', rise=90.0, hold=150.0, back=280.0):
    return CamProfile([
        segment('rise', rise, lift, law), segment('hold', hold),
        segment('back', back, -lift, law), segment('wait', 360.0)])


def press_profile():
    """Make the cam of document 004."""
    return CamProfile([
        segment('rise', 150.0, 0.06, 'modified_trapezoid', fractions=HARMONIC),
        segment('return', 360.0, -0.06, 'modified_trapezoid', fractions=HARMONIC)])


PRESS = CamDisc(press_profile(), TranslatingRoller(0.04, 0.012))
FOLLOWERS = (
    (0.02, TranslatingRoller(0.05, 0.012, 0.01)), (0.012, TranslatingFlat(0.06, 0.004)),
    (0.3, SwingingRoller(0.05, 0.015, 0.12, 0.13)), (0.1, SwingingFlat(0.06, 0.15, 0.01)))
DISCS = [CamDisc(profile_of(lift), follower, sense)
         for lift, follower in FOLLOWERS for sense in SENSES]


@st.composite
def discs(draw):
    """Draw a disc that can be made."""
    law, sense = draw(st.sampled_from(LAWS)), draw(st.sampled_from(SENSES))
    base, roller = draw(st.floats(0.03, 0.08)), draw(st.floats(0.0, 0.02))
    kind = draw(st.integers(0, 3))
    lift = draw(st.floats(0.002, 0.03) if kind < 2 else st.floats(0.02, 0.3))
    side, pivot = draw(st.floats(-0.02, 0.02)), draw(st.floats(0.1, 0.2))
    follower = (
        TranslatingRoller(base, roller, side), TranslatingFlat(base, side),
        SwingingRoller(base, roller, pivot * (1.0 + 5.0 * side), pivot),
        SwingingFlat(base, pivot, side))[kind]
    rise = draw(st.floats(60.0, 130.0))
    try:
        disc = CamDisc(profile_of(lift, law, rise), follower, sense)
    except ConfigurationError:
        assume(False)
    assume(disc.least_contour_radius.value > 1e-3)
    return disc


def inside(disc, share):
    """Give an angle in the rise, clear of its ends."""
    return disc.profile.segments[0].end * (0.02 + 0.96 * share)


def differences(path, q, step=STEP):
    """Give first and second derivative of a path by central differences of fourth order."""
    p = path(q + step * np.arange(-2.0, 3.0))
    return ((p[0] - 8.0 * p[1] + 8.0 * p[3] - p[4]) / (12.0 * step),
            (-p[0] + 16.0 * p[1] - 30.0 * p[2] + 16.0 * p[3] - p[4]) / (12.0 * step ** 2))


@given(disc=discs(), share=st.floats(0.0, 1.0))
def test_the_contour_is_the_envelope_of_the_follower(disc, share):
    q = inside(disc, share)
    found = disc.contact(q)
    normal = disc.on_disc(found.normal, q)
    first, _ = differences(disc.contour, q)
    assert abs(found.normal) == pytest.approx(1.0, rel=ROUNDING)
    # square to the common normal, and as long as it says
    assert abs((np.conj(normal) * first).real) < SLOPE * abs(first) + 1e-10
    assert complex(first) == pytest.approx(complex(disc.on_disc(found.tangent, q)), abs=1e-8)
    if disc.follower.is_flat:
        around = disc.contour(q + np.linspace(-0.3, 0.3, 61)) - disc.contour(q)
        assert np.max((np.conj(normal) * around).real) < ROUNDING
    else:
        roller = disc.follower.roller_radius
        assert abs(disc.contour(q) - disc.pitch(q)) == pytest.approx(roller, abs=ROUNDING)
        assert abs(disc.outer_flank(q) - disc.pitch(q)) == pytest.approx(roller, abs=ROUNDING)
        near = np.abs(disc.contour(q + np.linspace(-0.05, 0.05, 41)) - disc.pitch(q))
        assert np.min(near) > roller - ROUNDING


@given(disc=discs(), share=st.floats(0.0, 1.0))
def test_the_curvature_is_that_of_the_points_of_the_contour(disc, share):
    q = inside(disc, share)
    for path, curvature in ((disc.contour, disc.contour_curvature(q)),
                            (disc.pitch, disc.pitch_curvature(q))):
        if disc.follower.is_flat and path == disc.pitch:
            continue
        first, second = differences(path, q, 1e-3)
        turning = -disc.sense * (np.conj(first) * second).imag / abs(first) ** 3
        assert curvature == pytest.approx(turning, rel=BEND, abs=1e-2)


@given(disc=discs(), share=st.floats(0.0, 1.0))
def test_disc_and_follower_move_alike_along_the_common_normal(disc, share):
    q = inside(disc, share)
    found = disc.contact(q)
    slope = float(disc.profile(q, 1))
    of_disc = (np.conj(found.normal) * 1j * disc.sense * found.point).real
    assert float(of_disc) == pytest.approx(float(found.reach) * slope, abs=1e-13)
    # the part of the follower's own velocity there that is along the normal
    pivot = disc.follower.pivot
    way = 1j if pivot is None else -1j * (
        (found.point if disc.follower.is_flat else found.centre) - pivot)
    assert float((np.conj(found.normal) * way).real) == pytest.approx(
        float(found.reach), abs=1e-13)
    assert abs(np.cos(found.pressure)) * abs(way) == pytest.approx(float(found.reach), rel=1e-9)


@given(disc=discs())
def test_extremes_are_beyond_every_grid_and_hardly_so(disc):
    q = np.linspace(0.0, TURN, 4001)[:-1]
    found = disc.contact(q)
    for exact, values in (
            (disc.pressure_angles, found.pressure),
            ((disc.nearest, disc.farthest), np.abs(found.point))):
        low, high = (getattr(peak, 'value', peak) for peak in exact)
        assert -ROUNDING < np.min(values) - low < 2e-5
        assert -ROUNDING < high - np.max(values) < 2e-5
    radii = disc.contour_radius(q)
    assert disc.least_contour_radius.value <= np.min(radii[radii > 0.0]) * (1.0 + ROUNDING)
    assert disc.least_contour_radius.value == pytest.approx(np.min(radii[radii > 0.0]), rel=1e-3)


@pytest.mark.parametrize('sense', SENSES)
@given(q=st.floats(0.0, TURN), offset=st.floats(-0.03, 0.03))
def test_the_pressure_angle_of_an_offset_roller_is_the_books(sense, q, offset):
    disc = CamDisc(press_profile(), TranslatingRoller(0.04, 0.012, offset), sense)
    s, slope, _, _ = disc.profile.sample(q)
    printed = atan2(slope - sense * offset, (0.052 ** 2 - offset ** 2) ** 0.5 + s)
    assert float(disc.pressure_angle(q)) == pytest.approx(printed, abs=ROUNDING)


@given(q=st.floats(0.0, TURN))
def test_a_mushroom_has_the_radius_and_the_contact_of_the_books(q):
    disc = CamDisc(profile_of(0.012), TranslatingFlat(0.06, 0.004))
    s, slope, bend, _ = disc.profile.sample(q)
    found = disc.contact(q)
    assert float(disc.contour_radius(q)) == pytest.approx(0.06 + s + bend, abs=ROUNDING)
    assert complex(found.point) == pytest.approx(complex(slope, 0.06 + s), abs=ROUNDING)
    assert float(found.along) == pytest.approx(slope - 0.004, abs=ROUNDING)
    assert float(found.pressure) == 0.0


@given(q=st.floats(0.0, TURN))
def test_the_radius_of_the_press_is_the_documents_formula(q):
    s, s1, s2, _ = PRESS.profile.sample(q)
    r = 0.052 + s
    printed = (r * r + s1 * s1) ** 1.5 / (r * r + 2.0 * s1 * s1 - r * s2) - 0.012
    assert float(PRESS.contour_radius(q)) == pytest.approx(printed, rel=1e-9)


def test_the_documents_figures_on_its_grid_and_exactly():
    grid = np.linspace(0.0, TURN, 401)
    on_grid = PRESS.pressure_angle(grid)
    assert f'{np.max(on_grid) / DEGREE:.4f}' == '25.2536'
    greatest = PRESS.max_pressure_angle
    assert greatest.value / DEGREE == pytest.approx(25.2545724, abs=1e-7)
    s, s1, s2, _ = PRESS.profile.sample(greatest.at)
    assert s2 * (0.052 + s) - s1 * s1 == pytest.approx(0.0, abs=1e-12)  # stationary there
    q = np.linspace(0.0, TURN, 200_001)
    assert PRESS.least_contour_radius.value == pytest.approx(
        np.min(PRESS.contour_radius(q)), abs=1e-10)
    assert PRESS.least_contour_radius.value > 0.012 and not PRESS.undercuts


def test_steps_of_the_acceleration_count_from_both_sides():
    # at 0 the rise begins with its greatest s'': the flattest place, seen from the right only
    s2 = PRESS.profile.curve(0.0, 2)
    flattest = PRESS.extremes(lambda found: found.bend)[0]
    assert flattest.at == 0.0
    assert flattest.value == pytest.approx((0.052 - s2) / 0.052 ** 2, rel=ROUNDING)


@pytest.mark.parametrize('sense', SENSES)
def test_an_offset_of_none_is_the_in_line_roller(sense):
    q = np.linspace(0.0, TURN, 200)
    with_none = CamDisc(press_profile(), TranslatingRoller(0.04, 0.012, 0.0), sense)
    path = (0.052 + with_none.profile(q)) * 1j * np.exp(-1j * sense * q)
    assert with_none.pitch(q) == pytest.approx(path, abs=ROUNDING)


@pytest.mark.parametrize('sense', SENSES)
def test_a_very_long_arm_swings_along_a_line(sense):
    straight = CamDisc(profile_of(0.02), TranslatingRoller(0.05, 0.01), sense)
    q = np.linspace(0.0, TURN, 400)
    off = []
    for arm in (1e2, 1e3):
        distance = (arm ** 2 - 0.06 ** 2) ** 0.5
        disc = CamDisc(profile_of(0.02 / arm), SwingingRoller(0.05, 0.01, arm, distance), sense)
        off.append(np.max(np.abs(disc.contour(q) - straight.contour(q))))
        assert disc.pressure_angle(q) == pytest.approx(straight.pressure_angle(q), abs=0.1 / arm)
    assert off[1] < 2e-6
    assert off[0] / off[1] == pytest.approx(10.0, rel=0.01)


@pytest.mark.parametrize('sense', SENSES)
def test_a_flat_face_on_a_far_bearing_travels(sense):
    straight = CamDisc(profile_of(0.012), TranslatingFlat(0.06), sense)
    q = np.linspace(0.0, TURN, 400)
    far = 1e4
    disc = CamDisc(profile_of(0.012 / far), SwingingFlat(0.06, far), sense)
    assert np.max(np.abs(disc.contour(q) - straight.contour(q))) < 1e-5


@pytest.mark.parametrize(('lift', 'follower'), FOLLOWERS)
def test_the_other_direction_is_the_motion_the_other_way_round(lift, follower):
    there = CamDisc(profile_of(lift), follower)
    back = CamProfile([segment('wait', 80.0), segment('out', 210.0, lift, 'cycloidal'),
                       segment('hold', 270.0), segment('in', 360.0, -lift, 'cycloidal')])
    turned = CamDisc(back, follower, CLOCKWISE)
    q = np.linspace(0.01, 6.2, 300)
    assert turned.contour(-q) == pytest.approx(there.contour(q), abs=ROUNDING)
    assert turned.pressure_angle(-q) == pytest.approx(-there.pressure_angle(q), abs=ROUNDING)
    assert turned.contour_radius(-q) == pytest.approx(there.contour_radius(q), rel=1e-9)


def test_an_offset_to_the_other_side_is_seen_in_the_mirror():
    q = np.linspace(0.0, TURN, 300)
    right = CamDisc(press_profile(), TranslatingRoller(0.04, 0.012, 0.01))
    left = CamDisc(press_profile(), TranslatingRoller(0.04, 0.012, -0.01), CLOCKWISE)
    assert left.contour(q) == pytest.approx(-np.conj(right.contour(q)), abs=ROUNDING)


@pytest.mark.parametrize('disc', DISCS)
def test_a_dwell_is_an_arc_around_the_shaft(disc):
    wait = np.linspace(285.0, 355.0, 20) * DEGREE
    assert np.abs(disc.contour(wait)) == pytest.approx(disc.base_radius, rel=1e-9)
    assert disc.contour_radius(wait) == pytest.approx(disc.base_radius, rel=1e-9)
    hold = np.linspace(95.0, 145.0, 20) * DEGREE
    assert np.ptp(np.abs(disc.contour(hold))) < 1e-12
    assert disc.contour_radius(hold) == pytest.approx(np.abs(disc.contour(hold)), rel=1e-9)


@pytest.mark.parametrize('disc', DISCS)
def test_the_pose_is_in_touch_with_the_disc(disc):
    for q in (0.0, 0.8, 4.0):
        pose = follower_pose(disc, q)
        assert pose.contact == pytest.approx(complex(disc.turned(disc.contour(q), q)))
        if pose.roller_radius is not None:
            assert abs(pose.centre - pose.contact) == pytest.approx(pose.roller_radius)
        else:
            first, last = pose.face
            share = (pose.contact - first) / (last - first)
            assert abs(share.imag) < 1e-9 and -1e-9 < share.real < 1.0 + 1e-9
        if isinstance(disc.follower, SwingingRoller):
            assert abs(pose.centre - pose.pivot) == pytest.approx(disc.follower.arm_length)


def test_a_hollow_path_never_undercuts_but_limits_the_cutter():
    disc = CamDisc(profile_of(0.03, rise=60.0), TranslatingRoller(0.03, 0.001))
    hollow = disc.hollow_contour_radius
    assert hollow.value < -0.001 and not disc.undercuts and not disc.groove_undercuts
    assert hollow.value == pytest.approx(float(disc.contour_radius(hollow.at)), rel=1e-6)
    wide = CamDisc(profile_of(0.03, rise=60.0), TranslatingRoller(
        0.03 + 0.001 + hollow.value - 1e-3, 0.001 - hollow.value + 1e-3))
    assert wide.groove_undercuts


def test_a_flat_face_runs_in_no_groove():
    with pytest.raises(DomainError, match='no groove'):
        DISCS[2].outer_flank(0.0)


def test_shapes_are_kept():
    q = np.linspace(0.0, 12.0, 6).reshape(2, 3)
    for disc in DISCS:
        for found in (disc.contour(q), disc.pressure_angle(q), disc.contour_radius(q)):
            assert found.shape == (2, 3)
        assert complex(disc.contour(1.0)) == pytest.approx(complex(disc.contour(1.0 + 3 * TURN)))


@pytest.mark.parametrize(('follower', 'paths'), [
    (TranslatingRoller(0.0, 0.01), ['base_radius']),
    (TranslatingRoller(-0.04, nan), ['base_radius', 'roller_radius']),
    (TranslatingRoller(0.04, inf), ['roller_radius']),
    (TranslatingRoller(0.04, 0.01, 0.05), ['offset']),
    (TranslatingFlat(0.04, inf), ['offset']),
    (SwingingRoller(0.04, 0.01, 0.1, 0.2), ['base_radius']),
    (SwingingRoller(0.1, 0.01, -0.1, 0.0), ['arm_length', 'pivot_distance']),
    (SwingingFlat(0.2, 0.1), ['base_radius']),
])
def test_figures_that_make_no_cam_are_refused(follower, paths):
    with pytest.raises(ConfigurationError) as refused:
        CamDisc(profile_of(0.02), follower)
    assert [problem.path for problem in refused.value.problems] == paths


def test_a_travel_into_the_shaft_is_refused_with_a_radius_that_will_do():
    inwards = profile_of(-0.02)
    with pytest.raises(ConfigurationError, match='goes 0.02 m inwards at 90 deg') as refused:
        CamDisc(inwards, TranslatingRoller(0.005, 0.01, 0.004))
    needed = float(refused.value.problems[0].hint.split()[-2])
    CamDisc(inwards, TranslatingRoller(needed + 1e-7, 0.01, 0.004))
    with pytest.raises(ConfigurationError):
        CamDisc(inwards, TranslatingRoller(needed - 1e-7, 0.01, 0.004))


def test_an_arm_that_swings_too_far_is_refused():
    with pytest.raises(ConfigurationError, match='clear of the line through shaft and bearing'):
        CamDisc(profile_of(2.9), SwingingRoller(0.05, 0.015, 0.12, 0.13))
    with pytest.raises(ConfigurationError, match='within 90 deg'):
        CamDisc(profile_of(1.4), SwingingFlat(0.05, 0.12))


def test_a_face_that_turns_faster_than_the_disc_is_refused():
    fast = profile_of(0.9, rise=60.0)
    CamDisc(fast, SwingingFlat(0.01, 0.2, -0.005))  # away from its bearing it may
    with pytest.raises(ConfigurationError, match='slower than the disc'):
        CamDisc(fast, SwingingFlat(0.01, 0.2, -0.005), CLOCKWISE)


def test_a_travel_that_does_not_return_is_refused():
    belt = CamProfile([segment('feed', 360.0, 0.1, 'cycloidal')], accumulate=True)
    with pytest.raises(ConfigurationError, match='profile: 0.1; .* must return'):
        CamDisc(belt, TranslatingRoller(0.04, 0.012))
    with pytest.raises(ConfigurationError, match='sense: 2'):
        CamDisc(press_profile(), TranslatingRoller(0.04, 0.012), 2)


def test_the_pressure_angle_of_a_face_off_its_bearing_is_that_of_its_offset():
    disc = CamDisc(profile_of(0.1), SwingingFlat(0.06, 0.15, 0.01))
    found = disc.contact(1.0)
    assert float(found.pressure) == pytest.approx(-atan2(0.01, float(found.along)))
    assert abs(float(disc.pressure_angle(1.0))) < 0.5 * pi
