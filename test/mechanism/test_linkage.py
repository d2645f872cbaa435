# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The solver of vector loops: textbook linkages, its proof, singular positions, virtual work."""

import cmath
from dataclasses import replace
import math

from cam_motion.errors import ConfigurationError
from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.linkage import Body, Linkage, Loop, Point, Vector
from cam_motion.mechanism.linkage_motion import holding_efforts, move, sweep
from cam_motion.mechanism.planar import four_bar, slider_crank
from cam_motion.mechanism.pose import SingularError
from cam_motion.mechanism.umbrella import Umbrella
from hypothesis import assume, given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

CLOSED_FORM = 1e-11
STEP = 1e-4  # s, of central differences
DIFFERENCES = 1e-5  # their truncation, for rates near 1 well inside the range

ANGLE = st.floats(0.0, 2.0 * math.pi)
RATE = st.floats(-1.0, 1.0)

CRANK_ROCKER = (0.1, 0.3, 0.25, 0.35)
DRAG_LINK = (0.3, 0.25, 0.35, 0.1)


def freudenstein(a, b, c, d, theta2, omega2):
    """Give angles and angular velocities of coupler and rocker, open assembly (textbook)."""
    k1, k2, k3 = d / a, d / c, (a * a - b * b + c * c + d * d) / (2.0 * a * c)
    cos, sin = math.cos(theta2), math.sin(theta2)
    p, q, r = cos - k1 - k2 * cos + k3, -2.0 * sin, k1 - (k2 + 1.0) * cos + k3
    theta4 = 2.0 * math.atan2(-q - math.sqrt(q * q - 4.0 * p * r), 2.0 * p)
    theta3 = cmath.phase(d + cmath.rect(c, theta4) - cmath.rect(a, theta2))
    omega3 = a * omega2 / b * math.sin(theta4 - theta2) / math.sin(theta3 - theta4)
    omega4 = a * omega2 / c * math.sin(theta2 - theta3) / math.sin(theta4 - theta3)
    return theta3, theta4, omega3, omega4


def apart(first, second):
    """Give the angle between two directions."""
    return abs(math.remainder(first - second, math.tau))


@pytest.fixture(scope='module')
def crank_rocker():
    return Assembly(four_bar(*CRANK_ROCKER))


@given(theta2=ANGLE, omega2=RATE)
@settings(max_examples=40, deadline=None)
def test_four_bar_has_the_closed_form_of_freudenstein(crank_rocker, theta2, omega2):
    motion = move(crank_rocker, crank_rocker.at({'theta2': theta2}), {'theta2': omega2})
    theta3, theta4, omega3, omega4 = freudenstein(*CRANK_ROCKER, theta2, omega2)
    assert apart(motion.position['theta3'], theta3) < CLOSED_FORM
    assert apart(motion.position['theta4'], theta4) < CLOSED_FORM
    assert motion.velocity['theta3'] == pytest.approx(omega3, abs=CLOSED_FORM)
    assert motion.velocity['theta4'] == pytest.approx(omega4, abs=CLOSED_FORM)
    assert motion.points['O4'].position == pytest.approx(CRANK_ROCKER[3], abs=CLOSED_FORM)
    assert motion.points['O4'].acceleration == pytest.approx(0.0, abs=CLOSED_FORM)


def test_transmission_angle_of_the_four_bar_by_the_law_of_cosines(crank_rocker):
    a, b, c, d = CRANK_ROCKER
    for theta2, distance in ((0.0, d - a), (math.pi, d + a)):
        motion = move(crank_rocker, crank_rocker.at({'theta2': theta2}), {})
        cosine = (b * b + c * c - distance ** 2) / (2.0 * b * c)
        assert motion.transmission['rocker_angle'] == pytest.approx(
            math.acos(abs(cosine)), abs=CLOSED_FORM)


@given(theta=ANGLE, omega=RATE, offset=st.sampled_from([0.0, 0.03, -0.05]))
@settings(max_examples=40, deadline=None)
def test_slider_crank_has_its_closed_form(theta, omega, offset):
    r, rod = 0.1, 0.3
    assembly = Assembly(slider_crank(r, rod, offset))
    motion = move(assembly, assembly.at({'theta2': theta}), {'theta2': omega})
    cos, sin = math.cos(theta), math.sin(theta)
    s = offset - r * sin
    root = math.sqrt(rod ** 2 - s * s)
    slope = -r * sin + s * r * cos / root
    bend = -r * cos - r * (r * cos * cos + s * sin) / root - (s * r * cos) ** 2 / root ** 3
    assert motion.position['x'] == pytest.approx(r * cos + root, abs=CLOSED_FORM)
    assert motion.velocity['x'] == pytest.approx(slope * omega, abs=CLOSED_FORM)
    assert motion.acceleration['x'] == pytest.approx(bend * omega ** 2, abs=CLOSED_FORM)
    assert motion.points['B'].position == pytest.approx(complex(r * cos + root, offset))
    assert motion.transmission['slider_angle'] == pytest.approx(math.acos(abs(s) / rod))


def start_at(linkage, assembly, inputs):
    """Give the linkage started anew at other inputs."""
    pose = assembly.at(inputs)
    return Assembly(replace(linkage, start={name: pose[name] for name in linkage.variables}))


@given(st.floats(0.25, 2.1), st.floats(0.4, 1.4), st.tuples(RATE, RATE), st.tuples(RATE, RATE))
@settings(max_examples=15, deadline=None)
def test_velocities_and_accelerations_are_derivatives_of_the_umbrella(h1, h2, rates, seconds):
    linkage = Umbrella().linkage()
    assembly = start_at(linkage, Assembly(linkage), {'h1': h1, 'h2': h2})
    assume(assembly.start.clearance > 0.05)
    check_derivatives(assembly, dict(zip(linkage.inputs, rates)),
                      dict(zip(linkage.inputs, seconds)))


@given(st.floats(0.05, 0.2), st.floats(0.3, 0.5), st.floats(0.3, 0.5), st.floats(0.3, 0.5), ANGLE,
       st.booleans(), RATE, RATE)
@settings(max_examples=25, deadline=None)
def test_velocities_and_accelerations_are_derivatives_of_any_four_bar(
        a, b, c, d, theta2, crossed, rate, second):
    try:
        assembly = Assembly(four_bar(a, b, c, d, crossed, theta2))
    except ConfigurationError:
        assume(False)
    assume(assembly.start.clearance > 0.1)
    check_derivatives(assembly, {'theta2': rate}, {'theta2': second})


def check_derivatives(assembly, rates, seconds):
    """Compare velocity and acceleration at the start with central differences over time."""
    start, names = assembly.start, assembly.linkage.inputs

    def at(t):
        pose = assembly.at({
            name: start[name] + rates[name] * t + 0.5 * seconds[name] * t * t for name in names})
        return move(assembly, pose, {name: rates[name] + seconds[name] * t for name in names},
                    seconds)

    before, now, after = at(-STEP), at(0.0), at(STEP)
    for name in assembly.linkage.variables:
        assert (after.position[name] - before.position[name]) / (2 * STEP) == pytest.approx(
            now.velocity[name], abs=DIFFERENCES)
        assert (after.velocity[name] - before.velocity[name]) / (2 * STEP) == pytest.approx(
            now.acceleration[name], abs=20 * DIFFERENCES, rel=DIFFERENCES)
    for name, point in now.points.items():
        velocity = (after.points[name].position - before.points[name].position) / (2 * STEP)
        bend = (after.points[name].velocity - before.points[name].velocity) / (2 * STEP)
        assert velocity == pytest.approx(point.velocity, abs=DIFFERENCES)
        assert bend == pytest.approx(point.acceleration, abs=20 * DIFFERENCES, rel=DIFFERENCES)


# ---- staying on the branch ----------------------------------------------------------------------
@pytest.mark.parametrize('crossed', [False, True])
def test_after_a_turn_the_crank_rocker_is_back_on_its_branch(crossed):
    assembly = Assembly(four_bar(*CRANK_ROCKER, crossed))
    pose = assembly.follow(assembly.start, {'theta2': assembly.start['theta2'] + 2.0 * math.pi})
    assert pose.values[1:] == pytest.approx(assembly.start.values[1:], abs=CLOSED_FORM)
    proof = pose.certificate
    assert proof.orientation == assembly.start.certificate.orientation == (1 if crossed else -1)
    assert 0.0 < proof.kantorovich < 0.5 and proof.steps > 4


def test_a_drag_link_counts_its_turns():
    assembly = Assembly(four_bar(*DRAG_LINK))
    pose = assembly.follow(assembly.start, {'theta2': assembly.start['theta2'] + 4.0 * math.pi})
    assert pose.values - assembly.start.values == pytest.approx([4.0 * math.pi] * 3)


@given(h1=st.floats(0.3, 2.1), h2=st.floats(0.35, 1.45), seed=st.integers(0, 2 ** 32 - 1))
@settings(max_examples=30, deadline=None)
def test_the_jacobian_changes_no_faster_than_the_clearance_says(h1, h2, seed):
    assembly = Assembly(Umbrella().linkage())
    pose, equations = assembly.at({'h1': h1, 'h2': h2}), assembly.equations

    def scaled(z):
        return (equations.jacobian(z) * equations.units / equations.size)[:, 2:]

    way = np.random.default_rng(seed).normal(size=6)
    way *= 0.5 * pose.clearance / np.linalg.norm(way)
    there = scaled(pose.values + way * equations.units)
    change = np.linalg.solve(scaled(pose.values), there) - np.eye(4)
    assert np.linalg.norm(change, 2) <= 0.5


def test_sweep_gives_the_same_as_each_position_alone(crank_rocker):
    angles = np.linspace(0.0, 7.0, 9)
    motions = sweep(crank_rocker, {'theta2': angles}, {'theta2': 2.0})
    for angle, motion in zip(angles, motions):
        alone = move(crank_rocker, crank_rocker.at({'theta2': angle}), {'theta2': 2.0})
        assert motion.pose.values == pytest.approx(alone.pose.values, abs=CLOSED_FORM)
        assert motion.velocity == pytest.approx(alone.velocity, abs=CLOSED_FORM)


# ---- singular positions -------------------------------------------------------------------------
def test_a_rocker_stops_where_coupler_and_follower_are_in_line():
    a, b, c, d = 0.3, 0.25, 0.2, 0.4  # not Grashof: nothing turns through
    assembly = Assembly(four_bar(a, b, c, d))
    found = assembly.range_of('theta2')
    end = math.acos((a * a + d * d - (b + c) ** 2) / (2.0 * a * d))
    assert (found.low, found.high) == pytest.approx((-end, end), abs=1e-7)
    assert found.at_high.text == 'coupler and rocker come into line in loop four_bar_loop'
    with pytest.raises(SingularError, match='coupler and rocker come into line') as caught:
        assembly.follow(assembly.start, {'theta2': 3.0})
    last = caught.value.pose
    assert last['theta2'] < end and np.all(np.isfinite(last.values)) and last.clearance < 1e-5


def test_a_long_crank_stops_where_the_rod_is_square_to_the_slide():
    assembly = Assembly(slider_crank(0.3, 0.1, start=0.1))
    found = assembly.range_of('theta2')
    end = math.asin(0.1 / 0.3)
    assert (found.low, found.high) == pytest.approx((-end, end), abs=1e-7)
    assert found.at_low.text == 'rod comes square to the slide x in loop crank_loop'


def test_a_crank_that_turns_through_has_no_bounds(crank_rocker):
    found = crank_rocker.range_of('theta2')
    assert (found.low, found.high) == (-math.inf, math.inf)
    assert found.at_low is found.at_high is None


def five_bar():
    """Give two cranks whose ends are joined by two couplers."""
    height = math.sqrt(0.6 ** 2 - 0.5 ** 2)
    return Linkage(
        'five_bar', (Body('left', 'a'), Body('right', 'b'), Body('first', 'c'),
                     Body('second', 'd')),
        (Vector('l', 0.5, 'left'), Vector('r', 0.5, 'right'), Vector('p', 0.6, 'first'),
         Vector('q', 0.6, 'second'), Vector('f', 1.0)),
        (Loop('ring', ('l', 'p', '-q', '-r', '-f')),), (Point('tip', ('l', 'p')),), ('a', 'b'),
        ('c', 'd'), {'a': 0.5 * math.pi, 'b': 0.5 * math.pi, 'c': math.atan2(height, 0.5),
                     'd': math.atan2(height, -0.5)})


def test_an_input_out_of_range_is_told_the_range_with_the_others_as_they_are_wanted():
    assembly = Assembly(five_bar())
    apart = {'a': math.radians(110.0), 'b': math.radians(70.0)}
    with pytest.raises(ConfigurationError, match='first and second come into line') as caught:
        assembly.at(apart)
    (a, b) = caught.value.problems
    assert (a.path, b.path) == ('a', 'b')
    found = assembly.range_of('a', assembly.at({'b': apart['b']}))
    assert math.degrees(found.high) < 110.0 < math.degrees(assembly.range_of('a').high)
    assert 'with b = 70 deg' in a.rule and f'to {math.degrees(found.high):.6g} deg' in a.rule


def test_where_the_straight_way_is_blocked_one_input_goes_after_the_other():
    # with b = 100 deg the crank a turns through; on the straight way it is stopped before
    turn, linkage = math.radians, replace(
        five_bar(), vectors=tuple(replace(vector, length=length) for vector, length in zip(
            five_bar().vectors, (1.0, 1.0, 1.2, 1.2, 1.0))),
        start={'a': math.radians(120.0), 'b': math.radians(60.0), 'c': math.radians(32.0),
               'd': math.radians(148.0)})
    assembly = Assembly(linkage)
    wanted = {'a': turn(250.0), 'b': turn(100.0)}
    with pytest.raises(SingularError):
        assembly.follow(assembly.start, wanted)
    pose = assembly.at(wanted)
    assert (pose['a'], pose['b']) == (wanted['a'], wanted['b'])
    assert np.abs(assembly.equations.closure(pose.values)).max() < CLOSED_FORM
    assert pose.certificate.kantorovich < 0.5
    assert pose.certificate.orientation == assembly.start.certificate.orientation
    # and what is out of range by itself stays so
    with pytest.raises(ConfigurationError, match='with b = 60 deg'):
        assembly.at({'a': wanted['a']})


def test_what_no_way_leads_to_is_said_to_be_out_of_reach_together(monkeypatch):
    assembly = Assembly(five_bar())
    wanted = {'a': 1.8, 'b': 1.3}

    def blocked(pose, inputs):
        raise SingularError(assembly.start, assembly.range_of('a').at_high)

    monkeypatch.setattr(assembly, 'reach', blocked)
    with pytest.raises(ConfigurationError, match='one input after the other') as caught:
        assembly.at(wanted)
    assert [problem.path for problem in caught.value.problems] == ['a, b']


# ---- virtual work -------------------------------------------------------------------------------
LOAD = st.floats(-100.0, 100.0)


@given(st.floats(0.4, 2.0), st.floats(0.4, 1.4), RATE, RATE, LOAD, LOAD, LOAD)
@settings(max_examples=20, deadline=None)
def test_inputs_and_loads_balance_in_power(h1, h2, h1_dot, h2_dot, fx, fy, torque):
    assembly = Assembly(Umbrella().linkage())
    pose = assembly.at({'h1': h1, 'h2': h2})
    forces, torques = {'E': complex(fx, fy), 'G': complex(fy, 1.0)}, {'theta5': torque}
    motion = move(assembly, pose, {'h1': h1_dot, 'h2': h2_dot})
    held = holding_efforts(assembly, pose, forces, torques)
    power = held['h1'] * h1_dot + held['h2'] * h2_dot + torque * motion.velocity['theta5']
    power += sum((force.conjugate() * motion.points[name].velocity).real
                 for name, force in forces.items())
    assert power == pytest.approx(0.0, abs=1e-9)


def test_torque_of_a_crank_that_holds_a_piston():
    assembly = Assembly(slider_crank(0.1, 0.3))
    pose = assembly.at({'theta2': 1.0})
    slope = move(assembly, pose, {'theta2': 1.0}).velocity['x']
    by_force = holding_efforts(assembly, pose, {'B': -500.0})
    assert by_force == pytest.approx({'theta2': 500.0 * slope})
    assert holding_efforts(assembly, pose, {}, {'x': -500.0}) == pytest.approx(by_force)


def test_loads_on_nothing_are_refused():
    assembly = Assembly(slider_crank(0.1, 0.3))
    with pytest.raises(ConfigurationError) as caught:
        holding_efforts(assembly, assembly.start, {'Z': 1.0}, {'y': 1.0})
    assert [problem.path for problem in caught.value.problems] == ['Z', 'y']
    with pytest.raises(ConfigurationError, match='theta9_dot'):
        move(assembly, assembly.start, {'theta9': 1.0})


# ---- descriptions -------------------------------------------------------------------------------
@pytest.mark.parametrize('change, path', [
    ({'inputs': ('theta2', 'theta3'), 'unknowns': ('theta4',)}, 'unknowns'),
    ({'inputs': ()}, 'inputs'),
    ({'loops': (Loop('l', ('r2', '-r9')),)}, 'l.path'),
    ({'loops': (Loop('l', ()),)}, 'l.path'),
    ({'loops': (Loop('l', ('r2', '-r1')),)}, 'theta3'),
    ({'points': (Point('P', start='Q'),)}, 'P.from'),
    ({'points': (Point('r2'),)}, 'points'),
    ({'vectors': (Vector('r2', -1.0, 'crank'),)}, 'r2.length'),
    ({'vectors': (Vector('r2', math.nan, 'crank'),)}, 'r2.length'),
    ({'vectors': (Vector('r2', 'theta3', 'crank'),)}, 'r2.variable'),
    ({'vectors': (Vector('r2', 'what', 'crank'),)}, 'r2.variable'),
    ({'vectors': (Vector('r2', 1.0, 'wheel'),)}, 'r2.body'),
    ({'bodies': (Body('crank', 'what'),)}, 'crank.angle'),
    ({'start': {'theta2': math.inf}}, 'theta2.start'),
    ({'start': {}}, 'theta4.start'),
])
def test_what_is_no_linkage_is_said_at_its_place(change, path):
    with pytest.raises(ConfigurationError) as caught:
        replace(four_bar(*CRANK_ROCKER), **change)
    assert path in {problem.path for problem in caught.value.problems}


def test_a_start_that_names_no_branch_is_refused():
    good = four_bar(*CRANK_ROCKER)
    with pytest.raises(ConfigurationError, match='name no branch'):
        Assembly(replace(good, start={**good.start, 'theta3': good.start['theta3'] + 1.5}))


def problem_of(linkage):
    """Give the one problem of assembling a linkage."""
    with pytest.raises(ConfigurationError) as caught:
        Assembly(linkage)
    problem, = caught.value.problems
    return problem


@pytest.mark.parametrize('length, start, words', [
    (9.0, 1.0, 'h1 = 1 m, whatever the angles: L2 is 9 m long, d1 and slide only 2.2 m'),
    (1.0, 2.3, 'h1 = 2.3 m, whatever the angles: slide is 2.3 m long, d1 and L2 only 2.2 m'),
])
def test_lengths_that_cannot_close_are_named_with_their_loop_and_input(length, start, words):
    good = Umbrella().linkage()
    vectors = tuple(replace(each, length=length) if each.name == 'L2' else each
                    for each in good.vectors)
    problem = problem_of(replace(good, vectors=vectors, start={**good.start, 'h1': start}))
    assert problem.path == 'rib.path' and words in problem.rule


def test_vectors_of_one_body_are_one_side():
    # L6 and the stretch are square to each other on link 6: 1.6 m, more than d4 and L5
    good = Umbrella().linkage()
    problem = problem_of(replace(good, start={**good.start, 'h2': 1.6}))
    side = math.hypot(0.1, 1.6)
    assert problem.path == 'tip.path'
    assert f'L6 and stretch are together {side:.6g} m long' in problem.rule


def test_a_start_that_misses_says_which_loop_and_speaks_of_degrees():
    good = Umbrella().linkage()
    problem = problem_of(replace(good, start={**good.start, 'theta5': math.radians(40.0)}))
    assert 'theta5 = 40 deg' in problem.value and 'h1 = 1 m, h2 = 0.8 m' in problem.rule
    assert 'loop tip misses by' in problem.rule and 'loop rib' not in problem.rule


def test_a_start_in_a_singular_position_is_said_to_be_one():
    problem = problem_of(Linkage(
        'flat', (Body('first', 'a'), Body('second', 'b')),
        (Vector('l', 0.6, 'first'), Vector('q', 0.4, 'second'), Vector('s', 'x')),
        (Loop('ring', ('l', 'q', '-s')),), (), ('x',), ('a', 'b'),
        {'x': 1.0, 'a': 0.0, 'b': 0.0}))
    assert 'first and second come into line in loop ring' in problem.rule


@pytest.mark.parametrize('make', [
    lambda: four_bar(0.1, 0.1, 0.1, 0.5), lambda: slider_crank(0.5, 0.1, start=1.5)])
def test_lengths_that_never_close_are_refused(make):
    with pytest.raises(ConfigurationError):
        make()
