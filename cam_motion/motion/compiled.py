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
enter the source, through ``repr``, which is exact.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
import math

from cam_motion.motion.piece import Piece
from cam_motion.units import TURN

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
    return _build(['def sample(x):', *_tree(breaks, pieces, 0, len(pieces), 1, '')])


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
        'def sample(phi):',
        f'    turn = floor(phi / {TURN!r})',
        f'    x = phi - turn * {TURN!r}',
    ]
    return _build(head + _tree(breaks, pieces, 0, len(pieces), 1, gain))


def _build(lines: list[str]) -> Sampler:
    namespace = {'cos': math.cos, 'sin': math.sin, 'floor': math.floor}
    exec('\n'.join(lines), namespace)  # noqa: S102 (our own numbers only, see the module's head)
    sampler: Sampler = namespace['sample']  # type: ignore[assignment]
    return sampler


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
