# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
Sizing of drives: candidates, the rules that they keep or break, and their ranking.

What a candidate does is worked out elsewhere: `sizing_inverse` for drives that follow an axis,
`sizing_forward` for drives that turn a cam shaft.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
import math
from typing import NamedTuple

from cam_motion.drive.gearbox import Gearbox

_ROUNDING = 1e-9  # a bound exceeded by this share only is kept

Progress = Callable[[int, int], None]
"""Told how many of how many steps are done."""


def silent(done: int, total: int) -> None:
    """
    Tell nobody.

    Parameters
    ----------
    done, total : int
        How many of how many steps are done.

    """


@dataclass(frozen=True)
class GearboxChoice:
    """
    A gearbox that a drive could have.

    Attributes
    ----------
    name : str
        Its name.
    gearbox : Gearbox
        Ratio, efficiency and inertia.
    rated_torque, peak_torque : float
        Torque at the output for good and for a moment [N m]; infinite where not known.
    peak_rate : float
        How often the peak torque may come [1/s]; beyond, the rated torque is the limit.
    rated_speed, max_speed : float
        Speed of the motor shaft for good and at most [rad/s]; infinite where not known.
    source : str
        Where the figures are from.

    """

    name: str
    gearbox: Gearbox
    rated_torque: float = math.inf
    peak_torque: float = math.inf
    peak_rate: float = math.inf
    rated_speed: float = math.inf
    max_speed: float = math.inf
    source: str = ''

    def torque_limit(self, rate: float) -> float:
        """
        Give the largest torque at the output.

        Parameters
        ----------
        rate : float
            How often it comes [1/s].

        Returns
        -------
        float
            Torque [N m]; infinite where not known.

        """
        if rate <= self.peak_rate:
            return self.peak_torque
        return min(self.rated_torque, self.peak_torque)


class Check(NamedTuple):
    """
    A rule applied to a candidate.

    Attributes
    ----------
    rule : str
        Name of the rule, a key of `RULES`.
    value, bound : float
        The figure and the bound that it has to keep, in one unit.
    unit : str
        That unit.
    at_least : bool
        Whether the bound is the least allowed, else the largest.
    failed : bool
        Whether the rule is broken whatever the figures say.

    """

    rule: str
    value: float
    bound: float
    unit: str
    at_least: bool = False
    failed: bool = False

    @property
    def margin_pct(self) -> float:
        """Say how far the value keeps off its bound, in per cent of it; negative when broken."""
        gap = self.value - self.bound if self.at_least else self.bound - self.value
        if self.bound == 0.0:
            return math.copysign(math.inf, gap) if gap else 0.0
        return 100.0 * gap / abs(self.bound)

    @property
    def broken(self) -> bool:
        """Whether the candidate breaks the rule; figures that are not numbers do."""
        return self.failed or not self.margin_pct >= -100.0 * _ROUNDING

    @property
    def by_pct(self) -> float:
        """Say by how much the rule is broken, in per cent of the bound; at least 0."""
        return max(0.0, -self.margin_pct)


RULES = {
    'periodic_motion': 'has a periodic motion: the motor carries the load round',
    'starts_from_rest': 'torque at rest against the peak of the static load, at the cam shaft',
    'mean_speed': 'mean speed off the nominal one',
    'fluctuation': 'speed fluctuation',
    'contact': 'least force that presses the follower on its cam',
    'peak_torque': 'peak motor torque against the peak torque at that speed',
    'rms_torque': 'RMS motor torque against the continuous torque',
    'stability': 'stability: distance of the slowest moment from breakdown',
    'speed': 'peak motor speed against the largest speed',
    'inertia_ratio': "load's inertia at the motor shaft to the rotor's",
    'gearbox_peak_torque': 'peak torque at the output of the gearbox',
    'gearbox_rms_torque': 'RMS torque at the output of the gearbox',
    'gearbox_mean_speed': 'mean speed at the input of the gearbox',
    'gearbox_speed': 'peak speed at the input of the gearbox',
}
"""What every rule compares."""


@dataclass(frozen=True)
class Candidate:
    """
    A motor with a gearbox and a flywheel, and how it does.

    Attributes
    ----------
    motor, gearbox : str
        Their names.
    ratio : float
        Turns of the motor per turn of the load shaft [-].
    flywheel : float | None
        Inertia of the flywheel on the motor shaft [kg m²]; None for a drive without one.
    rated_power : float
        Rated power of the motor [W].
    figures : Mapping[str, float]
        What the motion costs, by name with unit.
    checks : tuple[Check, ...]
        Every rule that could be applied.

    """

    motor: str
    gearbox: str
    ratio: float
    flywheel: float | None
    rated_power: float
    figures: Mapping[str, float]
    checks: tuple[Check, ...]

    @property
    def broken(self) -> tuple[Check, ...]:
        """List the rules that it breaks."""
        return tuple(check for check in self.checks if check.broken)

    @property
    def least_margin_pct(self) -> float:
        """Give the margin to the rule that it keeps most narrowly [%]."""
        return min((check.margin_pct for check in self.checks), default=math.inf)

    @property
    def missed_by_pct(self) -> float:
        """Give the largest share by which it breaks a rule [%]; infinite for a plain failure."""
        return max((math.inf if check.failed else check.by_pct for check in self.broken),
                   default=0.0)


class Objective(NamedTuple):
    """What is best: a text for people, and a key of which the least is the best."""

    text: str
    key: Callable[[Candidate], float]


def _figure(name: str) -> Callable[[Candidate], float]:
    return lambda candidate: candidate.figures[name]


_POWER = Objective('smallest rated power', lambda candidate: candidate.rated_power)
_MARGIN = Objective('largest margin to the rule kept most narrowly',
                    lambda candidate: -candidate.least_margin_pct)
_ENERGY = Objective('least work drawn per cycle', _figure('drawn_work_per_cycle'))

OBJECTIVES: dict[str, dict[str, Objective]] = {
    'inverse': {
        'power': _POWER, 'margin': _MARGIN, 'energy': _ENERGY,
        'inertia': Objective("least ratio of the load's inertia to the rotor's",
                             _figure('inertia_ratio')),
    },
    'forward': {
        'power': _POWER, 'margin': _MARGIN, 'energy': _ENERGY,
        'fluctuation': Objective('least speed fluctuation', _figure('fluctuation_pct')),
        'flywheel': Objective('smallest flywheel', lambda candidate: candidate.flywheel or 0.0),
    },
}
"""The objectives that each method knows, by name."""


@dataclass(frozen=True)
class Sizing:
    """
    All candidates of one drive.

    Attributes
    ----------
    method : str
        ``inverse`` or ``forward``: how the candidates were worked out.
    objective : str
        By what they are ranked, a key of ``OBJECTIVES[method]``.
    ranked : tuple[Candidate, ...]
        Those that keep every rule, the best first.
    rejected : tuple[Candidate, ...]
        The others, the nearest miss first.

    """

    method: str
    objective: str
    ranked: tuple[Candidate, ...]
    rejected: tuple[Candidate, ...]

    @property
    def rejections(self) -> dict[str, int]:
        """Count the candidates that break each rule, the commonest rule first."""
        count = Counter(check.rule for one in self.rejected for check in one.broken)
        return dict(count.most_common())


def rank(method: str, objective: str, candidates: Iterable[Candidate]) -> Sizing:
    """
    Part candidates by the rules and rank those that keep them.

    Parameters
    ----------
    method : str
        A key of `OBJECTIVES`.
    objective : str
        A key of ``OBJECTIVES[method]``.
    candidates : Iterable[Candidate]
        The candidates.

    Returns
    -------
    Sizing
        Ranked by the objective; among equals the larger margin comes first.

    """
    best = OBJECTIVES[method][objective].key
    kept: list[Candidate] = []
    rejected: list[Candidate] = []
    for candidate in candidates:
        (rejected if candidate.broken else kept).append(candidate)
    kept.sort(key=lambda one: (best(one), -one.least_margin_pct))
    rejected.sort(key=lambda one: (one.missed_by_pct, len(one.broken)))
    return Sizing(method, objective, tuple(kept), tuple(rejected))
