# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The speed bounds of axes that follow others, and ranges of positions in a configuration."""

import math

from cam_motion.errors import ConfigurationError
from cam_motion.io.axis import build_axis
from cam_motion.io.axis_limits import axes_of, ramp_room, reach_of, speed_problems
from cam_motion.io.config import flatten
from cam_motion.runtime.follower import Follower
from cam_motion.runtime.follower_settings import FollowerState
from cam_motion.runtime.planning import TransitionError
from cam_motion.units import DEGREE, RPM, TURN
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

FEEDER = flatten({
    'cycle': 'accumulate', 'segments': ['feed', 'wait'], 'wait': {'end_deg': 360.0},
    'feed': {'law': 'modified_trapezoid', 'end_deg': 80.0, 'lift': 0.3}})
LABEL = flatten({
    'follows': 'feeder', 'segments': ['a', 'b', 'c', 'd'], 'a': {'end_deg': 200.0},
    'b': {'law': 'cycloidal', 'end_deg': 250.0, 'lift': 0.05}, 'c': {'end_deg': 300.0},
    'd': {'law': 'cycloidal', 'end_deg': 360.0, 'lift': -0.05},
    'limits': {'velocity': 1.0, 'acceleration': 50.0}})
PRESS = flatten({
    'segments': ['u', 'd'], 'u': {'law': 'cycloidal', 'end_deg': 180.0, 'lift': 0.1},
    'd': {'law': 'cycloidal', 'end_deg': 360.0, 'lift': -0.1}})


@pytest.mark.parametrize('ratio, turns', [(TURN, 10.0), (TURN / 0.3, 1.0), (20.0, None)])
def test_a_cascade_keeps_its_limits_in_every_turn_of_the_shaft(ratio, turns):
    """The follower repeats after 1 m, the feeder feeds 0.3 m a turn: after 10 turns both do."""
    axis = axes_of({'feeder': FEEDER, 'label': {**LABEL, 'ratio': ratio}})['label']
    if turns is not None:
        assert axis.period == pytest.approx(turns * TURN)
    omega = axis.speed_bound.omega
    _, slope, bend, _ = axis.motion(np.linspace(0.0, 30.0 * TURN, 600_001))
    shares = (np.abs(slope).max() * omega / 1.0, np.abs(bend).max() * omega ** 2 / 50.0)
    assert (0.9 if turns else 0.5) < max(shares) <= 1.0
    assert bool(ramp_room([axis]))
    assert speed_problems(axis, 1.01 * omega) and not speed_problems(axis, 0.99 * omega)


def test_a_cascade_behind_an_axis_that_returns_repeats_with_it():
    axis = axes_of({'feeder': PRESS, 'label': {**LABEL, 'ratio': 40.0}})['label']
    assert axis.period == pytest.approx(TURN)
    assert axis.speed_bound.omega > 10.0 * RPM


def test_positions_of_an_axis_that_engages_where_it_stands():
    relative = {**PRESS, 'engage.slave': 'relative', 'engage_at_start': False,
                'start_position': 0.5, 'limits.lowest': 0.4, 'limits.highest': 0.7}
    assert build_axis('axis', relative).limits.highest == 0.7
    for given, words in (({**relative, 'engage_at_start': True}, 'would go from'),
                         ({**relative, 'limits.highest': 0.45}, 'takes 0.1, more than'),
                         ({**FEEDER, 'limits.highest': 1.0}, 'leaves any range')):
        with pytest.raises(ConfigurationError, match=words) as caught:
            build_axis('axis', given)
        assert [problem.path for problem in caught.value.problems] == ['limits.highest']


def follower_of(axis):
    """Make a follower of an axis that stands."""
    return Follower(axis.layout, axis.settings, engaged=False)


@pytest.mark.parametrize('ratio', [31.4, TURN, 0.02])
def test_transitions_over_another_axis_count_turns_of_the_cam(ratio):
    """Whatever the unit of what is followed, 90 deg is a quarter of a turn of the cam."""
    axis = build_axis('axis', {**PRESS, 'follows': 'other', 'ratio': ratio, 'engage.at': 'angle',
                               'engage.angle_deg': 30.0})
    follower = follower_of(axis)
    follower.answer(0.01 / ratio, 1.0 / ratio, 0.0)
    plan = follower.engage()
    assert plan.blend.start * ratio == pytest.approx(30.0 * DEGREE)
    assert plan.blend.span * ratio == pytest.approx(90.0 * DEGREE)
    assert plan.text('m').startswith('over 90 deg from 30 deg')
    assert f'at {1.0 / RPM:.4g} cycles/min' in plan.text('m')


def test_a_transition_that_would_not_end_is_refused():
    """Behind an axis that turns back at 0.1 m a span must fit in what is left."""
    leader = axes_of({'leader': PRESS})['leader']
    reach = reach_of(leader)
    assert reach == (pytest.approx(0.0, abs=1e-12), pytest.approx(0.1))
    assert reach_of(axes_of({'leader': FEEDER})['leader']) == (-math.inf, math.inf)
    slow = {**PRESS, 'follows': 'leader', 'ratio': 15.0}
    follower = follower_of(build_axis('axis', slow, reach))
    follower.answer(0.06, 0.1, 0.0)
    with pytest.raises(TransitionError, match=r'between \S+ and 0.1 and turns back'):
        follower.engage()
    follower = follower_of(build_axis('axis', {**slow, 'ratio': 31.4}, reach))
    follower.answer(0.03, 0.1, 0.0)
    plan = follower.engage()
    assert plan.blend.end == pytest.approx(0.03 + 90.0 * DEGREE / 31.4)
    follower.answer(0.099, 0.01, 0.0)
    assert follower.state is FollowerState.IN_SYNC
    # what is left of the way up is too short: on the way back
    follower.answer(0.06, 0.1, 0.0)
    assert follower.disengage().blend.end == pytest.approx(0.06 - 90.0 * DEGREE / 31.4)
    for position, velocity in ((0.08, 0.1), (0.1, 0.0), (0.06, -0.1), (0.05, -0.1), (0.0, 0.0)):
        follower.answer(position, velocity, 0.0)
    assert follower.state is FollowerState.DISENGAGED
