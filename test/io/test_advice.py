# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Advice on laws: what handbooks say is found, what breaks is refused, drives count."""

import json
import math
from pathlib import Path

from cam_motion.drive.cycle import cycle_figures
from cam_motion.errors import ConfigurationError
from cam_motion.io.advice import advise
from cam_motion.io.advice_data import advice_as_data
from cam_motion.io.advice_movement import movement
from cam_motion.io.advice_questions import questions
from cam_motion.io.axis import build_axis
from cam_motion.io.config import load_machine, read_sections
from cam_motion.io.filter_advice import advise_filters, filters_as_data
from cam_motion.io.plain import to_json
from cam_motion.motion.advice import BALANCED, Candidate, CRITERIA, merged, ranked, reason
from cam_motion.motion.laws import Boundary, LAWS, laws_between, make_law
from cam_motion.motion.shaping_effect import Load
from cam_motion.motion.spline import EndState
from cam_motion.motion.vibration import residual_spectrum
from cam_motion.units import DEGREE, RPM, TURN
import pytest

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config'
LIFT, SPAN_DEG, CPM = 0.3, 80.0, 100.0
DURATION = SPAN_DEG * DEGREE / (CPM * RPM)


def names(places):
    """List the laws of a ranking."""
    return [each.candidate.law.name for each in places]


@pytest.fixture(scope='module')
def question():
    """Give the movement of the feeding group, on its own."""
    return movement(LIFT, SPAN_DEG, CPM)


@pytest.fixture(scope='module')
def sections():
    """Give the feeding group with its drive."""
    return read_sections(CONFIG / 'feeding_group.yaml')


@pytest.mark.parametrize('by, first', [
    ('peak_acceleration', 'modified_trapezoid'), ('peak_velocity', 'modified_constant_velocity'),
    ('peak_jerk', 'cycloidal'), ('peak_power', 'modified_sine'),
    ('rms_acceleration', 'modified_sine'), (BALANCED, 'modified_sine'),
])
def test_smooth_laws_are_ranked_as_handbooks_do(question, by, first):
    assert names(advise(question, by).ranking)[0] == first


@pytest.mark.parametrize('by, first', [
    ('peak_acceleration', 'constant_acceleration'), ('rms_acceleration', 'cubic'),
    ('peak_power', 'cubic'), ('peak_jerk', 'cycloidal'),
])
def test_with_steps_of_acceleration_other_laws_come_first(question, by, first):
    advice = advise(question, by, allow_steps=True)
    assert names(advice.ranking)[0] == first and advice.stepping == ()
    endless = [math.isinf(each.candidate.figures['peak_jerk']) for each in advice.ranking]
    if by == 'peak_jerk':
        assert endless == sorted(endless)
    assert all(each.candidate.legal is not without for each, without in zip(
        advice.ranking, endless))


def test_the_ranking_rises_and_holds_every_law_once(question):
    for by in ('peak_velocity', 'peak_jerk', BALANCED):
        advice = advise(question, by)
        scores = [each.score for each in advice.ranking]
        assert scores == sorted(scores)
        listed = [name for place in (*advice.ranking, *advice.stepping)
                  for name in (place.candidate.law.name, *place.candidate.same_as)]
        refused = [each.law.name for each in advice.refused]
        assert sorted(listed + refused) == sorted(name for name in LAWS if name != 'dwell')


def test_what_is_ranked_is_what_is_legal_between_the_neighbours(question):
    advice = advise(question)
    ranked_names = {name for each in advice.ranking
                    for name in (each.candidate.law.name, *each.candidate.same_as)}
    assert ranked_names == set(laws_between(Boundary.REST, Boundary.REST))
    line = [each for each in advice.refused if each.law.name == 'constant_velocity']
    assert 'starts at constant velocity, its neighbour there is at rest' in line[0].refusal


def test_other_boundary_conditions_have_other_laws():
    ends = (Boundary.REST, Boundary.TURN)
    advice = advise(movement(LIFT, SPAN_DEG, CPM, ends))
    assert set(names(advice.ranking)) <= set(laws_between(*ends))
    assert {'polynomial_8', 'double_harmonic'} <= set(names(advice.ranking))
    assert 'cycloidal' in names(advice.stepping)  # at rest too, but its acceleration steps
    mean = EndState(LIFT / DURATION)
    moving = advise(movement(LIFT, SPAN_DEG, CPM, (
        Boundary.CONSTANT_VELOCITY, Boundary.CONSTANT_VELOCITY), start=mean, end=mean))
    assert 'constant_velocity' in names(moving.ranking)
    assert set(names(moving.ranking)) <= set(laws_between(*moving.question.ends))


def test_figures_are_the_coefficients_of_the_law(question):
    for each in advise(question).ranking:
        found, law = each.candidate.figures, each.candidate.law.coefficients
        time = DURATION
        assert found == pytest.approx({
            'peak_velocity': law.cv * LIFT / time, 'peak_acceleration': law.ca * LIFT / time ** 2,
            'peak_jerk': law.cj * LIFT / time ** 3,
            'peak_power': law.power * LIFT ** 2 / time ** 3,
            'rms_acceleration': law.rms_acceleration * LIFT / time ** 2}, rel=1e-9)


def test_the_balance_is_the_geometric_mean_over_the_best(question):
    places = advise(question).ranking
    best = {name: min(each.candidate.figures[name] for each in places)
            for name in places[0].candidate.figures}
    for each in places:
        product = math.prod(value / best[name] for name, value in each.candidate.figures.items())
        assert each.score == pytest.approx(product ** (1.0 / len(best)), rel=1e-12)


def test_vibration_is_that_of_the_spectrum_and_counts_in_the_balance():
    load = Load(3.0 / DURATION * TURN)  # three free periods: the cycloidal law leaves nothing
    advice = advise(movement(LIFT, SPAN_DEG, CPM, load=load), 'residual')
    assert names(advice.ranking)[0] == 'cycloidal'
    assert 'least' in advice.ranking[0].reason and 'vibration' in advice.ranking[0].reason
    for each in advice.ranking:
        assert each.candidate.figures['residual'] == pytest.approx(
            LIFT * float(residual_spectrum(each.candidate.law.curve, 3.0)), rel=1e-6, abs=1e-12)
    balanced = advise(movement(LIFT, SPAN_DEG, CPM, load=load)).ranking
    assert names(balanced) != names(advise(movement(LIFT, SPAN_DEG, CPM)).ranking)


def test_reasons_name_best_and_worst_in_per_cent():
    best = {'peak_velocity': 2.0, 'peak_acceleration': 4.0, 'peak_jerk': 10.0}
    assert reason(best, best, BALANCED) == 'least velocity, acceleration, jerk'
    assert reason({'peak_velocity': 2.2, 'peak_acceleration': 4.0, 'peak_jerk': 25.0}, best,
                  'peak_velocity') == 'velocity +10 %; least acceleration; worst: jerk +150 %'
    assert reason({'peak_velocity': 2.2, 'peak_acceleration': 5.0, 'peak_jerk': 30.0}, best,
                  BALANCED) == 'best: velocity +10 %; worst: jerk +200 %'
    assert reason({'peak_velocity': 1.0, 'peak_acceleration': 8.0, 'peak_jerk': math.inf}, best,
                  BALANCED) == 'velocity −50 %; worst: acceleration +100 %; infinite jerk'


def test_laws_with_one_curve_are_one_candidate():
    curves = [(name, make_law(name).curve) for name in (
        'scca', 'modified_trapezoid', 'auto', 'polynomial_345', 'polynomial_8',
        'polynomial_8_return')]
    found = merged([Candidate(make_law(name), {'peak_velocity': 1.0}, curve)
                    for name, curve in curves])
    assert {(each.law.name, each.same_as) for each in found} == {
        ('scca', ('modified_trapezoid',)), ('polynomial_345', ('auto',)),
        ('polynomial_8', ()), ('polynomial_8_return', ())}
    assert ranked([], BALANCED) == []


def test_torques_are_those_of_the_whole_cycle_with_the_law_in_its_place(sections):
    [feed] = questions(sections)
    machine = load_machine(CONFIG / 'feeding_group.yaml')
    advice = advise(feed, 'rms_torque', allow_steps=True)
    now = next(each.candidate for each in advice.ranking if each.candidate.configured)
    assert now.law.name == 'modified_trapezoid'
    figures = cycle_figures(machine.drives['feeder_drive'].drive,
                            machine.diagram.axes['feeder'].profile, machine.master.speed)
    assert now.figures['peak_torque'] == pytest.approx(figures.peak_torque, rel=1e-12)
    assert now.figures['rms_torque'] == pytest.approx(figures.rms_torque, rel=1e-12)
    assert now.figures['energy'] == pytest.approx(
        figures.motor_energy + figures.regenerated_energy, rel=1e-12)
    # the document's resistance is small beside the inertia: the cubic heats the motor least
    assert names(advice.ranking)[0] == 'cubic'
    assert names(advise(feed, 'rms_torque').ranking)[0] == 'modified_sine'
    assert names(advise(feed, 'peak_torque').ranking)[0] == 'modified_trapezoid'


def test_a_scaled_cam_costs_what_the_lifts_times_the_scale_cost(sections):
    scaled = {**sections, 'feeder': {**sections['feeder'], 'scale': 2.0}}
    double = {**sections, 'feeder': {**sections['feeder'], 'feed.lift': 0.6}}
    one, other = (advise(questions(each)[0]).ranking for each in (scaled, double))
    for first, second in zip(one, other):
        assert first.candidate.figures == pytest.approx(second.candidate.figures, rel=1e-9)
    assert questions(scaled)[0].lift == 0.6


def test_a_law_that_breaks_a_limit_is_refused_with_the_speed_that_it_keeps():
    sections = read_sections(CONFIG / 'cutting_machine.yaml')
    [feed] = questions(sections, ['feeder.feed'])
    assert (feed.start_deg, feed.end_deg, feed.lift) == (0.0, 80.0, 0.3)
    advice = advise(feed)
    refused = {each.law.name: each.refusal for each in advice.refused}
    # cycloidal: 2 pi · 0.3 / T², T = 80/360 · 0.3 s; the limit is 400 m/s²
    needed = 2.0 * math.pi * 0.3 / (0.3 * 80.0 / 360.0) ** 2
    cpm = math.floor(200.0 * math.sqrt(400.0 / needed) * 100.0) / 100.0
    assert refused['cycloidal'] == (
        f'needs {needed:.5g} m/s², the limit is 400: it runs up to {cpm:g} cycles/min')
    assert 'modified_trapezoid' in names(advice.ranking)
    jerky = {**sections, 'feeder': {**sections['feeder'], 'limits.jerk': 1e6}}
    refused = {each.law.name: each.refusal
               for each in advise(questions(jerky, ['feeder'])[0]).refused}
    assert refused['trapezoidal_velocity'] == (
        'its acceleration steps: no limit of the jerk can be kept')


def test_a_cam_that_breaks_its_limits_is_advised_upon_all_the_same():
    sections = read_sections(CONFIG / 'cutting_machine.yaml')
    fast = {**sections, 'master_shaft': {'speed_cpm': 230.0}}
    [feed] = questions(fast, ['feeder.feed'])
    advice = advise(feed)
    now = next(each for each in advice.refused if each.configured)
    assert now.law.name == 'modified_trapezoid' and 'm/s²' in now.refusal
    assert advice.ranking == ()


def test_neighbours_that_move_are_met_by_the_law_auto():
    sections = {'master_shaft': {'speed_cpm': 60.0}, 'knife': {
        'segments': ['down', 'follow', 'up', 'wait'],
        'down.law': 'auto', 'down.end_deg': 90.0, 'down.lift': 0.1,
        'follow.law': 'constant_velocity', 'follow.end_deg': 150.0, 'follow.lift': 0.05,
        'up.law': 'auto', 'up.end_deg': 300.0, 'up.lift': -0.15, 'wait.end_deg': 360.0}}
    asked = questions(sections)
    assert [each.name for each in asked] == ['knife.down', 'knife.follow', 'knife.up']
    assert asked[0].ends == (Boundary.REST, Boundary.CONSTANT_VELOCITY)
    advice = advise(asked[0])
    assert names(advice.ranking) == ['auto', 'modified_sine_vv']
    assert names(advice.stepping) == ['harmonic_combination_tv']  # a turn behind a dwell
    assert advice.ranking[0].candidate.same_as == ('polynomial',)
    told = advice.ranking[1].candidate.law.parameters
    assert (told['start_velocity'], told['end_velocity']) == pytest.approx(
        (0.0, 0.05 / 60.0 * 90.0 / 0.1), rel=1e-12)
    refused = {each.law.name: each.refusal for each in advice.refused}
    assert refused['acceleration_trapezoid_rv'] == (
        'ends at 2 lifts per span, its neighbour there has 0.75')
    assert refused['cycloidal'] == 'ends at rest, its neighbour there is at constant velocity'


def built_with(sections, candidate, axis, segment):
    """Put a candidate into the file as a user would, and build the axis."""
    values = {key: value for key, value in sections[axis].items()
              if not key.startswith(f'{segment}.') or key in (
                  f'{segment}.end_deg', f'{segment}.lift')}
    told = {f'{segment}.{key}': list(value) if isinstance(value, tuple) else value
            for key, value in candidate.law.parameters.items() if value is not None}
    return build_axis(axis, {**values, f'{segment}.law': candidate.law.name, **told})


@pytest.mark.parametrize('file, movement_name', [
    ('flying_shear.yaml', 'carriage.back'), ('flying_shear.yaml', 'carriage.brake'),
    ('flying_shear.yaml', 'carriage.accelerate'), ('rotary_knife.yaml', 'knife.ahead'),
])
def test_what_is_ranked_keeps_the_limits_of_the_whole_cam(file, movement_name):
    sections = read_sections(CONFIG / file)
    asked, = questions(sections, [movement_name])
    advice = advise(asked)
    assert len(advice.ranking) > 1
    for each in (*advice.ranking, *advice.stepping):
        axis = built_with(sections, each.candidate, *movement_name.split('.'))
        bound = axis.bound_by(axis.limits)
        assert bound is None or bound.omega >= asked.shaft_speed * (1.0 - 1e-9), each


def test_the_segments_that_a_law_reshapes_count_with_it():
    asked, = questions(read_sections(CONFIG / 'flying_shear.yaml'), ['carriage.back'])
    assert asked.names_beside == ('brake',)
    advice = advise(asked)
    refused = {each.law.name: each.refusal for each in advice.refused}
    # the fast return asks brake for more than the limit of the axis
    assert refused['acceleration_trapezoid_vr'] == (
        'needs 64.304 m/s² in brake, the limit is 40: it runs up to 47.32 cycles/min')
    assert advice_as_data(advice)['covers_too'] == ['brake']
    now = next(each.candidate for each in advice.ranking if each.candidate.configured)
    cam = asked.profile
    peaks = [cam.segment_peaks[place].acceleration.value for place in asked.covered]
    assert now.figures['peak_acceleration'] == pytest.approx(
        max(map(abs, peaks)) * asked.speed ** 2, rel=1e-12)


def test_a_movement_on_its_own_meets_the_velocities_it_is_told():
    start = EndState(0.4)
    asked = movement(0.1, 90.0, 60.0, (Boundary.CONSTANT_VELOCITY, Boundary.REST), start=start)
    advice = advise(asked)
    assert names(advice.ranking) == ['auto', 'modified_sine_vv']
    assert advice.ranking[0].candidate.same_as == ('polynomial',)
    for each in (*advice.ranking, *advice.stepping):
        curve = each.candidate.curve
        assert curve.end_values(1)[0] * asked.speed == pytest.approx(0.4, rel=1e-12)
        assert curve.end_values(1)[1] == pytest.approx(0.0, abs=1e-12)
    refused = {each.law.name: each.refusal for each in advice.refused}
    assert refused['acceleration_trapezoid_vr'] == (
        'starts at 2 lifts per span, its neighbour there has 1')
    moving = advise(movement(0.1, 90.0, 60.0, (Boundary.MOTION, Boundary.REST),
                             start=EndState(0.4, 1.0)))
    assert names(moving.ranking) == ['auto']
    curve = moving.ranking[0].candidate.curve
    assert curve.end_values(2)[0] * TURN ** 2 == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize('kind, state, paths', [
    (Boundary.CONSTANT_VELOCITY, (0.0, 0.0), ['velocity']),
    (Boundary.MOTION, (0.0, 0.0), ['velocity', 'acceleration']),
    (Boundary.MOTION, (0.4, 0.0), ['acceleration']),
    (Boundary.REST, (0.4, 1.0), ['velocity', 'acceleration']),
    (Boundary.TURN, (0.4, 1.0), ['velocity']),
])
def test_an_end_that_contradicts_its_kind_is_refused(kind, state, paths):
    with pytest.raises(ConfigurationError) as caught:
        movement(0.1, 90.0, 60.0, (Boundary.REST, kind), end=EndState(*state))
    assert [problem.path for problem in caught.value.problems] == [
        f'--end-{name}' for name in paths]


def test_standing_still_is_no_advice_for_a_table_that_comes_back():
    asked, = questions(read_sections(CONFIG / 'table_cam.yaml'), ['press'])
    advice = advise(asked)
    assert names(advice.ranking) == ['spline'] and advice.stepping == ()
    assert {each.refusal for each in advice.refused} >= {'would stand still: the lift is 0'}


def test_movements_are_found_by_name():
    sections = read_sections(CONFIG / 'cutting_machine.yaml')
    assert [each.name for each in questions(sections)] == [
        'feeder.feed', 'press.close', 'press.open', 'knife.cut', 'knife.back']
    assert [each.name for each in questions(sections, ['press', 'knife.cut'])] == [
        'press.close', 'press.open', 'knife.cut']
    with pytest.raises(ConfigurationError) as caught:
        questions(sections, ['press.hold', 'nobody'])
    assert [problem.path for problem in caught.value.problems] == ['press.hold', 'nobody']
    assert 'press.close' in caught.value.problems[0].hint
    still = {**sections, 'master_shaft': {'speed_cpm': 0.0}}
    with pytest.raises(ConfigurationError, match='no movement without a speed'):
        questions(still)


@pytest.mark.parametrize('by, way', [('peak_torque', 'a drive'), ('residual', '--frequency-hz')])
def test_a_criterion_of_which_nothing_is_known_is_refused(question, by, way):
    with pytest.raises(ConfigurationError) as caught:
        advise(question, by)
    assert caught.value.problems[0].path == '--by' and way in caught.value.problems[0].hint


def test_everything_fits_into_json(sections):
    [feed] = questions(sections, load=Load(12.0 * TURN, 0.01))
    data = advice_as_data(advise(feed, 'energy'))
    assert data['by'] == 'energy' and data['ranking'][0]['place'] == 1
    assert data['stepping'][0]['figures']['peak_jerk'] is None
    assert set(data['ranking'][0]['figures']) | {BALANCED} == set(CRITERIA)
    assert json.loads(to_json(data)) == data


def test_filters_are_compared_over_the_law(sections):
    [feed] = questions(sections, load=Load(12.0 * TURN, 0.01))
    found = {each.kind: each for each in advise_filters(feed, make_law('polynomial_4567'))}
    assert list(found) == ['none', 'zv', 'zvd', 'zvdd', 'ei', 'polydyne']
    none = found['none']
    for kind in ('zv', 'zvd', 'zvdd', 'polydyne'):
        assert found[kind].residual < 1e-10 < 0.01 < none.residual
    assert found['ei'].residual == pytest.approx(0.05 * none.residual, rel=1e-6)
    for error in (-0.1, 0.1):  # each less sensitive than the one before
        left = [found[kind].residuals[error] for kind in ('none', 'zv', 'zvd', 'zvdd')]
        assert left == sorted(left, reverse=True)
    assert found['zvd'].delay == pytest.approx(2.0 * found['zv'].delay)
    [over] = [each['over_speed'] for each in filters_as_data(feed, [found['zv']])]
    least = min(range(41), key=lambda n: over['residual'][n])
    assert over['speed_cpm'][least] == pytest.approx(100.0) and len(over['residual']) == 41
    refused = advise_filters(feed, make_law('cycloidal'))[-1]
    assert refused.kind == 'polydyne' and 'the jerk of the cam steps' in refused.refusal
    assert filters_as_data(feed, [refused]) == [{'kind': 'polydyne', 'reason': refused.refusal}]
    assert advise_filters(movement(LIFT, SPAN_DEG, CPM), make_law('cubic')) == []


def test_an_axis_that_is_shaped_is_advised_upon_as_it_is_shaped():
    sections = read_sections(CONFIG / 'cup_shuttle.yaml')
    carry = questions(sections, ['shuttle.carry'])[0]
    advice = advise(carry)
    assert all(each.candidate.figures['residual'] < 1e-10 for each in advice.ranking)
    now = next(each.candidate for each in advice.ranking if each.candidate.configured)
    assert now.figures['peak_acceleration'] == pytest.approx(
        abs(carry.profile.parts[carry.index].peak(2).value) * carry.speed ** 2, rel=1e-12)
