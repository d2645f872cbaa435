# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""When a recorded axis was on the curve of its machine file, and what it did in between."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

OFF_CURVE = ('disengaged', 'engaging', 'changing', 'disengaging', 'stopping_on_curve', 'held',
             'fault')
"""States in which an axis is not on its curve."""

OTHER = 'in sync on other couplings'
"""What an axis is called that has been changed since it was started."""

_AROUND_NS = 50_000_000  # a state and the setpoints around it may be recorded out of order by this


class Spell(NamedTuple):
    """
    A stretch of time in which an axis was not on the curve of its machine file.

    From ``begin_ns`` to ``end_ns`` in times of reception, and what it did instead.
    """

    begin_ns: int
    end_ns: int
    what: str


def spells_of(states: Sequence[tuple[int, str]], relative: bool = False) -> tuple[Spell, ...]:
    """
    Find the stretches in which an axis cannot be compared with its machine file.

    Parameters
    ----------
    states : Sequence[tuple[int, str]]
        (time of reception [ns], state) as the axis told them.
    relative : bool
        Whether the axis engages wherever the shaft or itself is, so that its curve is not known
        afterwards.

    Returns
    -------
    tuple[Spell, ...]
        The stretches; none of an axis that was on its curve from first to last.

    """
    found: list[Spell] = []
    off, other, since = '', False, 0
    for time_ns, state in states:
        now = off
        if state in OFF_CURVE:
            now = state
            other = other or state == 'changing' or (relative and state == 'engaging')
        elif state == 'in_sync':
            now = OTHER if other else ''
        elif state == 'waiting' and off:
            now = state
        if now != off:
            if off:
                found.append(Spell(since, time_ns, off))
            off, since = now, time_ns
    if off:
        found.append(Spell(since, np.iinfo(np.int64).max // 2, off))
    return tuple(found)


def within(spells: Sequence[Spell], stamps_ns: NDArray[np.int64]) -> NDArray[np.bool_]:
    """
    Tell what was received in one of several stretches, or close to its ends.

    Parameters
    ----------
    spells : Sequence[Spell]
        The stretches.
    stamps_ns : ndarray of int64, shape (n,)
        Times of reception [ns].

    Returns
    -------
    ndarray of bool, shape (n,)
        Whether each was.

    """
    inside = np.zeros(len(stamps_ns), dtype=bool)
    for spell in spells:
        inside |= (stamps_ns >= spell.begin_ns - _AROUND_NS) & (
            stamps_ns <= spell.end_ns + _AROUND_NS)
    return inside


def durations(spells: Sequence[Spell], last_ns: int) -> dict[str, float]:
    """
    Sum how long an axis did what.

    Parameters
    ----------
    spells : Sequence[Spell]
        The stretches.
    last_ns : int
        Time of reception at which the recording ends [ns].

    Returns
    -------
    dict[str, float]
        Times [s] by what it did.

    """
    found: dict[str, float] = {}
    for begin, end, what in spells:
        lasted = max(0, min(end, last_ns) - begin) * 1e-9
        found[what] = found.get(what, 0.0) + lasted
    return found
