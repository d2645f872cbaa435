# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What loads the follower of a cam disc, as a machine file describes it."""

from __future__ import annotations

from cam_motion.drive.load import Friction, Part, Process, Spring, TranslatingMass
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io import cam_disc_parameters as tables
from cam_motion.io.axis import Values
from cam_motion.io.load_config import build_part
from cam_motion.io.parameters import check_values
from cam_motion.mechanism.cam_force import ContactForce
from cam_motion.units import DEGREE
import numpy as np

FAST = 1000.0
"""Speed of the shaft at which a load must be bearable [rad/s]."""

LARGEST_FORCE = 1e15
"""Contact force that is [N]: more cannot be computed with."""


def load_part(given: Values, swings: bool) -> Part:
    """
    Check the parameters of a part of the load and build it.

    Parameters
    ----------
    given : Mapping[str, Any]
        Parameters by name.
    swings : bool
        Whether the follower swings: the part is then about its bearing, forces are moments and
        travels angles.

    Returns
    -------
    Part
        The part.

    Raises
    ------
    ConfigurationError
        With every problem, paths relative to the part.

    """
    return _swing_part(given) if swings else _travel_part(given)


def is_bearable(force: ContactForce) -> bool:
    """
    Tell whether a contact force is a number that can be computed with.

    Parameters
    ----------
    force : ContactForce
        The force.

    Returns
    -------
    bool
        Whether it stays below `LARGEST_FORCE` at the speed `FAST`, all the way round.

    """
    try:
        with np.errstate(all='ignore'):
            _, forces = force.at_speed(FAST)
    except OverflowError:
        return False
    return bool(np.all(np.abs(forces) < LARGEST_FORCE))  # not where it is no number


def _travel_part(given: Values) -> Part:
    if str(given.get('type')) not in tables.TRAVEL_PARTS:
        raise ConfigurationError([Problem(
            'type', given.get('type'), 'must be one of ' + ', '.join(tables.TRAVEL_PARTS))])
    return build_part(given)


def _swing_part(given: Values) -> Part:
    kind = str(given.get('type'))
    if kind not in tables.SWING_PARTS:
        raise ConfigurationError([Problem(
            'type', given.get('type'), 'must be one of ' + ', '.join(tables.SWING_PARTS),
            'of a follower that swings')])
    values, problems = check_values(tables.SWING_PARTS[kind], given)
    if problems:
        raise ConfigurationError(problems)
    if kind == 'spring':
        return Spring(values['stiffness'], values['preload_deg'] * DEGREE)
    if kind == 'friction':
        return Friction(values['viscous'], values['coulomb'])
    if kind == 'process':
        return build_part({'type': kind, 'force': values['moment'],
                           'window_deg': values['window_deg']})
    inertia, moment = values['inertia'], values['weight_moment']
    if moment and not inertia:
        return Process(force=moment)
    return TranslatingMass(inertia, moment / inertia if inertia else 0.0)
