# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Steps along the branch of a linkage that cannot leave it, by the theorem of Kantorovich."""

from __future__ import annotations

from collections.abc import Mapping
import math
from operator import mul

from cam_motion.mechanism.linkage import Linkage
from cam_motion.mechanism.loops import LoopEquations
from cam_motion.mechanism.pose import Certificate, Foothold, Pose, SingularError
from cam_motion.mechanism.singular import Singularity
from cam_motion.motion.piece import Array
import numpy as np

# Share of the distance kept to singular positions that one step may take. With x = 0.4 the
# number of Kantorovich of the whole step is (x / (1 - x))² / 2 = 0.22, and 0.5 is allowed.
_SHARE = 0.4
# A root within a ball of (1 - sqrt(1 - 2 h)) (1 - x) of that distance, so this is ever touched.
_REACH = _SHARE + 0.16
# Clearance at which a position counts as singular: five digits of its velocities are lost.
_SINGULAR = 1e-5
# Up to this share the Jacobian at the beginning of the step closes the loops at its end: with
# x = 0.1 the corrections shrink tenfold or more each, within 1.2 times the first, x²/2.
_SHORT = 0.1
_NEWTON = 16
_CONVERGED = 1e-12  # so small a step leaves nothing but rounding


class Continuation:
    """
    Follows the solutions of the loop equations from one position to the next.

    Parameters
    ----------
    linkage : Linkage
        The linkage.

    Attributes
    ----------
    equations : LoopEquations
        Its equations.

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
        """Write down the equations."""
        self.linkage = linkage
        self.equations = LoopEquations(linkage)
        self._inputs = len(linkage.inputs)
        self._scale = self.equations.units / self.equations.size
        self._units = self.equations.units[self._inputs:].tolist()
        self._orientation = 0  # that of the branch; it changes in singular positions only

    def close(self, rough: Array) -> Pose | None:
        """
        Find the position that a rough one is near to, and begin the branch there.

        Parameters
        ----------
        rough : ndarray, shape (n,)
            The variables, inputs exactly and unknowns roughly [m, rad].

        Returns
        -------
        Pose | None
            The only position near by, by the theorem of Kantorovich; None where it promises none.

        """
        foothold = self._foothold(rough, 0, 0.0)
        step = foothold.inverse @ self.equations.closure(rough) / self.equations.size
        # h = M |J⁻¹| |J⁻¹ F|; the solution must be within the reach for which M holds
        distance = float(np.linalg.norm(step)) / max(
            foothold.clearance, np.finfo(float).tiny)
        if not (foothold.clearance >= _SINGULAR and distance <= 0.25):
            return None
        z = self._newton(rough)
        self._orientation = int(np.linalg.slogdet(self._scaled_jacobian(z)[:, self._inputs:])[0])
        return self.pose(self._foothold(z, 0, distance))

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
        target = np.array([inputs.get(name, pose[name]) for name in self.linkage.inputs])
        foothold = self.stand(pose)
        while not foothold.reaches(target):
            foothold = self.step(foothold, target)
        if not foothold.clearance >= _SINGULAR:
            raise self._singular(foothold)
        return self.pose(foothold)

    def stand(self, pose: Pose) -> Foothold:
        """
        Give what the next step from a position needs to know.

        Parameters
        ----------
        pose : Pose
            The position.

        Returns
        -------
        Foothold
            The same, ready for `step`.

        """
        proof = pose.certificate
        return self._foothold(pose.values, proof.steps, proof.kantorovich)

    def step(self, foothold: Foothold, target: Array) -> Foothold:
        """
        Go one certified step towards other inputs, all the way if that is near enough.

        Parameters
        ----------
        foothold : Foothold
            Where to begin.
        target : ndarray, shape (inputs,)
            Inputs to go to [m, rad].

        Returns
        -------
        Foothold
            Where the step ends, on the same branch.

        Raises
        ------
        SingularError
            When it begins in a singular position.

        """
        if not foothold.clearance >= _SINGULAR:  # so that NaN counts as singular
            raise self._singular(foothold)
        count, units, z = self._inputs, self.equations.units, foothold.z
        way = np.empty_like(z)
        way[:count] = (target - z[:count]) / units[:count]
        way[count:] = foothold.gain @ way[:count]
        length = math.sqrt(way @ way) / foothold.clearance
        share = 1.0 if length <= _SHARE else _SHARE / length
        x = share * length
        z = z + share * way * units
        if share == 1.0:
            z[:count] = target
        z = self._newton(z) if x > _SHORT else self._close_by(z, foothold.inverse)
        return self._foothold(z, foothold.steps + 1,
                              max(foothold.worst, 0.5 * (x / (1.0 - x)) ** 2))

    def pose(self, foothold: Foothold) -> Pose:
        """
        Give the position of a foothold.

        Parameters
        ----------
        foothold : Foothold
            The foothold.

        Returns
        -------
        Pose
            Its position, with the certificate.

        """
        return Pose(self.linkage, foothold.z, foothold.clearance, Certificate(
            foothold.steps, foothold.worst, self._orientation))

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
        scaled: Array = self.equations.jacobian(z) * self._scale
        return scaled

    def _foothold(self, z: Array, steps: int, worst: float) -> Foothold:
        """Find the inverse of the Jacobian by the unknowns, and the clearance."""
        count = self._inputs
        jacobian = self._scaled_jacobian(z)
        try:
            inverse = np.asarray(np.linalg.inv(jacobian[:, count:]), dtype=np.float64)
        except np.linalg.LinAlgError:
            nothing = np.zeros((len(z) - count,) * 2)
            return Foothold(z, nothing, nothing[:, :count], 0.0, steps, worst)
        # norm of the two columns of each loop, from their Gram matrix
        real, imaginary = inverse[:, :len(self.linkage.loops)], inverse[:, len(
            self.linkage.loops):]
        a, b = (0.5 * np.einsum('ij,ij->j', inverse, inverse)).reshape(2, -1)
        c = np.einsum('ij,ij->j', real, imaginary)
        weights = np.sqrt(a + b + np.hypot(a - b, c))
        # the bound holds within a reach that depends on it: from the greatest reach downwards
        here, growth = self.equations.bends(z, weights)
        clearance = 1.0 / float((here + _REACH / float(here.max()) * growth).max())
        return Foothold(z, inverse, -(inverse @ jacobian[:, :count]), clearance, steps, worst)

    def _newton(self, z: Array) -> Array:
        """Close the loops to rounding by the unknowns."""
        count, before = self._inputs, math.inf
        z = z.copy()
        for _ in range(_NEWTON):
            step = np.linalg.solve(self._scaled_jacobian(z)[:, count:],
                                   self.equations.closure(z) / self.equations.size)
            size = float(np.linalg.norm(step))
            z[count:] -= step * self.equations.units[count:]
            if size < _CONVERGED or not size < before:
                break  # steps are squared each time: rounding is all that is left
            before = size
        return z

    def _close_by(self, z: Array, inverse: Array) -> Array:
        """Do the same with the inverse of a Jacobian near by, in plain floats for speed."""
        count, before = self._inputs, math.inf
        values, rows = z.tolist(), (inverse / self.equations.size).tolist()
        units = self._units
        for _ in range(_NEWTON):
            gaps = self.equations.gaps(values)
            size = 0.0
            for k, row in enumerate(rows):
                step = sum(map(mul, row, gaps))
                size += step * step
                values[count + k] -= step * units[k]
            if size < _CONVERGED ** 2 or not size < before:
                break  # steps shrink each time: rounding is all that is left
            before = size
        return np.array(values)

    def _singular(self, foothold: Foothold) -> SingularError:
        return SingularError(self.pose(foothold), Singularity.nearest(
            self.linkage, self.equations, foothold.z))
