# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Ramps of the shaft that keep the limits of all axes, as long as they last."""

from cam_motion.motion.limits import Limits
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from cam_motion.runtime.demand import Demand
from cam_motion.runtime.motion_over_angle import CoupledCam
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.ramp_room import RampRoom
from cam_motion.runtime.shaft import Shaft, ShaftError, ShaftMode
from cam_motion.units import TURN
from hypothesis import example, given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

RAMP = RampLimits(30.0, 300.0)
SLACK = 1e-3  # the points of a demand miss up to this share of a peak
CAM = CoupledCam(CamProfile([
    segment('up', end_deg=120.0, lift=0.2, law='cycloidal'),
    segment('down', end_deg=300.0, lift=-0.2, law='cycloidal'),
    segment('rest', end_deg=360.0)]))
TURNING = Demand(CAM, 0.0, TURN)
PEAKS = TURNING.peaks(1.0, RampLimits(0.0, 0.0))


def worst(shaft, begin, end, slowest=0.0):
    """Give the largest share of acceleration and jerk that a ramp takes, at any cam angle."""
    _, y1, y2, y3 = Demand(CAM, 0.0, TURN).values
    found = []
    for t in np.linspace(begin, end, 400):
        state, later = shaft.state(t), shaft.state(t + 1e-6)
        assert slowest - 1e-9 <= state.omega <= shaft.allowed  # no ramp swings beyond its speeds
        omega, alpha = abs(state.omega), abs(state.alpha)
        jerk = abs(later.alpha - state.alpha) / 1e-6
        found.append((np.max(y2 * omega ** 2 + y1 * alpha),
                      np.max(y3 * omega ** 3 + 3.0 * y2 * omega * alpha + y1 * jerk)))
    return np.max(found, axis=0)


# an acceleration under way, and a command that softens the ramp, as found by chance
@example(5.0, 0.0, False, [(1.0 / 3.0, 0.5), (0.125, 0.0)])
@given(st.floats(5.0, 25.0), st.sampled_from([0.0, 1e-3, 0.02, 0.5]), st.booleans(),
       st.lists(st.tuples(st.floats(0.02, 2.0), st.floats(0.0, 1.0)), max_size=3))
@settings(max_examples=30, deadline=None)
def test_no_axis_breaks_its_limits_on_any_ramp(omega, room, with_jerk, changes):
    """From rest up to the highest speed allowed, and through changes of speed on the way."""
    limits = Limits(acceleration=PEAKS.acceleration * omega ** 2 * (1.0 + room),
                    jerk=PEAKS.jerk * omega ** 3 * (1.0 + room) if with_jerk else None)
    shaft = Shaft(omega, RAMP, RAMP)
    shaft.room = RampRoom([(TURNING, limits)])
    shaft.allow(0.0, omega)
    t = 0.0
    shaft.run(t)
    for wait, share in [*changes, (0.0, 1.0)]:
        check(shaft, t, t + wait, limits)
        t += wait
        shaft.set_speed(t, share * omega)
    check(shaft, t, min(shaft.settled_at, t + 60.0), limits)
    t = shaft.settled_at
    shaft.stop(t)
    check(shaft, t, min(shaft.settled_at, t + 60.0), limits)


def check(shaft, begin, end, limits, slowest=0.0):
    """Check a stretch of time."""
    if end <= begin:
        return
    acceleration, jerk = worst(shaft, begin, end, slowest)
    assert acceleration <= limits.acceleration * (1.0 + SLACK)
    assert limits.jerk is None or jerk <= limits.jerk * (1.0 + 5.0 * SLACK)


def test_a_shaft_too_fast_for_its_axes_is_not_slowed_down_forever():
    shaft = Shaft(20.0, RAMP, RAMP)
    shaft.run(0.0)
    t = shaft.settled_at + 1.0
    bound = 10.0
    shaft.room = RampRoom([(TURNING, Limits(acceleration=PEAKS.acceleration * bound ** 2))])
    shaft.allow(t, bound)
    assert shaft.settled_at - t < 3.0
    assert shaft.state(shaft.settled_at).omega == shaft.target < bound


def test_without_need_nothing_is_softened():
    """Limits with room leave the ramp as it was asked for; tight ones make it gentler."""
    wide = RampRoom([(TURNING, Limits(acceleration=1e4))])
    assert wide.soften(20.0, RAMP) == RAMP
    tight = RampRoom([(TURNING, Limits(acceleration=PEAKS.acceleration * 400.0 * 1.0005))])
    softer = tight.soften(20.0, RAMP)
    assert softer.jerk < RAMP.jerk
    assert softer.acceleration <= RAMP.acceleration


@pytest.mark.parametrize('omega, longest', [(5.0, 4.0), (10.0, 2.0), (20.0, 1.2)])
def test_a_shaft_at_the_very_limit_of_its_axes_starts_and_stops_in_reasonable_time(omega, longest):
    """A slow machine too: what the limits of its axes leave is used up, not a share of it."""
    shaft = Shaft(2.0 * omega, RAMP, RAMP)
    shaft.room = RampRoom([(TURNING, Limits(
        acceleration=PEAKS.acceleration * omega ** 2, jerk=PEAKS.jerk * omega ** 3))])
    shaft.allow(0.0, omega)
    shaft.run(0.0)
    assert shaft.settled_at < longest * 1.6
    t = shaft.settled_at
    shaft.stop(t)
    assert shaft.settled_at - t < longest * 1.6


def test_with_no_room_left_at_its_speed_a_shaft_still_stops_in_reasonable_time():
    """The limits have come down to just above the speed at which it runs."""
    shaft = Shaft(10.0, RAMP, RAMP)
    shaft.run(0.0)
    t = shaft.settled_at + 1.0
    shaft.make_room(t, RampRoom([(TURNING, Limits(
        acceleration=PEAKS.acceleration * 100.0 * (1.0 + 1e-7)))]))
    shaft.stop(t)
    assert shaft.settled_at - t < 5.0


def test_other_room_softens_the_ramp_under_way_and_leaves_a_steady_shaft_alone():
    shaft = Shaft(20.0, RAMP, RAMP)
    shaft.run(0.0)
    quick = shaft.settled_at
    tight = RampRoom([(TURNING, Limits(acceleration=PEAKS.acceleration * 400.0 * 1.0005))])
    shaft.make_room(0.3 * quick, tight)
    assert shaft.settled_at > 1.1 * quick
    steady = shaft.settled_at
    shaft.make_room(steady + 1.0, None)
    assert shaft.settled_at == steady


# a stop, then another speed while it brakes: nothing fits that begins with this acceleration
@example(5.75, 0.0, True, [(8.0, 'set_speed', -0.14), (1e-9, 'stop', 0.0),
                           (0.42, 'set_speed', 0.1), (0.021, 'run', 0.0),
                           (0.052, 'set_speed', 1.0)])
# a speed so small that its reciprocal overflows
@example(5.0, 0.0, True, [(0.0, 'set_speed', 2.2250738585e-313)])
@given(st.floats(5.0, 25.0), st.sampled_from([0.0, 1e-3, 0.02]), st.booleans(),
       st.lists(st.tuples(
           st.one_of(st.sampled_from([0.0, 1e-9, 2e-3, 8.0]), st.floats(0.0, 1.0)),
           st.sampled_from(['set_speed', 'set_speed', 'run', 'stop', 'stop_at_cycle_end']),
           st.floats(-1.0, 1.0)), max_size=6))
@settings(max_examples=40, deadline=None)
def test_no_command_on_a_softened_ramp_breaks_a_limit_or_takes_for_ever(
        omega, room, with_jerk, sequence):
    limits = Limits(acceleration=PEAKS.acceleration * omega ** 2 * (1.0 + room),
                    jerk=PEAKS.jerk * omega ** 3 * (1.0 + room) if with_jerk else None)
    shaft = Shaft(omega, RAMP, RAMP)
    shaft.room = RampRoom([(TURNING, limits)])
    shaft.allow(0.0, omega)
    shaft.run(0.0)
    plain, t = shaft.settled_at, 0.0
    for wait, name, share in sequence:
        check(shaft, t, t + wait, limits, -omega)
        t += wait
        before = shaft.state(t)
        try:
            getattr(shaft, name)(t, *([share * omega] if name == 'set_speed' else []))
        except ShaftError:
            continue
        assert shaft.state(t) == pytest.approx(before, abs=1e-9)
        if shaft.mode(t) is not ShaftMode.STOPPING_AT_CYCLE_END:
            assert shaft.settled_at - t < 2.5 * plain + 1.0
    check(shaft, t, min(shaft.settled_at, t + 60.0), limits, -omega)
