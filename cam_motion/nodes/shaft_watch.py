# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Watching a shaft that others turn: whether it stands, comes to rest, or goes on."""

from __future__ import annotations

from cam_motion.nodes.wire import Point

_GRACE = 0.3  # within this time [s] a master asked to stop along with us begins to slow down
_DEFAULT_PERIOD = 0.002


class ShaftWatch:
    """
    Remembers what the shaft last did.

    Attributes
    ----------
    last : Point | None
        The last point of the shaft.
    period : float
        Time between the last two points [s].

    """

    def __init__(self) -> None:
        """Know nothing yet."""
        self.last: Point | None = None
        self.period = _DEFAULT_PERIOD
        self._stop_from: float | None = None
        self._looked_at: Point | None = None  # the last point when it was asked for last
        self._silent_from = 0.0

    def note(self, point: Point) -> None:
        """
        Take a point of the shaft.

        Parameters
        ----------
        point : Point
            Angle, speed and acceleration.

        """
        if self.last is not None:
            step = point.sec - self.last.sec + 1e-9 * (point.nanosec - self.last.nanosec)
            if step > 0.0:
                self.period = step
        self.last = point

    @property
    def at_rest(self) -> bool:
        """Whether the shaft stands, or has never been seen."""
        return self.last is None or (self.last.velocity == 0.0 == self.last.acceleration)

    def begin_stop(self, now: float) -> None:
        """
        Begin to wait for the shaft to come to rest.

        Parameters
        ----------
        now : float
            Steady time [s].

        """
        self._stop_from = now

    def goes_on(self, now: float) -> bool:
        """
        Tell whether the shaft goes on although it has been waited for.

        Parameters
        ----------
        now : float
            Steady time [s].

        Returns
        -------
        bool
            True when it turns, the time of grace is over, and it is not slowing down or has
            fallen silent. Not to be asked of a shaft `at_rest`.

        """
        if self.last is None or self._stop_from is None or now < self._stop_from + _GRACE:
            return False
        if self.last is not self._looked_at:
            self._looked_at, self._silent_from = self.last, now
        if now - self._silent_from > _GRACE:
            return True  # silent while it turned: whoever waited for it would wait for ever
        return self.last.velocity * self.last.acceleration >= 0.0
