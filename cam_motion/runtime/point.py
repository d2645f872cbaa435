# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""One sample of a motion on the machine's time base."""

from __future__ import annotations

from typing import NamedTuple


class Point(NamedTuple):
    """
    One sample of a motion on the machine's time base.

    For the shaft: angle [rad], speed [rad/s], acceleration [rad/s²]; for an axis its setpoint
    in its own unit, per s, per s². The time is ``sec`` + ``nanosec`` since the time base began.
    """

    position: float
    velocity: float
    acceleration: float
    sec: int
    nanosec: int

    @property
    def time(self) -> float:
        """Time since the machine's time base began [s]."""
        return self.sec + 1e-9 * self.nanosec
