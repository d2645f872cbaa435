# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The best member of the seven-stage family: its stage lengths under an objective and limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws import make_law, MotionLaw
from cam_motion.motion.optimal import (
    check_objective,
    Demands,
    figures,
    Load,
    PEAKS,
    references,
    ROOTS,
    weighed,
)
from cam_motion.motion.optimal_spline import INTERVALS, raised
from cam_motion.motion.piece import Array
from cam_motion.motion.spline_programme import Tell
import numpy as np

SEED = 2143
"""Seed of the global search, so that the same question has the same answer."""

_GENERATIONS = 300
_POPULATION = 12  # members per unknown
_ALIKE = 1e-6  # the search ends when its members are so much alike (relative)
_BREACH = 1e3  # what breaking a limit by its own size costs in the global search
_NOTHING = 1e-6  # a share this small is what the solver leaves of one that is not there
_MARGIN = 1e-8  # by which limits are drawn in, so that the law keeps them after rounding
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_SINES = np.sin(0.25 * np.pi * (1.0 + _NODES))[:, None]  # of a quarter wave
_WORST = 1e12
_DECIMALS = 10  # of what is found: further ones mean nothing


@dataclass(frozen=True)
class Family:
    """
    Laws that are made of the seven stages, and their unknowns.

    Attributes
    ----------
    name : str
        Name of the law.
    bounds : tuple[tuple[float, float], ...]
        Range of each of the k unknowns.
    stages : Callable[[ndarray], ndarray]
        From unknowns, shape (k, m), to the seven stage lengths, shape (7, m).
    parameters : Callable[[ndarray], dict[str, Any]]
        From the unknowns of one member, shape (k,), to the parameters of the law.
    smooth : bool
        Whether its acceleration can be continuous.

    """

    name: str
    bounds: tuple[tuple[float, float], ...]
    stages: Callable[[Array], Array]
    parameters: Callable[[Array], dict[str, Any]]
    smooth: bool = True


def _shares(values: Array) -> Array:
    found: Array = values / np.maximum(values.sum(axis=0), 1e-12)
    return found


def _ramp_stages(values: Array) -> Array:
    up, hold, down = _shares(values)
    none = np.zeros_like(up)
    return np.stack([none, up, none, hold, none, down, none])


def _ramps(values: Array) -> dict[str, Any]:
    up, _, down = _shares(values).tolist()
    return {'ramp_up': up, 'ramp_down': min(down, 1.0 - up)}


def _scca_stages(values: Array) -> Array:
    hold, inflection = values[3], values[4]
    up, down = (part * (1.0 - hold) * _shares(values[:3]) for part in (
        inflection, 1.0 - inflection))
    return np.stack([*up, hold, *down[::-1]])


def _scca(values: Array) -> dict[str, Any]:
    return {'shares': _shares(values[:3]).tolist(), 'constant_velocity': float(values[3]),
            'inflection': float(values[4])}


def _sine_stages(values: Array) -> Array:
    shares = np.repeat([[0.25], [0.0], [0.75]], values.shape[1], axis=1)
    return _scca_stages(np.concatenate([shares, values]))


def _sine(values: Array) -> dict[str, Any]:
    return {'constant_velocity': float(values[0]), 'inflection': float(values[1])}


_SHARE, _HOLD, _INFLECTION = (0.0, 1.0), (0.0, 0.95), (0.02, 0.98)

FAMILIES = {family.name: family for family in (
    Family('modified_trapezoid', (_SHARE,) * 7, _shares,
           lambda values: {'fractions': _shares(values).tolist()}),
    Family('scca', (_SHARE,) * 3 + (_HOLD, _INFLECTION), _scca_stages, _scca),
    Family('modified_constant_velocity', (_HOLD, _INFLECTION), _sine_stages, _sine),
    Family('trapezoidal_velocity', (_SHARE,) * 3, _ramp_stages, _ramps, smooth=False),
)}
"""The families whose members can be searched, by the name of their law."""


def best_member(family: str, weights: Mapping[str, float], demands: Demands,
                load: Load | None = None, shortest: float = 1.0 / INTERVALS,
                tell: Tell = lambda done, total: None) -> MotionLaw:
    """
    Find the member of a family that is best by an objective within limits.

    Parameters
    ----------
    family : str
        A name in `FAMILIES`.
    weights : Mapping[str, float]
        Weight of each figure to minimise, see `cam_motion.motion.optimal.OBJECTIVES`.
    demands : Demands
        Limits and continuity 1 or 2; both neighbours stand.
    load : Load | None
        The load, for torques.
    shortest : float
        Least length of a sinusoidal stage [-] where the acceleration must not step; without it
        and without a limit on the jerk the best law would be one that steps.
    tell : Callable[[int, int], None]
        Hears of the progress.

    Returns
    -------
    MotionLaw
        The law with the parameters found.

    Raises
    ------
    ConfigurationError
        When no member keeps the limits, or what is asked makes no sense.

    Notes
    -----
    The figures of the family are closed forms of its stage lengths. A global search over them
    (differential evolution of fixed seed) is followed by sequential quadratic programming, in
    which every peak is a variable of its own, so that the programme is smooth.

    References
    ----------
    R. Storn, K. Price, Differential evolution, J. Global Optimization 11 (1997).
    D. Kraft, A software package for sequential quadratic programming, DFVLR-FB 88-28 (1988).

    """
    check_objective(weights, load)
    demands = raised(demands, weights)
    problems = demands.problems()
    if family not in FAMILIES:
        problems.append(Problem('law', family, 'must be a law whose stages can be searched',
                                'known are: ' + ', '.join(FAMILIES)))
        raise ConfigurationError(problems)
    kind = FAMILIES[family]
    if demands.continuity > (2 if kind.smooth else 1):
        problems.append(Problem(
            'law', family, f'has no member that keeps C{demands.continuity}', 'take the spline'))
    if not demands.at_rest:
        problems.append(Problem('law', family, 'starts and ends at rest, its neighbours do not',
                                'take the spline'))
    if not 0.0 < shortest <= 0.2:
        problems.append(Problem('shortest', shortest, 'must be above 0 and at most 0.2'))
    if problems:
        raise ConfigurationError(problems)
    search = _Search(kind, weights, demands, load, shortest)
    law = make_law(family, **{
        name: np.round(value, _DECIMALS).tolist()
        for name, value in kind.parameters(search.run(tell)).items()})
    found = figures(law.curve, demands, load)
    broken = [name for name, order in PEAKS.items()
              if found[name] > demands.limits.get(order, np.inf)]
    if broken or not np.isfinite(weighed(weights, found, load)):
        raise ConfigurationError([Problem(
            'limits', ', '.join(f'{name} {demands.limits[PEAKS[name]]:.6g}' for name in broken),
            f'no member of {family} keeps them (lift 1 over span 1)',
            'raise one of them, give the segment more span, or take the spline')])
    return law


def stage_figures(stages: Array, load: Load | None = None) -> dict[str, Array]:
    """
    Compute the figures of members of the seven-stage family in closed form.

    Parameters
    ----------
    stages : ndarray, shape (7, m)
        Stage lengths of m members, each summing to 1.
    load : Load | None
        The load, where there is one.

    Returns
    -------
    dict[str, ndarray]
        Peaks, RMS values and torques by name, and the two plateaus ``up`` and ``down`` of the
        acceleration; shape (m,) each. Infinite where a stage that would have to be there is not.

    References
    ----------
    Document 000, ModTVP.

    """
    x1, x2, x3, x4, x5, x6, x7 = stages
    share = 2.0 / np.pi
    with np.errstate(divide='ignore', invalid='ignore'):
        k1, k2 = share * (x1 + x3) + x2, share * (x5 + x7) + x6
        middle = x1 + x2 + x3 + x4
        m1 = ((share * x1) ** 2 + x2 * (x1 + 0.5 * x2)
              + share * x3 * (x1 + x2 + x3 - share * x3))
        m2 = (share * x5 * (middle + share * x5) + x6 * (middle + x5 + 0.5 * x6)
              + share * x7 * (1.0 - share * x7))
        speed = 1.0 / (m2 / k2 - m1 / k1)
        up, down = speed / k1, speed / k2
        slopes = [0.5 * np.pi * plateau / length
                  for plateau, length in ((up, x1), (up, x3), (down, x5), (down, x7))]
        found = {
            'up': up, 'down': down, 'peak_velocity': speed,
            'peak_acceleration': np.maximum(up, down), 'peak_jerk': np.max(slopes, axis=0),
            'rms_acceleration': np.sqrt(
                up ** 2 * (0.5 * (x1 + x3) + x2) + down ** 2 * (0.5 * (x5 + x7) + x6)),
            'rms_jerk': np.sqrt(sum(0.5 * slope ** 2 * length for slope, length in zip(
                slopes, (x1, x3, x5, x7)))),
        }
        if load is not None:
            squares = x4 * load.torque(np.zeros_like(x4)) ** 2
            for plateau, sines, flat in ((up, x1 + x3, x2), (-down, x5 + x7, x6)):
                waves = 0.5 * _WEIGHTS @ load.torque(plateau * _SINES) ** 2
                squares = squares + sines * waves + flat * load.torque(plateau) ** 2
            found['rms_torque'] = np.sqrt(squares)
            found['peak_torque'] = np.maximum(
                np.abs(load.torque(up)), np.abs(load.torque(-down)))
    return {name: np.where(np.isfinite(values), values, np.inf)
            for name, values in found.items()}


class _Search:
    """The search of one family: its objective, and what breaks which limit by how much."""

    def __init__(self, kind: Family, weights: Mapping[str, float], demands: Demands,
                 load: Load | None, shortest: float) -> None:
        self.kind, self.weights, self.load = kind, weights, load
        self.limits = {name: demands.limits[order] * (1.0 - _MARGIN)
                       for name, order in PEAKS.items() if order in demands.limits}
        self.shortest = shortest if demands.continuity >= 2 else 0.0
        alone = len(weights) == 1
        scales = references(load)
        self.shares = {name: 1.0 if alone else weight / scales[name]
                       for name, weight in weights.items()}
        self.peaks = [name for name in weights if name not in ROOTS and name != 'rms_torque']

    def run(self, tell: Tell) -> Array:
        """Search globally, then polish; gives the unknowns of the best member."""
        from scipy.optimize import differential_evolution
        done = 0

        def count(*_: Any, **__: Any) -> None:
            nonlocal done
            done += 1
            tell(min(done, _GENERATIONS), _GENERATIONS)

        found = differential_evolution(
            self.penalised, self.kind.bounds, popsize=_POPULATION, maxiter=_GENERATIONS,
            tol=_ALIKE, seed=SEED, polish=False, vectorized=True, updating='deferred',
            callback=count)
        best = min((found.x, self._polished(found.x)), key=self._worth)
        tell(_GENERATIONS, _GENERATIONS)
        cleaned = np.where(best < _NOTHING, 0.0, best)
        return cleaned if self._worth(cleaned) <= self._worth(best) + 1e-9 else best

    def penalised(self, values: Array) -> Array:
        """Give objective plus penalty, shape (m,), for unknowns of shape (k, m)."""
        stages = self.kind.stages(values)
        found = stage_figures(stages, self.load)
        total = sum(share * found[name] for name, share in self.shares.items())
        breach = sum(np.maximum(found[name] / limit - 1.0, 0.0)
                     for name, limit in self.limits.items())
        if self.shortest:
            breach = breach + np.maximum(self.shortest - stages[[0, 2, 4, 6]], 0.0).sum(axis=0)
        worth = np.asarray(total + _BREACH * breach)
        finite: Array = np.where(np.isfinite(worth), worth, _WORST)
        return finite

    def _worth(self, values: Array) -> float:
        return float(self.penalised(values[:, None])[0])

    def _polished(self, start: Array) -> Array:
        """Go on from a good member with the peaks as variables of their own."""
        from scipy.optimize import minimize
        count = len(start)
        first = self._at(start)
        x = np.concatenate([start, [first[name] for name in self.peaks]])
        found = minimize(
            self._smooth, x, method='SLSQP', jac='3-point',
            bounds=[*self.kind.bounds, *((0.0, None),) * len(self.peaks)],
            constraints={'type': 'ineq', 'fun': self._kept},
            options={'maxiter': 300, 'ftol': 1e-14})
        low, high = np.transpose(self.kind.bounds)
        inside: Array = np.clip(found.x[:count], low, high)
        return inside

    def _at(self, values: Array) -> dict[str, float]:
        found = stage_figures(self.kind.stages(values[:, None]), self.load)
        return {name: float(figure[0]) for name, figure in found.items()}

    def _smooth(self, x: Array) -> float:
        peaks = x[len(x) - len(self.peaks):]
        found = {**self._at(x[:len(x) - len(self.peaks)]), **dict(zip(self.peaks, peaks))}
        total = sum(share * found[name] for name, share in self.shares.items())
        return min(float(total), _WORST)

    def _kept(self, x: Array) -> Array:
        """Give what is left of each limit and below each peak; negative where it is broken."""
        cut = len(x) - len(self.peaks)
        stages, found = self.kind.stages(x[:cut, None])[:, 0], self._at(x[:cut])
        left = []
        for name, level in (*self.limits.items(), *zip(self.peaks, x[cut:])):
            if name == 'peak_velocity':
                left.append(level - found[name])
            elif name == 'peak_acceleration':
                left += [level - found['up'], level - found['down']]
            elif name == 'peak_torque' and self.load is not None:
                left += [level - abs(float(self.load.torque(bend)))
                         for bend in (found['up'], -found['down'])]
            else:
                left += [level * length - 0.5 * np.pi * found[plateau] for length, plateau in zip(
                    stages[[0, 2, 4, 6]], ('up', 'up', 'down', 'down'))]
        if self.shortest:
            left += (stages[[0, 2, 4, 6]] - self.shortest).tolist()
        kept: Array = np.minimum(np.array(left or [1.0]), _WORST)
        return kept
