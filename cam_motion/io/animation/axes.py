# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The film of a timing diagram: the dial of the shaft, where every axis is, and their curves."""

from __future__ import annotations

from collections.abc import Sequence

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.animation.course import angle_ticks, Course
from cam_motion.io.animation.drawing import circle, Drawing, Label, Places, Shape, THIN
from cam_motion.io.animation.film import Curve, Film, Panel
from cam_motion.io.machine import Machine
from cam_motion.io.plots.style import COLOURS, GREY
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE, rate_text
import numpy as np

_RIM = 1.0  # radius of the dial, in whose unit the drawing is
_INNER = 0.4  # where its rings begin
_TRACK = '#D9D9D9'
_BAR = 1.25  # half of the length of the bars
_TOP_BAR = -1.62
_PITCH = 0.36  # of the bars
_BARS = 2.3  # what they have in height at most
_ARC = 2.0 * DEGREE  # of one side of an arc
_ROUNDING = 1e-9  # share of a cycle


def axes_film(machine: Machine, course: Course, only: str | None = None) -> Film:
    """
    Film axes on a shaft.

    Parameters
    ----------
    machine : Machine
        The machine.
    course : Course
        What it goes through.
    only : str, optional
        The axis to film alone, with velocity and acceleration; else the positions of all.

    Returns
    -------
    Film
        Left the dial of the shaft with a ring per axis, thick where that moves, and where each
        axis is between its ends; right the curves.

    Raises
    ------
    ConfigurationError
        When no axis was recorded.

    """
    names = list(course.axes) if only is None else [only]
    if not names:
        raise ConfigurationError([Problem(
            'BAG', None, 'no setpoint of any axis of its machine file was recorded',
            'record the whole line, or name another file with --config')])
    colours = {name: COLOURS[k % len(COLOURS)] for k, name in enumerate(course.axes)}
    units = {name: machine.diagram.axes[name].unit for name in names}
    if only is None:
        panels = [axis_panel(course, name, 0, f'{name} [{units[name]}]', colours[name])
                  for name in names]
    else:
        panels = [axis_panel(course, only, order, f'{word} [{rate_text(units[only], order)}]',
                             colours[only])
                  for order, word in enumerate(('position', 'velocity', 'acceleration'))]
    name = machine.master.name if only is None else only
    return Film(
        f'{name}: {course.title}', _drawing(course, names, units, colours), panels,
        course.across, course.cursor, course.captions, course.timing.fps, course.timing.note,
        course.ticks)


def axis_panel(course: Course, axis: str, order: int, label: str, colour: str = COLOURS[0],
               ) -> Panel:
    """
    Make the panel of an axis.

    Parameters
    ----------
    course : Course
        What it goes through.
    axis : str
        Its name.
    order : int
        0 for its position, 1 for its velocity, 2 for its acceleration.
    label : str
        What stands above.
    colour : str
        Colour of the curve.

    Returns
    -------
    Panel
        The panel, shaded where the axis moves in a cycle, if it ever stands.

    """
    x, y = course.curve(axis, order)
    spans = [(begin / DEGREE, end / DEGREE) for begin, end in course.moving(axis)]
    dwells = sum(end - begin for begin, end in spans) < (1.0 - _ROUNDING) * 360.0 * course.turns
    return Panel(label, [Curve('', x, y, course.timing.frames(course.axes[axis][order]), colour)],
                 spans if course.over_angle and dwells else ())


def _drawing(course: Course, names: Sequence[str], units: dict[str, str],
             colours: dict[str, str]) -> Drawing:
    phi = course.timing.frames(course.phi)
    shapes = [Shape(circle(_RIM), GREY, 1.2)]
    labels = []
    for angle in angle_ticks(course.turns)[:-1]:
        place = _on_dial(np.array([angle * DEGREE]), course.turns)[0]
        shapes.append(Shape(np.array([0.96 * place, 1.04 * place]), GREY, THIN))
        labels.append(Label(f'{angle:g}°', 1.17 * place, align='center'))
    step = (0.92 * _RIM - _INNER) / len(names)
    for k, name in enumerate(names):
        radius = 0.92 * _RIM - (k + 0.5) * step
        shapes.append(Shape(circle(radius), _TRACK, THIN))
        shapes += [
            Shape(radius * _on_dial(np.linspace(begin, end, 2 + int((end - begin) / _ARC)),
                                    course.turns), colours[name], 5.0)
            for begin, end in course.moving(name)]
    # over all rings, so that none hides it
    shapes += [Shape(np.array([0.0, 1.04j]), '#222222', 1.6, turn=-phi / course.turns),
               Shape(circle(0.06), '#222222', 1.0, '#222222', shift=np.zeros(len(phi), complex))]
    bars, words = _bars(course, names, units, colours)
    return Drawing([*shapes, *bars], labels=[*labels, *words], unit='')


def _bars(course: Course, names: Sequence[str], units: dict[str, str], colours: dict[str, str],
          ) -> tuple[list[Shape], list[Label]]:
    """Draw every axis as a slider between its ends, its name and position above."""
    shapes, labels = [], []
    pitch = min(_PITCH, _BARS / len(names))
    for k, name in enumerate(names):
        positions = course.timing.frames(course.axes[name][0])
        low, high, here = _within(course, name, positions)
        height = 1j * (_TOP_BAR - k * pitch)
        share = (here - low) / ((high - low) or 1.0)
        slider: Places = np.asarray(height + _BAR * (2.0 * share - 1.0), complex)
        shapes += [
            Shape(np.array([height - _BAR, height + _BAR]), _TRACK, 4.0),
            Shape(np.column_stack([np.full_like(slider, height - _BAR), slider]), colours[name],
                  4.0),
            Shape(slider[:, None], colours[name], joints=True)]
        panel = Panel('', [Curve('', positions, positions, positions, '')])
        above = height + 0.42j * pitch
        labels += [
            Label(name, above - _BAR),
            Label('', above + _BAR, align='right', texts=[
                f'{panel.text(value)} {units[name]}' for value in positions])]
    return shapes, labels


def _within(course: Course, axis: str, positions: Array) -> tuple[float, float, Array]:
    """Give the ends between which an axis is shown; one that goes on is shown cycle by cycle."""
    motion = course.motions[axis]
    begin, end = (motion.sample(turn)[0] for turn in (0.0, course.turns * 2.0 * np.pi))
    gain = end - begin
    values = course.axes[axis][0]
    if abs(gain) > _ROUNDING * max(float(np.ptp(values)), abs(end)):
        # at the end of a cycle all the way, not back at its begin
        cycles = np.ceil((positions - begin) / gain - _ROUNDING) - 1.0
        shown = positions - gain * np.maximum(cycles, 0.0)
        return min(begin, end), max(begin, end), shown
    return float(values.min()), float(values.max()), positions


def _on_dial(phi: Array, turns: int) -> Places:
    """Place angles on the dial: zero at the top, clockwise, one round for a whole cycle."""
    return np.asarray(1j * np.exp(-1j * phi / turns))
