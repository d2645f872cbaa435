# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The periodic motion of a cam drive, against time stepping, energy and plain integration."""

from dataclasses import replace
from math import acos, sqrt
import re

from cam_motion.drive import course
from cam_motion.drive.load import Friction
from cam_motion.drive.motor import InductionMotor
from cam_motion.drive.orbit import find_orbit, NoOrbitError
from cam_motion.drive.time_stepping import step_in_time
from cam_motion.errors import ConfigurationError
from cam_motion.units import RPM, TURN
import numpy as np
import pytest
from scipy.integrate import solve_ivp

pytestmark = pytest.mark.timeout(60)

SOLVERS_AGREE = 1e-8  # asked of the two solvers; the tolerance of the slow one is 1e-11
BALANCE = 1e-9  # asked of the energy over a revolution
ELEVEN_DIGITS = 1e-11  # the reference figures are given to twelve or thirteen
DIFFERENCE = 1e-5  # one-revolution energies from two starts 0.02 % apart

SWEEP = [0.0, 0.02, 0.06, 0.2]
flywheels = pytest.mark.parametrize('flywheel', SWEEP)

MOMENT_WORK = 150.0 * (acos((0.148 - 0.06) / 0.18) - acos(0.148 / 0.18))
"""What the moment on the lever takes in a turn; spring and weight give back what they take [J]."""


def start_speed(drive, orbit):
    inertia = drive.terms(drive.follower(drive.elements[0], np.zeros(1))).inertia
    return sqrt(2.0 * orbit.start_energy / float(inertia[0]))


def figures(drive, orbit, base):
    slowest, fastest = (drive.gearbox.ratio * speed for speed in orbit.speeds)
    synchronous = drive.motor.synchronous_speed
    breakdown = (1.0 - drive.motor.breakdown_slip) * synchronous
    rated = drive.gearbox.ratio * drive.nominal_speed
    span = synchronous - breakdown
    return {
        'fluctuation_pct': 100.0 * (fastest - slowest) / rated,
        'stability_pct': 100.0 * (slowest - breakdown) / span,
        'running_cost_pct': 100.0 * abs(0.5 * (slowest + fastest) - rated) / span,
        'min_speed_rpm': orbit.speeds[0] / RPM,
        'max_speed_rpm': orbit.speeds[1] / RPM,
        'period_s': orbit.period,
        'min_contact_force': orbit.least_contact(base).value,
    }


REFERENCE = {
    'fluctuation_pct': 5.7675671504,
    'stability_pct': 84.0672379220,
    'running_cost_pct': 9.4595267269,
    'min_speed_rpm': 401.0465022327,
    'max_speed_rpm': 424.1167708341,
    'period_s': 0.1450662602529,
    'min_contact_force': 774.1485557681,
}


def revolve(drive, energy):
    """Integrate dE/dq = Q over one turn with a general solver, element by element."""
    for element in drive.elements:
        def power(q, state, element=element):
            terms = drive.terms(drive.follower(element, np.array([q])))
            omega = np.sqrt(2.0 * state / terms.inertia)
            return terms.force + terms.damping * omega + drive.motor_torque(omega)
        energy = solve_ivp(power, (element.start, element.end), [energy], method='DOP853',
                           rtol=1e-12, atol=1e-12).y[0, -1]
    return float(energy)


@pytest.mark.parametrize('name', REFERENCE)
def test_the_figures_of_document_004_in_periodic_motion_stay(press, orbit_of, base, name):
    found = figures(press(), orbit_of(0.06), base)
    assert found[name] == pytest.approx(REFERENCE[name], rel=ELEVEN_DIGITS)


@flywheels
def test_time_stepping_from_the_orbit_comes_back_to_it_after_its_period(
        press, orbit_of, flywheel):
    drive, orbit = press(flywheel), orbit_of(flywheel)
    speed = start_speed(drive, orbit)
    history = step_in_time(drive, orbit.period, speed)
    assert history.t[-1] == pytest.approx(orbit.period, rel=SOLVERS_AGREE)
    assert history.q[-1] == pytest.approx(TURN, rel=SOLVERS_AGREE)
    assert history.omega[-1] == pytest.approx(speed, rel=SOLVERS_AGREE)
    assert min(history.omega) >= orbit.speeds[0] * (1.0 - SOLVERS_AGREE)
    assert max(history.omega) <= orbit.speeds[1] * (1.0 + SOLVERS_AGREE)


@flywheels
def test_the_motor_gives_over_a_revolution_what_the_load_takes(press, orbit_of, flywheel):
    drive, orbit = press(flywheel), orbit_of(flywheel)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    driven = 0.0
    for stretch in orbit.stretches:
        half = 0.5 * stretch.span
        omega = stretch.omega(stretch.element.start + half * (nodes + 1.0))
        driven += half * float(weights @ drive.motor_torque(omega))
    assert driven == pytest.approx(MOMENT_WORK, rel=BALANCE)


@flywheels
def test_without_losses_the_work_of_the_motor_is_that_of_the_load(press, flywheel):
    orbit = find_orbit(press(flywheel, efficiency=1.0))
    assert orbit.motor_work == pytest.approx(MOMENT_WORK, rel=BALANCE)


def test_where_power_never_reverses_the_motor_pays_for_the_gearbox(orbit_of):
    orbit = orbit_of(0.2)
    assert orbit.power_reversals() == []
    assert orbit.motor_work * 0.9 == pytest.approx(MOMENT_WORK, rel=BALANCE)


@flywheels
def test_the_energy_comes_back_after_a_revolution(press, orbit_of, flywheel):
    start = orbit_of(flywheel).start_energy
    assert revolve(press(flywheel), start) == pytest.approx(start, rel=BALANCE)


@flywheels
def test_the_multiplier_is_the_slope_of_the_one_revolution_map(press, orbit_of, flywheel):
    drive, orbit = press(flywheel), orbit_of(flywheel)
    step = 1e-4 * orbit.start_energy
    above, below = (revolve(drive, orbit.start_energy + sign * step) for sign in (1.0, -1.0))
    assert orbit.multiplier == pytest.approx((above - below) / (2.0 * step), abs=DIFFERENCE)


def test_the_fluctuation_falls_with_the_flywheel(orbit_of):
    widths = [np.ptp(orbit_of(flywheel).speeds) for flywheel in SWEEP]
    assert widths == sorted(widths, reverse=True)


def test_a_heavier_flywheel_forgets_more_slowly(orbit_of):
    multipliers = [orbit_of(flywheel).multiplier for flywheel in SWEEP]
    assert multipliers == sorted(multipliers)
    assert all(0.0 <= x < 1.0 for x in multipliers)


@pytest.mark.parametrize('flywheel', np.linspace(0.0, 0.2, 11).tolist())
def test_every_flywheel_of_the_sweep_has_its_orbit(orbit_of, flywheel):
    orbit = orbit_of(flywheel)
    end = orbit.stretches[-1].energy_at_end
    assert end == pytest.approx(orbit.start_energy, rel=1e-12)


@pytest.mark.parametrize('flywheel', [0.0, 0.06])
@pytest.mark.parametrize('points', [9, 14])
def test_the_number_of_gauss_points_does_not_matter(
        monkeypatch, press, orbit_of, flywheel, points):
    monkeypatch.setattr(course, 'POINTS', points)
    other, usual = find_orbit(press(flywheel)), orbit_of(flywheel)
    assert other.stretches[0].powers.size == points
    assert other.period == pytest.approx(usual.period, rel=BALANCE)
    assert other.speeds == pytest.approx(usual.speeds, rel=BALANCE)


@flywheels
def test_the_revolution_is_cut_where_the_power_reverses(press, orbit_of, flywheel):
    drive, orbit = press(flywheel), orbit_of(flywheel)
    ends = np.array([stretch.element.end for stretch in orbit.stretches])
    for place in orbit.power_reversals():
        assert np.min(np.abs(ends - place)) < 1e-7
    for stretch in orbit.stretches:
        omega = stretch.omega(stretch.dense())
        torque = drive.motor.torque(drive.gearbox.ratio * omega)
        clear = torque[np.abs(torque) > 1e-6 * drive.motor.breakdown_torque]
        assert abs(np.sum(np.sign(clear))) == clear.size


def test_friction_slows_the_shaft_and_costs_the_motor_its_work(press, press_parts, orbit_of):
    drive = press(parts=(*press_parts, Friction(viscous=20.0, coulomb=50.0)))
    orbit = find_orbit(drive)
    assert orbit.period > orbit_of(0.06).period
    rubbed = 0.0
    nodes, weights = np.polynomial.legendre.leggauss(24)
    for stretch in orbit.stretches:
        q = stretch.element.start + 0.5 * stretch.span * (nodes + 1.0)
        s1 = drive.profile(q, 1)
        force = 50.0 * np.abs(s1) + 20.0 * s1 ** 2 * stretch.omega(q)
        rubbed += 0.5 * stretch.span * float(weights @ force)
    without_loss = find_orbit(press(efficiency=1.0))
    assert without_loss.motor_work < rubbed + MOMENT_WORK < orbit.motor_work
    assert revolve(drive, orbit.start_energy) == pytest.approx(orbit.start_energy, rel=BALANCE)


@flywheels
@pytest.mark.parametrize('torque', [1.0, 2.0, 3.0])
def test_a_motor_too_weak_has_no_orbit_and_the_refusal_gives_the_figures(
        press, flywheel, torque):
    weak = InductionMotor(1500.0 * RPM, torque, 0.315, 1.587, 1.416, 0.0028)
    with pytest.raises(NoOrbitError) as refused:
        find_orbit(press(flywheel, motor=weak))
    text = str(refused.value)
    largest = torque * 1421.0 / 400.0 * 0.9
    assert 'near 400 rpm' in text
    assert f'takes {MOMENT_WORK / TURN:.4g} N m on average' in text
    given = re.search(r'the motor gives up to (\S+) N m at the cam shaft', text)
    assert float(given[1]) == pytest.approx(largest, rel=1e-3)
    assert 'take a stronger motor' in text


@pytest.mark.parametrize(('name', 'value', 'rule'), [
    ('flywheel', -0.06, 'must be at least 0 kg m²'),
    ('flywheel', float('nan'), 'must be at least 0 kg m²'),
    ('nominal_speed', 0.0, 'must be above 0'),
    ('nominal_speed', float('inf'), 'must be above 0'),
])
def test_figures_that_make_no_drive_are_refused(press, name, value, rule):
    with pytest.raises(ConfigurationError) as refused:
        press(**{name: value})
    problem, = refused.value.problems
    assert (problem.path, problem.value is value, problem.rule) == (name, True, rule)


@pytest.mark.parametrize('flywheel', [0.0, 0.06])
def test_the_gearbox_passes_on_what_the_shaft_behind_it_takes(press, orbit_of, flywheel):
    drive, orbit = press(flywheel), orbit_of(flywheel)
    own = (drive.motor.inertia + flywheel) * drive.gearbox.ratio ** 2
    taken = []
    for stretch in orbit.stretches:
        q = np.linspace(stretch.element.start, stretch.element.end, 401)
        at, (omega, alpha) = drive.follower(stretch.element, q), stretch.motion(q)
        terms = drive.terms(at)
        taken.append(np.abs((terms.inertia - own) * alpha + terms.centripetal * omega ** 2
                            - terms.force - terms.damping * omega))
    assert orbit.peak_gearbox_torque == pytest.approx(np.max(taken), rel=1e-6)
    assert orbit.peak_gearbox_torque >= np.max(taken) * (1.0 - 1e-12)


def test_a_search_from_the_wrong_speed_still_finds_the_motion(press):
    drive = press()
    far = replace(drive, nominal_speed=0.4 * drive.nominal_speed)
    assert find_orbit(far).speeds == pytest.approx(find_orbit(drive).speeds, rel=1e-10)
