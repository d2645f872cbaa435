# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The two commonest linkages, described for the solver that solves all of them."""

from __future__ import annotations

import cmath
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.mechanism.linkage import Body, Linkage, Loop, Point, Transmission, Vector

_QUARTER = 0.25 * math.tau


def four_bar(crank: float, coupler: float, rocker: float, frame: float,
             crossed: bool = False, start: float = math.pi / 3.0) -> Linkage:
    """
    Describe a four-bar linkage.

    Parameters
    ----------
    crank, coupler, rocker, frame : float
        Lengths [m]; the frame lies along x.
    crossed : bool
        Whether it is assembled crossed, the coupler's end below the line from the crank's end
        to the rocker's pivot.
    start : float
        Angle of the crank at the start [rad].

    Returns
    -------
    Linkage
        Input theta2 (crank), unknowns theta3 (coupler) and theta4 (rocker); points O2, A, B, O4.

    Raises
    ------
    ConfigurationError
        When it cannot be assembled at the start.

    """
    diagonal = frame - cmath.rect(crank, start)
    distance = abs(diagonal)
    if not abs(coupler - rocker) < distance < coupler + rocker:
        raise ConfigurationError([Problem(
            'start', start, f'coupler and rocker do not meet over {distance:.6g} m',
            'start at another angle of the crank')])
    corner = math.acos((distance ** 2 + coupler ** 2 - rocker ** 2) / (2.0 * distance * coupler))
    theta3 = cmath.phase(diagonal) + (-corner if crossed else corner)
    theta4 = cmath.phase(cmath.rect(coupler, theta3) - diagonal)
    return Linkage(
        'four_bar',
        bodies=(Body('crank', 'theta2'), Body('coupler', 'theta3'), Body('rocker', 'theta4')),
        vectors=(Vector('r2', crank, 'crank'), Vector('r3', coupler, 'coupler'),
                 Vector('r4', rocker, 'rocker'), Vector('r1', frame)),
        loops=(Loop('four_bar_loop', ('r2', 'r3', '-r4', '-r1')),),
        points=(Point('O2'), Point('A', ('r2',), 'O2'), Point('B', ('r3',), 'A'),
                Point('O4', ('-r4',), 'B')),
        inputs=('theta2',), unknowns=('theta3', 'theta4'),
        start={'theta2': start, 'theta3': theta3, 'theta4': theta4},
        transmissions=(Transmission('rocker_angle', ('r3',), ('r4',)),))


def slider_crank(crank: float, rod: float, offset: float = 0.0,
                 start: float = math.pi / 3.0) -> Linkage:
    """
    Describe a slider-crank whose slider lies on the side of positive x.

    Parameters
    ----------
    crank, rod : float
        Lengths [m].
    offset : float
        Height of the slide above the crank's pivot [m].
    start : float
        Angle of the crank at the start [rad].

    Returns
    -------
    Linkage
        Input theta2 (crank), unknowns theta3 (rod, from crank to slider) and x (slider, from
        the crank's pivot); points O, A and B. The transmission angle is that between the rod
        and the normal of the slide.

    Raises
    ------
    ConfigurationError
        When it cannot be assembled at the start.

    """
    rise = offset - crank * math.sin(start)
    if not abs(rise) < rod:
        raise ConfigurationError([Problem(
            'start', start, f'the rod does not bridge {abs(rise):.6g} m',
            'start at another angle of the crank')])
    theta3 = math.asin(rise / rod)
    vectors = [Vector('r2', crank, 'crank'), Vector('r3', rod, 'rod'), Vector('slide', 'x'),
               Vector('normal', rod, turn=_QUARTER)]
    path = ['r2', 'r3', '-slide']
    if offset:
        vectors.append(Vector('offset', abs(offset), turn=math.copysign(_QUARTER, offset)))
        path.append('-offset')
    return Linkage(
        'slider_crank', bodies=(Body('crank', 'theta2'), Body('rod', 'theta3')),
        vectors=tuple(vectors), loops=(Loop('crank_loop', tuple(path)),),
        points=(Point('O'), Point('A', ('r2',), 'O'), Point('B', ('r3',), 'A')),
        inputs=('theta2',), unknowns=('theta3', 'x'),
        start={'theta2': start, 'theta3': theta3,
               'x': crank * math.cos(start) + rod * math.cos(theta3)},
        transmissions=(Transmission('slider_angle', ('r3',), ('normal',)),))
