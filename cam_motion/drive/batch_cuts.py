# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The periodic motions of many designs in cells that end wherever Q has a kink."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import NamedTuple

from cam_motion.drive.approach import Road
from cam_motion.drive.batch_figures import reversals
from cam_motion.drive.batch_orbit import Motions, solve
from cam_motion.drive.cells import Cells, LoadTable, NODES, Numbers
from cam_motion.drive.designs import Shafts
from cam_motion.motion.piece import Array
import numpy as np

_PASSES = 5
_PLACED = 5e-6  # a cut misplaced by this [rad] changes speeds by its square, the multiplier by it
_LOOSE = 5e-3  # relative change of the energy at which to stop before anything is cut
_ROUGH = 1e-4  # roughness above which a cell is too long


class _Group(NamedTuple):
    """Some designs, with equally many cells; without cuts as long as they are solved loosely."""

    numbers: Numbers
    motions: Motions
    cuts: Array | None
    halvings: int


def periodic(shafts: Shafts, table: LoadTable, road: Road, speeds: Array, halvings: int,
             ) -> Iterator[tuple[Numbers, Motions]]:
    """
    Solve, cut where the power reverses or where Q is rough, and solve again until it stands.

    Parameters
    ----------
    shafts : Shafts
        The designs.
    table : LoadTable
        The load.
    road : Road
        The nodes of the guess.
    speeds : ndarray, shape (nodes, n)
        Speeds at them, near the periodic motions [rad/s].
    halvings : int
        How often to halve the elements to begin with.

    Yields
    ------
    tuple[ndarray, Motions]
        Numbers of some designs, and their periodic motions. Designs for which Newton's method
        does not converge never come.

    """
    guess = _guess(shafts, table.halved(halvings), table.edges, road.steps, speeds)
    lossy = shafts.driving < shafts.driven
    smooth, kinked = np.flatnonzero(~lossy), np.flatnonzero(lossy)
    pending = [
        _Group(smooth, solve(guess.take(smooth)), np.empty((0, smooth.size)), halvings),
        _Group(kinked, solve(guess.take(kinked), _LOOSE), None, halvings)]
    for _ in range(_PASSES):
        following = []
        for group in pending:
            done, rest = _cut(group, table)
            yield from done
            following += rest
        pending = following


def _guess(shafts: Shafts, cells: Cells, edges: Array, steps: int, speeds: Array) -> Motions:
    """Interpolate between speeds at steps within each element."""
    element = cells.element
    x = (cells.start + cells.span * NODES[:, None, None] - edges[element]) / (
        edges[element + 1] - edges[element])
    before = np.clip((x * steps).astype(int), 0, steps - 1)
    share = x * steps - before
    at = (element * (steps + 1) + before)[..., 0]
    omega = (1.0 - share) * speeds[at] + share * speeds[at + 1]
    energy = 0.5 * (cells.inertia + shafts.inertia) * omega * omega
    ends = np.concatenate([energy[0], energy[0, :1]])
    return Motions(shafts, cells, energy[1:-1], ends, np.full(shafts.ratio.size, np.nan))


def _cut(group: _Group, table: LoadTable,
         ) -> tuple[list[tuple[Numbers, Motions]], list[_Group]]:
    """Tell which designs of a group are done; cut the others and solve them again."""
    done, rest = [], []
    found = np.isfinite(group.motions.multiplier)
    counts, angles = reversals(group.motions)
    ends = np.cumsum(counts)
    rough = group.motions.roughness() > _ROUGH
    for count, more in product(np.unique(counts[found]).tolist(), (0, 1)):
        mine = np.flatnonzero(found & (counts == count) & (rough == bool(more)))
        cuts = angles[ends[mine] - count + np.arange(count)[:, None]]
        placed = np.zeros(mine.size, dtype=bool)
        if group.cuts is not None and len(group.cuts) == count and not more:
            placed = np.all(np.abs(cuts - group.cuts[:, mine]) < _PLACED, axis=0)
            done.append((group.numbers[mine[placed]], group.motions.take(mine[placed])))
        if not placed.all():
            mine, cuts = mine[~placed], cuts[:, ~placed]
            halvings = group.halvings + more
            motions = group.motions.take(mine)
            cells = table.split(cuts, halvings)
            energy, first = motions.over(cells)
            again = solve(replace(motions, cells=cells, energy=energy, first=first))
            rest.append(_Group(group.numbers[mine], again, cuts, halvings))
    return done, rest
