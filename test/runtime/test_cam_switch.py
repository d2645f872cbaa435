# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Cam tracks: the outputs of MC_DigitalCamSwitch, exactly when they are due, without chatter."""

from itertools import pairwise
import math

from cam_motion.runtime.cam_switch import CamSwitch, CamTrack, Direction, time_to, travel
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.units import DEGREE, RPM, TURN
from hypothesis import given
from hypothesis import strategies as st
import pytest

MODULO = 5000.0  # of the published example, in its units
SPEED = 1000.0
TICK = 0.001


def edges(track, speed=SPEED, seconds=12.0, start=0.0, tick=TICK, switch=None):
    """Move at a constant speed; give the times at which the output is switched, and to what."""
    switch = switch or CamSwitch(track)
    found, was = [], switch.answer(0.0, start, speed, 0.0)
    for k in range(1, round(seconds / tick) + 1):
        on = switch.answer(k * tick, start + speed * k * tick, speed, 0.0)
        if on is not was:
            found.append((round(k * tick, 9), on))
        was = on
    return found


# The example of MC_DigitalCamSwitch in the CODESYS documentation: four switches on a modulo axis


def test_a_window_forwards_only():
    track = CamTrack([2000.0], [3000.0], MODULO, direction=Direction.POSITIVE)
    assert edges(track, seconds=11.0) == [
        (2.0, True), (3.0, False), (7.0, True), (8.0, False)]
    assert edges(track, -SPEED) == []


def test_a_window_backwards_only():
    track = CamTrack([2500.0], [3000.0], MODULO, direction=Direction.NEGATIVE)
    assert edges(track) == []
    # at 3000 it is still outside: a window does not hold its own end
    assert edges(track, -SPEED, 6.0) == [(2.001, True), (2.501, False)]


def test_a_window_through_the_end_of_the_cycle():
    track = CamTrack([4000.0], [1000.0], MODULO)
    switch = CamSwitch(track)
    assert switch.answer(0.0, 0.0, SPEED, 0.0)
    assert edges(track) == [
        (1.0, False), (4.0, True), (6.0, False), (9.0, True), (11.0, False)]
    assert edges(track, -SPEED, 6.0) == [(1.001, False), (4.001, True)]


def test_a_duration_from_a_place():
    track = CamTrack([3000.0], period=MODULO, duration=1.35)
    assert edges(track) == [(3.0, True), (4.35, False), (8.0, True), (9.35, False)]


@pytest.mark.parametrize('speed, on, off', [(1000.0, 1.875, 3.25), (500.0, 3.875, 6.25)])
def test_switched_on_earlier_and_off_later_by_times(speed, on, off):
    track = CamTrack([2000.0], [3000.0], MODULO, on_compensation=-0.125, off_compensation=0.25)
    assert edges(track, speed, 8.0)[:2] == [(on, True), (off, False)]


def test_compensations_go_with_switching_on_and_off_in_both_directions():
    track = CamTrack([2000.0], [3000.0], MODULO, on_compensation=-0.125, off_compensation=0.25)
    # from 0 backwards: 3000 lies 2000 ahead, 2000 lies 3000 ahead
    assert edges(track, -SPEED, 4.0, tick=0.002) == [(1.876, True), (3.252, False)]


# Identities


@given(st.lists(st.integers(0, 3599), min_size=2, max_size=8, unique=True), st.booleans(),
       st.lists(st.integers(-4000, 4000), min_size=1, max_size=30))
def test_on_within_its_windows_wherever_it_moves(tenths, wraps, places):
    marks = sorted(tenths)[:len(tenths) // 2 * 2]
    marks = [*marks[1:], marks[0]] if wraps else marks
    windows = list(zip(marks[::2], marks[1::2]))
    switch = CamSwitch(CamTrack([0.1 * DEGREE * a for a, _ in windows],
                                [0.1 * DEGREE * b for _, b in windows]))
    for k, place in enumerate(places):
        x = 0.1 * (place + 0.5) * DEGREE  # half-way between marks: rounding decides nothing
        inside = any((place - a) % 3600 < (b - a) % 3600 for a, b in windows)
        assert switch.answer(k * TICK, x, 0.0, 0.0) is inside


@given(st.floats(-20.0, 20.0), st.floats(-50.0, 50.0), st.floats(-0.3, 0.3))
def test_the_time_of_a_place_is_the_inverse_of_travel(speed, acceleration, time):
    distance = travel(speed, acceleration, time)
    if abs(speed + acceleration * time) < 1e-3 or speed * (speed + acceleration * time) <= 0.0:
        return  # it has come to rest on the way, or had started from it
    assert time_to(distance, speed, acceleration) == pytest.approx(time, abs=1e-9)


def test_it_comes_to_rest_and_starts_from_rest_but_does_not_turn_round():
    assert travel(2.0, -4.0, 10.0) == travel(2.0, -4.0, 0.5) == 0.5
    assert travel(2.0, 4.0, -10.0) == -0.5
    assert travel(0.0, 4.0, 1.0) == 2.0 and travel(0.0, 4.0, -1.0) == 0.0
    assert math.isnan(time_to(1.0, 1.0, -1.0)) and math.isnan(time_to(1.0, 0.0, 0.0))
    assert time_to(2.0, 0.0, 4.0) == 1.0


# Dead times over a ramp


def passages(phi, until):
    """Find when a shaft that starts from rest passes an angle, by bisection."""
    low, high = 0.0, until.settled_at + 2.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if until.state(middle).phi < phi else (low, middle)
    return high


@pytest.mark.parametrize('compensation, tolerance', [(-0.01, 2e-4), (-0.03, 2e-3), (0.01, 2e-4)])
def test_a_dead_time_is_made_up_for_while_the_speed_changes(compensation, tolerance):
    shaft = Shaft(200 * RPM, RampLimits(30.0, 300.0), RampLimits(150.0, 3000.0))
    shaft.run(0.0)
    tick = 1e-4
    for degrees in (40.0, 170.0, 300.0):
        switch = CamSwitch(CamTrack([degrees * DEGREE], [359.0 * DEGREE],
                                    on_compensation=compensation))
        k = 0
        while not switch.answer(k * tick, *shaft.state(k * tick)):
            k += 1
        due = passages(degrees * DEGREE, shaft) + compensation
        assert k * tick == pytest.approx(due, abs=tolerance + tick)


def test_a_shaft_that_stops_short_of_an_edge_switches_nothing():
    switch = CamSwitch(CamTrack([2.0], [3.0], on_compensation=-0.2))
    for k in range(201):  # from 10 rad/s to rest at 1.9
        t = k * TICK
        assert not switch.answer(t, 0.9 + t * (10.0 - 25.0 * t), 10.0 - 50.0 * t, -50.0)
    assert switch.answer(1.0, 1.95, 1.0, 0.0)  # it goes on slowly: there in 0.05 s


# Exactly


def test_a_duration_counts_from_when_the_place_was_passed_not_from_the_tick():
    track = CamTrack([1.0], duration=0.0105)
    speed, tick = 20.0, 0.002
    passed = 1.0 / speed
    found = edges(track, speed, 0.2, tick=tick)
    assert found[0] == (math.ceil(passed / tick) * tick, True)
    assert found[1] == (math.ceil((passed + 0.0105) / tick) * tick, False)


@pytest.mark.parametrize('turns', [1, 7, 1_000_000])
def test_a_shaft_that_stands_exactly_at_the_end_of_a_cycle(turns):
    ends = CamSwitch(CamTrack([300.0 * DEGREE], [TURN]))
    begins = CamSwitch(CamTrack([0.0], [10.0 * DEGREE]))
    phi = turns * TURN
    for switch, on in ((ends, False), (begins, True)):
        switch.answer(0.0, phi - 0.1, 1.0, 0.0)
        assert switch.answer(0.1, phi, 0.0, 0.0) is on


def test_a_window_of_a_whole_cycle_is_always_on():
    assert edges(CamTrack([1.0], [1.0 + TURN]), 20.0, 2.0) == []
    assert CamSwitch(CamTrack([1.0], [1.0 + TURN])).answer(0.0, 3.0, 0.0, 0.0)


def test_windows_over_a_position_that_does_not_repeat():
    switch = CamSwitch(CamTrack([0.01, 0.05], [0.02, 0.08], math.inf))
    answers = [switch.answer(k * TICK, x, 0.0, 0.0) for k, x in enumerate(
        [-0.5, 0.015, 0.03, 0.06, 0.09, 0.5, 0.015])]
    assert answers == [False, True, False, True, False, False, True]


# Chatter


@given(st.lists(st.floats(-0.5, 0.5), min_size=2, max_size=40))
def test_trembling_around_an_edge_switches_once_at_most(noise):
    switch = CamSwitch(CamTrack([1.0], [2.0], hysteresis=1.0))
    answers = [switch.answer(k * TICK, 1.0 + x, 40.0 * x, 0.0) for k, x in enumerate(noise)]
    assert sum(a is not b for a, b in pairwise(answers)) <= 1


def test_trembling_without_hysteresis_chatters():
    switch = CamSwitch(CamTrack([1.0], [2.0]))
    for k in range(40):
        switch.answer(k * TICK, 1.0 + 0.1 * (-1) ** k, 0.0, 0.0)
    assert switch.count == 20


def test_hysteresis_displaces_no_edge_of_a_motion_in_one_direction():
    track = CamTrack([1.0, 1.3], [1.2, 1.5])
    calm = CamTrack([1.0, 1.3], [1.2, 1.5], hysteresis=0.09)
    for speed in (0.3, -0.3):
        assert edges(track, speed, 30.0) == edges(calm, speed, 30.0) != []


def test_a_track_for_one_direction_does_not_tremble_with_it():
    switch = CamSwitch(CamTrack([1.0], [2.0], direction=Direction.POSITIVE, hysteresis=0.2))
    switch.answer(0.0, 0.5, 1.0, 0.0)
    assert all(switch.answer(k * TICK, 1.5 + 0.05 * (-1) ** k, (-1.0) ** k, 0.0)
               for k in range(1, 20))
    assert not switch.answer(1.0, 1.2, -1.0, 0.0)  # now it really goes back


def test_a_duration_ends_while_the_shaft_trembles():
    switch = CamSwitch(CamTrack([1.0], duration=0.05, hysteresis=0.2))
    switch.answer(0.0, 0.99, 1.0, 0.0)
    answers = [switch.answer(k * TICK, 1.01 + 0.02 * (-1) ** k, 0.0, 0.0) for k in range(1, 100)]
    assert sum(answers) == pytest.approx(50, abs=1) and switch.count == 1


# Counters


def test_counting():
    switch = CamSwitch(CamTrack([1.0, 3.0], [2.0, 4.0]))
    edges(None, 10.0, 10 * TURN / 10.0, switch=switch)
    assert (switch.count, switch.unseen) == (20, 0)


@pytest.mark.parametrize('sense', [1.0, -1.0])
def test_windows_between_two_ticks_are_counted_as_unseen(sense):
    switch = CamSwitch(CamTrack([1.0, 3.0], [1.01, 4.0]))
    edges(None, sense * 20.0, 10 * TURN / 20.0, tick=0.002, switch=switch)
    assert switch.count + switch.unseen == 20 and switch.unseen >= 6


def test_what_compensations_leave_nothing_of_is_unseen():
    switch = CamSwitch(CamTrack([1.0], [1.2], on_compensation=0.01, off_compensation=-0.01))
    assert edges(None, 20.0, 5 * TURN / 20.0, switch=switch) == []
    assert switch.unseen == 5
    assert edges(CamTrack([1.0], [1.2], on_compensation=0.01, off_compensation=-0.01), 2.0)


def test_a_jump_to_another_angle_passes_nothing():
    for track in (CamTrack([1.0], [1.1]), CamTrack([1.0], duration=0.5)):
        switch = CamSwitch(track)
        switch.answer(0.0, 0.5, 1.0, 0.0)
        assert not switch.answer(TICK, 0.5 + 10 * TURN, 1.0, 0.0)
        assert (switch.count, switch.unseen) == (0, 0)


def test_reset_switches_off_and_goes_on_counting():
    switch = CamSwitch(CamTrack([1.0], [2.0]))
    switch.answer(0.0, 1.5, 1.0, 0.0)
    switch.reset()
    assert not switch.on and switch.count == 1
    assert switch.answer(0.1, 1.6, 1.0, 0.0) and switch.count == 2
