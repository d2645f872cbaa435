# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A dead time made up for: exact where it can be, one motion, and at rest at once."""

from cam_motion.runtime.dead_time import ahead, DeadTime
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.runtime.shaft_motion import ShaftState
import pytest

pytestmark = pytest.mark.timeout(60)

TICK = 0.001
LEAD = 0.05


@pytest.mark.parametrize('sense', [1.0, -1.0])
@pytest.mark.parametrize('command', ['stop', 'quick_stop'])
def test_through_a_stop_it_comes_to_rest_and_tells_the_speed_it_has(command, sense):
    ramp, quick = RampLimits(30.0, 300.0), RampLimits(150.0, 3000.0)
    shaft = Shaft(sense * 6.0, ramp, quick)
    shaft.run(0.0)
    begin = shaft.settled_at + 0.1
    getattr(shaft, command)(begin)
    jerk = (quick if command == 'quick_stop' else ramp).jerk
    dead_time, points = DeadTime(LEAD), []
    for k in range(round((shaft.settled_at - begin) / TICK) + 10):
        t = begin + k * TICK
        points.append(dead_time.ahead(t, shaft.state(t)))
    assert points[-1] == ShaftState(shaft.state(1e3).phi, 0.0, 0.0)
    off = 0
    for one, two in zip(points[1:], points[2:]):
        moved = (two.phi - one.phi) / TICK
        if command == 'stop':  # the quick stop is over before the dead time is
            assert sense * moved >= -1e-9
            assert sense * two.omega >= -1e-9
        off += abs(moved - 0.5 * (one.omega + two.omega)) > 2.0 * jerk * LEAD * TICK
    # but for the ticks in which the jerk steps, which nobody can know of before
    assert off <= 8


def test_a_shaft_of_constant_acceleration_is_found_exactly():
    assert ahead(ShaftState(1.0, 4.0, -10.0), 0.1) == pytest.approx((1.35, 3.0, -10.0))
    assert ahead(ShaftState(1.0, 4.0, -10.0), 1.0) == pytest.approx((1.8, 0.0, 0.0))
    assert ahead(ShaftState(1.0, 0.0, 2.0), 1.0) == pytest.approx((2.0, 2.0, 2.0))
    assert ahead(ShaftState(1.0, 0.0, 0.0), 1.0, 5.0) == (1.0, 0.0, 0.0)
