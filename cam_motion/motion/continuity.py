# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The compile check: how smoothly a cam runs through each joint of its segments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
import math
import sys

from cam_motion.motion.piece import Piece
from cam_motion.motion.piecewise import JOINT_TOLERANCE, Piecewise
from cam_motion.motion.profile import CamProfile, joined
from cam_motion.motion.segment import Segment

HIGHEST_ORDER = 6
"""Highest derivative looked at: one that steps further up is of no consequence to a machine."""

_ROUNDING = 64.0 * sys.float_info.epsilon
_AMPLIFIED = 4.0  # rounding in a fitted curve, by each differentiation, per length of a piece
_SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)  # of a piece, where its size is read


@dataclass(frozen=True)
class Joint:
    """
    How a curve passes a joint.

    Attributes
    ----------
    at : float
        Abscissa, of a cam the shaft angle [rad].
    order : int | None
        Order of the first derivative that steps there; None where none steps, up to
        `HIGHEST_ORDER`.
    step : float
        By how much it steps, from left to right [unit/rad^order]; 0 where none does.

    """

    at: float
    order: int | None = None
    step: float = 0.0

    @property
    def continuity(self) -> int:
        """Give k of the continuity class Ck; `HIGHEST_ORDER` where nothing steps."""
        return HIGHEST_ORDER if self.order is None else self.order - 1

    @property
    def label(self) -> str:
        """Write the class: ``C1`` where the acceleration steps, ``C6+`` where nothing does."""
        return f'C{HIGHEST_ORDER}+' if self.order is None else f'C{self.continuity}'

    def step_at(self, omega: float) -> float:
        """
        Give the step as it is in time.

        Parameters
        ----------
        omega : float
            Shaft speed [rad/s].

        Returns
        -------
        float
            The step [unit/s^order].

        """
        # a product overflows to infinity, a power to an exception
        return self.step * math.prod([omega] * (self.order or 0))


@dataclass(frozen=True)
class ProgramJoint:
    """
    A joint between two segments, and what lies inside the second of them.

    Attributes
    ----------
    before, after : Segment
        The segments that meet; over the end of the cycle the last one and the first.
    joint : Joint
        How they meet; the end of the cycle is at the angle 0.
    inside : Joint | None
        The least smooth joint inside the segment ``after``; None where its law is one piece.

    """

    before: Segment
    after: Segment
    joint: Joint
    inside: Joint | None


@dataclass(frozen=True)
class Continuity:
    """
    How smoothly a program of segments runs.

    Attributes
    ----------
    joints : tuple[ProgramJoint, ...]
        One per segment, at its start.

    """

    joints: tuple[ProgramJoint, ...]

    @property
    def weakest(self) -> Joint:
        """Find the least smooth joint of the cam, those inside segments included."""
        found = [joint for each in self.joints for joint in (each.joint, each.inside)
                 if joint is not None]
        return min(found, key=lambda joint: (joint.continuity, joint.at))

    @property
    def label(self) -> str:
        """Write the class of the whole cam."""
        return self.weakest.label


def continuity_of(profile: CamProfile) -> Continuity:
    """
    Judge every joint of a cam.

    Parameters
    ----------
    profile : CamProfile
        The cam.

    Returns
    -------
    Continuity
        The joints, by rising angle from 0 on.

    """
    return _judge(profile.segments, profile.parts, profile.advance)


def program_continuity(segments: Sequence[Segment]) -> Continuity:
    """
    Judge every joint of a program of segments, also of one whose velocity steps.

    Parameters
    ----------
    segments : Sequence[Segment]
        The segments of one turn; angles rise to 360 degrees. `CamProfile` refuses them where
        the velocity steps, this function says where and how much.

    Returns
    -------
    Continuity
        The joints, by rising angle from 0 on.

    """
    matched, parts = joined(segments)
    return _judge(matched, parts, math.fsum(each.lift for each in segments))


def curve_joints(curve: Piecewise, advance: float | None = None) -> list[Joint]:
    """
    Judge every joint inside a curve.

    Parameters
    ----------
    curve : Piecewise
        The curve.
    advance : float | None
        What it gains in each cycle, where it repeats itself: then its seam is a joint, too.

    Returns
    -------
    list[Joint]
        The seam, at the start, and one per inner joint, from left to right.

    """
    scales = _scales(curve)
    seam = [] if advance is None else [_joint(
        curve.pieces[-1], curve.pieces[0], curve.start, scales, scales, advance)]
    return seam + [_joint(left, right, at, scales, scales)
                   for left, right, at in zip(curve.pieces, curve.pieces[1:], curve.breaks[1:])]


def _judge(segments: Sequence[Segment], parts: Sequence[Piecewise], advance: float) -> Continuity:
    scales = [_scales(part) for part in parts]
    joints = []
    for n, (segment, part) in enumerate(zip(segments, parts)):
        joint = _joint(parts[n - 1].pieces[-1], part.pieces[0], part.start, scales[n - 1],
                       scales[n], 0.0 if n else advance)
        inside = min(curve_joints(part), key=lambda each: each.continuity, default=None)
        joints.append(ProgramJoint(segments[n - 1], segment, joint, inside))
    return Continuity(tuple(joints))


def _joint(left: Piece, right: Piece, at: float, left_scales: Sequence[float],
           right_scales: Sequence[float], advance: float = 0.0) -> Joint:
    """
    Find the first derivative that steps between two pieces.

    A step counts as rounding up to the sum of two bounds. One is what rounding can do: the error
    of evaluating a piece at its end, a few times the machine precision times the sum of the
    magnitudes of its terms, and that of its coefficients, which come from values as large as the
    travel over a piece as short as this. The other is `JOINT_TOLERANCE` of the derivative's own
    size in the segments that meet: numbers in a file have that many digits, and a step so much
    smaller than what happens beside it is not felt. A steep segment elsewhere hides nothing.
    """
    noise = [left_scales[0], right_scales[0]]
    for order, scales in enumerate(zip(left_scales, right_scales)):
        step = right.at(0.0) - left.at(left.length) + (0.0 if order else advance)
        rounding = sum(noise) + _magnitude(left, left.length) + _magnitude(right, 0.0)
        if abs(step) > JOINT_TOLERANCE * max(scales) + _ROUNDING * rounding:
            return Joint(at, order, step)
        noise = [each * _AMPLIFIED / piece.length for each, piece in zip(noise, (left, right))]
        left, right = left.derivative, right.derivative
    return Joint(at)


def _scales(curve: Piecewise) -> list[float]:
    """Give about the largest magnitude of each derivative; of the curve itself its travel."""
    pieces = list(curve.pieces)
    scales = []
    for order in range(HIGHEST_ORDER + 1):
        values = [piece.at(share * piece.length) for piece in pieces for share in _SHARES]
        scales.append(max(map(abs, values)) if order else max(values) - min(values))
        pieces = [piece.derivative for piece in pieces]
    return scales


def _magnitude(piece: Piece, u: float) -> float:
    """Sum the magnitudes of the terms of a piece, by which rounding grows."""
    total = 0.0
    for coefficient in reversed(piece.coefficients):
        total = total * u + abs(coefficient)
    return total + sum((abs(cosine) + abs(sine)) * (1.0 + omega * u)
                       for omega, cosine, sine in piece.waves)
