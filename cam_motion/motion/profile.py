# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The cam profile: segments joined over one turn of the shaft, repeated for ever."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
import math
from typing import Any, NamedTuple

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.compiled import compile_periodic_sampler, Sampler
from cam_motion.motion.matching import matched
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import JOINT_TOLERANCE, Jump, Peak, Piecewise
from cam_motion.motion.remedies import conditions_at, ends_asked, laws_instead, to_change
from cam_motion.motion.segment import Segment
from cam_motion.units import DEGREE, TURN
import numpy as np
from numpy.typing import ArrayLike

CLOSURE_TOLERANCE = 1e-9
"""How far the lifts of a returning cycle may miss zero, as a share of the largest lift."""

FULL_CIRCLE_DEG = 360.0


class SegmentPeaks(NamedTuple):
    """
    Signed peaks of one segment per radian of the shaft, and where they occur [rad].

    The jerk is infinite where the acceleration steps, inside the segment or at its ends.
    """

    segment: Segment
    start_deg: float
    velocity: Peak
    acceleration: Peak
    jerk: Peak


class VelocityStepError(ConfigurationError):
    """
    The velocity of a cam steps at a joint, which is the only thing wrong with it.

    Parameters
    ----------
    problems : Iterable[Problem]
        One per step.
    segments : tuple[Segment, ...]
        The segments of the cam.

    """

    def __init__(self, problems: Iterable[Problem], segments: tuple[Segment, ...]) -> None:
        """Keep the segments, for whoever tells more about their joints."""
        super().__init__(problems)
        self.segments = segments


class CamProfile:
    """
    The position of an axis as a function of the shaft angle, y(phi), exact and periodic.

    Over each turn of the shaft y grows by ``advance``: 0 for an axis that returns, the stroke
    for one that accumulates (a belt).

    Segments with the law ``auto`` are joined to their neighbours (`matched`).

    Parameters
    ----------
    segments : Iterable[Segment]
        The segments of one turn, in order; the last one ends at 360 degrees.
    accumulate : bool
        Whether the lifts of one turn may sum to something else than zero.

    Raises
    ------
    ConfigurationError
        When the angles do not rise to 360 degrees, a dwell has a lift or the cycle does not
        close; all problems are listed, their paths relative to the axis.
    VelocityStepError
        When the velocity steps at a joint.

    """

    def __init__(self, segments: Iterable[Segment], accumulate: bool = False) -> None:
        """Join the segments, each starting where the one before has led."""
        self.segments = tuple(segments)
        self.accumulate = accumulate
        if problems := program_problems(self.segments, accumulate):
            raise ConfigurationError(problems)
        self.segments, self.parts = joined(self.segments)
        self.advance = math.fsum(s.lift for s in self.segments) if accumulate else 0.0
        self.curve = Piecewise(
            0.0,
            [piece for part in self.parts for piece in part.pieces],
            [0.0, *(x for part in self.parts for x in part.breaks[1:])],
        )
        if problems := self._velocity_problems():
            raise VelocityStepError(problems, self.segments)

    def __getstate__(self) -> dict[str, Any]:
        """Leave the compiled function out: it is made anew where it is needed."""
        return {key: value for key, value in self.__dict__.items() if key != 'sample'}

    @cached_property
    def sample(self) -> Sampler:
        """
        Evaluate (y, y', y'', y''') at one shaft angle [rad], compiled for speed.

        The angle must be finite: NaN raises ValueError and infinity OverflowError, which costs
        nothing on the hot path; whoever takes angles from outside looks at them before.
        """
        return compile_periodic_sampler(self.curve.breaks, self.curve.pieces, self.advance)

    def __call__(self, phi: ArrayLike, order: int = 0) -> Array:
        """
        Evaluate the profile or one of its derivatives.

        Parameters
        ----------
        phi : array_like, any shape
            Shaft angles, unwrapped [rad].
        order : int
            Order of the derivative with respect to the shaft angle.

        Returns
        -------
        ndarray, shape of phi
            Values, in the unit of the axis per rad^order.

        """
        angles = np.asarray(phi, dtype=float)
        if angles.size and angles.min() >= 0.0 and angles.max() < TURN:
            return self.curve.evaluate(angles, order)
        turns = np.floor(angles / TURN)
        within = np.asarray(turns * -TURN)
        within += angles
        values = self.curve.evaluate(within, order)
        if order == 0 and self.advance:
            values += turns * self.advance
        return values

    def at_speed(self, phi: float, omega: float, alpha: float = 0.0,
                 ) -> tuple[float, float, float]:
        """
        Give the setpoint at a shaft angle while the shaft turns.

        Parameters
        ----------
        phi : float
            Shaft angle, unwrapped [rad].
        omega : float
            Speed of the shaft [rad/s].
        alpha : float
            Acceleration of the shaft [rad/s²].

        Returns
        -------
        tuple[float, float, float]
            Position, velocity y' omega and acceleration y'' omega² + y' alpha, in the unit of
            the axis, per s and per s².

        """
        y, slope, bend, _ = self.sample(phi)
        return y, slope * omega, bend * omega * omega + slope * alpha

    def jumps(self, order: int) -> list[Jump]:
        """
        List the steps of a derivative over one turn, the seam at 0 degrees included.

        Parameters
        ----------
        order : int
            Order of the derivative.

        Returns
        -------
        list[Jump]
            Steps larger than rounding, by rising shaft angle [rad].

        """
        first, last = self.curve.end_values(order)
        if order == 0:
            last -= self.advance
        seam = Jump(0.0, order, first - last)
        jumps = self.curve.jumps(order)
        # as in the curve itself: mostly no peak need be searched for
        pieces = self.curve.differentiated(order).pieces
        some = max(abs(piece.at(0.5 * piece.length)) for piece in pieces)
        if abs(seam.amount) > JOINT_TOLERANCE * some and (
                abs(seam.amount) > JOINT_TOLERANCE * abs(self.curve.peak(order).value)):
            jumps.insert(0, seam)
        return jumps

    @cached_property
    def segment_peaks(self) -> tuple[SegmentPeaks, ...]:
        """Peaks of each segment, exact, with the angle of each."""
        steps = [jump.at for jump in self.jumps(2)]
        found = []
        for each, part in zip(self.segments, self.parts):
            jerk = part.peak(3)
            if part.peak(1).value:
                for at in steps:
                    place = TURN if at == 0.0 and part.end == TURN else at
                    if part.start <= place <= part.end or part.start == at:
                        jerk = Peak(math.inf, place)
                        break
            found.append(SegmentPeaks(
                each, part.start / DEGREE, part.peak(1), part.peak(2), jerk))
        return tuple(found)

    def _velocity_problems(self) -> list[Problem]:
        names = {part.start: n for n, part in enumerate(self.parts)}
        problems = []
        for jump in self.jumps(1):
            n = names.get(jump.at, 0)
            place = to_change(self.segments, n)
            segment = self.segments[place]
            asked = conditions_at(self.segments, self.parts, place)
            problems.append(Problem(
                f'{self.segments[n].name}.law', self.segments[n].law.name,
                'the velocity of a cam must not step: it steps by '
                f'{jump.amount:.6g} per rad at {jump.at / DEGREE:.6g} deg',
                f'give {segment.name} a law that runs {ends_asked(asked)}: '
                + laws_instead(segment, asked)))
        return problems


def joined(segments: Sequence[Segment]) -> tuple[tuple[Segment, ...], tuple[Piecewise, ...]]:
    """
    Join segments, each starting where the one before has led.

    Parameters
    ----------
    segments : Sequence[Segment]
        The segments of one turn; their angles rise.

    Returns
    -------
    tuple[tuple[Segment, ...], tuple[Piecewise, ...]]
        The segments, those with the law ``auto`` matched to their neighbours, and their curves
        over the shaft angle [rad].

    """
    segments = matched(segments)
    parts: list[Piecewise] = []
    start, lifts = 0.0, [0.0]
    for each in segments:
        parts.append(each.law.curve.scaled(start, each.end, each.gain, math.fsum(lifts)))
        start = each.end
        lifts.append(each.lift)
    return segments, tuple(parts)


def program_problems(segments: tuple[Segment, ...], accumulate: bool) -> list[Problem]:
    """
    Check angles and lifts of a program of segments, whatever their laws.

    Parameters
    ----------
    segments : tuple[Segment, ...]
        The segments in order; an angle or lift that is not known is NaN.
    accumulate : bool
        Whether the lifts may sum to something else than zero.

    Returns
    -------
    list[Problem]
        Everything that is wrong, paths relative to the axis.

    """
    return [*_angle_problems(segments), *_lift_problems(segments, accumulate)]


def _angle_problems(segments: tuple[Segment, ...]) -> list[Problem]:
    if not segments:
        return [Problem('segments', [], 'a cam needs at least one segment',
                        'list the names of the segments in order')]
    problems = []
    before = 0.0
    for each in segments:
        path = f'{each.name}.end_deg'
        if not math.isfinite(each.end_deg):
            problems.append(Problem(path, each.end_deg, 'an angle must be a finite number'))
            continue
        if each.end_deg > FULL_CIRCLE_DEG:
            problems.append(Problem(path, each.end_deg, 'a cycle ends at 360 deg'))
        elif each.end_deg <= before:
            problems.append(Problem(
                path, each.end_deg, f'angles must rise: it starts at {before:g} deg',
                'correct the angle or the order of segments'))
        before = max(before, each.end_deg)
    last = segments[-1]
    if last.end_deg < FULL_CIRCLE_DEG:
        problems.append(Problem(
            f'{last.name}.end_deg', last.end_deg, 'the last segment must end at 360 deg',
            'add a dwell that ends at 360.0'))
    return problems


def _lift_problems(segments: tuple[Segment, ...], accumulate: bool) -> list[Problem]:
    problems = [
        Problem(f'{s.name}.lift', s.lift, 'a lift must be a finite number')
        for s in segments if not math.isfinite(s.lift)
    ]
    unknown = bool(problems)
    problems += [
        Problem(f'{s.name}.lift', s.lift, 'a dwell has no lift', 'give the segment a law')
        for s in segments if s.is_dwell and s.lift and math.isfinite(s.lift)
    ]
    if unknown:
        return problems
    total = math.fsum(s.lift for s in segments)
    largest = max((abs(s.lift) for s in segments), default=0.0)
    if not accumulate and abs(total) > CLOSURE_TOLERANCE * largest:
        problems.append(Problem(
            'cycle', 'return', 'the lifts of one cycle must sum to zero: they sum to '
            f'{total:.9g}', 'correct a lift, or write cycle: accumulate for a belt'))
    return problems
