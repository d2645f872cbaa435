# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Limits of disc cams: undercutting, the smallest base circle and the best offset, sharply."""

from dataclasses import replace
from math import cos, hypot, inf, pi, radians, sin, tan

from cam_motion import CamProfile, segment
from cam_motion.errors import ConfigurationError
from cam_motion.mechanism.cam_disc import CamDisc, CLOCKWISE, COUNTERCLOCKWISE
from cam_motion.mechanism.cam_flat import SwingingFlat, TranslatingFlat
from cam_motion.mechanism.cam_limits import (
    CamLimits,
    limit_problems,
    margins,
    round_up,
    smallest_base_circle,
)
from cam_motion.mechanism.cam_offset import best_offset
from cam_motion.mechanism.cam_roller import SwingingRoller, TranslatingRoller
from cam_motion.units import DEGREE, TURN
from hypothesis import assume, given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

BESIDE = 1e-9  # share of a radius by which one passes and the other does not
CLOSED_FORM = 1e-12


def profile_of(lift, law='cycloidal', rise=90.0):
    return CamProfile([segment('rise', rise, lift, law), segment('hold', 150.0),
                       segment('back', 280.0, -lift, law), segment('wait', 360.0)])


def on(disc, radius):
    return CamDisc(disc.profile, replace(disc.follower, base_radius=radius), disc.sense)


THIRTY = radians(30.0)
HARD_START = CamProfile([  # hollows at its ends that are tighter than the bend between them
    segment('rise', 140.0, 0.04, 'modified_trapezoid',
            fractions=(0.04, 0.04, 0.04, 0.0, 0.2, 0.48, 0.2)),
    segment('back', 280.0, -0.04, 'modified_trapezoid',
            fractions=(0.2, 0.48, 0.2, 0.0, 0.04, 0.04, 0.04)), segment('wait', 360.0)])
CASES = {
    'in-line, pressure angle': (profile_of(0.03), TranslatingRoller(0.05, 0.01),
                                CamLimits(THIRTY, THIRTY), 'pressure_angle'),
    'offset, way back': (profile_of(0.03, rise=130.0), TranslatingRoller(0.05, 0.01, 0.012),
                         CamLimits(radians(35.0), radians(25.0)), 'return_pressure_angle'),
    'roller, undercut': (CamProfile([segment('in', 90.0, -0.02, 'cycloidal'),
                                     segment('out', 180.0, 0.02, 'cycloidal'),
                                     segment('wait', 360.0)]),
                         TranslatingRoller(0.2, 0.02), CamLimits(), 'undercut'),
    'roller, radius': (profile_of(0.03), TranslatingRoller(0.05, 0.01),
                       CamLimits(radius_of_curvature=0.06), 'radius_of_curvature'),
    'roller, cutter': (profile_of(0.03, rise=60.0), TranslatingRoller(0.05, 0.01),
                       CamLimits(cutter_radius=0.5), 'cutter_radius'),
    'groove': (HARD_START, TranslatingRoller(0.05, 0.03), CamLimits(groove=True), 'groove'),
    'mushroom, undercut': (profile_of(0.02, rise=60.0), TranslatingFlat(0.5), CamLimits(),
                           'undercut'),
    'mushroom, radius': (profile_of(0.02), TranslatingFlat(0.5),
                         CamLimits(radius_of_curvature=0.005), 'radius_of_curvature'),
    'arm, pressure angle': (profile_of(0.35), SwingingRoller(0.07, 0.015, 0.12, 0.13),
                            CamLimits(radians(42.0), radians(45.0)), 'pressure_angle'),
    'face on an arm': (profile_of(0.1, rise=60.0), SwingingFlat(0.05, 0.2, 0.01), CamLimits(),
                       'undercut'),
}


@pytest.mark.parametrize('case', CASES)
def test_the_smallest_base_circle_is_sharp(case):
    profile, follower, limits, binding = CASES[case]
    disc = CamDisc(profile, follower)
    found = smallest_base_circle(disc, limits)
    assert found.binding == binding
    assert limit_problems(on(disc, found.radius * (1.0 + BESIDE)), limits) == []
    assert min(m.left for m in margins(on(disc, found.radius), limits)) > 0.0
    below = on(disc, found.radius * (1.0 - BESIDE))
    assert min(m.left for m in margins(below, limits)) < 0.0
    # what is said of one that is too small names the angle, and leads to one that will do
    small = on(disc, 0.98 * found.radius)
    problems = limit_problems(small, limits)
    assert problems and f'{found.at / DEGREE:.1f}'.split('.')[0]
    hint = problems[0].hint
    assert 'take a base_radius of at least' in hint
    said = float(hint.split('at least ')[1].split()[0])
    assert found.radius <= said < found.radius * (1.0 + 2e-5)
    assert limit_problems(on(disc, said), limits) == []


@pytest.mark.parametrize('case', list(CASES)[::3])
def test_the_direction_does_not_make_the_bound_less_sharp(case):
    profile, follower, limits, _ = CASES[case]
    try:
        disc = CamDisc(profile, follower, CLOCKWISE)
        found = smallest_base_circle(disc, limits)
    except ConfigurationError:
        return  # not every cam can turn the other way round
    if found.binding != 'geometry':
        below = on(disc, found.radius * (1.0 - BESIDE))
        assert min(m.left for m in margins(below, limits)) < 0.0
    assert limit_problems(on(disc, found.radius * (1.0 + BESIDE)), limits) == []


def test_closed_forms_of_the_smallest_base_circle():
    profile = profile_of(0.02, rise=60.0)
    q = np.linspace(0.0, TURN, 200_001)
    s, slope, bend = (profile(q, order) for order in (0, 1, 2))
    mushroom = smallest_base_circle(CamDisc(profile, TranslatingFlat(0.5)), CamLimits())
    assert mushroom.radius == pytest.approx(np.max(-(s + bend)), abs=1e-9)
    assert mushroom.radius == pytest.approx(-profile(mushroom.at) - profile(mushroom.at, 2),
                                            rel=CLOSED_FORM)
    roller = smallest_base_circle(
        CamDisc(profile, TranslatingRoller(0.5, 0.01)), CamLimits(THIRTY, THIRTY))
    assert roller.radius + 0.01 == pytest.approx(
        np.max(np.abs(slope) / tan(THIRTY) - s), abs=1e-9)


def test_a_roller_as_large_as_the_tightest_bend_of_its_path_makes_a_point():
    # the roller moves inwards with the disc, so that the path of its centre stays the same
    profile = profile_of(0.02, rise=60.0)
    path = CamDisc(profile, TranslatingRoller(0.04, 0.0))
    tightest = path.least_contour_radius
    for roller, undercuts in ((tightest.value * (1.0 - BESIDE), False),
                              (tightest.value * (1.0 + BESIDE), True)):
        disc = CamDisc(profile, TranslatingRoller(0.04 - roller, roller)) if roller < 0.04 else (
            None)
        assert disc is not None and disc.undercuts is undercuts
    problem, = limit_problems(disc, CamLimits())
    assert problem.path == 'roller_radius' and problem.value == roller
    assert f'{tightest.at / DEGREE:.6g} deg' in problem.rule
    assert f'{tightest.value:.6g} m' in problem.rule


@pytest.mark.parametrize('sense', [COUNTERCLOCKWISE, CLOCKWISE])
@given(out=st.floats(0.2, 1.2), back=st.floats(0.2, 1.2), rise=st.floats(60.0, 140.0))
def test_the_best_offset_allows_the_smallest_base_circle(sense, out, back, rise):
    profile = profile_of(0.03, rise=rise)
    found = best_offset(profile, sense, 0.005, out, back)
    assume(found.base_radius > 0.0)
    disc = CamDisc(profile, TranslatingRoller(found.base_radius * (1.0 + BESIDE), 0.005,
                                              found.offset), sense)
    low, high = disc.pressure_angles
    assert high.value <= out + 1e-7 and low.value >= -back - 1e-7
    # one of the limits is reached
    assert min(out - high.value, back + low.value) < 1e-6
    q = np.linspace(0.0, TURN, 4001)
    s, slope = profile(q), profile(q, 1)
    prime = found.base_radius + 0.005
    for turn in (-0.3, -0.01, 0.01, 0.3):  # no other offset does with less
        offset = prime * sin(turn) + sense * found.offset * cos(turn)
        height = max(np.max((slope - offset) / tan(out) - s),
                     np.max((offset - slope) / tan(back) - s))
        assert hypot(height, offset) >= prime * (1.0 - 1e-9)


def test_the_best_offset_beats_none():
    profile = profile_of(0.03)
    with_it = best_offset(profile, COUNTERCLOCKWISE, 0.01, THIRTY, radians(40.0))
    without = smallest_base_circle(CamDisc(profile, TranslatingRoller(0.05, 0.01)), CamLimits(
        THIRTY, radians(40.0)))
    assert with_it.offset > 0.0 and with_it.base_radius < 0.8 * without.radius


def test_where_nothing_binds_geometry_does():
    cam = CamDisc(profile_of(-0.02), TranslatingRoller(0.05, 0.005, 0.01))
    found = smallest_base_circle(cam, CamLimits(radians(89.0), radians(89.0)))
    assert found.binding in ('geometry', 'pressure_angle', 'return_pressure_angle')
    assert found.radius > hypot(0.02, 0.01) - 0.005


def test_where_no_base_circle_will_do_the_hardest_limit_is_named():
    cam = CamDisc(profile_of(0.9), SwingingRoller(0.07, 0.015, 0.12, 0.13))
    with pytest.raises(ConfigurationError, match='no base radius keeps these limits: pressure'):
        smallest_base_circle(cam, CamLimits(radians(5.0), radians(5.0)))
    problem = limit_problems(cam, CamLimits(radians(5.0), radians(5.0)))[0]
    assert 'no base radius keeps these limits' in problem.hint


@pytest.mark.parametrize('limits', [
    {'pressure_angle': 0.0}, {'return_pressure_angle': 0.5 * pi}, {'radius_of_curvature': -1.0},
    {'cutter_radius': inf},
])
def test_limits_out_of_range_are_refused(limits):
    with pytest.raises(ConfigurationError) as refused:
        CamLimits(**limits)
    assert [problem.path for problem in refused.value.problems] == list(limits)


@given(value=st.floats(1e-9, 1e9))
def test_a_number_rounded_up_is_hardly_more(value):
    assert value * (1.0 - 1e-15) <= round_up(value) <= value * (1.0 + 1.1e-5)
