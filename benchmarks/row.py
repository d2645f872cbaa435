# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""One line of the result."""

from collections.abc import Callable, Sequence
from time import perf_counter
from typing import NamedTuple


class Row(NamedTuple):
    """What was measured: our figure, that of the alternative, their ratio, and the goal."""

    what: str
    ours: str
    peer: str
    ratio: str
    goal: str


def best_of(work: Callable[[], object], repeats: int = 7) -> float:
    """
    Time a piece of work; the least of several runs is the one least disturbed.

    Parameters
    ----------
    work : Callable[[], object]
        The work.
    repeats : int
        How often.

    Returns
    -------
    float
        Seconds.

    """
    times = []
    for _ in range(repeats):
        start = perf_counter()
        work()
        times.append(perf_counter() - start)
    return min(times)


def percentile_99(values: Sequence[int]) -> int:
    """Give the value that 99 % of them do not exceed."""
    return sorted(values)[int(0.99 * len(values))]
