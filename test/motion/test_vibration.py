# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Vibration of a load behind an exact curve: closed forms against integration, known zeros."""

import math

from cam_motion.motion.laws import Boundary, LAWS, make_law
from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.vibration import (
    forced,
    pole,
    residual_amplitude,
    residual_spectrum,
    Response,
)
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from scipy.integrate import solve_ivp

pytestmark = pytest.mark.timeout(40)

INTEGRATED = 2e-9  # what the integrator misses, as a share of the lift
ROUNDING = 1e-12
STANDING = (Boundary.REST, Boundary.TURN)
RUNNING = [name for name, law in LAWS.items() if name != 'dwell' and not law.any_ends
           and all(end in STANDING for end in make_law(name).ends)]

frequencies = st.floats(0.3, 70.0)
dampings = st.sampled_from((0.0, 0.003, 0.05, 0.4))


def integrated(curve, nu, zeta, until):
    """Integrate the deviation piece by piece, as the acceleration may step between."""
    state, times, values = [0.0, 0.0], [], []
    acceleration = curve.differentiated(2)
    pieces = [*zip(acceleration.breaks, acceleration.pieces)]
    pieces.append((curve.end, Piece(until - curve.end)))
    for begin, piece in pieces:
        done = solve_ivp(
            lambda u, x, piece=piece: [
                x[1], -2.0 * zeta * nu * x[1] - nu * nu * x[0] - piece.at(u)],
            (0.0, piece.length), state, method='DOP853', rtol=1e-11, atol=1e-13,
            dense_output=True)
        local = np.linspace(0.0, piece.length, 40)[1:-1]
        times += [begin + u for u in local]
        values += [float(done.sol(u)[0]) for u in local]
        state = done.y[:, -1]
    return np.array(times), np.array(values)


@pytest.mark.parametrize('law, nu, zeta', [
    ('modified_trapezoid', 9.0, 0.0), ('modified_sine', 27.0, 0.02), ('polynomial_345', 4.0, 0.1),
    ('cycloidal', 2.0 * math.pi, 0.0), ('polynomial_6_to_11', 15.0, 0.3), ('cubic', 21.0, 0.0),
    ('trapezoidal_velocity', 2.0, 0.05), ('simple_harmonic', math.pi, 0.0),
])
def test_the_closed_form_is_what_integration_finds(law, nu, zeta):
    curve = make_law(law).curve
    times, values = integrated(curve, nu, zeta, 1.7)
    assert Response(curve, nu, zeta)(times) == pytest.approx(values, abs=INTEGRATED)


def test_a_wave_in_resonance_has_its_own_closed_form():
    # x'' + nu² x = -cos(nu t) from rest: x = -t sin(nu t) / (2 nu)
    nu = 7.0
    curve = Piecewise(0.0, [Piece(2.0, (), (Wave(nu, -1.0 / nu ** 2, 0.0),))])
    t = np.linspace(0.0, 2.0, 50)
    assert Response(curve, nu)(t) == pytest.approx(-t * np.sin(nu * t) / (2.0 * nu), abs=ROUNDING)


@given(st.lists(st.floats(-5.0, 5.0), min_size=1, max_size=12), frequencies, dampings,
       st.floats(1e-3, 3.0))
def test_the_state_after_a_polynomial_is_its_integral(coefficients, nu, zeta, length):
    s = pole(nu, zeta)
    piece = Piece(length, tuple(coefficients))
    nodes, weights = np.polynomial.legendre.leggauss(40)
    parts = np.linspace(0.0, length, 200)
    half = 0.5 * np.diff(parts)
    t = parts[:-1, None] + half[:, None] * (1.0 + nodes)
    expected = np.sum(half[:, None] * weights * np.exp(s * (length - t)) * piece(t))
    largest = sum(abs(c) * length ** (k + 1) for k, c in enumerate(coefficients))
    assert abs(forced(piece, s, length) - expected) <= 1e-12 * (largest + 1e-300)


@given(st.sampled_from(RUNNING), frequencies, dampings)
def test_the_residual_is_the_amplitude_of_the_free_swing(law, nu, zeta):
    curve = make_law(law).curve
    response = Response(curve, nu, zeta)
    assert response.residual == pytest.approx(
        float(residual_amplitude(curve, nu, zeta)), rel=1e-9, abs=ROUNDING)
    damped = nu * math.sqrt(1.0 - zeta * zeta)
    t = np.linspace(0.0, 2.0 * math.pi / damped, 400)
    swing = response(1.0 + t) * np.exp(zeta * nu * t)  # its decay taken off
    assert np.max(np.abs(swing)) == pytest.approx(response.residual, rel=1e-4, abs=ROUNDING)


@given(st.sampled_from(RUNNING), frequencies, dampings)
def test_no_deviation_exceeds_the_peak(law, nu, zeta):
    curve = make_law(law).curve
    response = Response(curve, nu, zeta)
    looked = np.abs(response(np.linspace(0.0, 1.0, 3001)))
    value, at = response.peak
    assert np.max(looked) <= abs(value) * (1.0 + 1e-9) + ROUNDING
    assert abs(value) <= np.max(looked) * 1.02 + ROUNDING
    assert float(response(min(at, 1.0 - 1e-15))) == pytest.approx(value, rel=1e-6, abs=1e-9)


def test_the_cycloidal_law_leaves_nothing_after_whole_periods_but_one():
    curve = make_law('cycloidal').curve
    left = residual_spectrum(curve, np.arange(1.0, 9.0))
    assert left[0] == pytest.approx(0.5, rel=1e-12)  # in resonance: pi / (2 pi)
    assert left[1:] == pytest.approx(np.zeros(7), abs=1e-15)
    ratio = np.linspace(0.35, 6.05, 58)
    nu = 2.0 * math.pi * ratio
    assert residual_spectrum(curve, ratio) == pytest.approx(
        8.0 * math.pi ** 2 * np.abs(np.sin(nu / 2.0)) / np.abs(4.0 * math.pi ** 2 - nu ** 2) / nu,
        abs=ROUNDING)


def test_the_spectra_of_parabola_and_harmonic_are_those_of_handbooks():
    # s'' = 4, then -4
    ratio = np.linspace(0.3, 6.0, 200)
    nu = 2.0 * math.pi * ratio
    left = residual_spectrum(make_law('constant_acceleration').curve, ratio)
    assert left == pytest.approx(16.0 * np.sin(nu / 4.0) ** 2 / nu ** 2, abs=ROUNDING)
    # s'' = pi²/2 cos(pi t)
    left = residual_spectrum(make_law('simple_harmonic').curve, ratio)
    assert left == pytest.approx(
        math.pi ** 2 * np.abs(np.cos(nu / 2.0)) / np.abs(nu ** 2 - math.pi ** 2), abs=1e-11)


@given(st.sampled_from(RUNNING), frequencies, dampings, st.floats(0.1, 30.0), st.floats(-4.0, 4.0))
def test_vibration_scales_with_the_lift_and_with_time(law, nu, zeta, span, lift):
    curve = make_law(law).curve
    longer = curve.scaled(3.0, 3.0 + span, lift)
    assert float(residual_amplitude(longer, nu / span, zeta)) == pytest.approx(
        abs(lift) * float(residual_amplitude(curve, nu, zeta)), rel=1e-7, abs=1e-11)


def test_a_load_as_stiff_as_can_be_deviates_by_the_acceleration_over_the_square():
    curve = make_law('polynomial_4567').curve
    nu = 400.0
    x = np.linspace(0.05, 0.95, 31)
    assert Response(curve, nu, 0.2)(x) == pytest.approx(
        -curve(x, 2) / nu ** 2, abs=0.03 * curve.peak(2).value / nu ** 2)


def test_a_cycle_repeated_for_long_ends_as_it_begins():
    law = make_law('modified_sine').curve
    cycle = Piecewise(0.0, [*law.pieces, Piece(0.5, (1.0,))])
    response = Response(cycle, 40.0, 0.03).repeated
    x = np.linspace(0.0, 1.4, 60)
    through = response
    for _ in range(3):  # state at the end of one is the start of the next
        assert through(np.array([1.5]))[0] == pytest.approx(
            through(np.array([0.0]))[0], abs=ROUNDING)
        through = Response(cycle, 40.0, 0.03, complex(through._starts[-1]))
        assert through(x) == pytest.approx(response(x), abs=ROUNDING)
    assert abs(response.peak.value) > 0.0
