# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
A linkage as URDF, for robot_state_publisher and whoever shows its frames.

A URDF is a tree, and a linkage is not. Every piece therefore hangs on the frame itself: it slides
along x and y with its origin, where that moves, and turns by its own angle. All these joints are
among the published joint states, so that nothing is left to be solved by whoever shows it, and a
frame stands at every named point.
"""

from __future__ import annotations

from collections.abc import Sequence
import math
from xml.etree import ElementTree as Xml

from cam_motion.io.linkage_settings import LinkageSettings
from cam_motion.mechanism.joints import origin_joints, repeated_joints
from cam_motion.mechanism.outline import Outline, Piece

# Of the size of the linkage: thickness of bars, diameter of joints, length of sliding blocks.
_BAR, _JOINT, _BLOCK = 0.02, 0.035, 0.06
_FAR = 100.0  # of that size: an input that no loop holds back
_EFFORT, _VELOCITY = 1e6, 1e3  # N and m/s that no slide has: URDF asks for some
_ROUNDING = 12  # decimals [m]: what is left is rounding
_COLOURS = ('0.35 0.35 0.35 1', '0 0.45 0.7 1', '0 0.62 0.45 1', '0.8 0.47 0.65 1',
            '0.9 0.62 0 1', '0.34 0.71 0.91 1')
_DARK = '0.15 0.15 0.15 1'


def linkage_urdf(settings: LinkageSettings) -> str:
    """
    Describe a linkage as URDF.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.

    Returns
    -------
    str
        The XML: its root is the link ``frame_id``, its joints bear the names of the published
        joint states, and each piece, slide and point is a link of its own name. Limits of slides
        are the ranges of inputs, with the other inputs at the start, and else how far all lengths
        reach together.

    """
    return _Robot(settings).text


class _Robot:
    """Writes the tree."""

    def __init__(self, settings: LinkageSettings) -> None:
        outline = Outline(settings.assembly)
        assembly = settings.assembly
        self._size = assembly.equations.size
        self._ranges = {name: assembly.range_of(name) for name in assembly.linkage.inputs
                        if name not in assembly.linkage.angles}
        # nothing is farther away than all lengths together, each at its longest; an unknown one is
        # no longer than all others of its loop
        lengths = [vector.length for vector in assembly.linkage.vectors]
        known = sum(each if not isinstance(each, str) else self._longest(each)
                    for each in lengths if each not in assembly.linkage.unknowns)
        self._reach = known * (1 + sum(each in assembly.linkage.unknowns for each in lengths))
        self._repeated = repeated_joints(outline)
        self._robot = Xml.Element('robot', name=settings.name)
        root = settings.values['frame_id']
        for k, piece in enumerate(outline.pieces):
            self._piece(piece, root, _COLOURS[k % len(_COLOURS)])
        Xml.indent(self._robot)
        self.text = ('<?xml version="1.0"?>\n' + Xml.tostring(self._robot, encoding='unicode')
                     + '\n')

    def _longest(self, variable: str) -> float:
        found = self._ranges[variable]
        return max((abs(end) for end in (found.low, found.high) if math.isfinite(end)),
                   default=_FAR * self._size)

    def _bounds(self, variable: str) -> tuple[float, float]:
        found = self._ranges.get(variable)
        low, high = (found.low, found.high) if found else (-math.inf, math.inf)
        return max(low, -self._reach), min(high, self._reach)

    def _piece(self, piece: Piece, root: str, colour: str) -> None:
        link = self._hang(piece, root) if piece.angle else self._link(root)
        name = link.get('name', '')
        for bar in piece.bars:
            way = bar.end - bar.start
            self._visual(link, 'box', 0.5 * (bar.start + bar.end), math.atan2(way.imag, way.real),
                         (abs(way), _BAR * self._size, _BAR * self._size), colour, name)
        for mark in piece.marks:
            self._link_at(name, mark.name, mark.place)
            self._visual(link, 'sphere', mark.place, 0.0, (0.5 * _JOINT * self._size,), _DARK,
                         'joints')
        for slide in piece.slides:
            block = self._link(slide.name)
            angle = math.atan2(slide.along.imag, slide.along.real)
            self._visual(block, 'box', 0.0, angle, tuple(
                share * self._size for share in (_BLOCK, _JOINT, _JOINT)), _COLOURS[0], 'slides')
            self._joint(self._joint_of(slide.name, slide.variable), 'prismatic', name, slide.name,
                        slide.start, slide.along, slide.variable)
            for point in slide.marks:
                self._link_at(slide.name, point, 0.0)

    def _hang(self, piece: Piece, root: str) -> Xml.Element:
        """Hang a piece on the frame by the joints that move it."""
        parent, place = root, piece.place
        if piece.moves:
            place = 0.0
            for joint, along in zip(origin_joints(piece), (1.0, 1j)):
                self._link(f'{joint}_carriage')
                self._joint(joint, 'prismatic', parent, f'{joint}_carriage', 0.0, along)
                parent = f'{joint}_carriage'
        link = self._link(piece.name)
        self._joint(self._joint_of(piece.name, piece.angle), 'continuous', parent, piece.name,
                    place)
        return link

    def _joint_of(self, name: str, variable: str) -> str:
        return self._repeated[name].name if name in self._repeated else variable

    def _link(self, name: str) -> Xml.Element:
        return Xml.SubElement(self._robot, 'link', name=name)

    def _link_at(self, parent: str, name: str, place: complex) -> None:
        self._link(name)
        self._joint(f'{name}_fixed', 'fixed', parent, name, place)

    def _joint(self, name: str, kind: str, parent: str, child: str, place: complex,
               along: complex | None = None, variable: str = '') -> None:
        joint = Xml.SubElement(self._robot, 'joint', name=name, type=kind)
        Xml.SubElement(joint, 'origin', xyz=_numbers((place.real, place.imag, 0.0)), rpy='0 0 0')
        Xml.SubElement(joint, 'parent', link=parent)
        Xml.SubElement(joint, 'child', link=child)
        if kind == 'continuous':
            Xml.SubElement(joint, 'axis', xyz='0 0 1')
        if along is not None:
            Xml.SubElement(joint, 'axis', xyz=_numbers((along.real, along.imag, 0.0)))
            low, high = self._bounds(variable)
            Xml.SubElement(joint, 'limit', lower=_numbers((low,)), upper=_numbers((high,)),
                           effort=_numbers((_EFFORT,)), velocity=_numbers((_VELOCITY,)))

    def _visual(self, link: Xml.Element, shape: str, place: complex, angle: float,
                size: Sequence[float], colour: str, material: str) -> None:
        visual = Xml.SubElement(link, 'visual')
        Xml.SubElement(visual, 'origin', xyz=_numbers((place.real, place.imag, 0.0)),
                       rpy=_numbers((0.0, 0.0, angle)))
        key = 'size' if shape == 'box' else 'radius'
        Xml.SubElement(Xml.SubElement(visual, 'geometry'), shape, {key: _numbers(size)})
        paint = Xml.SubElement(visual, 'material', name=material)
        Xml.SubElement(paint, 'color', rgba=colour)


def _numbers(values: Sequence[float]) -> str:
    """Write numbers exactly but for rounding, without a minus before zero."""
    return ' '.join(repr(round(value, _ROUNDING) + 0.0) for value in values)
