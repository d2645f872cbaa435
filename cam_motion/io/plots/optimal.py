# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A movement before and after it was optimised."""

from __future__ import annotations

from collections.abc import Sequence

from cam_motion.io.plots.style import COLOURS, GREY, new_figure, styled
from cam_motion.motion.limits import QUANTITIES
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Piecewise
from cam_motion.units import rate_text
from matplotlib.figure import Figure
import numpy as np

_POINTS = 400  # per curve, shared by its pieces
_LEAST = 12  # per piece
_ROOM = 1.15  # a limit further off than this many largest values is not drawn


def optimal_figure(name: str, before: tuple[str, Piecewise], after: tuple[str, Piecewise],
                   scales: Sequence[float], unit: str, limits: Sequence[float | None]) -> Figure:
    """
    Draw position to jerk of a movement before and after.

    Parameters
    ----------
    name : str
        The movement.
    before, after : tuple[str, Piecewise]
        Name and curve of the law, normalised.
    scales : Sequence[float]
        Factors to the unit of each of the four panels.
    unit : str
        Unit of the position.
    limits : Sequence[float | None]
        Limits on velocity, acceleration and jerk, in those units.

    Returns
    -------
    Figure
        Four panels over the share of the span.

    """
    with styled():
        figure = new_figure(7.5)
        rows = figure.subplots(4, 1, sharex=True)
        for order, row in enumerate(rows):
            low = high = 0.0
            for colour, width, (label, curve) in zip(
                    (GREY, COLOURS[0]), (1.2, 1.8), (before, after)):
                xi, values = _sampled(curve, order)
                values = values * scales[order]
                row.plot(xi, values, color=colour, linewidth=width,
                         label=label if order == 0 else None)
                low, high = min(low, float(values.min())), max(high, float(values.max()))
            row.axhline(0.0, color='#444444', linewidth=0.8, zorder=1)
            limit = limits[order - 1] if order else None
            for sign, reach in ((1.0, high), (-1.0, -low)):
                if limit is not None and limit <= _ROOM * reach:
                    row.axhline(sign * limit, color=COLOURS[1], linewidth=1.1,
                                linestyle=(0, (5, 3)))
            row.set_ylabel(f'{QUANTITIES[order]}\n[{rate_text(unit, order)}]')
        rows[0].set_title(f'{name}: before and after')
        rows[0].legend(loc='upper left' if scales[0] > 0.0 else 'upper right')
        rows[-1].set_xlabel('share of the span ξ')
        rows[-1].set_xlim(0.0, 1.0)
        figure.align_ylabels(rows)
    return figure


def _sampled(curve: Piecewise, order: int) -> tuple[Array, Array]:
    """Sample a derivative piece by piece; its steps are upright lines, dwells on both sides."""
    derivative = curve.differentiated(order)
    count = max(_LEAST, _POINTS // len(derivative.pieces))
    xi = [begin + np.linspace(0.0, piece.length, count)
          for begin, piece in zip(derivative.breaks, derivative.pieces)]
    values = [piece(at - begin) for begin, piece, at in zip(
        derivative.breaks, derivative.pieces, xi)]
    return np.concatenate(xi), np.concatenate(values)
