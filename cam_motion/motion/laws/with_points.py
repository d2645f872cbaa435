# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The law of a table: a spline through points, which makes a segment or a whole cam."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws.law import register
from cam_motion.motion.laws.parameters import ANY_NUMBER, LARGEST_VALUE, LawParameter
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.spline import DEGREES, Ends, EndState, hermite, interpolate
import numpy as np

SPLINE = 'spline'
"""Name of the law."""

END_STATES = (('start_velocity', 'start_acceleration'), ('end_velocity', 'end_acceleration'))
"""What can be told at the start and at the end of a spline."""


def _list(name: str, what: str) -> LawParameter:
    return LawParameter(name, (), what, count=ANY_NUMBER, least=-LARGEST_VALUE,
                        most=LARGEST_VALUE)


def _end(name: str) -> LawParameter:
    end, quantity = name.split('_')
    unit = 'rad' if quantity == 'velocity' else 'rad²'
    return LawParameter(
        name, None, f'the {quantity} at the {end} in units of the axis per {unit}; left out, '
        'that of the neighbour', least=-LARGEST_VALUE, most=LARGEST_VALUE)


_POSITIONS = _list('positions', 'the positions at the points, in the unit of the axis; at least 2')
_ANGLES = _list('angles_deg', 'the shaft angles of the points [deg], rising from where the '
                'segment starts to where it ends; left out, equidistant')
_VELOCITIES = _list('velocities', 'the velocities at the points, in units of the axis per rad; '
                    'left out, those of the spline')
_ACCELERATIONS = _list('accelerations', 'the accelerations at the points, in units of the axis '
                       'per rad²; only with velocities')
_DEGREE = LawParameter('degree', 5.0, '3 or 5: the acceleration is continuous, or the snap too',
                       least=3.0, most=5.0)


def shares_of(parameters: Mapping[str, Any]) -> Array:
    """
    Give where the points of a spline lie within its segment.

    Parameters
    ----------
    parameters : Mapping[str, Any]
        Parameters of the law.

    Returns
    -------
    ndarray, shape (n,)
        Shares of the span, from 0 to 1.

    """
    angles = np.array(parameters['angles_deg'])
    if not angles.size:
        return np.linspace(0.0, 1.0, max(2, len(parameters['positions'])))
    shares: Array = (angles - angles[0]) / (angles[-1] - angles[0])
    return shares


def lift_of(parameters: Mapping[str, Any]) -> float | None:
    """
    Give what a table rises by, free of the rounding of its curve.

    Parameters
    ----------
    parameters : Mapping[str, Any]
        Parameters of the law.

    Returns
    -------
    float | None
        From the first to the last position, in the unit of the axis; None without points, where
        the lift of the segment is free.

    """
    positions = parameters['positions']
    return float(positions[-1] - positions[0]) if positions else None


def spline_curve(parameters: Mapping[str, Any], span: float, ends: Ends,
                 lift: float = 1.0) -> Piecewise:
    """
    Lay the spline of a segment through its points.

    Parameters
    ----------
    parameters : Mapping[str, Any]
        Parameters of the law.
    span : float
        Span of the segment [rad].
    ends : str or tuple[EndState, EndState]
        What is known of its ends, in units of the axis per rad and rad².
    lift : float
        What it rises by where it has no points.

    Returns
    -------
    Piecewise
        The curve over 0 to 1 from 0 on, in the unit of the axis.

    """
    shares = shares_of(parameters)
    positions = np.array(parameters['positions'] or (0.0, lift))
    positions = positions - positions[0]
    if parameters['velocities']:
        accelerations = np.array(parameters['accelerations']) * span**2
        return hermite(shares, positions, np.array(parameters['velocities']) * span,
                       accelerations if accelerations.size else None)
    if not isinstance(ends, str):
        start, end = (EndState(each.velocity * span, each.acceleration * span**2)
                      for each in ends)
        ends = (start, end)
    return interpolate(shares, positions, int(parameters['degree']), ends)


@register(SPLINE, 'spline through the points of a table, which may be a whole cam',
          'C. de Boor, A Practical Guide to Splines (1978), chapter XIII', _POSITIONS, _ANGLES,
          _VELOCITIES, _ACCELERATIONS, _DEGREE,
          *(_end(name) for names in END_STATES for name in names), any_ends=True)
def spline(**parameters: Any) -> Piecewise:
    """
    Build the spline as it is between two dwells, over a span of 1 rad.

    In a cam the neighbours decide about its ends, and as the only segment of a cycle it closes
    on itself, see `cam_motion.motion.points.through_points`.

    Parameters
    ----------
    **parameters : Any
        The table: ``positions``; ``angles_deg``; ``velocities`` and ``accelerations`` at the
        points, with which polynomials of degree 3 or 5 join them; ``degree`` of the spline; and
        ``start_velocity``, ``start_acceleration``, ``end_velocity``, ``end_acceleration``.

    Returns
    -------
    Piecewise
        The curve over 0 to 1, in the unit of the axis, from 0 to its lift (1 without points).

    Raises
    ------
    ConfigurationError
        When the lists do not fit together.

    """
    if problems := _problems(parameters):
        raise ConfigurationError(problems)
    start, end = (EndState(*(parameters[name] or 0.0 for name in names)) for names in END_STATES)
    return spline_curve(parameters, 1.0, (start, end))


def _problems(parameters: Mapping[str, Any]) -> list[Problem]:
    count, angles = len(parameters['positions']), parameters['angles_deg']
    problems = []
    if count == 1:
        problems.append(Problem('positions', list(parameters['positions']),
                                'a spline needs at least 2 points'))
    for given in (_ANGLES, _VELOCITIES, _ACCELERATIONS):
        if parameters[given.name] and len(parameters[given.name]) != count:
            problems.append(Problem(
                given.name, list(parameters[given.name]), f'one value for each of the {count} '
                f'positions: these are {len(parameters[given.name])}'))
    problems += [
        Problem('angles_deg', after, f'angles must rise: point {place + 2} lies at {after:g} deg '
                f'after {before:g} deg', 'put the points in order, each angle once')
        for place, (before, after) in enumerate(zip(angles, angles[1:])) if not after > before
    ][:5]
    if parameters['accelerations'] and not parameters['velocities']:
        problems.append(Problem(
            'accelerations', list(parameters['accelerations']), 'accelerations at the points go '
            'with velocities there', 'give both, or leave both to the spline'))
    if parameters['degree'] not in DEGREES:
        problems.append(Problem('degree', parameters['degree'], _DEGREE.rule))
    told = [name for names in END_STATES for name in names if parameters[name] is not None]
    if parameters['velocities'] and told:
        problems += [Problem(name, parameters[name], 'the lists of velocities and accelerations '
                             'say what happens at the ends', 'leave it out') for name in told]
    elif parameters['degree'] == 3.0:
        problems += [Problem(name, parameters[name], 'the acceleration of a cubic spline follows '
                             'from its points', 'take degree 5, or leave it out')
                     for name in told if name.endswith('acceleration')]
    return problems
