# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The motion of a cam drive over one element of the shaft angle, as the energy solver finds it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from cam_motion.drive.cam_drive import CamDrive, Element
from cam_motion.drive.collocation import gauss_rule
from cam_motion.drive.load import Follower
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Peak
import numpy as np

_DENSE = 33  # points among which extremes are looked for before they are refined
_ROUNDS = 4  # each finds an extreme among as many points, sixteen times as close as before
_SECANTS = 5  # from a thirtieth of an element on, these reach rounding
_SAME = 1e-12  # share of a speed by which another is the same, rounded
_EVEN = np.linspace(0.0, 1.0, _DENSE)


@dataclass(frozen=True)
class Stretch:
    """
    One passage of an element.

    Attributes
    ----------
    drive : CamDrive
        The drive.
    element : Element
        The element, within one turn.
    time : float
        Time at its beginning [s].
    energy : float
        Kinetic energy at its beginning [J].
    powers : ndarray, shape (points,)
        Q(q, w), motor included, at the Gauss points [N m].
    slowness : ndarray, shape (points,)
        1 / w at the Gauss points [s/rad].

    """

    drive: CamDrive
    element: Element
    time: float
    energy: float
    powers: Array
    slowness: Array

    @property
    def span(self) -> float:
        """Measure the element [rad]."""
        return self.element.end - self.element.start

    @cached_property
    def energy_at_end(self) -> float:
        """Sum the kinetic energy at the end [J]."""
        rule = gauss_rule(self.powers.size)
        return self.energy + self.span * float(rule.weights @ self.powers)

    @cached_property
    def time_at_end(self) -> float:
        """Give the time at the end [s]."""
        rule = gauss_rule(self.powers.size)
        return self.time + self.span * float(rule.weights @ self.slowness)

    def omega(self, q: Array) -> Array:
        """
        Give the speed.

        Parameters
        ----------
        q : ndarray, shape (n,)
            Shaft angles within the element [rad].

        Returns
        -------
        ndarray, shape (n,)
            Speed of the cam shaft [rad/s].

        """
        _, omega = sample((self,), (q - self.element.start) / self.span)
        speed: Array = omega[0]
        return speed

    def times(self, q: Array) -> Array:
        """
        Give the times at which angles are passed.

        Parameters
        ----------
        q : ndarray, shape (n,)
            Shaft angles within the element [rad].

        Returns
        -------
        ndarray, shape (n,)
            Times [s].

        """
        rule = gauss_rule(self.powers.size)
        passed: Array = rule.row((q - self.element.start) / self.span) @ self.slowness
        return self.time + self.span * passed

    def motion(self, q: Array) -> tuple[Array, Array]:
        """
        Give speed and acceleration, the ends from inside.

        Parameters
        ----------
        q : ndarray, shape (n,)
            Shaft angles within the element [rad].

        Returns
        -------
        tuple[ndarray, ndarray]
            Speed [rad/s] and acceleration [rad/s²] of the cam shaft.

        """
        omega = self.omega(q)
        return omega, self.drive.acceleration(self.drive.follower(self.element, q), omega)

    def contact_force(self, q: Array, base: float) -> Array:
        """
        Give the force between cam and roller, the ends from inside.

        Parameters
        ----------
        q : ndarray, shape (n,)
            Shaft angles within the element [rad].
        base : float
            Distance of the roller's centre from the cam shaft at s = 0 [m].

        Returns
        -------
        ndarray, shape (n,)
            Force [N].

        """
        at = self.drive.follower(self.element, q)
        return self.drive.contact_force(at, *self.motion(q), base)

    def dense(self, count: int = _DENSE) -> Array:
        """
        Spread angles evenly over the element.

        Parameters
        ----------
        count : int
            How many, both ends included.

        Returns
        -------
        ndarray, shape (count,)
            Shaft angles [rad].

        """
        return np.linspace(self.element.start, self.element.end, count)

    def place(self, speed: float, low: float, high: float) -> float:
        """
        Find where the shaft passes a speed, by the secant method.

        Parameters
        ----------
        speed : float
            Speed of the cam shaft [rad/s].
        low, high : float
            Shaft angles before and behind it [rad].

        Returns
        -------
        float
            Shaft angle [rad].

        """
        ends = np.array([low, high])
        for _ in range(_SECANTS):
            at_low, at_high = self.omega(ends) - speed
            if at_low == at_high:
                break
            better = ends[1] - at_high * (ends[1] - ends[0]) / (at_high - at_low)
            ends = np.clip([ends[1], better], low, high)
        return float(ends[1])


def sample(stretches: Sequence[Stretch], x: Array) -> tuple[Follower, Array]:
    """
    Look up several stretches at once.

    Parameters
    ----------
    stretches : Sequence[Stretch]
        The n stretches, of one drive.
    x : ndarray, shape (m,)
        Places [-], from 0 at the beginning of each stretch to 1 at its end.

    Returns
    -------
    tuple[Follower, ndarray], shape (n, m) each
        Follower, and speed of the cam shaft [rad/s].

    """
    drive = stretches[0].drive
    at = Follower(*map(np.array, zip(*(
        drive.follower(s.element, s.element.start + s.span * x) for s in stretches))))
    powers = np.array([s.span * s.powers for s in stretches])
    energies = np.array([[s.energy] for s in stretches])
    energies = energies + powers @ gauss_rule(powers.shape[1]).row(x).T
    speed: Array = np.sqrt(2.0 * energies / drive.terms(at).inertia)
    return at, speed


def passing(stretches: Sequence[Stretch], speed: float) -> list[tuple[Stretch, float, bool]]:
    """
    Find where the shaft passes a speed.

    Parameters
    ----------
    stretches : Sequence[Stretch]
        Where to look.
    speed : float
        Speed of the cam shaft [rad/s].

    Returns
    -------
    list[tuple[Stretch, float, bool]]
        Stretch, shaft angle in it [rad], and whether upwards.

    """
    above = (sample(stretches, _EVEN)[1] - speed).ravel()
    clear = np.flatnonzero(np.abs(above) > _SAME * speed)
    up = above[clear] > 0.0
    found = []
    for k in np.flatnonzero(up[1:] != up[:-1]).tolist():
        (before, first), (row, last) = divmod(int(clear[k]), _DENSE), divmod(
            int(clear[k + 1]), _DENSE)
        stretch = stretches[row]
        q = stretch.dense()
        angle = stretch.place(speed, q[first], q[last]) if before == row else float(q[0])
        found.append((stretch, angle, bool(up[k + 1])))
    return found


def least(stretches: Sequence[Stretch], value: Callable[[Follower, Array], Array],
          sign: float = 1.0) -> Peak:
    """
    Find the least value of something over several stretches, steps taken from both sides.

    Parameters
    ----------
    stretches : Sequence[Stretch]
        Where to look.
    value : Callable[[Follower, ndarray], ndarray]
        Gives the value at followers and speeds of the cam shaft.
    sign : float
        -1 finds the greatest value instead.

    Returns
    -------
    Peak
        The value, refined between the points looked at, and its shaft angle [rad].

    """
    dense = sign * value(*sample(stretches, _EVEN))
    rows, lows = np.arange(len(stretches)), np.argmin(dense, axis=1)
    lowest = dense[rows, lows]
    around = np.maximum(dense[rows, np.maximum(lows - 1, 0)],
                        dense[rows, np.minimum(lows + 1, _DENSE - 1)])
    # a parabola dips less than a quarter of this between the points
    reach = lowest - (around - lowest)
    first = int(np.argmin(lowest))
    best, place = float(lowest[first]), (first, float(_EVEN[lows[first]]))
    for row in np.argsort(reach).tolist():
        if reach[row] >= best:
            break
        x, low = _EVEN, int(lows[row])
        for _ in range(_ROUNDS):
            x = np.linspace(x[max(low - 1, 0)], x[min(low + 1, _DENSE - 1)], _DENSE)
            values = sign * value(*sample(stretches[row:row + 1], x))[0]
            low = int(np.argmin(values))
        if values[low] < best:
            best, place = float(values[low]), (row, float(x[low]))
    stretch = stretches[place[0]]
    return Peak(sign * best, stretch.element.start + stretch.span * place[1])


def least_contact(stretches: Sequence[Stretch], base: float) -> Peak:
    """
    Find the least force between cam and roller, steps taken from both sides.

    Parameters
    ----------
    stretches : Sequence[Stretch]
        Where to look.
    base : float
        Distance of the roller's centre from the cam shaft at s = 0 [m].

    Returns
    -------
    Peak
        Force [N] and shaft angle [rad].

    """
    drive = stretches[0].drive
    return least(stretches, lambda at, omega: drive.contact_force(
        at, omega, drive.acceleration(at, omega), base))
