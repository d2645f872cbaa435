# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A movement to advise upon: part of a cam, or described on its own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from cam_motion.drive.inverse import FollowerDrive
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws import Boundary, make_law, MotionLaw
from cam_motion.motion.laws.fitted import Conditions, EndCondition, scaled_condition
from cam_motion.motion.limits import Limits
from cam_motion.motion.matching import shaped_with
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import Segment
from cam_motion.motion.shaped_profile import ShapedProfile
from cam_motion.motion.shaping_effect import Load
from cam_motion.motion.spline import EndState
from cam_motion.runtime.layout import Layout
from cam_motion.units import DEGREE, RPM

_STILL = EndState()


@dataclass(frozen=True)
class Question:
    """
    A movement to advise upon.

    Attributes
    ----------
    name : str
        What it is called: ``feeder.feed``.
    unit : str
        Unit of its axis.
    lift : float
        What it moves by, the scale of the cam included, in the unit of the axis.
    start_deg, end_deg : float
        Where on the cam [deg].
    speed : float
        Speed of the cam [rad/s]; above 0.
    ends : tuple[Boundary, Boundary]
        What its neighbours do where they meet it.
    profile : CamProfile | None
        The cam; None for a movement on its own that does not go from rest to rest.
    shaft_speed : float
        Speed of the shaft [rad/s]; above 0.
    index : int
        Place of its segment among those of the cam.
    scale : float
        What the lifts of the cam are multiplied by [-].
    limits : Limits
        Limits of the axis.
    layout : Layout | None
        All cams of the axis and how they are coupled.
    cam : str
        Which of them this is.
    load : Load | None
        What swings behind the axis.
    drive : FollowerDrive | None
        What moves it.
    configured : MotionLaw | None
        The law that it has now.
    asked : tuple[EndCondition, EndCondition] | None
        What its neighbours do, where there is no cam to tell it [lifts and spans].

    """

    name: str
    unit: str
    lift: float
    start_deg: float
    end_deg: float
    speed: float
    ends: tuple[Boundary, Boundary]
    profile: CamProfile | None
    shaft_speed: float
    index: int = 0
    scale: float = 1.0
    limits: Limits = Limits()
    load: Load | None = None
    drive: FollowerDrive | None = None
    configured: MotionLaw | None = None
    layout: Layout | None = None
    cam: str = ''
    asked: Conditions | None = None

    @property
    def duration(self) -> float:
        """How long it lasts [s]."""
        return (self.end_deg - self.start_deg) * DEGREE / self.speed

    @property
    def bare_cam(self) -> CamProfile | None:
        """Give the cam before any filter."""
        cam = self.profile
        return cam.original if isinstance(cam, ShapedProfile) else cam

    @cached_property
    def conditions(self) -> Conditions | None:
        """
        Tell what its neighbours do where they meet it; None where it is not known.

        In lifts and spans of it. Of a neighbour that takes its shape from this movement it is what
        it does now.
        """
        cam = self.bare_cam
        if cam is None:
            return self.asked
        part, lift = cam.parts[self.index], cam.segments[self.index].lift
        span = part.end - part.start
        before, after = (cam.parts[(self.index + step) % len(cam.parts)] for step in (-1, 1))
        start, end = (
            scaled_condition(each.end_values(1)[side], each.end_values(2)[side], span, lift)
            for each, side in ((before, 1), (after, 0)))
        return start, end

    @cached_property
    def covered(self) -> tuple[int, ...]:
        """Places of the segments whose curves follow from its law, itself among them."""
        cam = self.bare_cam
        return (self.index,) if cam is None else shaped_with(cam.segments, self.index)

    @property
    def names_beside(self) -> tuple[str, ...]:
        """Names of the other segments that are `covered`."""
        cam = self.bare_cam
        return () if cam is None else tuple(
            cam.segments[place].name for place in self.covered if place != self.index)

    def cam_with(self, law: MotionLaw) -> CamProfile | None:
        """
        Put a law into the movement, the rest of the cam as it is.

        Parameters
        ----------
        law : MotionLaw
            The law.

        Returns
        -------
        CamProfile | None
            The cam, shaped if it is; None for a movement that has no cam.

        Raises
        ------
        ConfigurationError
            When the law does not fit its neighbours, or the filter.

        """
        cam = self.profile
        if cam is None or law is self.configured:
            return cam
        bare = self.bare_cam
        assert bare is not None
        segments = list(bare.segments)
        segments[self.index] = replace(segments[self.index], law=law)
        changed = CamProfile(segments, bare.accumulate)
        return cam.shaping(changed) if isinstance(cam, ShapedProfile) else changed


def movement(lift: float, span_deg: float, speed_cpm: float,
             ends: tuple[Boundary, Boundary] = (Boundary.REST, Boundary.REST),
             load: Load | None = None, unit: str = 'm',
             start: EndState = _STILL, end: EndState = _STILL) -> Question:
    """
    Describe a movement on its own.

    Parameters
    ----------
    lift : float
        What it moves by, in its unit.
    span_deg : float
        Over which angle [deg], above 0 and at most 360.
    speed_cpm : float
        Speed of the cam [cycles/min]; above 0.
    ends : tuple[Boundary, Boundary]
        What is before and behind it.
    load : Load | None
        What swings behind it.
    unit : str
        Its unit.
    start, end : EndState
        Velocity and acceleration of what is before and behind it [unit/s, unit/s²], as `ends`
        says: the velocity where that moves, both where it is in motion. At a turn without an
        acceleration its neighbour has that of the law.

    Returns
    -------
    Question
        The movement.

    Raises
    ------
    ConfigurationError
        When what is said of an end contradicts its kind; paths are those of the command line.

    """
    problems = [problem for name, kind, state in zip(('start', 'end'), ends, (start, end))
                for problem in _end_problems(name, kind, state)]
    if problems:
        raise ConfigurationError(problems)
    profile, asked = None, None
    speed = speed_cpm * RPM
    if ends == (Boundary.REST, Boundary.REST):
        segments = [Segment('movement', make_law('polynomial_345'), span_deg, lift)]
        if span_deg < 360.0:
            segments.append(Segment('dwell', make_law('dwell'), 360.0))
        profile = CamProfile(segments, accumulate=True)
    else:
        first, last = (
            EndCondition(0.0) if kind is Boundary.TURN and not state.acceleration else
            scaled_condition(*state, span_deg * DEGREE / speed, lift)
            for kind, state in zip(ends, (start, end)))
        asked = (first, last)
    return Question('movement', unit, lift, 0.0, span_deg, speed, ends, profile, speed, load=load,
                    asked=asked)


def _end_problems(name: str, kind: Boundary, state: EndState) -> list[Problem]:
    """Compare what is said of an end with its kind."""
    told = kind.value.replace(' ', '_')
    problems = []
    if kind.moves and not state.velocity:
        problems.append(Problem(
            f'--{name}-velocity', state.velocity, f'must be given, not zero, with --{name} {told}',
            'say how fast its neighbour is where they meet, in its unit per s'))
    if not kind.moves and state.velocity:
        problems.append(Problem(
            f'--{name}-velocity', state.velocity, f'must be zero with --{name} {told}',
            f'leave it out, or --{name}'))
    if kind is Boundary.MOTION and not state.acceleration:
        problems.append(Problem(
            f'--{name}-acceleration', state.acceleration,
            f'must be given, not zero, with --{name} {told}',
            f'without one it is --{name} constant_velocity'))
    if kind in (Boundary.REST, Boundary.CONSTANT_VELOCITY) and state.acceleration:
        problems.append(Problem(
            f'--{name}-acceleration', state.acceleration, f'must be zero with --{name} {told}',
            f'leave it out, or --{name}'))
    return problems
