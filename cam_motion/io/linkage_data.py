# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The motion of a linkage as plain data, for JSON and for people."""

from __future__ import annotations

import math
from typing import Any

from cam_motion.io.linkage_config import rate_name
from cam_motion.io.linkage_settings import LinkageSettings
from cam_motion.io.plain import finite
from cam_motion.mechanism.linkage_motion import holding_efforts, LinkageMotion
from cam_motion.mechanism.pose import bound_text, others_text, Pose
from cam_motion.units import DEGREE


def motion_as_data(settings: LinkageSettings, motion: LinkageMotion, everything: bool = False,
                   ) -> dict[str, Any]:
    """
    Turn the motion of a linkage into plain data.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.
    motion : LinkageMotion
        Its motion.
    everything : bool
        Whether accelerations, transmission angles, ranges and the certificate are wanted too.

    Returns
    -------
    dict[str, Any]
        What ``cam_motion linkage --json`` prints: ``angles_deg`` in (-180, 180], ``omega`` and
        ``points``; ``lengths`` where loops determine any; ``efforts`` where there are loads, and
        ``crank_torques`` of the inputs among them that a spool winds.

    """
    linkage = settings.linkage
    angles = [name for name in linkage.variables if name in linkage.angles]
    lengths = [name for name in linkage.unknowns if name not in linkage.angles]
    data: dict[str, Any] = {
        'angles_deg': {name: math.remainder(motion.position[name], math.tau) / DEGREE
                       for name in angles},
        'omega': {rate_name(name): motion.velocity[name] for name in angles},
        'points': {name: {'x': point.position.real, 'y': point.position.imag,
                          'vx': point.velocity.real, 'vy': point.velocity.imag}
                   for name, point in motion.points.items()},
    }
    if lengths:
        data['lengths'] = {name: {'value': motion.position[name], 'rate': motion.velocity[name]}
                           for name in lengths}
    if settings.loaded:
        efforts = _efforts(settings, motion.pose)
        data['efforts'] = efforts
        if settings.spools:
            data['crank_torques'] = {name: efforts[name] * radius
                                     for name, radius in settings.spools.items()}
    if everything:
        data |= _rest(settings, motion)
    return data


def _rest(settings: LinkageSettings, motion: LinkageMotion) -> dict[str, Any]:
    pose = motion.pose
    return {
        'inputs': {name: motion.position[name] for name in settings.linkage.inputs},
        'accelerations': dict(motion.acceleration),
        'point_accelerations': {
            name: {'ax': point.acceleration.real, 'ay': point.acceleration.imag}
            for name, point in motion.points.items()},
        'transmission_deg': {name: angle / DEGREE for name, angle in motion.transmission.items()},
        'ranges': {name: range_as_data(settings, name, pose)
                   for name in settings.linkage.inputs},
        'certificate': {'steps': pose.certificate.steps,
                        'kantorovich': pose.certificate.kantorovich,
                        'orientation': pose.certificate.orientation,
                        'clearance': pose.clearance},
    }


def effort_texts(settings: LinkageSettings, pose: Pose) -> list[str]:
    """
    Say what the inputs must exert to hold the loads.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.
    pose : Pose
        Its position.

    Returns
    -------
    list[str]
        One sentence for each input; none without loads.

    """
    if not settings.loaded:
        return []
    texts = []
    for name, effort in _efforts(settings, pose).items():
        held = f'{effort:.6g} {"N m" if name in settings.linkage.angles else "N"}'
        if name in settings.spools:
            held += f', {effort * settings.spools[name]:.6g} N m at the crank of its spool'
        texts.append(f'{name} holds the loads with {held}')
    return texts


def _efforts(settings: LinkageSettings, pose: Pose) -> dict[str, float]:
    return {name: effort + 0.0 for name, effort in holding_efforts(  # no minus before a zero
        settings.assembly, pose, settings.forces, settings.torques).items()}


def range_as_data(settings: LinkageSettings, name: str, pose: Pose | None = None,
                  ) -> dict[str, Any]:
    """
    Turn how far an input goes while the others stay into plain data.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.
    name : str
        The input.
    pose : Pose, optional
        The position to begin at; None takes the start.

    Returns
    -------
    dict[str, Any]
        Its bounds [m, rad], None where nothing stops it, and what stops it.

    """
    found = settings.assembly.range_of(name, pose)
    return {'low': finite(found.low), 'high': finite(found.high),
            'at_low': found.at_low.text if found.at_low else None,
            'at_high': found.at_high.text if found.at_high else None}


def range_text(settings: LinkageSettings, name: str, pose: Pose | None = None) -> str:
    """
    Say how far an input goes while the others stay.

    Parameters
    ----------
    settings : LinkageSettings
        The linkage.
    name : str
        The input.
    pose : Pose, optional
        The position to begin at; None takes the start, and says where the others are there.

    Returns
    -------
    str
        One sentence.

    """
    found = settings.assembly.range_of(name, pose)
    ends = [(f'{side} {bound_text(settings.linkage, name, value)}', what.text)
            for side, value, what in (('above', found.low, found.at_low),
                                      ('below', found.high, found.at_high)) if what]
    others = others_text(settings.assembly.start, name) if pose is None else ''
    given = f' (with {others})' if others else ''
    if not ends:
        return f'{name}: turns through, nothing stops it{given}'
    reasons = dict.fromkeys(reason for _, reason in ends)
    return (f'{name}: ' + ' and '.join(end for end, _ in ends) + ', where '
            + ' and '.join(reasons) + given)
