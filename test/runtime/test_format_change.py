# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A follower changes its format at an exact shaft angle, and never jumps, whatever happens."""

from dataclasses import replace
import math

from cam_motion.io.axis import build_axis
from cam_motion.runtime.follower_settings import FollowerState
from cam_motion.runtime.format_change import Format, FormatFollower
from cam_motion.runtime.planning import TransitionError
from cam_motion.units import DEGREE, RPM, TURN
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

PRESS = {
    'segments': ['wait', 'down', 'up'], 'wait.end_deg': 60.0,
    'down.law': 'cycloidal', 'down.end_deg': 180.0, 'down.lift': 0.05,
    'up.law': 'modified_trapezoid', 'up.end_deg': 360.0, 'up.lift': -0.05,
    'limits.velocity': 2.0, 'limits.acceleration': 60.0, 'limits.lowest': -0.01,
}
SHORT = {**PRESS, 'down.lift': 0.03, 'up.lift': -0.03, 'phase_deg': 10.0}
BELT = {'cycle': 'accumulate', 'segments': ['feed', 'wait'], 'feed.law': 'modified_trapezoid',
        'feed.end_deg': 80.0, 'feed.lift': 0.3, 'wait.end_deg': 360.0}
STEP = 0.01  # rad of the shaft from point to point


def follower(given=PRESS, phi=1.0, speed=60.0, engaged=True):
    """Make a follower that has heard a steady shaft."""
    axis = build_axis('axis', given)
    made = FormatFollower(axis.layout, axis.settings, engaged)
    made.answer(phi, speed * RPM, 0.0)
    return made


def new_format(given=SHORT, at=40.0, span=90.0, **settings):
    axis = build_axis('axis', {**given, **settings})
    return Format(axis.layout, axis.settings, at * DEGREE, span * DEGREE)


def turned(made, start, end, speed=60.0):
    """Turn the shaft from angle to angle; give angles and positions."""
    phi = np.arange(start, end, math.copysign(STEP, end - start))
    omega = math.copysign(speed, end - start) * RPM
    return phi, np.array([made.answer(float(at), omega, 0.0)[0] for at in phi])


def test_the_transition_goes_over_exactly_the_angles_agreed_upon():
    made, new = follower(), new_format()
    old = made.layout.motion
    plan = made.check_format(new)
    assert plan is not None and made.plan is None and made.scheduled is None
    start = TURN + 40.0 * DEGREE
    plan = made.schedule(new, start)
    assert (plan.blend.start, plan.blend.span) == (start, pytest.approx(90.0 * DEGREE))
    phi, y = turned(made, 1.0, start)
    assert np.array_equal(y, [old.sample(float(at))[0] for at in phi])
    assert made.state is FollowerState.IN_SYNC and made.layout.motion == old
    turned(made, start + 1e-6, start + 90.0 * DEGREE)
    assert made.state is FollowerState.CHANGING and made.settings is new.settings
    phi, y = turned(made, start + 90.0 * DEGREE + 1e-6, start + 7.0)
    assert made.state is FollowerState.IN_SYNC and made.plan is None
    assert np.array_equal(y, [new.layout.motion.sample(float(at))[0] for at in phi])


@pytest.mark.parametrize('sense', [1.0, -1.0])
def test_nothing_jumps_whichever_way_the_shaft_turns(sense):
    made, new = follower(speed=60.0 * sense), new_format()
    taken = []
    made.on_taken = lambda: taken.append(made.layout)
    made.schedule(new, 40.0 * DEGREE + sense * TURN)
    _, y = turned(made, 1.0, 1.0 + sense * 3.0 * TURN)
    assert np.max(np.abs(np.diff(y))) <= 2.0 * STEP / (60.0 * RPM)
    assert made.state is FollowerState.IN_SYNC and taken == [new.layout]


@pytest.mark.parametrize(('changes', 'speed', 'words'), [
    ({'down.lift': 0.9, 'up.lift': -0.9}, 60.0, 'slow down first'),
    ({'offset': 0.1}, 60.0, 'slow down, or allow a longer span'),
    ({'offset': 0.01, 'limits.lowest': 0.005}, 20.0, 'beyond the limits of position'),
])
def test_what_does_not_keep_the_limits_is_refused_and_changes_nothing(changes, speed, words):
    made = follower(speed=speed)
    before = (made.layout, made.settings, made.plan, made.sample, made.speed_bound)
    with pytest.raises(TransitionError, match=words):
        made.check_format(new_format({**PRESS, **changes}, span=30.0))
    assert (made.layout, made.settings, made.plan, made.sample, made.speed_bound) == before


def test_a_shaft_that_became_too_fast_is_slowed_down_and_nobody_drops_out():
    made, new = follower(), new_format({**PRESS, 'phase_deg': 180.0}, span=120.0)
    agreed = made.check_format(new)
    fast = 1.2 * agreed.highest_speed
    made.answer(1.1, fast, 0.0)
    with pytest.raises(TransitionError):
        made.check_format(new)
    plan = made.schedule(new, TURN + 40.0 * DEGREE)
    assert plan.blend.span == agreed.blend.span
    assert made.speed_bound.omega == pytest.approx(plan.highest_speed) and (
        made.speed_bound.omega < fast)


def test_until_the_change_the_old_limits_hold_and_from_its_schedule_on_the_new_ones_too():
    made = follower()
    now = made.speed_bound.omega
    slower = new_format({**PRESS, 'limits.velocity': 0.2})
    faster = new_format({**PRESS, 'limits.velocity': 20.0, 'limits.acceleration': 900.0})
    made.schedule(faster, TURN + 1.0)
    assert made.speed_bound.omega == now
    turned(made, 1.0, 3.0 * TURN)
    assert made.speed_bound.omega > now
    made.schedule(slower, 4.0 * TURN)
    assert made.speed_bound.omega < now


def test_revoked_it_is_as_if_it_had_never_been():
    made, new = follower(), new_format()
    before = (made.layout, made.settings, made.speed_bound)
    made.schedule(new, TURN)
    assert made.revoke() and not made.revoke()
    assert (made.layout, made.settings, made.speed_bound) == before
    phi, y = turned(made, 1.0, 3.0 * TURN)
    assert np.array_equal(y, [before[0].motion.sample(float(at))[0] for at in phi])


def test_an_axis_that_stands_takes_the_format_over_at_the_angle_too():
    made, new = follower({**PRESS, 'engage_at_start': False}, engaged=False), new_format()
    assert made.check_format(new) is None and made.schedule(new, TURN) is None
    turned(made, 1.0, TURN - 0.02)
    assert made.layout.couplings['cam'].phase == 0.0
    turned(made, TURN - 0.02, TURN + 0.1)
    assert made.layout.couplings['cam'].phase == pytest.approx(10.0 * DEGREE)
    assert made.state is FollowerState.DISENGAGED


def test_an_axis_held_before_the_angle_comes_back_with_the_format():
    made, new = follower(), new_format()
    made.schedule(new, TURN)
    made.hold(FollowerState.HELD, 'the shaft fell silent')
    assert made.scheduled is not None and made.layout != new.layout
    y = made.answer(1.5, 0.0, 0.0)[0]
    made.reset()
    assert made.scheduled is None and made.settings is new.settings
    made.answer(1.5, 60.0 * RPM, 0.0)
    _, positions = turned(made, 1.5, 20.0)
    assert positions[0] == pytest.approx(y) and made.state is FollowerState.IN_SYNC
    assert made.layout.couplings == new.layout.couplings


def test_an_angle_that_has_been_passed_means_now():
    made, new = follower(phi=5.0), new_format()
    assert made.schedule(new, 4.0).blend.start == 5.0


def test_a_belt_goes_on_from_where_it_stands():
    short = {**BELT, 'feed.lift': 0.2}
    made = follower(BELT, phi=5.0 * TURN)
    made.schedule(new_format(short, at=100.0), 7.0 * TURN + 100.0 * DEGREE)
    phi, y = turned(made, 5.0 * TURN, 9.0 * TURN)
    assert np.min(np.diff(y)) >= -1e-12  # it never creeps back
    ends = [y[np.searchsorted(phi, k * TURN) - 1] for k in (6, 7, 8, 9)]
    assert np.diff(ends) == pytest.approx([0.3, 0.3, 0.2], abs=1e-9)


def test_one_that_is_in_the_middle_of_something_refuses():
    made, new = follower(), new_format()
    made.change(replace(made.layout, couplings=new.layout.couplings))
    with pytest.raises(TransitionError, match='is in_sync|changing'):
        made.check_format(new)
    made = follower()
    made.schedule(new, TURN)
    with pytest.raises(TransitionError, match='scheduled already'):
        made.check_format(new)
