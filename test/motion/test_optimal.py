# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The optimiser against optima that are known in closed form, and against itself."""

from functools import cache
import math
from math import pi, sqrt

from cam_motion.errors import ConfigurationError
from cam_motion.motion.laws import LAWS, make_law
from cam_motion.motion.least_squares import least_squares
from cam_motion.motion.optimal import Demands, End, figures, Load, weighed
from cam_motion.motion.optimal_spline import best_spline
from cam_motion.motion.optimal_stages import best_member, FAMILIES, stage_figures
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest
from scipy.optimize import brentq, nnls

pytestmark = pytest.mark.timeout(60)

PROGRAMME = 1e-6  # limits are drawn in by 2e-7
SEARCHED = 1e-6  # of the search over stage lengths
FLAT = 1e-4  # of the lengths themselves: an optimum is flat
INTEGRATED = 1e-4  # quadrature over a kink
XI = np.linspace(0.0, 1.0, 301)
C1, C2 = Demands(continuity=1), Demands(continuity=2)
LOAD = Load(own=1.0, driven=2.0, against=6.0, efficiency=0.8)
STAGES = 'modified_trapezoid'


def spline(goal, demands=C2, **more):
    """Find the best spline by one figure."""
    return best_spline({goal: 1.0}, demands, **more)


def member(goal, demands=C2, family=STAGES, **more):
    """Find the best member of a family by one figure."""
    return best_member(family, {goal: 1.0}, demands, **more)


@pytest.mark.parametrize(('goal', 'known', 'least'), [
    ('rms_acceleration', 'cubic', sqrt(12.0)),  # the least copper losses
    ('peak_acceleration', 'constant_acceleration', 4.0),
    ('rms_jerk', 'polynomial_345', sqrt(720.0)),
    ('rms_snap', 'polynomial_4567', sqrt(100800.0)),
])
def test_the_spline_finds_the_laws_that_are_known_as_the_best(goal, known, least):
    law = spline(goal, C1)
    assert figures(law.curve, C1)[goal] == pytest.approx(least, rel=PROGRAMME)
    assert law(XI) == pytest.approx(make_law(known)(XI), abs=PROGRAMME)


def test_the_least_peak_jerk_is_32_in_three_cubic_pieces():
    law = spline('peak_jerk')
    xi = (np.arange(96) + 0.5) / 96
    expected = np.where((xi < 0.25) | (xi > 0.75), 32.0, -32.0)
    assert law(xi, 3) == pytest.approx(expected, abs=32.0 * PROGRAMME)
    assert law.coefficients.cv == pytest.approx(2.0, rel=PROGRAMME)
    assert law.coefficients.ca == pytest.approx(8.0, rel=PROGRAMME)
    assert law.coefficients.cj == pytest.approx(32.0, rel=PROGRAMME)


@pytest.mark.parametrize('ramp', [1 / 3, 1 / 4, 1 / 6, 1 / 8])
def test_with_a_bounded_velocity_the_least_peak_acceleration_is_the_trapezoid(ramp):
    speed = 1.0 / (1.0 - ramp)
    law = spline('peak_acceleration', Demands(velocity=speed, continuity=1))
    trapezoid = make_law('trapezoidal_velocity', ramp_up=ramp)
    assert law(XI) == pytest.approx(trapezoid(XI), abs=PROGRAMME)
    back = spline('peak_velocity', Demands(acceleration=trapezoid.coefficients.ca, continuity=1))
    assert back.coefficients.cv == pytest.approx(speed, rel=PROGRAMME)
    found = member('peak_velocity', Demands(acceleration=trapezoid.coefficients.ca, continuity=1))
    assert found.coefficients.cv == pytest.approx(speed, rel=SEARCHED)
    assert found.parameters['fractions'] == pytest.approx(
        (0, ramp, 0, 1 - 2 * ramp, 0, ramp, 0), abs=FLAT)


def test_the_trapezoid_of_least_rms_acceleration_has_thirds():
    law = member('rms_acceleration', C1, 'trapezoidal_velocity')
    assert law.coefficients.rms_acceleration == pytest.approx(1.5 * sqrt(6.0), rel=SEARCHED)
    assert law.parameters['ramp_up'] == pytest.approx(1 / 3, abs=FLAT)
    assert law.parameters['ramp_down'] == pytest.approx(1 / 3, abs=FLAT)


def test_of_the_seven_stages_parabola_and_cycloid_have_the_least_peaks():
    parabola = member('peak_acceleration', C1)
    assert parabola.parameters['fractions'] == pytest.approx((0, .5, 0, 0, 0, .5, 0), abs=FLAT)
    assert parabola.coefficients.ca == pytest.approx(4.0, rel=SEARCHED)
    cycloid = member('peak_jerk')
    assert cycloid.coefficients.cj == pytest.approx(4.0 * pi ** 2, rel=SEARCHED)
    assert cycloid(XI) == pytest.approx(make_law('cycloidal')(XI), abs=FLAT)


def test_the_spline_is_never_worse_than_the_family_it_contains_the_limit_of():
    for goal, demands in (('rms_acceleration', Demands(jerk=60.0)), ('rms_jerk', C2),
                          ('peak_acceleration', Demands(jerk=60.0, velocity=1.9))):
        best = figures(spline(goal, demands).curve, demands)[goal]
        searched = figures(member(goal, demands).curve, demands)[goal]
        assert best < searched


@cache
def catalogue():
    """Give the figures of every law between two dwells."""
    return {name: figures(make_law(name).curve, C2) for name, kind in LAWS.items()
            if name != 'dwell' and not kind.any_ends}


bounds = st.tuples(st.integers(115, 220), st.integers(45, 120), st.integers(40, 200))


@settings(max_examples=6, deadline=None)
@given(bounds, st.sampled_from(['rms_acceleration', 'peak_acceleration', 'peak_velocity',
                                'peak_jerk', 'rms_jerk']))
def test_limits_are_kept_everywhere_and_no_catalogue_law_within_them_is_better(levels, goal):
    demands = Demands(levels[0] / 100.0, levels[1] / 10.0, float(levels[2]))
    try:
        law = spline(goal, demands, degree=4)
    except ConfigurationError:
        law = None
    kept = {name: found[goal] for name, found in catalogue().items()
            if found['peak_velocity'] <= demands.velocity
            and found['peak_acceleration'] <= demands.acceleration
            and found['peak_jerk'] <= demands.jerk}
    if law is None:
        assert not kept
        return
    found = figures(law.curve, demands)
    for name, limit in (('peak_velocity', demands.velocity), ('peak_jerk', demands.jerk),
                        ('peak_acceleration', demands.acceleration)):
        assert found[name] <= limit
    # its 24 intervals cost little against a law whose joints they cannot meet
    assert all(found[goal] <= 1.03 * other for other in kept.values())


def test_a_limit_holds_between_the_knots_too_where_the_derivative_is_curved():
    law = spline('rms_jerk', Demands(velocity=1.6, acceleration=6.2), degree=6)
    assert law.coefficients.cv <= 1.6
    assert law.coefficients.cv == pytest.approx(1.6, rel=1e-6)


@pytest.mark.parametrize('continuity', [1, 2, 3])
def test_ends_are_exactly_as_smooth_as_asked(continuity):
    curve = spline('rms_acceleration', Demands(continuity=continuity)).curve
    for order in range(1, 4):
        start, end = curve.end_values(order)
        if order <= continuity:
            assert start == 0.0
            assert end == pytest.approx(0.0, abs=1e-11 * abs(curve.peak(order).value))
        else:
            assert abs(start) > 1.0


def test_neighbours_that_move_are_met():
    start, end = End(0.5, 1.0, -2.0), End(1.2, -0.7, 3.0)
    demands = Demands(continuity=3, start=start, end=end)
    curve = spline('rms_snap', demands).curve
    for order in (1, 2, 3):
        assert curve.end_values(order) == pytest.approx(
            (start[order - 1], end[order - 1]), abs=1e-9)
    # without limits it is the one polynomial of degree 7 with these ends
    assert curve.differentiated(7).extremes(0)[0].value == pytest.approx(
        curve.differentiated(7).extremes(0)[1].value, rel=1e-4)
    assert math.isfinite(figures(curve, demands)['rms_snap'])
    assert figures(curve, C2)['rms_acceleration'] == math.inf


def test_what_a_peak_leaves_free_is_the_calmest():
    # the neighbour's acceleration is the peak already, and many curves have no larger one
    start = End(0.5, 6.0)
    curve = spline('peak_acceleration', Demands(start=start)).curve
    assert abs(curve.peak(2).value) == pytest.approx(6.0, rel=PROGRAMME)
    rival = spline('rms_jerk', Demands(acceleration=6.00001, start=start), degree=3).curve
    assert curve.rms(3) == pytest.approx(rival.rms(3), rel=1e-4)


def test_a_weighted_sum_is_on_the_front_between_its_parts():
    weights = {'rms_acceleration': 1.0, 'peak_jerk': 0.5}
    law = best_spline(weights, C2)
    found = figures(law.curve, C2)
    best = weighed(weights, found, None)
    for share in (0.97, 1.0, 1.03):
        rival = spline('rms_acceleration', Demands(jerk=share * found['peak_jerk']), degree=3)
        value = weighed(weights, figures(rival.curve, C2), None)
        assert value >= best * (1.0 - PROGRAMME)
        if share == 1.0:
            assert value == pytest.approx(best, rel=PROGRAMME)
    searched = best_member('scca', weights, C2)
    assert weighed(weights, figures(searched.curve, C2), None) > best


def test_sums_of_peaks_are_linear_programmes():
    weights = {'peak_velocity': 1.0, 'peak_acceleration': 1.0}
    law = best_spline(weights, C1)
    # of all trapezoids the sum Cv / 1.875 + Ca sqrt(3)/10 is least at one ramp, found on a grid
    ramps = np.arange(1, 13) / 24
    sums = 1 / (1 - ramps) / 1.875 + 1 / (ramps * (1 - ramps)) * sqrt(3.0) / 10
    assert weighed(weights, figures(law.curve, C1), None) == pytest.approx(sums.min(), rel=1e-7)


def test_without_losses_the_rms_torque_is_least_with_the_rms_acceleration():
    ideal = Load(1.0, 2.0, 6.0)
    law = spline('rms_torque', C1, load=ideal)
    assert law(XI) == pytest.approx(make_law('cubic')(XI), abs=1e-9)
    found = figures(law.curve, C1, ideal)
    assert found['rms_torque'] == pytest.approx(sqrt(9.0 * 12.0 + 36.0), rel=1e-9)
    assert found['peak_torque'] == pytest.approx(18.0 + 6.0, rel=1e-9)


def test_the_least_peak_torque_shares_it_between_driving_and_braking():
    law = spline('peak_torque', C1, load=LOAD, intervals=60)
    bend = (np.arange(60) + 0.5) / 60
    torques = LOAD.torque(law(bend, 2))
    peak = figures(law.curve, C1, LOAD)['peak_torque']
    # bang-bang: at the peak all the time but for where it changes over between the knots
    assert np.sum(np.abs(np.abs(torques) - peak) > 1e-6) <= 2
    # constant acceleration with unequal halves, A x = B (1 - x) = 2, and equal torques
    ramp = brentq(lambda x: LOAD.torque(2.0 / x) + LOAD.torque(-2.0 / (1.0 - x)), 0.1, 0.9)
    least = float(LOAD.torque(2.0 / ramp))
    assert peak == pytest.approx(least, rel=1e-3)
    searched = member('peak_torque', C1, load=LOAD)
    assert figures(searched.curve, C1, LOAD)['peak_torque'] == pytest.approx(
        least, rel=SEARCHED)


def test_with_losses_the_rms_torque_is_below_that_of_every_rival():
    law = spline('rms_torque', C1, load=LOAD)
    best = figures(law.curve, C1, LOAD)['rms_torque']
    for rival in (make_law('cubic'), member('rms_torque', C1, load=LOAD),
                  *(make_law('trapezoidal_velocity', ramp_up=r / 10) for r in range(2, 6))):
        assert figures(rival.curve, C1, LOAD)['rms_torque'] > best
    # a small change in any coefficient makes it worse
    coefficients = np.array(law.parameters['coefficients'])
    for place in range(2, len(coefficients) - 2):
        for shift in (-1e-3, 1e-3):
            moved = coefficients.copy()
            moved[place] += shift
            other = make_law('b_spline', coefficients=moved.tolist(), degree=3)
            assert figures(other.curve, C1, LOAD)['rms_torque'] > best


stage_lists = st.lists(st.integers(1, 30), min_size=7, max_size=7)


@settings(max_examples=12, deadline=None)
@given(stage_lists)
def test_the_closed_forms_of_the_stages_are_those_of_the_exact_curve(parts):
    stages = np.array(parts) / sum(parts)
    law = make_law(STAGES, fractions=stages.tolist())
    exact, closed = figures(law.curve, C2, LOAD), stage_figures(stages[:, None], LOAD)
    for name, values in closed.items():
        if name in exact:
            slack = INTEGRATED if name == 'rms_torque' else 1e-11
            assert values[0] == pytest.approx(exact[name], rel=slack)


@pytest.mark.parametrize('family', FAMILIES)
def test_each_family_makes_the_law_whose_stages_were_searched(family):
    kind = FAMILIES[family]
    values = np.array([0.3 + 0.07 * n for n in range(len(kind.bounds))])
    law = make_law(family, **kind.parameters(values))
    closed = stage_figures(kind.stages(values[:, None]))
    assert law.coefficients.cv == pytest.approx(closed['peak_velocity'][0], rel=1e-11)
    assert abs(law.curve.peak(2).value) == pytest.approx(
        closed['peak_acceleration'][0], rel=1e-11)
    assert law.curve.rms(2) == pytest.approx(closed['rms_acceleration'][0], rel=1e-11)


def test_the_same_question_has_the_same_answer():
    first, second = (member('rms_jerk', family='scca') for _ in range(2))
    assert first.parameters == second.parameters


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 6), st.integers(0, 12), st.randoms(use_true_random=False))
def test_least_squares_within_bounds_meets_the_conditions_of_a_minimum(size, count, random):
    rng = np.random.default_rng(random.randrange(10 ** 6))
    matrix, side = rng.normal(size=(size + 3, size)), rng.normal(size=size + 3)
    bounds, inside = rng.normal(size=(count, size)), rng.normal(size=size)
    levels = bounds @ inside - rng.random(count)
    x = least_squares(matrix, side, bounds, levels)
    left = bounds @ x - levels
    assert np.all(left >= -1e-9)
    # the slope is a combination of the active bounds with factors that are not negative
    slope = matrix.T @ (matrix @ x - side)
    active = bounds[left < 1e-8]
    if len(active):
        assert nnls(active.T, slope)[1] == pytest.approx(0.0, abs=1e-7)
    else:
        assert slope == pytest.approx(np.zeros(size), abs=1e-9)


def test_progress_is_told_to_its_end():
    heard = []
    best_spline({'rms_acceleration': 1.0}, C2, tell=lambda *now: heard.append(now))
    best_member('trapezoidal_velocity', {'rms_acceleration': 1.0}, C1,
                tell=lambda *now: heard.append(now))
    assert heard[0][0] == 0 and heard[-1][0] == heard[-1][1]


def refused(find, *arguments, **more):
    """Give the paths of what is refused."""
    with pytest.raises(ConfigurationError) as caught:
        find(*arguments, **more)
    assert all(problem.rule for problem in caught.value.problems)
    return [problem.path for problem in caught.value.problems]


def test_what_no_law_can_do_is_refused():
    one = {'rms_acceleration': 1.0}
    assert refused(best_spline, one, Demands(velocity=0.9)) == ['limits']
    assert refused(best_spline, {'peak_jerk': 1.0}, Demands(acceleration=3.9)) == ['limits']
    assert refused(best_member, STAGES, one, Demands(jerk=39.0)) == ['limits']
    assert refused(best_member, STAGES, one, Demands(velocity=1.0)) == ['limits']


def test_what_makes_no_sense_is_refused():
    one = {'rms_acceleration': 1.0}
    assert refused(best_spline, {'beauty': 1.0, 'rms_torque': 1.0}, C2) == ['minimise'] * 2
    assert refused(best_spline, {}, C2) == ['minimise']
    assert refused(best_spline, {'rms_jerk': -1.0}, C2) == ['minimise.rms_jerk']
    assert refused(best_spline, one, Demands(velocity=-1.0, jerk=math.nan, continuity=4)) == [
        'max_velocity', 'max_jerk', 'continuity']
    assert refused(best_spline, one, C2, degree=2) == ['degree']
    assert refused(best_spline, one, C2, intervals=1) == ['intervals']
    assert refused(best_spline, one, C2, intervals=999) == ['intervals']
    assert refused(best_member, 'cubic', one, C2) == ['law']
    assert refused(best_member, 'trapezoidal_velocity', one, C2) == ['law']
    assert refused(best_member, STAGES, {'rms_snap': 1.0}, C2) == ['law']
    assert refused(best_member, STAGES, one, Demands(start=End(1.0))) == ['law']
    assert refused(best_member, STAGES, one, C2, shortest=0.3) == ['shortest']
    assert refused(Load, 0.0, 0.0) == ['inertia']


def test_figures_are_infinite_above_what_steps():
    found = figures(make_law('constant_acceleration').curve, C2)
    assert found['peak_acceleration'] == 4.0
    assert found['peak_jerk'] == found['rms_jerk'] == found['rms_snap'] == math.inf
    line = figures(make_law('constant_velocity').curve, C2, LOAD)
    assert line['peak_velocity'] == 1.0 and line['peak_torque'] == math.inf
    moving = Demands(start=End(1.0), end=End(1.0))
    assert figures(make_law('constant_velocity').curve, moving, LOAD)['peak_torque'] == 7.5
