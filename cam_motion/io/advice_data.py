# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Advice as plain data, for machines."""

from __future__ import annotations

from typing import Any

from cam_motion.io.advice import Advice
from cam_motion.io.plain import finite, plain
from cam_motion.motion.advice import Candidate, Ranked
from cam_motion.units import RPM, TURN


def advice_as_data(advice: Advice) -> dict[str, Any]:
    """
    Give advice as plain data.

    Parameters
    ----------
    advice : Advice
        The advice.

    Returns
    -------
    dict[str, Any]
        For JSON: None where a figure is infinite.

    """
    question = advice.question

    def law(each: Candidate) -> dict[str, Any]:
        return {
            'law': each.law.name, 'parameters': plain(each.law.parameters),
            'configured': each.configured, 'same_as': list(each.same_as),
            'figures': {name: finite(value) for name, value in each.figures.items()}}

    def places(found: tuple[Ranked, ...]) -> list[dict[str, Any]]:
        return [{'place': place, **law(each.candidate), 'score': finite(each.score),
                 'legal': each.candidate.legal, 'reason': each.reason}
                for place, each in enumerate(found, start=1)]
    return {
        'movement': question.name, 'unit': question.unit, 'lift': question.lift,
        'start_deg': question.start_deg, 'end_deg': question.end_deg,
        'speed_cpm': question.shaft_speed / RPM, 'duration_s': question.duration,
        'ends': [end.value for end in question.ends],
        'covers_too': list(question.names_beside), 'by': advice.by,
        'frequency_hz': None if question.load is None else question.load.frequency / TURN,
        'ranking': places(advice.ranking), 'stepping': places(advice.stepping),
        'refused': [{**law(each), 'reason': each.refusal} for each in advice.refused],
    }
