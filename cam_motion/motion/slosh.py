# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
Liquid in an open container that an axis moves: when it sloshes, and how high.

Linear theory of small waves: only the first antisymmetric mode counts, which behaves as a
pendulum hung in the container.
"""

from __future__ import annotations

from dataclasses import dataclass
import math

GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s²]."""

_BESSEL = 1.8411837813406593  # least zero of the derivative of the Bessel function J1


@dataclass(frozen=True)
class Container:
    """
    An upright container with liquid: a box, or a cylinder.

    Attributes
    ----------
    fill_height : float
        Height of the liquid at rest [m].
    width : float | None
        Inner width of a box in the direction in which it moves [m].
    radius : float | None
        Inner radius of a cylinder [m]; one of the two is given.

    Notes
    -----
    The free surface follows from the potential flow in the box (or cylinder): at the wall the
    first mode q obeys q'' + 2 zeta w q' + w² q = -c a, with a the acceleration of the container
    and c = `height_factor`. A steady acceleration then raises the wall to 0.811 of half the width
    times a / g (0.837 of the radius): the higher modes make up what is missing to 1.

    References
    ----------
    H. N. Abramson (ed.), The Dynamic Behavior of Liquids in Moving Containers, NASA SP-106
    (1966), chapter 2; R. A. Ibrahim, Liquid Sloshing Dynamics (2005), chapters 1 and 5.

    """

    fill_height: float
    width: float | None = None
    radius: float | None = None

    @property
    def _wave_number(self) -> float:
        if self.width is not None:
            return math.pi / self.width
        assert self.radius is not None, 'a container is a box or a cylinder'
        return _BESSEL / self.radius

    @property
    def _depth(self) -> float:
        return math.tanh(self._wave_number * self.fill_height)

    @property
    def frequency(self) -> float:
        """First natural frequency w [rad/s]: w² = g k tanh(k h), k pi/width or 1.841/radius."""
        return math.sqrt(GRAVITY * self._wave_number * self._depth)

    @property
    def pendulum_length(self) -> float:
        """Length of the pendulum with the same frequency [m]."""
        return GRAVITY / self.frequency ** 2

    @property
    def height_factor(self) -> float:
        """Height of the wave at the wall per deviation of the equivalent oscillator [-]."""
        if self.width is not None:
            return 4.0 / math.pi * self._depth
        square = _BESSEL * _BESSEL
        return 2.0 * _BESSEL / (square - 1.0) * self._depth

    @property
    def moving_share(self) -> float:
        """Share of the liquid's mass that swings as the pendulum [-]."""
        depth = self._wave_number * self.fill_height
        if self.width is not None:
            return 8.0 / math.pi ** 2 * self._depth / depth
        return 2.0 / (_BESSEL * _BESSEL - 1.0) * self._depth / depth
