# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The one style of all pictures: sizes, colours, the angle axis, and how they are saved."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from cam_motion.motion.piece import Array
from cam_motion.motion.profile import CamProfile
from cam_motion.units import DEGREE
import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
import numpy as np

FORMATS = ('png', 'svg', 'pdf')
"""File formats of pictures."""

COLOURS = ('#0072B2', '#D55E00', '#009E73', '#CC79A7', '#56B4E9', '#E69F00', '#000000')
"""Line colours that the colour-blind tell apart (Okabe and Ito, 2008)."""

GREY = '#6B6B6B'
"""Colour of what only explains: limits, notes, secondary lines."""

WIDTH = 9.0
"""Width of every picture [inch]; on a page 900 pixels wide its text stays readable."""

_DPI = 160
_POINTS = 240  # per segment: smooth at print resolution
_MOST_POINTS = 12000  # of one curve, however many pieces a table makes of it
_FEWEST_POINTS = 6
_BESIDE = 1e-9  # how far beside an edge its two sides are looked at (relative)
# Two angle labels closer than this would touch at the width above [deg].
_CLOSE_DEG = 14.0
_STYLE: dict[Any, Any] = {
    'font.family': 'DejaVu Sans',  # it comes with matplotlib, so pictures look alike everywhere
    'font.size': 9.0,
    'axes.titlesize': 11.0,
    'axes.titleweight': 'bold',
    'axes.titlelocation': 'left',
    'axes.spines.top': False,
    'axes.spines.right': False,
    'axes.edgecolor': '#444444',
    'axes.linewidth': 0.8,
    'axes.grid': True,
    'grid.color': '#E4E4E4',
    'grid.linewidth': 0.7,
    'axes.axisbelow': True,
    'lines.linewidth': 1.8,
    'lines.solid_joinstyle': 'round',
    'xtick.color': '#444444',
    'ytick.color': '#444444',
    'xtick.labelcolor': 'black',
    'ytick.labelcolor': 'black',
    'xtick.labelsize': 8.5,
    'ytick.labelsize': 8.5,
    'legend.frameon': False,
    'legend.fontsize': 8.5,
    'figure.facecolor': 'white',
    'savefig.facecolor': 'white',
    'svg.fonttype': 'none',
    'svg.hashsalt': 'cam_motion',  # the same picture is the same file
    'path.simplify': False,
}


@contextmanager
def styled() -> Iterator[None]:
    """
    Draw in the common style.

    Yields
    ------
    None
        Everything made within the context is in the style; settings outside stay untouched.

    """
    with matplotlib.rc_context(_STYLE):
        yield


def new_figure(height: float) -> Figure:
    """
    Make an empty figure, free of pyplot.

    Parameters
    ----------
    height : float
        Its height [inch].

    Returns
    -------
    Figure
        The figure, of the common width, its layout found by constraints.

    """
    figure = Figure(figsize=(WIDTH, height), dpi=_DPI, layout='constrained')
    FigureCanvasAgg(figure)
    return figure


def save(figure: Figure, path: Path) -> Path:
    """
    Write a figure to a file; its suffix tells the format.

    Parameters
    ----------
    figure : Figure
        The figure.
    path : Path
        The file; its directory is made.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    OSError
        When the file cannot be written.

    """
    path.parent.mkdir(parents=True, exist_ok=True)
    # no dates: the same figures give the same file
    undated: dict[str, dict[str, str | None]] = {
        '.svg': {'Date': None}, '.pdf': {'CreationDate': None}}
    with styled():
        figure.savefig(path, metadata=undated.get(path.suffix))
    return path


def exact_curve(profile: CamProfile, order: int, edges: Sequence[float] = (),
                ) -> tuple[Array, Array]:
    """
    Give one cycle of a cam as points to be joined by lines.

    Parameters
    ----------
    profile : CamProfile
        The cam.
    order : int
        Order of the derivative.
    edges : Sequence[float]
        Further shaft angles at which something steps, within one turn [rad].

    Returns
    -------
    tuple[ndarray, ndarray], shape (n,) each
        Shaft angles [deg] and values [unit/rad^order]. Every joint is there twice, with its value
        from the left and from the right, so that a step is drawn as one; and so is every edge,
        by angles just before and just behind it.

    """
    curve = profile.curve.differentiated(order)
    angles, values = [], []
    count = max(_FEWEST_POINTS, min(_POINTS, _MOST_POINTS // len(curve.pieces)))
    for begin, piece in zip(curve.breaks, curve.pieces):
        beside = np.outer(edges, (1.0 - _BESIDE, 1.0 + _BESIDE)).ravel() - begin
        beside = beside[(beside > 0.0) & (beside < piece.length)]
        local = np.sort(np.concatenate([np.linspace(0.0, piece.length, count), beside]))
        angles.append((begin + local) / DEGREE)
        values.append(piece(local))
    return np.concatenate(angles), np.concatenate(values)


def figure_text(value: float) -> str:
    """
    Write a number beside a point of a picture.

    Parameters
    ----------
    value : float
        The number.

    Returns
    -------
    str
        Five significant digits, no exponent below a million, a true minus sign.

    """
    text = f'{value:.0f}' if 1e4 <= abs(value) < 1e6 else f'{value:.5g}'
    return text.replace('-', '−')


def angle_axis(axes: Axes, ends_deg: Sequence[float], label: str | None = None,
               numbered: bool = True) -> None:
    """
    Set up an axis of one turn with ticks where segments end.

    Parameters
    ----------
    axes : Axes
        The axes.
    ends_deg : Sequence[float]
        Angles at which segments end [deg], rising, the last one 360.
    label : str | None
        Label of the axis; none for the upper ones of a stack.
    numbered : bool
        Whether the ticks carry their angles.

    """
    ticks = [0.0, *ends_deg]
    axes.set_xlim(0.0, 360.0)
    axes.set_xticks(ticks, [f'{tick:.6g}°' for tick in ticks])
    if not numbered:
        axes.tick_params(axis='x', labelbottom=False)
    labels = axes.get_xticklabels()
    crowded = [b - a < _CLOSE_DEG for a, b in zip(ticks, ticks[1:])]
    for place, text in enumerate(labels):
        left = place > 0 and crowded[place - 1]
        right = place < len(crowded) and crowded[place]
        if left and right:
            text.set_visible(False)  # its tick stays
        elif left or right:
            text.set_horizontalalignment('left' if left else 'right')
    if label:
        axes.set_xlabel(label)
