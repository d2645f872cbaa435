# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Positions of a linkage on one branch: followed by steps that cannot leave it."""

from __future__ import annotations

from collections.abc import Mapping
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.mechanism.linkage import Linkage
from cam_motion.mechanism.loops import LoopEquations
from cam_motion.mechanism.pose import bound_text, Certificate, Pose, Range, SingularError
from cam_motion.mechanism.singular import Singularity
from cam_motion.motion.piece import Array
from cam_motion.units import TURN
import numpy as np

# Share of the distance kept to singular positions that one step may take. With x = 0.4 the
# number of Kantorovich of the whole step is (x / (1 - x))² / 2 = 0.22, and 0.5 is allowed.
_SHARE = 0.4
# A root within a ball of (1 - sqrt(1 - 2 h)) (1 - x) of that distance, so this is ever touched.
_REACH = _SHARE + 0.16
# Clearance at which a position counts as singular: five digits of its velocities are lost.
_SINGULAR = 1e-5
_NEWTON = 12
_CONVERGED = 1e-12  # so small a step leaves nothing but rounding
_LARGEST = 1e3  # metres or radians: 159 turns of a crank
_FAR = 10.0  # sums of all lengths; no input of a closed loop goes that far


class Assembly:
    """
    The branch of a linkage that its start names, and all that can be reached on it.

    Parameters
    ----------
    linkage : Linkage
        The linkage.

    Attributes
    ----------
    start : Pose
        The start, exactly.

    Raises
    ------
    ConfigurationError
        When the start is not near enough to one assembly to name it.

    Notes
    -----
    Let J be the Jacobian by the unknowns at a position and J⁻¹ J change by at most M per unit of
    way (from `LoopEquations.bends`): no singular position is nearer than the clearance 1/M. A
    step w along the tangent opens the loops, seen through J⁻¹, by at most M |w|²/2, and the
    Jacobian there, J', has |J'⁻¹ J| <= 1/(1 - x) with x = M |w|. So the number of Kantorovich is
    at most (x / (1 - x))²/2 for each point of the step. It is below 1/2 for x < 1/2: then there
    is exactly one solution near each point, they join to one curve, and Newton's method finds
    its end. No step is longer than that, whatever is asked, so none leaves the branch.

    References
    ----------
    Kantorovich, Functional Analysis and Applied Mathematics (1948): the theorem on Newton's
    method. Ortega, Rheinboldt, Iterative Solution of Nonlinear Equations in Several Variables,
    12.6.

    """

    def __init__(self, linkage: Linkage) -> None:
        """Close the start exactly."""
        self.linkage = linkage
        self.equations = LoopEquations(linkage)
        self._inputs = len(linkage.inputs)
        rough = np.array([linkage.start[name] for name in linkage.variables])
        self.start = self._close(rough)

    def at(self, inputs: Mapping[str, float]) -> Pose:
        """
        Find the position for given inputs, straight from the start.

        Parameters
        ----------
        inputs : Mapping[str, float]
            Inputs [m, rad]; those left out stay as at the start.

        Returns
        -------
        Pose
            The position.

        Raises
        ------
        ConfigurationError
            When an input is unknown or out of range; the problem states the range.

        """
        unknown = [Problem(name, value, 'is no input of the linkage', 'known are: '
                           + ', '.join(self.linkage.inputs))
                   for name, value in inputs.items() if name not in self.linkage.inputs]
        unknown += [Problem(name, value, f'must be at most {_LARGEST:g} m or rad in magnitude')
                    for name, value in inputs.items() if not abs(value) <= _LARGEST]
        if unknown:
            raise ConfigurationError(unknown)
        try:
            return self.follow(self.start, inputs)
        except SingularError as error:
            raise ConfigurationError(self._range_problems(inputs, error)) from error

    def follow(self, pose: Pose, inputs: Mapping[str, float]) -> Pose:
        """
        Go from one position straight to other inputs.

        Parameters
        ----------
        pose : Pose
            Where to begin.
        inputs : Mapping[str, float]
            Inputs to go to [m, rad]; those left out stay.

        Returns
        -------
        Pose
            The position there, on the same branch.

        Raises
        ------
        SingularError
            When a singular position is in the way; nothing beyond it is tried.

        """
        names, count = self.linkage.inputs, self._inputs
        target = np.array([inputs.get(name, pose[name]) for name in names])
        z, steps = pose.values, pose.certificate.steps
        worst = pose.certificate.kantorovich
        inverse, clearance = self._condition(z)
        while np.any(z[:count] != target):
            if not clearance >= _SINGULAR:  # so that NaN counts as singular
                raise SingularError(
                    self._pose(z, clearance, steps, worst), Singularity.nearest(
                        self.linkage, self.equations, z))
            way = np.zeros_like(z)
            way[:count] = (target - z[:count]) / self.equations.units[:count]
            way[count:] = inverse @ -(self._scaled_jacobian(z)[:, :count] @ way[:count])
            length = float(np.linalg.norm(way)) / clearance
            share = 1.0 if length <= _SHARE else _SHARE / length
            x = share * length
            worst = max(worst, 0.5 * (x / (1.0 - x)) ** 2)
            z = z + share * way * self.equations.units
            if share == 1.0:
                z[:count] = target
            z = self._newton(z)
            steps += 1
            inverse, clearance = self._condition(z)
        if not clearance >= _SINGULAR:
            raise SingularError(self._pose(z, clearance, steps, worst), Singularity.nearest(
                self.linkage, self.equations, z))
        return self._pose(z, clearance, steps, worst)

    def range_of(self, name: str, pose: Pose | None = None) -> Range:
        """
        Find how far one input goes while the others stay.

        Parameters
        ----------
        name : str
            The input.
        pose : Pose, optional
            The position to begin at; None takes the start.

        Returns
        -------
        Range
            Its bounds and what stops it there; an angle that turns through a whole revolution
            is not bounded.

        """
        pose = self.start if pose is None else pose
        far = TURN if name in self.linkage.angles else _FAR * float(
            np.abs(self.equations.vectors(pose.values)).sum())
        bounds: list[tuple[float, Singularity | None]] = []
        for sign in (-1.0, 1.0):
            try:
                self.follow(pose, {name: pose[name] + sign * far})
                bounds.append((sign * math.inf, None))
            except SingularError as error:
                bounds.append((error.pose[name], error.singularity))
        (low, at_low), (high, at_high) = bounds
        return Range(low, high, at_low, at_high)

    def jacobian(self, pose: Pose) -> tuple[Array, Array]:
        """
        Give the derivatives of the closure at a position.

        Parameters
        ----------
        pose : Pose
            The position.

        Returns
        -------
        tuple[ndarray, ndarray], shapes (u, inputs) and (u, u)
            By the inputs and by the unknowns.

        """
        whole = self.equations.jacobian(pose.values)
        return whole[:, :self._inputs], whole[:, self._inputs:]

    def _scaled_jacobian(self, z: Array) -> Array:
        scaled: Array = self.equations.jacobian(z) * self.equations.units / self.equations.size
        return scaled

    def _condition(self, z: Array) -> tuple[Array, float]:
        """Give the inverse of the Jacobian by the unknowns, and the clearance."""
        try:
            inverse = np.asarray(
                np.linalg.inv(self._scaled_jacobian(z)[:, self._inputs:]), dtype=np.float64)
        except np.linalg.LinAlgError:
            return np.zeros((len(z) - self._inputs,) * 2), 0.0
        # norm of the two columns of each loop, from their Gram matrix
        real, imaginary = np.split(inverse, 2, axis=1)
        a, b, c = ((u * v).sum(axis=0) for u, v in (
            (real, real), (imaginary, imaginary), (real, imaginary)))
        weights = np.sqrt(0.5 * (a + b) + np.hypot(0.5 * (a - b), c))
        # the bound holds within a reach that depends on it: from the greatest reach downwards
        reach = _REACH / float((weights @ self.equations.bends(z, 0.0)).max())
        return inverse, 1.0 / float((weights @ self.equations.bends(z, reach)).max())

    def _newton(self, z: Array) -> Array:
        """Close the loops to rounding by the unknowns."""
        count, before = self._inputs, math.inf
        for _ in range(_NEWTON):
            step = np.linalg.solve(self._scaled_jacobian(z)[:, count:],
                                   self.equations.closure(z) / self.equations.size)
            size = float(np.linalg.norm(step))
            z = z.copy()
            z[count:] -= step * self.equations.units[count:]
            if size < _CONVERGED or not size < before:
                break  # steps are squared each time: rounding is all that is left
            before = size
        return z

    def _close(self, rough: Array) -> Pose:
        """Find the assembly that the start is near to."""
        inverse, clearance = self._condition(rough)
        step = inverse @ self.equations.closure(rough) / self.equations.size
        # h = M |J⁻¹| |J⁻¹ F|; the solution must be within the reach for which M holds
        distance = float(np.linalg.norm(step)) / max(clearance, np.finfo(float).tiny)
        if not (clearance >= _SINGULAR and distance <= 0.25):
            gap = float(np.abs(self.equations.closure(rough)).max())
            raise ConfigurationError([Problem(
                'unknowns', {name: float(rough[self._inputs + k]) for k, name in enumerate(
                    self.linkage.unknowns)},
                f'the start values name no branch: the loops miss by {gap:.4g} m there',
                'measure them on a drawing: near a singular position more closely')])
        z = self._newton(rough)
        return self._pose(z, self._condition(z)[1], 0, distance)

    def _pose(self, z: Array, clearance: float, steps: int, worst: float) -> Pose:
        sign = np.linalg.slogdet(self._scaled_jacobian(z)[:, self._inputs:])[0]
        return Pose(self.linkage, z, clearance, Certificate(steps, worst, int(sign)))

    def _range_problems(self, inputs: Mapping[str, float], error: SingularError,
                        ) -> list[Problem]:
        """Say which inputs are out of range; where none is alone, what stops them together."""
        problems = []
        for name, value in inputs.items():
            found = self.range_of(name)
            beyond = found.at_low if value <= found.low else found.at_high
            if found.low < value < found.high or beyond is None:
                continue
            low, high = (bound_text(self.linkage, name, x) for x in (found.low, found.high))
            problems.append(Problem(
                name, value, f'the linkage can be assembled from {low} to {high}, both ends '
                f'excluded; there {beyond.text}', 'stay within this range'))
        return problems or [Problem(
            ', '.join(inputs), tuple(inputs.values()),
            f'on the straight way from the start {error}',
            'give it another start, or go there by way of other inputs')]
