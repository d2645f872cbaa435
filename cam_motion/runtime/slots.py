# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A stream thinned out to a lower rate, by the time of what it carries."""

from __future__ import annotations

from cam_motion.runtime.ticks import NANOSECONDS


class Slots:
    """
    Lets the first tick of each period through.

    Parameters
    ----------
    rate : float
        Periods per second [Hz]; 0 lets every tick through.

    """

    def __init__(self, rate: float) -> None:
        """Let the first tick through."""
        self._rate = rate
        self._slot: int | None = None

    def due(self, time_ns: int) -> bool:
        """
        Tell whether a tick is the first of its period.

        Parameters
        ----------
        time_ns : int
            Time of the tick on the machine's time base [ns].

        Returns
        -------
        bool
            Whether it is.

        """
        slot = int(time_ns * self._rate) // NANOSECONDS
        if self._rate and slot == self._slot:
            return False
        self._slot = slot
        return True
