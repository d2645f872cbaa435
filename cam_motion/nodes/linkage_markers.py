# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A linkage as markers that RViz and Foxglove show: pieces, joints, names, velocities."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from builtin_interfaces.msg import Duration, Time
from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.outline import Outline
from cam_motion.motion.piece import Array
from cam_motion.runtime.ticks import NANOSECONDS
from geometry_msgs.msg import Point as Position
from geometry_msgs.msg import Pose as Placement
from geometry_msgs.msg import Quaternion, Vector3
import numpy as np
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

# Of the size of the linkage: widths of bars and slides, diameters of joints, height of letters.
_BAR, _SLIDE, _JOINT, _TEXT = 0.02, 0.008, 0.035, 0.06
_SHAFT, _HEAD = 0.014, 0.035  # diameters of arrows
_STILL = 1e-3  # length of an arrow, of the size of the linkage, below which none is drawn
_HELD = (0.80, 0.10, 0.10)
_JOINTS, _NAMES, _ARROWS, _SLIDES = (
    (0.15, 0.15, 0.15), (0.30, 0.30, 0.30), (0.84, 0.37, 0.0), (0.55, 0.55, 0.55))
# colours that people with any colour vision tell apart (Okabe, Ito)
_PIECES = ((0.35, 0.35, 0.35), (0.0, 0.45, 0.70), (0.0, 0.62, 0.45), (0.80, 0.47, 0.65),
           (0.90, 0.62, 0.0), (0.34, 0.71, 0.91))


class _Lines(NamedTuple):
    """A list of lines, and which ways lead to their ends."""

    marker: Marker
    ways: Array
    colour: tuple[float, float, float]


class LinkageMarkers:
    """
    Writes the markers of a linkage; namespaces and numbers stay the same for ever.

    Parameters
    ----------
    assembly : Assembly
        The linkage.
    outline : Outline
        Its pieces.
    frame_id : str
        Frame of the drawing; x and y are its plane.
    velocity_scale : float
        Length of an arrow per m/s [s]; 0 for none.
    lifetime : float
        How long the markers are shown unless they are renewed [s].

    """

    def __init__(self, assembly: Assembly, outline: Outline, frame_id: str,
                 velocity_scale: float, lifetime: float) -> None:
        """Make all messages once; only positions change."""
        self._equations = assembly.equations
        self._scale = velocity_scale
        linkage, size = assembly.linkage, self._equations.size
        self._still = _STILL * size
        self._frame_id = frame_id
        seconds, rest = divmod(round(lifetime * NANOSECONDS), NANOSECONDS)
        self._lifetime = Duration(sec=seconds, nanosec=rest)
        self._lines: list[_Lines] = []
        for k, piece in enumerate(outline.pieces):
            colour = _PIECES[k % len(_PIECES)] if k else _PIECES[0]
            for namespace, parts, width in (
                    ('links', piece.bars, _BAR), ('slides', piece.slides, _SLIDE)):
                if parts:
                    self._lines.append(_Lines(
                        self._marker(namespace, k, Marker.LINE_LIST, width * size),
                        np.array([way for part in parts
                                  for way in (part.where.tail, part.where.head)]),
                        colour if namespace == 'links' else _SLIDES))
        self._joints = [self._marker('joints', k, Marker.SPHERE, *[_JOINT * size] * 3)
                        for k, _ in enumerate(linkage.points)]
        self._names = [self._marker('names', k, Marker.TEXT_VIEW_FACING, 0.0, 0.0, _TEXT * size)
                       for k, _ in enumerate(linkage.points)]
        for text, point in zip(self._names, linkage.points):
            text.text = point.name
        self._arrows = [self._marker('velocities', k, Marker.ARROW, _SHAFT * size, _HEAD * size)
                        for k, _ in enumerate(linkage.points)] if velocity_scale else []
        _paint(self._joints, _JOINTS)
        _paint(self._names, _NAMES)
        _paint(self._arrows, _ARROWS)
        self._array = MarkerArray(markers=[
            *(each.marker for each in self._lines), *self._joints, *self._names, *self._arrows])
        self._lift = 0.5 * _JOINT * size  # names stand above the joints

    def _marker(self, namespace: str, number: int, kind: int, *scale: float) -> Marker:
        x, y, z = (*scale, 0.0, 0.0)[:3]
        marker = Marker(
            ns=namespace, id=number, type=kind, action=Marker.ADD, lifetime=self._lifetime,
            scale=Vector3(x=x, y=y, z=z),
            pose=Placement(orientation=Quaternion(w=1.0)))
        marker.header.frame_id = self._frame_id
        return marker

    def at(self, stamp_ns: int, values: Array, rates: Array, held: bool) -> MarkerArray:
        """
        Write the markers of a position.

        Parameters
        ----------
        stamp_ns : int
            When it was due, in the node's time [ns].
        values, rates : ndarray, shape (n,)
            The variables, inputs first [m, rad], and their rates [m/s, rad/s].
        held : bool
            Whether the linkage is held there because its inputs are out of range: it is red then.

        Returns
        -------
        MarkerArray
            The message, to be published before the next call.

        """
        vectors = self._equations.vectors(values)
        sec, nanosec = divmod(stamp_ns, NANOSECONDS)
        stamp = Time(sec=sec, nanosec=nanosec)
        for marker in self._array.markers:
            marker.header.stamp = stamp
        for lines in self._lines:
            lines.marker.points = _positions(lines.ways @ vectors)
            _paint([lines.marker], _HELD if held else lines.colour)
        places = self._equations.points @ vectors
        for joint, text, place in zip(self._joints, self._names, places.tolist()):
            joint.pose.position = Position(x=place.real, y=place.imag)
            text.pose.position = Position(x=place.real, y=place.imag, z=self._lift)
        velocities = self._equations.points @ (self._equations.slopes(values) @ rates)
        for arrow, foot, way in zip(self._arrows, places, (self._scale * velocities).tolist()):
            moves = abs(way) > self._still
            arrow.action = Marker.ADD if moves else Marker.DELETE
            arrow.points = _positions([foot, foot + way]) if moves else []
        return self._array


def _positions(places: Any) -> list[Position]:
    return [Position(x=float(place.real), y=float(place.imag)) for place in places]


def _paint(markers: Sequence[Marker], colour: tuple[float, float, float]) -> None:
    red, green, blue = colour
    for marker in markers:
        marker.color = ColorRGBA(r=red, g=green, b=blue, a=1.0)
