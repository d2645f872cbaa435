# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Warnings: a cam that runs, though its acceleration steps where two segments meet."""

from __future__ import annotations

from collections.abc import Mapping

from cam_motion.errors import Problem
from cam_motion.io.axis import ONLY_CAM
from cam_motion.motion.continuity import Continuity
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.remedies import (
    conditions_at,
    ends_asked,
    law_text,
    laws_instead,
    to_change,
)
from cam_motion.motion.segment import Segment
from cam_motion.units import DEGREE, rate_text, RPM

_ACCELERATION = 2


def joint_warnings(cams: Mapping[str, CamProfile], continuity: Mapping[str, Continuity],
                   unit: str, omega: float) -> tuple[Problem, ...]:
    """
    Warn of joints at which the acceleration steps: the jerk is infinite there.

    Parameters
    ----------
    cams : Mapping[str, CamProfile]
        The cams of an axis by name.
    continuity : Mapping[str, Continuity]
        Their joints, by the same names.
    unit : str
        Unit of the axis.
    omega : float
        Set speed of the shaft [rad/s].

    Returns
    -------
    tuple[Problem, ...]
        One per joint, paths relative to the axis; the way out names the laws that would be
        legal between the neighbours of the one to change.

    """
    found = []
    for name, cam in cams.items():
        for place, each in enumerate(continuity[name].joints):
            joint = each.joint
            if joint.order != _ACCELERATION:
                continue
            at = to_change(cam.segments, place)
            segment = cam.segments[at]
            conditions = conditions_at(cam.segments, cam.parts, at)
            found.append(Problem(
                ('' if name == ONLY_CAM else f'{name}.') + f'{segment.name}.law',
                segment.law.name,
                f'the acceleration steps at {joint.at / DEGREE:.6g} deg, where {each.after.name} '
                f'follows {each.before.name}: by {joint.step:.4g} {rate_text(unit, 2, "rad")}, '
                f'{joint.step_at(omega):.4g} {rate_text(unit, 2)} at {omega / RPM:.6g} '
                f'cycles/min; {_law_text(segment)} is not legal {ends_asked(conditions)}',
                f'legal there: {laws_instead(segment, conditions)}'))
    return tuple(found)


def _law_text(segment: Segment) -> str:
    """Name a law; of one made of points these say nothing."""
    return segment.law.name if segment.is_spline else law_text(segment.law)
