# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Random timing diagrams: whatever the program, it is smooth and its limits are honest."""

import math

from cam_motion import Axis, CamProfile, Limits, segment, TimingDiagram
from cam_motion.units import DEGREE, RPM, TURN
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(40)

ROUNDING = 1e-11
LAWS = [  # that start and end at rest
    ('constant_acceleration', {}), ('constant_acceleration', {'ramp_up': 0.3}),
    ('trapezoidal_velocity', {}), ('trapezoidal_velocity', {'ramp_up': 0.2, 'ramp_down': 0.5}),
    ('cubic', {}), ('cycloidal', {}), ('modified_trapezoid', {}),
    ('modified_trapezoid', {'fractions': (.1, .2, .1, .1, .2, .1, .2)}),
]
STEPLESS = {'dwell', 'cycloidal', 'modified_trapezoid'}  # with the parameters above
lifts = st.integers(-300, 300).filter(bool).map(lambda n: n / 1000.0)


@st.composite
def profiles(draw):
    """Make a legal cam; the last segment goes back where the cycle must close."""
    ends = sorted(draw(st.sets(st.integers(1, 3599), min_size=1, max_size=7)))
    accumulate = draw(st.booleans())
    segments, total = [], 0.0
    for number, end in enumerate(ends):
        if draw(st.booleans()):
            law, parameters = draw(st.sampled_from(LAWS))
            lift = draw(lifts)
            segments.append(segment(f's{number}', end / 10.0, lift, law, **parameters))
            total = math.fsum([total, lift])
        else:
            segments.append(segment(f's{number}', end / 10.0))
    if total and not accumulate:
        law, parameters = draw(st.sampled_from(LAWS))
        segments.append(segment('last', 360.0, -total, law, **parameters))
    else:
        segments.append(segment('last', 360.0))
    return CamProfile(segments, accumulate)


@given(profiles())
def test_position_and_velocity_are_continuous_and_the_cycle_closes(cam):
    assert cam.jumps(0) == [] and cam.jumps(1) == []
    step = 1e-7
    joints = np.array([0.0, *cam.curve.breaks])
    for order in (0, 1):
        steep = abs(cam.curve.peak(order + 1).value)
        slack = 2.0 * step * steep + ROUNDING * (abs(cam.curve.peak(order).value) + 1.0)
        assert cam(joints + step, order) == pytest.approx(
            cam(joints - step, order), rel=0, abs=slack)
    assert float(cam(TURN) - cam(0.0)) == pytest.approx(cam.advance, rel=0, abs=ROUNDING)
    assert float(cam(TURN / 3 - TURN)) == pytest.approx(
        float(cam(TURN / 3)) - cam.advance, rel=0, abs=ROUNDING)


@given(profiles())
def test_each_segment_begins_where_the_lifts_before_have_led(cam):
    led = 0.0
    for each in cam.segments:
        led = math.fsum([led, each.lift])
        before_the_end = (each.end_deg - 1e-9) * DEGREE
        assert float(cam(before_the_end)) == pytest.approx(led, rel=0, abs=1e-9)


@given(profiles())
def test_peaks_of_a_segment_are_never_below_a_grid_and_near_it(cam):
    start_deg = 0.0
    for each, peaks in zip(cam.segments, cam.segment_peaks):
        assert peaks.segment is each
        assert peaks.start_deg == pytest.approx(start_deg, abs=1e-9)
        inside = np.linspace(start_deg + 1e-7, each.end_deg - 1e-7, 4001) * DEGREE
        for order, peak in ((1, peaks.velocity), (2, peaks.acceleration), (3, peaks.jerk)):
            greatest = np.abs(cam(inside, order)).max()
            assert abs(peak.value) >= greatest * (1.0 - ROUNDING)
            if not math.isinf(peak.value):
                assert abs(peak.value) <= greatest * 1.001 + ROUNDING
            assert start_deg - 1e-9 <= peak.at / DEGREE <= each.end_deg + 1e-9
        if each.law.name in STEPLESS and not cam.jumps(2):
            assert math.isfinite(peaks.jerk.value)
        start_deg = each.end_deg


@given(profiles(), st.integers(1, 100).map(float), st.integers(1, 1000).map(float))
def test_the_highest_speed_attains_its_limit_and_exceeds_none(cam, velocity, acceleration):
    limits = Limits(velocity=velocity, acceleration=acceleration)
    bound = limits.highest_speed(cam)
    if all(each.is_dwell for each in cam.segments):
        assert bound is None
        return
    phi = np.linspace(0.0, TURN, 20_001)
    v, a = (np.abs(cam(phi, order)).max() * bound.omega**order for order in (1, 2))
    assert v <= velocity * (1.0 + ROUNDING) and a <= acceleration * (1.0 + ROUNDING)
    order = {'velocity': 1, 'acceleration': 2}[bound.quantity]
    assert bound.limit == limits.of_order(order)
    near = np.clip(bound.at + np.array([-1e-9, 0.0, 1e-9]), 0.0, TURN - 1e-12)
    assert np.abs(cam(near, order)).max() * bound.omega**order == pytest.approx(
        bound.limit, rel=1e-5)
    named = next(s for s in cam.segments if s.name == bound.segment)
    assert bound.at <= named.end + 1e-12


def cutting_machine(feeder_limits, press_limits=None):
    """Make the machine of document 001."""
    law = 'modified_trapezoid'
    feeder = CamProfile([segment('feed', 80.0, 0.3, law), segment('wait', 360.0)], True)
    press = CamProfile([
        segment('wait', 90.0), segment('press', 135.0, 0.02, law), segment('hold', 305.0),
        segment('lift', 350.0, -0.02, law), segment('rest', 360.0)])
    return TimingDiagram({
        'feeder': Axis('feeder', feeder, 'm', feeder_limits),
        'press': Axis('press', press, 'm', press_limits or Limits()),
    })


def test_the_slowest_axis_holds_the_shaft_and_is_named():
    ca = 8 * math.pi / (2 + math.pi)
    by_acceleration = math.sqrt(400.0 / (ca * 0.3)) * 80.0 * DEGREE
    name, bound = cutting_machine(Limits(10.0, 400.0)).speed_bound()
    assert (name, bound.quantity, bound.segment, bound.limit) == (
        'feeder', 'acceleration', 'feed', 400.0)
    assert bound.omega == pytest.approx(by_acceleration, rel=1e-12)
    assert bound.omega / RPM == pytest.approx(220.2, abs=0.05)
    name, bound = cutting_machine(Limits(10.0, 400.0), Limits(velocity=0.1)).speed_bound()
    assert (name, bound.quantity, bound.segment) == ('press', 'velocity', 'press')
    assert bound.omega == pytest.approx(0.1 * 45.0 * DEGREE / 0.04, rel=1e-12)


def test_without_limits_nothing_holds_the_shaft():
    assert cutting_machine(Limits()).speed_bound() is None
    assert TimingDiagram({}).speed_bound() is None


def test_a_jerk_limit_allows_no_speed_where_the_acceleration_steps():
    cam = CamProfile([segment('up', 90.0, 1.0, 'cubic'), segment('hold', 180.0),
                      segment('down', 360.0, -1.0, 'cycloidal')])
    bound = Limits(jerk=1e6).highest_speed(cam)
    assert bound == (0.0, 'jerk', 1e6, 'up', 0.0)
    smooth = CamProfile([segment('up', 180.0, 1.0, 'cycloidal'),
                         segment('down', 360.0, -1.0, 'cycloidal')])
    assert Limits(jerk=1e3).highest_speed(smooth).omega == pytest.approx(
        (1e3 * math.pi / 4.0) ** (1.0 / 3.0), rel=1e-12)
