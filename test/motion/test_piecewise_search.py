# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What is searched for in a curve: extremes, peaks, power, steps. Never less than any grid."""

import math

from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.piecewise import Piecewise
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-10  # relative to the sum of magnitudes of all terms
GRID = 1001  # points on each piece

amounts = st.integers(-500, 500).map(lambda n: n / 100.0)
waves = st.builds(Wave, st.integers(10, 500).map(lambda n: n / 50.0), amounts, amounts)
pieces = st.builds(
    Piece,
    st.integers(10, 200).map(lambda n: n / 100.0),
    st.lists(amounts, max_size=5).map(tuple),
    st.lists(waves, max_size=2).map(tuple),
)
curves = st.builds(Piecewise, amounts, st.lists(pieces, min_size=1, max_size=5))
orders = st.integers(0, 3)


def size(curve, order):
    """Bound the magnitude of a derivative by the sum of its terms' magnitudes."""
    return max(
        sum(abs(c) * piece.length**k for k, c in enumerate(piece.coefficients))
        + sum(abs(wave.cosine) + abs(wave.sine) for wave in piece.waves)
        for piece in curve.differentiated(order).pieces
    )


def dense(curve, order):
    """Give values on a dense grid, both sides of each joint included."""
    return np.concatenate([piece(np.linspace(0.0, piece.length, GRID))
                           for piece in curve.differentiated(order).pieces])


def one_sided(curve, order, at):
    """Give the values that a derivative has at an abscissa: one, or two at a joint."""
    slack = 1e-12 * (abs(curve.start) + abs(curve.end))
    return [
        piece.at(min(max(at - begin, 0.0), piece.length))
        for begin, end, piece in zip(
            curve.breaks, curve.breaks[1:], curve.differentiated(order).pieces)
        if begin - slack <= at <= end + slack
    ]


def nearest(values, wanted):
    """Give the distance of the nearest of some values."""
    return min(abs(value - wanted) for value in values)


@given(curves, orders)
def test_extremes_are_attained_and_no_grid_exceeds_them(curve, order):
    least, greatest = curve.extremes(order)
    values, slack = dense(curve, order), ROUNDING * size(curve, order)
    assert least.value <= values.min() + slack
    assert greatest.value >= values.max() - slack
    for extreme in (least, greatest):
        assert nearest(one_sided(curve, order, extreme.at), extreme.value) <= slack


@given(curves, orders)
def test_the_peak_is_the_larger_of_both_extremes_with_its_sign(curve, order):
    peak = curve.peak(order)
    slack = ROUNDING * size(curve, order)
    assert abs(peak.value) >= np.abs(dense(curve, order)).max() - slack
    assert nearest([e.value for e in curve.extremes(order)], peak.value) <= slack
    assert nearest(one_sided(curve, order, peak.at), peak.value) <= slack


@given(curves)
def test_the_peak_of_power_is_attained_and_no_grid_exceeds_it(curve):
    peak = curve.peak_power()
    slack = ROUNDING * (size(curve, 1) * size(curve, 2) + 1e-300)
    assert abs(peak.value) >= np.abs(dense(curve, 1) * dense(curve, 2)).max() - slack
    at = zip(one_sided(curve, 1, peak.at), one_sided(curve, 2, peak.at))
    assert nearest([v * a for v, a in at], peak.value) <= slack


def test_of_equal_peaks_the_first_is_reported():
    curve = Piecewise(0.0, [Piece(4.0 * math.pi, (), (Wave(1.0, 0.0, 1.0),))])
    assert curve.peak(0) == pytest.approx((1.0, 0.5 * math.pi))
    least, greatest = curve.extremes(0)
    assert least == pytest.approx((-1.0, 1.5 * math.pi))
    assert greatest == pytest.approx((1.0, 0.5 * math.pi))


def test_a_curve_of_zeros_has_zero_peaks_at_its_start():
    curve = Piecewise(2.0, [Piece(1.0), Piece(1.0, (0.0,))])
    assert curve.peak(2) == (0.0, 2.0) == curve.peak_power()
    assert curve.rms(1) == 0.0 and curve.jumps(0) == []


@given(st.lists(amounts, min_size=4, max_size=4), pieces, st.integers(1, 300))
def test_steps_at_a_joint_are_exact_in_every_order(steps, left, hundredths):
    values = [left.at(left.length)]
    derivative = left
    for _ in range(3):
        derivative = derivative.derivative
        values.append(derivative.at(left.length))
    taylor = [(value + step) / math.factorial(order)
              for order, (value, step) in enumerate(zip(values, steps))]
    curve = Piecewise(1.0, [left, Piece(hundredths / 100.0, tuple(taylor))])
    for order, step in enumerate(steps):
        found = curve.jumps(order)
        if abs(step) > 2e-9 * abs(curve.peak(order).value):
            assert [(jump.at, jump.order) for jump in found] == [(curve.breaks[1], order)]
            assert found[0].amount == pytest.approx(
                step, rel=0, abs=1e-12 * (size(curve, order) + 1.0))
        elif step == 0.0:
            assert found == []


@given(curves, orders)
def test_the_root_mean_square_is_that_of_a_fine_midpoint_sum(curve, order):
    total = 0.0
    for piece in curve.differentiated(order).pieces:
        step = piece.length / 4000
        total += step * float(np.sum(piece((np.arange(4000) + 0.5) * step) ** 2))
    expected = math.sqrt(total / (curve.end - curve.start))
    assert curve.rms(order) == pytest.approx(
        expected, rel=1e-4, abs=1e-6 * size(curve, order))
