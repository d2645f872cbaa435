# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Why a start names no assembly: lengths that cannot close, or values too far from any."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain

from cam_motion.errors import Problem
from cam_motion.mechanism.linkage import FRAME, Linkage, Loop
from cam_motion.mechanism.loops import LoopEquations
from cam_motion.mechanism.pose import bound_text
from cam_motion.mechanism.singular import Singularity
from cam_motion.motion.piece import Array
import numpy as np

_ROUNDING = 1e-12  # of the longest length: sides that are longer by that are not
_CLOSED = 1e-6  # of the longest length: loops that miss by less than that are well measured

_WORSE = 0.1  # of the greatest miss: loops that miss by less are measured as roughly as they may


def closing_problems(linkage: Linkage, equations: LoopEquations, rough: Array) -> list[Problem]:
    """
    Say why no assembly is near enough to the start.

    Parameters
    ----------
    linkage : Linkage
        The linkage.
    equations : LoopEquations
        Its equations.
    rough : ndarray, shape (n,)
        The variables at the start [m, rad].

    Returns
    -------
    list[Problem]
        Every loop that cannot close at the start of the inputs, whatever the angles; where all of
        them may, the one that the unknowns are not near enough to an assembly.

    Notes
    -----
    All vectors of a body turn together, those of the frame and of bodies whose angle is an input
    not at all: a loop is a polygon whose sides are their sums, and closes if and only if none of
    these is longer than all others together. With a slide of unknown length that tells nothing.

    """
    found = [problem for loop, passed in zip(linkage.loops, equations.loops)
             if (problem := _polygon_problem(linkage, equations, rough, loop, passed))]
    if found:
        return found
    values = ', '.join(_values(linkage, linkage.unknowns, rough))
    inputs = ', '.join(_values(linkage, linkage.inputs, rough))
    gaps = np.abs(equations.closure(rough).reshape(2, -1).T @ [1.0, 1j])
    if gaps.max() < _CLOSED * equations.size:
        there = Singularity.nearest(linkage, equations, rough)
        return [Problem(
            'unknowns', values, f'the start values name no branch: with {inputs} branches meet, '
            f'{there.text}', 'start the inputs farther from there')]
    misses = ', '.join(f'loop {loop.name} misses by {gap:.4g} m'
                       for loop, gap in zip(linkage.loops, gaps) if gap >= _WORSE * gaps.max())
    return [Problem(
        'unknowns', values, f'the start values name no branch: with {inputs} {misses}',
        'measure them on a drawing: near a singular position more closely')]


def _polygon_problem(linkage: Linkage, equations: LoopEquations, rough: Array, loop: Loop,
                     passed: Array) -> Problem | None:
    vectors = [(vector, count * value) for vector, count, value in zip(
        linkage.vectors, passed, equations.vectors(rough)) if count]
    if any(vector.length in linkage.unknowns for vector, _ in vectors):
        return None
    angles = {FRAME: '', **{body.name: body.angle for body in linkage.bodies}}
    given = [name for name in linkage.inputs if any(
        name in (vector.length, angles[vector.body]) for vector, _ in vectors)]
    sides: dict[str, tuple[complex, list[str]]] = {}
    for vector, value in vectors:
        angle = angles[vector.body]
        side = '' if angle in linkage.inputs else angle
        total, names = sides.get(side, (0.0, []))
        sides[side] = (total + value, [*names, vector.name])
    if len(sides) < 2:
        return None
    (length, longest), *others = sorted(
        ((abs(total), names) for total, names in sides.values()), key=lambda side: -side[0])
    rest = sum(other for other, _ in others)
    if not length > rest + _ROUNDING * equations.size:
        return None
    start = ', '.join(_values(linkage, given, rough))
    return Problem(
        f'{loop.name}.path', list(loop.path),
        f'the loop cannot close{f" with {start}" if start else ""}, whatever the angles: '
        f'{_and(longest)} {"is" if len(longest) == 1 else "are together"} {length:.6g} m long, '
        f'{_and(chain.from_iterable(names for _, names in others))} only {rest:.6g} m',
        'change these lengths' + (f', or the start of {_and(given)}' if given else ''))


def _values(linkage: Linkage, names: Iterable[str], z: Array) -> Iterator[str]:
    return (f'{name} = {bound_text(linkage, name, float(z[linkage.variables.index(name)]))}'
            for name in names)


def _and(names: Iterable[str]) -> str:
    *first, last = names
    return f'{", ".join(first)} and {last}' if first else last
