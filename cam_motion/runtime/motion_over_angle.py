# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Motions over the shaft angle: cams coupled to the shaft, sums of them, and standstill."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
import math
from typing import Protocol

from cam_motion.motion.compiled import Sampler
from cam_motion.motion.piece import Array
from cam_motion.motion.profile import CamProfile
from cam_motion.units import TURN
import numpy as np

_LOOKS = 33  # points between two joints among which passages are looked for


class Motion(Protocol):
    """What an axis does as a function of the shaft angle, for ever, in both directions."""

    @property
    def sample(self) -> Sampler:
        """Evaluate (y, y', y'', y''') at one shaft angle [rad]."""

    def __call__(self, phi: Array) -> Array:
        """
        Evaluate the motion and its derivatives.

        Parameters
        ----------
        phi : ndarray, shape (n,)
            Shaft angles [rad].

        Returns
        -------
        ndarray, shape (4, n)
            Position and three derivatives, in the unit of the axis per rad^order of the shaft.

        """

    def joints(self, low: float, high: float) -> Array:
        """
        Give the angles at which a derivative may step.

        Parameters
        ----------
        low, high : float
            Range of shaft angles [rad].

        Returns
        -------
        ndarray, shape (n,)
            Shaft angles, rising [rad].

        """


@dataclass(frozen=True)
class Standstill:
    """
    An axis that stands while the shaft turns.

    Attributes
    ----------
    position : float
        Where it stands, in the unit of the axis.

    """

    position: float

    @property
    def motion(self) -> Standstill:
        """Give what a transition to standstill leads to: this."""
        return self

    @cached_property
    def sample(self) -> Sampler:
        """Evaluate (y, 0, 0, 0) at any shaft angle."""
        values = (self.position, 0.0, 0.0, 0.0)
        return lambda phi: values

    def __call__(self, phi: Array) -> Array:
        """
        Evaluate the motion and its derivatives.

        Parameters
        ----------
        phi : ndarray, shape (n,)
            Shaft angles [rad].

        Returns
        -------
        ndarray, shape (4, n)
            Position and three derivatives, in the unit of the axis per rad^order of the shaft.

        """
        values = np.zeros((4, np.size(phi)))
        values[0] = self.position
        return values

    def joints(self, low: float, high: float) -> Array:
        """
        Give the angles of steps.

        Parameters
        ----------
        low, high : float
            Range of shaft angles [rad].

        Returns
        -------
        ndarray, shape (0,)
            None.

        """
        return np.empty(0)


@dataclass(frozen=True)
class CoupledCam:
    """
    A cam on the shaft: y = scale * cam(ratio * phi + phase) + offset.

    Attributes
    ----------
    profile : CamProfile
        The cam.
    ratio : float
        Turns of the cam per turn of the shaft [-]; not zero, negative turns it backwards.
    phase : float
        Angle of the cam at shaft angle 0 [rad].
    scale : float
        What the lifts are multiplied by [-].
    offset : float
        What is added to the position, in the unit of the axis.

    """

    profile: CamProfile
    ratio: float = 1.0
    phase: float = 0.0
    scale: float = 1.0
    offset: float = 0.0

    @property
    def advance(self) -> float:
        """Give what the axis gains in one turn of the cam, in its unit."""
        return self.scale * self.profile.advance

    @cached_property
    def sample(self) -> Sampler:
        """Evaluate (y, y', y'', y''') at one shaft angle [rad]."""
        inner, ratio, phase, offset = self.profile.sample, self.ratio, self.phase, self.offset
        if (ratio, phase, self.scale, offset) == (1.0, 0.0, 1.0, 0.0):
            return inner
        gains = [self.scale * ratio ** order for order in range(4)]
        gain, gain_1, gain_2, gain_3 = gains

        def coupled(phi: float) -> tuple[float, float, float, float]:
            y, slope, bend, jerk = inner(ratio * phi + phase)
            return gain * y + offset, gain_1 * slope, gain_2 * bend, gain_3 * jerk
        return coupled

    def __call__(self, phi: Array) -> Array:
        """
        Evaluate the motion and its derivatives.

        Parameters
        ----------
        phi : ndarray, shape (n,)
            Shaft angles [rad].

        Returns
        -------
        ndarray, shape (4, n)
            Position and three derivatives, in the unit of the axis per rad^order of the shaft.

        """
        at = self.ratio * phi + self.phase
        values = np.array([
            self.scale * self.ratio ** order * self.profile(at, order) for order in range(4)])
        values[0] += self.offset
        return values

    def joints(self, low: float, high: float) -> Array:
        """
        Give the angles of steps.

        Parameters
        ----------
        low, high : float
            Range of shaft angles [rad].

        Returns
        -------
        ndarray, shape (n,)
            Shaft angles of the joints of the cam [rad], rising.

        """
        ends = sorted((self.ratio * low + self.phase, self.ratio * high + self.phase))
        turns = np.arange(math.floor(ends[0] / TURN), math.floor(ends[1] / TURN) + 1) * TURN
        at = np.add.outer(turns, np.asarray(self.profile.curve.breaks[:-1])).ravel()
        at = np.sort((at - self.phase) / self.ratio)
        return at[(at >= low) & (at <= high)]


@dataclass(frozen=True)
class Cascade:
    """
    A motion that follows another one instead of the shaft: y = outer(inner(phi)).

    Attributes
    ----------
    outer : Motion
        The motion of the axis, over what it follows.
    inner : Motion
        What it follows, over the shaft angle.

    """

    outer: Motion
    inner: Motion

    @cached_property
    def sample(self) -> Sampler:
        """Evaluate position and three derivatives at one angle [rad]."""
        inner, outer = self.inner.sample, self.outer.sample

        def chained(phi: float) -> tuple[float, float, float, float]:
            at, slope, bend, jerk = inner(phi)
            y, y1, y2, y3 = outer(at)
            return (
                y, y1 * slope, y2 * slope * slope + y1 * bend,
                y3 * slope * slope * slope + 3.0 * y2 * slope * bend + y1 * jerk)
        return chained

    def __call__(self, phi: Array) -> Array:
        """
        Evaluate the motion and its derivatives, by the chain rule.

        Parameters
        ----------
        phi : ndarray, shape (n,)
            Shaft angles [rad].

        Returns
        -------
        ndarray, shape (4, n)
            Position and three derivatives, in the unit of the axis per rad^order of the shaft.

        """
        inner, slope, bend, jerk = self.inner(phi)
        y, y1, y2, y3 = self.outer(inner)
        return np.array([
            y, y1 * slope, y2 * slope ** 2 + y1 * bend,
            y3 * slope ** 3 + 3.0 * y2 * slope * bend + y1 * jerk])

    def joints(self, low: float, high: float) -> Array:
        """
        Give the angles of steps.

        Parameters
        ----------
        low, high : float
            Range of shaft angles [rad].

        Returns
        -------
        ndarray, shape (n,)
            Those of the inner motion, and where it passes joints of the outer one, rising [rad].

        """
        edges = np.unique(np.concatenate([[low, high], self.inner.joints(low, high)]))
        found = [self.inner.joints(low, high)]
        phi = np.unique(np.concatenate(
            [edges, *(np.linspace(a, b, _LOOKS) for a, b in zip(edges, edges[1:]))]))
        passed = self.inner(phi)[0]
        for at in self.outer.joints(float(passed.min()), float(passed.max())):
            k = np.flatnonzero((passed[:-1] - at) * (passed[1:] - at) < 0.0)
            share = (at - passed[k]) / (passed[k + 1] - passed[k])
            found.append(phi[k] + share * (phi[k + 1] - phi[k]))
        return np.unique(np.concatenate(found))


@dataclass(frozen=True)
class Superposition:
    """
    Several motions added up on one axis.

    Attributes
    ----------
    parts : Sequence[Motion]
        At least one.

    """

    parts: Sequence[Motion]

    @cached_property
    def sample(self) -> Sampler:
        """Evaluate (y, y', y'', y''') at one shaft angle [rad]."""
        samplers = [part.sample for part in self.parts]

        def added(phi: float) -> tuple[float, float, float, float]:
            y = slope = bend = jerk = 0.0
            for sampler in samplers:
                one, two, three, four = sampler(phi)
                y, slope, bend, jerk = y + one, slope + two, bend + three, jerk + four
            return y, slope, bend, jerk
        return added

    def __call__(self, phi: Array) -> Array:
        """
        Evaluate the motion and its derivatives.

        Parameters
        ----------
        phi : ndarray, shape (n,)
            Shaft angles [rad].

        Returns
        -------
        ndarray, shape (4, n)
            Position and three derivatives, in the unit of the axis per rad^order of the shaft.

        """
        return np.asarray(np.sum([part(phi) for part in self.parts], axis=0))

    def joints(self, low: float, high: float) -> Array:
        """
        Give the angles of steps.

        Parameters
        ----------
        low, high : float
            Range of shaft angles [rad].

        Returns
        -------
        ndarray, shape (n,)
            Those of all parts, rising [rad].

        """
        return np.unique(np.concatenate([part.joints(low, high) for part in self.parts]))
