# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
The look-ahead of an axis, and what a trajectory controller makes of it between its points.

The controller is written here anew, from the description of joint_trajectory_controller: between
two points with position, velocity and acceleration it goes by a quintic, and a message replaces
the one before as soon as it is there.
"""

from functools import cache
from itertools import pairwise
import math
from pathlib import Path

from cam_motion.io.axis import build_axis
from cam_motion.io.config import load_machine
from cam_motion.motion.limits import Limits
from cam_motion.runtime.follower import Follower
from cam_motion.runtime.follower_settings import FollowerSettings
from cam_motion.runtime.look_ahead import (
    look_ahead,
    shaft_ahead,
    SHORTEST,
    stopping_after,
    times_ahead,
)
from cam_motion.runtime.motion_over_angle import Cascade, Standstill
from cam_motion.runtime.planning import Timing
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.runtime.shaft_motion import ShaftMotion, ShaftState
from cam_motion.units import DEGREE, RPM, TURN
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

MACHINE = load_machine(Path(__file__).resolve().parents[2] / 'config' / 'cutting_machine.yaml')
STROKES = {'feeder': 0.3, 'press': 0.02, 'knife': 0.08}
SPEED = 200.0 * RPM
TICK = 0.002
STOP = RampLimits(150.0, 3000.0)
# value, slope and curvature at both ends of the unit interval, by rising powers
HERMITE = np.array([
    [1, 0, 0, -10, 15, -6], [0, 1, 0, -6, 8, -3], [0, 0, 0.5, -1.5, 1.5, -0.5],
    [0, 0, 0, 10, -15, 6], [0, 0, 0, -4, 7, -3], [0, 0, 0, 0.5, -1, 0.5]])


def quintic(one, two, t):
    """Interpolate position and velocity between two points as the controller does."""
    h = two.time - one.time
    s = (t - one.time) / h
    ends = np.array([one.position, h * one.velocity, h * h * one.acceleration,
                     two.position, h * two.velocity, h * h * two.acceleration])
    powers = ends @ HERMITE
    return (float(powers @ s ** np.arange(6)),
            float(powers[1:] @ (np.arange(1, 6) * s ** np.arange(5))) / h)


class Controller:
    """A trajectory controller that is sent messages, and says where it wants the joint."""

    def __init__(self):
        self.start, self.points = 0.0, []

    def receive(self, stamp, points):
        """Take a message in the place of the one before, as the controller's rules allow."""
        assert points[-1].velocity == 0.0  # else it must be told to take it
        assert all(b.time > a.time for a, b in pairwise(points)) and points[0].time == 0.0
        self.start, self.points = stamp, points

    def desired(self, t):
        """Give position and velocity at a time; behind the last point it holds that."""
        t -= self.start
        for one, two in pairwise(self.points):
            if one.time <= t < two.time:
                return quintic(one, two, t)
        return self.points[-1].position, 0.0


def message(motion, shaft, t, rate, points=5):
    """Make the message of a tick as the node does, the jerk from the tick before."""
    state = shaft(t)
    jerk = (state.alpha - shaft(t - TICK).alpha) / TICK
    ahead = stopping_after(shaft_ahead(state, jerk, points / rate), STOP)
    return look_ahead(motion, ahead, times_ahead(ahead, 1.0 / rate, points))


def errors(motion, shaft, rate, seconds, latency=0.004, start=0.5):
    """Send messages that take a while; give the largest error of position and of velocity."""
    controller, due, worst = Controller(), round(start * rate), np.zeros(2)
    for k in range(round(seconds / 0.0005)):
        t = start + latency + 0.0005 * k
        while due / rate + latency <= t + 1e-9:
            controller.receive(due / rate, message(motion, shaft, due / rate, rate))
            due += 1
        phi, omega, _ = shaft(t)
        y, slope, _, _ = motion.sample(phi)
        worst = np.maximum(worst, np.abs(np.array(controller.desired(t)) - (y, slope * omega)))
    return worst


def steady(t):
    """Turn at 200 cycles/min."""
    return ShaftState(SPEED * t, SPEED, 0.0)


@cache
def run_up(start):
    """Start then and run up to 200 cycles/min, jerk-limited as a master shaft does."""
    shaft = Shaft(SPEED, RampLimits(30.0, 300.0), STOP)
    shaft.run(start)
    return shaft.state


def motion_of(axis):
    return MACHINE.diagram.axes[axis].layout.motion


# What the controller makes of it


@pytest.mark.parametrize('axis', STROKES)
@pytest.mark.parametrize('rate', [50.0, 100.0])
def test_the_controller_reproduces_the_curve_at_200_cycles_per_minute(axis, rate):
    position, velocity = errors(motion_of(axis), steady, rate, 0.62)
    assert position < 8e-6 * STROKES[axis]
    assert velocity < 3.5e-4 * motion_peak(axis)


def motion_peak(axis):
    return SPEED * np.abs(motion_of(axis)(np.linspace(0.0, TURN, 3601))[1]).max()


@pytest.mark.parametrize('axis', STROKES)
@pytest.mark.parametrize('start', [0.55, 0.578, 0.606])
@pytest.mark.parametrize('rate, share', [(50.0, 6e-4), (100.0, 9e-5)])
def test_the_controller_reproduces_the_curve_while_the_shaft_runs_up(axis, rate, share, start):
    # until the next message the controller does not know that the jerk has changed
    position, velocity = errors(motion_of(axis), run_up(start), rate, 1.2)
    assert position < share * STROKES[axis]
    assert velocity < 4e-3 * motion_peak(axis)


@pytest.mark.parametrize('law', ['cubic', 'constant_acceleration', 'trapezoidal_velocity'])
def test_laws_whose_acceleration_steps_are_reproduced_too(law):
    axis = build_axis('axis', {
        'segments': ['up', 'down'], 'up.law': law, 'up.end_deg': 120.0, 'up.lift': 0.1,
        'down.law': law, 'down.end_deg': 360.0, 'down.lift': -0.1})
    position, velocity = errors(axis.layout.motion, steady, 50.0, 0.62)
    assert position < 1e-9 and velocity < 1e-3


def test_without_the_joints_it_would_be_off_by_far():
    class Smooth:
        sample = staticmethod(motion_of('feeder').sample)

        @staticmethod
        def joints(low, high):
            return np.empty(0)
    assert errors(Smooth, steady, 50.0, 0.62)[0] > 1e-3 * STROKES['feeder']


def test_a_transition_that_goes_on_is_seen_ahead():
    axis = build_axis('axis', {
        'segments': ['up', 'down'], 'up.law': 'cycloidal', 'up.end_deg': 120.0, 'up.lift': 0.1,
        'down.law': 'cycloidal', 'down.end_deg': 360.0, 'down.lift': -0.1})
    follower = Follower(axis.layout, FollowerSettings(
        Limits(), engage=Timing(span=90.0 * DEGREE)), engaged=False)
    follower.answer(*steady(0.5))
    follower.engage()
    follower.answer(*steady(0.51))
    assert errors(follower.motion, steady, 50.0, 0.3)[0] < 5e-6


def test_without_further_messages_the_axis_stops_on_its_curve():
    motion, controller = motion_of('feeder'), Controller()
    controller.receive(0.5, message(motion, steady, 0.5, 50.0))
    end = controller.points[-1]
    ahead = stopping_after(shaft_ahead(steady(0.5), 0.0, 0.1), STOP)
    worst = 0.0
    for t in np.arange(0.5, 0.5 + end.time, 0.0005):
        phi = ahead.state(t - 0.5).phi
        worst = max(worst, abs(controller.desired(t)[0] - motion.sample(phi)[0]))
    assert worst < 1e-5 and (end.velocity, end.acceleration) == (0.0, 0.0)
    assert ahead.settled_at == pytest.approx(end.time)
    assert end.position == motion.sample(ahead.final.phi)[0]


# The points


def test_points_are_exact_setpoints():
    motion, state = motion_of('press'), ShaftState(1.7, 15.0, 40.0)
    shaft = ShaftMotion(0.0, state)
    for point in look_ahead(motion, shaft, [0.0, 0.01, 0.02]):
        phi, omega, alpha = shaft.state(point.time)
        y, slope, bend, _ = motion.sample(phi)
        assert point[1:4] == pytest.approx((y, slope * omega, bend * omega ** 2 + slope * alpha))


def test_grid_and_joints_are_among_the_times():
    motion = motion_of('feeder')
    shaft = ShaftMotion(0.0, ShaftState(-0.5, 10.0, 20.0))
    times = [0.02 * k for k in range(6)]
    found = [point.time for point in look_ahead(motion, shaft, times)]
    assert set(times) <= set(found)
    between = [shaft.state(t).phi for t in found if t not in times]
    assert between == pytest.approx(motion.joints(-0.5, shaft.state(0.1).phi), abs=1e-9)
    assert len(between) > 2


@given(st.floats(-50.0, 50.0), st.floats(-25.0, 25.0), st.floats(-40.0, 40.0),
       st.floats(-400.0, 400.0), st.sampled_from(sorted(STROKES)))
def test_times_rise_and_the_end_stands(phi, omega, alpha, jerk, axis):
    ahead = stopping_after(shaft_ahead(ShaftState(phi, omega, alpha), jerk, 0.1), STOP)
    times = times_ahead(ahead, 0.02, 5)
    points = look_ahead(motion_of(axis), ahead, times)
    assert (points[0].time, points[-1].time) == (0.0, times[-1])
    assert all(b.time - a.time > 0.9 * SHORTEST for a, b in pairwise(points))
    assert points[-1].velocity == points[-1].acceleration == 0.0
    assert np.isfinite(points).all()


def test_a_joint_at_the_very_beginning_does_not_bend_the_first_stretch():
    cubic = build_axis('axis', {
        'segments': ['up', 'down'], 'up.law': 'cubic', 'up.end_deg': 180.0, 'up.lift': 0.1,
        'down.law': 'cubic', 'down.end_deg': 360.0, 'down.lift': -0.1}).layout.motion
    for offset in (-1e-15, 0.0, 1e-15, 1e-4):
        shaft = ShaftMotion(0.0, ShaftState(math.pi + offset, 20.0, 0.0))
        points = look_ahead(cubic, shaft, [0.0, 0.02])
        t = 0.5 * (points[-2].time + 0.02)
        assert quintic(points[-2], points[-1], t)[0] == pytest.approx(
            cubic.sample(shaft.state(t).phi)[0], abs=1e-12)


def test_an_axis_that_stands_has_a_plain_grid():
    points = look_ahead(Standstill(0.2), shaft_ahead(ShaftState(1.0, 0.0, 0.0), 0.0, 0.1),
                        [0.0, 0.05, 0.1])
    assert [tuple(point[:4]) for point in points] == [
        (0.0, 0.2, 0.0, 0.0), (0.05, 0.2, 0.0, 0.0), (0.1, 0.2, 0.0, 0.0)]


def test_an_axis_behind_another_one_is_seen_through_it():
    outer = build_axis('axis', {
        'segments': ['up', 'down'], 'up.law': 'cycloidal', 'up.end_deg': 120.0, 'up.lift': 0.1,
        'down.law': 'cycloidal', 'down.end_deg': 360.0, 'down.lift': -0.1, 'ratio': 4.0})
    chain = Cascade(outer.layout.motion, motion_of('feeder'))
    phi = np.linspace(-3.0, 9.0, 200)
    one_by_one = np.array([chain.sample(float(x)) for x in phi]).T
    assert one_by_one == pytest.approx(chain(phi), rel=1e-9, abs=1e-9)
    # where the feeder passes a joint of the outer cam, and at its own joints
    joints = chain.joints(0.0, 3 * TURN)
    assert set(motion_of('feeder').joints(0.0, 3 * TURN)) <= set(joints)
    passed = motion_of('feeder')(joints)[0]
    for at in outer.layout.motion.joints(0.01, 0.89):
        assert np.abs(passed - at).min() < 1e-4
    assert errors(chain, steady, 50.0, 0.3)[0] < 1e-5


# The shaft ahead


def test_it_is_the_shaft_itself_while_its_jerk_lasts():
    shaft = Shaft(SPEED, RampLimits(30.0, 300.0), STOP)
    shaft.run(0.0)
    now, then = shaft.state(0.02), shaft.state(0.07)
    assert shaft_ahead(now, 300.0, 0.1).state(0.05) == pytest.approx(then, abs=1e-12)


def test_the_end_of_a_ramp_is_foreseen():
    shaft = Shaft(SPEED, RampLimits(30.0, 300.0), STOP)
    shaft.run(0.0)
    for t in (shaft.settled_at - 0.06, shaft.settled_at - 0.03):
        ahead = shaft_ahead(shaft.state(t), -300.0, 0.2)
        assert ahead.state(0.15) == pytest.approx(shaft.state(t + 0.15), abs=1e-9)
    shaft.stop(2.0)
    rest = shaft.settled_at
    ahead = shaft_ahead(shaft.state(rest - 0.05), 300.0, 0.2)
    assert ahead.state(0.15) == pytest.approx(shaft.state(rest), abs=1e-9)


@given(st.floats(-20.0, 20.0), st.floats(-60.0, 60.0), st.floats(-500.0, 500.0))
def test_it_never_turns_round(omega, alpha, jerk):
    ahead = shaft_ahead(ShaftState(0.0, omega, alpha), jerk, 0.3)
    for t in np.linspace(0.0, 0.3, 31):
        assert ahead.state(float(t)).omega * omega >= -1e-9
