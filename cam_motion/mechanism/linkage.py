# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A planar linkage as data: bodies, vectors, loops, points, given and unknown variables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
import math

from cam_motion.errors import ConfigurationError, Problem

FRAME = 'frame'
"""Name of the body that never moves; its angle is 0."""


@dataclass(frozen=True)
class Body:
    """
    A rigid body that turns.

    Attributes
    ----------
    name : str
        Its name.
    angle : str
        The variable that is its angle.

    """

    name: str
    angle: str


@dataclass(frozen=True)
class Vector:
    """
    A distance on a body, from one joint to another: length · e^(j (angle of the body + turn)).

    Attributes
    ----------
    name : str
        Its name.
    length : float | str
        Its length [m], or the variable that is its length, for a slide.
    body : str
        The body that it turns with.
    turn : float
        Its direction on the body [rad].

    """

    name: str
    length: float | str
    body: str = FRAME
    turn: float = 0.0


@dataclass(frozen=True)
class Loop:
    """
    A closed way through the linkage: its vectors sum to zero.

    Attributes
    ----------
    name : str
        Its name.
    path : tuple[str, ...]
        Names of vectors; one that is passed backwards has a ``-`` before its name.

    """

    name: str
    path: tuple[str, ...]


@dataclass(frozen=True)
class Point:
    """
    A point, reached along vectors.

    Attributes
    ----------
    name : str
        Its name.
    path : tuple[str, ...]
        Names of vectors, as in a loop.
    start : str
        The point where the way begins, described before this one; empty for the origin.

    """

    name: str
    path: tuple[str, ...] = ()
    start: str = ''


@dataclass(frozen=True)
class Transmission:
    """
    Two directions whose angle tells how well a force is passed on.

    Attributes
    ----------
    name : str
        Its name.
    first, second : tuple[str, ...]
        Names of vectors, as in a loop; each sum is one of the two directions.

    """

    name: str
    first: tuple[str, ...]
    second: tuple[str, ...]


@dataclass(frozen=True)
class Linkage:
    """
    A planar linkage, whole and sound.

    Attributes
    ----------
    name : str
        Its name.
    bodies, vectors, loops, points : tuple[Body, ...] and so on
        Its parts.
    inputs, unknowns : tuple[str, ...]
        Variables that are given, and those that the loops determine: two for each loop.
    start : Mapping[str, float]
        An assembly [m, rad] that names the branch: inputs exactly, unknowns roughly.
    transmissions : tuple[Transmission, ...]
        Where the transmission angle is of interest.

    Raises
    ------
    ConfigurationError
        With every problem; paths are the names of the parts.

    """

    name: str
    bodies: tuple[Body, ...]
    vectors: tuple[Vector, ...]
    loops: tuple[Loop, ...]
    points: tuple[Point, ...]
    inputs: tuple[str, ...]
    unknowns: tuple[str, ...]
    start: Mapping[str, float]
    transmissions: tuple[Transmission, ...] = ()

    def __post_init__(self) -> None:
        """Refuse what is no linkage."""
        problems = [*self._name_problems(), *self._vector_problems(), *self._use_problems(),
                    *self._path_problems(), *self._start_problems()]
        problems = problems or [*self._balance_problems()]
        if problems:
            raise ConfigurationError(problems)

    @property
    def variables(self) -> tuple[str, ...]:
        """List all variables, the inputs first."""
        return self.inputs + self.unknowns

    @property
    def angles(self) -> frozenset[str]:
        """Give the variables that are angles; all others are lengths."""
        return frozenset(body.angle for body in self.bodies)

    def unit(self, variable: str) -> str:
        """
        Give the unit of a variable.

        Parameters
        ----------
        variable : str
            Its name.

        Returns
        -------
        str
            ``rad`` or ``m``.

        """
        return 'rad' if variable in self.angles else 'm'

    def _name_problems(self) -> Iterator[Problem]:
        parts: tuple[tuple[str, Iterable[str]], ...] = (
            ('inputs', self.inputs), ('unknowns', self.unknowns),
            ('bodies', (each.name for each in self.bodies)),
            ('vectors', (each.name for each in self.vectors)),
            ('loops', (each.name for each in self.loops)),
            ('points', (each.name for each in self.points)),
            ('transmissions', (each.name for each in self.transmissions)))
        seen = {FRAME: 'bodies'}
        for kind, names in parts:
            for name in names:
                if name in seen:
                    yield Problem(kind, name, 'every part has a name of its own',
                                  f'it stands in {seen[name]} already')
                elif not name or name.startswith('-') or '.' in name:
                    yield Problem(kind, name, 'a name has no dot and no minus before it')
                seen.setdefault(name, kind)
        for kind, many in (('inputs', self.inputs), ('loops', self.loops)):
            if not many:
                yield Problem(kind, [], 'a linkage needs at least one')

    def _vector_problems(self) -> Iterator[Problem]:
        known = ', '.join([FRAME, *(body.name for body in self.bodies)])
        for vector in self.vectors:
            if vector.body != FRAME and not any(b.name == vector.body for b in self.bodies):
                yield Problem(f'{vector.name}.body', vector.body, 'must name a body',
                              'known are: ' + known)
            if not isinstance(vector.length, str) and not (
                    math.isfinite(vector.length) and vector.length > 0.0):
                yield Problem(f'{vector.name}.length', vector.length,
                              'must be a finite number above 0 [m]',
                              'turn the vector by 180 deg to point it backwards')
            if not math.isfinite(vector.turn):
                yield Problem(f'{vector.name}.turn_deg', vector.turn, 'must be a finite number')

    def _use_problems(self) -> Iterator[Problem]:
        """Find variables that are used wrongly, or not at all."""
        known = 'known are: ' + ', '.join(self.variables)
        lengths = {vector.length for vector in self.vectors if isinstance(vector.length, str)}
        for body in self.bodies:
            if body.angle not in self.variables:
                yield Problem(f'{body.name}.angle', body.angle, 'must name a variable', known)
        for vector in self.vectors:
            if not isinstance(vector.length, str):
                continue
            if vector.length not in self.variables:
                yield Problem(f'{vector.name}.variable', vector.length, 'must name a variable',
                              known)
            elif vector.length in self.angles:
                yield Problem(f'{vector.name}.variable', vector.length,
                              'is the angle of a body: it cannot be a length too')
        for kind, names in (('inputs', self.inputs), ('unknowns', self.unknowns)):
            for name in names:
                if name not in lengths | self.angles:
                    yield Problem(kind, name, 'is neither the angle of a body nor the length of '
                                  'a vector', 'name it there, or leave the variable out')
        if self.loops and len(self.unknowns) != 2 * len(self.loops):
            yield Problem(
                'unknowns', list(self.unknowns),
                f'a loop determines two unknowns: {len(self.loops)} loops, '
                f'{len(self.unknowns)} unknowns', 'make others inputs, or close another loop')

    def _balance_problems(self) -> Iterator[Problem]:
        """Find unknowns that the loops, sound by now, do not determine."""
        passed = {name.removeprefix('-') for loop in self.loops for name in loop.path}
        used = [vector for vector in self.vectors if vector.name in passed]
        bodies = {vector.body for vector in used}
        determined = {vector.length for vector in used} | {
            body.angle for body in self.bodies if body.name in bodies}
        for name in self.unknowns:
            if name not in determined:
                yield Problem(name, None, 'no loop determines this unknown',
                              'make it an input, or pass it in a loop')

    def _path_problems(self) -> Iterator[Problem]:
        names = [vector.name for vector in self.vectors]
        paths = [(f'{loop.name}.path', loop.path) for loop in self.loops]
        for each in self.transmissions:
            paths += [(f'{each.name}.first', each.first), (f'{each.name}.second', each.second)]
        for place, path in paths:
            if not path:
                yield Problem(place, [], 'must name at least one vector')
        paths += [(f'{point.name}.path', point.path) for point in self.points]
        for place, path in paths:
            for name in path:
                if name.removeprefix('-') not in names:
                    yield Problem(place, name, 'must name vectors, with a - for backwards',
                                  'known are: ' + ', '.join(names))
        before: list[str] = []
        for point in self.points:
            if point.start and point.start not in before:
                yield Problem(f'{point.name}.from', point.start,
                              'must name a point that is listed before this one',
                              'leave it out to begin at the origin')
            before.append(point.name)

    def _start_problems(self) -> Iterator[Problem]:
        for name in self.variables:
            value = self.start.get(name)
            if value is None or not math.isfinite(value):
                yield Problem(f'{name}.start', value, 'must be a finite number: the start names '
                              'the branch', f'write {name}: with start: [SI] or start_deg: in it')
