# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Telling one shaft from another, lost ticks from another rate, silence from rest."""

from dataclasses import replace

from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from cam_motion.runtime.coasting import Coasting, stop_of_axis
from cam_motion.runtime.follower_settings import FollowerState
from cam_motion.runtime.motion_over_angle import CoupledCam
from cam_motion.runtime.plausibility import AxisPlausibility
from cam_motion.runtime.point import Point
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.runtime.watchdog import ShaftWatch
from hypothesis import given, settings
from hypothesis import strategies as st
import pytest

pytestmark = pytest.mark.timeout(60)

PERIOD_NS = 2_000_000
RAMP = RampLimits(150.0, 3000.0)


def point_of(shaft, k, start_ns=0):
    """Give tick k of a shaft."""
    time_ns = start_ns + k * PERIOD_NS
    return Point(*shaft.state(k * PERIOD_NS * 1e-9), *divmod(time_ns, 10**9))


def running(speed=20.0):
    """Make a shaft that ramps up from rest."""
    shaft = Shaft(speed, RAMP, RAMP)
    shaft.run(0.0)
    return shaft


@given(st.floats(-40.0, 40.0), st.lists(st.integers(1, 20), min_size=20, max_size=200))
def test_a_shaft_that_ramps_is_one_shaft_however_many_ticks_are_lost(speed, gaps):
    shaft, watch, k = running(speed), ShaftWatch(0.2), 0
    for step in [1] * 10 + gaps:
        k += step
        assert watch.note(point_of(shaft, k), k * 0.002)
    assert watch.known and watch.refused == 0


def test_lost_ticks_are_counted_and_another_rate_is_learnt():
    shaft, watch = running(), ShaftWatch(0.2)
    for k in [*range(100), 105, *range(106, 200)]:
        watch.note(point_of(shaft, k), 0.0)
    assert (watch.missed, round(watch.period, 9)) == (5, 0.002)
    for k in range(200, 400, 4):
        watch.note(point_of(shaft, k), 0.0)
    assert round(watch.period, 9) == 0.008


@pytest.mark.parametrize('phi, omega, ns', [
    (3.0, 20.0, 0), (0.0, 0.0, 0), (0.0, 20.0, 5 * 10**9), (1.0, 1.0, -10**9)])
def test_points_of_another_shaft_are_refused(phi, omega, ns):
    shaft, watch = running(), ShaftWatch(0.2)
    for k in range(500):
        watch.note(point_of(shaft, k), k * 0.002)
    last = watch.last
    time_ns = last.sec * 10**9 + last.nanosec + PERIOD_NS + ns
    alien = Point(last.position + phi - (0.0 if ns else 0.3), omega, 0.0, *divmod(time_ns, 10**9))
    assert not watch.note(alien, 1.0)
    assert (watch.refused, watch.astray) == (1, 1) and 'deg' in watch.reason
    assert watch.last is last
    assert watch.note(point_of(shaft, 500), 1.0)
    assert watch.astray == 0


@pytest.mark.parametrize('later_ns', [0, PERIOD_NS])
def test_a_shaft_that_stops_dead_is_not_followed_into_standstill(later_ns):
    shaft, watch = running(), ShaftWatch(0.2)
    for k in range(500):
        watch.note(point_of(shaft, k), k * 0.002)
    last = watch.last
    dead = Point(last.position, 0.0, 0.0, *divmod(
        last.sec * 10**9 + last.nanosec + later_ns, 10**9))
    assert not watch.note(dead, 1.0)
    assert watch.lost(2.0)


def test_before_it_is_known_any_shaft_will_do():
    watch = ShaftWatch(0.2)
    for k, phi in enumerate((1.0, 5.0, -3.0, 100.0)):
        assert watch.note(Point(phi, 2.0, 0.0, k, 0), 0.0)
    assert not watch.known
    assert not watch.lost(1e3)


def test_silence_is_no_harm_to_a_shaft_that_stands():
    standing, turning = ShaftWatch(0.2), ShaftWatch(0.2)
    shaft = running()
    for k in range(10):
        standing.note(Point(1.0, 0.0, 0.0, 0, k * PERIOD_NS), 0.0)
        turning.note(point_of(shaft, k), 0.0)
    assert not standing.lost(100.0)
    assert turning.lost(0.21) and not turning.lost(0.19)
    # but something else heard meanwhile is: the shaft has gone elsewhere
    assert not standing.note(Point(2.0, 0.0, 0.0, 1, 0), 0.1)
    assert standing.lost(0.31)
    # the same angle on a time base begun anew is the same shaft
    assert standing.note(Point(1.0, 0.0, 0.0, 0, 0), 0.2)


@given(st.floats(-40.0, 40.0), st.integers(5, 300), st.floats(0.05, 0.4), st.floats(0.05, 0.4))
def test_all_that_had_the_same_last_point_come_to_rest_together(speed, ticks, one, two):
    """Whenever each notices the silence, the points are the same, on the grid, to exact rest."""
    shaft = running(speed)
    last = point_of(shaft, ticks)

    def stop(noticed):
        coasting = Coasting(last, 0.002, 7.0, RAMP, 'silence', FollowerState.HELD)
        found, now = list(coasting.due(7.0 + noticed)), noticed
        while not coasting.over:
            now += 0.0031
            found += coasting.due(7.0 + now)
        return found
    points = stop(one)
    assert points == stop(two)
    times = [p.sec * 10**9 + p.nanosec for p in (last, *points)]
    assert {b - a for a, b in zip(times, times[1:])} == {PERIOD_NS}
    assert points[-1][1:3] == (0.0, 0.0)
    for a, b in zip([last, *points], points):
        assert abs(b.velocity - a.velocity) <= 150.0 * 0.002 * (1.0 + 1e-9)


FEEDER = CoupledCam(CamProfile([
    segment('feed', end_deg=80.0, lift=0.3, law='modified_trapezoid'),
    segment('wait', end_deg=360.0)], accumulate=True))


def setpoints_of(scale, speed, ticks):
    """Give the setpoints of a feeder whose unit is 1/scale metres, while the shaft starts."""
    shaft, axis, found = running(speed), replace(FEEDER, scale=scale), []
    for k in range(ticks):
        _, omega, alpha, *time = point_of(shaft, k)
        y, slope, bend, _ = axis.sample(point_of(shaft, k).position)
        found.append(Point(y, slope * omega, bend * omega ** 2 + slope * alpha, *time))
    return found


@pytest.mark.parametrize('scale', [1e-3, 1.0, 1e3, -1e6])
@given(st.floats(1.0, 40.0), st.lists(st.integers(1, 8), max_size=150))
@settings(max_examples=20, deadline=None)
def test_an_axis_is_known_by_its_setpoints_whatever_its_unit(scale, speed, gaps):
    """A feeder in mm is the same as one in m: none of its setpoints is taken for another's."""
    watch, points = ShaftWatch(0.2, AxisPlausibility()), setpoints_of(scale, speed, 1400)
    k = 300
    assert all(watch.note(point, 0.0) for point in points[:k])
    for step in [*gaps, *[1] * 100]:
        k = min(k + step, len(points) - 1)
        if points[k] is not watch.last:
            assert watch.note(points[k], 0.0), watch.reason
    assert watch.known and watch.refused == 0


@pytest.mark.parametrize('scale', [1e-3, 1.0, 1e3, 1e6])
def test_what_an_axis_cannot_do_is_refused_whatever_its_unit(scale):
    points = setpoints_of(scale, 20.0, 1400)
    # in the middle of a feed, where it is fastest
    k = max(range(1000, 1400), key=lambda k: abs(points[k].velocity))
    last, then = points[k - 1], points[k]
    for alien in (then._replace(position=then.position + 0.01 * scale),
                  then._replace(position=last.position, velocity=0.0, acceleration=0.0),
                  then._replace(position=0.0, velocity=0.0, acceleration=0.0)):
        watch = ShaftWatch(0.2, AxisPlausibility())
        assert all(watch.note(point, 0.0) for point in points[:k])
        assert not watch.note(alien, 0.0)
        assert 'deg' not in watch.reason and watch.note(then, 0.0)


@pytest.mark.parametrize('scale', [1e-3, 1.0, 57.3, 1e3])
def test_an_axis_that_follows_another_stops_in_the_same_time_whatever_the_unit(scale):
    last = Point(0.0, 6.0 * scale, 0.0, 0, 0)
    coasting = Coasting(last, 0.002, 0.0, stop_of_axis(last, RAMP), '', FollowerState.HELD)
    points = list(coasting.due(10.0))
    assert coasting.over and len(points) in (50, 51)  # 0.1 s
    assert points[-1].position == pytest.approx(0.3 * scale)
    # an acceleration under way is taken back soon, wherever in a feed it is caught
    for point in setpoints_of(scale, 20.0, 1400)[1000:]:
        coasting = Coasting(point, 0.002, 0.0, stop_of_axis(point, RAMP), '', FollowerState.HELD)
        points = list(coasting.due(1e4))
        assert coasting.over and len(points) <= 60
        assert abs(points[-1].position - point.position) < 0.5 * scale
