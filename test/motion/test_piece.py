# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Pieces: each operation against another way to the same number."""

import math

from cam_motion.motion.piece import Piece, Wave
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from scipy.integrate import quad

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-13  # relative to the sum of magnitudes of all terms
QUADRATURE = 1e-9  # scipy's own tolerance, loosened for fast waves

amounts = st.integers(-500, 500).map(lambda n: n / 100.0)
waves = st.builds(Wave, st.integers(5, 900).map(lambda n: n / 50.0), amounts, amounts)
pieces = st.builds(
    Piece,
    st.integers(10, 300).map(lambda n: n / 100.0),
    st.lists(amounts, max_size=6).map(tuple),
    st.lists(waves, max_size=2).map(tuple),
)


def size(piece: Piece) -> float:
    """Bound the magnitude of a piece by the sum of its terms' magnitudes."""
    powers = sum(abs(c) * piece.length**k for k, c in enumerate(piece.coefficients))
    return powers + sum(abs(wave.cosine) + abs(wave.sine) for wave in piece.waves)


def grid(piece: Piece, count: int = 801) -> np.ndarray:
    """Give local coordinates over the whole piece."""
    return np.linspace(0.0, piece.length, count)


@given(pieces)
def test_one_point_gives_what_the_vector_gives(piece):
    u = grid(piece, 25)
    assert [piece.at(x) for x in u] == pytest.approx(piece(u), rel=0, abs=ROUNDING * size(piece))


@given(pieces)
def test_the_derivative_is_the_limit_of_differences(piece):
    h = 1e-4 * piece.length
    u = grid(piece, 25)[1:-1]
    third = piece.derivative.derivative.derivative
    bound = h * h / 6.0 * size(third) + 4.0 * ROUNDING * size(piece) / h
    difference = (piece(u + h) - piece(u - h)) / (2.0 * h)
    assert piece.derivative(u) == pytest.approx(difference, rel=0, abs=1.01 * bound)


@given(pieces, amounts)
def test_the_integral_starts_where_told_and_differentiates_back(piece, start):
    integral = piece.integral(start)
    slack = ROUNDING * (size(piece) + size(integral) + abs(start))
    assert integral.at(0.0) == pytest.approx(start, rel=0, abs=slack)
    assert integral.length == piece.length
    u = grid(piece)
    assert integral.derivative(u) == pytest.approx(piece(u), rel=0, abs=slack)


@given(pieces)
def test_the_integral_is_the_area(piece):
    area, _ = quad(piece.at, 0.0, piece.length, limit=400, epsabs=0.0, epsrel=1e-10,
                   full_output=True)[:2]
    found = piece.integral().at(piece.length) - piece.integral().at(0.0)
    assert found == pytest.approx(area, rel=0, abs=QUADRATURE * size(piece) * (1 + piece.length))


@given(pieces, st.integers(1, 500).map(lambda n: n / 50.0), amounts, amounts)
def test_scaling_stretches_lifts_and_shifts(piece, stretch, lift, offset):
    scaled = piece.scaled(stretch, lift, offset)
    assert scaled.length == piece.length * stretch
    u = grid(piece, 50)
    slack = 10 * ROUNDING * (abs(lift) * size(piece) + abs(offset))
    assert scaled(u * stretch) == pytest.approx(offset + lift * piece(u), rel=0, abs=slack)


@given(pieces)
def test_every_change_of_sign_is_found(piece):
    found = np.array(sorted(piece.zeros()))
    assert np.all((found >= 0.0) & (found <= piece.length))
    u = grid(piece, 2001)
    values = piece(u)
    clear = 1e-9 * size(piece)
    change = (values[:-1] * values[1:] < 0.0) & (np.abs(values[:-1]) > clear) & (
        np.abs(values[1:]) > clear)
    slack = 1e-9 * piece.length
    for low, high in zip(u[:-1][change], u[1:][change]):
        assert np.any((found >= low - slack) & (found <= high + slack)), (low, high)


@pytest.mark.parametrize(('piece', 'expected'), [
    (Piece(1.0, (-0.125, 0.75, -1.5, 1.0)), [0.5]),
    (Piece(1.0, (0.25, -1.0, 1.0)), [0.5]),
    (Piece(1.0, (0.99 * 0.01, -1.0, 1.0)), [0.01, 0.99]),
    (Piece(2.0, (0.0, 1.0), (Wave(math.pi, 0.0, -1.0),)), [0.0, 0.7364844482]),
    (Piece(2.0, (1.0,), (Wave(math.pi, 1.0, 0.0),)), [1.0]),
    (Piece(1.0, (), (Wave(math.tau, 0.0, 1.0),)), [0.0, 0.5, 1.0]),
], ids=['triple', 'double', 'close_to_both_ends',
        'line_and_sine', 'touching', 'at_the_ends_of_the_stretches'])
def test_multiple_zeros_and_zeros_at_the_ends_are_found(piece, expected):
    near_a_multiple_zero = 2e-4
    found = np.array(piece.zeros())
    for place in expected:
        assert np.min(np.abs(found - place)) < near_a_multiple_zero
    assert piece(found) == pytest.approx(0.0, abs=1e-7)


@given(pieces)
def test_the_mean_square_is_the_integral_of_the_square(piece):
    total = quad(lambda u: piece.at(u) ** 2, 0.0, piece.length, limit=400, epsabs=0.0,
                 epsrel=1e-10, full_output=True)[0]
    assert piece.mean_square() == pytest.approx(
        total / piece.length, rel=QUADRATURE, abs=1e-15 * size(piece) ** 2)


@given(pieces)
def test_no_stretch_is_longer_than_half_a_wave(piece):
    ends = piece.stretches()
    assert ends[0] == 0.0 and ends[-1] == piece.length
    fastest = max((wave.omega for wave in piece.waves), default=0.0)
    assert np.max(np.diff(ends)) * fastest <= math.pi * (1.0 + 1e-9)


def test_zero_is_known_as_zero_and_has_no_isolated_zeros():
    for piece in (Piece(1.0), Piece(1.0, (0.0, 0.0)), Piece(1.0, (), (Wave(3.0, 0.0, 0.0),))):
        assert piece.is_zero and piece.zeros() == [] and piece.mean_square() == 0.0
        assert piece.at(0.3) == 0.0 and piece.derivative.is_zero
    assert not Piece(1.0, (0.0, 1e-300)).is_zero
