# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The compile check: the class of each joint, the size of its step, and what is only rounding."""

import math

from cam_motion.errors import ConfigurationError
from cam_motion.motion.continuity import (
    continuity_of,
    curve_joints,
    HIGHEST_ORDER,
    program_continuity,
)
from cam_motion.motion.laws import Boundary, LAWS, laws_between, make_law
from cam_motion.motion.profile import CamProfile, VelocityStepError
from cam_motion.motion.segment import segment
from cam_motion.units import DEGREE, TURN
from hypothesis import given, settings
from hypothesis import strategies as st
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-12

SPAN = 60.0 * DEGREE
LIFT = 0.3

# Order of the first derivative that steps between a dwell and the law, and its size for lift 1
# over span 1 (Ca, Cj, ... of the catalogue at the start of the law).
STEPS = {
    'constant_velocity': (1, 1.0), 'constant_acceleration': (2, 4.0), 'cubic': (2, 6.0),
    'simple_harmonic': (2, math.pi ** 2 / 2.0), 'trapezoidal_velocity': (2, 4.5),
    'cycloidal': (3, 4.0 * math.pi ** 2), 'polynomial_345': (3, 60.0),
    'modified_trapezoid': (3, 32.0 * math.pi ** 2 / (2.0 + math.pi)),
    'modified_sine': (3, 16.0 * math.pi ** 3 / (4.0 + math.pi)),
    'gutman_13': (3, 6.0 * math.pi ** 2),
    'polynomial_4567': (4, 840.0), 'polynomial_5_to_9': (5, 126.0 * 120.0),
    'polynomial_6_to_11': (6, 462.0 * 720.0), 'b_spline': (3, 60.0), 'auto': (3, 60.0),
}


def rise_and_return(law, lift=LIFT, **parameters):
    """Give a program of dwell, rise, dwell, return."""
    return [segment('low', 90.0), segment('up', 150.0, lift, law, **parameters),
            segment('high', 240.0), segment('down', 360.0, -lift, law, **parameters)]


@pytest.mark.parametrize('law', STEPS)
def test_the_class_between_dwells_and_the_size_of_the_step_are_those_of_the_law(law):
    order, size = STEPS[law]
    found = program_continuity(rise_and_return(law))
    joint = found.joints[1].joint
    assert (joint.order, joint.continuity, joint.label) == (order, order - 1, f'C{order - 1}')
    assert joint.at == pytest.approx(90.0 * DEGREE, rel=ROUNDING)
    assert joint.step == pytest.approx(size * LIFT / SPAN ** order, rel=1e-10)
    assert found.joints[3].joint.step == pytest.approx(
        -size * LIFT / (2.0 * SPAN) ** order, rel=1e-10)
    assert found.label == f'C{order - 1}'


@pytest.mark.parametrize('omega', [0.0, 3.0, -7.0])
def test_at_a_speed_the_step_grows_with_its_power(omega):
    joint = program_continuity(rise_and_return('polynomial_345')).joints[1].joint
    assert joint.step_at(omega) == pytest.approx(joint.step * omega ** 3, rel=ROUNDING)


def test_nothing_steps_where_two_dwells_or_two_turns_of_a_belt_meet():
    dwells = program_continuity([segment('a', 90.0), segment('b', 180.0),
                                 segment('c', 270.0, 1.0, 'cubic'),
                                 segment('d', 360.0, -1.0, 'cubic')])
    assert dwells.joints[1].joint.order is None
    assert dwells.joints[1].joint.label == f'C{HIGHEST_ORDER}+'
    assert dwells.joints[1].joint.step_at(10.0) == 0.0
    belt = continuity_of(CamProfile(
        [segment('run', 360.0, 0.4, 'constant_velocity')], accumulate=True))
    assert belt.weakest.order is None


def test_the_end_of_the_cycle_is_the_joint_at_0_with_the_last_segment_before_it():
    found = program_continuity([segment('up', 180.0, 1.0, 'cubic'),
                                segment('down', 360.0, -1.0, 'polynomial_345')])
    seam = found.joints[0]
    assert (seam.before.name, seam.after.name, seam.joint.at) == ('down', 'up', 0.0)
    assert seam.joint.order == 2
    assert seam.joint.step == pytest.approx(6.0 / (180.0 * DEGREE) ** 2, rel=ROUNDING)


def test_joints_inside_a_law_count_for_the_cam():
    found = continuity_of(CamProfile(rise_and_return('constant_acceleration')))
    inside = found.joints[1].inside
    assert inside.label == 'C1'
    assert inside.at == pytest.approx(120.0 * DEGREE, rel=ROUNDING)
    assert inside.step == pytest.approx(-8.0 * LIFT / SPAN ** 2, rel=ROUNDING)
    # the modified trapezoid: sine into plateau, where the jerk fades to zero and the snap steps
    assert continuity_of(CamProfile(rise_and_return('modified_trapezoid'))).joints[1].inside \
        .label == 'C3'
    assert found.joints[0].inside is None


def test_a_cam_whose_velocity_steps_is_refused_with_its_segments_for_the_table():
    with pytest.raises(VelocityStepError) as caught:
        CamProfile(rise_and_return('constant_velocity'))
    assert isinstance(caught.value, ConfigurationError)
    found = program_continuity(caught.value.segments)
    assert found.label == 'C0'
    assert [each.joint.label for each in found.joints] == ['C0'] * 4
    assert found.joints[1].joint.step == pytest.approx(LIFT / SPAN, rel=ROUNDING)


laws_at_rest = st.sampled_from([name for name in LAWS if name not in {'dwell', 'spline'} and [
    end.value for end in make_law(name).ends] == ['rest', 'rest']])


@settings(max_examples=30, deadline=None)
@given(laws_at_rest, st.integers(-12, 12), st.integers(1, 1000), st.integers(1, 1000))
def test_the_class_does_not_depend_on_lift_or_angle(law, power, start, span):
    def labels(joint):
        return [each.label for each in (joint.joint, joint.inside) if each is not None]
    plain = program_continuity(rise_and_return(law))
    lift, start, span = 0.37 * 10.0 ** power, start / 10.0, span / 10.0
    moved = program_continuity([
        segment('low', start), segment('up', start + span, lift, law),
        segment('high', 270.0), segment('down', 360.0, -lift, law)])
    assert [labels(joint) for joint in moved.joints] == [labels(joint) for joint in plain.joints]


angles = st.lists(st.integers(1, 359), min_size=3, max_size=6, unique=True).map(sorted)


@settings(max_examples=20, deadline=None)
@given(angles, st.randoms(use_true_random=False))
def test_programs_of_auto_segments_are_c2_everywhere(ends, random):
    lifts = [random.uniform(-1.0, 1.0) for _ in ends]
    program = [segment(f's{n}', float(end), lift, 'auto')
               for n, (end, lift) in enumerate(zip(ends, lifts))]
    program.append(segment('last', 360.0, -math.fsum(lifts), 'auto'))
    # of the smoothest curve not even jerk and snap step
    assert continuity_of(CamProfile(program)).weakest.continuity >= 4


resting = st.sampled_from(laws_between(Boundary.REST, Boundary.REST))
general = st.sampled_from(['polynomial', 'flexible_polynomial', 'spline', 'auto'])
states = st.tuples(st.sampled_from([0.0, 0.0, 0.4, -0.7, 1.3]), st.sampled_from([0.0, 0.0, 2.0]))


@st.composite
def legal_programs(draw):
    """Draw what happens at each joint, and laws between that are legal there."""
    ends = [*draw(angles), 360]
    told = draw(st.lists(states, min_size=len(ends), max_size=len(ends)))
    lifts = draw(st.lists(st.sampled_from([-0.8, 0.3, 1.0]), min_size=len(ends),
                          max_size=len(ends)))
    program, laws = [], []
    for n, (start, end, lift) in enumerate(zip([0, *ends], ends, lifts)):
        (v0, a0), (v1, a1) = told[n], told[(n + 1) % len(ends)]
        span = (end - start) * DEGREE
        turned = {'start_velocity': v0, 'end_velocity': v1}
        scaled = {key: v * span / lift for key, v in turned.items()}
        bends = {key: a * span**2 / lift for key, a in (
            ('start_acceleration', a0), ('end_acceleration', a1))}
        own = {
            'polynomial': scaled | bends, 'modified_sine_vv': scaled,
            'flexible_polynomial': {
                'velocities': [0.0, scaled['start_velocity'], 1.0, scaled['end_velocity']],
                'accelerations': [
                    0.0, bends['start_acceleration'], 1.0, bends['end_acceleration']]},
            'spline': turned | {'start_acceleration': a0, 'end_acceleration': a1}}
        if (v0, a0, v1, a1) == (0.0,) * 4:
            law = draw(resting)
        elif a0 == a1 == 0.0 and draw(st.booleans()):
            law = 'modified_sine_vv'
        else:
            law = draw(general)
        if law == 'auto' and laws[-1:] == ['auto'] or law == 'auto' and n in (0, len(ends) - 1):
            law = 'polynomial'  # of two in a row nobody would tell their joint
        laws.append(law)
        program.append(segment(f's{n}', float(end), lift, law, **own.get(law, {})))
    return program


@settings(max_examples=60, deadline=None)
@given(legal_programs())
def test_legal_programs_between_any_states_are_c2_everywhere(program):
    cam = CamProfile(program, accumulate=True)
    assert continuity_of(cam).weakest.continuity >= 2
    assert cam.jumps(0) == cam.jumps(1) == cam.jumps(2) == []


@settings(max_examples=15, deadline=None)
@given(st.integers(3, 7), st.integers(2, 30), st.randoms(use_true_random=False))
def test_a_b_spline_is_as_smooth_inside_as_its_degree_says(degree, intervals, random):
    inner = [random.uniform(0.0, 1.0) for _ in range(intervals + degree - 2)]
    curve = make_law('b_spline', coefficients=[0.0, *inner, 1.0], degree=degree).curve
    assert {joint.continuity for joint in curve_joints(curve)} == {min(degree, 7) - 1}


@pytest.mark.parametrize(('miss', 'label'), [(1e-6, 'C0'), (1e-8, 'C0'), (1e-11, 'C2')])
def test_what_is_rounding_is_told_from_a_step(miss, label):
    ends = {'start_velocity': 0.0, 'end_velocity': 2.0 * (1.0 + miss)}
    found = program_continuity([
        segment('up', 72.0, 0.12, 'polynomial', **ends),
        segment('run', 144.0, 0.24, 'constant_velocity'), segment('back', 360.0, -0.36, 'auto')])
    assert found.joints[1].joint.label == label


@pytest.mark.parametrize('count', [25, 361, 2001])
def test_the_rounding_of_a_table_of_many_points_is_no_step(count):
    points = [1.0 - math.cos(TURN * n / (count - 1)) for n in range(count)]
    found = continuity_of(CamProfile([
        segment('all', 360.0, 0.0, 'spline', positions=[*points[:-1], points[0]])]))
    assert found.weakest.continuity >= 4  # a quintic spline


def test_a_steep_segment_elsewhere_hides_no_step():
    # a jerk 10^12 times as large as that of the gentle rise
    found = program_continuity([
        segment('low', 100.0), segment('gentle', 200.0, 1e-3, 'polynomial_345'),
        segment('high', 300.0), segment('steep', 300.01, -1e-3, 'polynomial_345'),
        segment('rest', 360.0)])
    assert [each.joint.label for each in found.joints[1:]] == ['C2'] * 4


def test_a_step_of_the_position_is_class_minus_1():
    # two laws never leave a gap, but a curve from elsewhere may
    from cam_motion.motion.piece import Piece
    from cam_motion.motion.piecewise import Piecewise
    joint, = curve_joints(Piecewise(0.0, [Piece(1.0, (0.0, 1.0)), Piece(1.0, (1.5, 1.0))]))
    assert (joint.order, joint.label, joint.step) == (0, 'C-1', 0.5)


def test_the_weakest_joint_is_the_first_of_the_lowest_class():
    found = program_continuity([
        segment('a', 100.0, 1.0, 'polynomial_345'), segment('b', 200.0, 1.0, 'cubic'),
        segment('c', 360.0, -2.0, 'cubic')])
    assert found.weakest.order == 2
    assert found.weakest.at == 0.0  # where the last cubic ends
    assert found.weakest.at < TURN
