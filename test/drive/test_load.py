# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The parts of a load: their derivatives, their virtual work, their power, one by one."""

from math import cos, pi

from cam_motion.drive.load import (
    Follower,
    Friction,
    GRAVITY,
    Lever,
    Process,
    RotatingInertia,
    Spring,
    TranslatingMass,
)
from cam_motion.errors import ConfigurationError
from cam_motion.units import TURN
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-12
STEP = 1e-4  # for central differences of fourth order [rad]
DIFFERENCE = 1e-9  # what they miss, relative to the largest value over the turn

PARTS = {
    'inertia': RotatingInertia(0.02),
    'mass': TranslatingMass(7.0),
    'level mass': TranslatingMass(7.0, gravity=0.0),
    'spring': Spring(20000.0, 0.01),
    'friction': Friction(viscous=30.0, coulomb=12.0),
    'lever': Lever(0.05, 0.18, 0.148),
    'loaded lever': Lever(0.05, 0.18, 0.148, 150.0, (0.0, 5.0 * pi / 6.0)),
    'process': Process(400.0, 0.0, (0.5, 2.5)),
    'short lever': Lever(0.2, 0.1, 0.03, 40.0, (1.0, 5.0)),
}
MOVED = {name: part for name, part in PARTS.items() if name != 'inertia'}

parts = pytest.mark.parametrize('part', PARTS.values(), ids=PARTS.keys())
moved = pytest.mark.parametrize('part', MOVED.values(), ids=MOVED.keys())
shares = st.floats(0.001, 0.999)  # of a piece of the cam, so that no difference crosses a joint
pieces = st.integers(0, 3)


def follower(profile, q):
    curve, angles = profile.curve, np.atleast_1d(np.asarray(q, dtype=float))
    return Follower(angles, *(curve.evaluate(angles, order) for order in range(3)))


def inside(profile, share, piece):
    low, high = profile.curve.breaks[piece:piece + 2]
    return low + share * (high - low)


def derivative(function, q):
    """Differentiate a function of an array of angles at one angle."""
    values = function(q + STEP * np.array([-2.0, -1.0, 1.0, 2.0]))
    return float(values @ [1.0, -8.0, 8.0, -1.0]) / (12.0 * STEP)


def scale(profile, function):
    return 1e-12 + float(np.max(np.abs(function(np.linspace(0.0, TURN, 721)))))


@parts
@given(share=shares, piece=pieces)
def test_the_centripetal_term_is_half_the_slope_of_the_inertia(
        press_profile, part, share, piece):
    q = inside(press_profile, share, piece)
    slope = derivative(lambda x: part.terms(follower(press_profile, x)).inertia, q)
    found = part.terms(follower(press_profile, q)).centripetal
    tolerance = DIFFERENCE * scale(
        press_profile, lambda x: part.terms(follower(press_profile, x)).inertia)
    assert found == pytest.approx(0.5 * slope, abs=tolerance)


@parts
@given(share=shares, piece=pieces)
def test_the_inertia_is_never_negative(press_profile, part, share, piece):
    at = follower(press_profile, inside(press_profile, share, piece))
    assert part.terms(at).inertia >= 0.0
    assert part.terms(at).damping <= 0.0


POTENTIALS = {
    'mass': lambda at: 7.0 * GRAVITY * at.s,
    'spring': lambda at: 0.5 * 20000.0 * (at.s + 0.01) ** 2,
    # acos((h - s) / a) as an angle from its sine, which stays exact near a = h - s
    'loaded lever': lambda at: 150.0 * np.where(
        at.q <= 5.0 * pi / 6.0, np.arctan2(np.sqrt(0.18 ** 2 - (0.148 - at.s) ** 2),
                                           0.148 - at.s), 0.0),
}


@pytest.mark.parametrize('name', POTENTIALS)
@given(share=shares, piece=pieces)
def test_the_virtual_work_is_the_loss_of_potential(press_profile, name, share, piece):
    q = inside(press_profile, share, piece)
    part, potential = PARTS[name], POTENTIALS[name]
    slope = derivative(lambda x: potential(follower(press_profile, x)), q)
    tolerance = DIFFERENCE * scale(
        press_profile, lambda x: potential(follower(press_profile, x))) * 10.0
    found = part.terms(follower(press_profile, q)).force
    assert found == pytest.approx(-slope, abs=tolerance)


@given(share=shares, piece=pieces, omega=st.floats(0.1, 100.0))
def test_friction_takes_what_the_follower_rubs_away(press_profile, share, piece, omega):
    at = follower(press_profile, inside(press_profile, share, piece))
    terms = PARTS['friction'].terms(at)
    speed = float(at.s1[0]) * omega
    rubbed = 12.0 * abs(speed) + 30.0 * speed * speed
    assert (terms.force + terms.damping * omega) * omega == pytest.approx(-rubbed, rel=ROUNDING)


@moved
@given(share=shares, piece=pieces, omega=st.floats(0.0, 100.0), alpha=st.floats(-1e3, 1e3))
def test_the_force_at_the_follower_carries_the_power_of_the_part(
        press_profile, part, share, piece, omega, alpha):
    # F s' w = d/dt (J w² / 2) - Q w, divided by w
    at = follower(press_profile, inside(press_profile, share, piece))
    terms = part.terms(at)
    terms_sum = [terms.inertia * alpha, terms.centripetal * omega ** 2,
                 -terms.force, -terms.damping * omega]
    found = part.follower_force(at, np.array([omega]), np.array([alpha])) * at.s1
    size = float(sum(abs(x) for x in terms_sum)[0])
    assert found == pytest.approx(sum(terms_sum), abs=ROUNDING * size + 1e-15)


def test_an_inertia_on_the_shaft_does_not_load_the_follower(press_profile):
    at = follower(press_profile, [0.5, 1.5])
    force = PARTS['inertia'].follower_force(at, np.full(2, 40.0), np.full(2, 9.0))
    assert force.tolist() == [0.0, 0.0]


@given(share=shares, piece=pieces)
def test_the_lever_turns_as_its_slider_says(press_profile, share, piece):
    q = inside(press_profile, share, piece)
    lever = PARTS['short lever']

    def angle(x):
        return np.arccos((0.03 - follower(press_profile, x).s) / 0.1)

    reach, g1, g1_slope = lever.ratios(follower(press_profile, q))
    assert g1 == pytest.approx(derivative(angle, q), abs=1e-8)
    assert reach == pytest.approx(0.1 * np.sin(angle(q)), rel=ROUNDING)
    slope = derivative(lambda x: lever.ratios(follower(press_profile, x))[1], q)
    assert g1_slope == pytest.approx(slope, abs=1e-8)


def test_the_follower_lifts_the_levers_end_by_its_own_travel(press_profile):
    at = follower(press_profile, np.linspace(0.0, TURN, 13))
    reach = PARTS['lever'].ratios(at)[0]
    phi = np.arctan2(reach, 0.148 - at.s)
    assert [0.18 * cos(x) for x in phi] == pytest.approx(0.148 - at.s, rel=ROUNDING, abs=1e-15)


def test_the_moment_acts_within_its_window_ends_included():
    lever = PARTS['short lever']
    q = np.array([0.0, 0.999, 1.0, 3.0, 5.0, 5.001])
    zero = np.zeros_like(q)
    assert lever.moment_at(Follower(q, zero, zero, zero)).tolist() == [0, 0, 40, 40, 40, 0]


def test_only_what_acts_in_a_window_has_edges():
    edges = {name: part.edges() for name, part in PARTS.items() if part.edges()}
    assert edges == {'loaded lever': (0.0, 5.0 * pi / 6.0), 'short lever': (1.0, 5.0),
                     'process': (0.5, 2.5)}
    with pytest.raises(ConfigurationError, match='window'):
        Process(force=1.0, window=(2.0, 1.0))


def test_a_process_acts_inside_its_window_only(press_profile):
    at = follower(press_profile, np.array([0.4, 0.6, 2.4, 2.6]))
    inside = np.array([0.0, 1.0, 1.0, 0.0])
    terms = Process(400.0, 25.0, (0.5, 2.5)).terms(at)
    assert terms.force == pytest.approx(-inside * (400.0 * at.s1 + 25.0))


def test_the_contact_force_is_along_the_normal(press, base):
    drive = press()
    element = drive.elements[2]
    at = drive.follower(element, np.linspace(element.start, element.end, 9))
    omega, alpha = np.full(9, 41.0), np.full(9, -20.0)
    along = sum(part.follower_force(at, omega, alpha) for part in drive.parts)
    angle = np.arctan2(at.s1, base + at.s)
    found = drive.contact_force(at, omega, alpha, base)
    assert found * np.cos(angle) == pytest.approx(along, rel=ROUNDING)


def test_the_drive_sums_its_parts_and_what_turns_with_the_motor(press):
    drive = press()
    element = drive.elements[1]
    at = drive.follower(element, np.array([0.5 * (element.start + element.end)]))
    found, ratio = drive.terms(at), drive.gearbox.ratio
    single = [part.terms(at) for part in drive.parts]
    turned = (0.0028 + 0.06) * ratio ** 2 + (1.0 + 0.1 * ratio) * 0.0028
    assert found.inertia == pytest.approx(turned + sum(t.inertia for t in single), rel=ROUNDING)
    assert found.force == pytest.approx(sum(t.force for t in single), rel=ROUNDING)
    assert found.centripetal == pytest.approx(
        sum(t.centripetal for t in single), rel=ROUNDING)
