# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The best B-spline under an objective and limits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws import MotionLaw
from cam_motion.motion.optimal import check_objective, Demands, Load, PEAKS, ROOTS
from cam_motion.motion.spline_programme import SplineProgramme, Tell
from cam_motion.motion.spline_space import Space

INTERVALS = 24
"""Intervals of the spline unless told: a number that 2, 3, 4, 6, 8 and 12 divide."""

MOST_INTERVALS = 120
_HIGHEST_DEGREE = 9

_NEEDED = {'peak_velocity': 0, 'peak_torque': 1, 'rms_torque': 1,
           **{name: order - 1 for name, order in (*PEAKS.items(), *ROOTS.items())}}


def best_spline(weights: Mapping[str, float], demands: Demands, load: Load | None = None,
                intervals: int = INTERVALS, degree: int | None = None,
                tell: Tell = lambda done, total: None) -> MotionLaw:
    """
    Find the B-spline that is best by an objective within limits.

    Parameters
    ----------
    weights : Mapping[str, float]
        Weight of each figure to minimise, see `cam_motion.motion.optimal.OBJECTIVES`.
    demands : Demands
        Limits, ends and continuity; an objective of a higher derivative asks for more.
    load : Load | None
        The load, for torques.
    intervals : int
        Number of equal intervals.
    degree : int | None
        Degree of the pieces; None takes the one that the theory of the objective asks for.
    tell : Callable[[int, int], None]
        Hears of the progress.

    Returns
    -------
    MotionLaw
        The law `b_spline` with the coefficients found. Its limits are kept between the points
        of the programme as well.

    Raises
    ------
    ConfigurationError
        When no such curve keeps the limits, or what is asked makes no sense.

    Notes
    -----
    All limits and peaks are linear in the coefficients at any point, so a peak is minimised by a
    linear programme (HiGHS) and an RMS value by a quadratic one (Lawson and Hanson's reduction
    to non-negative least squares). Where a derivative is no straight line between knots, the
    exact extremes of each solution become further points until none breaks a limit. What a peak
    leaves free is settled by the least RMS jerk. Sums that mix both kinds are left to sequential
    quadratic programming, from the solution without the peaks.

    Without limits the least peak of a derivative of order k belongs to pieces of degree k, the
    least RMS value to pieces of degree 2 k - 1.

    References
    ----------
    C. L. Lawson, R. J. Hanson, Solving Least Squares Problems (1974), chapter 23.
    R. Hettich, K. O. Kortanek, Semi-infinite programming, SIAM Review 35 (1993): exchange.

    """
    check_objective(weights, load)
    demands = raised(demands, weights)
    if problems := demands.problems():
        raise ConfigurationError(problems)
    if degree is None:
        degree = natural_degree(weights, demands)
    least = max([demands.continuity + 1, *demands.limits, *(
        {**PEAKS, **ROOTS}.get(name, 2) for name in weights)])
    if not least <= degree <= _HIGHEST_DEGREE:
        raise ConfigurationError([Problem(
            'degree', degree, f'must be from {least} to 9 for this objective and continuity')])
    if not 2 <= intervals <= MOST_INTERVALS or intervals + degree < 2 * demands.continuity + 3:
        raise ConfigurationError([Problem(
            'intervals', intervals, f'must be from {max(2, 2 * demands.continuity + 3 - degree)} '
            f'to {MOST_INTERVALS}')])
    programme = SplineProgramme(Space.meeting(demands, degree, intervals), weights, demands, load)
    return programme.solve(tell)


def raised(demands: Demands, weights: Mapping[str, float]) -> Demands:
    """
    Raise the continuity to what objective and limits need to be finite.

    Parameters
    ----------
    demands : Demands
        What was asked.
    weights : Mapping[str, float]
        The objective.

    Returns
    -------
    Demands
        The same with continuity k where a derivative of order k + 1 shall be small; rising
        where a torque is to be minimised, as the load knows one direction only.

    """
    needed = max([demands.continuity, *(order - 1 for order in demands.limits),
                  *(_NEEDED[name] for name in weights)])
    torque = any(name.endswith('torque') for name in weights)
    return replace(demands, continuity=needed, rising=demands.rising or torque)


def natural_degree(weights: Mapping[str, float], demands: Demands) -> int:
    """
    Choose the degree that an objective asks for.

    Parameters
    ----------
    weights : Mapping[str, float]
        The objective.
    demands : Demands
        Limits and continuity.

    Returns
    -------
    int
        The degree of the pieces of the best curve there is.

    """
    wanted = [demands.continuity + 1, *demands.limits]
    wanted += [PEAKS[name] for name in weights if name in PEAKS]
    wanted += [2 * ROOTS[name] - 1 for name in weights if name in ROOTS]
    wanted += [3 if name == 'rms_torque' else 2 for name in weights if name.endswith('torque')]
    return max(wanted)
