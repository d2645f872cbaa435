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
from cam_motion.motion.advice import (
    BALANCED,
    Candidate,
    ends_text,
    figures_of,
    merged,
    Ranked,
    ranked,
)
from cam_motion.motion.laws import Boundary, LAWS, laws_between, make_law, MotionLaw
from cam_motion.motion.limits import Limits, QUANTITIES
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import Segment
from cam_motion.motion.shaped_profile import movements, ShapedProfile
from cam_motion.motion.shaping_effect import Load, MovementEffect
from cam_motion.motion.superposition import window
from cam_motion.motion.vibration import residual_amplitude
from cam_motion.units import DEGREE, rate_text, RPM, TURN

_ROUNDING = 1e-9
_BY_NEIGHBOURS = 'auto'  # the one law that needs nothing but its neighbours
_MOVING = (Boundary.CONSTANT_VELOCITY, Boundary.MOTION)


@dataclass(frozen=True)
class Question:
    """
    A movement to advise upon.

    Attributes
    ----------
    name : str
        What it is called: ``feeder.feed``.
    unit : str
        Unit of its axis.
    lift : float
        What it moves by, the scale of the cam included, in the unit of the axis.
    start_deg, end_deg : float
        Where on the cam [deg].
    speed : float
        Speed of the cam [rad/s]; above 0.
    ends : tuple[Boundary, Boundary]
        What its neighbours do where they meet it.
    profile : CamProfile | None
        The cam; None for a movement on its own that does not go from rest to rest.
    index : int
        Place of its segment among those of the cam.
    scale : float
        What the lifts of the cam are multiplied by [-].
    shaft_speed : float
        Speed of the shaft [rad/s]; above 0.
    limits : Limits
        Limits of the axis.
    load : Load | None
        What swings behind the axis.
    drive : FollowerDrive | None
        What moves it.
    configured : MotionLaw | None
        The law that it has now.

    """

    name: str
    unit: str
    lift: float
    start_deg: float
    end_deg: float
    speed: float
    ends: tuple[Boundary, Boundary]
    profile: CamProfile | None
    shaft_speed: float
    index: int = 0
    scale: float = 1.0
    limits: Limits = Limits()
    load: Load | None = None
    drive: FollowerDrive | None = None
    configured: MotionLaw | None = None

    @property
    def duration(self) -> float:
        """How long it lasts [s]."""
        return (self.end_deg - self.start_deg) * DEGREE / self.speed

    def cam_with(self, law: MotionLaw) -> CamProfile | None:
        """
        Put a law into the movement, the rest of the cam as it is.

        Parameters
        ----------
        law : MotionLaw
            The law.

        Returns
        -------
        CamProfile | None
            The cam, shaped if it is; None for a movement that has no cam.

        Raises
        ------
        ConfigurationError
            When the law does not fit its neighbours, or the filter.

        """
        cam = self.profile
        if cam is None or law is self.configured:
            return cam
        bare = cam.original if isinstance(cam, ShapedProfile) else cam
        segments = list(bare.segments)
        segments[self.index] = replace(segments[self.index], law=law)
        changed = CamProfile(segments, bare.accumulate)
        return cam.shaping(changed) if isinstance(cam, ShapedProfile) else changed


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


def movement(lift: float, span_deg: float, speed_cpm: float,
             ends: tuple[Boundary, Boundary] = (Boundary.REST, Boundary.REST),
             load: Load | None = None, unit: str = 'm') -> Question:
    """
    Describe a movement on its own.

    Parameters
    ----------
    lift : float
        What it moves by, in its unit.
    span_deg : float
        Over which angle [deg], above 0 and at most 360.
    speed_cpm : float
        Speed of the cam [cycles/min]; above 0.
    ends : tuple[Boundary, Boundary]
        What is before and behind it.
    load : Load | None
        What swings behind it.
    unit : str
        Its unit.

    Returns
    -------
    Question
        The movement.

    """
    profile = None
    if ends == (Boundary.REST, Boundary.REST):
        segments = [Segment('movement', make_law('polynomial_345'), span_deg, lift)]
        if span_deg < 360.0:
            segments.append(Segment('dwell', make_law('dwell'), 360.0))
        profile = CamProfile(segments, accumulate=True)
    speed = speed_cpm * RPM
    return Question('movement', unit, lift, 0.0, span_deg, speed, ends, profile, speed, load=load)


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
    for name, law in LAWS.items():
        if name == 'dwell':
            continue
        try:
            made = _default(name)
        except ConfigurationError as error:
            yield Candidate(MotionLaw(name, {}, make_law('dwell').curve),
                            refusal=f'needs parameters: {error.problems[0].path}')
            continue
        by_neighbours = name == _BY_NEIGHBOURS and question.profile is not None
        if law.any_ends and not by_neighbours and made.ends != question.ends:
            yield Candidate(made, refusal='takes its shape from conditions that it is given')
        elif now is None or (now.name, now.parameters) != (name, made.parameters):
            yield _tried(question, made)


@cache
def _default(name: str) -> MotionLaw:
    """Make a law once: it remembers its coefficients."""
    return make_law(name)


def _tried(question: Question, law: MotionLaw) -> Candidate:
    """Put a law into the movement and look at it."""
    configured = law is question.configured
    low, high = question.start_deg * DEGREE, question.end_deg * DEGREE
    start, end = question.ends
    if question.profile is None:
        if any((has in _MOVING) != (needed in _MOVING)
               for has, needed in zip(law.ends, question.ends)):
            return Candidate(law, refusal=ends_text(law, start, end))
        cam, curve = None, law.curve.scaled(low, high, question.lift)
        legal = law.name in laws_between(start, end) and not curve.jumps(2)
    else:
        try:
            cam = question.cam_with(law)
        except ConfigurationError as error:
            reason = ends_text(law, start, end) or '; '.join(
                dict.fromkeys(problem.rule for problem in error.problems))
            return Candidate(law, configured=configured, refusal=reason)
        assert cam is not None
        curve = _stretch(cam, question.index)
        curve = curve.scaled(curve.start, curve.end, question.scale)
        steps = [jump.at for jump in cam.jumps(2)]
        legal = not any(low - _ROUNDING <= at + turn <= high + _ROUNDING
                        for at in steps for turn in (0.0, TURN))
    figures = _figures(question, law, curve, legal)
    if not configured and figures['peak_velocity'] == 0.0:
        return Candidate(law, refusal='would stand still: the lift is 0')
    if question.load is not None:
        figures['residual'] = _residual(question, cam, curve, question.load)
    if question.drive is not None and cam is not None:
        figures |= _torques(question, cam, question.drive)
    return Candidate(law, figures, curve, configured, legal, _broken_limit(question, figures))


def _figures(question: Question, law: MotionLaw, curve: Piecewise, legal: bool,
             ) -> dict[str, float]:
    """Take the figures of a movement, from the coefficients of its law where these hold."""
    if LAWS[law.name].any_ends or isinstance(question.profile, ShapedProfile) or any(
            end in _MOVING for end in law.ends):
        return figures_of(curve, question.speed, not legal)
    found, lift, time = law.coefficients, abs(question.lift), question.duration
    return {
        'peak_velocity': found.cv * lift / time, 'peak_acceleration': found.ca * lift / time ** 2,
        'peak_jerk': found.cj_inside * lift / time ** 3 if legal else math.inf,
        'peak_power': found.power * lift ** 2 / time ** 3,
        'rms_acceleration': found.rms_acceleration * lift / time ** 2}


def _stretch(cam: CamProfile, index: int) -> Piecewise:
    """Cut the movement out of its cam, with what a filter adds to it in the dwell behind."""
    part = cam.parts[index]
    if not isinstance(cam, ShapedProfile) or cam.fit:
        return part
    behind = cam.segments[(index + 1) % len(cam.segments)]
    if not behind.is_dwell:
        return part
    dwell = cam.parts[(index + 1) % len(cam.segments)]
    late = min(cam.filter.duration * cam.speed, dwell.end - dwell.start)
    return window(cam.curve, cam.advance, part.start, part.end + late)


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


def _broken_limit(question: Question, figures: Mapping[str, float]) -> str:
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
        text = (f'needs {value:.5g} {unit}, the limit is {limit:g}: it runs up to '
                f'{math.floor(most * 100.0) / 100.0:g} cycles/min')
    return text
