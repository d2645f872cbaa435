# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The grid of scheduled ticks: which are due, which came late, which were missed."""

from __future__ import annotations

from fractions import Fraction

NANOSECONDS = 1_000_000_000
"""Nanoseconds in a second."""

# How early a wake-up may come and still stand for its tick, in periods: clocks are read at
# slightly different instants. A late wake-up never carries out a tick before its time.
_EARLY = 0.1


class TickSchedule:
    """
    Ticks at a fixed rate on the machine's time base, which begins at zero.

    The time of tick k is k / rate, rounded to the nanosecond, never a sum of periods. Ticks that
    are late by less than the bound are still carried out, each with its own scheduled time;
    later ones are given up, counted, and never silently stretched.

    Parameters
    ----------
    rate : float
        Ticks per second [Hz]; positive.
    catch_up : float
        How late a tick may be carried out [s].
    burst : int | None
        How many ticks are carried out at a time at most, the others at the next readings of the
        clock; None for as many as are due.

    Attributes
    ----------
    late, missed : int
        Ticks carried out after their own period was over, and ticks given up.
    worst_ns : int
        Largest lateness of a tick that was carried out [ns].
    restarts : int
        How often the clock was found to have jumped backwards.

    """

    def __init__(self, rate: float, catch_up: float, burst: int | None = None) -> None:
        """Begin before the first tick."""
        self.rate = rate
        self._period = (NANOSECONDS / Fraction(rate)).as_integer_ratio()
        self.catch_up = catch_up
        self.burst = burst
        self.late = 0
        self.missed = 0
        self.worst_ns = 0
        self.restarts = 0
        self.next_tick = 0
        self._zero_ns: int | None = None

    @property
    def period_ns(self) -> float:
        """Time from tick to tick [ns]."""
        return NANOSECONDS / self.rate

    def time_ns(self, tick: int) -> int:
        """
        Give the scheduled time of a tick.

        Parameters
        ----------
        tick : int
            Number of the tick, from 0.

        Returns
        -------
        int
            Time since the machine's time base began [ns].

        """
        # in whole numbers: a float is exact to the nanosecond for 104 days only
        return (2 * tick * self._period[0] + self._period[1]) // (2 * self._period[1])

    def resume(self) -> None:
        """Go on after a pause: the next clock reading is when the next tick is due."""
        self._zero_ns = None

    def due(self, now_ns: int) -> range:
        """
        Take the ticks that are due.

        Parameters
        ----------
        now_ns : int
            Clock reading [ns]; the first one defines when the next tick is due.

        Returns
        -------
        range
            Numbers of the ticks to carry out now, oldest first; often one, empty when early.

        """
        period = self.period_ns
        if self._zero_ns is None:
            self._zero_ns = now_ns - self.time_ns(self.next_tick)
        newest = int((now_ns - self._zero_ns) / period + _EARLY)
        if newest < self.next_tick - 2:
            # the clock ran backwards (a looped bag): the time base goes on from where it was
            self.restarts += 1
            self._zero_ns = now_ns - self.time_ns(self.next_tick)
            newest = self.next_tick
        oldest = max(self.next_tick, newest - int(self.catch_up * self.rate + _EARLY))
        self.missed += oldest - self.next_tick
        last = newest if self.burst is None else min(newest, oldest + self.burst - 1)
        if last >= oldest:
            self.late += last - oldest + (last < newest)
            self.next_tick = last + 1
            self.worst_ns = max(self.worst_ns, now_ns - self._zero_ns - self.time_ns(oldest))
        return range(oldest, last + 1)
