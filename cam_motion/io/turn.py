# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The motion of an axis over one turn of the shaft, couplings included, for its drive."""

from __future__ import annotations

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.axis import CoupledAxis
from cam_motion.io.axis_parameters import SHAFT
from cam_motion.motion.diagram import Axis
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.turn_profile import Turned, TurnProfile
from cam_motion.runtime.layout import Coupling

_WHOLE = 1e-9  # by which share a ratio may miss a whole number


def turn_profile(axis: Axis, drive: str = '') -> CamProfile:
    """
    Give what an axis does in one turn of the shaft.

    Parameters
    ----------
    axis : Axis
        The axis.
    drive : str
        Name of its drive, for the path of problems.

    Returns
    -------
    CamProfile
        Its cam, or what its couplings and all its cams in use make of it.

    Raises
    ------
    ConfigurationError
        When it does not repeat after one turn of the shaft: a cam that does not turn by whole
        turns meanwhile, or an axis that follows another one.

    """
    if why := _why_not(axis):
        raise ConfigurationError([Problem('axis', axis.name, (
            f'the figures of a drive are those of one turn of the shaft, and {why}'),
            'run it live: drive_sim takes the setpoints of the axis whatever they come from',
        ).below(drive)])
    if not isinstance(axis, CoupledAxis):
        return axis.profile
    layout = axis.layout
    couplings = {name: layout.couplings[name] for name in layout.active}
    if list(couplings.values()) == [Coupling()]:
        return axis.profile
    return TurnProfile([
        Turned(layout.cams[name], round(each.ratio), each.phase, each.scale)
        for name, each in couplings.items()], sum(each.offset for each in couplings.values()))


def repeats(axis: Axis) -> bool:
    """
    Tell whether an axis repeats after one turn of the shaft, so that it has a `turn_profile`.

    Parameters
    ----------
    axis : Axis
        The axis.

    Returns
    -------
    bool
        Whether it does.

    """
    return not _why_not(axis)


def _why_not(axis: Axis) -> str:
    if not isinstance(axis, CoupledAxis):
        return ''
    if axis.values['follows'] != SHAFT:
        return f'this one follows {axis.values["follows"]}'
    ratios = [axis.layout.couplings[name].ratio for name in axis.layout.active]
    wrong = [ratio for ratio in ratios
             if not round(ratio) or abs(ratio - round(ratio)) > _WHOLE * abs(ratio)]
    return f'a cam turns by {wrong[0]:g} turns meanwhile' if wrong else ''
