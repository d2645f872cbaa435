# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The film of a linkage: its bodies with velocity arrows, and its angles and velocities."""

from __future__ import annotations

from collections.abc import Sequence

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.animation.course import Course
from cam_motion.io.animation.drawing import Arrows, Drawing, Label, Places, Shape, THIN, TRACE
from cam_motion.io.animation.film import Curve, Film, Panel
from cam_motion.io.animation.pace import Pace, pace, Wishes
from cam_motion.io.linkage_config import rate_name
from cam_motion.io.linkage_settings import LinkageCase, LinkageSettings
from cam_motion.io.plots.linkage import away_from_middle, moving_points, NAME_AWAY, run_case
from cam_motion.io.plots.style import COLOURS
from cam_motion.mechanism.linkage_motion import LinkageMotion, sweep
from cam_motion.mechanism.pose import whole_turns
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE
import numpy as np

_ARROW = 0.2  # length of the longest arrow, of the drawing's larger side


def case_film(settings: LinkageSettings, case: LinkageCase, wishes: Wishes) -> Film:
    """
    Film a motion of a linkage at constant rates.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.
    case : LinkageCase
        The motion.
    wishes : Wishes
        How fast it shall go.

    Returns
    -------
    Film
        The film.

    """
    timing = pace(wishes, case.duration)
    motions = run_case(settings, case, timing.times)
    captions = [f't = {time:.2f} s' for time in timing.frames(timing.times)]
    return _film(settings, f'{settings.name}: {case.name}', motions, timing, timing.times,
                 'time [s]', captions)


def driven_film(settings: LinkageSettings, course: Course) -> Film:
    """
    Film a linkage that axes of a machine drive.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.
    course : Course
        What the machine goes through.

    Returns
    -------
    Film
        The film.

    Raises
    ------
    ConfigurationError
        When an axis that drives it was not recorded, or takes it out of its range.
    SingularError
        When a singular position is in the way.

    """
    assembly = settings.assembly
    inputs = _driven(settings, course)
    for name, each in inputs.items():
        if name in assembly.linkage.angles:  # a run counts turns that the start knows nothing of
            each[0] -= whole_turns(assembly.linkage, name, each[0, 0] - assembly.start[name],
                                   assembly.range_of(name))
    motions = sweep(assembly, {name: each[0] for name, each in inputs.items()},
                    {name: each[1] for name, each in inputs.items()})
    return _film(settings, f'{settings.name}: {course.title}', motions, course.timing, course.x,
                 course.across, course.captions, course.ticks)


def _driven(settings: LinkageSettings, course: Course) -> dict[str, Array]:
    """Give position and velocity of the inputs: as the axes say, else as the linkage told."""
    missing = [Problem(f'{settings.name}.{name}.axis', drive.axis, 'was not recorded',
                       'record all axes that drive the linkage, or its joint states')
               for name, drive in settings.drives.items() if drive.axis not in course.axes]
    if not missing:
        return {name: drive.factor * course.axes[drive.axis][:2] + [[drive.offset], [0.0]]
                for name, drive in settings.drives.items()}
    told = course.linkages.get(settings.name, {})
    if not set(settings.linkage.inputs) <= set(told):
        raise ConfigurationError(missing)
    return {name: told[name].copy() for name in settings.linkage.inputs}


def _film(settings: LinkageSettings, title: str, motions: Sequence[LinkageMotion], timing: Pace,
          x: Array, across: str, captions: Sequence[str], ticks: Sequence[float] = ()) -> Film:
    """Film motions, one for each point of the curves."""
    linkage = settings.linkage
    angles = [name for name in linkage.variables if name in linkage.angles]
    lengths = [name for name in linkage.variables if name not in linkage.angles]
    points = moving_points(motions)

    def panel(label: str, curves: dict[str, Array]) -> Panel:
        return Panel(label, [
            Curve(name, x, values, timing.frames(values), COLOURS[k % len(COLOURS)])
            for k, (name, values) in enumerate(curves.items())])

    def rates(names: Sequence[str]) -> dict[str, Array]:
        return {rate_name(name) if name in linkage.angles else f'{name}_dot':
                np.array([each.velocity[name] for each in motions]) for name in names}

    panels = [
        panel('angle [deg]', {name: np.unwrap([each.position[name] for each in motions]) / DEGREE
                              for name in angles}),
        panel('angular velocity [rad/s]', rates(angles)),
        panel('speed of points [m/s]', {name: np.array([
            abs(each.points[name].velocity) for each in motions]) for name in points}),
        panel('length [m]', {name: np.array([each.position[name] for each in motions])
                             for name in lengths}),
    ]
    shown = motions[::timing.stride][:timing.count]
    return Film(
        title, _drawing(settings, motions, shown, points),
        [each for each in panels if each.curves], across, timing.frames(x),
        [f'{caption}   {_inputs(settings, motion)}' for caption, motion in zip(captions, shown)],
        timing.fps, timing.note, ticks)


def _inputs(settings: LinkageSettings, motion: LinkageMotion) -> str:
    """Say where the inputs are."""
    linkage = settings.linkage
    return '   '.join(
        f'{name} = {motion.position[name] / DEGREE:.1f}°' if name in linkage.angles else
        f'{name} = {motion.position[name]:.3f} m' for name in linkage.inputs).replace('-', '−')


def _drawing(settings: LinkageSettings, motions: Sequence[LinkageMotion],
             shown: Sequence[LinkageMotion], moving: Sequence[str]) -> Drawing:
    linkage = settings.linkage
    names = [point.name for point in linkage.points]

    def ways(of: Sequence[LinkageMotion], which: Sequence[str]) -> Places:
        return np.array([[each.points[name].position for name in which] for each in of])

    places = ways(shown, names)
    everything = ways(motions, names)
    size = max(float(np.ptp(everything.real)), float(np.ptp(everything.imag)))
    traces = [Shape(way, TRACE, THIN) for way in ways(motions, moving).T]
    bodies = [Shape(places[:, [names.index(point.start), names.index(point.name)]], width=3.0)
              for point in linkage.points if point.start]
    arrows = []
    if moving:
        velocities = np.array([[each.points[name].velocity for name in moving]
                               for each in shown])
        fastest = max(abs(each.points[name].velocity) for each in motions for name in moving)
        arrows = [Arrows(moving, ways(shown, moving), velocities, _ARROW * size / fastest,
                         'm/s')]
    labels = [Label(name, way, away, align='center')
              for name, way, away in zip(names, places.T, NAME_AWAY * away_from_middle(places).T)]
    return Drawing([*traces, *bodies, Shape(places, joints=True)], arrows, labels)
