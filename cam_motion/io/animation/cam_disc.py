# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The film of a disc cam that turns under its follower."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cam_motion.io.animation.axes import axis_panel
from cam_motion.io.animation.course import Course
from cam_motion.io.animation.drawing import Arrows, circle, Drawing, Label, Shape, THIN
from cam_motion.io.animation.film import Curve, Film, Panel
from cam_motion.io.plots.style import COLOURS, GREY
from cam_motion.mechanism.cam_pose import follower_pose, FollowerPose
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE, rate_text, TURN
import numpy as np

if TYPE_CHECKING:
    from cam_motion.io.cam_disc_config import CamDiscSettings

_BESIDE = 9.0  # where the pressure angle stands [pt]
_SIDES = 720  # of the contour
_NORMAL = 0.7  # length of the contact normal, of the base radius
_METAL = '#DCE6EE'
_STEEL = '#F4F4F4'
_STEM = '#A9A9A9'


def cam_disc_film(settings: CamDiscSettings, course: Course) -> Film:
    """
    Film a disc cam.

    Parameters
    ----------
    settings : CamDiscSettings
        The disc with its follower.
    course : Course
        What its machine goes through.

    Returns
    -------
    Film
        Left the disc turning under its follower, with the common normal at the contact; right
        displacement, velocity, acceleration and pressure angle.

    """
    disc, axis, timing = settings.disc, settings.axis, course.timing
    words = ('angle', 'angular velocity', 'angular acceleration') if disc.unit == 'rad' else (
        'displacement', 'velocity', 'acceleration')
    panels = [axis_panel(course, axis, order, f'{word} [{rate_text(disc.unit, order)}]',
                         COLOURS[order]) for order, word in enumerate(words)]
    x, _ = course.curve(axis, 1)
    pressure = disc.pressure_angle(x * DEGREE if course.over_angle else course.phi) / DEGREE
    phi = timing.frames(course.phi)
    panels.append(Panel('pressure angle [deg]', [Curve(
        '', x, pressure, disc.pressure_angle(phi) / DEGREE, COLOURS[3])], panels[0].spans))
    return Film(f'{settings.name}: {course.title}', _drawing(settings, phi), panels, course.across,
                course.cursor, course.captions, timing.fps, timing.note, course.ticks)


def _drawing(settings: CamDiscSettings, phi: Array) -> Drawing:
    disc = settings.disc
    turn, base, radius = disc.sense * phi, disc.base_radius, disc.follower.roller_radius
    bore = 0.3 * base if settings.bore_radius is None else settings.bore_radius
    normal = disc.contact(phi).normal
    poses = [follower_pose(disc, angle) for angle in phi]
    around = np.linspace(0.0, TURN, _SIDES + 1)
    shapes = []
    if settings.groove:
        flank = disc.outer_flank(around)
        rim = float(np.abs(flank).max()) + 2.0 * radius
        shapes = [Shape(circle(rim), COLOURS[0], 1.2, _METAL, turn=turn),
                  Shape(flank, COLOURS[0], 2.0, '#FFFFFF', turn=turn)]
    shapes += [
        Shape(disc.contour(around), COLOURS[0], 2.0, _METAL, turn=turn),
        Shape(disc.pitch(around), GREY, THIN, dashed=True, turn=turn),
        # still, but on the disc
        Shape(circle(base), GREY, THIN, dashed=True, shift=np.zeros(len(phi), complex)),
        # what shows that it turns: the key of its shaft
        Shape(circle(bore), COLOURS[0], 1.2, '#FFFFFF', turn=turn),
        Shape(np.array([0.7 * bore, 1.3 * bore], dtype=complex), COLOURS[0], 5.0, turn=turn),
        *_follower(poses, radius)]
    contact = np.array([[pose.contact] for pose in poses])
    arrows = Arrows(['common normal'], contact, normal[:, None], _NORMAL * base,
                    colour=COLOURS[1])
    label = Label('', contact[:, 0] + _NORMAL * base * normal, _BESIDE, colour=COLOURS[1],
                  texts=[f'{angle:.1f}°'.replace('-', '−')
                         for angle in disc.pressure_angle(phi) / DEGREE])
    return Drawing(shapes, [arrows], [label])


def _follower(poses: list[FollowerPose], radius: float) -> list[Shape]:
    """Draw roller or face, the stem or arm to it, and what guides it."""
    first, frames = poses[0], len(poses)
    centres = np.array([pose.centre for pose in poses])
    feet = np.array([pose.foot for pose in poses])
    shapes = [Shape(np.column_stack([centres, feet]), _STEM, 6.0)]
    if first.pivot is None:
        side = 0.35 * max(radius, 0.3 * abs(first.foot - first.centre))
        top = feet[np.argmin(feet.imag)]  # of the stem at its lowest: it never leaves the guide
        length = 0.25 * abs(first.foot - first.centre)
        shapes += [Shape(top + sign * side - 1j * np.array([0.0, length]), GREY, 3.0)
                   for sign in (-1.0, 1.0)]
    else:
        shapes.append(Shape(np.full((1, 1), first.pivot).repeat(frames, axis=0), '#444444',
                            joints=True))
    if first.face is not None:
        shapes.append(Shape(np.array([pose.face for pose in poses]), '#444444', 4.0))
    else:
        shapes += [Shape(circle(radius), '#444444', 1.8, _STEEL, shift=centres),
                   Shape(centres[:, None], '#444444', joints=True)]
    return shapes
