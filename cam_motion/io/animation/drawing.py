# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What moves in a film, as plain data: lines, areas, joints, vectors and texts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
import math

from cam_motion.io.plots.style import COLOURS
from cam_motion.motion.piece import Array
import numpy as np
from numpy.typing import NDArray

Places = NDArray[np.complex128]
"""Points of the plane, x + j y."""

THIN = 0.8
"""Width of lines that only explain [pt]."""

TRACE = '#C9C9C9'
"""Colour of the ways of points."""

_ROOM = 0.05  # share of the drawing left free around everything that ever moves in it


@dataclass(frozen=True)
class Shape:
    """
    A line, an area or joints, which change frame by frame or move as a whole.

    Attributes
    ----------
    points : ndarray of complex, shape (n,) or (frames, n)
        Its points, the same in all frames or of each.
    colour : str
        Colour of its line, or of the edge of its area.
    width : float
        Width of its line [pt].
    fill : str
        Colour of its area; empty for a line.
    dashed : bool
        Whether its line is dashed.
    joints : bool
        Whether its points are drawn as joints, without a line.
    turn : ndarray, shape (frames,), optional
        Angles about the origin by which it is turned [rad].
    shift : ndarray of complex, shape (frames,), optional
        Where its origin is, after the turn.

    """

    points: Places
    colour: str = COLOURS[0]
    width: float = 2.0
    fill: str = ''
    dashed: bool = False
    joints: bool = False
    turn: Array | None = None
    shift: Places | None = None

    @property
    def moves(self) -> bool:
        """Whether it is not the same in all frames."""
        return self.points.ndim == 2 or self.turn is not None or self.shift is not None

    def at(self, frame: int) -> Places:
        """
        Give its points in a frame.

        Parameters
        ----------
        frame : int
            Number of the frame.

        Returns
        -------
        ndarray of complex, shape (n,)
            The points.

        """
        points = self.points if self.points.ndim == 1 else self.points[frame]
        if self.turn is not None:
            points = points * np.exp(1j * self.turn[frame])
        return points if self.shift is None else points + self.shift[frame]


@dataclass(frozen=True)
class Arrows:
    """
    Vectors at points, all on one scale.

    Attributes
    ----------
    names : Sequence[str]
        Whose vectors they are.
    feet, vectors : ndarray of complex, shape (frames, n)
        Where they begin, and what they are.
    scale : float
        Length in the drawing of a vector of 1.
    unit : str
        Unit of the vectors; empty for directions, which need no key.
    colour : str
        Their colour.

    """

    names: Sequence[str]
    feet: Places
    vectors: Places
    scale: float
    unit: str = ''
    colour: str = COLOURS[1]

    @property
    def key(self) -> float:
        """Give a round length for the key, at most half of the longest vector."""
        longest = float(np.max(np.abs(self.vectors), initial=0.0))
        return round_below(0.5 * longest) if longest else 0.0


@dataclass(frozen=True)
class Label:
    """
    A text in the drawing.

    Attributes
    ----------
    text : str
        The text.
    place : complex or ndarray of complex, shape (frames,)
        Where it stands.
    offset : complex or ndarray of complex, shape (frames,)
        How far right and up from there [pt].
    align : str
        Which part of the text stands there: ``left``, ``center`` or ``right``.
    colour : str
        Its colour.
    texts : Sequence[str], optional
        What it says in each frame instead, where that changes.

    """

    text: str
    place: complex | Places
    offset: complex | Places = 0.0
    align: str = 'left'
    colour: str = '#000000'
    texts: Sequence[str] = ()

    @property
    def moves(self) -> bool:
        """Whether it is not the same in all frames."""
        return bool(self.texts) or np.ndim(self.place) == 1 or np.ndim(self.offset) == 1

    def at(self, frame: int) -> tuple[str, complex, complex]:
        """
        Give what it says in a frame, and where.

        Parameters
        ----------
        frame : int
            Number of the frame.

        Returns
        -------
        tuple[str, complex, complex]
            Text, place, and how far from there [pt].

        """
        place, offset = (complex(each[frame] if isinstance(each, np.ndarray) and each.ndim else
                                 each) for each in (self.place, self.offset))
        return self.texts[frame] if self.texts else self.text, place, offset


@dataclass(frozen=True)
class Drawing:
    """
    What moves.

    Attributes
    ----------
    shapes : Sequence[Shape]
        Lines and areas, the lowest first; those that never move lie below all others.
    arrows : Sequence[Arrows]
        Vectors.
    labels : Sequence[Label]
        Texts.
    unit : str
        Unit of both axes; empty for a drawing without axes.

    """

    shapes: Sequence[Shape]
    arrows: Sequence[Arrows] = ()
    labels: Sequence[Label] = ()
    unit: str = 'm'

    @cached_property
    def box(self) -> tuple[float, float, float, float]:
        """Give left, bottom, right and top of all that is ever drawn, with some room."""
        seen = np.concatenate([*self._extent()])
        low, high = complex(seen.real.min(), seen.imag.min()), complex(
            seen.real.max(), seen.imag.max())
        room = _ROOM * max(abs(high - low), 1e-12) * (1 + 1j)
        return ((low - room).real, (low - room).imag, (high + room).real, (high + room).imag)

    def _extent(self) -> Iterator[Places]:
        for shape in self.shapes:
            count = max((len(each) for each in (shape.turn, shape.shift) if each is not None),
                        default=len(shape.points) if shape.points.ndim == 2 else 1)
            if shape.turn is not None:  # a turning shape sweeps a disc
                reach = float(np.abs(shape.points).max())
                centres = np.zeros(1, complex) if shape.shift is None else shape.shift
                yield (centres[:, None] + reach * np.array([1, -1, 1j, -1j])).ravel()
            else:
                yield np.concatenate([shape.at(k) for k in range(count)])
        for each in self.arrows:
            yield each.feet.ravel()
            yield (each.feet + each.scale * each.vectors).ravel()
        for label in self.labels:
            yield np.atleast_1d(np.asarray(label.place, dtype=np.complex128))


def round_below(value: float) -> float:
    """
    Give a round number.

    Parameters
    ----------
    value : float
        A number above 0.

    Returns
    -------
    float
        The largest of 1, 2 and 5 times a power of ten that is not above it.

    """
    power = 10.0 ** math.floor(math.log10(value) + 1e-12)
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1 + 1e-12))


def circle(radius: float, count: int = 72) -> Places:
    """
    Give a circle about the origin as a closed line.

    Parameters
    ----------
    radius : float
        Its radius.
    count : int
        Number of its sides.

    Returns
    -------
    ndarray of complex, shape (count + 1,)
        Its points.

    """
    return np.asarray(radius * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, count + 1)))
