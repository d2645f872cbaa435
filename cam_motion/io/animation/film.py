# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A film as plain data: what moves, the curves beside it, and where the cursor stands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
import math

from cam_motion.io.animation.drawing import Drawing
from cam_motion.motion.piece import Array
import numpy as np

_HEADROOM = 0.08  # share of a panel left free above and below its curves
_ROUNDING = 1e-9
_DIGITS = 4  # of the values beside the curves


@dataclass(frozen=True)
class Curve:
    """
    A curve beside the drawing.

    Attributes
    ----------
    name : str
        Its name; empty where the panel has but one.
    x, y : ndarray, shape (n,)
        The curve.
    at : ndarray, shape (frames,)
        Its value in each frame.
    colour : str
        Its colour.

    """

    name: str
    x: Array
    y: Array
    at: Array
    colour: str


@dataclass(frozen=True)
class Panel:
    """
    Curves on one scale.

    Attributes
    ----------
    label : str
        Quantity and unit.
    curves : Sequence[Curve]
        The curves.
    spans : Sequence[tuple[float, float]]
        Stretches of x that are shaded.

    """

    label: str
    curves: Sequence[Curve]
    spans: Sequence[tuple[float, float]] = ()

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Give the ends of its scale, the same in all frames."""
        low = min(float(np.min(curve.y)) for curve in self.curves)
        high = max(float(np.max(curve.y)) for curve in self.curves)
        largest = max(abs(low), abs(high))
        if high - low > _ROUNDING * max(largest, 1e-6):
            room = _HEADROOM * (high - low)
        else:  # a constant is a line, not the noise of its rounding
            room = 0.1 * largest if largest > _ROUNDING else 1.0
        return low - room, high + room

    @cached_property
    def decimals(self) -> int:
        """Give the decimals that its values are written with, the same in all frames."""
        largest = max(map(abs, self.limits))
        return max(0, min(6, _DIGITS - 1 - math.floor(math.log10(largest))))

    def text(self, value: float) -> str:
        """
        Write a value.

        Parameters
        ----------
        value : float
            The value.

        Returns
        -------
        str
            It with its decimals and a true minus sign, but no minus before a zero.

        """
        text = f'{value:.{self.decimals}f}'
        return text.replace('-', '−') if float(text) else text.lstrip('-')


@dataclass(frozen=True)
class Film:
    """
    A film.

    Attributes
    ----------
    title : str
        What it shows.
    drawing : Drawing
        What moves.
    panels : Sequence[Panel]
        The curves beside it.
    across : str
        What the curves go over, with its unit.
    cursor : ndarray, shape (frames,)
        Where the cursor stands.
    captions : Sequence[str]
        What is said of each frame.
    fps : float
        Frames per second.
    note : str
        How fast it goes.
    ticks : Sequence[float]
        Where the curves' axis has its ticks, if not anywhere.

    """

    title: str
    drawing: Drawing
    panels: Sequence[Panel]
    across: str
    cursor: Array
    captions: Sequence[str]
    fps: float
    note: str = ''
    ticks: Sequence[float] = ()

    def __len__(self) -> int:
        """Count the frames."""
        return len(self.captions)

    @property
    def span(self) -> tuple[float, float]:
        """Give the ends of what the curves go over."""
        curves = [curve for panel in self.panels for curve in panel.curves]
        return (min(float(curve.x[0]) for curve in curves),
                max(float(curve.x[-1]) for curve in curves))
