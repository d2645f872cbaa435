# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The force between disc and follower: document 004, lift-off, and the springs that prevent it."""

from math import pi, sqrt

from cam_motion import CamProfile, segment
from cam_motion.drive.load import Follower, Friction, Process, Spring, TranslatingMass
from cam_motion.errors import ConfigurationError
from cam_motion.mechanism.cam_disc import CamDisc, CLOCKWISE
from cam_motion.mechanism.cam_flat import SwingingFlat, TranslatingFlat
from cam_motion.mechanism.cam_force import ContactForce
from cam_motion.mechanism.cam_roller import SwingingRoller, TranslatingRoller
from cam_motion.units import DEGREE, RPM, TURN
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

SAME = 1e-9
PRINTED_MINIMUM = 514.2013  # N, document 004 i)


def profile_of(lift):
    return CamProfile([segment('rise', 90.0, lift, 'cycloidal'), segment('hold', 150.0),
                       segment('back', 280.0, -lift, 'cycloidal'), segment('wait', 360.0)])


@pytest.fixture(scope='module')
def press_force(press_profile, press_parts):
    """Give the contact force of document 004's cam."""
    return ContactForce(CamDisc(press_profile, TranslatingRoller(0.04, 0.012)), press_parts)


def test_the_printed_minimum_is_met_along_the_documents_simulation(press_force, document_run):
    every = document_run.history
    shown = np.append(np.arange(0, every.q.size, 101), np.argmin(every.contact_force))
    past = type(every)(*(column[shown] for column in every))
    q, profile = np.mod(past.q, TURN), press_force.disc.profile
    at = Follower(q, profile.curve.evaluate(q), profile.curve.evaluate(q, 1),
                  profile.curve.evaluate(q, 2))
    force = press_force.normal(at, past.omega, past.alpha)
    assert force == pytest.approx(past.contact_force, rel=SAME)
    assert f'{np.min(force):.4f}' == f'{PRINTED_MINIMUM:.4f}'


def test_in_the_periodic_motion_it_is_what_the_drive_says(press_force, orbit_of, base):
    least, greatest = press_force.extremes_on(orbit_of(0.06))
    assert least.value == pytest.approx(orbit_of(0.06).least_contact(base).value, rel=1e-7)
    assert least.value > PRINTED_MINIMUM  # that is of the start-up
    stretches = orbit_of(0.06).stretches
    dense = np.concatenate([press_force.on_stretch(s, s.dense(200)) for s in stretches])
    assert -SAME < np.min(dense) - least.value < 1e-2
    assert -SAME < greatest.value - np.max(dense) < 1e-2


def test_equation_4_of_the_document_holds_at_steady_speed(press_force):
    angles, forces = press_force.at_speed(400.0 * RPM)
    q, omega = angles[10], 400.0 * RPM
    s, s1, s2, _ = press_force.disc.profile.sample(float(q))
    height = 0.148 - s
    reach = sqrt(0.18 ** 2 - height ** 2)
    g1 = s1 / reach
    slope = (s2 * reach - height * g1 * s1) / reach ** 2
    lever = (0.05 * slope * omega ** 2 + 150.0) / reach
    along = lever + 20000.0 * (s + 0.01) + 7.0 * 9.81 + 7.0 * s2 * omega ** 2
    assert forces[10] == pytest.approx(along * sqrt(s1 ** 2 + (0.052 + s) ** 2) / (0.052 + s),
                                       rel=SAME)


@pytest.mark.parametrize('viscous', [0.0, 200.0])
@pytest.mark.parametrize('coulomb', [0.0, 30.0])
@pytest.mark.parametrize('sense', [1, -1])
def test_at_the_lift_off_speed_the_least_force_is_none(press_profile, press_parts, viscous,
                                                       coulomb, sense):
    disc = CamDisc(press_profile, TranslatingRoller(0.04, 0.012, 0.005), sense)
    force = ContactForce(disc, (*press_parts, Friction(viscous, coulomb)))
    speed = force.lift_off
    at_rest = force.extremes(0.0)[0].value
    least = force.extremes(speed.value)[0]
    assert least.value == pytest.approx(0.0, abs=SAME * at_rest)
    assert least.at == pytest.approx(speed.at, abs=1e-4)
    assert force.extremes(speed.value * (1.0 + 1e-6))[0].value < 0.0
    assert force.extremes(speed.value * (1.0 - 1e-6))[0].value > 0.0


def test_the_lift_off_speed_of_mass_and_spring_is_that_of_the_books():
    profile = profile_of(0.02)
    disc = CamDisc(profile, TranslatingRoller(0.05, 0.01))
    force = ContactForce(disc, [TranslatingMass(3.0), Spring(8000.0, 0.02)])
    q = np.linspace(0.0, TURN, 200_001)
    s, bend = profile(q), profile(q, 2)
    down = bend < 0.0
    square = (8000.0 * (s[down] + 0.02) + 3.0 * 9.81) / (-3.0 * bend[down])
    assert force.lift_off.value == pytest.approx(sqrt(np.min(square)), rel=1e-8)


def test_lift_off_is_found_between_speeds_that_hold():
    # viscous friction lifts the follower off on its way back; at a higher speed its own
    # inertia presses it down at the same angle
    profile = CamProfile([segment('rise', 300.0, 0.05, 'cycloidal'),
                          segment('back', 360.0, -0.05, 'cycloidal')])
    disc = CamDisc(profile, TranslatingRoller(0.3, 0.01))
    force = ContactForce(disc, [TranslatingMass(0.5), Spring(300.0, 0.02), Friction(40.0)])
    speed = force.lift_off.value
    assert force.extremes(speed)[0].value == pytest.approx(0.0, abs=1e-6)
    for share in np.linspace(0.05, 0.999, 12):
        assert force.extremes(share * speed)[0].value > 0.0


def test_what_is_not_held_at_rest_lifts_off_at_no_speed_and_what_is_pressed_never():
    disc = CamDisc(profile_of(0.02), TranslatingFlat(0.3))
    loose = ContactForce(disc, [TranslatingMass(1.0, gravity=-1.0)])
    assert loose.lift_off.value == 0.0
    assert ContactForce(disc, [Spring(100.0, 0.01)]).lift_off is None
    assert ContactForce(disc, [Spring(100.0, 0.01), Friction(1.0, 1e-6)]).lift_off is not None


@pytest.mark.parametrize('wanted', [0.0, 75.0])
def test_the_spring_that_is_needed_leaves_just_the_force_wanted(press_force, press_parts, wanted):
    omega = 800.0 * RPM
    others = [part for part in press_parts if not isinstance(part, Spring)]
    stiffness = press_force.stiffness_for(omega, 0.01, wanted).value
    preload = press_force.preload_for(omega, 20000.0, wanted).value
    for spring in (Spring(stiffness, 0.01), Spring(20000.0, preload)):
        least = ContactForce(press_force.disc, [*others, spring]).extremes(omega)[0].value
        assert least == pytest.approx(wanted, abs=1e-7)


def test_springs_that_cannot_be_are_refused(press_force):
    with pytest.raises(ConfigurationError, match='preload: 0.0; the spring must be compressed'):
        press_force.stiffness_for(10.0, 0.0)
    with pytest.raises(ConfigurationError, match='stiffness: 0.0'):
        press_force.preload_for(10.0, 0.0)


@pytest.mark.parametrize('follower', [
    SwingingRoller(0.05, 0.015, 0.12, 0.13), SwingingFlat(0.06, 0.15, 0.01)])
def test_a_follower_that_swings_balances_moments_about_its_bearing(follower):
    disc = CamDisc(profile_of(0.1), follower, CLOCKWISE)
    force = ContactForce(disc, [TranslatingMass(0.02, 0.0), Spring(50.0, 1.0),
                                Process(force=3.0, window=(0.0, pi))])
    omega = 20.0
    for q in (0.7, 2.0, 4.0):
        at = disc.motion(np.array([q]))
        normal = float(force.normal(at, np.array([omega]), np.zeros(1))[0])
        found = disc.contact(q)
        point = found.point if disc.follower.is_flat else found.centre
        arm = point - disc.follower.pivot
        # seen from the bearing, outwards is clockwise
        moment = -(np.conj(arm) * found.normal).imag * normal
        y, _, bend, _ = disc.profile.sample(q)
        needed = 0.02 * bend * omega ** 2 + 50.0 * (y + 1.0) + 3.0 * (q <= pi)
        assert float(moment) == pytest.approx(needed, rel=SAME)


def test_the_work_at_the_contact_is_that_at_the_shaft(press_force):
    # without friction the torque of the disc is the force along, times s'
    q = np.linspace(0.05, 6.2, 50)
    disc = press_force.disc
    found, at = disc.contact(q), disc.motion(q)
    omega = np.full_like(q, 40.0)
    normal = press_force.normal(at, omega, 0.0 * q)
    torque = (np.conj(found.point) * found.normal).imag * normal
    assert torque == pytest.approx(press_force.along(at, omega, 0.0 * q) * at.s1, rel=1e-9,
                                   abs=1e-9)


def test_friction_steps_where_the_follower_turns_round():
    disc = CamDisc(profile_of(0.02), TranslatingRoller(0.05, 0.01))
    angles, forces = ContactForce(disc, [Spring(1000.0, 0.1), Friction(0.0, 20.0)]).at_speed(1.0)
    for at, before, behind in ((0.0, 0.0, 20.0), (90.0, 20.0, 0.0), (150.0, 0.0, -20.0),
                               (280.0, -20.0, 0.0)):
        k = np.flatnonzero(np.abs(angles / DEGREE - at) < 1e-6)
        spring = 1000.0 * (0.1 + float(disc.profile(at * DEGREE)))
        cosine = np.cos(disc.pressure_angle(at * DEGREE))
        steps = sorted(forces[k] * cosine - spring)
        wanted = sorted({before, behind}) if at else [behind]
        assert steps == pytest.approx(wanted, abs=1e-6)
