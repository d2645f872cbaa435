# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The grid of ticks: exact for ever, and honest about what came late or not at all."""

from fractions import Fraction

from cam_motion.runtime.ticks import NANOSECONDS, TickSchedule
from hypothesis import given
from hypothesis import strategies as st
import pytest

pytestmark = pytest.mark.timeout(60)

rates = st.sampled_from([1.0, 30.0, 60.0, 100.0, 333.3, 500.0, 1000.0, 1024.0, 4000.0])
starts = st.integers(0, 4 * 10**18)  # clocks count from 1970 [ns]


@pytest.mark.parametrize('rate', [3.0, 60.0, 500.0, 1000.0, 1024.0])
@pytest.mark.parametrize('tick', [0, 1, 2, 10**7 - 1, 10**7, 10**9 + 7])
def test_the_time_of_a_tick_is_its_number_over_the_rate(rate, tick):
    exact = Fraction(tick * NANOSECONDS) / Fraction(rate)
    # to the nanosecond for the 104 days that a float can count them, to rounding after that
    slack = Fraction(1, 2) + (exact / 2**53 if exact > 2**51 else 0)
    assert abs(TickSchedule(rate, 0.01).time_ns(tick) - exact) <= slack


@pytest.mark.parametrize('rate', [500.0, 1000.0])
def test_ticks_are_uniform_over_ten_million(rate):
    schedule, period = TickSchedule(rate, 0.01), round(NANOSECONDS / rate)
    assert schedule.period_ns == period
    assert all(schedule.time_ns(k) == k * period for k in range(0, 10**7, 9973))


@given(rates, starts, st.lists(st.floats(-0.09, 0.89), max_size=80))
def test_jitter_within_a_period_neither_loses_nor_doubles_a_tick(rate, start, jitter):
    schedule = TickSchedule(rate, 0.01)
    assert list(schedule.due(start)) == [0]
    for k, shift in enumerate(jitter, start=1):
        wake = start + schedule.time_ns(k) + int(shift * schedule.period_ns)
        assert list(schedule.due(wake)) == [k]
        assert list(schedule.due(wake)) == []
    assert (schedule.late, schedule.missed, schedule.restarts) == (0, 0, 0)
    worst = max([0.0, *jitter]) * schedule.period_ns
    assert schedule.worst_ns == pytest.approx(worst, rel=0, abs=1.0)


@given(rates, starts, st.lists(st.integers(0, 40), max_size=60), st.integers(0, 20))
def test_each_tick_is_carried_out_once_or_counted_as_missed(rate, start, gaps, catch_up_ticks):
    catch_up = catch_up_ticks / rate + 0.1 / rate
    schedule = TickSchedule(rate, catch_up)
    carried = list(schedule.due(start))
    at, late = 0, 0
    for gap in gaps:
        at += gap
        due = list(schedule.due(start + schedule.time_ns(at)))
        assert len(due) <= catch_up_ticks + 1
        if gap:
            assert due[-1] == at
            late += len(due) - 1
        carried += due
    assert carried == sorted(set(carried))
    assert len(carried) + schedule.missed == at + 1 == schedule.next_tick
    assert schedule.late == late
    if max(gaps, default=0) <= catch_up_ticks + 1:
        assert schedule.missed == 0


def test_late_and_missed_ticks_are_counted():
    schedule = TickSchedule(1000.0, 0.003)
    ms = 1_000_000
    assert list(schedule.due(5 * ms)) == [0]
    assert list(schedule.due(8 * ms)) == [1, 2, 3]
    assert (schedule.late, schedule.missed) == (2, 0)
    assert list(schedule.due(28 * ms)) == [20, 21, 22, 23]
    assert (schedule.late, schedule.missed) == (5, 16)
    assert list(schedule.due(28 * ms)) == []
    assert list(schedule.due(29 * ms)) == [24]


@given(rates, st.integers(1, 7), st.lists(st.integers(1, 40), max_size=30))
def test_late_ticks_come_in_bursts_and_none_is_lost(rate, burst, gaps):
    schedule, at = TickSchedule(rate, 1e4 / rate, burst), 0
    carried = list(schedule.due(0))
    for gap in gaps:
        at += gap
        due = list(schedule.due(schedule.time_ns(at)))
        assert len(due) <= burst
        carried += due
    while carried[-1:] != [at]:
        due = list(schedule.due(schedule.time_ns(at)))
        assert 0 < len(due) <= burst
        carried += due
    assert carried == list(range(at + 1))
    assert schedule.missed == 0


def test_what_comes_in_the_next_burst_is_late_too():
    schedule, ms = TickSchedule(1000.0, 1.0, 3), 1_000_000
    assert list(schedule.due(0)) == [0]
    assert (list(schedule.due(5 * ms)), schedule.late) == ([1, 2, 3], 3)
    assert (list(schedule.due(5 * ms)), schedule.late) == ([4, 5], 4)  # 5 is in time


def test_without_catching_up_only_the_newest_tick_is_carried_out():
    schedule = TickSchedule(1000.0, 0.0)
    schedule.due(0)
    assert list(schedule.due(7_000_000)) == [7]
    assert (schedule.late, schedule.missed) == (0, 6)


@given(rates, starts, st.integers(3, 2000), st.integers(4, 5000))
def test_a_clock_that_runs_backwards_restarts_the_grid_without_doubling_a_tick(
        rate, start, before, back):
    schedule = TickSchedule(rate, 0.01)
    schedule.due(start)
    schedule.due(start + schedule.time_ns(before))
    carried_out, missed = schedule.next_tick, schedule.missed
    now = start + schedule.time_ns(before) - schedule.time_ns(back)
    assert list(schedule.due(now)) == [carried_out]
    assert schedule.restarts == 1
    assert schedule.missed == missed
    period = round(schedule.period_ns)
    assert [list(schedule.due(now + k * period)) for k in (1, 2, 3)] == [
        [carried_out + k] for k in (1, 2, 3)]


def test_a_clock_that_steps_back_by_one_period_is_waited_for():
    schedule = TickSchedule(1000.0, 0.01)
    ms = 1_000_000
    for k in range(10):
        assert list(schedule.due(k * ms)) == [k]
    assert list(schedule.due(8 * ms)) == []
    assert list(schedule.due(9 * ms)) == []
    assert list(schedule.due(10 * ms)) == [10]
    assert schedule.restarts == 0


def test_a_tick_is_not_carried_out_clearly_before_its_time():
    schedule = TickSchedule(1000.0, 0.01)
    assert list(schedule.due(0)) == [0]
    assert list(schedule.due(800_000)) == []
    assert list(schedule.due(950_000)) == [1]


@given(rates, starts, st.integers(1, 50), st.integers(0, 10**12))
def test_a_pause_is_neither_late_nor_missed_and_no_number_is_left_out(rate, start, before, pause):
    schedule = TickSchedule(rate, 0.01)
    for k in range(before):
        assert list(schedule.due(start + schedule.time_ns(k))) == [k]
    schedule.resume()
    again = start + schedule.time_ns(before) + pause
    assert list(schedule.due(again)) == [before]
    assert list(schedule.due(again + round(schedule.period_ns))) == [before + 1]
    assert (schedule.late, schedule.missed, schedule.restarts) == (0, 0, 0)
