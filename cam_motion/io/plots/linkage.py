# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A linkage in motion: where it goes, and angles and velocities over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cam_motion.io.linkage_config import rate_name
from cam_motion.io.linkage_settings import LinkageCase, LinkageSettings
from cam_motion.io.plots.style import COLOURS, GREY, new_figure, styled
from cam_motion.mechanism.linkage_motion import LinkageMotion, sweep
from cam_motion.mechanism.loops import ComplexArray
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

NAME_AWAY = 11.0
"""Distance of a point's name from it [pt]."""

_MOMENTS = 181
_DRAWN = 5  # positions in the drawing
_ARROW = 0.22  # length of the longest arrow, of the drawing's height
_STILL = 1e-9  # share of the fastest point below which a speed is rounding
_DASHES = ('-', (0, (6, 3)), (0, (2, 2)), (0, (6, 2, 1, 2)), '-', (0, (6, 3)), (0, (2, 2)))


def linkage_figure(settings: LinkageSettings, case: LinkageCase) -> Figure:
    """
    Draw one motion of a linkage.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.
    case : LinkageCase
        The motion.

    Returns
    -------
    Figure
        Left the linkage from its first position (light) to its last (dark), the velocities of
        the points in the last as arrows [m]; right, over time [s], angles [deg], angular
        velocities [rad/s] and speeds of the points [m/s].

    """
    times = np.linspace(0.0, case.duration, _MOMENTS)
    motions = run_case(settings, case, times)
    linkage = settings.linkage
    angles = [name for name in linkage.unknowns if name in linkage.angles]
    points = moving_points(motions)
    with styled():
        figure = new_figure(6.6)
        grid = figure.add_gridspec(3, 2, width_ratios=(5, 6))
        drawing = figure.add_subplot(grid[:, 0])
        panels = [figure.add_subplot(grid[row, 1]) for row in range(3)]
        _draw(drawing, settings, [motions[k] for k in np.linspace(
            0, _MOMENTS - 1, _DRAWN).round().astype(int)])
        drawing.set_title(f'{settings.name}: {case.name}')
        _lines(panels[0], times, {
            name: np.unwrap([each.position[name] for each in motions]) / DEGREE
            for name in angles}, 'angle [deg]')
        _lines(panels[1], times, {
            rate_name(name): np.array([each.velocity[name] for each in motions])
            for name in angles},
            'angular velocity [rad/s]')
        _lines(panels[2], times, {
            name: np.array([abs(each.points[name].velocity) for each in motions])
            for name in points}, 'speed of points [m/s]')
        for panel in panels[:2]:
            panel.tick_params(axis='x', labelbottom=False)
        panels[0].set_title(_inputs_text(settings, case), fontsize=9.0)
        panels[2].set_xlabel('time [s]')
    return figure


def run_case(settings: LinkageSettings, case: LinkageCase, times: Array) -> list[LinkageMotion]:
    """
    Go through a motion at constant rates.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.
    case : LinkageCase
        The motion.
    times : ndarray, shape (n,)
        Times since its begin, rising [s].

    Returns
    -------
    list[LinkageMotion]
        The motion at each time.

    """
    start, rates = settings.assembly.start, case.inputs.rates
    inputs = {name: case.inputs.values.get(name, start[name]) + rates.get(name, 0.0) * times
              for name in settings.linkage.inputs}
    return sweep(settings.assembly, inputs, rates)


def moving_points(motions: Sequence[LinkageMotion]) -> list[str]:
    """
    List the points that move by more than rounding.

    Parameters
    ----------
    motions : Sequence[LinkageMotion]
        The motions.

    Returns
    -------
    list[str]
        Their names.

    """
    speeds = {name: max(abs(each.points[name].velocity) for each in motions)
              for name in motions[0].points}
    fastest = max(speeds.values(), default=0.0)
    return [name for name, speed in speeds.items() if speed > _STILL * fastest]


def away_from_middle(places: ComplexArray) -> ComplexArray:
    """
    Give the directions in which names hide least of a linkage: away from its middle.

    Parameters
    ----------
    places : ndarray of complex, shape (..., points)
        Where its points are.

    Returns
    -------
    ndarray of complex, shape (..., points)
        Unit vectors; up for a point in the middle.

    """
    ways = places - places.mean(axis=-1, keepdims=True)
    lengths = np.abs(ways)
    return np.where(lengths > 0.0, ways / np.where(lengths > 0.0, lengths, 1.0), 1j)


def _inputs_text(settings: LinkageSettings, case: LinkageCase) -> str:
    """Say from where to where the inputs go, and how fast."""
    start, said = settings.assembly.start, []
    for name in settings.linkage.inputs:
        turns = name in settings.linkage.angles
        factor, unit = (1.0 / DEGREE, 'deg') if turns else (1.0, 'm')
        begin = case.inputs.values.get(name, start[name])
        rate = case.inputs.rates.get(name, 0.0)
        text = f'{name} = {begin * factor:.4g} {unit}'
        if rate:
            text = (f'{name} from {begin * factor:.4g} to '
                    f'{(begin + rate * case.duration) * factor:.4g} {unit}, ')
            radius = settings.spools.get(name)
            text += f'{rate:.4g} {settings.linkage.unit(name)}/s' if radius is None else (
                f'crank {rate / radius:.4g} rad/s, spool radius {radius:g} m')
        said.append(text.replace('-', '−'))
    return '\n'.join(said)


def _lines(panel: Axes, times: Array, curves: Mapping[str, Array], label: str) -> None:
    # lines that coincide stay visible: each is thinner than the one below, and dashed otherwise
    for k, (name, values) in enumerate(curves.items()):
        panel.plot(times, values, color=COLOURS[k % len(COLOURS)], label=name,
                   linestyle=_DASHES[k % len(_DASHES)], linewidth=2.6 - 0.25 * min(k, 5))
    panel.set_ylabel(label)
    panel.margins(x=0.0)
    panel.legend(loc='center left', bbox_to_anchor=(1.0, 0.5), handlelength=2.6)


def _draw(axes: Axes, settings: LinkageSettings, motions: Sequence[LinkageMotion]) -> None:
    """Draw the ways to the points at some moments, and arrows at the last."""
    linkage = settings.linkage
    for k, motion in enumerate(motions):
        last = k == len(motions) - 1
        for point in linkage.points:
            if point.start:
                way = np.array([motion.points[name].position
                                for name in (point.start, point.name)])
                axes.plot(way.real, way.imag, color=COLOURS[0] if last else GREY,
                          alpha=1.0 if last else 0.18 + 0.12 * k, linewidth=2.2 if last else 1.2,
                          solid_capstyle='round')
    axes.set_aspect('equal', adjustable='datalim')
    axes.margins(0.12)
    places = {name: each.position for name, each in motions[-1].points.items()}
    axes.plot([z.real for z in places.values()], [z.imag for z in places.values()], 'o',
              color=COLOURS[0], markersize=4.5, markerfacecolor='white')
    ways = away_from_middle(np.array(list(places.values())))
    for (name, place), way in zip(places.items(), NAME_AWAY * ways):
        axes.annotate(name, (place.real, place.imag), xytext=(way.real, way.imag), ha='center',
                      va='center', textcoords='offset points', fontsize=8.5)
    everything = [each.position for motion in motions for each in motion.points.values()]
    height = max(float(np.ptp(np.real(everything))), float(np.ptp(np.imag(everything))))
    label = 'x [m]'
    if moving := moving_points(motions[-1:]):
        arrows = np.array([motions[-1].points[name].velocity for name in moving])
        fastest = float(np.abs(arrows).max())
        arrows *= _ARROW * height / fastest
        feet = np.array([places[name] for name in moving])
        axes.quiver(feet.real, feet.imag, arrows.real, arrows.imag, angles='xy',
                    scale_units='xy', scale=1.0, color=COLOURS[1], width=0.006, zorder=3)
        tips = feet + arrows
        axes.update_datalim(np.column_stack([tips.real, tips.imag]))
        axes.autoscale_view()
        label += f'\narrows: velocities, the longest {fastest:.3g} m/s'
    axes.set_xlabel(label)
    axes.set_ylabel('y [m]')
