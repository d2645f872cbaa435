# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Points of one tick find each other, in whatever order they come; streams are thinned evenly."""

from itertools import pairwise
import random

from cam_motion.runtime.pairing import Pairing
from cam_motion.runtime.point import Point
from cam_motion.runtime.slots import Slots
import pytest

SOURCES = ('a', 'b', 'c')


def point(tick, position=0.0):
    """Make a point of a tick."""
    return Point(position, 0.0, 0.0, tick // 1000, tick % 1000)


@pytest.mark.parametrize('seed', range(5))
def test_every_tick_is_paired_once_however_the_sources_interleave(seed):
    order = random.Random(seed)
    waiting = {name: list(range(200)) for name in SOURCES}
    pairing, found = Pairing(SOURCES), []
    while any(waiting.values()):
        # a source is at most 20 ticks ahead of the slowest
        least = min((each[0] for each in waiting.values() if each), default=0)
        name = order.choice([name for name, each in waiting.items()
                             if each and each[0] < least + 20])
        tick = waiting[name].pop(0)
        points = pairing.take(name, point(tick, float(ord(name))))
        if points is not None:
            assert set(points) == set(SOURCES)
            assert {p.position for p in points.values()} == {97.0, 98.0, 99.0}
            assert {p.sec * 1000 + p.nanosec for p in points.values()} == {tick}
            found.append(tick)
    assert found == list(range(200))
    assert pairing.unpaired == 0


def test_a_source_that_is_silent_is_named_and_memory_is_bounded():
    pairing = Pairing(SOURCES)
    assert pairing.missing() == ['a', 'b', 'c']
    for tick in range(1000):
        assert pairing.take('a', point(tick)) is None
        assert pairing.take('c', point(tick)) is None
    assert pairing.missing() == ['b']
    assert pairing.unpaired > 900 and len(pairing._waiting) <= 64
    # it comes back: the ticks before are given up
    assert pairing.take('b', point(999)) is not None
    assert (pairing.unpaired, pairing._waiting) == (999, {})


def test_a_hold_that_repeats_a_tick_is_paired_again():
    pairing = Pairing(SOURCES[:2])
    for _ in range(2):
        assert pairing.take('a', point(5)) is None
        assert set(pairing.take('b', point(5))) == {'a', 'b'}


@pytest.mark.parametrize('rate, count', [(0.0, 500), (500.0, 500), (100.0, 100), (30.0, 30)])
def test_a_stream_is_thinned_to_its_rate(rate, count):
    slots = Slots(rate)
    through = [tick for tick in range(500) if slots.due(tick * 2_000_000)]
    assert len(through) == count and through[0] == 0
    gaps = {b - a for a, b in pairwise(through)}
    assert max(gaps) - min(gaps) <= 1
