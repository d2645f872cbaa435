# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The printed figures of document 004, by its own scheme and its own definitions."""

from math import acos, atan2, ceil, cos, fmod, hypot, inf, nan, pi, sin, sqrt

from cam_motion.drive.document_004 import document_metrics
from cam_motion.drive.load import Friction
from cam_motion.drive.motor import KlossMotor
from cam_motion.errors import ConfigurationError
from cam_motion.units import RPM, TURN
import numpy as np
import pytest
from scipy.integrate import solve_ivp

pytestmark = pytest.mark.timeout(60)

SAME_STEPS = 1e-9  # rounding of 30 000 Euler steps, added up in two ways
CRUDE = 1e-6  # a run over time, extremes taken from its steps
NEAR_A_JUMP = 1e-5  # the same, where the extreme is the one-sided value at a jump

PRINTED = {
    'max_pressure_angle_deg': '25.2536',
    'max_torque_estimate': '70.6292',
    'steady_state_time_s': '0.6513',
    'stability_pct': '84.0363',
    'fluctuation_pct': '5.8038',
    'running_cost_pct': '9.4831',
    'min_contact_force': '514.2013',
}


def listing(h, flywheel=0.06):
    """Run the loop of the document's appendix, line by line, with plain floats."""
    beta, lift, back = 5.0 * pi / 6.0, 0.06, 2.0 * pi - 5.0 * pi / 6.0
    r = 1421.0 / 400.0
    count = round(3.0 / h) + 1
    qs, speeds, forces = [0.0], [0.0], []
    steady = None
    for i in range(count - 1):
        q, w = qs[i], speeds[i]
        x = fmod(q, 2.0 * pi)
        if x <= beta:
            s = lift / 2.0 * (1.0 - cos(pi * x / beta))
            s_p = pi * lift / (2.0 * beta) * sin(pi * x / beta)
            s_pp = pi ** 2 * lift / (2.0 * beta ** 2) * cos(pi * x / beta)
            moment = 150.0
        else:
            s = lift - lift / 2.0 * (1.0 - cos(pi * (x - beta) / back))
            s_p = -lift / 2.0 * pi / back * sin(pi * (x - beta) / back)
            s_pp = -lift / 2.0 * (pi / back) ** 2 * cos(pi * (x - beta) / back)
            moment = 0.0
        phi = acos((0.3 - 0.1 - 0.04 - 0.012 - s) / 0.18)
        across = 0.18 * sin(phi)
        g1 = s_p / across
        g1_p = (0.18 * s_pp * sin(phi) - 0.18 * s_p * cos(phi) * g1) / across ** 2
        inertia = (0.02 + 0.05 * g1 ** 2 + 7.0 * s_p ** 2 + (1.0 + 0.1 * r) * 0.0028
                   + 0.0028 * r ** 2 + flywheel * r ** 2)
        centripetal = 0.05 * g1 * g1_p + 7.0 * s_p * s_pp
        slip = 1.0 - abs(w) * r / (1500.0 * pi / 30.0)
        torque = 27.27 / (1.0 + (0.315 - slip) ** 2 * (1.587 / slip - 1.416 * slip ** 2)) * r * 0.9
        force = (torque - moment * g1 - 7.0 * 9.81 * s_p - 20000.0 * (s + 0.01) * s_p)
        alpha = (force - centripetal * w ** 2) / inertia
        along = (7.0 * (s_p * alpha + s_pp * w ** 2) + 7.0 * 9.81 + 20000.0 * (s + 0.01)
                 + (0.05 * (g1 * alpha + g1_p * w ** 2) + moment) / across)
        forces.append(along / cos(atan2(s_p, 0.04 + 0.012 + s)))
        if steady is None and w > 400.0 * pi / 30.0:
            steady = i * h
        qs.append(q + h * w)
        speeds.append(w + h * alpha)
    window = speeds[ceil(count / 3) - 1:count - 1]
    slowest, fastest = min(window) * 30.0 / pi, max(window) * 30.0 / pi
    breakdown = (1.0 - 0.315) * 1500.0
    return {
        'steady_state_time_s': steady,
        'stability_pct': (r * slowest - breakdown) / (1500.0 - breakdown) * 100.0,
        'fluctuation_pct': (fastest - slowest) / 400.0 * 100.0,
        'running_cost_pct':
            abs((slowest + fastest) / 2.0 * r - 1421.0) / (1500.0 - breakdown) * 100.0,
        'min_contact_force': min(forces),
    }


@pytest.mark.parametrize('name', PRINTED)
def test_the_printed_figure_comes_out_to_its_last_digit(document_run, name):
    assert f'{getattr(document_run, name):.4f}' == PRINTED[name]


@pytest.mark.parametrize('flywheel', [0.0, 0.06])
def test_the_steps_are_those_of_the_listing(press, base, flywheel):
    ours = document_metrics(press(flywheel), base, 1e-4)
    for name, value in listing(1e-4, flywheel).items():
        assert getattr(ours, name) == pytest.approx(value, rel=SAME_STEPS), name


def test_every_step_is_an_explicit_euler_step(document_run):
    _, q, omega, alpha, *_ = document_run.history
    assert (q[0], omega[0]) == (0.0, 0.0)
    assert q.size == 300_000
    assert np.array_equal(q[1:], q[:-1] + 1e-5 * omega[:-1])
    assert np.array_equal(omega[1:], omega[:-1] + 1e-5 * alpha[:-1])


def test_the_history_balances_torques_at_every_step(press, document_run):
    run = document_run.history
    q = np.mod(run.q, 2.0 * pi)
    curve = press().profile.curve
    s, s1 = curve(q), curve(q, 1)
    reach = np.sqrt(0.18 ** 2 - (0.148 - s) ** 2)
    load = s1 * (20000.0 * (s + 0.01) + 7.0 * 9.81 + np.where(q <= 5 * pi / 6, 150.0, 0) / reach)
    rest = run.inertia_torque + run.centripetal_torque + load - run.motor_torque
    assert np.max(np.abs(rest)) < 1e-9 * np.max(np.abs(run.motor_torque))


def test_the_motor_starts_with_the_torque_of_the_printed_curve_at_slip_one(document_run):
    printed = 27.27 / (1.0 + (0.315 - 1.0) ** 2 * (1.587 - 1.416)) * 1421.0 / 400.0 * 0.9
    assert document_run.history.motor_torque[0] == pytest.approx(printed, rel=1e-14)


def test_the_document_reports_the_start_up_where_the_orbit_reports_the_motion(
        document_run, orbit_of, base):
    assert document_run.min_contact_force < 0.7 * orbit_of(0.06).least_contact(base).value


def plain(q, w, flywheel):
    """Give acceleration and contact force of document 004's drive, written out by hand."""
    r, x, beta = 1421.0 / 400.0, q % TURN, 5.0 * pi / 6.0
    rising = x <= beta
    k = pi / beta if rising else pi / (TURN - beta)
    x, amount = (x, 0.03) if rising else (x - beta, -0.03)
    s = amount * (1.0 - cos(k * x)) + (0.0 if rising else 0.06)
    s1, s2 = amount * k * sin(k * x), amount * k * k * cos(k * x)
    moment = 150.0 if rising else 0.0
    across = 0.148 - s
    reach = sqrt(0.18 ** 2 - across ** 2)
    g1 = s1 / reach
    g1_slope = (s2 * reach - across * g1 * s1) / reach ** 2
    inertia = (0.02 + (1.0 + 0.1 * r) * 0.0028 + (0.0028 + flywheel) * r * r
               + 0.05 * g1 * g1 + 7.0 * s1 * s1)
    slip = 1.0 - w * r / (50.0 * pi)
    torque = 27.27 * slip / (slip + (0.315 - slip) ** 2 * (1.587 - 1.416 * slip ** 3))
    torque *= r * (0.9 if torque >= 0.0 else 1.0 / 0.9)
    load = moment * g1 + 7.0 * 9.81 * s1 + 20000.0 * (s + 0.01) * s1
    alpha = (torque - load - (0.05 * g1 * g1_slope + 7.0 * s1 * s2) * w * w) / inertia
    force = (7.0 * (s1 * alpha + s2 * w * w + 9.81) + 20000.0 * (s + 0.01)
             + (0.05 * (g1 * alpha + g1_slope * w * w) + moment) / reach)
    return alpha, force * hypot(s1, 0.052 + s) / (0.052 + s)


def test_a_plain_run_from_rest_settles_into_the_same_motion(orbit_of, base):
    run = solve_ivp(lambda t, y: (y[1], plain(*y, 0.06)[0]), (0.0, 2.2), [0.0, 0.0],
                    method='DOP853', rtol=1e-9, atol=1e-11, max_step=3e-4)
    q, omega = run.y
    turns = int(q[-1] // TURN)
    last = (q >= (turns - 1) * TURN) & (q <= turns * TURN)
    orbit = orbit_of(0.06)
    assert np.min(omega[last]) == pytest.approx(orbit.speeds[0], rel=CRUDE)
    assert np.max(omega[last]) == pytest.approx(orbit.speeds[1], rel=CRUDE)
    least = min(plain(x, w, 0.06)[1] for x, w in zip(q[last], omega[last]))
    assert least == pytest.approx(orbit.least_contact(base).value, rel=NEAR_A_JUMP)


def test_friction_in_the_load_costs_speed(press, press_parts, base):
    friction = (*press_parts, Friction(viscous=20.0, coulomb=50.0))
    with_friction = document_metrics(press(parts=friction), base, 1e-4)
    without = document_metrics(press(), base, 1e-4)
    assert with_friction.stability_pct < without.stability_pct
    assert with_friction.max_torque_estimate > without.max_torque_estimate


def test_a_motor_known_by_rated_figures_does_as_well(press, base):
    motor = KlossMotor.from_rated(1500.0 * RPM, 1421.0 * RPM, 10.1, 45.0, 0.0028)
    found = document_metrics(press(motor=motor), base, 1e-4)
    assert found.steady_state_time_s < 1.5
    assert 0.0 < found.fluctuation_pct < 10.0
    assert 0.0 < found.stability_pct < 100.0


def test_a_speed_that_is_never_reached_has_no_time(press, base):
    assert document_metrics(press(), base, 1e-4, 0.3).steady_state_time_s is None


@pytest.mark.parametrize(('changed', 'path'), [
    ({'step': 0.0}, 'step'), ({'step': -1e-5}, 'step'), ({'step': nan}, 'step'),
    ({'duration': 2e-5}, 'duration'), ({'duration': inf}, 'duration'),
    ({'duration': nan}, 'duration'), ({'base': 0.0}, 'base'),
])
def test_nonsense_is_refused_by_name(press, base, changed, path):
    with pytest.raises(ConfigurationError) as refused:
        document_metrics(press(), **{'base': base, **changed})
    assert [problem.path for problem in refused.value.problems] == [path]


def test_a_step_too_long_for_the_method_is_refused(press, base):
    with pytest.raises(ConfigurationError, match=r'step: 2\.0; .*diverges within \d+ s'):
        document_metrics(press(), base, 2.0, 100.0)


def test_a_motor_without_slip_is_refused(press, base):
    class Servo:
        inertia = 0.001

        def torque(self, speed):
            return 0.0 * speed + 30.0

        def slope(self, speed):
            return 0.0 * speed

    with pytest.raises(ConfigurationError, match="motor: 'Servo'; must have a synchronous speed"):
        document_metrics(press(motor=Servo()), base)
