# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Which torque curve an induction motor gets from the figures that are known of it."""

from __future__ import annotations

from collections.abc import Mapping

from cam_motion.drive.motor import InductionMotor, KlossMotor
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.units import RPM

FIGURES = ('synchronous_rpm', 'rated_rpm', 'rated_torque', 'breakdown_torque', 'starting_torque',
           'breakdown_slip', 'a', 'b', 'inertia')
"""What may be known of a motor."""


def induction_motor(known: Mapping[str, float | None]) -> InductionMotor | KlossMotor:
    """
    Make a motor from its figures.

    Parameters
    ----------
    known : Mapping[str, float | None]
        All of `FIGURES`, None for what is not known: speeds [rpm], torques [N m], slip at
        breakdown and the constants of document 004's curve [-], inertia [kg m²].

    Returns
    -------
    InductionMotor | KlossMotor
        Document 004's curve by slip, a and b; else Kloss' curve by the slip, or through the rated
        point, bent to the torque at rest where that is known.

    Raises
    ------
    ConfigurationError
        When the figures make no curve, or contradict each other.

    """
    synchronous, torque, inertia = (
        known[name] or 0.0 for name in ('synchronous_rpm', 'breakdown_torque', 'inertia'))
    synchronous *= RPM
    slip, a, b, starting, rated, rated_torque = (known[name] for name in (
        'breakdown_slip', 'a', 'b', 'starting_torque', 'rated_rpm', 'rated_torque'))
    if rated is not None and rated * RPM >= synchronous:
        raise ConfigurationError([Problem(
            'rated_rpm', rated,
            f'must lie below the synchronous speed of {synchronous / RPM:g} rpm',
            'take both from the rating plate')])
    if (a is None) != (b is None) or (a is not None and slip is None):
        raise ConfigurationError([Problem(
            'a', a, 'a, b and breakdown_slip make the curve of document 004 together',
            'give all three, or leave a and b out')])
    if a is not None and b is not None and slip is not None:
        if starting is not None:
            raise ConfigurationError([Problem(
                'starting_torque', starting, 'a, b and breakdown_slip give the torque at rest too',
                'leave it out, or leave a and b out')])
        return InductionMotor(synchronous, torque, slip, a, b, inertia)
    if slip is not None:
        by_slip = KlossMotor(synchronous, torque, slip, inertia)
        return by_slip if starting is None else by_slip.started_with(starting)
    if rated is None or rated_torque is None:
        raise ConfigurationError([Problem(
            'breakdown_slip', None, 'a motor needs its breakdown slip, or rated_rpm and '
            'rated_torque', 'take them from the rating plate')])
    speed = rated * RPM
    found = KlossMotor.from_rated(synchronous, speed, rated_torque, torque, inertia)
    return found if starting is None else found.started_with(starting, speed)
