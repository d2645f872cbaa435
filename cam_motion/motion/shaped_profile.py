# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A cam behind a filter: a profile like any other, made for one speed."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import NamedTuple

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws import LAWS, make_law
from cam_motion.motion.piecewise import JOINT_TOLERANCE, Piecewise
from cam_motion.motion.profile import CamProfile, FULL_CIRCLE_DEG
from cam_motion.motion.segment import Segment
from cam_motion.motion.shaping import CamFilter, Polydyne
from cam_motion.motion.superposition import window
from cam_motion.units import DEGREE, TURN


class Movement(NamedTuple):
    """
    Segments between two dwells: their names, and where they begin and end [rad].

    One that passes 360 degrees ends beyond one turn; an axis that never stands has one of a
    whole turn.
    """

    segments: tuple[str, ...]
    start: float
    end: float


def movements(profile: CamProfile) -> list[Movement]:
    """
    List the movements of a cam.

    Parameters
    ----------
    profile : CamProfile
        The cam.

    Returns
    -------
    list[Movement]
        In the order in which they begin.

    """
    found: list[Movement] = []
    start, moving = 0.0, False
    for each in profile.segments:
        if not each.is_dwell and moving:
            found[-1] = Movement((*found[-1].segments, each.name), found[-1].start, each.end)
        elif not each.is_dwell:
            found.append(Movement((each.name,), start, each.end))
        start, moving = each.end, not each.is_dwell
    if moving and len(found) > 1 and found[0].start == 0.0:
        first, last = found.pop(0), found.pop()
        found.append(Movement(
            (*last.segments, *first.segments), last.start, first.end + TURN))
    return found


class ShapedProfile(CamProfile):
    """
    A cam behind a filter.

    Its segments keep their names and angles; in a dwell it may still move, as a shaped movement
    ends later than the movement that it is made of.

    Parameters
    ----------
    original : CamProfile
        The cam.
    made : CamFilter
        The filter.
    speed : float
        Speed of the cam for which it is shaped [rad/s]; above 0.
    fit : bool
        Whether the movements are shortened first, so that shaped they begin and end where their
        segments do.

    Attributes
    ----------
    original, filter, speed, fit
        As given.
    shortened : CamProfile
        What the filter is applied to: the cam, its movements shortened for `fit`.

    Raises
    ------
    ConfigurationError
        When the cam is not smooth enough for the filter, or a movement too short to be
        shortened; paths relative to the axis.

    """

    def __init__(self, original: CamProfile, made: CamFilter, speed: float,
                 fit: bool = False) -> None:
        """Shape the cam."""
        self.original, self.filter, self.speed, self.fit = original, made, speed, fit
        if isinstance(made, Polydyne):
            _check_smooth(original)
        self.shortened = _shortened(original, made.duration * speed) if fit else original
        self.segments = original.segments
        self.accumulate, self.advance = original.accumulate, original.advance
        self.curve = made.applied(self.shortened, speed)
        ends = [0.0, *(each.end for each in self.segments)]
        ends[-1] = TURN
        self.parts = tuple(
            window(self.curve, self.advance, low, high) for low, high in zip(ends, ends[1:]))

    def shaping(self, other: CamProfile) -> ShapedProfile:
        """
        Shape another cam in the same way.

        Parameters
        ----------
        other : CamProfile
            The other cam.

        Returns
        -------
        ShapedProfile
            It behind the same filter.

        Raises
        ------
        ConfigurationError
            See the class.

        """
        return ShapedProfile(other, self.filter, self.speed, self.fit)


@cache
def smooth_laws() -> tuple[str, ...]:
    """
    List the laws from rest to rest that are smooth enough for `Polydyne`.

    Returns
    -------
    tuple[str, ...]
        Names of those whose jerk does not step, in the order of the registry.

    """
    return tuple(name for name, law in LAWS.items()
                 if name != 'dwell' and not law.any_ends and _is_smooth(make_law(name).curve))


def _is_smooth(curve: Piecewise) -> bool:
    """Tell whether a law between two dwells has no step up to its jerk."""
    for order in (1, 2, 3):
        scale = JOINT_TOLERANCE * abs(curve.peak(order).value)
        if curve.jumps(order) or any(abs(end) > scale for end in curve.end_values(order)):
            return False
    return True


def _check_smooth(profile: CamProfile) -> None:
    steps = profile.jumps(2) + profile.jumps(3)
    if steps:
        first = steps[0]
        what = ('acceleration', 'jerk')[first.order - 2]
        raise ConfigurationError([Problem(
            'shaping.kind', 'polydyne', f'the {what} of the cam steps at '
            f'{first.at / DEGREE:.6g} deg: the velocity of the compensated cam would step',
            'take a shaper (zv, zvd, zvdd, ei), or laws whose jerk is continuous: '
            + ', '.join(smooth_laws()))])


def _shortened(profile: CamProfile, length: float) -> CamProfile:
    """Shorten each movement by the length of a shaper [rad], the dwell behind it begins sooner."""
    moving = movements(profile)
    problems = [
        Problem('shaping.fit', True, f'the movement {"+".join(each.segments)} spans '
                f'{(each.end - each.start) / DEGREE:.6g} deg, the shaper takes '
                f'{length / DEGREE:.6g} deg of it at its speed',
                'run slower, give the movement more angle, take a shorter shaper, or leave fit '
                'out')
        for each in moving if each.end - each.start <= length * (1.0 + 1e-9)]
    if any(each.end > TURN for each in moving) or all(
            not each.is_dwell for each in profile.segments):
        problems.append(Problem(
            'shaping.fit', True, 'the cam must stand at 0 deg, or somewhere at least',
            'begin the cycle in a dwell, or leave fit out'))
    if problems:
        raise ConfigurationError(problems)
    by_name = {name: each for each in moving for name in each.segments}
    segments = []
    for each in profile.segments:
        movement = by_name.get(each.name)
        if movement is not None:
            share = 1.0 - length / (movement.end - movement.start)
            end = movement.start + (each.end - movement.start) * share
            each = replace(each, end_deg=end / DEGREE)
        segments.append(each)
    if segments[-1].end_deg < FULL_CIRCLE_DEG:
        segments.append(Segment('', make_law('dwell'), FULL_CIRCLE_DEG))
    return CamProfile(segments, profile.accumulate)
