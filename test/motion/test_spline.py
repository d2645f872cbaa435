# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Splines through points and within a deviation of them, and the law made of them."""

import math

from cam_motion.errors import ConfigurationError, DomainError
from cam_motion.motion.difference import difference, largest
from cam_motion.motion.laws import make_law
from cam_motion.motion.piece import Piece
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from cam_motion.motion.spline import (
    DEGREES,
    EndState,
    estimate,
    hermite,
    interpolate,
    linear,
    NATURAL,
    PERIODIC,
    smooth,
)
from cam_motion.units import DEGREE, TURN
from hypothesis import assume, given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-12
SOLVED = 1e-8  # rounding of a solved spline with unequal steps, as a share of the derivative
GRID = np.linspace(0.0, TURN, 2001)


@st.composite
def tables(draw, least=3, most=25):
    """Points at unequal distances, up to a factor of 5."""
    steps = draw(st.lists(st.integers(2, 10), min_size=least - 1, max_size=most - 1))
    x = np.concatenate([[0.0], np.cumsum(steps)]) / sum(steps) * TURN
    y = draw(st.lists(st.integers(-50, 50), min_size=len(x), max_size=len(x)))
    assume(len(set(y)) > 1)
    return x, np.array(y) / 50.0


def step_sizes(curve, order):
    """Give the steps of a derivative at the inner joints, beside its peak."""
    derivative = curve.differentiated(order)
    steps = [abs(right.at(0.0) - left.at(left.length))
             for left, right in zip(derivative.pieces, derivative.pieces[1:])]
    return max(steps, default=0.0) / max(abs(curve.peak(order).value), 1e-300)


@settings(max_examples=25)
@given(tables(), st.sampled_from(DEGREES), st.sampled_from([NATURAL, PERIODIC, 'told']))
def test_a_spline_passes_through_its_points_and_is_as_smooth_as_its_degree_says(
        table, degree, kind):
    x, y = table
    ends = (EndState(0.3, -0.2), EndState(-0.1, 0.4)) if kind == 'told' else kind
    curve = interpolate(x, y, degree, ends)
    assert curve(x) == pytest.approx(y, abs=ROUNDING)
    # the highest order is judged by the one below: where it is nothing but rounding, so is it
    for order in range(1, degree):
        if abs(curve.peak(order).value) > 1e-6:
            assert step_sizes(curve, order) < SOLVED * 10.0 ** max(0, order - 1)
    if kind == 'told':
        assert curve.end_values(1) == pytest.approx((0.3, -0.1), abs=SOLVED)
        if degree == 5:
            assert curve.end_values(2) == pytest.approx((-0.2, 0.4), abs=SOLVED)
    if kind == PERIODIC:
        for order in range(1, degree):
            first, last = curve.end_values(order)
            assert first == pytest.approx(
                last, abs=SOLVED * 10.0 ** order * max(1.0, abs(curve.peak(order).value)))


@given(tables(least=4), st.sampled_from(DEGREES))
def test_natural_ends_are_free(table, degree):
    curve = interpolate(*table, degree)
    for order in range((degree + 1) // 2, degree):
        peak = abs(curve.peak(order).value)
        assert curve.end_values(order) == pytest.approx((0.0, 0.0), abs=1e-4 * peak + 1e-6)


@pytest.mark.parametrize('degree', DEGREES)
def test_a_polynomial_of_the_degree_is_its_own_spline(degree):
    polynomial = np.polynomial.Polynomial([0.5, -1.0, 0.3, 0.2, -0.05, 0.01][:degree + 1])
    x = np.array([0.0, 0.7, 1.1, 2.4, 3.0, 3.2])
    first, second = polynomial.deriv(1), polynomial.deriv(2)
    ends = tuple(EndState(first(at), second(at)) for at in (x[0], x[-1]))
    curve = interpolate(x, polynomial(x), degree, ends)
    at = np.linspace(0.0, 3.2, 101)
    for order in range(degree + 1):
        assert curve(at, order) == pytest.approx(
            polynomial.deriv(order)(at) if order else polynomial(at), abs=SOLVED)


@pytest.mark.parametrize(('degree', 'rate'), [(3, 4), (5, 6)])
def test_the_error_falls_with_the_power_of_the_steps_that_theory_gives(degree, rate):
    errors = []
    for count in (16, 32):
        x = np.linspace(0.0, TURN, count + 1)
        curve = interpolate(x, np.sin(x), degree, PERIODIC)
        errors.append(np.abs(curve(GRID) - np.sin(GRID)).max())
    assert math.log2(errors[0] / errors[1]) == pytest.approx(rate, abs=0.15)


@pytest.mark.parametrize('degree', DEGREES)
def test_a_periodic_spline_with_an_advance_differs_from_one_without_by_a_line(degree):
    x = np.linspace(0.0, TURN, 13)
    y = np.cos(x) + 0.3 * np.sin(2 * x)
    y[-1] = y[0]
    plain = interpolate(x, y, degree, PERIODIC)
    moved = interpolate(x, y + 0.7 * x, degree, PERIODIC)
    assert moved(GRID) == pytest.approx(plain(GRID) + 0.7 * GRID, abs=1e-12)


def test_two_points_make_the_line_between_them():
    for ends in (NATURAL, PERIODIC):
        curve = interpolate([0.0, 2.0], [1.0, 5.0], 5, ends)
        assert curve([0.0, 0.5, 2.0]) == pytest.approx([1.0, 2.0, 5.0])
    assert linear([0.0, 1.0, 3.0], [0.0, 2.0, 1.0])([0.5, 2.0]) == pytest.approx([1.0, 1.5])


@given(tables(least=2))
def test_pieces_with_stated_derivatives_have_them(table):
    x, y = table
    v, a = np.cos(3.0 * x), np.sin(2.0 * x)
    for curve, orders in ((hermite(x, y, v), (y, v)), (hermite(x, y, v, a), (y, v, a))):
        for order, values in enumerate(orders):
            derivative = curve.differentiated(order)
            for n, piece in enumerate(derivative.pieces):
                assert piece.at(0.0) == pytest.approx(values[n], abs=1e-12)
                assert piece.at(piece.length) == pytest.approx(values[n + 1], abs=1e-9)


def test_an_estimate_is_exact_for_a_quartic():
    polynomial = np.polynomial.Polynomial([1.0, 2.0, -3.0, 0.5, 0.25])
    x = np.array([0.0, 0.1, 0.35, 0.5, 0.9, 1.4])
    for at in (0.0, 0.35):
        found = estimate(x, polynomial(x), at)
        assert found == pytest.approx((polynomial.deriv(1)(at), polynomial.deriv(2)(at)))
    assert estimate([0.0, 2.0], [0.0, 3.0], 2.0) == pytest.approx((1.5, 0.0))


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-3, 1e-2, 0.1]), st.booleans(),
       st.sampled_from(DEGREES), st.integers(30, 120))
def test_a_smoothing_spline_holds_its_bound_at_every_point(seed, tolerance, periodic, degree, n):
    rng = np.random.default_rng(seed)
    x = np.sort(np.concatenate([[0.0, TURN], rng.uniform(0.0, TURN, n)]))
    assume(np.diff(x).min() > 1e-4)
    y = np.sin(x) + 0.2 * x + rng.uniform(-0.8, 0.8, len(x)) * tolerance
    if periodic:
        y[-1] = y[0] + 0.2 * TURN
    found = smooth(x, y, tolerance, degree, periodic)
    misses = np.abs(found.curve(x) - y)
    assert misses.max() <= tolerance * (1.0 + 1e-9)
    assert found.deviation == pytest.approx(misses.max(), abs=ROUNDING)
    assert len(found.x) <= len(x)
    again = interpolate(found.x, found.y, degree, found.ends)
    assert again(GRID) == pytest.approx(found.curve(GRID), abs=ROUNDING)
    if periodic:
        first, last = found.curve.end_values(1)
        assert first == pytest.approx(last, abs=1e-9)
        assert found.y[-1] - found.y[0] == pytest.approx(y[-1] - y[0])


def test_smoothing_takes_the_rounding_out_of_the_acceleration():
    x = np.linspace(0.0, TURN, 361)
    y = np.round(np.sin(x), 3)
    through, smoothed = interpolate(x, y, 5, PERIODIC), smooth(x, y, 1e-3, 5, True)
    assert abs(through.peak(2).value) > 4.0
    assert abs(smoothed.curve.peak(2).value) == pytest.approx(1.0, abs=0.02)
    assert len(smoothed.x) < 20


def test_few_points_are_kept_as_they_are():
    found = smooth([0.0, 1.0, 2.0], [0.0, 1.0, 0.0], 0.1)
    assert found.deviation == 0.0 and list(found.y) == [0.0, 1.0, 0.0]


@pytest.mark.parametrize(('x', 'y', 'words'), [
    ([0.0], [1.0], 'two points'), ([0.0, 1.0], [1.0], 'two points'),
    ([0.0, 1.0, 1.0], [0.0, 1.0, 2.0], 'rise'), ([0.0, 1.0], [0.0, math.nan], 'finite')])
def test_what_is_no_table_of_points_is_refused(x, y, words):
    for make in (interpolate, linear, lambda x, y: smooth(x, y, 0.1)):
        with pytest.raises(DomainError, match=words):
            make(x, y)


# The law: a segment, or a whole cam.


def sine(count=37):
    """Give the positions of a sine over a whole turn."""
    y = np.sin(np.linspace(0.0, TURN, count))
    y[-1] = y[0]
    return y.tolist()


@pytest.mark.parametrize('degree', DEGREES)
def test_a_table_makes_a_whole_cam_that_closes_in_velocity_and_acceleration(degree):
    cam = CamProfile([segment('curve', 360.0, 0.0, 'spline', positions=sine(), degree=degree)])
    assert cam.jumps(0) == cam.jumps(1) == cam.jumps(2) == []
    assert cam(GRID) == pytest.approx(np.sin(GRID), abs=2e-5)
    assert cam.sample(0.5 * math.pi)[:2] == pytest.approx((1.0, 0.0), abs=1e-4)


def test_a_table_makes_an_accumulating_cam():
    y = (np.linspace(0.0, TURN, 25) + 0.5 * np.sin(np.linspace(0.0, TURN, 25))).tolist()
    cam = CamProfile([segment('curve', 360.0, y[-1], 'spline', positions=y)], accumulate=True)
    assert cam.jumps(0) == cam.jumps(1) == cam.jumps(2) == []
    assert cam.advance == pytest.approx(TURN)
    assert float(cam(GRID[7] + 3 * TURN)) == pytest.approx(float(cam(GRID[7])) + 3 * TURN)


ANGLES = [0.0, 20.0, 50.0, 90.0, 130.0, 160.0, 180.0]
HALF = [1.0 - math.cos(angle * DEGREE) for angle in ANGLES]


def half(**parameters):
    """Give a rise of 2 over half a turn as a table at unequal angles."""
    return segment('curve', 180.0, 2.0, 'spline', **{
        'angles_deg': ANGLES, 'positions': [5.0 + y for y in HALF], **parameters})


@pytest.mark.parametrize('back', ['modified_sine', 'double_harmonic', 'cubic', 'auto', 'spline'])
def test_a_table_joins_its_neighbours_in_velocity_and_acceleration(back):
    cam = CamProfile([half(), segment('back', 360.0, -2.0, back)])
    assert cam.jumps(0) == cam.jumps(1) == cam.jumps(2) == []
    assert cam(np.array(ANGLES) * DEGREE) == pytest.approx(HALF, abs=ROUNDING)


def test_two_tables_estimate_their_joint_from_the_points_of_both():
    other = segment('back', 360.0, -2.0, 'spline', positions=HALF[::-1],
                    angles_deg=[360.0 - angle for angle in ANGLES[::-1]])
    cam = CamProfile([half(), other])
    assert cam.jumps(1) == cam.jumps(2) == []
    # the sine that both were made of
    assert cam([0.0, math.pi], 2) == pytest.approx([1.0, -1.0], abs=0.02)


def test_ends_can_be_told_and_a_step_of_the_velocity_is_refused_with_its_figure():
    line = segment('line', 360.0, 2.0, 'constant_velocity')
    cam = CamProfile([half(start_velocity=2.0 / math.pi, end_velocity=2.0 / math.pi,
                           start_acceleration=0.0, end_acceleration=0.0), line], True)
    assert cam.jumps(1) == cam.jumps(2) == []
    with pytest.raises(ConfigurationError) as caught:
        CamProfile([half(end_velocity=0.3), segment('back', 360.0, -2.0, 'cubic')])
    problem, = caught.value.problems
    assert 'steps by -0.3 per rad at 180 deg' in problem.rule


def test_stated_velocities_and_accelerations_are_those_of_the_curve():
    v = [math.sin(angle * DEGREE) for angle in ANGLES]
    a = [math.cos(angle * DEGREE) for angle in ANGLES]
    cam = CamProfile([half(velocities=v, accelerations=a),
                      segment('back', 360.0, -2.0, 'auto')])
    at = np.array(ANGLES[:-1]) * DEGREE
    assert cam(at, 1) == pytest.approx(v[:-1], abs=1e-9)
    assert cam(at, 2) == pytest.approx(a[:-1], abs=1e-9)
    assert cam.jumps(2) == []


@pytest.mark.parametrize('count', [20, 201])
@pytest.mark.parametrize('advance', [0.0, 3.0])
def test_a_cam_of_many_points_is_sampled_as_it_is_evaluated(advance, count):
    x = np.linspace(0.0, TURN, count)
    y = np.sin(x) + advance * x / TURN
    y[-1] = y[0] + advance
    cam = CamProfile([segment('curve', 360.0, y[-1] - y[0], 'spline', positions=y.tolist())],
                     bool(advance))
    for phi in (*x[:5], 0.7, 3.3, TURN, -2.0, 40.0):
        assert cam.sample(phi) == pytest.approx(
            [float(cam(phi, order)) for order in range(4)], rel=1e-12, abs=1e-9)
    assert cam.curve.sample(0.5) == pytest.approx(cam.sample(0.5))


def test_without_points_the_spline_is_the_quintic_between_its_neighbours():
    assert make_law('spline')(0.3) == pytest.approx(float(make_law('polynomial_345')(0.3)))


@pytest.mark.parametrize(('parameters', 'path', 'words'), [
    ({'positions': [1.0], 'angles_deg': [0.0]}, 'positions', 'at least 2'),
    ({'velocities': [0.0] * 3}, 'velocities', 'these are 3'),
    ({'angles_deg': [0, 20, 50, 50, 130, 160, 180]}, 'angles_deg', 'point 4 lies at 50'),
    ({'accelerations': [0.0] * 7}, 'accelerations', 'with velocities'),
    ({'degree': 4}, 'degree', '3 or 5'),
    ({'degree': 3, 'end_acceleration': 1.0}, 'end_acceleration', 'follows'),
    ({'velocities': [0.0] * 7, 'end_velocity': 1.0}, 'end_velocity', 'say what happens'),
    ({'angles_deg': [angle + 1.0 for angle in ANGLES]}, 'curve.angles_deg', 'starts at 1'),
    ({'positions': [2.0 * y for y in HALF]}, 'curve.lift', 'first to its last position: 4'),
])
def test_a_table_that_makes_no_segment_is_refused(parameters, path, words):
    with pytest.raises(ConfigurationError) as caught:
        CamProfile([half(**parameters), segment('back', 360.0, -2.0, 'cubic')])
    problem = caught.value.problems[0]
    assert problem.path == path and words in str(problem)


# Differences of exact curves.


@settings(max_examples=12)
@given(tables(most=9), tables(most=9))
def test_a_difference_is_that_of_the_values(first, second):
    one, other = interpolate(*first), interpolate(*second, 3)
    inner = GRID[1:-1:5]
    for order in (0, 1, 2):
        apart = one(inner, order) - other(inner, order)
        size = abs(one.peak(order).value) + abs(other.peak(order).value)
        assert difference(one, other)(inner, order) == pytest.approx(apart, abs=1e-9 * size)
        assert abs(largest(difference(one, other), order).value) >= (
            np.abs(apart).max() - 1e-9 * size)


def test_a_leading_coefficient_that_is_rounding_spoils_no_root():
    for leading in (1e-18, -1.4e-16, 3e-13, 2e-11):
        root, = Piece(3.0, (-0.0369, 0.0851, leading, 0.0)).zeros()
        assert root == pytest.approx(0.0369 / 0.0851, rel=1e-9)


def test_lines_between_points_miss_a_curve_by_its_bend():
    law = make_law('cycloidal')
    x = np.linspace(0.0, 1.0, 361)
    off = largest(difference(linear(x, law(x)), law.curve))
    assert abs(off.value) == pytest.approx(math.tau / (8.0 * 360.0**2), rel=1e-3)


def test_curves_over_different_ranges_have_no_difference():
    with pytest.raises(DomainError, match='different ranges'):
        difference(linear([0.0, 1.0], [0.0, 1.0]), linear([0.0, 2.0], [0.0, 1.0]))
