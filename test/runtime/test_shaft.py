# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The master shaft: whatever is commanded and whenever, it moves smoothly and within limits."""

import math

from cam_motion.runtime.ramp import RampLimits, RampStep
from cam_motion.runtime.shaft import Shaft, ShaftError, ShaftMode
from cam_motion.runtime.shaft_motion import ShaftMotion, ShaftState
from cam_motion.units import TURN
from hypothesis import given
from hypothesis import strategies as st
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-9
AT_CYCLE_END = 1e-8  # rad; an end this near counts as reached
LIMITS = RampLimits(12.0, 80.0)
QUICK = RampLimits(60.0, 900.0)
STOPS = (ShaftMode.STOPPED, ShaftMode.QUICK_STOPPED)

pauses = st.integers(0, 1500).map(lambda n: n / 1000.0)
speeds = st.integers(-250, 250).map(lambda n: n / 10.0)
commands = st.lists(st.tuples(pauses, st.one_of(
    st.just(('run',)), st.just(('stop',)), st.just(('quick_stop',)),
    st.just(('stop_at_cycle_end',)), st.just(('reset',)),
    st.tuples(st.just('set_speed'), speeds),
)), max_size=12)


def make(speed=20.0, phi=0.0):
    """Make a shaft with the limits of these tests."""
    return Shaft(speed, LIMITS, QUICK, phi)


def instants(begin, end, count=60):
    """Give equally spaced times, both ends included."""
    return [begin + (end - begin) * k / count for k in range(count + 1)]


def check_motion(shaft, begin, end):
    """Check limits, and that each quantity is the integral of the next."""
    if end <= begin:
        return
    quick = shaft.mode(begin) in (ShaftMode.QUICK_STOPPING, ShaftMode.QUICK_STOPPED)
    bounds = QUICK if quick else LIMITS
    times = instants(begin, end)
    states = [shaft.state(t) for t in times]
    for t, u, one, two in zip(times, times[1:], states, states[1:]):
        h = u - t
        slack = ROUNDING * (1.0 + abs(two.phi))
        assert abs(two.alpha) <= bounds.acceleration * (1.0 + ROUNDING)
        assert abs(two.alpha - one.alpha) <= bounds.jerk * h + slack
        # the trapezoidal rule errs by at most h²/4 and h³/12 of the jerk
        assert abs(two.omega - one.omega - 0.5 * h * (one.alpha + two.alpha)) <= (
            bounds.jerk * h * h / 4.0 + slack)
        assert abs(two.phi - one.phi - 0.5 * h * (one.omega + two.omega)) <= (
            bounds.jerk * h**3 / 12.0 + slack + AT_CYCLE_END)


@given(commands)
def test_any_sequence_of_commands_moves_smoothly_within_the_limits(sequence):
    shaft, t = make(), 0.0
    for pause, (name, *arguments) in sequence:
        check_motion(shaft, t, t + pause)
        t += pause
        before = shaft.state(t)
        try:
            getattr(shaft, name)(t, *arguments)
        except ShaftError:
            assert name in ('run', 'stop_at_cycle_end', 'reset')
        after = shaft.state(t)
        assert after == pytest.approx(before, rel=0, abs=AT_CYCLE_END)
    check_motion(shaft, t, max(t, shaft.settled_at) + 1.0)
    end = shaft.settled_at + 10.0
    state, mode = shaft.state(end), shaft.mode(end)
    assert state.alpha == 0.0
    assert state.omega == (shaft.speed if mode is ShaftMode.RUNNING else 0.0)
    assert mode is ShaftMode.RUNNING or mode in STOPS


@given(commands, pauses)
def test_asking_for_the_state_changes_nothing(sequence, pause):
    asked, left_alone, t = make(), make(), 0.0
    for wait, (name, *arguments) in sequence:
        for between in instants(t, t + wait, 3):
            asked.state(between)
            asked.mode(between)
        t += wait
        for shaft in (asked, left_alone):
            try:
                getattr(shaft, name)(t, *arguments)
            except ShaftError:
                pass
    assert asked.state(t + pause) == left_alone.state(t + pause)
    assert asked.mode(t + pause) is left_alone.mode(t + pause)


@given(st.integers(1, 250), st.sampled_from([1, -1]), pauses, pauses,
       st.integers(0, 250), st.integers(-1000, 1000))
def test_a_stop_at_cycle_end_is_exact_and_never_reverses_and_is_the_first(
        tenths, sense, pause, later, other_tenths, start):
    shaft = make(sense * other_tenths / 10.0, start / 7.0)
    shaft.run(0.0)
    shaft.set_speed(pause, sense * tenths / 10.0)
    t = pause + later
    # where it would come to rest if it braked as soon as it has reached its speed
    other = make(sense * other_tenths / 10.0, start / 7.0)
    other.run(0.0)
    other.set_speed(pause, sense * tenths / 10.0)
    other.stop(max(t, other.settled_at))
    soonest = other.state(other.settled_at).phi

    shaft.stop_at_cycle_end(t)
    assert shaft.mode(t) is ShaftMode.STOPPING_AT_CYCLE_END
    phi, omega, alpha = shaft.state(shaft.settled_at)
    assert (omega, alpha) == (0.0, 0.0)
    assert phi == round(phi / TURN) * TURN
    assert -AT_CYCLE_END <= sense * (phi - soonest) <= TURN - AT_CYCLE_END / 10.0
    for at in instants(t, shaft.settled_at, 100):
        assert sense * shaft.state(at).omega >= -ROUNDING
    assert shaft.mode(shaft.settled_at) is ShaftMode.STOPPED
    assert shaft.state(shaft.settled_at + 100.0).phi == phi


def test_the_stop_is_exact_after_a_million_cycles():
    shaft = make(20.0)
    shaft.run(0.0)
    t = 1e6 * TURN / 20.0
    shaft.stop_at_cycle_end(t)
    turns = shaft.state(shaft.settled_at).phi / TURN
    assert turns == round(turns) and turns > 999_990


def test_it_can_run_on_while_it_stops_at_the_cycle_end():
    shaft = make()
    shaft.run(0.0)
    shaft.stop_at_cycle_end(5.0)
    shaft.stop_at_cycle_end(5.1)  # asked again: the same stop
    shaft.run(shaft.settled_at - 0.2)
    assert shaft.mode(6.0) is ShaftMode.RUNNING
    assert shaft.state(60.0).omega == 20.0


@pytest.mark.parametrize('when', [0.0, 0.3, 2.0, 5.0])
def test_a_quick_stop_is_latched_until_it_is_reset(when):
    shaft = make()
    shaft.run(0.0)
    shaft.quick_stop(when)
    ended = shaft.settled_at
    if ended > when:
        with pytest.raises(ShaftError, match='still turning'):
            shaft.reset(when)
    for t in (when, ended, ended + 100.0):
        with pytest.raises(ShaftError, match='reset it before it runs'):
            shaft.run(t)
        shaft.stop(t)
        shaft.quick_stop(t)
        shaft.set_speed(t, 5.0)
        assert shaft.settled_at == ended
    assert shaft.mode(ended) is ShaftMode.QUICK_STOPPED
    shaft.reset(ended + 1.0)
    assert shaft.mode(ended + 1.0) is ShaftMode.STOPPED
    shaft.run(ended + 2.0)
    assert shaft.state(ended + 60.0).omega == 5.0


def test_a_quick_stop_is_quicker_than_a_stop():
    ends = []
    for name in ('stop', 'quick_stop'):
        shaft = make()
        shaft.run(0.0)
        getattr(shaft, name)(10.0)
        ends.append(shaft.settled_at)
    assert ends[1] - 10.0 < 0.3 * (ends[0] - 10.0)


def test_what_the_shaft_cannot_do_is_refused_and_changes_nothing():
    shaft = make()
    for bad in (math.nan, math.inf, -math.inf):
        with pytest.raises(ShaftError, match='finite number'):
            shaft.set_speed(0.0, bad)
    assert shaft.speed == 20.0
    with pytest.raises(ShaftError, match='stopped'):
        shaft.stop_at_cycle_end(0.0)
    shaft.run(0.0)
    shaft.stop(1.0)
    with pytest.raises(ShaftError, match='stopping'):
        shaft.stop_at_cycle_end(1.1)
    shaft.reset(1.2)  # nothing to acknowledge
    assert shaft.mode(1.2) is ShaftMode.STOPPING
    still = make(0.0)
    still.run(0.0)
    with pytest.raises(ShaftError, match='not running'):
        still.stop_at_cycle_end(1.0)


def test_a_resting_shaft_takes_a_new_speed_without_moving():
    shaft = make(phi=1.25)
    shaft.set_speed(1.0, 9.0)
    assert shaft.state(50.0) == (1.25, 0.0, 0.0)
    assert shaft.mode(50.0) is ShaftMode.STOPPED
    shaft.run(50.0)
    assert shaft.mode(50.0) is ShaftMode.RUNNING
    assert shaft.state(60.0).omega == 9.0


def test_the_angle_is_computed_and_never_summed():
    shaft = make()
    shaft.run(0.0)
    start = shaft.state(shaft.settled_at)
    for hours in (1, 24, 1000):
        t = shaft.settled_at + 3600.0 * hours
        assert shaft.state(t).phi == pytest.approx(
            start.phi + 20.0 * (t - shaft.settled_at), rel=4e-16)


def test_a_shaft_made_at_rest_has_the_same_settings_and_none_of_the_motion():
    shaft = make()
    shaft.run(0.0)
    fresh = shaft.at_rest(3.0)
    assert fresh.state(5.0) == (3.0, 0.0, 0.0)
    assert (fresh.speed, fresh.limits, fresh.quick_limits) == (20.0, LIMITS, QUICK)
    assert shaft.state(60.0).omega == 20.0


def test_a_motion_continues_behind_its_last_step_and_leaves_the_first_one_as_it_was():
    motion = ShaftMotion(1.0, ShaftState(0.0, 0.0, 0.0)).ramped(1.0, 4.0, LIMITS)
    before, ended = motion.final, motion.settled_at
    longer = motion.continued([RampStep(0.5, 0.0), RampStep(0.0, 9.0)], ShaftState(50.0, 0.0, 0.0))
    assert longer.settled_at == ended + 0.5
    assert longer.state(0.5 * (1.0 + ended)) == motion.state(0.5 * (1.0 + ended))
    assert longer.state(ended + 0.25) == motion.state(ended + 0.25)
    assert longer.state(ended + 9.0) == longer.final == (50.0, 0.0, 0.0)
    assert motion.final == before and motion.settled_at == ended


@pytest.mark.parametrize('wait', [0.1, 0.3, 0.5, 0.62, 0.7])
def test_a_stop_at_cycle_end_obeys_a_lower_speed(wait):
    """Whenever the axes allow less, the shaft slows down, and stops at an end all the same."""
    shaft = make()
    shaft.run(0.0)
    begin = shaft.settled_at
    shaft.stop_at_cycle_end(begin)
    t = begin + wait * (shaft.settled_at - begin)
    before = shaft.state(t).omega
    shaft.allow(t, 8.0)
    assert shaft.mode(t) is ShaftMode.STOPPING_AT_CYCLE_END
    check_motion(shaft, t, shaft.settled_at)
    slowed = max(0.0, before - 8.0) / LIMITS.acceleration + LIMITS.acceleration / LIMITS.jerk + 0.2
    assert all(shaft.state(u).omega <= 8.0 for u in instants(t + slowed, shaft.settled_at))
    end = shaft.state(shaft.settled_at)
    assert end.omega == 0.0 and abs(math.remainder(end.phi, TURN)) < AT_CYCLE_END
    shaft.allow(t, 100.0)
    assert shaft.settled_at - t < 60.0


def test_a_stop_at_cycle_end_stops_at_once_where_no_speed_is_allowed():
    shaft = make()
    shaft.run(0.0)
    t = shaft.settled_at
    shaft.stop_at_cycle_end(t)
    shaft.allow(t, 0.0)
    assert shaft.mode(t) is ShaftMode.STOPPING
