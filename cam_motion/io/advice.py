# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Advice for movements of a machine file, or for one described on its own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
import math

from cam_motion.drive.cycle import cycle_figures
from cam_motion.drive.inverse import FollowerDrive
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.advice_movement import Question
from cam_motion.motion.advice import (
    BALANCED,
    Candidate,
    ends_text,
    figures_of,
    merged,
    Ranked,
    ranked,
)
from cam_motion.motion.laws import LAWS, make_law, MotionLaw
from cam_motion.motion.laws.fitted import fitted, misses
from cam_motion.motion.limits import QUANTITIES
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.shaped_profile import movements, ShapedProfile
from cam_motion.motion.shaping_effect import Load, MovementEffect
from cam_motion.motion.superposition import window
from cam_motion.motion.vibration import residual_amplitude
from cam_motion.runtime.planning import TransitionError
from cam_motion.units import DEGREE, rate_text, RPM, TURN

_ROUNDING = 1e-9
_BY_NEIGHBOURS = 'auto'  # the one law that needs nothing but its neighbours


@dataclass(frozen=True)
class Advice:
    """
    The laws for a movement.

    Attributes
    ----------
    question : Question
        The movement.
    by : str
        What they are ranked by.
    ranking : tuple[Ranked, ...]
        Those that can be taken, the best first.
    stepping : tuple[Ranked, ...]
        Those with which the acceleration steps, likewise ranked among themselves; empty where
        they have been ranked with the others.
    refused : tuple[Candidate, ...]
        Those that cannot, each with its reason.

    """

    question: Question
    by: str
    ranking: tuple[Ranked, ...]
    stepping: tuple[Ranked, ...]
    refused: tuple[Candidate, ...]


def advise(question: Question, by: str = BALANCED, allow_steps: bool = False) -> Advice:
    """
    Rank the laws for a movement.

    Parameters
    ----------
    question : Question
        The movement.
    by : str
        One of `cam_motion.motion.advice.CRITERIA`.
    allow_steps : bool
        Whether laws with which the acceleration steps are ranked with the others.

    Returns
    -------
    Advice
        The laws.

    Raises
    ------
    ConfigurationError
        When nothing is known of what they are to be ranked by.

    """
    candidates = merged(_candidates(question))
    usable = [each for each in candidates if not each.refusal]
    if usable and by != BALANCED and by not in usable[0].figures:
        drive = by in ('peak_torque', 'rms_torque', 'energy')
        raise ConfigurationError([Problem(
            '--by', by, f'nothing is known of it for {question.name}',
            'it needs a drive that follows the axis; without one, peak_acceleration goes with '
            'the torque of a servo motor and peak_power with that of a cam shaft' if drive else
            'give --frequency-hz, or shaping.frequency_hz of the axis; it must stand somewhere')])
    frequency = None if question.load is None else question.load.frequency
    groups = [[each for each in usable if allow_steps or each.legal],
              [each for each in usable if not allow_steps and not each.legal]]
    ranking, stepping = (
        tuple(ranked(group, by, question.lift, frequency, against))
        for group, against in zip(groups, ((), groups[0])))
    return Advice(question, by, ranking, stepping,
                  tuple(each for each in candidates if each.refusal))


def _candidates(question: Question) -> Iterator[Candidate]:
    now = question.configured
    if now is not None:
        yield _tried(question, now)
    # the one that needs no numbers first: others with its curve are the same as it
    for name in sorted(LAWS, key=lambda name: name != _BY_NEIGHBOURS):
        if name == 'dwell':
            continue
        try:
            made = _law_for(question, name)
        except ConfigurationError as error:
            yield Candidate(MotionLaw(name, {}, make_law('dwell').curve),
                            refusal=f'needs parameters: {error.problems[0].path}')
            continue
        if made is None:
            yield Candidate(_default(name), refusal='takes its shape from conditions that it is '
                                                    'given')
        elif now is None or (now.name, now.parameters) != (name, made.parameters):
            yield _tried(question, made)


def _law_for(question: Question, name: str) -> MotionLaw | None:
    """Make a law that begins and ends as its neighbours do; None where only a user could."""
    made, asked = _default(name), question.conditions
    if name == _BY_NEIGHBOURS:
        if question.profile is not None or made.ends == question.ends:
            return made
        if asked is None or None in (*asked[0], *asked[1]):
            return None
        return MotionLaw(name, made.parameters, make_law('polynomial', **{
            f'{end}_{quantity}': value for end, condition in zip(('start', 'end'), asked)
            for quantity, value in condition._asdict().items()}).curve)
    fitting = None if asked is None else fitted(name, asked)
    if fitting is None and LAWS[name].any_ends and made.ends != question.ends:
        return None
    return fitting or made


@cache
def _default(name: str) -> MotionLaw:
    """Make a law once: it remembers its coefficients."""
    return make_law(name)


def _tried(question: Question, law: MotionLaw) -> Candidate:
    """Put a law into the movement and look at it."""
    configured = law is question.configured
    asked = question.conditions
    cam = None
    if question.profile is None:
        assert asked is not None
        wrong = _velocity_text(law, question)
        if wrong:
            return Candidate(law, refusal=wrong)
        low, high = question.start_deg * DEGREE, question.end_deg * DEGREE
        curve = wide = law.curve.scaled(low, high, question.lift)
        legal = not curve.jumps(2) and not any(misses(law, asked, 2)) and all(
            condition.acceleration is not None or has is kind
            for condition, has, kind in zip(asked, law.ends, question.ends))
    else:
        try:
            cam = question.cam_with(law)
            if cam is not None and question.layout is not None:
                replace(question.layout, cams={
                    **question.layout.cams, question.cam: cam}).check_range(question.limits)
        except TransitionError as error:
            return Candidate(law, configured=configured, refusal=str(error))
        except ConfigurationError as error:
            reason = ends_text(law, *question.ends) or _velocity_text(law, question) or (
                '; '.join(dict.fromkeys(problem.rule for problem in error.problems)))
            return Candidate(law, configured=configured, refusal=reason)
        assert cam is not None
        curve, wide = (
            part.scaled(part.start, part.end, question.scale) for part in (
                _stretch(cam, (question.index,)), _stretch(cam, question.covered)))
        legal = not _steps(question, cam)
    figures = _figures(question, law, wide, legal)
    if not configured and curve.peak(1).value == 0.0:
        return Candidate(law, refusal='would stand still: the lift is 0')
    if question.load is not None:
        figures['residual'] = _residual(question, cam, curve, question.load)
    if question.drive is not None and cam is not None:
        figures |= _torques(question, cam, question.drive)
    return Candidate(law, figures, curve, configured, legal,
                     _broken_limit(question, figures, cam, wide))


def _velocity_text(law: MotionLaw, question: Question) -> str:
    """Say at which end the velocity of a law is not that of its neighbour; empty if at none."""
    kinds = ends_text(law, *question.ends)
    if question.conditions is None or not any(misses(law, question.conditions, 1)):
        return ''
    if any(has.moves != needed.moves for has, needed in zip(law.ends, question.ends)):
        return kinds
    ends = zip(('starts', 'ends'), misses(law, question.conditions, 1), law.curve.end_values(1),
               question.conditions)
    return ' and '.join(
        f'{verb} at {has:.5g} lifts per span, its neighbour there has {needed.velocity:.5g}'
        for verb, wrong, has, needed in ends if wrong)


def _steps(question: Question, cam: CamProfile) -> bool:
    """Tell whether the acceleration steps within a movement or where it meets its neighbours."""
    low, high = question.start_deg * DEGREE, question.end_deg * DEGREE
    return any(low - _ROUNDING <= jump.at + turn <= high + _ROUNDING
               for jump in cam.jumps(2) for turn in (0.0, TURN))


def _figures(question: Question, law: MotionLaw, curve: Piecewise, legal: bool,
             ) -> dict[str, float]:
    """Take the figures of a movement, from the coefficients of its law where these hold."""
    if LAWS[law.name].any_ends or isinstance(question.profile, ShapedProfile) or (
            len(question.covered) > 1 or any(end.moves for end in law.ends)):
        return figures_of(curve, question.speed, not legal)
    found, lift, time = law.coefficients, abs(question.lift), question.duration
    return {
        'peak_velocity': found.cv * lift / time, 'peak_acceleration': found.ca * lift / time ** 2,
        'peak_jerk': found.cj_inside * lift / time ** 3 if legal else math.inf,
        'peak_power': found.power * lift ** 2 / time ** 3,
        'rms_acceleration': found.rms_acceleration * lift / time ** 2}


def _stretch(cam: CamProfile, covered: tuple[int, ...]) -> Piecewise:
    """Cut segments out of their cam, with what a filter adds to them in the dwell behind."""
    first, last = (cam.parts[place] for place in (covered[0], covered[-1]))
    end = last.end if last.end > first.start else last.end + TURN
    place = (covered[-1] + 1) % len(cam.segments)
    if isinstance(cam, ShapedProfile) and not cam.fit and cam.segments[place].is_dwell:
        dwell = cam.parts[place]
        late = min(cam.filter.duration * cam.speed, dwell.end - dwell.start)
        return window(cam.curve, cam.advance, first.start, end + late)
    return first if len(covered) == 1 else window(cam.curve, cam.advance, first.start, end)


def _residual(question: Question, cam: CamProfile | None, curve: Piecewise, load: Load) -> float:
    """Find what is left swinging when the axis stands again."""
    if cam is None:
        return load.factor * float(residual_amplitude(
            curve, load.frequency / question.speed, load.damping))
    name = cam.segments[question.index].name
    whole = next(each for each in movements(cam) if name in each.segments)
    left = MovementEffect(cam, whole, load).residual(question.speed)
    return abs(question.scale) * float(left)


def _torques(question: Question, cam: CamProfile, drive: FollowerDrive) -> dict[str, float]:
    # a scaled cam on a drive is the cam on a drive whose roller is smaller by that
    seen = replace(drive, radius=drive.radius / question.scale,
                   resistance_force=drive.resistance_force * question.scale)
    figures = cycle_figures(seen, cam, question.speed)
    return {'peak_torque': figures.peak_torque, 'rms_torque': figures.rms_torque,
            'energy': figures.motor_energy + figures.regenerated_energy}


def _broken_limit(question: Question, figures: Mapping[str, float], cam: CamProfile | None,
                  curve: Piecewise) -> str:
    """Say which limit would break at the set speed, the one that breaks most; empty if none."""
    worst, text = 1.0 + _ROUNDING, ''
    for order, quantity in enumerate(QUANTITIES[1:], start=1):
        limit, value = question.limits.of_order(order), figures[f'peak_{quantity}']
        if limit is None or value <= limit * worst:
            continue
        worst = value / limit
        unit = rate_text(question.unit, order)
        if math.isinf(value):
            return 'its acceleration steps: no limit of the jerk can be kept'
        most = question.shaft_speed / RPM * worst ** (-1.0 / order)
        where = ''
        if cam is not None and len(question.covered) > 1:
            at = curve.peak(order).at % TURN
            name = next(each.name for each in cam.segments if at <= each.end + _ROUNDING)
            where = f' in {name}'
        text = (f'needs {value:.5g} {unit}{where}, the limit is {limit:g}: it runs up to '
                f'{math.floor(most * 100.0) / 100.0:g} cycles/min')
    return text
