# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What one cycle of an axis costs its drive: peak and RMS torque, speed, energy fed back."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from cam_motion.drive.collocation import gauss_rule
from cam_motion.drive.inverse import FollowerDrive
from cam_motion.motion.piece import Array, Piece
from cam_motion.motion.profile import CamProfile
from cam_motion.units import TURN
import numpy as np

_PARTS = 64  # intervals per piece of the cam: a kink of the torque within one costs 1e-6 at most
_POINTS = 8
_INSIDE = 1e-9  # how far from the ends of a piece (relative) its own torque is read


class CycleFigures(NamedTuple):
    """
    Figures of one cycle at the motor shaft.

    Torques [N m], speed [rad/s], energies [J]; the inertia ratio [-] is that of the load, seen
    from the motor, to the motor's own, the largest in the cycle, and None for a motor without
    inertia.
    """

    peak_torque: float
    rms_torque: float
    peak_speed: float
    motor_energy: float
    regenerated_energy: float
    inertia_ratio: float | None


class CycleNodes(NamedTuple):
    """
    One cycle of an axis at steady shaft speed, as setpoints at chosen moments.

    ``dense`` and ``inner`` hold positions, velocities and accelerations [unit, unit/s, unit/s²]
    and shaft angles [rad]: the first closely spaced for peaks, steps taken from both sides, the
    second at Gauss points, with ``weights`` [s] that integrate over the ``period`` [s].
    """

    dense: tuple[Array, Array, Array, Array]
    inner: tuple[Array, Array, Array, Array]
    weights: Array
    period: float


def cycle_nodes(profile: CamProfile, omega: float, edges: Iterable[float] = ()) -> CycleNodes:
    """
    Choose the moments of a cycle at which a drive is looked at.

    Parameters
    ----------
    profile : CamProfile
        The cam of its axis.
    omega : float
        Speed of the master shaft [rad/s]; not zero.
    edges : Iterable[float]
        Shaft angles at which the load steps, within one turn [rad].

    Returns
    -------
    CycleNodes
        The setpoints.

    """
    rule = gauss_rule(_POINTS)
    cuts = np.linspace(0.0, 1.0, _PARTS + 1)
    inner = (cuts[:-1, None] + rule.points / _PARTS).ravel()
    weights = np.tile(rule.weights / _PARTS, _PARTS)
    dense = np.clip(np.linspace(0.0, 1.0, 4 * _PARTS + 1), _INSIDE, 1.0 - _INSIDE)
    stretches = _stretches(profile, sorted(edges))
    setpoints = []
    for x in (dense, inner):
        rows = []
        for piece, begin, low, high in stretches:
            u, slope = low + x * (high - low), piece.derivative
            rows.append((piece(u), slope(u) * omega, slope.derivative(u) * omega * omega,
                         begin + u))
        position, velocity, acceleration, angle = map(np.concatenate, zip(*rows))
        setpoints.append((position, velocity, acceleration, angle))
    times = [weights * (high - low) / abs(omega) for _, _, low, high in stretches]
    return CycleNodes(setpoints[0], setpoints[1], np.concatenate(times), TURN / abs(omega))


def _stretches(profile: CamProfile, edges: Sequence[float],
               ) -> list[tuple[Piece, float, float, float]]:
    """Cut a cycle into piece, its begin, and the local ends between which nothing steps [rad]."""
    found = []
    for begin, piece in zip(profile.curve.breaks, profile.curve.pieces):
        room = _INSIDE * piece.length
        ends = [0.0, *(edge - begin for edge in edges
                       if room < edge - begin < piece.length - room), piece.length]
        found += [(piece, begin, low, high) for low, high in zip(ends, ends[1:]) if high > low]
    return found


def cycle_figures(drive: FollowerDrive, profile: CamProfile, omega: float) -> CycleFigures:
    """
    Go through one cycle at steady shaft speed.

    Parameters
    ----------
    drive : FollowerDrive
        The drive.
    profile : CamProfile
        The cam of its axis.
    omega : float
        Speed of the master shaft [rad/s]; not zero.

    Returns
    -------
    CycleFigures
        The figures; torques at steps are taken from both sides.

    """
    nodes = cycle_nodes(profile, omega, drive.edges)
    state = drive.follow_all(*nodes.dense)
    peak = float(np.max(np.abs(state.motor_torque)))
    speed = float(np.max(np.abs(state.motor_velocity)))
    state = drive.follow_all(*nodes.inner)
    power = state.motor_torque * state.motor_velocity
    square = float(nodes.weights @ state.motor_torque ** 2)
    ratio = None
    if drive.motor_inertia > 0.0:
        moved = float(np.max(drive.law(nodes.dense[0]).inertia))
        ratio = moved / drive.gear_ratio ** 2 / drive.motor_inertia
    return CycleFigures(
        peak, float(np.sqrt(square / nodes.period)), speed, float(nodes.weights @ power),
        float(nodes.weights @ np.maximum(-power, 0.0)), ratio)
