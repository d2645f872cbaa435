# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
A transition of the speed rather than the position: it goes from one speed to the other.

A blend of positions makes up on its way for what lies between the two motions, and where that
grows, as between two gears, it overshoots both speeds and may turn back. Here the speed is
blended, y' = old' + w (new' - old'), so that it stays between the two wherever they are, and the
position is what comes of it.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property

from cam_motion.motion.compiled import Sampler
from cam_motion.motion.piece import Array
from cam_motion.runtime.transition import Blend, weight
import numpy as np

_NODES = 12  # of the polynomial through the integrand within a cell
_CELLS = 4  # at least so many between two joints: what is left of a sinusoid is below 1e-13
_WIDEST = 0.2  # widest cell, as a share of the span
_AT = 0.5 - 0.5 * np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)  # Chebyshev nodes in [0, 1]
_FIT = np.linalg.inv(np.vander(2.0 * _AT - 1.0, increasing=True))  # coefficients from values
_POWERS = np.arange(1, _NODES + 1)


@dataclass(frozen=True)
class SpeedBlend(Blend):
    """
    The way from one motion to another by their speeds; see `Blend` for the attributes.

    Notes
    -----
    With d = new - old and the weight w, the position is old + w d - K, where K is the integral of
    w' d from the start. It ends on the new motion if K is 0 at the end; `gap` is by how much the
    new one is to be shifted for that.

    """

    @cached_property
    def _made_up(self) -> tuple[Array, Array]:
        """Give the edges of cells, and in each the polynomial of K over [-1, 1], rising powers."""
        low, high = sorted((self.start, self.end))
        joints = self.joints(low, high)
        ends = np.unique(np.concatenate([[low, high], joints]))
        counts = np.maximum(
            _CELLS, np.ceil(np.diff(ends) / (_WIDEST * (high - low)))).astype(int)
        edges = np.append(np.concatenate([
            np.linspace(a, b, count, endpoint=False)
            for a, b, count in zip(ends, ends[1:], counts)]), high)
        widths = np.diff(edges)
        phi = (edges[:-1, None] + widths[:, None] * _AT).ravel()
        w1 = weight((phi - self.start) / self.span)[1] / self.span
        rates = (w1 * (self.new(phi)[0] - self.old(phi)[0])).reshape(-1, _NODES)
        powers = np.zeros((len(widths), _NODES + 1))
        powers[:, 1:] = rates @ _FIT.T / _POWERS * (0.5 * widths[:, None])
        signs = (-1.0) ** np.arange(_NODES + 1)
        powers[:, 0] = -powers @ signs  # from the lower edge of each cell
        powers[1:, 0] += np.cumsum(powers.sum(axis=1))[:-1]
        if self.span < 0.0:
            powers[:, 0] -= powers[-1].sum()  # from the start, which is the upper end
        return edges, powers

    @property
    def gap(self) -> float:
        """Give what must be added to the new motion so that the blend ends on it."""
        powers = self._made_up[1]
        if self.span < 0.0:
            return -float(powers[0] @ (-1.0) ** np.arange(_NODES + 1))
        return -float(powers[-1].sum())

    @cached_property
    def sample(self) -> Sampler:
        """Evaluate (y, y', y'', y''') at one shaft angle [rad]."""
        old, new, start, rate = self.old.sample, self.new.sample, self.start, 1.0 / self.span
        edges = self._made_up[0].tolist()
        falling = self._made_up[1][:, ::-1].tolist()
        last = len(falling) - 1

        def blended(phi: float) -> tuple[float, float, float, float]:
            x = (phi - start) * rate
            if x <= 0.0:
                return old(phi)
            if x >= 1.0:
                return new(phi)
            cell = min(max(bisect_right(edges, phi) - 1, 0), last)
            low, high = edges[cell], edges[cell + 1]
            t, made_up = 2.0 * (phi - low) / (high - low) - 1.0, 0.0
            for power in falling[cell]:
                made_up = made_up * t + power
            rest = 1.0 - x
            w = x * x * x * (10.0 - x * (15.0 - 6.0 * x))
            w1 = 30.0 * (x * rest) ** 2 * rate
            w2 = 60.0 * x * rest * (rest - x) * rate * rate
            y, slope, bend, jerk = old(phi)
            d, d1, d2, d3 = new(phi)
            d, d1, d2, d3 = d - y, d1 - slope, d2 - bend, d3 - jerk
            return (
                y + w * d - made_up,
                slope + w * d1,
                bend + w1 * d1 + w * d2,
                jerk + w2 * d1 + 2.0 * w1 * d2 + w * d3)
        return blended

    def __call__(self, phi: Array) -> Array:
        """
        Evaluate the blend and its derivatives.

        Parameters
        ----------
        phi : ndarray, shape (n,)
            Shaft angles [rad].

        Returns
        -------
        ndarray, shape (4, n)
            Position and three derivatives, in the unit of the axis per rad^order of the shaft.

        """
        rates = self.span ** -np.arange(4.0)
        w, w1, w2, _ = weight((phi - self.start) / self.span) * rates[:, None]
        values = self.old(phi)
        d, d1, d2, d3 = self.new(phi) - values
        edges, powers = self._made_up
        cell = np.clip(np.searchsorted(edges, phi, side='right') - 1, 0, len(powers) - 1)
        t = np.clip(2.0 * (phi - edges[cell]) / np.diff(edges)[cell] - 1.0, -1.0, 1.0)
        values[0] += w * d - np.einsum('ij,ij->i', powers[cell], np.vander(
            t, _NODES + 1, increasing=True))
        values[1] += w * d1
        values[2] += w1 * d1 + w * d2
        values[3] += w2 * d1 + 2.0 * w1 * d2 + w * d3
        return values
