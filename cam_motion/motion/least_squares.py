# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Least squares within linear bounds, solved exactly."""

from __future__ import annotations

from cam_motion.motion.piece import Array
import numpy as np


def least_squares(matrix: Array, side: Array, bounds: Array, levels: Array) -> Array:
    """
    Minimise |A x - b| subject to G x >= h.

    Parameters
    ----------
    matrix, side : ndarray, shapes (k, n) and (k,)
        A and b; the columns of A are independent.
    bounds, levels : ndarray, shapes (m, n) and (m,)
        G and h; m may be 0. Some x must keep them.

    Returns
    -------
    ndarray, shape (n,)
        The minimum.

    Notes
    -----
    With A = Q R and y = R x - Q^T b the problem is to find the shortest y with
    G R^-1 y >= h - G R^-1 Q^T b, which non-negative least squares solves in finitely many steps.

    References
    ----------
    C. L. Lawson, R. J. Hanson, Solving Least Squares Problems (1974), chapter 23, problems LSI
    and LDP.

    """
    from scipy.linalg import solve_triangular
    from scipy.optimize import nnls
    q, r = np.linalg.qr(matrix)
    free = q.T @ side
    if len(levels):
        turned = solve_triangular(r, bounds.T, trans='T').T
        short = levels - turned @ free
        # rows of one length: the active ones are chosen by distance
        size = np.linalg.norm(turned, axis=1)
        turned, short = turned / size[:, None], short / size
        if np.any(short > 0.0):
            stack = np.vstack([turned.T, short])
            goal = np.zeros(len(stack))
            goal[-1] = 1.0
            dual, _ = nnls(stack, goal, maxiter=50 * len(short))
            rest = stack @ dual - goal
            free = free - rest[:-1] / rest[-1]
    found: Array = solve_triangular(r, free)
    return found
