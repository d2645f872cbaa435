# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The cam profile: periodic, continuous, and honest about its steps and peaks."""

import math
import pickle

from cam_motion import CamProfile, segment
from cam_motion.errors import ConfigurationError
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.units import DEGREE, TURN
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-12
PER_CYCLE = 4e-16 * TURN  # rounding of an angle, for each cycle it is away from zero


def belt():
    """Make a belt that is fed 0.3 in each cycle."""
    return CamProfile([
        segment('feed', 80.0, 0.3, 'modified_trapezoid'), segment('wait', 360.0),
    ], accumulate=True)


def knife():
    """Make a cam that goes and returns."""
    return CamProfile([
        segment('low', 145.0), segment('cut', 225.0, 0.08, 'modified_trapezoid'),
        segment('hold', 235.0), segment('back', 295.0, -0.08, 'cycloidal'), segment('rest', 360.0),
    ])


@pytest.mark.parametrize('cycles', [-100_000, -1000, -3, -1, 1, 2, 1000, 100_000])
@pytest.mark.parametrize('make', [belt, knife])
def test_a_cam_repeats_itself_and_advances(make, cycles):
    cam = make()
    phi = np.linspace(0.0, TURN, 721)[:-1] + 0.001
    for order in range(3):
        there = cam(phi + cycles * TURN, order)
        expected = cam(phi, order) + (cycles * cam.advance if order == 0 else 0.0)
        steepness = abs(cam.curve.peak(order + 1).value)
        slack = ROUNDING * (1.0 + abs(cycles * cam.advance)) + steepness * PER_CYCLE * abs(cycles)
        assert there == pytest.approx(expected, rel=0, abs=2 * slack)


def test_a_belt_advances_by_its_stroke_and_a_returning_cam_does_not():
    assert belt().advance == 0.3
    assert knife().advance == 0.0
    assert float(belt()(-0.5)) == 0.0  # it waits at the end of the cycle before: -0.3 + 0.3
    assert float(belt()(-TURN)) == pytest.approx(-0.3, rel=ROUNDING)
    assert belt().sample(10.0 * TURN + 2.0)[0] == pytest.approx(3.3, rel=ROUNDING)


@pytest.mark.parametrize('make', [belt, knife])
def test_sample_gives_what_the_vector_gives(make):
    cam = make()
    phi = np.concatenate([np.random.default_rng(7).uniform(-30.0, 30.0, 500),
                          [0.0, -0.0, TURN, -TURN, 5 * TURN, -1e-300], cam.curve.breaks])
    sampled = np.array([cam.sample(float(x)) for x in phi])
    for order in range(4):
        scale = abs(cam.curve.peak(order).value) + abs(cam.advance) * 6
        assert sampled[:, order] == pytest.approx(cam(phi, order), rel=0, abs=ROUNDING * scale)


@pytest.mark.parametrize('shape', [(), (0,), (3, 4), (2, 0, 5)])
def test_the_shape_of_the_angles_is_kept(shape):
    assert knife()(np.ones(shape), 1).shape == shape


def test_an_angle_that_is_not_a_number_gives_no_number():
    assert np.isnan(knife()([0.0, math.nan])).tolist() == [False, True]


def test_no_joint_and_no_seam_shows_a_step_of_position_or_velocity():
    for cam in (belt(), knife()):
        assert [cam.jumps(order) for order in (0, 1, 2)] == [[], [], []]


def test_steps_of_the_acceleration_are_listed_seam_first():
    cam = CamProfile([segment('up', 90.0, 1.0, 'cubic'), segment('hold', 180.0),
                      segment('down', 360.0, -1.0, 'cubic')])
    jumps = cam.jumps(2)
    assert [jump.at / DEGREE for jump in jumps] == pytest.approx([0.0, 90.0, 180.0])
    up, down = 6.0 / (0.5 * math.pi) ** 2, 6.0 / math.pi**2
    assert [jump.amount for jump in jumps] == pytest.approx([up - down, up, -down])
    assert all(jump.order == 2 for jump in jumps)


def test_the_jerk_is_infinite_where_the_acceleration_steps_and_only_there():
    cam = CamProfile([
        segment('up', 90.0, 1.0, 'cubic'), segment('hold', 180.0),
        segment('down', 300.0, -1.0, 'cycloidal'), segment('rest', 360.0),
    ])
    up, hold, down, rest = (peaks.jerk for peaks in cam.segment_peaks)
    assert up == (math.inf, 0.0)
    assert down.value == pytest.approx(-4 * math.pi**2 / (2 * math.pi / 3) ** 3)
    assert hold.value == rest.value == 0.0


def test_a_step_at_the_seam_makes_the_jerk_of_the_last_segment_infinite():
    cam = CamProfile([segment('low', 180.0), segment('up', 200.0, 1.0, 'cycloidal'),
                      segment('down', 360.0, -1.0, 'modified_trapezoid',
                              fractions=(.2, .1, .2, 0, 0, .3, .2))])
    assert not math.isinf(cam.segment_peaks[1].jerk.value)
    cam = CamProfile([segment('up', 180.0, 1.0, 'cycloidal'),
                      segment('down', 360.0, -1.0, 'cubic')])
    assert cam.segment_peaks[1].jerk.value == math.inf
    ends_hard = (.25, 0, .25, 0, .2, .3, 0)
    cam = CamProfile([segment('low', 180.0), segment('up', 270.0, 1.0, 'cycloidal'), segment(
        'down', 360.0, -1.0, 'modified_trapezoid', fractions=ends_hard)])
    assert cam.segment_peaks[2].jerk == (math.inf, TURN)
    assert not math.isinf(cam.segment_peaks[1].jerk.value)


STARTS_HARD = (.0, .4, .1, .1, .15, .0, .25)


def test_rounding_of_a_joint_does_not_hide_an_infinite_jerk():
    cam = CamProfile([
        segment('up', 2.2, 1.0, 'cycloidal'), segment('wait', 6.2),
        segment('down', 359.0, -1.0, 'modified_trapezoid', fractions=STARTS_HARD),
        segment('rest', 360.0),
    ])
    assert [jump.at / DEGREE for jump in cam.jumps(2)] == pytest.approx([6.2])
    assert cam.segment_peaks[2].jerk.value == math.inf


def test_the_acceleration_of_the_shaft_enters_the_setpoint():
    """Differences of y(phi(t)) while the shaft runs up are the setpoint's derivatives."""
    cam, h = knife(), 1e-5
    shaft = Shaft(20.0, RampLimits(30.0, 200.0), RampLimits(100.0, 1000.0))
    shaft.run(0.0)

    def position(t):
        return cam.sample(shaft.state(t).phi)[0]

    checked = 0
    for t in np.linspace(0.01, 1.5, 150):
        phi, omega, alpha = shaft.state(t)
        y, velocity, acceleration = cam.at_speed(phi, omega, alpha)
        assert y == position(t)
        assert velocity == pytest.approx((position(t + h) - position(t - h)) / (2 * h), abs=1e-6)
        second = (position(t + h) - 2 * y + position(t - h)) / (h * h)
        assert acceleration == pytest.approx(second, abs=1e-2)
        without_alpha = cam.at_speed(phi, omega)[2]
        checked += abs(acceleration - without_alpha) > 0.1
    assert checked > 5


def test_a_single_segment_may_fill_the_turn():
    line = CamProfile([segment('run', 360.0, 2.0, 'constant_velocity')], accumulate=True)
    assert line.jumps(1) == []
    assert float(line(7.0 * TURN + 1.0)) == pytest.approx(14.0 + 2.0 / TURN)
    still = CamProfile([segment('rest', 360.0)])
    assert still(np.linspace(-9.0, 9.0, 5)).tolist() == [0.0] * 5


def test_neighbours_that_meet_at_the_same_velocity_are_accepted():
    fractions = (0, 0, .5, 0, .5, 0, 0)
    cam = CamProfile([segment('up', 180.0, 1.0, 'modified_trapezoid', fractions=fractions),
                      segment('down', 360.0, -1.0, 'modified_trapezoid', fractions=fractions)])
    assert cam.jumps(2) == []  # two simple harmonics make one sine
    assert float(cam(1.0)) == pytest.approx(0.5 - 0.5 * math.cos(1.0), rel=ROUNDING)


def test_a_cycle_may_miss_its_closure_by_rounding_only():
    thirds = [segment('a', 120.0, 0.1, 'cubic'), segment('b', 240.0, 0.2, 'cubic')]
    assert CamProfile([*thirds, segment('c', 360.0, -0.3, 'cubic')]).jumps(0) == []
    with pytest.raises(ConfigurationError, match='must sum to zero'):
        CamProfile([*thirds, segment('c', 360.0, -0.30001, 'cubic')])


def test_a_profile_travels_between_processes_also_when_it_has_been_sampled():
    cam = CamProfile([segment('rise', end_deg=180.0, lift=1.0, law='cycloidal'),
                      segment('fall', end_deg=360.0, lift=-1.0, law='cycloidal')])
    sampled = cam.sample(1.0), cam.curve.sample(1.0)
    again = pickle.loads(pickle.dumps(cam))
    assert (again.sample(1.0), again.curve.sample(1.0)) == sampled
