# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""All motion laws on one sheet, each in a panel of its own on the same scales."""

from __future__ import annotations

from collections.abc import Iterable
import math

from cam_motion.io.plots.style import COLOURS, figure_text, new_figure, styled
from cam_motion.motion.laws import Boundary, MotionLaw
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Piecewise
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
import numpy as np

_COLUMNS = 4
_ROW = 1.75  # height of a row of panels [inch]
_POINTS = 60  # per piece
# Derivative, its name and what it is divided by, so that all three fit one scale.
_CURVES = ((0, 's', 1.0), (1, 's′', 1.0), (2, 's″/4', 4.0), (3, 's‴/80', 80.0))
_MARGIN = 0.1  # of the scale, above and below
_TEXT = 0.14  # of the scale, below the curves
_LETTERS = {Boundary.REST: 'R', Boundary.CONSTANT_VELOCITY: 'V', Boundary.TURN: 'T',
            Boundary.MOTION: 'M'}


def laws_figure(laws: Iterable[MotionLaw]) -> Figure:
    """
    Draw position, velocity, acceleration and jerk of motion laws.

    Parameters
    ----------
    laws : Iterable[MotionLaw]
        The laws.

    Returns
    -------
    Figure
        One panel per law with its ends and coefficients; the scales are the same in all, and
        nothing is cut off.

    """
    laws = list(laws)
    rows = math.ceil(len(laws) / _COLUMNS)
    with styled():
        figure = new_figure(_ROW * rows + 0.5)
        panels = figure.subplots(rows, _COLUMNS, sharex=True, sharey=True, squeeze=False)
        values = [value for panel, law in zip(panels.flat, laws) for value in _draw(panel, law)]
        low, high = min(values, default=-1.0), max(values, default=1.0)
        height = high - low
        panels.flat[0].set_ylim(low - (_MARGIN + _TEXT) * height, high + _MARGIN * height)
        for panel in panels.flat[len(laws):]:
            panel.set_visible(False)
        for n in range(max(0, len(laws) - _COLUMNS), len(laws)):
            panels.flat[n].tick_params(labelbottom=True)
        figure.supxlabel('share of the span ξ', fontsize=9.0)
        handles = [Line2D([], [], color=COLOURS[n], label=name)
                   for n, (_, name, _) in enumerate(_CURVES)]
        figure.legend(handles=handles, loc='outside upper center', ncols=len(_CURVES))
    return figure


def _draw(panel: Axes, law: MotionLaw) -> tuple[float, float]:
    """Draw a law; give the range of its values."""
    panel.axhline(0.0, color='#444444', linewidth=0.8, zorder=1)
    low, high = 0.0, 1.0
    for n, (order, _, divisor) in enumerate(_CURVES):
        xi, values = _with_steps(law.curve, order)
        panel.plot(xi, values / divisor, color=COLOURS[n], linewidth=1.2, zorder=5 - n)
        low, high = min(low, values.min() / divisor), max(high, values.max() / divisor)
    panel.set_xlim(0.0, 1.0)
    panel.set_title(f'{law.name}  {"-".join(_LETTERS[end] for end in law.ends)}', fontsize=8.0)
    found = law.coefficients
    panel.text(
        0.97, 0.03, '  '.join(f'{name} {_text(value)}' for name, value in (
            ('Cv', found.cv), ('Ca', found.ca), ('Cj', found.cj))),
        transform=panel.transAxes, ha='right', va='bottom', fontsize=6.5,
        bbox={'boxstyle': 'square,pad=0.1', 'color': 'white', 'alpha': 0.8})
    return low, high


def _text(value: float) -> str:
    return '∞' if math.isinf(value) else figure_text(value)


def _with_steps(curve: Piecewise, order: int) -> tuple[Array, Array]:
    """Sample a derivative as it is between its own ends; its steps are upright lines."""
    derivative = curve.differentiated(order)
    xi = [begin + np.linspace(0.0, piece.length, _POINTS)
          for begin, piece in zip(derivative.breaks, derivative.pieces)]
    values = [piece(at - begin) for begin, piece, at in zip(
        derivative.breaks, derivative.pieces, xi)]
    return np.concatenate(xi), np.concatenate(values)
