# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Where the vectors of a linkage lie, and which of them are one rigid piece: what to draw."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.linkage import FRAME
from cam_motion.mechanism.loops import ComplexArray
from cam_motion.motion.piece import Array
import numpy as np

_SAME = 1e-9  # distance, of the size of the linkage, below which two places are one


class Place(NamedTuple):
    """
    A vector at its place in the linkage.

    Attributes
    ----------
    vector : str
        Name of the vector.
    tail, head : ndarray, shape (vectors,)
        How often the way from the origin to its ends passes each vector.

    """

    vector: str
    tail: Array
    head: Array


class Bar(NamedTuple):
    """
    A distance of fixed length on a piece, in coordinates of the piece, x + j y.

    Attributes
    ----------
    where : Place
        The vector at its place.
    start, end : complex
        Its ends [m].

    """

    where: Place
    start: complex
    end: complex


class Slide(NamedTuple):
    """
    A distance of variable length on a piece, in coordinates of the piece, x + j y.

    Attributes
    ----------
    name : str
        Name of the vector; with a number where the same one slides at several places.
    variable : str
        The variable that is its length.
    where : Place
        The vector at its place.
    start : complex
        The end that is fixed to the piece [m].
    along : complex
        Direction of the other end, a unit vector.
    marks : tuple[str, ...]
        Points at that other end which are fixed to no piece.

    """

    name: str
    variable: str
    where: Place
    start: complex
    along: complex
    marks: tuple[str, ...] = ()


class Mark(NamedTuple):
    """
    A named point that is fixed to a piece, in its coordinates, x + j y.

    Attributes
    ----------
    name : str
        Name of the point.
    place : complex
        Where it is [m].

    """

    name: str
    place: complex


@dataclass
class Piece:
    """
    What moves as one rigid body.

    Attributes
    ----------
    name : str
        Name of its body; with a number where several pieces turn by the angle of one body.
    body : str
        That body.
    angle : str
        The variable that is its angle; empty for the frame.
    origin : ndarray, shape (vectors,)
        Way to the origin of its coordinates, as in `Place`.
    place : complex
        Where that origin is at the start, x + j y [m].
    moves : bool
        Whether it moves.
    bars : list[Bar]
        Its distances of fixed length.
    slides : list[Slide]
        What slides on it.
    marks : list[Mark]
        The points that are fixed to it; each is a mark of one piece at most.

    """

    name: str
    body: str
    angle: str
    origin: Array
    place: complex
    moves: bool
    bars: list[Bar] = field(default_factory=list)
    slides: list[Slide] = field(default_factory=list)
    marks: list[Mark] = field(default_factory=list)


class Outline:
    """
    The rigid pieces of a linkage.

    Parameters
    ----------
    assembly : Assembly
        The linkage on its branch.

    Attributes
    ----------
    places : tuple[Place, ...]
        All vectors that the ways to the points and the loops pass, where they lie.
    pieces : tuple[Piece, ...]
        The frame first.

    """

    def __init__(self, assembly: Assembly) -> None:
        """Find the places, then what is rigid."""
        self._assembly = assembly
        self._equations = assembly.equations
        pose = assembly.start
        self._vectors = self._equations.vectors(pose.values)
        gain = np.concatenate([np.eye(len(assembly.linkage.inputs)), np.linalg.solve(
            *(sign * each for sign, each in zip((1.0, -1.0), assembly.jacobian(pose)[::-1])))])
        self._turning = {body.name: gain[assembly.linkage.variables.index(body.angle)]
                         for body in assembly.linkage.bodies}
        self._rates: ComplexArray = self._equations.slopes(pose.values) @ gain
        self.places = tuple(self._places())
        self.pieces = tuple(self._pieces())

    def _near(self, one: Array, other: Array) -> bool:
        return bool(abs((one - other) @ self._vectors) < _SAME * self._equations.size)

    def _places(self) -> Iterator[Place]:
        """Go along the ways to the points, then round the loops from what has been found."""
        linkage = self._assembly.linkage
        found: list[Place] = []

        def walk(path: Sequence[str], begin: Array) -> Iterator[Place]:
            here = begin
            for step in path:
                there = here + self._equations.along([step])
                ends = (there, here) if step.startswith('-') else (here, there)
                place = Place(step.removeprefix('-'), *ends)
                if not any(each.vector == place.vector and self._near(each.tail, place.tail)
                           for each in found):
                    found.append(place)
                    yield place
                here = there

        nowhere = np.zeros(len(linkage.vectors))
        chains = {'': nowhere, **{point.name: row for point, row in zip(
            linkage.points, self._equations.points)}}
        for point in linkage.points:
            yield from walk(point.path, chains[point.start])
        waiting = [loop.path for loop in linkage.loops]
        while waiting:
            for path in waiting:
                known = next(((k, each) for k, step in enumerate(path) for each in found
                              if each.vector == step.removeprefix('-')), None)
                if known is not None:
                    break
            waiting.remove(path)
            k, begin = 0, nowhere
            if known is not None:
                k, place = known
                begin = place.head if path[k].startswith('-') else place.tail
            yield from walk(path[k:] + path[:k], begin)

    def _pieces(self) -> Iterator[Piece]:
        linkage = self._assembly.linkage
        lengths = {vector.name: vector for vector in linkage.vectors}
        angles = {FRAME: '', **{body.name: body.angle for body in linkage.bodies}}
        nowhere = np.zeros(len(linkage.vectors))
        found = [Piece(FRAME, FRAME, '', nowhere, 0.0, False)]
        fixed = [each for each in self.places if not isinstance(
            lengths[each.vector].length, str)]
        for place in fixed:
            body = lengths[place.vector].body
            piece = self._piece_at(found, body, place.tail)
            if piece is None:
                count = sum(each.body == body for each in found)
                piece = Piece(f'{body}_{count + 1}' if count else body, body, angles[body],
                              place.tail, complex(place.tail @ self._vectors),
                              bool(np.abs(self._speed(place.tail)).max() > _SAME))
                found.append(piece)
            piece.bars.append(Bar(place, self._on(piece, place.tail),
                                  self._on(piece, place.head)))
        for place in self.places:
            vector = lengths[place.vector]
            if not isinstance(vector.length, str):
                continue
            along = complex(np.cos(vector.turn), np.sin(vector.turn))
            for end, direction in ((place.tail, along), (place.head, -along)):
                piece = self._piece_at(found, vector.body, end)
                if piece is not None:
                    count = sum(each.where.vector == vector.name
                                for other in found for each in other.slides)
                    piece.slides.append(Slide(
                        f'{vector.name}_{count + 1}' if count else vector.name, vector.length,
                        place, self._on(piece, end), direction))
                    break
        for point, way in zip(linkage.points, self._equations.points):
            for body in angles:
                piece = self._piece_at(found, body, way)
                if piece is not None:
                    piece.marks.append(Mark(point.name, self._on(piece, way)))
                    break
            else:
                self._mark_slide(found, point.name, way)
        yield from found

    def _mark_slide(self, pieces: list[Piece], point: str, way: Array) -> None:
        """Note a point that is where something slides on a piece."""
        for piece in pieces:
            for k, slide in enumerate(piece.slides):
                length = self._assembly.start[slide.variable]
                if abs(slide.start + length * slide.along - self._on(piece, way)) < (
                        _SAME * self._equations.size):
                    piece.slides[k] = slide._replace(marks=(*slide.marks, point))
                    return

    def _piece_at(self, pieces: list[Piece], body: str, end: Array) -> Piece | None:
        """Find the piece of a body to which a place is fixed."""
        turning = self._turning.get(body, np.zeros(1))
        for piece in pieces:
            arm = (end - piece.origin) @ self._vectors
            slip = self._speed(end) - self._speed(piece.origin) - 1j * turning * arm
            if piece.body == body and np.abs(slip).max() < _SAME * self._equations.size:
                return piece
        return None

    def _speed(self, way: Array) -> ComplexArray:
        """Give how a place moves with each input."""
        speed: ComplexArray = way @ self._rates
        return speed

    def _on(self, piece: Piece, way: Array) -> complex:
        """Give a place in the coordinates of a piece."""
        angle = self._assembly.start[piece.angle] if piece.angle else 0.0
        return complex((way - piece.origin) @ self._vectors * np.exp(-1j * angle))
