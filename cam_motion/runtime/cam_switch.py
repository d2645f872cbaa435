# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Digital cam switches: outputs that are on over windows of an angle, or for a time from one."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
import math

from cam_motion.units import TURN


class Direction(Enum):
    """Directions of motion in which a track switches; the value is its name for users."""

    BOTH = 'both'
    POSITIVE = 'positive'
    NEGATIVE = 'negative'


@dataclass(frozen=True)
class CamTrack:
    """
    When an output is on, over an angle or over a position.

    Attributes
    ----------
    on : Sequence[float]
        First positions of the windows, moving forwards.
    off : Sequence[float]
        Where each of them ends, moving forwards; a window that ends before it begins goes through
        the end of the cycle. Windows do not overlap. Empty where `duration` is given.
    period : float
        After which the windows repeat, TURN for a shaft; infinite: they do not.
    duration : float | None
        Instead of `off`: how long the output stays on from a first position [s], passed in
        whatever direction.
    direction : Direction
        In which direction of motion it switches on at all.
    on_compensation, off_compensation : float
        By how long switching on and off is put off [s]; negative: brought forward, to make up for
        the dead time of what is switched.
    hysteresis : float
        Motion back and forth by less than this switches nothing.

    References
    ----------
    PLCopen, Function blocks for motion control, part 1, MC_DigitalCamSwitch: FirstOnPosition,
    LastOnPosition, AxisDirection, CamSwitchMode, Duration, OnCompensation, OffCompensation,
    Hysteresis.

    """

    on: Sequence[float]
    off: Sequence[float] = ()
    period: float = TURN
    duration: float | None = None
    direction: Direction = Direction.BOTH
    on_compensation: float = 0.0
    off_compensation: float = 0.0
    hysteresis: float = 0.0


def travel(speed: float, acceleration: float, time: float) -> float:
    """
    Tell how far something moves in a time to come, or by how much it was elsewhere before.

    It comes to rest where its speed falls to zero, and has started from rest, instead of turning
    round.

    Parameters
    ----------
    speed, acceleration : float
        Now, per s and per s².
    time : float
        Ahead [s]; negative: ago.

    Returns
    -------
    float
        Position then, less the position now.

    """
    if abs(acceleration * time) > abs(speed):
        pull = speed * acceleration
        if pull < 0.0 if time > 0.0 else pull >= 0.0:
            return -0.5 * speed * speed / acceleration
    return time * (speed + 0.5 * time * acceleration)


def time_to(distance: float, speed: float, acceleration: float) -> float:
    """
    Tell when something passes a place, or has passed it.

    Parameters
    ----------
    distance : float
        How far ahead of it the place lies, in the direction of positive speeds.
    speed, acceleration : float
        Now, per s and per s².

    Returns
    -------
    float
        Time ahead [s], negative: ago; NaN where it does not get there.

    """
    square = speed * speed + 2.0 * acceleration * distance
    sense = speed or distance * acceleration  # from rest it can only go where it is pulled
    if square < 0.0 or sense == 0.0:
        return math.nan
    if speed == 0.0:
        return math.sqrt(2.0 * distance / acceleration)
    return 2.0 * distance / (speed + math.copysign(math.sqrt(square), speed))


class _Edges:
    """Edges that repeat with a period, counted from the first one of the first period."""

    def __init__(self, places: Sequence[float], period: float) -> None:
        """Take the places in order, of which those behind the first period are wrapped."""
        self._period = period
        wrapped = [place for place in places if place >= period]
        self._places = [
            *(place - period for place in wrapped), *(p for p in places if p < period)]
        self._wrapped = len(wrapped)
        self.count = len(self._places)

    def around(self, x: float) -> tuple[int, float, float]:
        """Count the edges up to a place; give the last of them and the next."""
        places, period, count = self._places, self._period, self.count
        if not count:
            return 0, -math.inf, math.inf
        turns = 0 if math.isinf(period) else math.floor(x / period)
        start = turns * period if turns else 0.0
        k = bisect_right(places, x - start)
        # the edges as they are compared with, not as rounding has left the difference
        if k < count and start + places[k] <= x:
            k += 1
        elif k and start + places[k - 1] > x:
            k -= 1
        low = start + places[k - 1] if k else start + (places[-1] - period)
        high = start + places[k] if k < count else start + (places[0] + period)
        return turns * count + k - self._wrapped, low, high


def _laid(first: float, last: float, period: float) -> tuple[float, float]:
    """Lay a window so that it begins in the first period and ends within one more."""
    if math.isinf(period):
        return first, last
    turns = math.floor(first / period) * period
    first, last = first - turns, last - turns
    while last <= first:
        last += period
    while last > first + period:
        last -= period
    return first, last


class CamSwitch:
    """
    One output as it switches while the shaft or the axis moves.

    Where the compensations are not zero, an edge is passed when the place is passed at which the
    shaft will be then, or was before, by its present speed and acceleration. The output is on
    between ticks as well as at them, but told at ticks only: a window that lies between two ticks
    is counted as unseen, as is one of which the compensations leave nothing.

    Parameters
    ----------
    track : CamTrack
        When it is on.

    Attributes
    ----------
    on : bool
        Whether it is on.
    count : int
        How often it has been switched on.
    unseen : int
        How often it would have been, for less than a tick.

    """

    def __init__(self, track: CamTrack) -> None:
        """Be off; the first place says what follows."""
        period = track.period
        offs: Sequence[float] = track.off or [math.nan] * len(track.on)
        windows = [_laid(first, last, period) for first, last in zip(track.on, offs)]
        windows.sort()
        self._track = track
        self._ons = _Edges([first for first, _ in windows], period)
        self._offs = _Edges([last for _, last in windows] if track.off else [], period)
        self._sense = 1.0
        self._leads = (-track.on_compensation, -track.off_compensation)
        self._longest_lead = max(map(abs, self._leads))
        self.on = False
        self.count = self.unseen = 0
        self.reset()

    def reset(self) -> None:
        """Switch off; the next place may be anywhere."""
        self.on = False
        self._far = math.nan  # farthest place in the present direction
        self._passed_ons: int | None = None
        self._passed_offs = 0
        self._last_time = math.nan
        self._until = math.inf  # when a duration is over
        self._forget()

    def _forget(self) -> None:
        """Let the next place be looked at, wherever it is."""
        self._low_on = self._high_on = self._low_off = self._high_off = math.nan

    def _turn_round(self) -> None:
        self._sense = -self._sense
        if self._track.duration is None:
            # moving backwards the ends of the windows switch on
            self._leads = self._leads[::-1]
        self._forget()

    def answer(self, time: float, x: float, speed: float, acceleration: float) -> bool:
        """
        Switch for a tick.

        Parameters
        ----------
        time : float
            Its time [s].
        x, speed, acceleration : float
            Place, speed and acceleration at that time, in the unit of the track.

        Returns
        -------
        bool
            Whether the output is on at that time.

        """
        ahead = (x - self._far) * self._sense
        if ahead < 0.0 and -ahead <= self._track.hysteresis:
            self._last_time = time
            if time >= self._until:
                self.on, self._until = False, math.inf
            return self.on
        turned = ahead < 0.0
        if turned:
            self._turn_round()
        self._far = at_on = at_off = x
        longest = self._longest_lead
        if longest:
            lead_on, lead_off = self._leads
            if longest * abs(acceleration) < abs(speed):  # no rest within: what `travel` gives
                at_on += lead_on * (speed + 0.5 * lead_on * acceleration)
                at_off += lead_off * (speed + 0.5 * lead_off * acceleration)
            else:
                at_on += travel(speed, acceleration, lead_on)
                at_off += travel(speed, acceleration, lead_off)
        if not (self._low_on <= at_on < self._high_on
                and self._low_off <= at_off < self._high_off):
            self._pass(time, x, speed, acceleration, turned)
        if time >= self._until:
            self.on, self._until = False, math.inf
        self._last_time = time
        return self.on

    @property
    def is_timed(self) -> bool:
        """Whether it is on for a duration, which ends whether or not anything moves."""
        return self.on and self._until < math.inf

    def expire(self, time: float) -> bool:
        """
        Switch off if a duration is over, without a tick.

        Parameters
        ----------
        time : float
            Time on the base of the ticks [s].

        Returns
        -------
        bool
            Whether the output is on at that time.

        """
        if time >= self._until:
            self.on, self._until = False, math.inf
        return self.on

    def _pass(self, time: float, x: float, speed: float, acceleration: float, turned: bool,
              ) -> None:
        """Find out which edges have been passed."""
        first = self._passed_ons is None
        if first and speed < 0.0:
            self._turn_round()
        was_on, was_off = self._passed_ons or 0, self._passed_offs
        at_on, at_off = (x + travel(speed, acceleration, lead) for lead in self._leads)
        self._passed_ons, self._low_on, self._high_on = self._ons.around(at_on)
        self._passed_offs, self._low_off, self._high_off = self._offs.around(at_off)
        forwards = self._sense > 0.0
        barred = self._track.direction is (
            Direction.NEGATIVE if forwards else Direction.POSITIVE)
        steps = self._passed_ons - was_on
        jumped = first or abs(steps) > self._ons.count
        if self._track.duration is not None:
            if not barred and not jumped and steps * self._sense > 0.0:
                edge = self._low_on if forwards else self._high_on
                self._trigger(time, edge - x, speed, acceleration)
            return
        on = not barred and self._passed_ons > self._passed_offs
        self.count += on and not self.on
        if not (on or self.on or barred or jumped or turned):
            # windows entered since the last tick that are left by now
            self.unseen += max(
                0, min(self._passed_ons, self._passed_offs) - was_on if forwards
                else was_off - max(self._passed_ons, self._passed_offs))
        self.on = on

    def _trigger(self, time: float, distance: float, speed: float, acceleration: float) -> None:
        """Switch on for the duration, from when exactly the edge was passed."""
        track = self._track
        passed = time + time_to(distance, speed, acceleration) + track.on_compensation
        if not passed <= time:
            passed = time
        passed = max(passed, min(time, self._last_time))
        self._until = passed + (track.duration or 0.0)
        if self._until <= time:
            self.unseen += 1
        elif not self.on:
            self.count += 1
            self.on = True
