# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Stamps of ticks on another clock: evenly spaced, whatever delays them, and never far off."""

from itertools import pairwise
import random

from cam_motion.runtime.time_relation import TimeRelation
import pytest

PERIOD = 20_000_000
EPOCH = 1_700_000_000_000_000_000


def stamps(seconds, rate=1.0, jitter=2_000_000):
    """Hear of ticks late, on a clock that runs at another rate; give times and stamps."""
    relation, late = TimeRelation(), random.Random(1)
    for k in range(int(seconds * 50)):
        time = k * PERIOD
        now = EPOCH + round(rate * time) + late.randint(0, jitter) + 100_000
        yield time, relation.stamp(time, now), EPOCH + round(rate * time)


def test_without_delays_stamps_are_the_clock():
    relation = TimeRelation()
    for k in range(200):
        assert relation.stamp(k * PERIOD, EPOCH + k * PERIOD) == EPOCH + k * PERIOD


def test_stamps_are_evenly_spaced_whatever_delays_the_ticks():
    for (_, one, _), (_, two, _) in pairwise(stamps(20)):
        assert two - one == pytest.approx(PERIOD, abs=5e-4 * PERIOD + 1)


def test_stamps_settle_at_the_least_delay():
    *_, (_, stamp, true) = stamps(20)
    assert 0 < stamp - true < 300_000


@pytest.mark.parametrize('rate', [1.0 - 1e-4, 1.0 + 1e-4])
def test_a_clock_that_drifts_is_followed(rate):
    late = [stamp - true for time, stamp, true in stamps(120, rate) if time > 20e9]
    assert max(map(abs, late)) < 1_000_000


@pytest.mark.parametrize('jump', [-3600, 3600])
def test_a_clock_that_is_set_is_followed_at_once(jump):
    relation = TimeRelation()
    relation.stamp(0, EPOCH)
    now = EPOCH + jump * 10**9 + PERIOD
    assert relation.stamp(PERIOD, now) == now


def test_a_time_base_that_begins_anew():
    relation = TimeRelation()
    relation.stamp(500 * PERIOD, EPOCH)
    assert relation.stamp(0, EPOCH + 500_000_000) == EPOCH + 500_000_000
