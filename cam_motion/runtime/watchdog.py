# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Watching a shaft that others turn: is it one shaft, does it go on, has it fallen silent."""

from __future__ import annotations

from cam_motion.runtime.plausibility import Plausibility
from cam_motion.runtime.point import Point

_GRACE = 0.3  # within this time [s] a master asked to stop along with us begins to slow down
_DEFAULT_PERIOD = 0.002
_KNOWN_AFTER = 5  # points in a row that fit each other make a shaft that is trusted


class ShaftWatch:
    """
    Remembers what the shaft last did, and tells points of that shaft from others.

    Some points in a row that fit each other in time, angle and speed make a shaft that is
    known. From then on points that do not go on from it, such as those of a second master, of
    a master that was started anew at another angle, or of a bag played from its beginning
    again, are refused: following them would make the axis jump.

    Parameters
    ----------
    timeout : float
        How long the shaft may be silent [s].
    plausible : Plausibility, optional
        What its points cannot do; None takes that of a shaft in radians.

    Attributes
    ----------
    last : Point | None
        The last point of the shaft.
    period : float
        Time from tick to tick [s].
    missed : int
        Ticks that did not come.
    refused, astray : int
        Points that did not go on from the shaft, ever and since its last one.
    reason : str
        What was wrong with the last one of them.

    """

    def __init__(self, timeout: float, plausible: Plausibility | None = None) -> None:
        """Know nothing yet."""
        self.timeout = timeout
        self._plausible = plausible or Plausibility()
        self.last: Point | None = None
        self.period = _DEFAULT_PERIOD
        self.missed = 0
        self.refused = 0
        self.astray = 0
        self.reason = ''
        self._arrival = 0.0  # steady time of the last point [s]
        self._fitting = 0  # points in a row that have fitted, up to the number that makes known
        self._unusual: float | None = None  # the last step that was not the period
        self._stop_from: float | None = None
        self._looked_at: Point | None = None  # the last point when it was asked for last
        self._silent_from = 0.0

    def note(self, point: Point, now: float) -> bool:
        """
        Take a point of the shaft.

        Parameters
        ----------
        point : Point
            Angle, speed and acceleration.
        now : float
            Steady time [s].

        Returns
        -------
        bool
            Whether it goes on from the shaft that is known.

        """
        last, plausible = self.last, self._plausible
        if last is not None:
            phi, omega, _, sec, nanosec = point
            phi_0, omega_0, _, sec_0, nanosec_0 = last
            step = sec - sec_0 + 1e-9 * (nanosec - nanosec_0)
            # the trapezoidal rule
            miss = phi - phi_0 - 0.5 * (omega + omega_0) * step
            if step > 0.0 and -plausible.tolerance <= miss <= plausible.tolerance:
                if not 0.5 * self.period < step < 1.5 * self.period:
                    self._note_step(step)
                if self._fitting < _KNOWN_AFTER:
                    self._fitting += 1
            elif not self._excused(point, last, step, miss):
                return False
        plausible.learn(point, self.period)
        self.last = point
        self._arrival = now
        self.astray = 0
        return True

    def _excused(self, point: Point, last: Point, step: float, miss: float) -> bool:
        """Look closer at a point that does not fit the last one at first sight."""
        plausible = self._plausible
        stands = point.velocity == 0.0 == last.velocity
        fits = plausible.accepts(point, last, step, miss, step > 1.5 * self.period)
        if fits and (step >= 0.0 and plausible.is_steady(point, last, step) or stands):
            # a time base that begins anew is no harm to a shaft that stands
            self._fitting = min(_KNOWN_AFTER, self._fitting + 1)
            if step > 0.0:
                self._note_step(step)
            return True
        if not self.known:
            self._fitting = 0
            plausible.forget()
            return True
        self.refused += 1
        self.astray += 1
        self.reason = (
            f'a shaft point {step:+.3g} s from the last one is at '
            f'{plausible.place(point.position)}, not near '
            f'{plausible.place(point.position - miss)} (is there a second master?)')
        if fits and step >= 0.0:
            self.reason = (f'the speed of the shaft steps from {last.velocity:.6g} to '
                           f'{point.velocity:.6g} {plausible.speed_unit}')
        return False

    def _note_step(self, step: float) -> None:
        """Tell lost ticks from another rate: a gap is followed by a step of the old length."""
        if self._unusual is not None and abs(step - self._unusual) < 0.5 * self._unusual:
            self.period, self._unusual = step, None
            return
        if step > 1.5 * self.period and self.known:
            self.missed += round(step / self.period) - 1
        elif not self.known:
            self.period = step
        self._unusual = step

    @property
    def known(self) -> bool:
        """Whether enough points have fitted each other to tell this shaft from others."""
        return self._fitting >= _KNOWN_AFTER

    @property
    def at_rest(self) -> bool:
        """Whether the shaft stands, or has never been seen."""
        return self.last is None or (self.last.velocity == 0.0 == self.last.acceleration)

    def age(self, now: float) -> float:
        """
        Tell how old the last point is.

        Parameters
        ----------
        now : float
            Steady time [s].

        Returns
        -------
        float
            Time since it arrived [s].

        """
        return now - self._arrival

    def lost(self, now: float) -> bool:
        """
        Tell whether a known shaft has fallen silent while it turned, or gone elsewhere.

        Parameters
        ----------
        now : float
            Steady time [s].

        Returns
        -------
        bool
            A shaft that stands may be silent, as long as nothing else is heard.

        """
        return self.known and self.age(now) > self.timeout and (
            not self.at_rest or self.astray > 0)

    def forget(self) -> None:
        """Begin anew: the next points may come from anywhere."""
        self.last, self._fitting, self.astray, self.reason = None, 0, 0, ''
        self._plausible.forget()

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
