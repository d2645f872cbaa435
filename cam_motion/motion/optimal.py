# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What the best motion law is: objectives, limits, load, and the figures of a law under them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
import math
from typing import NamedTuple

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws import make_law
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import JOINT_TOLERANCE, Piecewise
import numpy as np
from numpy.typing import ArrayLike

PEAKS = {'peak_velocity': 1, 'peak_acceleration': 2, 'peak_jerk': 3}
"""Objectives that are the largest magnitude of a derivative, and its order."""

ROOTS = {'rms_acceleration': 2, 'rms_jerk': 3, 'rms_snap': 4}
"""Objectives that are the root mean square of a derivative, and its order."""

TORQUES = ('peak_torque', 'rms_torque')
"""Objectives that need a load."""

OBJECTIVES = (*PEAKS, *ROOTS, *TORQUES)
"""All objectives, by name."""

_REFERENCE = 'polynomial_345'  # objectives are weighed against its figures, which are all finite
_PARTS = 16  # intervals per piece in which the torque is integrated
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)


@dataclass(frozen=True)
class Load:
    """
    The torque that a motor needs for a movement in one direction.

    It is own * s'' + through / e, where through = driven * s'' + against goes through a gearbox
    of efficiency e; where through is negative, power flows back and e multiplies instead. As e
    is at most 1, that is the larger of two straight lines in s''.

    Attributes
    ----------
    own, driven : float
        Torque per s'' for the inertia of the motor and for that behind the gearbox [N m]; not
        negative, and not both 0.
    against : float
        What resists the movement, as torque at the motor [N m].
    efficiency : float
        Efficiency of the gearbox [-], above 0 and at most 1.

    """

    own: float
    driven: float
    against: float = 0.0
    efficiency: float = 1.0

    def __post_init__(self) -> None:
        """Refuse what is no load."""
        if not (self.own >= 0.0 and self.driven >= 0.0 and self.own + self.driven > 0.0):
            raise ConfigurationError([Problem(
                'inertia', self.own + self.driven, 'a torque to minimise needs an inertia',
                'give the drive motor_inertia or load_inertia')])

    @property
    def lines(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Give slope and offset of the torque that drives and of the one that is fed back."""
        return tuple((self.own + share * self.driven, share * self.against)  # type: ignore
                     for share in (1.0 / self.efficiency, self.efficiency))

    def torque(self, acceleration: ArrayLike) -> Array:
        """
        Compute the torque at the motor.

        Parameters
        ----------
        acceleration : array_like, any shape
            s'' [-].

        Returns
        -------
        ndarray, shape of acceleration
            Torques in the direction of the movement [N m].

        """
        (up, up_at), (back, back_at) = self.lines
        bend = np.asarray(acceleration, dtype=float)
        return np.maximum(up * bend + up_at, back * bend + back_at)

    def slope(self, acceleration: Array) -> Array:
        """
        Differentiate the torque with respect to s''.

        Parameters
        ----------
        acceleration : ndarray, any shape
            s'' [-].

        Returns
        -------
        ndarray, shape of acceleration
            Slopes [N m].

        """
        (up, up_at), (back, back_at) = self.lines
        driving = (up - back) * acceleration + up_at - back_at >= 0.0
        return np.where(driving, up, back)


class End(NamedTuple):
    """Velocity, acceleration and jerk at an end of a law, in lifts per span to their order."""

    velocity: float = 0.0
    acceleration: float = 0.0
    jerk: float = 0.0


@dataclass(frozen=True)
class Demands:
    """
    What a law must keep, normalised: lift 1 over span 1.

    Attributes
    ----------
    velocity, acceleration, jerk : float | None
        Largest magnitudes of s', s'' and s'''; None where nothing limits them.
    continuity : int
        Class with which the law meets its neighbours: 1, 2 or 3.
    start, end : End
        What its neighbours do where it starts and where it ends.
    rising : bool
        Whether s' must not be negative.

    """

    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    continuity: int = 2
    start: End = End()
    end: End = End()
    rising: bool = False

    @property
    def limits(self) -> dict[int, float]:
        """Give the limits by the order of the derivative."""
        given = (self.velocity, self.acceleration, self.jerk)
        return {order: limit for order, limit in enumerate(given, 1) if limit is not None}

    @property
    def at_rest(self) -> bool:
        """Whether both neighbours stand."""
        return not any(self.start) and not any(self.end)

    def problems(self) -> list[Problem]:
        """
        Look for limits that no law keeps.

        Returns
        -------
        list[Problem]
            What is wrong, paths named like the limits.

        """
        problems = [
            Problem(f'max_{name}', limit, 'must be a finite number above 0')
            for name, limit in (('velocity', self.velocity), ('acceleration', self.acceleration),
                                ('jerk', self.jerk))
            if limit is not None and not (math.isfinite(limit) and limit > 0.0)]
        if self.continuity not in (1, 2, 3):
            problems.append(Problem('continuity', self.continuity, 'must be 1, 2 or 3'))
        return problems


def check_objective(weights: Mapping[str, float], load: Load | None) -> None:
    """
    Check an objective.

    Parameters
    ----------
    weights : Mapping[str, float]
        Weight of each figure to minimise.
    load : Load | None
        The load, where there is one.

    Raises
    ------
    ConfigurationError
        When a name is unknown, a weight is not positive, or a torque has no load.

    """
    problems = [Problem('minimise', name, 'must be an objective that is known',
                        'known are: ' + ', '.join(OBJECTIVES))
                for name in weights if name not in OBJECTIVES]
    problems += [Problem(f'minimise.{name}', weight, 'a weight must be a finite number above 0')
                 for name, weight in weights.items()
                 if not (math.isfinite(weight) and weight > 0.0)]
    problems += [Problem('minimise', name, 'a torque needs a load',
                         'name an axis with a drive that has an inertia, and a load that does '
                         'not depend on place and speed')
                 for name in weights if name in TORQUES and load is None]
    if not weights:
        problems.append(Problem('minimise', None, 'needs an objective',
                                'known are: ' + ', '.join(OBJECTIVES)))
    if problems:
        raise ConfigurationError(problems)


def figures(curve: Piecewise, demands: Demands, load: Load | None = None) -> dict[str, float]:
    """
    Compute all figures of a law that can be an objective.

    Parameters
    ----------
    curve : Piecewise
        The law from 0 to 1.
    demands : Demands
        What its neighbours do; where it does not meet their velocity or acceleration, the next
        derivative is infinite.
    load : Load | None
        The load, where there is one.

    Returns
    -------
    dict[str, float]
        Every objective by name; peaks are exact, RMS values exact to rounding.

    """
    found = {name: abs(curve.peak(order).value) for name, order in PEAKS.items()}
    found |= {name: curve.rms(order) for name, order in ROOTS.items()}
    stepping = _steps(curve, demands)
    for name, order in (*PEAKS.items(), *ROOTS.items()):
        if stepping < order:
            found[name] = math.inf
    if load is not None:
        extremes = [curve.extremes(2)[n].value for n in (0, 1)]
        found['peak_torque'] = float(np.max(np.abs(load.torque(extremes))))
        found['rms_torque'] = math.sqrt(_mean_square_torque(curve, load))
        if stepping < 2:
            found['peak_torque'] = found['rms_torque'] = math.inf
    return found


def weighed(weights: Mapping[str, float], found: Mapping[str, float], load: Load | None) -> float:
    """
    Put the figures of a law together into the one number that is minimised.

    Parameters
    ----------
    weights : Mapping[str, float]
        Weight of each figure.
    found : Mapping[str, float]
        The figures.
    load : Load | None
        The load, where there is one.

    Returns
    -------
    float
        The figure itself where there is one only; else the weighted sum, each figure divided by
        that of the polynomial 3-4-5.

    """
    if len(weights) == 1:
        return found[next(iter(weights))]
    scales = references(load)
    return math.fsum(weight * found[name] / scales[name] for name, weight in weights.items())


def references(load: Load | None) -> dict[str, float]:
    """
    Give the figures against which several objectives are weighed.

    Parameters
    ----------
    load : Load | None
        The load, where there is one.

    Returns
    -------
    dict[str, float]
        Those of the polynomial 3-4-5 between two dwells, by objective.

    """
    curve = make_law(_REFERENCE).curve
    found = figures(curve, Demands(), load)
    return found | {name: curve.rms(order) for name, order in ROOTS.items()}


def _steps(curve: Piecewise, demands: Demands) -> int:
    """Find the lowest derivative that steps, inside the law or towards its neighbours."""
    for order in (1, 2, 3):
        slack = JOINT_TOLERANCE * abs(curve.peak(order).value)
        ends = (demands.start[order - 1], demands.end[order - 1])
        misses = [abs(a - b) for a, b in zip(curve.end_values(order), ends)]
        if max(misses) > slack or curve.jumps(order):
            return order
    return 4


def _mean_square_torque(curve: Piecewise, load: Load) -> float:
    total = 0.0
    cuts = np.linspace(0.0, 1.0, _PARTS + 1)[:-1, None]
    shares = (cuts + 0.5 * (1.0 + _NODES) / _PARTS).ravel()
    weights = np.tile(0.5 * _WEIGHTS / _PARTS, _PARTS)
    for piece in curve.differentiated(2).pieces:
        total += piece.length * float(weights @ load.torque(piece(shares * piece.length)) ** 2)
    return total
