# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The shaft angle cut into elements, and the load of a cam drive at their Gauss points."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property

from cam_motion.drive.cam_drive import CamDrive, Element, POINTS, SHORTEST
from cam_motion.drive.collocation import gauss_rule
from cam_motion.drive.load import Follower, Terms
from cam_motion.motion.piece import Array
import numpy as np


@dataclass(frozen=True)
class Course:
    """
    Consecutive elements of the shaft angle, and the load on them.

    Attributes
    ----------
    drive : CamDrive
        The drive.
    elements : tuple[Element, ...]
        The n elements.
    terms : Terms
        J, C, Q0 and Q1 at the beginning, the Gauss points and the end of each, each of shape
        (n, points + 2).
    cuts : tuple[float, ...]
        Those angles between elements at which the power in the gearbox reverses [rad].
    uncut : Course or None
        The course without these cuts; None where there are none.

    """

    drive: CamDrive
    elements: tuple[Element, ...]
    terms: Terms
    cuts: tuple[float, ...] = ()
    uncut: Course | None = None

    @classmethod
    def over(cls, drive: CamDrive, elements: tuple[Element, ...]) -> Course:
        """
        Look up the load on elements.

        Parameters
        ----------
        drive : CamDrive
            The drive.
        elements : tuple[Element, ...]
            The elements.

        Returns
        -------
        Course
            Without cuts.

        """
        return cls(drive, elements, _terms(drive, [(e, _angles((e,))) for e in elements]))

    @cached_property
    def spans(self) -> Array:
        """Measure the elements [rad], shape (n, 1)."""
        return np.array([[e.end - e.start] for e in self.elements])

    @cached_property
    def angles(self) -> Array:
        """List the shaft angles of the terms [rad], shape (n, points + 2)."""
        return _angles(self.elements)

    def split_at(self, places: Sequence[float]) -> Course:
        """
        Split elements further.

        Parameters
        ----------
        places : Sequence[float]
            Shaft angles [rad], in order; those at an end of an element change nothing.

        Returns
        -------
        Course
            The course of the smaller elements.

        """
        elements: list[Element] = []
        rows: list[int] = []
        fresh: list[tuple[Element, Array]] = []
        count = len(self.elements)
        for row, whole in enumerate(self.elements):
            ends = [whole.start]
            for place in places:
                if ends[-1] + SHORTEST < place < whole.end - SHORTEST:
                    ends.append(place)
            if len(ends) == 1:
                elements.append(whole)
                rows.append(row)
                continue
            parts = [Element(start, end, whole.piece)
                     for start, end in zip(ends, [*ends[1:], whole.end])]
            elements += parts
            rows += range(count, count + len(parts))
            count += len(parts)
            fresh.append((whole, _angles(parts)))
        if not fresh:
            return self
        pairs = zip(self.terms, _terms(self.drive, fresh))
        return Course(self.drive, tuple(elements),
                      Terms(*(np.concatenate(pair)[rows] for pair in pairs)))

    def cut_at(self, cuts: Sequence[float]) -> Course:
        """
        Split elements where the power in the gearbox reverses.

        Parameters
        ----------
        cuts : Sequence[float]
            Shaft angles [rad], in order.

        Returns
        -------
        Course
            The course with these cuts only.

        """
        uncut = self.uncut or self
        return replace(uncut.split_at(cuts), cuts=tuple(cuts), uncut=uncut) if cuts else uncut

    def rows(self) -> Iterator[Course]:
        """
        Take the course apart.

        Yields
        ------
        Course
            Each element as a course of its own.

        """
        for row, element in enumerate(self.elements):
            yield Course(self.drive, (element,), Terms(*(t[row:row + 1] for t in self.terms)))

    def steady(self, half_square: float) -> Array:
        """
        Give the energies at constant speed, as a guess.

        Parameters
        ----------
        half_square : float
            Half of the speed squared [rad²/s²].

        Returns
        -------
        ndarray, shape (n, points)
            Kinetic energies [J].

        """
        energies: Array = half_square * self.terms.inertia[:, 1:-1]
        return energies


@cache
def _nodes(points: int) -> Array:
    return np.concatenate([[0.0], gauss_rule(points).points, [1.0]])


def _angles(elements: Sequence[Element]) -> Array:
    """Place the ends and Gauss points of elements."""
    starts, ends = (np.array(column)[:, None] for column in list(zip(*elements))[:2])
    angles: Array = starts + (ends - starts) * _nodes(POINTS)
    return angles


def _terms(drive: CamDrive, places: Sequence[tuple[Element, Array]]) -> Terms:
    """Look up the load at angles within elements."""
    at = [drive.follower(element, q) for element, q in places]
    return drive.terms(Follower(*map(np.concatenate, zip(*at))))
