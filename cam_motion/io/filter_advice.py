# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Advice which filter to lay over a cam, so that its load is at rest after a movement."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from cam_motion.errors import ConfigurationError
from cam_motion.io.advice_movement import Question
from cam_motion.io.plain import finite
from cam_motion.io.shaping_parameters import NO_FILTER
from cam_motion.motion.laws import MotionLaw
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.shaped_profile import movements, ShapedProfile
from cam_motion.motion.shaping import KINDS, make_filter
from cam_motion.motion.shaping_effect import Effect, ERRORS, MovementEffect
from cam_motion.units import RPM, TURN
import numpy as np

SPEEDS = np.linspace(0.5, 1.5, 41)
"""Shares of the set speed at which data tell what is left: a filter is exact at 1 only."""


@dataclass(frozen=True)
class FilterFigures:
    """
    What a filter does to a movement.

    Attributes
    ----------
    kind : str
        Name of the filter; ``none`` without one.
    delay : float
        How long the filter is [s]: by that the movement ends later, or is made shorter before.
    residual : float
        Amplitude left afterwards, in the unit of the axis.
    residuals : dict[float, float]
        The same where the frequency is wrong by a share.
    peak_deviation : float
        Largest deviation of the load during the movement, from rest, in the unit of the axis.
    repeated_peak : float
        The same with the cycle repeated for long; infinite in a resonance without damping.
    peak_velocity, peak_acceleration : float
        Peaks of the axis over its cycle [unit/s, unit/s²].
    effect : MovementEffect | None
        Behind these figures.
    refusal : str
        Why the filter cannot be taken; empty if it can.

    """

    kind: str
    delay: float = 0.0
    residual: float = 0.0
    residuals: dict[float, float] = field(default_factory=dict)
    peak_deviation: float = 0.0
    repeated_peak: float = 0.0
    peak_velocity: float = 0.0
    peak_acceleration: float = 0.0
    effect: MovementEffect | None = None
    refusal: str = ''


def advise_filters(question: Question, law: MotionLaw) -> list[FilterFigures]:
    """
    Lay each filter over the cam of a movement.

    Parameters
    ----------
    question : Question
        The movement; what swings must be known.
    law : MotionLaw
        The law that it is to have.

    Returns
    -------
    list[FilterFigures]
        Without a filter first; empty where nothing swings or there is no cam.

    """
    load, cam = question.load, question.cam_with(law)
    if load is None or cam is None:
        return []
    fit = False
    if isinstance(cam, ShapedProfile):
        fit = cam.fit
        cam = cam.original
    found = [_figures(question, NO_FILTER, cam)]
    for kind in KINDS:
        made = make_filter(kind, load.frequency, load.damping)
        try:
            shaped = ShapedProfile(cam, made, question.speed, fit)
        except ConfigurationError as error:
            found.append(FilterFigures(kind, refusal=error.problems[0].rule))
            continue
        found.append(_figures(question, kind, shaped))
    return found


def _figures(question: Question, kind: str, cam: CamProfile) -> FilterFigures:
    load, speed, scale = question.load, question.speed, abs(question.scale)
    assert load is not None
    name = cam.segments[question.index].name
    whole = next(each for each in movements(cam) if name in each.segments)
    effect = MovementEffect(cam, whole, load)
    response = effect.response(speed)
    return FilterFigures(
        kind, cam.filter.duration if isinstance(cam, ShapedProfile) else 0.0,
        scale * float(effect.residual(speed)),
        {error: scale * float(effect.residual(speed, error)) for error in ERRORS},
        scale * load.factor * abs(response.peak.value),
        scale * Effect(cam, load, speed).repeated_peak,
        scale * abs(cam.curve.peak(1).value) * speed,
        scale * abs(cam.curve.peak(2).value) * speed ** 2, effect)


def filters_as_data(question: Question, found: list[FilterFigures]) -> list[dict[str, Any]]:
    """
    Give the figures of filters as plain data.

    Parameters
    ----------
    question : Question
        The movement.
    found : list[FilterFigures]
        The figures.

    Returns
    -------
    list[dict[str, Any]]
        For JSON: None where a figure is infinite.

    """
    return [{'kind': each.kind, 'reason': each.refusal} if each.effect is None else {
        'kind': each.kind, 'duration_s': each.delay, 'residual': each.residual,
        'residual_by_frequency_error_pct': {
            f'{error * 100.0:+.0f}': value for error, value in each.residuals.items()},
        'over_speed': {
            'speed_cpm': (SPEEDS * question.shaft_speed / RPM).tolist(),
            'residual': (abs(question.scale) * each.effect.residual(
                SPEEDS * question.speed)).tolist()},
        'peak_deviation': each.peak_deviation, 'repeated_peak': finite(each.repeated_peak),
        'peak_velocity': each.peak_velocity, 'peak_acceleration': each.peak_acceleration,
    } for each in found]


def delay_deg(question: Question, delay: float) -> float:
    """
    Convert a delay to the angle by which the cam turns meanwhile.

    Parameters
    ----------
    question : Question
        The movement.
    delay : float
        The delay [s].

    Returns
    -------
    float
        The angle [deg].

    """
    return delay * question.speed * 360.0 / TURN
