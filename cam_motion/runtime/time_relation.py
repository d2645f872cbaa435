# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Where the ticks of the machine's time base lie on a clock."""

from __future__ import annotations

_JUMP_NS = 1_000_000_000  # a clock that is off by more has been set
_WINDOW_NS = 1_000_000_000  # over which the least delay is looked for
_LARGEST_RATE = 5e-4  # by which stamps may run faster or slower than the ticks


class TimeRelation:
    """
    Gives the stamps of ticks on a clock that is not theirs.

    Stamps keep the spacing of the ticks: what delays one tick or another does not show. Two
    clocks that drift apart are followed slowly, a clock that has been set at once.
    """

    def __init__(self) -> None:
        """Know no tick yet."""
        self._epoch: float | None = None  # clock time at which the time base began [ns]
        self._rate = 0.0
        self._last = self._window_end = 0
        self._least = 0.0

    def stamp(self, time_ns: int, now_ns: int) -> int:
        """
        Give the stamp of a tick.

        Parameters
        ----------
        time_ns : int
            Its time on the machine's time base [ns], rising from call to call.
        now_ns : int
            What the clock shows when it is heard of [ns].

        Returns
        -------
        int
            When it was on the clock, as nearly as the least delayed ticks tell [ns].

        """
        epoch = now_ns - time_ns
        if self._epoch is None or time_ns < self._last or abs(epoch - self._epoch) > _JUMP_NS:
            self._epoch, self._rate = float(epoch), 0.0
            self._least, self._window_end = 0.0, time_ns + _WINDOW_NS
        else:
            self._epoch += self._rate * (time_ns - self._last)
            self._least = min(self._least, epoch - self._epoch)
        self._last = time_ns
        if time_ns >= self._window_end:
            rate = self._least / _WINDOW_NS
            self._rate = min(max(rate, -_LARGEST_RATE), _LARGEST_RATE)
            self._least, self._window_end = float(_JUMP_NS), time_ns + _WINDOW_NS
        return round(self._epoch) + time_ns
