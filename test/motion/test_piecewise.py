# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The exact curve: both ways of evaluation agree, and nothing of what a joint does is lost."""

import math

from cam_motion.errors import DomainError
from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.rise import from_acceleration, Piecewise
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-11  # relative to the largest magnitude of the derivative
LARGE = 40_000  # more points than one block of the evaluator

amounts = st.integers(-500, 500).map(lambda n: n / 100.0)
waves = st.builds(Wave, st.integers(10, 500).map(lambda n: n / 50.0), amounts, amounts)
pieces = st.builds(
    Piece,
    st.integers(10, 200).map(lambda n: n / 100.0),
    st.lists(amounts, max_size=5).map(tuple),
    st.lists(waves, max_size=2).map(tuple),
)
curves = st.builds(Piecewise, amounts, st.lists(pieces, min_size=1, max_size=6))


def size(curve, order):
    """Bound the magnitude of a derivative by the sum of its terms' magnitudes."""
    return max(
        sum(abs(c) * piece.length**k for k, c in enumerate(piece.coefficients))
        + sum(abs(wave.cosine) + abs(wave.sine) for wave in piece.waves)
        for piece in curve.differentiated(order).pieces
    )


def by_hand(curve, x, order):
    """Evaluate at one point by the definition: the last piece that begins at or before it."""
    index = max(k for k in range(len(curve.pieces)) if k == 0 or curve.breaks[k] <= x)
    return curve.differentiated(order).pieces[index].at(x - curve.breaks[index])


@given(curves, st.integers(0, 1000))
def test_sample_gives_what_the_vector_gives_in_every_order(curve, seed):
    inside = np.random.default_rng(seed).uniform(curve.start, curve.end, 20)
    x = np.concatenate([inside, curve.breaks])
    sampled = np.array([curve.sample(float(point)) for point in x])
    for order in range(4):
        expected = curve(np.minimum(x, curve.end), order)
        assert sampled[:, order] == pytest.approx(
            expected, rel=0, abs=ROUNDING * size(curve, order))


CURVE = Piecewise(-0.5, [
    Piece(1.0, (0.0, 1.0, 2.0)), Piece(0.25, (7.0, -1.0), (Wave(3.0, 0.5, 1.0),)),
    Piece(0.75, (-2.0,)), Piece(0.5, (1.0, 0.0, 0.0, 4.0), (Wave(9.0, 0.0, -1.0),)),
])
SHUFFLE = np.random.default_rng(20260101)
POINTS = {
    'sorted': np.linspace(-0.5, 2.0, LARGE),
    'falling': np.linspace(2.0, -0.5, 1001),
    'shuffled': SHUFFLE.uniform(-0.5, 2.0, LARGE),
    'saw_tooth': np.tile(np.linspace(-0.5, 1.9, 1000), 3),
    'equal': np.full(700, 0.5),
    'two_dimensional': SHUFFLE.uniform(-0.5, 2.0, (37, 11)),
    'transposed': np.linspace(-0.5, 2.0, 600).reshape(20, 30).T,
    'strided': np.linspace(-0.5, 2.0, 999)[::-3],
    'empty': np.empty((0, 3)),
    'scalar': np.array(0.3),
    'joints': np.array(CURVE.breaks),
}


@pytest.mark.parametrize('order', range(4))
@pytest.mark.parametrize('name', POINTS)
def test_any_shape_and_any_order_of_points_give_the_same_values(name, order):
    x = POINTS[name]
    values = CURVE(x, order)
    assert values.shape == x.shape
    some = slice(None, None, 97 if x.size == LARGE else 1)
    expected = [by_hand(CURVE, point, order) for point in x.ravel()[some]]
    assert values.ravel()[some] == pytest.approx(np.array(expected), rel=0, abs=1e-11)


@pytest.mark.parametrize('count', [10, 5000])
def test_nan_stays_nan_and_harms_no_neighbour(count):
    x = np.linspace(-0.5, 2.0, count)
    holes = [0, count // 4, count // 2, count // 2 + 1, 3 * count // 4, count - 1]
    expected = CURVE(x)
    expected[holes] = math.nan
    x[holes] = math.nan
    assert CURVE(x) == pytest.approx(expected, rel=0, abs=0, nan_ok=True)


def test_lists_and_integers_are_taken_as_numbers():
    assert CURVE([0, 1]).tolist() == [CURVE(0.0), CURVE(1.0)]
    assert float(CURVE(0)) == 1.0


def test_a_joint_has_the_value_from_the_right_and_the_end_that_from_the_left():
    assert float(CURVE(0.5)) == 7.5
    assert CURVE.sample(0.5)[0] == 7.5
    assert float(CURVE(0.75)) == -2.0
    assert float(CURVE(2.0)) == CURVE.pieces[-1].at(0.5) == CURVE.end_values(0)[1]
    ends = [CURVE.end_values(order)[1] for order in range(4)]
    assert ends == pytest.approx(CURVE.sample(2.0), rel=1e-13)


@pytest.mark.parametrize('x', [-0.6, 2.1, [0.0, 2.1], [[-0.6], [0.0]], math.inf, -math.inf])
def test_an_abscissa_outside_the_curve_is_refused(x):
    with pytest.raises(DomainError, match='defined from -0.5 to 2'):
        CURVE(x)


def test_nan_does_not_hide_an_abscissa_outside_the_curve():
    with pytest.raises(DomainError):
        CURVE([math.nan, 2.1])


def test_rounding_beyond_the_ends_is_forgiven():
    assert CURVE([-0.5 - 1e-13, 2.0 + 1e-13]) == pytest.approx(CURVE([-0.5, 2.0]), abs=1e-11)


def test_a_curve_needs_a_piece():
    with pytest.raises(DomainError, match='at least one piece'):
        Piecewise(0.0, [])


@given(curves, st.integers(0, 3))
def test_the_derivative_of_a_curve_has_the_same_joints(curve, order):
    assert curve.differentiated(order).breaks == curve.breaks
    x = np.linspace(curve.start, curve.end, 50)
    assert curve.differentiated(order)(x).tolist() == curve(x, order).tolist()


@given(curves, st.integers(0, 400).map(lambda n: 0.1 + n / 100.0), amounts, amounts, amounts)
def test_scaling_fits_span_lift_start_and_offset(curve, span, lift, start, offset):
    scaled = curve.scaled(start, start + span, lift, offset)
    assert (scaled.start, scaled.end) == (start, start + span)
    share = (np.arange(20) + 0.5) / 20.0
    old = curve.start + share * (curve.end - curve.start)
    steep = 1e-14 * size(curve, 1) * (abs(curve.end) + abs(curve.start) + 1.0)
    slack = ROUNDING * (abs(lift) * size(curve, 0) + abs(offset)) + 100 * abs(lift) * steep
    near_joint = np.min(np.abs(old[:, None] - np.array(curve.breaks)), axis=1) < 1e-6
    new = start + share * span
    assert scaled(new)[~near_joint] == pytest.approx(
        (offset + lift * curve(old))[~near_joint], rel=0, abs=slack * (1.0 + 10.0 / span))


@given(st.lists(pieces, min_size=1, max_size=5))
def test_integrating_an_acceleration_gives_a_smooth_rise_to_one(diagram):
    area, reach = 0.0, 0.0
    for piece in diagram:
        reach += area * piece.length + piece.integral().integral().at(piece.length)
        area += piece.integral().at(piece.length)
    if abs(reach) < 1e-2:
        return
    rise = from_acceleration(diagram)
    assert rise.end_values(0) == pytest.approx((0.0, 1.0), rel=0, abs=1e-12)
    assert rise.end_values(1)[0] == pytest.approx(0.0, abs=1e-11 * size(rise, 1))
    for order in (0, 1):
        ends = zip(rise.differentiated(order).pieces, rise.differentiated(order).pieces[1:])
        for left, right in ends:
            assert left.at(left.length) == pytest.approx(
                right.at(0.0), rel=0, abs=ROUNDING * size(rise, order))
