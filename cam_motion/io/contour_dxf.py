# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The contour of a cam disc as a drawing for CAD and CAM, in DXF, units mm."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple, TYPE_CHECKING

from cam_motion.errors import CamMotionError, ConfigurationError
from cam_motion.io.cam_disc_config import CamDiscSettings
from cam_motion.io.contour import bore_problems
from cam_motion.mechanism.cam_follower import Points
from cam_motion.mechanism.cam_outline import CubicSpline, Outline, outline, spline
from cam_motion.mechanism.cam_pose import follower_pose
from cam_motion.units import MM

if TYPE_CHECKING:
    from ezdxf.layouts.layout import Modelspace

_RELEASE = 'R2010'
_LAYERS = {  # name: AutoCAD colour, line type
    'CONTOUR_POLYLINE': (1, 'CONTINUOUS'), 'CONTOUR_SPLINE': (5, 'CONTINUOUS'),
    'OUTER_FLANK_POLYLINE': (1, 'CONTINUOUS'), 'OUTER_FLANK_SPLINE': (5, 'CONTINUOUS'),
    'PITCH_CURVE': (8, 'DASHDOT'), 'BASE_CIRCLE': (8, 'DASHED'), 'BORE': (7, 'CONTINUOUS'),
    'FOLLOWER': (3, 'CONTINUOUS'), 'CENTRE': (8, 'DASHDOT'),
}
_CROSS = 1.15  # length of the lines through the shaft, by the radius of the disc


class Drawing(NamedTuple):
    """What was drawn: the contour as polyline and as spline, and the other flank of a groove."""

    polyline: Outline
    spline: CubicSpline
    outer_polyline: Outline | None
    outer_spline: CubicSpline | None

    @property
    def deviation(self) -> float:
        """Give the largest distance of anything drawn from the exact curve [m]."""
        return max(each.deviation for each in self if each is not None)


def write_dxf(settings: CamDiscSettings, path: Path, tolerance: float | None = None,
              at: float = 0.0) -> Drawing:
    """
    Draw the disc as it is at shaft angle 0, with its follower where it is at another angle.

    Parameters
    ----------
    settings : CamDiscSettings
        The disc.
    path : Path
        The file; its directory is made.
    tolerance : float | None
        Largest distance of polyline and spline from the contour [m]; None takes that of the disc.
    at : float
        Shaft angle at which the follower is drawn, turned back onto the disc [rad].

    Returns
    -------
    Drawing
        The curves with their largest distances from the exact ones.

    Raises
    ------
    ConfigurationError
        When the contour is undercut, or the bore does not fit into it.
    CamMotionError
        When the file cannot be written.

    Notes
    -----
    Each curve has a layer of its own, so that whoever reads the drawing takes what he needs: the
    polyline (LWPOLYLINE) or the cubic spline (SPLINE).

    """
    from ezdxf import units
    from ezdxf.filemanagement import new
    disc = settings.disc
    tolerance = settings.tolerance if tolerance is None else tolerance
    if problems := bore_problems(settings):
        raise ConfigurationError(problems)
    outer = 2.0 * disc.follower.roller_radius if settings.groove else None
    drawing = Drawing(outline(disc, tolerance), spline(disc, tolerance),
                      None if outer is None else outline(disc, tolerance, outer),
                      None if outer is None else spline(disc, tolerance, outer))
    document = new(_RELEASE, setup=['linetypes'])
    document.units = units.MM
    document.header['$MEASUREMENT'] = 1
    document.header.custom_vars.append('cam_motion disc', settings.name)
    document.header.custom_vars.append('largest deviation [mm]', f'{drawing.deviation / MM:.9g}')
    for name, (colour, kind) in _LAYERS.items():
        document.layers.add(name, color=colour, linetype=kind)
    space = document.modelspace()
    _draw_curve(space, 'CONTOUR', drawing.polyline, drawing.spline)
    if drawing.outer_polyline is not None and drawing.outer_spline is not None:
        _draw_curve(space, 'OUTER_FLANK', drawing.outer_polyline, drawing.outer_spline)
    if disc.follower.roller_radius > 0.0:
        _draw_spline(space, 'PITCH_CURVE', spline(
            disc, tolerance, disc.follower.roller_radius))
    space.add_circle((0.0, 0.0), disc.base_radius / MM, dxfattribs={'layer': 'BASE_CIRCLE'})
    _draw_centre(space, _CROSS * disc.farthest / MM)
    _draw_bore(space, settings)
    _draw_follower(space, settings, at)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        document.saveas(path)
    except OSError as error:
        raise CamMotionError(f'{path}: cannot be written: {error.strerror or error}') from error
    return drawing


def _points(points: Points) -> list[tuple[float, float]]:
    return [(float(z.real) / MM, float(z.imag) / MM) for z in points]


def _draw_curve(space: Modelspace, layer: str, polyline: Outline, curve: CubicSpline) -> None:
    space.add_lwpolyline(_points(polyline.points[:-1]), close=True,
                         dxfattribs={'layer': f'{layer}_POLYLINE'})
    _draw_spline(space, f'{layer}_SPLINE', curve)


def _draw_spline(space: Modelspace, layer: str, curve: CubicSpline) -> None:
    space.add_open_spline(_points(curve.control_points), degree=3, knots=curve.knots.tolist(),
                          dxfattribs={'layer': layer})


def _draw_centre(space: Modelspace, reach: float) -> None:
    attributes = {'layer': 'CENTRE'}
    space.add_line((-reach, 0.0), (reach, 0.0), dxfattribs=attributes)
    space.add_line((0.0, -reach), (0.0, reach), dxfattribs=attributes)


def _draw_bore(space: Modelspace, settings: CamDiscSettings) -> None:
    """Draw the bore; with a keyway, as one closed line of an arc and the three sides."""
    bore, key = settings.bore_radius, settings.keyway
    attributes: dict[str, Any] = {'layer': 'BORE'}
    if bore is None:
        return
    if key is None:
        space.add_circle((0.0, 0.0), bore / MM, dxfattribs=attributes)
        return
    half = 0.5 * key.width
    away = math.asin(half / bore)
    corners = ((bore * math.cos(away), half), (bore * math.cos(away), -half),
               (bore + key.depth, -half), (bore + key.depth, half))
    # from the upper corner counterclockwise round the shaft to the lower one
    bulge = math.tan(0.25 * (math.tau - 2.0 * away))
    cos, sin = math.cos(key.angle), math.sin(key.angle)
    space.add_lwpolyline(
        [((x * cos - y * sin) / MM, (x * sin + y * cos) / MM, bulge if k == 0 else 0.0)
         for k, (x, y) in enumerate(corners)],
        format='xyb', close=True, dxfattribs=attributes)


def _draw_follower(space: Modelspace, settings: CamDiscSettings, at: float) -> None:
    """Draw the follower where it is at a shaft angle, turned back onto the disc."""
    disc = settings.disc
    pose = follower_pose(disc, at)
    attributes = {'layer': 'FOLLOWER'}

    def place(point: complex) -> tuple[float, float]:
        return _points(disc.on_disc([point], [at]))[0]

    if pose.roller_radius:
        space.add_circle(place(pose.centre), pose.roller_radius / MM, dxfattribs=attributes)
    if pose.face is not None:
        space.add_line(place(pose.face[0]), place(pose.face[1]), dxfattribs=attributes)
    if pose.face is None or pose.pivot is None:
        space.add_line(place(pose.centre), place(pose.foot), dxfattribs=attributes)
    else:
        space.add_line(place(pose.face[0]), place(pose.foot), dxfattribs=attributes)
    space.add_point(place(pose.contact), dxfattribs=attributes)
