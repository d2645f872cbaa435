# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Axes that go on for ever: belts, webs and electronic gears never turn back."""

from dataclasses import replace

from cam_motion.motion.limits import Limits
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from cam_motion.runtime.follower import Follower
from cam_motion.runtime.follower_settings import FollowerSettings, FollowerState
from cam_motion.runtime.layout import Coupling, Layout
from cam_motion.runtime.planning import At, Timing
from cam_motion.units import DEGREE, TURN
import pytest

pytestmark = pytest.mark.timeout(60)

GEAR = CamProfile(
    [segment('run', end_deg=360.0, lift=1.2, law='constant_velocity')], accumulate=True)
BELT = CamProfile([
    segment('feed', end_deg=80.0, lift=0.3, law='modified_trapezoid'),
    segment('wait', end_deg=360.0)], accumulate=True)


def make(cam, engaged=True, ratio=1.0, **options):
    """Make a follower with one cam."""
    limits = Limits(velocity=8.0, acceleration=400.0)
    layout = Layout({'cam': cam}, {'cam': Coupling(ratio)}, ('cam',))
    return Follower(layout, FollowerSettings(limits, **options), engaged)


def turn(follower, start, end, speed=TURN):
    """Turn the shaft at a steady speed and give the setpoints."""
    count = max(1, round(abs(end - start) / TURN * 720))
    omega = speed if end > start else -speed
    return [follower.answer(start + (end - start) * k / count, omega, 0.0)
            for k in range(count + 1)]


def never_jumps(points, speed=TURN):
    """Check that position and velocity are the integrals of what follows them."""
    step = TURN / 720 / speed
    for (y0, v0, a0), (y1, v1, a1) in zip(points, points[1:]):
        assert abs(y1 - y0 - 0.5 * (v0 + v1) * step) < 1e-4
        assert abs(v1 - v0) < 1.5 * max(abs(a0), abs(a1)) * step + 1e-2


@pytest.mark.parametrize('sense', [1.0, -1.0])
@pytest.mark.parametrize('key, first, second', [
    ('ratio', 1.5, 1.0), ('ratio', 1.0, 1.5), ('scale', 1.0, 0.8), ('ratio', -1.0, -1.5)])
@pytest.mark.parametrize('at', [0.0, 5.0, 90.0, 180.0, 341.0])
def test_a_gear_changes_its_ratio_without_overshoot(at, key, first, second, sense):
    """Wherever it is set, the speed goes from the one to the other and nowhere else."""
    follower = make(GEAR)
    follower.layout = replace(
        follower.layout, couplings={'cam': Coupling()._replace(**{key: first})})
    follower._set_motion(follower.layout.motion)
    start = sense * (2.0 * TURN + at * DEGREE)
    points = turn(follower, 0.0, start)
    plan = follower.change(replace(
        follower.layout, couplings={'cam': Coupling()._replace(**{key: second})}))
    assert abs(plan.blend.span) == pytest.approx(90.0 * DEGREE)
    points = points[-1:] + turn(follower, start, start + sense * 2.0 * TURN)[1:]
    never_jumps(points)
    speeds = sorted((1.2 * sense * first, 1.2 * sense * second))
    velocities = [velocity for _, velocity, _ in points]
    assert speeds[0] - 1e-9 <= min(velocities) and max(velocities) <= speeds[1] + 1e-9
    assert velocities[-1] == pytest.approx(1.2 * sense * second)
    assert follower.state is FollowerState.IN_SYNC


@pytest.mark.parametrize('at', range(0, 360, 20))
@pytest.mark.parametrize('scale', [0.2, 0.6, 1.5])
def test_a_belt_changes_its_stroke_without_turning_back(at, scale):
    follower, start = make(BELT), TURN + at * DEGREE
    turn(follower, 0.0, start)
    follower.change(replace(follower.layout, couplings={'cam': Coupling(scale=scale)}))
    points = turn(follower, start, start + 3.0 * TURN)
    never_jumps(points)
    assert min(velocity for _, velocity, _ in points) > -1e-5
    stroke = points[-1][0] - points[-721][0]
    assert stroke == pytest.approx(0.3 * scale, abs=1e-12)


@pytest.mark.parametrize('at', range(0, 360, 40))
@pytest.mark.parametrize('cam', [GEAR, BELT])
def test_disengaging_slows_down_and_does_not_turn_back(cam, at):
    follower, start = make(cam), TURN + at * DEGREE
    turn(follower, 0.0, start)
    follower.disengage()
    points = turn(follower, start, start + TURN)
    never_jumps(points)
    assert follower.state is FollowerState.DISENGAGED and points[-1][1:] == (0.0, 0.0)
    assert -1e-9 < min(velocity for _, velocity, _ in points)


@pytest.mark.parametrize('sense', [1.0, -1.0])
@pytest.mark.parametrize('ratio', [1.0, -1.0, 0.5])
@pytest.mark.parametrize('cam', [GEAR, BELT])
def test_a_belt_engages_in_its_direction_of_travel(cam, ratio, sense):
    follower = make(cam, engaged=False, ratio=ratio)
    start = sense * 4.3 * TURN
    follower.answer(start, sense * TURN, 0.0)
    follower.engage()
    points = turn(follower, start, start + sense * 6.0 * TURN)
    never_jumps(points)
    assert follower.state is FollowerState.IN_SYNC
    assert min(sense * ratio * velocity for _, velocity, _ in points) > -1e-3


@pytest.mark.parametrize('at', ['now', 'cycle_end'])
@pytest.mark.parametrize('sense', [1.0, -1.0])
@pytest.mark.parametrize('ratio', [1.0, -1.0])
def test_a_belt_parks_ahead_of_where_it_is(ratio, sense, at):
    """A position to park at is meant within the stroke: the belt never runs back to it."""
    follower = make(BELT, ratio=ratio, stop_position=0.05, disengage=Timing(At(at)))
    start = sense * 6.55 * TURN
    turn(follower, 0.0, start)
    follower.disengage()
    points = turn(follower, start, start + sense * 6.0 * TURN)
    never_jumps(points)
    assert follower.state is FollowerState.DISENGAGED
    assert min(sense * ratio * velocity for _, velocity, _ in points) > -1e-9
    assert (points[-1][0] - 0.05) / 0.3 == pytest.approx(round((points[-1][0] - 0.05) / 0.3))
