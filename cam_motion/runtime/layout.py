# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""How the cams of an axis are coupled to the shaft, and the motion that comes of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
import math
from typing import NamedTuple

from cam_motion.motion.limits import Limits, SpeedBound
from cam_motion.motion.profile import CamProfile
from cam_motion.runtime.demand import AnyPhase, Demand, Demands
from cam_motion.runtime.motion_over_angle import CoupledCam, Motion, Superposition
from cam_motion.runtime.planning import TransitionError
from cam_motion.runtime.ramp import RampLimits
from cam_motion.units import TURN

LARGEST_SHARE = 1000
"""Largest denominator of two ratios that are looked upon as commensurable."""

MOST_TURNS = 16.0
"""Turns over which a motion is looked at as a whole; one that repeats later, in any phase."""

EQUAL = 1e-9
"""By how much two ratios may miss a rational share."""

_STEADY = RampLimits(0.0, 0.0)
_AHEAD = 1e-9  # strokes or turns: this far behind still counts as there, for rounding


class Cycle(NamedTuple):
    """Shaft angle at which a cycle begins, and the one after which the next does [rad]."""

    begin: float
    period: float


class Coupling(NamedTuple):
    """
    How one cam is coupled: y = scale * cam(ratio * phi + phase) + offset.

    The ``ratio`` [-] is turns of the cam per turn of the shaft, the ``phase`` an angle of the
    cam [rad], the ``scale`` [-] multiplies its lifts, the ``offset`` is in the axis' unit.
    """

    ratio: float = 1.0
    phase: float = 0.0
    scale: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Layout:
    """
    The cams that make up the motion of an axis, and where they are anchored.

    Attributes
    ----------
    cams : Mapping[str, CamProfile]
        All cams of the axis.
    couplings : Mapping[str, Coupling]
        The coupling of each cam.
    active : tuple[str, ...]
        Names of the cams that are summed, at least one.
    origin : float
        Shaft angle at which the cams stand at their phase [rad]: 0 for a coupling that is
        absolute on the side of the master.
    shift : float
        Added to the position, in the axis' unit: 0 for one that is absolute on the side of
        the axis.

    """

    cams: Mapping[str, CamProfile]
    couplings: Mapping[str, Coupling]
    active: tuple[str, ...]
    origin: float = 0.0
    shift: float = 0.0

    @property
    def motion(self) -> Motion:
        """Make the motion over the shaft angle."""
        parts = [self._cam(name) for name in self.active]
        first = parts[0]
        parts[0] = CoupledCam(
            first.profile, first.ratio, first.phase, first.scale, first.offset + self.shift)
        return parts[0] if len(parts) == 1 else Superposition(tuple(parts))

    def _cam(self, name: str) -> CoupledCam:
        ratio, phase, scale, offset = self.couplings[name]
        return CoupledCam(self.cams[name], ratio, phase - ratio * self.origin, scale, offset)

    @property
    def advance(self) -> float:
        """Sum what the axis gains in one turn of the shaft, in its unit."""
        return sum(self._cam(name).advance * self.couplings[name].ratio for name in self.active)

    @property
    def _strokes(self) -> list[tuple[float, float]]:
        return [(self.couplings[name].ratio, self._cam(name).advance) for name in self.active]

    @property
    def accumulates(self) -> bool:
        """Whether the axis gains something in each cycle, as a belt does."""
        return any(self.cams[name].advance for name in self.active)

    @property
    def period(self) -> float:
        """Shaft angle after which all repeats but for what is gained [rad]; infinite if never."""
        ratios = [abs(self.couplings[name].ratio) for name in self.active]
        first = ratios[0]
        shares = [Fraction(ratio / first).limit_denominator(LARGEST_SHARE) for ratio in ratios]
        if any(abs(share - ratio / first) > EQUAL * share
               for share, ratio in zip(shares, ratios)):
            return math.inf
        return TURN / first * math.lcm(*(share.denominator for share in shares)) / math.gcd(
            *(share.numerator for share in shares))

    @property
    def cycle(self) -> Cycle:
        """Say where the cycles of the axis begin and end, those of the first cam if none else."""
        ratio, phase, *_ = self.couplings[self.active[0]]
        return Cycle(self.origin - phase / ratio, (
            self.period if math.isfinite(self.period) else TURN / abs(ratio)))

    @property
    def stroke(self) -> float:
        """Give what is all the same to the axis as it has gained it, a magnitude in its unit."""
        period = self.period
        return abs(self.advance * period / TURN) if math.isfinite(period) else 0.0

    @cached_property
    def course(self) -> Demands:
        """Give what the motion demands for ever."""
        cams = [self._cam(name) for name in self.active]
        parts = [Demand(cam, self.origin, self.origin + TURN / abs(cam.ratio)) for cam in cams]
        period = self.period
        if len(cams) > 1 and period * max(abs(cam.ratio) for cam in cams) <= MOST_TURNS * TURN:
            parts = [Demand(self.motion, self.origin, self.origin + period)]
        return parts[0] if len(parts) == 1 else AnyPhase(tuple(parts))

    def begun_at(self, start: float) -> Layout:
        """
        Let the cams begin at a shaft angle: relative on the side of the master.

        Parameters
        ----------
        start : float
            Shaft angle at which they stand at their phase [rad].

        Returns
        -------
        Layout
            The layout so anchored.

        """
        return replace(self, origin=start)

    def lifted_to(self, y: float, start: float) -> Layout:
        """
        Shift the motion through a position: relative on the side of the axis.

        Parameters
        ----------
        y : float
            Position, in the unit of the axis.
        start : float
            Shaft angle at which it is passed [rad].

        Returns
        -------
        Layout
            The layout so anchored.

        """
        return replace(self, shift=self.shift + y - self.motion.sample(start)[0])

    def ahead_of(self, y: float, start: float, sense: float) -> Layout:
        """
        Shift a belt by whole strokes, which are all the same to it, until it lies ahead.

        Parameters
        ----------
        y : float
            Position at which the axis stands, in its unit.
        start : float
            Shaft angle at which it joins [rad].
        sense : float
            -1 for a shaft that turns backwards.

        Returns
        -------
        Layout
            The layout so anchored: at that angle less than a stroke ahead, in the direction in
            which the belt travels. Unchanged for an axis that returns.

        """
        there = self.motion.sample(start)[0]
        return self.shifted(self.strokes_ahead(there, y, sense))

    def strokes_ahead(self, place: float, y: float, sense: float) -> float:
        """
        Find the whole strokes that a place lacks to lie ahead of a position.

        Parameters
        ----------
        place, y : float
            The place and the position, in the unit of the axis.
        sense : float
            -1 for a shaft that turns backwards.

        Returns
        -------
        float
            The strokes, in the unit of the axis, either way: the place so shifted lies less than
            one stroke ahead in the direction of travel. 0 for an axis that returns.

        """
        stroke = self.stroke
        if not stroke:
            return 0.0
        ahead = math.copysign(stroke, self.advance * sense)
        return math.ceil((y - place) / ahead - _AHEAD) * ahead

    def anchored_as(self, old: Layout) -> Layout:
        """
        Anchor a layout where another one is anchored.

        Parameters
        ----------
        old : Layout
            The other one.

        Returns
        -------
        Layout
            This one with its origin and shift.

        """
        return replace(self, origin=old.origin, shift=old.shift)

    def continuing(self, old: Layout, start: float, sense: float) -> Layout:
        """
        Anchor a layout where another one is anchored that it takes over from.

        Parameters
        ----------
        old : Layout
            The layout before.
        start : float
            Shaft angle at which this one takes over [rad].
        sense : float
            -1 for a shaft that turns backwards.

        Returns
        -------
        Layout
            The layout so anchored. A belt with other strokes goes on from where it stands at
            the start, or, where it moves then, from where its last cycle began, whatever it has
            gained before.

        """
        new = self.anchored_as(old)
        if new.keeps_register(old):
            return new
        begin = start
        if old.motion.sample(start)[1] or new.motion.sample(start)[1]:
            origin, period = old.cycle
            begin = origin + sense * math.floor(
                sense * (start - origin) / period + _AHEAD) * period
        gap = old.motion.sample(begin)[0] - new.motion.sample(begin)[0]
        return new.shifted(gap)

    def keeps_register(self, old: Layout) -> bool:
        """
        Tell whether positions of another layout mean the same in this one.

        Parameters
        ----------
        old : Layout
            The other one.

        Returns
        -------
        bool
            False for belts of which the strokes differ: each has its own count of them.

        """
        return (not (self.accumulates or old.accumulates)) or self._strokes == old._strokes

    def shifted(self, gap: float) -> Layout:
        """
        Shift the motion.

        Parameters
        ----------
        gap : float
            By how much, in the unit of the axis.

        Returns
        -------
        Layout
            The layout so shifted.

        """
        return replace(self, shift=self.shift + gap)

    def check_range(self, limits: Limits, anywhere: bool = False) -> None:
        """
        Check that the axis stays within its positions.

        Parameters
        ----------
        limits : Limits
            Limits of the axis.
        anywhere : bool
            Whether it is to be known only later where the motion lies: it must fit between.

        Raises
        ------
        TransitionError
            When it would leave them, with the figures; an axis that accumulates does in time.

        """
        lowest, highest = limits.positions
        if (lowest, highest) == (-math.inf, math.inf):
            return
        if self.advance:
            raise TransitionError(
                f'the axis gains {self.advance:.6g} in each turn and so leaves any range of '
                f'positions ({limits.lowest} to {limits.highest}) in time: leave lowest and '
                'highest out, or take cams that return')
        course = self.course
        y = course.values[0]
        low, high = float(y.min()), float(y.max())
        if anywhere and high - low > (highest - lowest) * (1.0 + 1e-9):
            raise TransitionError(
                f'the motion takes {high - low:.6g}, more than the limits of position leave '
                f'({limits.lowest} to {limits.highest}): take a smaller scale')
        if not anywhere and not course.keeps_range(limits):
            raise TransitionError(
                f'the motion would go from {low:.6g} to {high:.6g}, beyond the limits of '
                f'position ({limits.lowest} to {limits.highest}): take another offset or scale')

    def speed_bound(self, limits: Limits) -> SpeedBound | None:
        """
        Find the highest steady speed of the shaft at which the limits hold.

        Parameters
        ----------
        limits : Limits
            Limits of the axis.

        Returns
        -------
        SpeedBound | None
            The bound, exact and with its segment for a single cam; None where nothing limits
            the speed.

        """
        if len(self.active) == 1:
            ratio, _, scale, _ = self.couplings[self.active[0]]
            if scale == 0.0:
                return None
            gain = abs(scale)
            seen = Limits(*(
                None if (limit := limits.of_order(order)) is None
                else limit / (gain * abs(ratio) ** order) for order in (1, 2, 3)))
            bound = seen.highest_speed(self.cams[self.active[0]])
            if bound is None:
                return None
            limit = limits.of_order(('velocity', 'acceleration', 'jerk').index(bound.quantity) + 1)
            return bound._replace(limit=math.nan if limit is None else limit)
        omega = self.course.highest_speed(limits, _STEADY)
        if math.isinf(omega):
            return None
        return SpeedBound(omega, 'limits', math.nan, '+'.join(self.active), math.nan)
