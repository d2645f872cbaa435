# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Speed ramps: they arrive exactly, keep their limits, and nothing faster exists."""

import math

from cam_motion.runtime.ramp import RampLimits, speed_ramp
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest
from scipy.optimize import linprog

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-9
STEPS = 40  # of the discretised ramps that are tried for comparison

speeds = st.integers(-500, 500).map(lambda n: n / 10.0)
accelerations = st.integers(-3000, 3000).map(lambda n: n / 10.0)
limits = st.builds(RampLimits, st.integers(1, 2000).map(lambda n: n / 10.0),
                   st.integers(1, 500).map(lambda n: n * 10.0))


def follow(omega, alpha, steps):
    """Give (speed, acceleration) at the start and after each step."""
    states = [(omega, alpha)]
    for duration, jerk in steps:
        omega += duration * (alpha + 0.5 * duration * jerk)
        alpha += duration * jerk
        states.append((omega, alpha))
    return states


@given(speeds, accelerations, speeds, limits)
def test_a_ramp_ends_at_its_target_without_acceleration(omega, alpha, target, bounds):
    steps = speed_ramp(omega, alpha, target, bounds)
    states = follow(omega, alpha, steps)
    scale = max(abs(omega), abs(target), abs(alpha), alpha * alpha / bounds.jerk, 1.0)
    assert states[-1] == pytest.approx((target, 0.0), rel=0, abs=ROUNDING * scale)


@given(speeds, accelerations, speeds, limits)
def test_a_ramp_keeps_its_limits(omega, alpha, target, bounds):
    steps = speed_ramp(omega, alpha, target, bounds)
    assert len(steps) <= 4
    assert all(step.duration > 0.0 for step in steps)
    assert all(abs(step.jerk) in (0.0, bounds.jerk) for step in steps)
    states = follow(omega, alpha, steps)
    reached = [abs(a) for _, a in states[1:]]
    assert max(reached, default=0.0) <= bounds.acceleration * (1.0 + ROUNDING)
    if abs(alpha) > bounds.acceleration:  # taken back first, straight to the limit
        assert steps[0].jerk == -math.copysign(bounds.jerk, alpha)
        assert reached[0] == pytest.approx(bounds.acceleration)


@given(speeds, speeds, limits)
def test_a_ramp_from_rest_of_acceleration_never_leaves_the_way(omega, target, bounds):
    """Between two steady speeds the speed only rises or only falls."""
    sense = math.copysign(1.0, target - omega)
    for _, alpha in follow(omega, 0.0, speed_ramp(omega, 0.0, target, bounds)):
        assert sense * alpha >= -ROUNDING * bounds.acceleration


def feasible(omega, alpha, target, bounds, duration):
    """Say whether some jerk in equal steps reaches the target in a given time."""
    h = duration / STEPS
    sums = np.tril(np.ones((STEPS, STEPS))) * h  # jerk to acceleration
    means = np.full(STEPS, h)
    means[-1] = 0.5 * h  # trapezoidal sum of the accelerations at the nodes, the last is zero
    to_speed = means @ sums
    start = alpha * (0.5 * h + h * (STEPS - 1) + 0.5 * h)
    answer = linprog(
        np.zeros(STEPS), bounds=(-bounds.jerk, bounds.jerk),
        A_ub=np.vstack([sums, -sums]),
        b_ub=np.concatenate([np.full(STEPS, bounds.acceleration - alpha),
                             np.full(STEPS, bounds.acceleration + alpha)]),
        A_eq=np.vstack([sums[-1], to_speed]), b_eq=[-alpha, target - omega - start],
    )
    return answer.status == 0


@settings(max_examples=25)
@given(speeds, st.integers(-10, 10), speeds, limits)
def test_no_ramp_is_faster(omega, tenths, target, bounds):
    alpha = tenths / 10.0 * bounds.acceleration
    duration = sum(step.duration for step in speed_ramp(omega, alpha, target, bounds))
    if duration > 1e-3:
        assert not feasible(omega, alpha, target, bounds, 0.98 * duration)
        assert feasible(omega, alpha, target, bounds, 1.15 * duration)


def test_named_ramps():
    bounds = RampLimits(10.0, 100.0)
    assert speed_ramp(3.0, 0.0, 3.0, bounds) == []
    # up to the limit, hold, and down again: 0.1 s + 0.4 s + 0.1 s
    assert speed_ramp(0.0, 0.0, 5.0, bounds) == [
        pytest.approx((0.1, 100.0)), pytest.approx((0.4, 0.0)), pytest.approx((0.1, -100.0))]
    # too little to do for the limit to be reached
    assert speed_ramp(0.0, 0.0, -0.25, bounds) == [
        pytest.approx((0.05, -100.0)), pytest.approx((0.05, 100.0))]
    # letting go of the acceleration is all that is needed
    assert speed_ramp(1.0, 10.0, 1.5, bounds) == [pytest.approx((0.1, -100.0))]
    # the acceleration is three times what is allowed
    first, *_ = speed_ramp(0.0, 30.0, 100.0, bounds)
    assert first == pytest.approx((0.2, -100.0))
