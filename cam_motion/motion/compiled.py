# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
Scalar evaluation at full speed: a curve written out as one Python function.

A generic loop over coefficients costs several microseconds per setpoint in Python. The curve is
therefore written out once, when it is built, as the source of a function of one float: a binary
decision over the joints, then Horner's scheme with the numbers in place. Only floats of our own
enter the source, through ``repr``, which is exact. Of the many like pieces of a table the numbers
stand in a list instead, in which the joint is searched: that is hardly slower, and hundreds of
leaves would take a good part of a second to compile.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
import math
from typing import Any

from cam_motion.motion.piece import Piece
from cam_motion.units import TURN

_MANY = 128  # pieces from which their numbers stand in a list and not in the source

Sample = tuple[float, float, float, float]
Sampler = Callable[[float], Sample]


def compile_sampler(breaks: Sequence[float], pieces: Sequence[Piece]) -> Sampler:
    """
    Compile a curve into a function of one float.

    Parameters
    ----------
    breaks : Sequence[float], n + 1 values
        Rising abscissae of the joints, both ends included.
    pieces : Sequence[Piece], n values
        What lies between them.

    Returns
    -------
    Callable[[float], tuple[float, float, float, float]]
        ``sample(x)`` giving (y, y', y'', y'''); outside the curve its end pieces go on.

    """
    return _build('x', [], breaks, pieces, '')


def compile_periodic_sampler(
    breaks: Sequence[float], pieces: Sequence[Piece], advance: float
) -> Sampler:
    """
    Compile a cam, periodic in the shaft angle, into a function of one float.

    Parameters
    ----------
    breaks : Sequence[float], n + 1 values
        Rising joints within one cycle, from 0 to one turn [rad].
    pieces : Sequence[Piece], n values
        What lies between them.
    advance : float
        What the cam gains in each cycle, in its own unit.

    Returns
    -------
    Callable[[float], tuple[float, float, float, float]]
        ``sample(phi)`` giving (y, y', y'', y''') for any shaft angle [rad].

    """
    gain = f' + turn * {advance!r}' if advance else ''
    head = [
        f'    turn = floor(phi / {TURN!r})',
        f'    x = phi - turn * {TURN!r}',
    ]
    return _build('phi', head, breaks, pieces, gain)


def _build(argument: str, head: list[str], breaks: Sequence[float], pieces: Sequence[Piece],
           gain: str) -> Sampler:
    namespace: dict[str, Any] = {'cos': math.cos, 'sin': math.sin, 'floor': math.floor}
    kept = ''
    if len(pieces) >= _MANY and not any(piece.waves for piece in pieces):
        size = max(1, *(len(piece.coefficients) for piece in pieces))
        namespace |= {
            'search': bisect_right, 'joints': tuple(breaks[1:-1]),
            'rows': tuple((start, *piece.coefficients, *[0.0] * (size - len(piece.coefficients)))
                          for start, piece in zip(breaks, pieces))}
        # as defaults they are local names, which are the fastest to read
        kept = ', search=search, joints=joints, rows=rows'
        body = _row(size, gain)
    else:
        body = _tree(breaks, pieces, 0, len(pieces), 1, gain)
    lines = [f'def sample({argument}{kept}):', *head, *body]
    exec('\n'.join(lines), namespace)  # noqa: S102 (our own numbers only, see the module's head)
    sampler: Sampler = namespace['sample']
    return sampler


def _row(size: int, gain: str) -> list[str]:
    """Write value and three derivatives of whichever piece is found in the list."""
    names = [f'c{power}' for power in range(size)]
    sums = []
    for order in range(4):
        terms = [(math.perm(power, order), names[power]) for power in range(order, size)]
        text = '0.0'
        for place, (factor, name) in enumerate(reversed(terms)):
            term = name if factor == 1 else f'{float(factor)!r} * {name}'
            text = term if place == 0 else f'{term} + u * ({text})'
        sums.append(text)
    return [
        f'    start, {", ".join(names)} = rows[search(joints, x)]',
        '    u = x - start',
        f'    return {sums[0]}{gain}, {sums[1]}, {sums[2]}, {sums[3]}',
    ]


def _tree(
    breaks: Sequence[float], pieces: Sequence[Piece], low: int, high: int, depth: int, gain: str
) -> list[str]:
    """Write the decision among pieces low to high - 1."""
    indent = '    ' * depth
    if high - low == 1:
        return [indent + line for line in _leaf(breaks[low], pieces[low], gain)]
    middle = (low + high) // 2
    return [
        f'{indent}if x < {breaks[middle]!r}:',
        *_tree(breaks, pieces, low, middle, depth + 1, gain),
        f'{indent}else:',
        *_tree(breaks, pieces, middle, high, depth + 1, gain),
    ]


def _leaf(start: float, piece: Piece, gain: str) -> list[str]:
    """Write value and three derivatives of one piece."""
    lines = [f'u = x - {start!r}' if start else 'u = x']
    orders = [piece]
    for _ in range(3):
        orders.append(orders[-1].derivative)
    terms = [[_horner(each.coefficients)] for each in orders]
    for number, wave in enumerate(piece.waves):
        lines += [f'w{number} = {wave.omega!r} * u',
                  f'c{number} = cos(w{number})', f's{number} = sin(w{number})']
        for term, each in zip(terms, orders):
            _, cosine, sine = each.waves[number]
            term += [f'{cosine!r} * c{number}'] if cosine else []
            term += [f'{sine!r} * s{number}'] if sine else []
    sums = [' + '.join(part for part in term if part) or '0.0' for term in terms]
    return [*lines, f'return {sums[0]}{gain}, {sums[1]}, {sums[2]}, {sums[3]}']


def _horner(coefficients: Sequence[float]) -> str:
    while coefficients and coefficients[-1] == 0.0:
        coefficients = coefficients[:-1]
    if not coefficients:
        return ''
    text = repr(coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        text = f'u * ({text})' if '+' in text else f'u * {text}'
        if coefficient:
            text = f'{coefficient!r} + {text}'
    return text
