# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Linear and quadratic programmes over B-splines, exact between their points by exchange."""

from __future__ import annotations

from collections.abc import Callable, Mapping
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws import MotionLaw
from cam_motion.motion.least_squares import least_squares
from cam_motion.motion.optimal import Demands, figures, Load, PEAKS, references, ROOTS
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.spline_space import Rows, Space
import numpy as np

_GRID = 4  # points per interval at which limits are asked for first
_EXCHANGES = 25
_KEPT = 1e-7  # how far (relative) a limit may be exceeded between the points
_MARGIN = 2e-7  # by which limits are drawn in for that, so that the law keeps them itself
_SAME = 1e-9  # points so close to each other are one
_TOLERANCES = (1e-10, 1e-7)  # of the linear programmes: the least there is, the usual one
_NOTHING = 1e-12  # a row with no larger factor holds for fixed coefficients only
_INFEASIBLE = 2  # status of the solver
_LEEWAY = 1e-8  # by which peaks may rise for a calmer curve
_TURNS = 60  # of the quadratic programmes for a torque with losses

Tell = Callable[[int, int], None]
"""Hears how many steps are done, and how many there are at most."""


class SplineProgramme:
    """
    One optimisation: the space, the objective, and the points at which limits hold.

    Parameters
    ----------
    space : Space
        Where to look.
    weights : Mapping[str, float]
        Weight of each figure to minimise.
    demands : Demands
        Limits.
    load : Load | None
        The load, for torques.

    """

    def __init__(self, space: Space, weights: Mapping[str, float], demands: Demands,
                 load: Load | None) -> None:
        """Choose the first points."""
        self.space, self.weights, self.demands, self.load = space, weights, demands, load
        self.scales = references(load)
        self.peaks = {name: PEAKS[name] for name in weights if name in PEAKS}
        if 'peak_torque' in weights:
            self.peaks['peak_torque'] = 2
        self.roots = [name for name in weights if name not in self.peaks]
        self.orders = {*demands.limits, *self.peaks.values()} | ({1} if demands.rising else set())
        self.points = {order: self._first_points(order) for order in self.orders}
        self.fed_back = 1  # which line bounds the torque from below, see _torque_rows

    def _first_points(self, order: int) -> Array:
        degree, count = self.space.degree - order, self.space.intervals
        if degree == 0:
            return (np.arange(count) + 0.5) / count
        return np.linspace(0.0, 1.0, (1 if degree == 1 else _GRID) * count + 1)

    def solve(self, tell: Tell) -> MotionLaw:
        """
        Solve, until the solution breaks no limit between the points.

        Parameters
        ----------
        tell : Callable[[int, int], None]
            Hears of the progress.

        Returns
        -------
        MotionLaw
            The law.

        Raises
        ------
        ConfigurationError
            When no curve of the space keeps the limits.

        """
        for done in range(_EXCHANGES):
            tell(done, _EXCHANGES)
            z, peaks = self._solve_once()
            law = self.space.law(z)
            if not self._exchange(law.curve, peaks):
                break
        tell(_EXCHANGES, _EXCHANGES)
        if any(abs(law.curve.peak(order).value) > limit * (1.0 + _MARGIN)
               for order, limit in self.demands.limits.items()):
            raise ConfigurationError([self._refusal()])
        return law

    def _solve_once(self) -> tuple[Array, dict[str, float]]:
        """Solve for the points there are; gives the free coefficients and the peaks reached."""
        if not self.roots:
            return self._calmed(*self._linear())
        start = self._quadratic() if len(self.roots) == 1 else None
        if start is not None and not self.peaks:
            return start, {}
        if start is None:
            start = self._linear(feasible=True)[0]
        return self._sequential(start)

    def _exchange(self, curve: Piecewise, peaks: Mapping[str, float]) -> bool:
        """Add the points where a limit is broken; False where none is."""
        added = False
        for order in self.orders:
            if self.space.degree - order <= 1:
                continue
            bounds = [limit * (1.0 - _MARGIN)
                      for k, limit in self.demands.limits.items() if k == order]
            bounds += [peaks[name] for name in self.peaks if PEAKS.get(name) == order]
            values = list(curve.candidates(order))
            size = max(abs(each.value) for each in values)
            broken = [each.at for each in values if bounds
                      and abs(each.value) > min(bounds) + _KEPT * size]
            if order == 1 and self.demands.rising:
                broken += [each.at for each in values if each.value < -_KEPT * size]
            if order == 2 and 'peak_torque' in peaks and self.load is not None:
                torques = np.abs(self.load.torque([each.value for each in values]))
                broken += [each.at for each, torque in zip(values, torques)
                           if torque > peaks['peak_torque'] * (1.0 + _KEPT)]
            added = self._add_points(order, broken) or added
        return added

    def _add_points(self, order: int, broken: list[float]) -> bool:
        """Ask for the limits at further points; False where they are asked for there already."""
        known = self.points[order]
        new = np.array([at for at in broken if np.abs(known - at).min() > _SAME])
        self.points[order] = np.union1d(known, np.clip(new, 0.0, 1.0))
        return bool(new.size)

    def _constraints(self) -> Rows:
        """Give G and g with G x >= g for x = (z, peaks), limits and peaks together."""
        columns = len(self.peaks)
        matrices, sides = [], []

        def add(matrix: Array, side: Array, scale: float, column: int | None = None) -> None:
            # by its own size, against which the solver's tolerance is small
            tail = np.zeros((len(matrix), columns))
            if column is not None:
                tail[:, column] = 1.0 / scale
            matrices.append(np.hstack([matrix / scale, tail]))
            sides.append(side / scale)

        for order, limit in self.demands.limits.items():
            a, b = self.space.rows(order, self.points[order])
            least = -limit * (1.0 - _MARGIN)
            add(-a, b + least, limit)
            add(a, -b + least, limit)
        if self.demands.rising:
            a, b = self.space.rows(1, self.points[1])
            add(a, -b, 1.0)
        for column, (name, order) in enumerate(self.peaks.items()):
            a, b = self.space.rows(order, self.points[order])
            for slope, offset in self._peak_lines(name):
                add(-slope * a, slope * b + offset, self.scales[name], column)
        size = self.space.free.stop - self.space.free.start + columns
        if not matrices:
            return np.zeros((0, size)), np.zeros(0)
        matrix, side = np.vstack(matrices), np.concatenate(sides)
        told = np.abs(matrix).max(axis=1) > _NOTHING
        return matrix[told], side[told]

    def _peak_lines(self, name: str) -> list[tuple[float, float]]:
        """
        Give slopes and offsets whose values a peak must not be below.

        The torque of a load is the larger of two lines, and its negative the smaller of two: not
        convex. But the torque rises with s'', so that one of the two alone bounds it, which one
        depends on whether the peak is above the torque where the lines meet. Both are tried.
        """
        if name != 'peak_torque' or self.load is None:
            return [(1.0, 0.0), (-1.0, 0.0)]
        lines = self.load.lines
        slope, offset = lines[self.fed_back]
        return [*lines, (-slope, -offset)]

    def _linear(self, feasible: bool = False) -> tuple[Array, dict[str, float]]:
        """Minimise a weighted sum of peaks, or only find a curve within the limits."""
        from scipy.optimize import linprog
        count = self.space.free.stop - self.space.free.start
        cost = np.zeros(count + len(self.peaks))
        if not feasible:
            cost[count:] = [self.weights[name] / self.scales[name] for name in self.peaks]
        best = None
        for line in (0, 1) if 'peak_torque' in self.peaks else (1,):
            self.fed_back = line
            matrix, side = self._constraints()
            for tolerance in _TOLERANCES:
                found = linprog(
                    cost, -matrix, -side, method='highs-ds',
                    bounds=[(None, None)] * count + [(0.0, None)] * len(self.peaks),
                    options={'primal_feasibility_tolerance': tolerance,
                             'dual_feasibility_tolerance': tolerance})
                if found.status in (0, _INFEASIBLE):
                    break  # else the solver has lost its way among rounding
            if found.status == 0 and (best is None or found.fun < best[0]):
                best = found.fun, line, found.x
        if best is None:
            raise ConfigurationError([self._refusal()])
        self.fed_back = best[1]
        return best[2][:count], dict(zip(self.peaks, best[2][count:].tolist()))

    def _calmed(self, z: Array, peaks: dict[str, float]) -> tuple[Array, dict[str, float]]:
        """Of all curves with these peaks take the one of least RMS jerk: peaks leave some free."""
        matrix, side = self._constraints()
        count = len(z)
        levels = side - matrix[:, count:] @ np.array([
            peak * (1.0 + _LEEWAY) for peak in peaks.values()])
        bounds = matrix[:, :count]
        told = np.abs(bounds).max(axis=1) > _NOTHING
        (a, b), weights = self.space.mean_square(min(3, self.space.degree))
        root = np.sqrt(weights)
        calm = least_squares(root[:, None] * a, -root * b, bounds[told], levels[told])
        # where the peaks leave nothing free, rounding decides between the two
        kept = np.all(bounds[told] @ calm - levels[told] >= -_LEEWAY)
        return (calm if kept else z), peaks

    def _refusal(self) -> Problem:
        limits = ', '.join(f'{name} {limit:.6g}' for name, limit in zip(
            ('velocity', 'acceleration', 'jerk'),
            (self.demands.velocity, self.demands.acceleration, self.demands.jerk))
            if limit is not None)
        return Problem(
            'limits', limits, f'no curve of degree {self.space.degree} over '
            f'{self.space.intervals} intervals keeps them (lift 1 over span 1)',
            'raise one of them, give the segment more span, or take more intervals')

    def _residual(self, name: str, z: Array) -> tuple[Array, Array]:
        """Give A and b of a mean square |A z + b|²; of a torque with losses, as it is at z."""
        order = ROOTS.get(name, 2)
        (a, b), weights = self.space.mean_square(order)
        root = np.sqrt(weights)
        if name == 'rms_torque' and self.load is not None:
            bend = a @ z + b
            slope = self.load.slope(bend)
            a, b = slope[:, None] * a, self.load.torque(bend) - slope * (bend - b)
        return root[:, None] * a, root * b

    def _quadratic(self) -> Array:
        """Minimise one RMS value within the limits, peaks left out."""
        name, = self.roots
        if self.demands.limits or self.demands.rising:
            z = self._without_peaks()._linear(feasible=True)[0]
        else:
            z = np.zeros(self.space.free.stop - self.space.free.start)
        matrix, side = self._without_peaks()._constraints()
        best, least = z, math.inf
        for _ in range(_TURNS if name == 'rms_torque' else 1):
            a, b = self._residual(name, z)
            z = least_squares(a, -b, matrix, side)
            a, b = self._residual(name, z)
            value = float(np.linalg.norm(a @ z + b))
            if not value < least * (1.0 - 1e-12):
                break
            best, least = z, value
        return best

    def _without_peaks(self) -> SplineProgramme:
        weights = {name: self.weights[name] for name in self.roots}
        made = SplineProgramme(self.space, weights, self.demands, self.load)
        made.points = {order: self.points[order] for order in made.orders}
        return made

    def _sequential(self, start: Array) -> tuple[Array, dict[str, float]]:
        """Minimise a sum of RMS values and peaks."""
        from scipy.optimize import minimize
        matrix, side = self._constraints()
        count = len(start)
        cost = np.array([self.weights[name] / self.scales[name] for name in self.peaks])
        law = figures(self.space.law(start).curve, self.demands, self.load)
        first = np.concatenate([start, [law[name] for name in self.peaks]])

        def value(x: Array) -> tuple[float, Array]:
            total, slope = float(cost @ x[count:]), np.zeros_like(x)
            slope[count:] = cost
            for name in self.roots:
                a, b = self._residual(name, x[:count])
                rest = a @ x[:count] + b
                size = max(float(np.linalg.norm(rest)), 1e-300)
                weight = self.weights[name] / self.scales[name]
                total += weight * size
                slope[:count] += weight * (a.T @ rest) / size
            return total, slope

        found = minimize(
            value, first, jac=True, method='SLSQP', options={'maxiter': 400, 'ftol': 1e-12},
            constraints=[{'type': 'ineq', 'fun': lambda x: matrix @ x - side,
                          'jac': lambda x: matrix}])
        return found.x[:count], dict(zip(self.peaks, found.x[count:].tolist()))
