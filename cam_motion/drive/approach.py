# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The periodic motions of many designs, near enough for Newton's method: by revolutions."""

from __future__ import annotations

from typing import NamedTuple

from cam_motion.drive.cells import Flags, LoadTable
from cam_motion.drive.designs import Shafts
from cam_motion.motion.piece import Array
import numpy as np

_ROUNDS = 12
_NEAR = 1e-3  # change of the energy at q = 0, relative
_CORRECTIONS = 2
_SCANS, _SCANNED = 2, 8  # the second between the neighbours of the best
_SLOWEST = 0.9  # slip
_STALLED = 0.01  # share of its energy below which a shaft does not fall within a step
_LONGEST_STEP = 0.7  # share of the speed that a step may take


class Revolution(NamedTuple):
    """
    One revolution from given energies.

    The energy after it [J], the derivative of that with respect to the energy before [-], whether
    the shaft stalled, the speeds [rad/s] at all nodes, shape (nodes, n).
    """

    energy: Array
    multiplier: Array
    stalled: Flags
    speeds: Array


class Road:
    """
    The load at evenly spread angles of each element, both ends included.

    Parameters
    ----------
    table : LoadTable
        The load.
    steps : int
        Steps per element of the drive.

    """

    def __init__(self, table: LoadTable, steps: int) -> None:
        self.steps = steps
        x = np.linspace(0.0, 1.0, steps + 1)
        places = [low + (high - low) * x for low, high in zip(table.edges, table.edges[1:])]
        columns = [table.terms(k, q) for k, q in enumerate(places)]
        self.q = np.concatenate(places)
        self.inertia, _, self.force, self.damping = np.concatenate(columns, axis=1)

    def revolve(self, shafts: Shafts, energy: Array) -> Revolution:
        """
        Go through one revolution.

        Parameters
        ----------
        shafts : Shafts
            The designs.
        energy : ndarray, shape (n,)
            Kinetic energy at q = 0 [J].

        Returns
        -------
        Revolution
            What comes of it, by the trapezoidal rule: good to about 1e-3.

        """
        inertia = self.inertia[0] + shafts.inertia
        speeds = np.empty((self.q.size, energy.size))
        speeds[0] = np.sqrt(2.0 * energy / inertia)
        power, slope = shafts.power(self.force[0], self.damping[0], inertia, energy)
        exponent = np.zeros_like(energy)
        stalled = np.zeros(energy.shape, dtype=bool)
        for k in range(1, self.q.size):
            half = 0.5 * (self.q[k] - self.q[k - 1])
            ahead = self.inertia[k] + shafts.inertia
            lowest = _STALLED * energy
            known = energy + half * power
            exponent += half * slope
            energy = energy * (ahead / inertia)  # at constant speed, to begin with
            for _ in range(_CORRECTIONS):
                power, slope = shafts.power(self.force[k], self.damping[k], ahead, energy)
                damped = np.minimum(slope, 0.0)
                better = (known + half * (power - damped * energy)) / (1.0 - half * damped)
                falls = ~(better > lowest)
                better = np.where(falls, lowest, better)
                power = power + slope * (better - energy)
                energy = better
            stalled |= falls
            exponent += half * slope
            inertia = ahead
            speeds[k] = np.sqrt(2.0 * energy / inertia)
        return Revolution(energy, np.exp(exponent), stalled, speeds)


def approach(shafts: Shafts, road: Road) -> tuple[Array, Array]:
    """
    Find about where the periodic motions are.

    Parameters
    ----------
    shafts : Shafts
        The designs.
    road : Road
        The load.

    Returns
    -------
    tuple[ndarray, ndarray]
        The speeds at the nodes of the road [rad/s], shape (nodes, n), and whether there is a
        periodic motion, shape (n,): 1 yes, 0 no, nan not known.

    Notes
    -----
    The energy after a revolution rises with the energy before it: no motion overtakes another.
    What is gained in a revolution, over the speed at q = 0, is about the torque of the motor over
    its speed and bends as that does. From the synchronous speed Newton's method therefore comes
    down to the periodic motion, mostly without passing it. Where the shaft stalls, and a faster
    start would end no faster, there is no periodic motion. Where Newton's method arrives at
    speeds at which energy is lost, but no longer less of it at lower speeds, it goes on from the
    working speed that gains most, and there is no periodic motion if none gains any.

    """
    energy = 0.5 * (road.inertia[0] + shafts.inertia) * shafts.idle_speed ** 2
    speeds, exists = _newton(shafts, road, energy)
    passed = np.flatnonzero(np.isneginf(exists))
    if passed.size:
        some = shafts.take(passed)
        energy, gained = _best(some, road)
        exists[passed] = 0.0
        gains = gained > 0.0
        again = passed[gains]
        if again.size:
            speeds[:, again], exists[again] = _newton(some.take(gains), road, energy[gains])
    return speeds, exists


def _newton(shafts: Shafts, road: Road, energy: Array) -> tuple[Array, Array]:
    """Go on from energies; where that passes beyond the breakdown, it is -inf that exists."""
    count = shafts.ratio.size
    speeds = np.full((road.q.size, count), np.nan)
    exists = np.full(count, np.nan)
    active = np.arange(count)
    for _ in range(_ROUNDS):
        turn = road.revolve(shafts, energy)
        gained = turn.energy - energy
        contracts = turn.multiplier < 1.0
        stalls = turn.stalled & (gained < _NEAR * energy)
        passed = ~turn.stalled & (gained < 0.0) & ~contracts
        step = np.where(turn.stalled, gained, np.where(
            contracts, gained / (1.0 - turn.multiplier), 0.5 * energy))
        near = ~turn.stalled & ~passed & (np.abs(step) < _NEAR * energy)
        exists[active[stalls]], exists[active[passed]], exists[active[near]] = 0.0, -np.inf, 1.0
        speeds[:, active[near]] = turn.speeds[:, near]
        keep = ~(stalls | passed | near)
        active = active[keep]
        if not active.size:
            break
        share = np.maximum(0.5 * step / energy, -_LONGEST_STEP)[keep]
        energy = energy[keep] * (1.0 + share) ** 2
        shafts = shafts.take(keep)
    return speeds, exists


def _best(shafts: Shafts, road: Road) -> tuple[Array, Array]:
    """Find the energy at q = 0 with which a revolution gains most, and what it gains."""
    count = shafts.ratio.size
    inertia = road.inertia[0] + shafts.inertia
    high = shafts.idle_speed
    low = (1.0 - np.minimum(shafts.breakdown_slip, _SLOWEST)) * high
    for _ in range(_SCANS):
        omega = low + (high - low) * np.linspace(0.0, 1.0, _SCANNED)[:, None]
        energy = 0.5 * inertia * omega ** 2
        many = shafts.take(np.tile(np.arange(count), _SCANNED))
        turn = road.revolve(many, energy.ravel())
        gained = np.where(turn.stalled, -np.inf, turn.energy - energy.ravel())
        gained = gained.reshape(_SCANNED, count)
        best, each = np.argmax(gained, axis=0), np.arange(count)
        low = omega[np.maximum(best - 1, 0), each]
        high = omega[np.minimum(best + 1, _SCANNED - 1), each]
    return energy[best, each], gained[best, each]
