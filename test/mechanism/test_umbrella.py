# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The umbrella of document 003: its closed forms against the solver, and its own identities."""

from dataclasses import replace
import math

from cam_motion.errors import ConfigurationError, DomainError
from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.linkage_motion import move
from cam_motion.mechanism.umbrella import Umbrella
from cam_motion.units import DEGREE
from hypothesis import given, settings
from hypothesis import strategies as st
import pytest

pytestmark = pytest.mark.timeout(60)

CLOSED_FORM = 1e-12
ENDS = 1e-7  # m; the solver stops where velocities have lost five digits
LINKS = ('2', '3', '5', '6')
UMBRELLA = Umbrella()
ASSEMBLY = Assembly(UMBRELLA.linkage())
(LOW1, HIGH1), (LOW2, HIGH2) = UMBRELLA.ranges

# a hundredth of the range away from both ends, where no digits are lost
H1 = st.floats(LOW1 + 0.02, HIGH1 - 0.02)
H2 = st.floats(LOW2 + 0.012, HIGH2 - 0.012)
RATE = st.floats(-1.0, 1.0)
LENGTH = st.floats(0.3, 3.0)
SHARE = st.floats(0.1, 0.9)


def at(h1, h2, h1_dot=0.0, h2_dot=0.0, assembly=ASSEMBLY):
    """Solve for given inputs."""
    return move(assembly, assembly.at({'h1': h1, 'h2': h2}), {'h1': h1_dot, 'h2': h2_dot})


def turned(angle):
    """Give an angle within half a turn of zero."""
    return math.remainder(angle, math.tau)


def test_the_branch_is_the_one_of_the_facts():
    start = ASSEMBLY.start
    angles = [start[f'theta{k}'] / DEGREE for k in LINKS]
    assert angles == pytest.approx([-16.3, 36.9, -81.9, -101.0], abs=0.05)
    assert (start['h1'], start['h2']) == (1.0, 0.8)


@given(H1, H2, RATE, RATE)
@settings(max_examples=60, deadline=None)
def test_solver_and_closed_forms_agree(h1, h2, h1_dot, h2_dot):
    motion = at(h1, h2, h1_dot, h2_dot)
    closed = zip(LINKS, UMBRELLA.angles(h1, h2),
                 UMBRELLA.angular_velocities(h1, h2, h1_dot, h2_dot))
    for link, angle, omega in closed:
        assert abs(turned(motion.position[f'theta{link}'] - angle)) < CLOSED_FORM
        assert motion.velocity[f'theta{link}'] == pytest.approx(
            omega, rel=CLOSED_FORM, abs=CLOSED_FORM)


@given(LENGTH, LENGTH, LENGTH, LENGTH, st.floats(0.01, 0.1), SHARE, SHARE, RATE, RATE)
@settings(max_examples=40, deadline=None)
def test_solver_and_closed_forms_agree_for_any_dimensions(
        l2, d1, d4, l5, l6, share1, share2, h1_dot, h2_dot):
    umbrella = Umbrella(l2=l2, d1=d1, d4=d4, l5=l5, l6=l6)
    h1, h2 = (low + share * (high - low)
              for share, (low, high) in zip((share1, share2), umbrella.ranges))
    angles = umbrella.angles(h1, h2)
    start = {'h1': h1, 'h2': h2, **{f'theta{k}': a for k, a in zip(LINKS, angles)}}
    motion = at(h1, h2, h1_dot, h2_dot, Assembly(replace(umbrella.linkage(), start=start)))
    closed = umbrella.angular_velocities(h1, h2, h1_dot, h2_dot)
    assert [motion.velocity[f'theta{k}'] for k in LINKS] == pytest.approx(
        closed, rel=1e-11, abs=1e-11)


@given(H1, H2, RATE)
@settings(max_examples=20, deadline=None)
def test_with_h2_held_links_3_5_and_6_turn_as_one_body(h1, h2, h1_dot):
    velocity = at(h1, h2, h1_dot).velocity
    assert velocity['theta5'] == pytest.approx(velocity['theta3'], abs=CLOSED_FORM)
    assert velocity['theta6'] == pytest.approx(velocity['theta3'], abs=CLOSED_FORM)


@given(H1, H2, RATE, RATE)
@settings(max_examples=20, deadline=None)
def test_d_moves_as_the_same_point_of_link_3_and_c_closes(h1, h2, h1_dot, h2_dot):
    motion = at(h1, h2, h1_dot, h2_dot)
    points, umbrella = motion.points, UMBRELLA
    theta, omega = motion.position['theta3'], motion.velocity['theta3']
    alpha = motion.acceleration['theta3']
    link = complex(math.cos(theta), math.sin(theta))
    for name, arm in (('D', umbrella.l3 - umbrella.d4), ('C', umbrella.d1)):
        on_link = points['B'].position + arm * link
        assert points[name].position == pytest.approx(on_link, abs=CLOSED_FORM)
        assert points[name].velocity == pytest.approx(
            points['B'].velocity + 1j * omega * arm * link, abs=1e-11)
        assert points[name].acceleration == pytest.approx(
            points['B'].acceleration + (1j * alpha - omega ** 2) * arm * link, rel=1e-9, abs=1e-9)
    assert points['A'].position == 0.0
    assert points['B'].position == pytest.approx(-1j * h1)


def test_the_printed_omega5_is_wrong():
    h1, h2, h1_dot, h2_dot = 1.0, 0.8, -0.3, 0.1
    _, t3, t5, t6 = UMBRELLA.angles(h1, h2)
    u = UMBRELLA
    printed = -(h2 * h2_dot - u.l6 * u.d4 * math.sin(t3 - t6) - u.d4 * h2 * math.cos(t3 - t6)) / (
        u.l5 * (u.l6 * math.sin(t5 - t6) + h2 * math.cos(t5 - t6)))
    assert abs(at(h1, h2, h1_dot, h2_dot).velocity['theta5'] - printed) > 0.1


@pytest.mark.parametrize('name, ends, links', [
    ('h1', (0.2, 2.2), ('link2', 'link3', 'rib')),
    ('h2', (math.sqrt(0.08), math.sqrt(2.24)), ('link5', 'link6', 'tip')),
])
def test_the_range_ends_where_two_links_are_in_line(name, ends, links):
    found = ASSEMBLY.range_of(name)
    assert (found.low, found.high) == pytest.approx(ends, abs=ENDS)
    assert found.low > ends[0] and found.high < ends[1]
    assert UMBRELLA.ranges[name == 'h2'] == pytest.approx(ends, abs=1e-15)
    for singularity in (found.at_low, found.at_high):
        assert all(word in singularity.text for word in links)
        assert singularity.unknowns == tuple(link.replace('link', 'theta') for link in links[:2])
        assert singularity.loops == links[2:]


@pytest.mark.parametrize('inputs, low, high', [
    ({'h1': 2.3}, '0.2 m', '2.2 m'), ({'h1': 0.1999}, '0.2 m', '2.2 m'),
    ({'h1': -1.0}, '0.2 m', '2.2 m'), ({'h2': 0.28}, '0.282843 m', '1.49666 m'),
    ({'h2': 1.5}, '0.282843 m', '1.49666 m'),
])
def test_an_input_out_of_range_is_refused_with_the_range(inputs, low, high):
    with pytest.raises(ConfigurationError) as caught:
        ASSEMBLY.at(inputs)
    problem, = caught.value.problems
    assert (problem.path, problem.value) == next(iter(inputs.items()))
    assert low in problem.rule and high in problem.rule and 'line' in problem.rule
    with pytest.raises(DomainError):
        UMBRELLA.angles(**{'h1': 1.0, 'h2': 0.8, **inputs})


def test_all_inputs_out_of_range_are_said_at_once():
    with pytest.raises(ConfigurationError) as caught:
        ASSEMBLY.at({'h1': 5.0, 'h2': 0.0})
    assert [problem.path for problem in caught.value.problems] == ['h1', 'h2']


@pytest.mark.parametrize('inputs', [{'h3': 1.0}, {'h1': math.nan}, {'h1': 1e300}])
def test_what_is_no_input_or_no_number_is_refused(inputs):
    with pytest.raises(ConfigurationError):
        ASSEMBLY.at(inputs)


def test_the_last_micrometre_before_the_end_is_still_solved():
    motion = at(HIGH1 - 1e-6, HIGH2 - 1e-6, 0.1, 0.1)
    closed = UMBRELLA.angular_velocities(HIGH1 - 1e-6, HIGH2 - 1e-6, 0.1, 0.1)
    assert [motion.velocity[f'theta{k}'] for k in LINKS] == pytest.approx(closed, rel=1e-7)
