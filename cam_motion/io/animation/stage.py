# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Frames of a film as pictures: what stands is drawn once, what moves again and again."""

from __future__ import annotations

from typing import Any

from cam_motion.io.animation.drawing import Arrows, Shape
from cam_motion.io.animation.film import Curve, Film, Panel
from cam_motion.io.animation.lettering import Picture, stamp
from cam_motion.io.plots.style import GREY, styled
from cam_motion.motion.piece import Array
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.quiver import Quiver
import numpy as np

_DPI = 100.0  # at the usual size
_LEAST_DPI = 40.0

# All in inches: texts keep their size whatever the size of the picture.
_LEFT, _BOTTOM, _TOP, _RIGHT = 0.74, 0.5, 0.8, 0.12
_GAP = 0.3  # between panels: what each shows stands there
_LABELS = 0.62  # for the scales of the panels
_LETTER = 0.076  # of the names beside the curves
_SWATCH = 0.16
_ROW = 0.165
_TEXT = 9.0  # [pt]
_SHARE = 0.47  # of the drawing in the width that is left
_MIN = 0.4  # of anything: below that texts have no room at all


def usual_size(film: Film) -> tuple[int, int]:
    """
    Give the size of a film that nobody set.

    Parameters
    ----------
    film : Film
        The film.

    Returns
    -------
    tuple[int, int]
        Width and height [px].

    """
    return 900, max(560, 130 + 95 * len(film.panels))


class Stage:
    """
    Draws the frames of a film, each in a few milliseconds.

    Parameters
    ----------
    film : Film
        The film.
    size : tuple[int, int], optional
        Width and height [px].
    dpi : float, optional
        Pixels per inch, which scale lines and texts; as the size wants it if left out.

    """

    def __init__(self, film: Film, size: tuple[int, int] | None = None, dpi: float | None = None,
                 ) -> None:
        """Draw what stands still."""
        self.film = film
        self.size = usual_size(film) if size is None else size
        if dpi is None:
            dpi = max(_LEAST_DPI, _DPI * min(
                given / usual for given, usual in zip(self.size, usual_size(film))))
        # the half avoids that rounding takes a pixel away
        width, height = ((pixels + 0.5) / dpi for pixels in self.size)
        with styled():
            self.figure = Figure(figsize=(width, height), dpi=dpi)
            canvas: Any = FigureCanvasAgg(self.figure)  # it has no types
            self._set_out(width, height)
            canvas.draw()
        self._canvas = canvas
        self._still = canvas.copy_from_bbox(self.figure.bbox)

    def frame(self, frame: int) -> Picture:
        """
        Draw a frame.

        Parameters
        ----------
        frame : int
            Its number.

        Returns
        -------
        ndarray of uint8, shape (height, width, 3)
            Red, green and blue.

        """
        self._canvas.restore_region(self._still)
        with styled():
            self.pose(frame)
            for artist in self._moving:
                (artist.axes or self.figure).draw_artist(artist)
        picture = np.ascontiguousarray(np.asarray(self._canvas.buffer_rgba())[:, :, :3])
        self._write(picture, frame)
        return picture

    def pose(self, frame: int) -> None:
        """
        Put everything that moves where it is in a frame.

        Parameters
        ----------
        frame : int
            Its number.

        """
        for shape, artist in self.shapes:
            points = shape.at(frame)
            if isinstance(artist, Polygon):
                artist.set_xy(_columns(points))
            else:
                artist.set_data(points.real, points.imag)
        for arrows, quiver in self.arrows:
            feet, vectors = arrows.feet[frame], arrows.scale * arrows.vectors[frame]
            quiver.set_offsets(_columns(feet))
            quiver.set_UVC(vectors.real, vectors.imag)
        at = float(self.film.cursor[frame])
        for line in self.cursors:
            line.set_xdata([at, at])
        for curve, dot in self.dots:
            dot.set_data([at], [curve.at[frame]])

    def _write(self, picture: Picture, frame: int) -> None:
        """Write what moves or changes."""
        points, dpi = self.figure.dpi / 72.0, self.figure.dpi
        stamp(picture, self.film.captions[frame], (0.12 * dpi, self.size[1] - 0.44 * dpi), _TEXT,
              dpi)
        for label in self.film.drawing.labels:
            if label.moves:
                said, at, offset = label.at(frame)
                x, y = self.drawing.transData.transform((at.real, at.imag))
                stamp(picture, said, (x + offset.real * points, y + offset.imag * points),
                      _TEXT, dpi, label.align, label.colour)
        for panel, curve, place, size in self._values:
            stamp(picture, panel.text(curve.at[frame]), place, size, dpi, 'right')

    def _set_out(self, width: float, height: float) -> None:
        """Place the drawing on the left, the panels on the right, and the words above."""
        film = self.film
        self.shapes: list[tuple[Shape, Line2D | Polygon]] = []
        self.arrows: list[tuple[Arrows, Quiver]] = []
        self.dots: list[tuple[Curve, Line2D]] = []
        self._values: list[tuple[Panel, Curve, tuple[float, float], float]] = []
        self.cursors: list[Line2D] = []
        self._moving: list[Artist] = []
        named = any(curve.name for panel in film.panels for curve in panel.curves)
        letters = max((len(curve.name) + 3 * named + len(panel.text(limit))
                       for panel in film.panels for curve in panel.curves
                       for limit in panel.limits), default=0)
        names = _SWATCH * named + _LETTER * letters + 0.1
        left = _LEFT if film.drawing.unit else _RIGHT
        free = max(width - left - _LABELS - names - _RIGHT, 2 * _MIN)
        tall = max(height - _TOP - _BOTTOM, _MIN)
        bottom = _BOTTOM if film.drawing.unit else _RIGHT

        def inches(x: float, y: float, wide: float, high: float) -> Axes:
            return self.figure.add_axes((x / width, y / height, wide / width, high / height))

        share = _SHARE if film.panels else 1.0
        self.drawing = inches(left, bottom, share * free, height - _TOP - bottom)
        self._draw(share * free, max(height - _TOP - bottom, _MIN))
        self.panels: list[Axes] = []
        count = len(film.panels)
        x = left + share * free + _LABELS
        for k, panel in enumerate(film.panels):
            high = (tall - (count - 1) * _GAP) / count
            y = _BOTTOM + (count - 1 - k) * (high + _GAP)
            axes = inches(x, y, (1.0 - share) * free, max(high, 0.05))
            self._panel(axes, panel, k == count - 1)
            self._names(panel, (x + (1.0 - share) * free + 0.1) / width, y / height, width,
                        height, high, names - 0.1)
        self.figure.text(0.12 / width, 1.0 - 0.1 / height, film.title, va='top', fontsize=11.0,
                         fontweight='bold')
        self.figure.text(1.0 - 0.12 / width, 1.0 - 0.12 / height, film.note, va='top',
                         ha='right', color=GREY)

    def _draw(self, width: float, height: float) -> None:
        """Draw what stands, and make what moves; both axes on one scale."""
        axes, drawing = self.drawing, self.film.drawing
        left, bottom, right, top = drawing.box
        scale = max((right - left) / width, (top - bottom) / height)  # units per inch
        middle = (0.5 * (left + right), 0.5 * (bottom + top))
        axes.set_xlim(middle[0] - 0.5 * scale * width, middle[0] + 0.5 * scale * width)
        axes.set_ylim(middle[1] - 0.5 * scale * height, middle[1] + 0.5 * scale * height)
        if drawing.unit:
            axes.set_xlabel(f'x [{drawing.unit}]')
            axes.set_ylabel(f'y [{drawing.unit}]')
            axes.locator_params(nbins=6)
        else:
            axes.set_axis_off()
        for shape in drawing.shapes:
            artist = _shape(axes, shape)
            if shape.moves:
                self.shapes.append((shape, artist))
                self._animate(artist)
        for arrows in drawing.arrows:
            quiver = _quiver(axes, arrows, np.zeros(len(arrows.names)))
            self.arrows.append((arrows, quiver))
            self._animate(quiver)
            if arrows.unit and arrows.key:
                _key(axes, arrows, scale)
        for label in drawing.labels:
            if not label.moves:
                said, place, offset = label.at(0)
                axes.annotate(
                    said, (place.real, place.imag), xytext=(offset.real, offset.imag),
                    textcoords='offset points', ha=label.align, va='center',
                    color=label.colour, annotation_clip=False)

    def _panel(self, axes: Axes, panel: Panel, lowest: bool) -> None:
        film = self.film
        axes.set_xlim(*film.span)
        axes.set_ylim(*panel.limits)
        axes.set_title(panel.label, fontsize=_TEXT, fontweight='normal', pad=4.0)
        axes.locator_params(axis='y', nbins=5)
        if film.ticks:
            axes.set_xticks(film.ticks)
        if lowest:
            axes.set_xlabel(film.across)
        else:
            axes.tick_params(axis='x', labelbottom=False)
        for start, end in panel.spans:
            axes.axvspan(start, end, color=panel.curves[0].colour, alpha=0.1, linewidth=0)
        for curve in panel.curves:
            axes.plot(curve.x, curve.y, color=curve.colour, linewidth=1.5)
        cursor = axes.axvline(film.span[0], color='#222222', linewidth=1.0, clip_on=False)
        self.cursors.append(cursor)
        self._animate(cursor)
        self.panels.append(axes)

    def _names(self, panel: Panel, x: float, y: float, width: float, height: float, high: float,
               wide: float) -> None:
        """Write the names of the curves beside them, each with its value."""
        axes = self.panels[-1]
        step = min(_ROW, high / len(panel.curves))
        size = 8.5 * min(1.0, step / (0.85 * _ROW))
        for k, curve in enumerate(panel.curves):
            row = y + (0.5 * high + (0.5 * (len(panel.curves) - 1) - k) * step) / height
            if curve.name:
                self.figure.add_artist(Line2D(
                    [x, x + 0.6 * _SWATCH / width], [row, row], color=curve.colour,
                    linewidth=2.5))
            self.figure.text(x + _SWATCH / width, row, curve.name, va='center', fontsize=size)
            dpi = self.figure.dpi
            place = (x * width + wide) * dpi, row * height * dpi
            self._values.append((panel, curve, place, size))
            dot, = axes.plot([], [], 'o', color=curve.colour, markersize=5.0, clip_on=False,
                             markeredgecolor='white', markeredgewidth=0.8)
            self.dots.append((curve, dot))
            self._animate(dot)

    def _animate(self, artist: Artist) -> None:
        artist.set_animated(True)
        self._moving.append(artist)


def _columns(points: Any) -> Array:
    return np.column_stack([np.real(points), np.imag(points)])


def _shape(axes: Axes, shape: Shape) -> Line2D | Polygon:
    points = shape.at(0)
    if shape.fill:
        area = Polygon(_columns(points), facecolor=shape.fill, edgecolor=shape.colour,
                       linewidth=shape.width)
        axes.add_patch(area)
        return area
    line, = axes.plot(
        points.real, points.imag, color=shape.colour, linewidth=0.0 if shape.joints else
        shape.width, linestyle=(0, (5, 3)) if shape.dashed else '-', solid_capstyle='butt')
    if shape.joints:
        line.set(marker='o', markersize=6.0, markerfacecolor='white', markeredgewidth=1.4)
    return line


def _quiver(axes: Axes, arrows: Arrows, feet: Any) -> Quiver:
    return axes.quiver(
        np.real(feet), np.imag(feet), np.real(feet), np.imag(feet), angles='xy',
        scale_units='xy', scale=1.0, color=arrows.colour, units='inches', width=0.02,
        headwidth=4.5, headlength=6.0, headaxislength=5.5, zorder=3, clip_on=False)


def _key(axes: Axes, arrows: Arrows, scale: float) -> None:
    """Draw an arrow of a round length in the lower right corner, and say what it is."""
    right, bottom = axes.get_xlim()[1], axes.get_ylim()[0]
    length = arrows.key * arrows.scale
    place = right - 0.1 * scale - length, bottom + 0.12 * scale
    key = _quiver(axes, arrows, np.array([complex(*place)]))
    key.set_UVC([length], [0.0])
    axes.annotate(f'{arrows.key:g} {arrows.unit}', (place[0] + length, place[1]),
                  xytext=(0.0, 9.0), textcoords='offset points', ha='right', va='center',
                  color=arrows.colour, fontsize=8.5)
