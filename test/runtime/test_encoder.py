# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The filter and the shaft that follow an encoder: no lag, little noise, consistent motion."""

import math

from cam_motion.runtime.encoder import JumpGate, SmoothShaft, TrackingFilter, Unwrapping
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.runtime.shaft_motion import ShaftState
from cam_motion.units import TURN
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

TICK = 0.002


@given(st.floats(-30.0, 30.0), st.floats(-50.0, 50.0), st.floats(5.0, 200.0), st.integers(0, 99))
@settings(max_examples=50, deadline=None)
def test_no_lag_at_constant_acceleration(omega, alpha, bandwidth, seed):
    """Whatever the times of the samples, a shaft of constant acceleration is found exactly."""
    rng = np.random.default_rng(seed)
    found, t = TrackingFilter(bandwidth), 0.0
    for _ in range(round(40.0 / bandwidth / 0.005) + 60):
        t += 0.005 * (1.0 + 0.3 * rng.uniform(-1.0, 1.0))
        found.update(t, omega * t + 0.5 * alpha * t * t)
    later = t + 0.01
    phi, speed, rate = found.at(later)
    assert phi == pytest.approx(omega * later + 0.5 * alpha * later ** 2, abs=1e-6)
    assert speed == pytest.approx(omega + alpha * later, abs=1e-4)
    assert rate == pytest.approx(alpha, abs=1e-2)


def test_a_late_sample_is_left_out():
    """Samples that are not newer change nothing."""
    found = TrackingFilter(50.0)
    found.update(1.0, 2.0)
    found.update(1.1, 2.1)
    before = found.state
    found.update(1.1, 7.0)
    found.update(0.5, 7.0)
    assert found.state == before


@pytest.mark.parametrize('noise, of_speed, of_acceleration', [
    (0.0, 1e-9, 1e-6), (1e-4, 0.03, 5.0)])
def test_a_ramping_shaft_is_followed(noise, of_speed, of_acceleration):
    """Through a start the angle stays near; at constant speed only the noise is left."""
    rng = np.random.default_rng(7)
    shaft = Shaft(20.0, RampLimits(30.0, 300.0), RampLimits(150.0, 3000.0), phi=3.0)
    shaft.run(0.0)
    found, smooth = TrackingFilter(60.0), SmoothShaft(120.0, 3.0)
    unwrap = Unwrapping(1.0, 0.0, wraps=True)
    sampled, before = 0.0, None
    for k in range(1, 2000):
        t = k * TICK
        while sampled <= t:
            phi = shaft.state(sampled).phi + noise * rng.standard_normal()
            found.update(sampled, unwrap(phi % TURN))
            sampled += 0.005
        state, exact = smooth.follow(found.at(t), TICK), shaft.state(t)
        if before is not None:
            # what is published is one motion: each the integral of the next over the tick
            mean = 0.5 * (state.alpha + before.alpha)
            assert state.omega - before.omega == pytest.approx(mean * TICK, abs=1e-12)
        before = state
        assert abs(state.phi - exact.phi) < 0.02
        if t > 2.0:
            assert abs(state.omega - exact.omega) < of_speed
            assert abs(state.alpha - exact.alpha) < of_acceleration


def test_the_smooth_shaft_catches_up_without_overshoot_of_a_third():
    """A step of the other shaft is taken up as a triple pole does."""
    smooth = SmoothShaft(60.0)
    seen = [smooth.follow(ShaftState(1.0, 0.0, 0.0), TICK).phi for _ in range(400)]
    assert max(seen) < 4.0 / 3.0
    assert seen[-1] == pytest.approx(1.0, abs=1e-9)
    # the error obeys e[k] = poly(k) exp(-w h k): three differences of e / r^k vanish
    r = math.exp(-60.0 * TICK)
    scaled = [(1.0 - phi) / r ** (k + 1) for k, phi in enumerate(seen[:60])]
    assert np.max(np.abs(np.diff(scaled, 3))) < 1e-9 * max(map(abs, scaled))


@given(st.lists(st.floats(-3.0, 3.0), min_size=1, max_size=60), st.sampled_from([1.0, -2.0, 0.5]))
def test_unwrapping(steps, ratio):
    """Steps of less than half a turn are added up, over however many turns."""
    unwrap, angle = Unwrapping(ratio, 0.25, True), 0.0
    unwrap(0.0)
    for step in steps:
        angle += step
        assert unwrap(angle % TURN) == pytest.approx(ratio * angle + 0.25, abs=1e-9)


@pytest.mark.parametrize('step', [0.001, 0.004, 0.02])
@pytest.mark.parametrize('acceleration, jerk', [(30.0, 300.0), (150.0, 3000.0)])
def test_no_ramp_of_a_real_shaft_is_taken_for_a_jump(step, acceleration, jerk):
    rng = np.random.default_rng(3)
    limits = RampLimits(acceleration, jerk)
    shaft = Shaft(30.0, limits, limits)
    shaft.run(0.5)
    found, gate = TrackingFilter(60.0), JumpGate()
    for k in range(round(3.0 / step)):
        if k * step > 2.0:
            shaft.stop(2.0)
        phi = shaft.state(k * step).phi + 3e-3 * rng.standard_normal()
        assert gate.admits(k * step, phi, found.state.omega if k > 10 else None)
        found.update(k * step, phi)


@pytest.mark.parametrize('omega', [-30.0, 0.0, 6.0])
def test_a_jump_is_refused_as_long_as_it_lasts(omega):
    gate = JumpGate()
    assert gate.admits(0.0, 1.0, None)
    for k in range(1, 6):
        t = 0.004 * k
        assert not gate.admits(t, 2.0 + omega * t, omega)
        assert gate.astray == k
        assert gate.jump == pytest.approx(1.0)
    assert gate.admits(0.024, 1.0 + 0.024 * omega, omega)
    assert (gate.astray, gate.refused) == (0, 5)
