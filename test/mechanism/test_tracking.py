# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A linkage followed tick by tick: the same as solved at once, never further than it may."""

import math

from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.joints import LinkageJoints
from cam_motion.mechanism.linkage import Body, Linkage, Loop, Point, Vector
from cam_motion.mechanism.linkage_motion import holding_efforts, move
from cam_motion.mechanism.outline import Outline
from cam_motion.mechanism.planar import four_bar, slider_crank
from cam_motion.mechanism.tracking import Tracker
from cam_motion.mechanism.umbrella import Umbrella
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

UMBRELLA = Assembly(Umbrella().linkage())
OTHERS = [Assembly(four_bar(0.10, 0.30, 0.25, 0.35)), Assembly(slider_crank(0.1, 0.3, 0.05))]
EXACT = 1e-12


def arrive(tracker, inputs, ticks=200):
    """Go on until the inputs are reached; say how many ticks it took."""
    for tick in range(ticks):
        if tracker.follow(inputs) is not None:
            return tick
    pytest.fail('not reached')


@given(st.lists(st.tuples(st.floats(0.25, 2.15), st.floats(0.32, 1.45)), min_size=1, max_size=4))
@settings(max_examples=25, deadline=None)
def test_any_way_leads_to_what_is_solved_from_the_start(targets):
    tracker = Tracker(UMBRELLA)
    for target in targets:
        arrive(tracker, target)
    want = UMBRELLA.at(dict(zip(('h1', 'h2'), targets[-1])))
    assert tracker.pose.values == pytest.approx(want.values, abs=1e-10)
    proof = tracker.pose.certificate
    assert proof.kantorovich < 0.5 and proof.orientation == want.certificate.orientation


def test_small_steps_are_one_certified_step_each_and_do_not_drift():
    tracker = Tracker(UMBRELLA)
    for k in range(1, 501):
        inputs = (1.0 + 0.6 * math.sin(0.02 * k), 0.8 + 0.3 * math.sin(0.013 * k))
        assert tracker.follow(inputs) is not None
        assert np.abs(UMBRELLA.equations.closure(tracker.pose.values)).max() < 1e-14
    assert tracker.pose.certificate.steps <= 600


@pytest.mark.parametrize('assembly', [UMBRELLA, *OTHERS])
def test_rates_are_those_of_the_motion(assembly):
    tracker = Tracker(assembly)
    names = assembly.linkage.inputs
    inputs = [assembly.start[name] + 0.1 for name in names]
    arrive(tracker, inputs)
    rates = tracker.rates([0.3, -0.2][:len(names)])
    motion = move(assembly, tracker.pose, dict(zip(names, (0.3, -0.2))))
    assert rates == pytest.approx([motion.velocity[name] for name in assembly.linkage.variables],
                                  abs=EXACT)


def test_a_crank_may_turn_for_ever():
    tracker = Tracker(OTHERS[0])
    for k in range(1, 200):
        arrive(tracker, [math.radians(60.0) + 0.5 * k])
    start = OTHERS[0].at({'theta2': math.remainder(
        math.radians(60.0) + 0.5 * 199, math.tau)})
    for name in ('theta3', 'theta4'):
        assert math.remainder(tracker.pose[name] - start[name], math.tau) == pytest.approx(
            0.0, abs=1e-11)


@pytest.mark.parametrize('turns', [3, -3, 100_000])
def test_turns_that_an_axis_has_counted_before_are_not_gone_through(turns):
    tracker = Tracker(OTHERS[1])
    inputs = [math.radians(200.0) + math.tau * turns]
    tracker.unwind(inputs)
    assert arrive(tracker, inputs) < 12
    assert tracker.pose['theta2'] == inputs[0]
    want = OTHERS[1].at({'theta2': math.radians(200.0)})
    for name in ('theta3', 'x'):
        assert tracker.pose[name] == pytest.approx(want[name], abs=1e-9)


def test_what_cannot_turn_all_the_way_round_is_not_turned():
    rocker = Assembly(four_bar(0.30, 0.10, 0.25, 0.35))  # its input swings
    tracker = Tracker(rocker)
    inputs = [rocker.start['theta2'] + math.tau]
    tracker.unwind(inputs)
    for _ in range(100):
        assert tracker.follow(inputs) is None
    assert 'theta2' in str(tracker.problems(inputs)[0])
    tracker = Tracker(UMBRELLA)
    tracker.unwind((1.0 + math.tau, 0.8))
    assert arrive(tracker, (1.0, 0.8)) == 0


def test_what_is_out_of_range_is_refused_and_the_last_position_kept():
    tracker = Tracker(UMBRELLA)
    tracker.prepare()
    arrive(tracker, (2.0, 0.8))
    kept = tracker.pose
    for h1 in np.linspace(2.05, 2.5, 80):
        if tracker.follow((h1, 0.8)) is not None:
            kept = tracker.pose
    assert tracker.pose is kept and 2.1 < kept['h1'] < 2.2
    problem, = tracker.problems((2.5, 0.8))
    assert (problem.path, problem.value) == ('h1', 2.5)
    assert '0.2 m to 2.2 m' in problem.rule and 'link2 and link3' in problem.rule
    assert 'with h2 = 0.8 m' in problem.rule and 'now' not in problem.rule
    problem, = tracker.problems((2.5, 0.9))  # the other input has moved: where it was stopped
    assert problem.rule.endswith(f'now {tracker.refusal}')
    assert arrive(tracker, (2.1, 0.8)) < 12
    assert tracker.refusal is None and tracker.problems((2.1, 0.8)) == []


def test_inputs_refused_only_together_are_tried_again():
    # two cranks of a five-bar: each may stand anywhere alone, not both apart
    turn = math.radians
    five = Linkage(
        'five', tuple(Body(f'link{k}', f't{k}') for k in (1, 2, 3, 4)),
        (*(Vector(f'r{k}', length, f'link{k}') for k, length in (
            (1, 0.3), (2, 0.4), (3, 0.4), (4, 0.3))), Vector('base', 0.4)),
        (Loop('ring', ('r1', 'r2', '-r3', '-r4', '-base')),),
        (Point('P', ('r1', 'r2')),), ('t1', 't4'), ('t2', 't3'),
        {'t1': turn(90.0), 't4': turn(90.0), 't2': turn(60.0), 't3': turn(120.0)})
    tracker = Tracker(Assembly(five))
    apart = (turn(160.0), turn(20.0))
    for _ in range(400):
        assert tracker.follow(apart) is None
        if tracker.refusal is not None:
            break
    assert tracker.problems(apart)
    arrive(tracker, (turn(100.0), turn(80.0)))


@pytest.mark.parametrize('assembly', [UMBRELLA, *OTHERS])
def test_the_origins_of_the_pieces_are_where_their_bars_are(assembly):
    outline = Outline(assembly)
    joints = LinkageJoints(assembly, outline, {})
    tracker = Tracker(assembly)
    arrive(tracker, [assembly.start[name] + 0.2 for name in assembly.linkage.inputs])
    rates = tracker.rates([0.4] * len(assembly.linkage.inputs))
    positions, velocities, efforts = joints.at(tracker.pose.values, rates, tracker.gain())
    there, moving = (dict(zip(joints.names, each)) for each in (positions, velocities))
    assert efforts == []
    motion = move(assembly, tracker.pose, dict.fromkeys(assembly.linkage.inputs, 0.4))
    marked = 0
    for piece in outline.pieces:
        origin, speed = piece.place, 0.0
        if piece.moves:
            origin, speed = (complex(each[f'{piece.name}_x'], each[f'{piece.name}_y'])
                             for each in (there, moving))
        angle, omega = (each.get(piece.angle, 0.0) for each in (there, moving))
        for mark in piece.marks:
            arm = mark.place * complex(math.cos(angle), math.sin(angle))
            point = motion.points[mark.name]
            assert origin + arm == pytest.approx(point.position, abs=EXACT)
            assert speed + 1j * omega * arm == pytest.approx(point.velocity, abs=EXACT)
            marked += 1
    assert marked == len(assembly.linkage.points)
    drawn = {part.where.vector for piece in outline.pieces
             for part in (*piece.bars, *piece.slides)}
    passed = {name.strip('-') for loop in assembly.linkage.loops for name in loop.path}
    assert drawn >= passed


def test_efforts_are_those_of_virtual_work():
    tracker = Tracker(UMBRELLA)
    arrive(tracker, (1.3, 0.9))
    forces = {'D': 3.0 - 10.0j, 'C': 2.0j}
    torques = {'theta5': 4.0, 'h1': -2.0}
    joints = LinkageJoints(UMBRELLA, Outline(UMBRELLA), forces, torques)
    efforts = joints.at(tracker.pose.values, tracker.rates((0.0, 0.0)), tracker.gain())[2]
    want = holding_efforts(UMBRELLA, tracker.pose, forces, torques)
    assert efforts[:2] == pytest.approx(list(want.values()), abs=1e-11)
    assert len(efforts) == len(joints.names) and not any(efforts[2:])
    joints = LinkageJoints(UMBRELLA, Outline(UMBRELLA), {}, torques)
    efforts = joints.at(tracker.pose.values, tracker.rates((0.0, 0.0)), tracker.gain())[2]
    want = holding_efforts(UMBRELLA, tracker.pose, {}, torques)
    assert efforts[:2] == pytest.approx(list(want.values()), abs=1e-11)
