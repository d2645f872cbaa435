# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The machine's time base in the node's time, for the stamps of what answers a tick."""

from __future__ import annotations

from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.runtime.ticks import NANOSECONDS


class TimeBase:
    """
    Translates times of ticks into stamps, so that these are as uniform as the ticks.

    Parameters
    ----------
    node : ManagedNode
        The node whose clock the stamps are in.

    """

    def __init__(self, node: ManagedNode) -> None:
        """Wait for the first tick."""
        self._node = node
        self._epoch_ns: int | None = None  # node time at which the machine's time base began

    def forget(self) -> None:
        """Begin anew with the next tick."""
        self._epoch_ns = None

    @property
    def known(self) -> bool:
        """Whether a tick has been noted."""
        return self._epoch_ns is not None

    def begins(self, time_ns: int) -> bool:
        """
        Take note of a tick.

        Parameters
        ----------
        time_ns : int
            Its time on the machine's time base [ns].

        Returns
        -------
        bool
            Whether it is the first, or the first since /clock has jumped back: the machine's time
            base goes on then, stamps do not.

        """
        if self._epoch_ns is not None and not self._clock_started_over(time_ns):
            return False
        self._epoch_ns = self._node.get_clock().now().nanoseconds - time_ns
        return True

    def stamp(self, time_ns: int) -> int:
        """
        Give the stamp of a tick that has been noted.

        Parameters
        ----------
        time_ns : int
            Its time on the machine's time base [ns].

        Returns
        -------
        int
            The same in the node's time [ns].

        """
        return (self._epoch_ns or 0) + time_ns

    def _clock_started_over(self, time_ns: int) -> bool:
        if not self._node.sim_time:
            return False
        return self._node.get_clock().now().nanoseconds < self.stamp(time_ns) - NANOSECONDS
