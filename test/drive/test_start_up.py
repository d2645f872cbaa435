# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The start-up of a cam drive, and drives of all kinds, against time stepping and identities."""

from dataclasses import replace
from math import isfinite
import re

from cam_motion.drive import course
from cam_motion.drive.course import Course
from cam_motion.drive.gearbox import Gearbox
from cam_motion.drive.load import Lever, Terms
from cam_motion.drive.motor import InductionMotor, KlossMotor
from cam_motion.drive.orbit import find_orbit, NoOrbitError
from cam_motion.drive.passage import settle
from cam_motion.drive.start_up import StallError, start_up
from cam_motion.drive.time_stepping import step_in_time
from cam_motion.units import DEGREE, RPM, TURN
from hypothesis import assume, given, HealthCheck, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

SOLVERS_AGREE = 1e-9  # asked of the two solvers; the tolerance of the slow one is 1e-11
BALANCE = 1e-9  # asked of the energy over a revolution
CONVERGED = 1e-10  # asked of figures found with half as many points again
ELEVEN_DIGITS = 1e-11  # the reference figures are given to twelve
FORGOTTEN = 1e-11  # share of the start that is left where a motion counts as settled
ROTOR = 0.0028

few = settings(max_examples=25, deadline=None,
               suppress_health_check=[HealthCheck.function_scoped_fixture])

MOTORS = {
    'document': InductionMotor(1500.0 * RPM, 27.27, 0.315, 1.587, 1.416, ROTOR),
    'kloss': KlossMotor(1500.0 * RPM, 27.27, 0.2, ROTOR),
    'soft': KlossMotor(1500.0 * RPM, 35.0, 0.35, ROTOR),
}

WAYS = {
    'flywheel': st.one_of(st.just(0.0), st.floats(0.0, 0.01), st.floats(0.01, 0.2)),
    'efficiency': st.one_of(st.just(1.0), st.floats(0.7, 1.0)),
    'motor': st.sampled_from(sorted(MOTORS)),
    'ratio': st.floats(2.5, 6.0),
    'load': st.floats(0.0, 1.5),
}


def load_scaled(parts, load):
    return tuple(replace(part, moment=part.moment * load) if isinstance(part, Lever) else part
                 for part in parts)


def make(press, press_parts, flywheel, efficiency, motor, ratio, load):
    drive = press(flywheel, motor=MOTORS[motor], parts=load_scaled(press_parts, load),
                  nominal_speed=1421.0 * RPM / ratio)
    return replace(drive, gearbox=Gearbox(ratio, efficiency, 0.004))


def orbit_or_refusal(drive):
    """Find the orbit; a drive without one is refused with figures, and not used further."""
    try:
        return find_orbit(drive)
    except NoOrbitError as refused:
        needed, peak, given = map(float, re.search(
            r'takes (\S+) N m on average and up to (\S+) N m, the motor gives up to (\S+) N m',
            str(refused)).groups())
        assert all(map(isfinite, (needed, peak, given)))
        assume(False)


def over(stretches, value, points=24):
    """Integrate something over the angle by more points than the solver has."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    total = 0.0
    for stretch in stretches:
        q = stretch.element.start + 0.5 * stretch.span * (nodes + 1.0)
        total += 0.5 * stretch.span * float(weights @ value(stretch, q))
    return total


@few
@given(**WAYS)
def test_every_orbit_closes_its_energy_and_is_one_revolution_of_the_start_up_equation(
        press, press_parts, **ways):
    drive = make(press, press_parts, **ways)
    orbit = orbit_or_refusal(drive)
    taken = over(orbit.stretches, lambda stretch, q: drive.terms(
        drive.follower(stretch.element, q)).force)
    driven = over(orbit.stretches, lambda stretch, q: drive.motor_torque(stretch.omega(q)))
    assert driven + taken == pytest.approx(0.0, abs=BALANCE * orbit.start_energy)
    whole = Course.over(drive, drive.elements)
    with np.errstate(all='ignore'):
        revolved = settle(whole, whole.steady(0.5 * orbit.speeds[1] ** 2), orbit.start_energy)
    assert revolved.starts[-1] == pytest.approx(orbit.start_energy, rel=BALANCE)
    assert revolved.multiplier == pytest.approx(orbit.multiplier, rel=1e-6, abs=1e-9)
    time = over(orbit.stretches, lambda stretch, q: 1.0 / stretch.omega(q))
    assert time == pytest.approx(orbit.period, rel=BALANCE)


@few
@given(**WAYS)
def test_the_late_revolutions_of_a_start_up_are_the_orbit(press, press_parts, **ways):
    drive = make(press, press_parts, **ways)
    orbit = orbit_or_refusal(drive)
    assume(abs(orbit.multiplier) < 0.8)
    turns_to_forget = np.log(FORGOTTEN) / np.log(max(abs(orbit.multiplier), 1e-3))
    try:
        run = start_up(drive, (turns_to_forget + 40.0) * orbit.period)
    except StallError as stalled:
        assert re.search(r'(stalls at|does not start)', str(stalled))
        assume(False)
    last = [stretch for stretch, turn in zip(run.stretches, run.turns)
            if turn == run.turns[-1] - 1]
    assert last[0].energy == pytest.approx(orbit.start_energy, rel=SOLVERS_AGREE)
    passed = last[-1].time_at_end - last[0].time
    assert passed == pytest.approx(orbit.period, rel=SOLVERS_AGREE)


def test_a_start_up_is_that_of_time_stepping(press):
    drive = press()
    history = step_in_time(drive, 0.8)
    run = start_up(drive, 0.8)
    turns = np.array(run.turns)
    ends = np.array([stretch.element.end for stretch in run.stretches]) + TURN * turns
    for t, q, omega in zip(history.t[::20], history.q[::20], history.omega[::20]):
        if q < run.stretches[0].element.start:
            continue
        row = int(np.searchsorted(ends, q))
        place = np.array([q - TURN * turns[row]])
        assert run.stretches[row].times(place)[0] == pytest.approx(t, rel=SOLVERS_AGREE)
        assert run.stretches[row].omega(place)[0] == pytest.approx(omega, rel=SOLVERS_AGREE)


def test_the_figures_of_the_start_up_of_document_004_stay(press, orbit_of, base):
    drive, run = press(), start_up(press(), 3.0)
    first, *later = run.crossings(drive.nominal_speed)
    assert first == pytest.approx(0.651310339914, rel=ELEVEN_DIGITS)
    assert later == pytest.approx([0.743843882634], rel=ELEVEN_DIGITS)
    assert run.least_contact(base).value == pytest.approx(514.194992523, rel=ELEVEN_DIGITS)
    assert run.stretches[-1].time < 3.0 <= run.duration
    times, angles, omegas = run.history
    assert np.all(np.diff(times) >= -ELEVEN_DIGITS)
    assert np.all(np.diff(angles) >= -ELEVEN_DIGITS)
    low, high = orbit_of(0.06).speeds
    assert low <= omegas[-1] <= high


@pytest.mark.parametrize('motor', sorted(MOTORS))
@pytest.mark.parametrize('flywheel', [0.0, 0.06])
def test_more_points_find_the_same_figures(monkeypatch, press, base, flywheel, motor):
    drive = press(flywheel, motor=MOTORS[motor])

    def figures():
        orbit = find_orbit(drive)
        found = [orbit.period, *orbit.speeds, orbit.least_contact(base).value, orbit.motor_work]
        try:
            run = start_up(drive, 1.2)
        except StallError:
            return found
        return [*found, run.least_contact(base).value,
                *run.crossings(0.5 * orbit.speeds[0])]
    usual = figures()
    monkeypatch.setattr(course, 'POINTS', 18)
    assert figures() == pytest.approx(usual, rel=CONVERGED)


def test_a_load_too_heavy_stalls_the_shaft_where_time_stepping_finds_it(press, press_parts):
    drive = press(0.0, parts=load_scaled(press_parts, 4.0))
    with pytest.raises(StallError) as stalled:
        start_up(drive, 3.0)
    at, left = map(float, re.search(
        r'stalls at (\S+) deg of the cam shaft, where (\S+) rpm are left', str(stalled.value)
    ).groups())
    with pytest.raises(StallError) as stepped:
        step_in_time(drive, 3.0)
    stop = float(re.search(r'at (\S+) rad', str(stepped.value))[1]) % TURN / DEGREE
    assert at <= stop <= at + 60.0
    assert left > 0.0
    assert 'take a stronger motor' in str(stalled.value)


class Brake:
    """A moment against the shaft itself [N m], from rest on."""

    def __init__(self, moment):
        self.moment = moment

    def terms(self, at):
        zero = np.zeros_like(at.q)
        return Terms(zero, zero, zero - self.moment, zero)

    def follower_force(self, at, omega, alpha):
        return np.zeros_like(at.q)

    def edges(self):
        return ()


def test_a_motor_too_weak_to_start_is_refused_with_its_torque(press, press_parts):
    free = press()
    torque = float(free.motor_torque(np.zeros(1))[0])
    assert start_up(press(parts=(*press_parts, Brake(0.2 * torque))), 0.1).duration >= 0.1
    with pytest.raises(StallError, match=f'does not start: at rest it gives {torque:.4g} N m'):
        start_up(press(parts=(*press_parts, Brake(1.01 * torque))), 3.0)


def test_a_brake_slows_the_orbit_and_costs_its_work(press, press_parts, orbit_of):
    braked = find_orbit(press(parts=(*press_parts, Brake(10.0))))
    assert braked.period > orbit_of(0.06).period
    assert braked.motor_work == pytest.approx(
        (find_orbit(press(efficiency=1.0)).motor_work + 10.0 * TURN) / 0.9, rel=0.02)
