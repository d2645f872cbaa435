# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Sweeps over designs: the periodic motions of many motors, ratios and flywheels over one load."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import as_completed, Executor
from typing import NamedTuple

from cam_motion.drive.approach import approach, Road
from cam_motion.drive.batch_cuts import periodic
from cam_motion.drive.batch_figures import Figures, figures, figures_of
from cam_motion.drive.cells import Flags, LoadTable, Numbers
from cam_motion.drive.designs import Designs, Shafts
from cam_motion.drive.load import Part
from cam_motion.drive.orbit import find_orbit, NoOrbitError
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.piece import Array
from cam_motion.motion.profile import CamProfile
import numpy as np

__all__ = ['Designs', 'OrbitTable', 'sweep', 'sweep_orbits']


class _Effort(NamedTuple):
    """
    How closely to look.

    Steps per element of the first revolutions; by how much stronger they take the motor, so that
    where even that one fails there is no doubt; how often the elements are halved for Newton's
    method.
    """

    steps: int
    margin: float
    halvings: int


_EFFORTS = (_Effort(4, 0.015, 0), _Effort(16, 0.002, 2))

CHUNK = 4096
"""Designs that one call works on: enough to share its overhead, few enough for the cache."""


class OrbitTable(NamedTuple):
    """
    Periodic motions of designs, arrays of shape (n,).

    Attributes
    ----------
    found : ndarray of bool
        Whether there is a periodic motion; where there is none, all else is nan.
    start_speed, min_speed, max_speed : ndarray
        Speed of the cam shaft at q = 0, least and greatest [rad/s].
    period : ndarray
        Duration of a revolution [s].
    motor_work : ndarray
        Work of the motor at its own shaft over a revolution [J].
    drawn_work : ndarray
        The same while the motor drives, without what it is driven with [J].
    rms_motor_torque : ndarray
        Root of the mean square over time of the torque at the motor shaft [N m].
    peak_motor_torque : ndarray
        Greatest magnitude of the torque at the motor shaft [N m].
    least_follower_force : ndarray
        Least force that presses the follower on the cam, along its own way, to two
        thousandths of its swing [N]; negative where it would lift off.
    multiplier : ndarray
        By how much a disturbance of the energy is multiplied in a revolution [-].

    """

    found: Flags
    start_speed: Array
    min_speed: Array
    max_speed: Array
    period: Array
    motor_work: Array
    drawn_work: Array
    rms_motor_torque: Array
    peak_motor_torque: Array
    least_follower_force: Array
    multiplier: Array


def sweep_orbits(profile: CamProfile, parts: Sequence[Part], nominal_speed: float,
                 designs: Designs) -> OrbitTable:
    """
    Find the periodic motions of designs, all at once.

    Parameters
    ----------
    profile : CamProfile
        Motion of the follower over the shaft angle [m].
    parts : Sequence[Part]
        The load.
    nominal_speed : float
        Speed of the cam shaft that the drives are meant for [rad/s].
    designs : Designs
        The designs.

    Returns
    -------
    OrbitTable
        What `orbit.find_orbit` finds, to 1e-6; the work drawn through a gearbox without losses
        to 1e-5, the least force as said there.

    Raises
    ------
    ConfigurationError
        When the load makes no drive.

    Notes
    -----
    A few revolutions by the trapezoidal rule, with a slightly stronger motor, tell whether there
    can be a periodic motion and about where; Newton's method on Gauss points ends there. What
    stays open, at the very limit of what a motor can carry, is repeated with finer steps, and the
    rest left to `orbit.find_orbit`. A design's figures are the same bits whatever designs are
    beside it.

    """
    values = np.full((len(Figures._fields), len(designs)), np.nan)
    if len(designs):
        table = LoadTable(designs.drive(0, profile, parts, nominal_speed))
        shafts = Shafts.of(designs)
        open_ones: Numbers = np.arange(len(designs))
        for effort in _EFFORTS:
            if open_ones.size:
                open_ones = _find(shafts, table, effort, open_ones, values)
        for k in open_ones.tolist():
            try:
                orbit = find_orbit(designs.drive(k, profile, parts, nominal_speed))
            except NoOrbitError:
                continue
            values[:, [k]] = np.stack(figures_of(orbit, shafts.take(np.array([k]))))
    return OrbitTable(np.isfinite(values[0]), *values)


def _find(shafts: Shafts, table: LoadTable, effort: _Effort, which: Numbers,
          values: Array) -> Numbers:
    """Fill in the figures of some designs; give the numbers of those that stay open."""
    mine, road = shafts.take(which), Road(table, effort.steps)
    stronger = mine._replace(breakdown_torque=(1.0 + effort.margin) * mine.breakdown_torque)
    with np.errstate(all='ignore'):
        speeds, exists = approach(stronger, road)
        near = np.flatnonzero(exists == 1.0)
        # about the same torques with the weaker motor: slips larger by the same share
        speeds += effort.margin * (speeds - mine.idle_speed)
        for part, motions in periodic(
                mine.take(near), table, road, speeds[:, near], effort.halvings):
            found = figures(motions, table)
            stable = np.abs(found.multiplier) < 1.0
            numbers = near[part[stable]]
            values[:, which[numbers]] = np.stack(found)[:, stable]
            exists[numbers] = 0.0  # settled, as are those for which it was zero
    still_open: Numbers = which[exists != 0.0]
    return still_open


def sweep(profile: CamProfile, parts: Sequence[Part], nominal_speed: float, designs: Designs,
          executor: Executor | None = None, chunk: int = CHUNK,
          tell: Callable[[int, int], None] = lambda done, total: None) -> OrbitTable:
    """
    Find the periodic motions of any number of designs, on one core or on many.

    Parameters
    ----------
    profile : CamProfile
        Motion of the follower over the shaft angle [m].
    parts : Sequence[Part]
        The load.
    nominal_speed : float
        Speed of the cam shaft that the drives are meant for [rad/s].
    designs : Designs
        The designs.
    executor : Executor, optional
        Where to work: processes of this machine, or the executor of a cluster. Without one, here.
    chunk : int
        How many designs make one task.
    tell : Callable[[int, int], None]
        Is told how many designs of how many are done.

    Returns
    -------
    OrbitTable
        The same bits whatever the executor and the chunks.

    Raises
    ------
    ConfigurationError
        When the load makes no drive or a chunk is empty. What else fails in a worker is raised
        here too, and tasks not yet begun are cancelled.

    """
    if chunk < 1:
        raise ConfigurationError([Problem('chunk', chunk, 'must be at least 1')])
    total, done = len(designs), 0
    starts = range(0, max(total, 1), chunk)
    tables: dict[int, OrbitTable] = {}
    if executor is None:
        for k in starts:
            tables[k] = sweep_orbits(profile, parts, nominal_speed, designs[k:k + chunk])
            done += tables[k].found.size
            tell(done, total)
    else:
        tasks = {executor.submit(sweep_orbits, profile, parts, nominal_speed,
                                 designs[k:k + chunk]): k for k in starts}
        try:
            for task in as_completed(tasks):
                tables[tasks[task]] = table = task.result()
                done += table.found.size
                tell(done, total)
        finally:
            for task in tasks:
                task.cancel()
    return OrbitTable(*(np.concatenate(column) for column in zip(*(tables[k] for k in starts))))
