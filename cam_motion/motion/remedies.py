# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The way out where two segments do not meet: which of them to change, and into what."""

from __future__ import annotations

from collections.abc import Sequence

from cam_motion.motion.laws import MotionLaw
from cam_motion.motion.laws.fitted import (
    Conditions,
    EndCondition,
    laws_meeting,
    scaled_condition,
    told_to,
)
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.segment import Segment

_ANY = EndCondition()


def to_change(segments: Sequence[Segment], place: int) -> int:
    """
    Choose which of two segments that do not meet should have another law.

    Parameters
    ----------
    segments : Sequence[Segment]
        The segments of one turn.
    place : int
        Place of the second one; the first is the one before it.

    Returns
    -------
    int
        Place of the one to change: not the one that stands, nor the one that runs at constant
        velocity, because they are what a cam is made for; else the second.

    """
    def firm(segment: Segment) -> int:
        return 2 if segment.is_dwell else int(segment.law.name == 'constant_velocity')
    before = (place - 1) % len(segments)
    return before if firm(segments[before]) < firm(segments[place]) else place


def conditions_at(segments: Sequence[Segment], parts: Sequence[Piecewise], place: int,
                  ) -> Conditions:
    """
    Tell what the neighbours of a segment ask of it.

    Parameters
    ----------
    segments : Sequence[Segment]
        The segments of one turn.
    parts : Sequence[Piecewise]
        Their curves over the shaft angle.
    place : int
        Place of the segment.

    Returns
    -------
    tuple[EndCondition, EndCondition]
        What they ask, in lifts and spans of the segment; nothing where they are ``auto``.

    """
    own = parts[place]
    found = []
    for step, side in ((-1, 1), (1, 0)):
        beside = (place + step) % len(segments)
        velocity, acceleration = (parts[beside].end_values(order)[side] for order in (1, 2))
        found.append(_ANY if segments[beside].is_auto else scaled_condition(
            velocity, acceleration, own.end - own.start, segments[place].lift))
    return found[0], found[1]


def ends_asked(conditions: Conditions) -> str:
    """
    Write what is asked of a law.

    Parameters
    ----------
    conditions : tuple[EndCondition, EndCondition]
        What is asked.

    Returns
    -------
    str
        ``from rest to 2 lifts per span``.

    """
    return 'from {} to {}'.format(*map(_condition_text, conditions))


def laws_instead(segment: Segment, conditions: Conditions) -> str:
    """
    List the laws that a segment could have instead of its own.

    Parameters
    ----------
    segment : Segment
        The segment.
    conditions : tuple[EndCondition, EndCondition]
        What its neighbours ask.

    Returns
    -------
    str
        Names, in brackets the parameters with which they fit.

    """
    return ', '.join(
        law_text(law) for law in laws_meeting(conditions)
        if (law.name, law.parameters) != (segment.law.name, segment.law.parameters))


def law_text(law: MotionLaw) -> str:
    """
    Write a law with what it is told.

    Parameters
    ----------
    law : MotionLaw
        The law.

    Returns
    -------
    str
        Its name, in brackets the parameters that are not its defaults.

    """
    told = told_to(law)
    return f'{law.name} ({told})' if told else law.name


def _condition_text(asked: EndCondition) -> str:
    if asked.velocity is None:
        return 'whatever auto meets'
    velocity = f'{asked.velocity:.6g} lifts per span' if asked.velocity else ''
    acceleration = f'{asked.acceleration:.6g} lifts per span²' if asked.acceleration else ''
    return ' and '.join(filter(None, (velocity, acceleration))) or 'rest'
