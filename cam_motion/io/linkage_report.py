# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A recorded linkage: whether its loops were closed all the time, and how far its inputs went."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from cam_motion.io.bag import JointStateSeries
from cam_motion.mechanism.assembly import Assembly
import numpy as np

_CLOSED = 1e-9  # what loops may miss by, of the size of the linkage: rounding, and nothing else


@dataclass(frozen=True)
class LinkageReport:
    """
    What a linkage did.

    Attributes
    ----------
    states : int
        Joint states recorded.
    gap : float
        The most by which its loops failed to close [m].
    slip : float
        The greatest speed at which they opened, by the recorded velocities [m/s].
    travel : Mapping[str, tuple[float, float]]
        Least and greatest value of each input [m, rad].
    sound : bool
        Whether gap and slip are rounding.

    """

    states: int
    gap: float = 0.0
    slip: float = 0.0
    travel: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    sound: bool = True


def linkage_report(assembly: Assembly, states: JointStateSeries) -> LinkageReport:
    """
    Put recorded joint states into the loop equations.

    Parameters
    ----------
    assembly : Assembly
        The linkage.
    states : JointStateSeries
        Its joint states.

    Returns
    -------
    LinkageReport
        What comes of it; no figures where a variable is not among the joints.

    """
    linkage, equations = assembly.linkage, assembly.equations
    if not len(states.positions) or not set(linkage.variables) <= set(states.names):
        return LinkageReport(len(states.positions))
    columns = [states.names.index(name) for name in linkage.variables]
    values, rates = states.positions[:, columns], states.velocities[:, columns]
    gap = max(float(np.abs(equations.closure(z)).max()) for z in values)
    slip = max(float(np.abs(equations.jacobian(z) @ rate).max())
               for z, rate in zip(values, rates))
    fastest = float(np.abs(rates / equations.units).max()) * equations.size
    return LinkageReport(
        len(values), gap, slip,
        {name: (float(values[:, k].min()), float(values[:, k].max()))
         for k, name in enumerate(linkage.inputs)},
        gap <= _CLOSED * equations.size and slip <= _CLOSED * max(fastest, equations.size))
