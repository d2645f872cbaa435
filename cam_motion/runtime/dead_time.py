# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Making up for a dead time: where the shaft will be when what is told now takes effect."""

from __future__ import annotations

from cam_motion.runtime.cam_switch import travel
from cam_motion.runtime.shaft_motion import ShaftState


def ahead(state: ShaftState, lead: float, jerk: float = 0.0) -> ShaftState:
    """
    Extrapolate a shaft at constant acceleration; it comes to rest instead of turning round.

    Parameters
    ----------
    state : ShaftState
        The shaft now.
    lead : float
        How far ahead [s].
    jerk : float
        Rate of its acceleration now [rad/s³].

    Returns
    -------
    ShaftState
        The angle then, with its own derivatives with respect to the time now: what is told
        as a speed is the speed at which what is told as an angle changes.

    Notes
    -----
    φ + L (ω + L α / 2) has the derivatives ω + L (α + L j / 2) and α + L j. Where it comes to
    rest within L the angle is φ - ω² / (2 α), with ω² j / (2 α²) and ω j / α - ω² j² / α³. The
    speed steps by L² / 2 times any step of the jerk, because nobody can know of that before.

    """
    phi, omega, alpha = state
    place = phi + travel(omega, alpha, lead)
    if omega * alpha < 0.0 and abs(alpha * lead) > abs(omega):
        left = omega / alpha
        return ShaftState(place, 0.5 * left * left * jerk,
                          left * jerk * (1.0 - left * jerk / alpha))
    if omega == 0.0 == alpha:
        return ShaftState(place, 0.0, 0.0)
    return ShaftState(place, omega + lead * (alpha + 0.5 * lead * jerk), alpha + lead * jerk)


class DeadTime:
    """
    Extrapolates a shaft that is told point by point.

    Parameters
    ----------
    lead : float
        The dead time to make up for [s].

    """

    def __init__(self, lead: float) -> None:
        """Know no point yet."""
        self.lead = lead
        self._last: tuple[float, float] | None = None  # time [s] and acceleration [rad/s²]

    def ahead(self, time: float, state: ShaftState) -> ShaftState:
        """
        Give the shaft when what is told now takes effect.

        Parameters
        ----------
        time : float
            Time of the point [s].
        state : ShaftState
            The shaft then.

        Returns
        -------
        ShaftState
            The shaft as far ahead as the dead time, see `ahead`.

        """
        last, self._last = self._last, (time, state.alpha)
        if last is None or time <= last[0]:
            return ahead(state, self.lead)
        return ahead(state, self.lead, (state.alpha - last[1]) / (time - last[0]))
