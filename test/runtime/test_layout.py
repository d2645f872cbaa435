# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Couplings of cams: common cycles, speeds in any phase, and ranges of positions."""

import math

from cam_motion.motion.limits import Limits
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from cam_motion.runtime.follower import Follower
from cam_motion.runtime.follower_settings import FollowerSettings, FollowerState
from cam_motion.runtime.layout import Coupling, Layout
from cam_motion.runtime.planning import At, Timing, TransitionError
from cam_motion.units import DEGREE, TURN
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

LIFT = CamProfile([
    segment('wait', end_deg=20.0), segment('up', end_deg=80.0, lift=0.1, law='cycloidal'),
    segment('hold', end_deg=300.0), segment('down', end_deg=350.0, lift=-0.1, law='cycloidal'),
    segment('rest', end_deg=360.0)])
BELT = CamProfile([
    segment('feed', end_deg=80.0, lift=0.3, law='modified_trapezoid'),
    segment('wait', end_deg=360.0)], accumulate=True)


def layout_of(*ratios, cam=LIFT, phase=0.0):
    """Make a layout of as many cams as ratios."""
    names = tuple('abcd'[:len(ratios)])
    return Layout(dict.fromkeys(names, cam),
                  {name: Coupling(ratio, phase) for name, ratio in zip(names, ratios)}, names)


@pytest.mark.parametrize('ratios, turns', [
    ((1.0,), 1.0), ((0.5,), 2.0), ((-3.0,), 1.0 / 3.0), ((1.0, 1.5), 2.0), ((1.0, 0.7), 10.0),
    ((2.0 / 3.0, 0.5), 6.0), ((1.0, 1.0 / 7.0, 0.5), 14.0), ((1.0, math.pi), math.inf)])
def test_the_period_is_common_to_all_cams(ratios, turns):
    layout = layout_of(*ratios)
    assert layout.period == pytest.approx(turns * TURN)
    if math.isfinite(turns):
        phi = np.linspace(0.0, 20.0, 101)
        assert layout.motion(phi + layout.period) == pytest.approx(layout.motion(phi), abs=1e-9)


@pytest.mark.parametrize('ratios', [(1.0, 1.5), (1.0, 0.7), (1.0, math.pi), (1.0, 0.999)])
def test_a_sum_of_cams_keeps_its_limits_in_every_turn(ratios):
    limits = Limits(velocity=2.0, acceleration=100.0)
    layout = layout_of(*ratios)
    omega = layout.speed_bound(limits).omega
    _, slope, bend, _ = layout.motion(np.linspace(0.0, 40.0 * TURN, 400_001))
    shares = (np.abs(slope).max() * omega / 2.0, np.abs(bend).max() * omega ** 2 / 100.0)
    assert 0.9 < max(shares) <= 1.0


def test_positions_in_every_turn():
    layout_of(1.0, 1.5).check_range(Limits(lowest=-0.001, highest=0.201))
    for ratios in ((1.0, 1.5), (1.0, math.pi)):
        with pytest.raises(TransitionError, match=r'from \S+ to 0\.2, beyond'):
            layout_of(*ratios).check_range(Limits(highest=0.15))
    layout_of(1.0).check_range(Limits(lowest=5.0, highest=5.2), anywhere=True)
    with pytest.raises(TransitionError, match='takes 0.1, more than'):
        layout_of(1.0).check_range(Limits(lowest=5.0, highest=5.05), anywhere=True)
    with pytest.raises(TransitionError, match='gains 0.3 in each turn'):
        layout_of(1.0, cam=BELT).check_range(Limits(highest=1.0))


def turn(follower, start, end):
    """Turn the shaft and give the last setpoint."""
    return [follower.answer(start + (end - start) * k / 3000, 6.0, 0.0) for k in range(3001)][-1]


@pytest.mark.parametrize('ratio, phase, relative', [
    (0.5, 0.0, False), (0.5, 50.0, False), (1.0, 200.0, False), (2.0, 0.0, False),
    (1.0, 0.0, True), (-0.5, 30.0, False)])
def test_the_cycle_ends_where_the_cam_does(ratio, phase, relative):
    """With cycle_end the axis stands where its cam has come round, wherever the shaft is."""
    follower = Follower(layout_of(ratio, phase=phase * DEGREE), FollowerSettings(
        disengage=Timing(At.CYCLE_END, span=10.0 * DEGREE), master_relative=relative,
        engage=Timing(span=5.0 * DEGREE)), engaged=not relative)
    turn(follower, 2.3, 2.4)
    follower.engage()
    turn(follower, 2.4, 3.0 * TURN + 1.0)
    assert follower.state is FollowerState.IN_SYNC
    plan = follower.disengage()
    angle = ratio * (plan.blend.end - follower.layout.origin) + phase * DEGREE
    assert math.remainder(angle, TURN) == pytest.approx(0.0, abs=1e-9)
    assert turn(follower, 3.0 * TURN + 1.0, 7.0 * TURN) == (pytest.approx(0.0, abs=1e-9), 0.0, 0.0)


def test_an_axis_resumes_where_its_cam_is_again_where_it_was():
    follower = Follower(layout_of(0.5), FollowerSettings(resume=Timing(At.ANGLE)))
    held = turn(follower, 0.0, 1.2)[0]
    follower.coast()
    follower.hold(FollowerState.HELD, 'silence')
    turn(follower, TURN - 1.0, TURN)
    plan = follower.reset()
    assert plan.blend.start == pytest.approx(2.0 * TURN + 1.2)
    assert plan.blend.new.sample(plan.blend.start)[0] == pytest.approx(held)


def test_an_axis_beyond_its_limits_of_position_can_be_stopped():
    follower = Follower(layout_of(1.0, cam=BELT), FollowerSettings(Limits(highest=1.0)))
    turn(follower, 0.0, 5.0 * TURN)
    follower.disengage()
    assert turn(follower, 5.0 * TURN, 7.0 * TURN)[1:] == (0.0, 0.0)
    assert follower.state is FollowerState.DISENGAGED
