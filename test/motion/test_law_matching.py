# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Segments with the law ``auto``: what they join, and that nothing else is smoother."""

import math

from cam_motion.errors import ConfigurationError
from cam_motion.motion.laws import Boundary, laws_between
from cam_motion.motion.matching import matched
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from cam_motion.units import DEGREE, TURN
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(40)

ROUNDING = 1e-11
LINE = 0.2 / (50.0 * DEGREE)  # velocity of the line below, per rad


def between(*, end_velocity=None, up='auto'):
    """Give a dwell, a segment, a line and a segment that leads back."""
    stated = {} if end_velocity is None else {'end_velocity': end_velocity}
    return [segment('wait', 60.0), segment('up', 150.0, 0.1, up, **stated),
            segment('run', 200.0, 0.2, 'constant_velocity'), segment('back', 360.0, -0.3, 'auto')]


def jerk_squared(cam):
    """Integrate the jerk squared over one turn."""
    return cam.curve.rms(3) ** 2 * TURN


def test_auto_joins_rest_and_constant_velocity():
    cam = CamProfile(between())
    for order in range(3):
        assert cam.jumps(order) == []
    y, slope, bend, _ = cam.sample(150.0 * DEGREE - 1e-9)
    assert (y, slope) == pytest.approx((0.1, LINE), rel=1e-8)
    assert bend == pytest.approx(0.0, abs=1e-8)
    assert [s.name for s in cam.segments] == ['wait', 'up', 'run', 'back']


def test_auto_between_two_dwells_is_the_polynomial_345():
    angles = np.linspace(0.0, TURN, 97)
    cams = [CamProfile([segment('a', 100.0, 0.3, law), segment('b', 200.0),
                        segment('c', 300.0, -0.3, law), segment('d', 360.0)])
            for law in ('auto', 'polynomial_345')]
    assert cams[0](angles) == pytest.approx(cams[1](angles), abs=ROUNDING)


def test_auto_takes_over_an_acceleration_too():
    cam = CamProfile([segment('a', 100.0, 0.3, 'double_harmonic'),
                      segment('b', 360.0, -0.3, 'auto')])
    assert cam.jumps(2) == []
    bend = -0.3 * math.pi**2 / (100.0 * DEGREE) ** 2
    assert cam.sample(100.0 * DEGREE)[2] == pytest.approx(bend, rel=1e-9)


def test_auto_without_a_lift_turns_round_between_two_lines():
    cam = CamProfile([
        segment('there', 100.0, 0.1, 'constant_velocity'), segment('far', 180.0, 0.0, 'auto'),
        segment('back', 280.0, -0.1, 'constant_velocity'), segment('near', 360.0, 0.0, 'auto')])
    for order in range(3):
        assert cam.jumps(order) == []
    # half-way of the turn, by the quintic with equal and opposite velocities at its ends
    assert cam.sample(140.0 * DEGREE)[0] == pytest.approx(
        0.1 + 5 / 16 * 0.1 / 100.0 * 80.0, rel=1e-9)


def test_auto_all_round_on_a_belt_is_a_straight_line():
    for ends in ([360.0], [90.0, 360.0], [10.0, 200.0, 360.0], [1.0, 2.0, 3.0, 200.0, 360.0]):
        starts = [0.0, *ends]
        cam = CamProfile([segment(f's{n}', end, (end - start) / 360.0, 'auto')
                          for n, (start, end) in enumerate(zip(starts, ends))], accumulate=True)
        assert cam(np.linspace(0.0, TURN, 50)) == pytest.approx(
            np.linspace(0.0, 1.0, 50), abs=ROUNDING)
        assert all(math.isfinite(peaks.jerk.value) for peaks in cam.segment_peaks)


RESTING = laws_between(Boundary.REST, Boundary.REST)
programs = st.lists(
    st.tuples(st.integers(5, 60), st.integers(-50, 50),
              st.sampled_from(['auto', 'cubic', 'simple_harmonic', 'dwell', *RESTING])),
    min_size=2, max_size=6)


@settings(max_examples=60)
@given(programs)
def test_auto_joins_velocity_and_acceleration_of_any_neighbours(program):
    total, at, segments = sum(span for span, _, _ in program) + 30, 0.0, []
    for n, (span, lift, law) in enumerate(program):
        at += 360.0 * span / total
        segments.append(segment(f's{n}', at, 0.0 if law == 'dwell' else lift / 100.0, law))
    segments.append(segment('last', 360.0, -math.fsum(s.lift for s in segments), 'auto'))
    cam = CamProfile(segments)
    assert cam.jumps(0) == [] and cam.jumps(1) == []
    steps = {round(jump.at / DEGREE, 6) for jump in cam.jumps(2)}
    starts = [0.0, *(s.end_deg for s in segments[:-1])]
    for n, (before, after) in enumerate(zip([segments[-1], *segments], segments)):
        if before.law.name == 'auto' or after.law.name == 'auto':
            assert round(starts[n], 6) not in steps


def test_between_auto_segments_not_even_the_snap_steps_and_nothing_is_smoother():
    lifts, ends = (0.1, -0.2, 0.15, -0.05), (50.0, 120.0, 300.0, 360.0)

    def cam(**stated):
        first, *others = (segment(f's{n}', end, lift, 'auto')
                          for n, (end, lift) in enumerate(zip(ends, lifts)))
        return CamProfile([segment('s0', 50.0, 0.1, 'auto', **stated) if stated else first,
                           *others])
    free = cam()
    for order in range(5):
        assert free.jumps(order) == []
    _, slope, bend, _ = free.sample(50.0 * DEGREE)
    least = jerk_squared(free)
    for stated in ({'end_velocity': slope + 1e-3}, {'end_velocity': slope - 1e-3},
                   {'end_acceleration': bend + 1e-3}, {'end_acceleration': bend - 1e-3}):
        assert jerk_squared(cam(**stated)) > least
    assert jerk_squared(cam(end_velocity=slope, end_acceleration=bend)) == pytest.approx(least)


def test_a_stated_end_is_kept_and_the_other_is_the_smoothest():
    cam = CamProfile([segment('wait', 60.0), segment('up', 150.0, 0.1, 'auto', end_velocity=0),
                      segment('down', 360.0, -0.1, 'auto')])
    assert cam.sample(150.0 * DEGREE)[1] == pytest.approx(0.0, abs=ROUNDING)
    assert cam.jumps(2) == []
    assert [jump.at for jump in cam.jumps(3) if jump.at > 2.0] == []


def test_a_stated_end_must_be_that_of_the_next_segment():
    assert CamProfile(between(end_velocity=LINE)).jumps(2) == []
    with pytest.raises(ConfigurationError) as caught:
        CamProfile(between(end_velocity=0.3))
    problem, = caught.value.problems
    assert (problem.path, problem.value) == ('up.end_velocity', 0.3)
    assert 'run starts with 0.229183118' in problem.rule


def test_a_law_that_does_not_fit_is_refused_with_those_that_do():
    with pytest.raises(ConfigurationError) as caught:
        CamProfile(between(up='modified_sine'))
    problem, = caught.value.problems
    assert problem.path == 'run.law'
    with pytest.raises(ConfigurationError) as caught:
        CamProfile([*between()[:3], segment('back', 360.0, -0.3, 'modified_sine')])
    problem, = caught.value.problems
    assert problem.path == 'back.law'
    # 0.2 over 60 deg before it are -4/3 of its own lift over its span
    assert problem.hint.startswith('give back a law that runs from ')
    assert 'modified_sine ' not in problem.hint and problem.hint.endswith(', auto')


def test_segments_without_auto_are_left_alone():
    segments = (segment('a', 180.0, 1.0, 'cubic'), segment('b', 360.0, -1.0, 'cubic'))
    assert all(a is b for a, b in zip(matched(segments), segments))
    autos = matched(between())
    assert autos[0] is not autos[1] and autos[1].law.name == 'auto'


@pytest.mark.parametrize(('points', 'error'), [(12, 1e-3), (36, 1e-6), (120, 1e-9)])
def test_a_turn_of_auto_segments_is_the_quintic_spline_through_its_points(points, error):
    def wanted(phi):
        return np.sin(phi) + 0.3 * np.cos(3.0 * phi)
    angles = np.linspace(0.0, TURN, points + 1)
    lifts = np.diff(wanted(angles))
    cam = CamProfile([segment(f's{n}', 360.0 * (n + 1) / points, float(lift), 'auto')
                      for n, lift in enumerate(lifts)], accumulate=True)
    assert cam.jumps(4) == []
    phi = np.linspace(0.0, TURN, 997)
    assert cam(phi) + wanted(0.0) == pytest.approx(wanted(phi), abs=error)
