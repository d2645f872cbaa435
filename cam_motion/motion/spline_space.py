# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""All B-splines that meet given ends, and their derivatives as linear forms."""

from __future__ import annotations

from dataclasses import dataclass

from cam_motion.motion.laws import make_law, MotionLaw
from cam_motion.motion.laws.with_coefficients import end_coefficients, hodograph, uniform_knots
from cam_motion.motion.optimal import Demands
from cam_motion.motion.piece import Array
import numpy as np

Rows = tuple[Array, Array]
"""Matrix A and offset b of values A z + b of a derivative at points, in the free coefficients."""


@dataclass(frozen=True)
class Space:
    """
    All B-splines of a degree over equal intervals that meet what is demanded of their ends.

    Attributes
    ----------
    degree, intervals : int
        Degree and number of equal intervals.
    fixed : ndarray, shape (n + p,)
        The coefficients that the ends settle, 0 for the others.
    free : slice
        The others.

    """

    degree: int
    intervals: int
    fixed: Array
    free: slice

    @classmethod
    def meeting(cls, demands: Demands, degree: int, intervals: int) -> Space:
        """
        Make the space of curves with given ends.

        Parameters
        ----------
        demands : Demands
            Continuity and ends.
        degree, intervals : int
            Degree and number of equal intervals.

        Returns
        -------
        Space
            The space.

        """
        count = demands.continuity + 1
        start, end = demands.start[:count - 1], demands.end[:count - 1]
        turned = tuple(-v if order % 2 else v for order, v in enumerate(end, 1))
        fixed = np.zeros(intervals + degree)
        fixed[:count] = end_coefficients(degree, intervals, (0.0, *start))
        fixed[-count:] = end_coefficients(degree, intervals, (1.0, *turned))[::-1]
        return cls(degree, intervals, fixed, slice(count, intervals + degree - count))

    def coefficients(self, z: Array) -> Array:
        """
        Put the free coefficients among the fixed ones.

        Parameters
        ----------
        z : ndarray, shape (m,)
            Free coefficients.

        Returns
        -------
        ndarray, shape (n + p,)
            All coefficients.

        """
        found = self.fixed.copy()
        found[self.free] = z
        return found

    def law(self, z: Array) -> MotionLaw:
        """
        Make the law.

        Parameters
        ----------
        z : ndarray, shape (m,)
            Free coefficients.

        Returns
        -------
        MotionLaw
            The law.

        """
        return make_law('b_spline', degree=float(self.degree),
                        coefficients=self.coefficients(z).tolist())

    def rows(self, order: int, points: Array) -> Rows:
        """
        Give a derivative at points in the free coefficients.

        Parameters
        ----------
        order : int
            Order of the derivative, at most the degree.
        points : ndarray, shape (k,)
            Points from 0 to 1.

        Returns
        -------
        tuple[ndarray, ndarray], shapes (k, m) and (k,)
            Matrix and offset.

        """
        from scipy.interpolate import BSpline
        knots = uniform_knots(self.degree, self.intervals)
        inner = knots[order:len(knots) - order]
        basis = BSpline.design_matrix(points, inner, self.degree - order).toarray()
        matrix = basis @ hodograph(self.degree, self.intervals, order)
        return matrix[:, self.free], matrix @ self.fixed

    def mean_square(self, order: int) -> tuple[Rows, Array]:
        """
        Give a derivative at the points of a rule that integrates its square exactly.

        Parameters
        ----------
        order : int
            Order of the derivative.

        Returns
        -------
        tuple[Rows, ndarray]
            The derivative at the points, and their weights, shape (k,).

        """
        nodes, weights = np.polynomial.legendre.leggauss(self.degree - order + 1)
        starts = np.arange(self.intervals)[:, None]
        points = ((starts + 0.5 * (1.0 + nodes)) / self.intervals).ravel()
        return self.rows(order, points), np.tile(0.5 * weights / self.intervals, self.intervals)
