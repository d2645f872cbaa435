# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Newton's method for the periodic motions of many designs at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

from cam_motion.drive.cells import Cells, Flags, Numbers, RULE, transform, weigh
from cam_motion.drive.designs import Shafts
from cam_motion.motion.piece import Array
import numpy as np
from numpy.polynomial import legendre

_STEPS = 12
_TOGETHER = 128  # designs whose systems fit into the cache of a core
CONVERGED = 1e-4
"""Relative change of the energy at which to stop; the error is of the order of its square."""

_LONGEST_STEP = 0.9  # share of the energy that a step may take

_INTEGRALS: Array = (np.linalg.inv(np.vander(RULE.points, increasing=True))
                     / np.arange(1.0, RULE.points.size + 1.0)[:, None])
_HIGHEST: Array = np.asarray(np.linalg.inv(
    legendre.legvander(2.0 * RULE.points - 1.0, RULE.points.size - 1))[-2:], dtype=np.float64)


class Nodes(NamedTuple):
    """
    Motions at the beginning, the Gauss points and the end of each cell.

    Kinetic energy E [J], inertia J of the whole shaft [kg m²], Q [N m] and dQ/dE [1/rad], shape
    (POINTS + 2, K, n) each.
    """

    energy: Array
    inertia: Array
    power: Array
    slope: Array


@dataclass(frozen=True)
class Motions:
    """
    One revolution of n designs.

    Attributes
    ----------
    shafts : Shafts
        The designs.
    cells : Cells
        The revolution, in K cells.
    energy : ndarray, shape (POINTS, K, n)
        Kinetic energy at the Gauss points [J].
    first : ndarray, shape (K + 1, n)
        Kinetic energy at the beginning of each cell and at the end of the last [J].
    multiplier : ndarray, shape (n,)
        By how much a disturbance of the energy is multiplied in one revolution [-]; nan where
        Newton's method did not converge.

    """

    shafts: Shafts
    cells: Cells
    energy: Array
    first: Array
    multiplier: Array

    def take(self, which: Numbers | Flags) -> Motions:
        """
        Take some of the designs.

        Parameters
        ----------
        which : ndarray
            Which ones.

        Returns
        -------
        Motions
            Theirs.

        """
        taken = Motions(self.shafts.take(which), self.cells.take(which), self.energy[..., which],
                        self.first[:, which], self.multiplier[which])
        if 'at_nodes' in vars(self):
            vars(taken)['at_nodes'] = Nodes(*(x[..., which] for x in self.at_nodes))
        return taken

    @cached_property
    def at_nodes(self) -> Nodes:
        """Give what is known at the beginning, the Gauss points and the end of each cell."""
        energy = np.concatenate([self.first[None, :-1], self.energy, self.first[None, 1:]])
        inertia = self.cells.inertia + self.shafts.inertia
        return Nodes(energy, inertia, *self.shafts.power(
            self.cells.force, self.cells.damping, inertia, energy))

    def roughness(self) -> Array:
        """
        Tell how much of Q is in the two highest polynomials that the Gauss points can hold.

        Returns
        -------
        ndarray, shape (n,)
            The greatest of all cells, as a change of the energy in the cell, relative.

        """
        high = self.cells.span * transform(_HIGHEST, self.at_nodes.power[1:-1]) / self.first[:-1]
        found: Array = np.max(np.abs(high), axis=(0, 1))
        return found

    @cached_property
    def polynomials(self) -> Array:
        """Give the coefficients of x, x², ... of the energy [J] in each cell, x from 0 to 1."""
        found: Array = self.cells.span * transform(_INTEGRALS, self.at_nodes.power[1:-1])
        return found

    def energy_at(self, q: Array) -> Array:
        """
        Give the energy at any angles.

        Parameters
        ----------
        q : ndarray, shape (..., 1)
            Shaft angles within one turn [rad].

        Returns
        -------
        ndarray, shape (..., n)
            Kinetic energy [J].

        """
        flat = q.reshape(-1, 1)
        mine = np.sum(self.cells.start[1:, None] <= flat, axis=0)
        start, span = (np.take_along_axis(x, mine, axis=0)
                       for x in (self.cells.start, self.cells.span))
        x = (flat - start) / span
        if mine.shape[1] == 1:
            first, terms = self.first[mine[:, 0]], self.polynomials[:, mine[:, 0]]
        else:
            first = np.take_along_axis(self.first, mine, axis=0)
            terms = np.take_along_axis(self.polynomials, mine[None], axis=1)
        energy: Array = first + x * horner(terms, x)
        return energy.reshape(*q.shape[:-1], -1)

    def over(self, cells: Cells) -> tuple[Array, Array]:
        """
        Give the energy in other cells.

        Parameters
        ----------
        cells : Cells
            Other cells of the same designs.

        Returns
        -------
        tuple[ndarray, ndarray]
            Energy [J] at their Gauss points, shape (POINTS, K', n), and at their ends,
            shape (K' + 1, n).

        """
        middle = cells.start + 0.5 * cells.span
        mine = np.sum(self.cells.start[1:, None] <= middle, axis=0)
        start, span = (
            np.take_along_axis(np.broadcast_to(x, self.first[1:].shape), mine, axis=0)
            for x in (self.cells.start, self.cells.span))
        terms = np.take_along_axis(self.polynomials, mine[None], axis=1)
        x = (cells.start + cells.span * _ENDS_TOO - start) / span
        energy = np.take_along_axis(self.first, mine, axis=0) + x * horner(terms[:, None], x)
        return energy[1:], np.concatenate([energy[0], energy[0, :1]])


_ENDS_TOO: Array = np.concatenate([[0.0], RULE.points])[:, None, None]


def horner(terms: Array, x: Array) -> Array:
    """
    Evaluate polynomials.

    Parameters
    ----------
    terms : ndarray, shape (m, ...)
        Coefficients of 1, x, x², ...
    x : ndarray
        Where.

    Returns
    -------
    ndarray
        The values.

    """
    value: Array = terms[-1]
    for term in terms[-2::-1]:
        value = value * x + term
    return value


def solve(guess: Motions, tolerance: float = CONVERGED) -> Motions:
    """
    Find the periodic motions by collocation.

    Parameters
    ----------
    guess : Motions
        Somewhere near.
    tolerance : ndarray, shape (n,)
        Relative change of the energy at which to stop.

    Returns
    -------
    Motions
        In the same cells.

    Notes
    -----
    The equations and the steps are those of `orbit.find_orbit`. In each cell the change of the
    energies is u times that at its beginning plus v; the cells are then joined up around the
    revolution, so that no system is larger than the Gauss points of a cell.

    """
    energy, first = np.empty_like(guess.energy), np.empty_like(guess.first)
    multiplier = np.full(guess.multiplier.shape, np.nan)
    for low in range(0, multiplier.size, _TOGETHER):
        active = np.arange(low, min(low + _TOGETHER, multiplier.size))
        now = guess.take(active)
        for _ in range(_STEPS):
            now, step, multipliers = _step(now)
            done, lost = step < tolerance, ~np.isfinite(step)
            if not (leave := done | lost).any():
                continue
            mine = active[done]
            energy[..., mine], first[:, mine] = now.energy[..., done], now.first[:, done]
            multiplier[mine] = multipliers[done]
            active = active[~leave]
            if not active.size:
                break
            now = now.take(~leave)
    return replace(guess, energy=energy, first=first, multiplier=multiplier)


def _step(now: Motions) -> tuple[Motions, Array, Array]:
    """Go a step, shortened where an energy would fall to zero; give its size and multipliers."""
    (energy, first), multiplier = _newton(now)
    share = energy / now.energy
    falling = np.maximum(np.max(-share, axis=(0, 1)), np.max(-first / now.first, axis=0))
    shorter = _LONGEST_STEP / np.maximum(falling, _LONGEST_STEP)
    size = np.max(np.abs(share), axis=(0, 1))
    return (replace(now, energy=now.energy + shorter * energy, first=now.first + shorter * first),
            size, multiplier)


def _newton(now: Motions) -> tuple[tuple[Array, Array], Array]:
    """Give the step of energies and first energies, and the multipliers."""
    inertia, force, damping = now.cells.inner
    span = now.cells.span
    power, slope = now.shafts.power(force, damping, inertia + now.shafts.inertia, now.energy)
    missing = now.first[:-1] + span * transform(RULE.matrix, power) - now.energy
    u, v = _eliminate(span * slope, missing)
    growth = 1.0 + span * weigh(RULE.weights, slope * u)
    gap = now.first[:-1] - now.first[1:] + span * weigh(RULE.weights, power + slope * v)
    count = growth.shape[0]
    change = np.empty_like(now.first)
    change[0], multiplier = 0.0, np.ones_like(growth[0])
    for k in range(count):
        change[k + 1] = growth[k] * change[k] + gap[k]
        multiplier = multiplier * growth[k]
    change[0] = change[count] / (1.0 - multiplier)
    for k in range(count):
        change[k + 1] = growth[k] * change[k] + gap[k]
    change[count] = change[0]
    return (change[:-1] * u + v, change), multiplier


def _eliminate(slope: Array, missing: Array) -> tuple[Array, Array]:
    """
    Solve (1 - M slope) u = 1 and (1 - M slope) v = missing in all cells of all designs.

    Gauss' elimination with all cells side by side; it needs no exchange of rows, as the matrix
    of the Gauss points is dominated by its lower triangle.
    """
    size = RULE.points.size
    left = -RULE.matrix[:, :, None, None] * slope
    for k in range(size):
        left[k, k] += 1.0
    u, v = np.ones_like(missing), missing
    for k in range(size - 1):
        factor = left[k + 1:, k] / left[k, k]
        left[k + 1:, k + 1:] -= factor[:, None] * left[k, None, k + 1:]
        u[k + 1:] -= factor * u[k]
        v[k + 1:] -= factor * v[k]
    for k in range(size - 1, -1, -1):
        u[k] /= left[k, k]
        v[k] /= left[k, k]
        u[:k] -= left[:k, k] * u[k]
        v[:k] -= left[:k, k] * v[k]
    return u, v
