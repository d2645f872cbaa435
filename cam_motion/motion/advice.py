# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Advice which law to take: figures of a movement under each of them, ranked, with reasons."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
import math

from cam_motion.motion.laws import Boundary, LAWS, MotionLaw
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Piecewise
import numpy as np

BALANCED = 'balanced'

LABELS = {
    'peak_velocity': 'velocity', 'peak_acceleration': 'acceleration', 'peak_jerk': 'jerk',
    'peak_power': 'power', 'rms_acceleration': 'RMS acceleration', 'residual': 'vibration',
    'peak_torque': 'peak torque', 'rms_torque': 'RMS torque', 'energy': 'energy',
}
"""What laws can be ranked by, with its name in sentences."""

CRITERIA = (BALANCED, *LABELS)
"""The same as a user names it."""

# Of what a balanced law has little: what limits the motor's speed, its torque, the life of the
# mechanics, the power taken, and the heat. With a drive its own torques say two of these better.
_BALANCED = ('peak_velocity', 'peak_acceleration', 'peak_jerk', 'peak_power', 'rms_acceleration')
_BY_THE_DRIVE = {'peak_acceleration': 'peak_torque', 'rms_acceleration': 'rms_torque'}
_LEAST = 1e-6  # as little as the best (relative), but for rounding
_NEGLIGIBLE = 1e-9  # of the lift: what is less is rounding
_LOOKS = 17  # places at which two movements are compared


@dataclass(frozen=True)
class Candidate:
    """
    A law for a movement.

    Attributes
    ----------
    law : MotionLaw
        The law; its default parameters, or those configured.
    figures : Mapping[str, float]
        Magnitudes by name of the criterion, in SI; empty where the movement cannot be made.
    curve : Piecewise | None
        The movement over the angle of the cam [rad].
    configured : bool
        Whether the movement has this law now.
    legal : bool
        Whether neither velocity nor acceleration steps where it meets its neighbours.
    refusal : str
        Why it cannot be taken; empty if it can.
    same_as : tuple[str, ...]
        Other laws with the same curve here.

    """

    law: MotionLaw
    figures: Mapping[str, float] = field(default_factory=dict)
    curve: Piecewise | None = None
    configured: bool = False
    legal: bool = True
    refusal: str = ''
    same_as: tuple[str, ...] = ()


@dataclass(frozen=True)
class Ranked:
    """
    A law with its place.

    Attributes
    ----------
    candidate : Candidate
        The law.
    score : float
        What it was ranked by: the figure, or the balance [-] against a law that would be the
        best in everything.
    reason : str
        Why, in one line.

    """

    candidate: Candidate
    score: float
    reason: str


def figures_of(curve: Piecewise, omega: float, steps: bool) -> dict[str, float]:
    """
    Take the figures of a movement that need nothing but its curve.

    Parameters
    ----------
    curve : Piecewise
        The movement over the angle of the cam [rad].
    omega : float
        Speed of the cam [rad/s].
    steps : bool
        Whether its acceleration steps where it begins or ends.

    Returns
    -------
    dict[str, float]
        Magnitudes by criterion: unit/s, unit/s², unit/s³ (infinite where the acceleration
        steps); power per unit of mass.

    """
    jerk = math.inf if steps or curve.jumps(2) else abs(curve.peak(3).value) * omega ** 3
    return {
        'peak_velocity': abs(curve.peak(1).value) * omega,
        'peak_acceleration': abs(curve.peak(2).value) * omega ** 2,
        'peak_jerk': jerk,
        'peak_power': abs(curve.peak_power().value) * omega ** 3,
        'rms_acceleration': curve.rms(2) * omega ** 2,
    }


def merged(candidates: Iterable[Candidate]) -> list[Candidate]:
    """
    Merge laws that make the same movement, such as members of a family at their defaults.

    Parameters
    ----------
    candidates : Iterable[Candidate]
        The laws.

    Returns
    -------
    list[Candidate]
        One of each, the configured one before all others and those that take their shape from
        elsewhere last; the rest as its `same_as`. In the order of the registry.

    """
    found: list[Candidate] = []
    looks: list[Array | None] = []
    for each in sorted(candidates, key=lambda each: (
            not each.configured, LAWS[each.law.name].any_ends)):
        look = None if each.curve is None else each.curve(
            np.linspace(each.curve.start, each.curve.end, _LOOKS))
        place = next((n for n, known in enumerate(looks) if _same(look, known)), None)
        if place is None:
            found.append(each)
            looks.append(look)
        elif each.law.name != found[place].law.name:
            known = found[place]
            found[place] = replace(known, same_as=(*known.same_as, each.law.name))
    order = list(LAWS)
    return sorted(found, key=lambda each: order.index(each.law.name))


def _same(one: Array | None, other: Array | None) -> bool:
    """Tell whether two movements are the same but for rounding."""
    if one is None or other is None:
        return False
    return bool(np.max(np.abs(one - other)) <= _NEGLIGIBLE * np.ptp(one))


def ranked(candidates: Sequence[Candidate], by: str = BALANCED, lift: float = 1.0,
           frequency: float | None = None, against: Sequence[Candidate] = (),
           ) -> list[Ranked]:
    """
    Rank laws, the best one first.

    Parameters
    ----------
    candidates : Sequence[Candidate]
        Laws that can be taken, all with the same figures.
    by : str
        One of `CRITERIA`, of which all have a figure.
    lift : float
        Lift of the movement, in the unit of the axis.
    frequency : float | None
        Natural frequency of what swings [rad/s], where there are figures of vibration.
    against : Sequence[Candidate]
        Better laws, against whose figures these are held; none: against each other.

    Returns
    -------
    list[Ranked]
        The laws with reasons; equals stay in their order.

    Notes
    -----
    The balance is the geometric mean of how much larger each figure is than the least of its
    kind: 10 % more of one and 10 % less of another is even, whatever their units. Its figures are
    those that size a machine, one each: velocity (speed of the motor), acceleration or peak
    torque (its size), jerk (wear and noise), power of the inertia (shaft and supply), RMS
    acceleration or torque (heat). Where something swings, its amplitude counts as the
    acceleration that it adds to the peak one after the movement. Between two dwells this finds
    the modified sine, which handbooks advise where nothing particular is asked.

    """
    best = _best(against or candidates)
    scores = [_balance(each.figures, best, frequency) if by == BALANCED else each.figures[by]
              for each in candidates]
    found = [Ranked(each, score, reason(each.figures, best, by, lift))
             for each, score in zip(candidates, scores)]
    # those that are equal, or equally infinite, by what else they cost
    finite = _best(candidates)
    return sorted(found, key=lambda each: (each.score, _balance(
        each.candidate.figures, finite, frequency)))


def _best(candidates: Sequence[Candidate]) -> dict[str, float]:
    names = candidates[0].figures if candidates else ()
    return {name: min(each.figures[name] for each in candidates) for name in names}


def _balance(figures: Mapping[str, float], best: Mapping[str, float],
             frequency: float | None) -> float:
    names = [_BY_THE_DRIVE[name] if _BY_THE_DRIVE.get(name) in figures else name
             for name in _BALANCED]
    logs = [_ratio(figures[name], best[name]) for name in names]
    if frequency is not None and 'residual' in figures:
        # per unit of what the best law accelerates anyway
        scale = best['peak_acceleration']
        swing = frequency ** 2 / scale if scale else 0.0
        logs.append((1.0 + swing * figures['residual']) / (1.0 + swing * best['residual']))
    return math.exp(math.fsum(map(math.log, logs)) / len(logs))


def _ratio(value: float, least: float) -> float:
    """Compare with the least; 1 where both are zero, or both infinite."""
    if value == least:
        return 1.0
    return value / least if least else math.inf


def reason(figures: Mapping[str, float], best: Mapping[str, float], by: str,
           lift: float = 1.0) -> str:
    """
    Say in one line what a law is best and worst at, relative to the best of its kind.

    Parameters
    ----------
    figures : Mapping[str, float]
        Its figures by criterion.
    best : Mapping[str, float]
        The least of each, against which per cents are told.
    by : str
        The criterion that they are ranked by.
    lift : float
        Lift of the movement, below a billionth of which a vibration is none.

    Returns
    -------
    str
        The line.

    """
    none = _NEGLIGIBLE * abs(lift)
    ratios = {name: 1.0 if name == 'residual' and value <= none else _ratio(value, best[name])
              for name, value in figures.items()}
    steps = math.isinf(figures.get('peak_jerk', 0.0))
    if steps:
        ratios.pop('peak_jerk')
    said = []
    if by in ratios and abs(ratios[by] - 1.0) > _LEAST:
        said.append(f'{LABELS[by]} {_more(ratios[by])}')
    below = {name: ratio for name, ratio in ratios.items() if ratio < 1.0 - _LEAST and name != by}
    said += [f'{LABELS[name]} {_more(ratio)}' for name, ratio in below.items()]
    least = [LABELS[name] for name, ratio in ratios.items() if abs(ratio - 1.0) <= _LEAST]
    # a vibration is small or not by its own measure, not against one that may be zero
    others = {name: ratio for name, ratio in ratios.items()
              if ratio > 1.0 + _LEAST and name not in (by, 'residual')}
    if least:
        said.append('least ' + ', '.join(least))
    elif len(others) > 1 and not below:
        name = min(others, key=lambda name: others[name])
        said.append(f'best: {LABELS[name]} {_more(others.pop(name))}')
    if others:
        name = max(others, key=lambda name: others[name])
        said.append(f'worst: {LABELS[name]} {_more(others[name])}')
    if steps:
        said.append('infinite jerk')
    return '; '.join(said)


def _more(ratio: float) -> str:
    if math.isinf(ratio):
        return '∞'
    return f'{(ratio - 1.0) * 100.0:+.3g} %'.replace('-', '−')


def ends_text(law: MotionLaw, start: Boundary, end: Boundary) -> str:
    """
    Say why a law does not fit its neighbours.

    Parameters
    ----------
    law : MotionLaw
        The law.
    start, end : Boundary
        What the neighbours do.

    Returns
    -------
    str
        What it does at its ends, and what would be needed.

    """
    wrong = [f'{verb} in {has.value}, its neighbour there is in {needed.value}'
             for verb, has, needed in zip(('starts', 'ends'), law.ends, (start, end))
             if has is not needed]
    return ' and '.join(wrong).replace('in turn', 'with an acceleration').replace(
        'in rest', 'at rest').replace('in constant velocity', 'at constant velocity')
