# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Whether the followers of many designs stay on their cams, read off their periodic motions."""

from __future__ import annotations

from cam_motion.drive.batch_orbit import Motions
from cam_motion.drive.cells import LoadTable
from cam_motion.motion.piece import Array
import numpy as np


def least_follower_force(motions: Motions, table: LoadTable) -> Array:
    """
    Find the least force that presses each follower on the cam, along its own way.

    Parameters
    ----------
    motions : Motions
        The periodic motions.
    table : LoadTable
        Their load.

    Returns
    -------
    ndarray, shape (n,)
        Force [N], to two thousandths of its swing; negative where the follower would lift off.

    Notes
    -----
    The force is looked at where the load is tabulated, at places shared by all designs, the ends
    of every element from inside; between three of them it follows a parabola.

    """
    shafts, (at, terms) = motions.shafts, table.dense
    energy = motions.energy_at(at.q)
    inertia = terms.inertia + shafts.inertia
    square = 2.0 * energy / inertia
    power, _ = shafts.power(terms.force, terms.damping, inertia, energy)
    alpha = (power - terms.centripetal * square) / inertia
    force = table.follower_force(np.sqrt(square), alpha)
    before, middle, after = force[:-2], force[1:-1], force[2:]
    bend = before - 2.0 * middle + after
    dips = (middle <= before) & (middle <= after) & (bend > 0.0)
    dip = np.divide((after - before) ** 2, 8.0 * bend, out=np.zeros_like(bend), where=dips)
    found: Array = np.minimum(np.min(force, axis=(0, 1)), np.min(middle - dip, axis=(0, 1)))
    return found
