# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The contour as polyline and as spline: within the tolerance, and as far off as they say."""

from cam_motion import CamProfile, segment
from cam_motion.errors import ConfigurationError
from cam_motion.mechanism.cam_disc import CamDisc, CLOCKWISE
from cam_motion.mechanism.cam_flat import SwingingFlat, TranslatingFlat
from cam_motion.mechanism.cam_outline import outline, spline
from cam_motion.mechanism.cam_roller import SwingingRoller, TranslatingRoller
from cam_motion.units import TURN
import numpy as np
import pytest
from scipy.interpolate import BSpline

pytestmark = pytest.mark.timeout(60)

HARMONIC = (0.0, 0.0, 0.5, 0.0, 0.5, 0.0, 0.0)
MEASURED = 1e-2  # share of a deviation within which a dense measurement agrees


def profile_of(lift, law='cycloidal'):
    return CamProfile([segment('rise', 90.0, lift, law), segment('hold', 150.0),
                       segment('back', 280.0, -lift, law), segment('wait', 360.0)])


DISCS = [
    CamDisc(CamProfile([
        segment('rise', 150.0, 0.06, 'modified_trapezoid', fractions=HARMONIC),
        segment('return', 360.0, -0.06, 'modified_trapezoid', fractions=HARMONIC)]),
        TranslatingRoller(0.04, 0.012)),
    CamDisc(profile_of(0.03), TranslatingRoller(0.04, 0.01, -0.01), CLOCKWISE),
    CamDisc(profile_of(0.012, 'polynomial_345'), TranslatingFlat(0.06)),
    CamDisc(profile_of(0.3), SwingingRoller(0.05, 0.015, 0.12, 0.13)),
    CamDisc(profile_of(0.1), SwingingFlat(0.06, 0.15, 0.01)),
]


def distance_from_chords(points, angles, disc):
    """Measure how far the exact contour is from the chords, segment by segment."""
    worst = 0.0
    for k in range(len(points) - 1):
        between = disc.contour(np.linspace(angles[k], angles[k + 1], 201)[1:-1])
        chord = points[k + 1] - points[k]
        worst = max(worst, np.max(np.abs((np.conj(chord) * (between - points[k])).imag))
                    / abs(chord))
    return worst


@pytest.mark.parametrize('tolerance', [1e-4, 2e-6])
@pytest.mark.parametrize('disc', DISCS)
def test_the_polyline_is_within_its_tolerance_and_as_far_off_as_it_says(disc, tolerance):
    found = outline(disc, tolerance)
    assert found.points[0] == found.points[-1]
    assert found.angles[0] == 0.0 and found.angles[-1] == pytest.approx(TURN)
    assert np.all(np.diff(found.angles) > 0.0)
    assert found.points == pytest.approx(disc.contour(found.angles), abs=1e-12)
    measured = distance_from_chords(found.points, found.angles, disc)
    assert measured <= tolerance * (1.0 + 1e-6)
    assert found.deviation == pytest.approx(measured, rel=MEASURED)
    # evenly spread: a fifth fewer points could not do
    half = 0.5 * len(found.points) * tolerance ** 0.5
    bound = np.sum(np.sqrt(np.abs(disc.contour_curvature(q := np.linspace(
        0.0, TURN, 20_001)[:-1])) / 8.0) * np.abs(disc.contact(q).tangent)) * TURN / 20_000
    assert half < 0.62 * bound + 8.0 * tolerance ** 0.5


@pytest.mark.parametrize('tolerance', [1e-4, 1e-7])
@pytest.mark.parametrize('disc', DISCS)
def test_the_spline_is_within_its_tolerance_and_touches_in_its_nodes(disc, tolerance):
    found = spline(disc, tolerance)
    curve = BSpline(found.knots, found.control_points, 3)
    nodes = found.angles[:-1]
    assert curve(nodes) == pytest.approx(disc.contour(nodes), abs=1e-12)
    assert found.control_points[0] == found.control_points[-1]
    q = np.linspace(0.0, TURN, 40_001)[:-1]
    drawn, exact = curve(q), disc.contour(q)
    tangent = disc.on_disc(disc.contact(q).tangent, q)
    off = np.abs((np.conj(tangent) * (drawn - exact)).imag / np.abs(tangent))
    assert np.max(off) <= found.deviation * (1.0 + MEASURED) + 1e-12
    assert found.deviation <= tolerance
    assert np.max(off) == pytest.approx(found.deviation, rel=0.05)
    assert found.angles.size < outline(disc, tolerance).angles.size


def test_four_times_the_tolerance_takes_half_the_points():
    fine, coarse = (outline(DISCS[0], tolerance).points.size for tolerance in (1e-6, 4e-6))
    assert fine / coarse == pytest.approx(2.0, rel=0.03)


@pytest.mark.parametrize('disc', DISCS[:2])
def test_the_other_flank_and_the_path_of_the_roller_lie_beside_it(disc):
    roller = disc.follower.roller_radius
    path = outline(disc, 1e-5, roller)
    assert path.points[:-1] == pytest.approx(disc.pitch(path.angles[:-1]), abs=1e-12)
    flank = spline(disc, 1e-5, 2.0 * roller)
    curve = BSpline(flank.knots, flank.control_points, 3)
    q = np.linspace(0.0, TURN, 5001)[:-1]
    assert np.max(np.abs(curve(q) - disc.outer_flank(q))) < 5e-5


def test_what_cannot_be_made_is_refused():
    undercut = CamDisc(profile_of(0.03), TranslatingFlat(0.02))
    with pytest.raises(ConfigurationError, match='base_radius: 0.02; the contour is undercut at'):
        outline(undercut, 1e-6)
    with pytest.raises(ConfigurationError, match='tolerance: 0.0'):
        spline(DISCS[0], 0.0)
    hard = (0.04, 0.04, 0.04, 0.0, 0.2, 0.48, 0.2)
    hollow = CamDisc(CamProfile([
        segment('rise', 140.0, 0.04, 'modified_trapezoid', fractions=hard),
        segment('back', 280.0, -0.04, 'modified_trapezoid', fractions=hard[::-1]),
        segment('wait', 360.0)]), TranslatingRoller(0.02, 0.03))
    assert hollow.groove_undercuts and not hollow.undercuts
    with pytest.raises(ConfigurationError, match='has a cusp at'):
        outline(hollow, 1e-5, 0.06)
