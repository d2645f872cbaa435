# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
Sums of vectors at full speed: written out once as two Python functions of plain floats.

With half a dozen variables an array operation costs more than all the arithmetic in it. What the
loops of a linkage come to is therefore written out, when the linkage is assembled, as source
with the numbers in place. Only floats of our own enter it, through ``repr``, which is exact, and
variables by their number; see `cam_motion.motion.compiled` for the same of motion curves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
import math

from cam_motion.mechanism.linkage import Linkage, Vector
from cam_motion.motion.piece import Array

Compiled = Callable[[Sequence[float]], tuple[float, ...]]


def compile_sums(linkage: Linkage, counts: Array, turned: Sequence[complex],
                 ) -> tuple[Compiled, Compiled]:
    """
    Write sums of vectors, such as the closure of loops, and their derivatives out as functions.

    Parameters
    ----------
    linkage : Linkage
        The linkage.
    counts : ndarray, shape (k, vectors)
        How often each sum holds each vector; -1 backwards.
    turned : Sequence[complex], one per vector
        Direction of each vector on its body.

    Returns
    -------
    tuple[Callable, Callable]
        Functions of all variables [m, rad]: the sums, real parts, then imaginary parts [m]; and
        their derivatives in the same order, row after row.

    """
    places = {name: k for k, name in enumerate(linkage.variables)}
    angles = {body.name: places[body.angle] for body in linkage.bodies}
    passed = {i: vector for i, vector in enumerate(linkage.vectors) if counts[:, i].any()}
    head = [
        'def sums(z):',
        '    ' + ''.join(f'z{k}, ' for k in places.values()) + '= z',
        *(f'    c{k} = cos(z{k}); s{k} = sin(z{k})' for k in sorted(
            {angles[vector.body] for vector in passed.values() if vector.body in angles})),
        *(line for i, vector in passed.items() for line in _vector(
            i, vector, complex(turned[i]), places, angles.get(vector.body))),
    ]
    count = len(counts)
    values: list[str] = [''] * (2 * count)
    slopes = [[''] * len(places) for _ in range(2 * count)]
    for i, vector in passed.items():
        by_length = places[vector.length] if isinstance(vector.length, str) else None
        for k, times in enumerate(map(float, counts[:, i])):
            if not times:
                continue
            real, imaginary = k, k + count
            values[real] += f' + {times!r} * x{i}'
            values[imaginary] += f' + {times!r} * y{i}'
            if by_length is not None:
                slopes[real][by_length] += f' + {times!r} * p{i}'
                slopes[imaginary][by_length] += f' + {times!r} * q{i}'
            if vector.body in angles:
                slopes[real][angles[vector.body]] += f' + {-times!r} * y{i}'
                slopes[imaginary][angles[vector.body]] += f' + {times!r} * x{i}'
    return (_build(head, values), _build(head, [term for row in slopes for term in row]))


def _vector(i: int, vector: Vector, turned: complex, places: dict[str, int],
            angle: int | None) -> Iterator[str]:
    """Write direction p, q and the vector x, y itself."""
    a, b = turned.real, turned.imag
    if angle is None:
        yield f'    p{i} = {a!r}; q{i} = {b!r}'
    else:
        c, s = f'c{angle}', f's{angle}'
        yield f'    p{i} = {a!r} * {c} - {b!r} * {s}; q{i} = {a!r} * {s} + {b!r} * {c}'
    length = (f'z{places[vector.length]}' if isinstance(vector.length, str)
              else repr(float(vector.length)))
    yield f'    x{i} = {length} * p{i}; y{i} = {length} * q{i}'


def _build(head: list[str], terms: list[str]) -> Compiled:
    sums = ''.join(f'{term.removeprefix(" + ") or "0.0"}, ' for term in terms)
    namespace: dict[str, Compiled] = {'cos': math.cos, 'sin': math.sin}  # type: ignore[dict-item]
    exec('\n'.join([*head, f'    return ({sums})']), namespace)  # noqa: S102 (see above)
    return namespace['sums']
