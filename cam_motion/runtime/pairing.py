# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Points of several sources that belong to the same tick, found by their time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from cam_motion.runtime.point import Point

_WAITING = 64  # ticks that may wait for a source that lags behind the others


class Pairing:
    """
    Collects points until every source has told its own of a tick.

    Points of one source may come before or after those of another. Ticks that another one
    overtakes, and the oldest of too many, are given up.

    Parameters
    ----------
    sources : Iterable[str]
        Names of the sources.

    Attributes
    ----------
    unpaired : int
        Ticks that have been given up.

    """

    def __init__(self, sources: Iterable[str]) -> None:
        """Wait for the first tick."""
        self._sources = frozenset(sources)
        self._waiting: dict[tuple[int, int], dict[str, Point]] = {}
        self.unpaired = 0

    def take(self, source: str, point: Point) -> Mapping[str, Point] | None:
        """
        Take a point.

        Parameters
        ----------
        source : str
            Name of its source.
        point : Point
            The point.

        Returns
        -------
        Mapping[str, Point] | None
            The points of all sources, when this one has made a tick complete.

        """
        tick = self._waiting.setdefault((point.sec, point.nanosec), {})
        tick[source] = point
        if len(tick) < len(self._sources):
            if len(self._waiting) > _WAITING:
                del self._waiting[next(iter(self._waiting))]
                self.unpaired += 1
            return None
        for time in list(self._waiting):  # in the order in which they came
            if self._waiting.pop(time) is tick:
                break
            self.unpaired += 1
        return tick

    def missing(self) -> list[str]:
        """
        List the sources that the newest tick still waits for.

        Returns
        -------
        list[str]
            Their names; all where nothing has come.

        """
        newest = next(reversed(self._waiting.values()), {})
        return sorted(self._sources - set(newest))
