# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The motion of a cam drive over many elements of the shaft angle, found at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

from cam_motion.drive.collocation import gauss_rule, spread, tail
from cam_motion.drive.course import Course
from cam_motion.drive.stretch import Stretch
from cam_motion.motion.piece import Array
import numpy as np

_STEPS = 60
_LINEAR = 1e-7  # relative; the squares of changes as small as this are rounding
_RUNAWAY = 1e4  # times the greatest energy guessed: no motor is meant for that
_DENSE = 33  # places in an element among which reversals of power are looked for
_NO_SLIP = 1e-9  # share of the synchronous speed that counts as being there
_PLACED = 1e-7  # a cut misplaced by this [rad] changes the energy by its square only
_ROUGH = 2e-8  # last terms of Q by the energy that leave less than 1e-10 between the points
_REFINEMENTS = 12
_FARTHEST = 0.1  # a cut is foreseen to move at most so far [rad]
_LEAST_SHARE = 0.1  # of the energy known nearby, below which no guess goes


@dataclass(frozen=True)
class Passage:
    """
    The motion over a course.

    Attributes
    ----------
    course : Course
        The course.
    starts : ndarray, shape (n + 1,)
        Kinetic energy at the beginning of each element, and at the end of the last [J].
    energies, powers : ndarray, shape (n, points)
        Kinetic energy [J] and Q(q, w), motor included [N m], at the Gauss points.
    slopes : ndarray, shape (n, points)
        Derivative of Q with respect to E at the Gauss points [1/rad].
    shares, inner_shares : ndarray, shape (n + 1,) and (n, points)
        Derivatives of ``starts`` and ``energies`` with respect to the first energy [-].

    """

    course: Course
    starts: Array
    energies: Array
    powers: Array
    slopes: Array
    shares: Array
    inner_shares: Array

    @property
    def multiplier(self) -> float:
        """Give by how much a disturbance of the energy is multiplied on the way [-]."""
        return float(self.shares[-1])

    @cached_property
    def speeds(self) -> Array:
        """Give the speeds at both ends and the Gauss points [rad/s], shape (n, points + 2)."""
        energies = np.hstack([self.starts[:-1, None], self.energies, self.starts[1:, None]])
        speeds: Array = np.sqrt(2.0 * energies / self.course.terms.inertia)
        return speeds

    def beside(self, first: float) -> Passage | None:
        """
        Give the motion from another energy on that is the same but for a small change.

        Parameters
        ----------
        first : float
            Kinetic energy at the beginning [J].

        Returns
        -------
        Passage or None
            The motion; None where the change is so large that its square counts.

        """
        more = first - float(self.starts[0])
        if not abs(more) < _LINEAR * first:
            return None
        change = self.inner_shares * more
        return replace(self, starts=self.starts + self.shares * more,
                       energies=self.energies + change, powers=self.powers + self.slopes * change)

    def stretches(self, time: float) -> tuple[Stretch, ...]:
        """
        Give the motion element by element.

        Parameters
        ----------
        time : float
            When it begins [s].

        Returns
        -------
        tuple[Stretch, ...]
            A stretch per element.

        """
        drive, slowness = self.course.drive, 1.0 / self.speeds[:, 1:-1]
        means = slowness @ gauss_rule(slowness.shape[1]).weights
        passed = np.cumsum(self.course.spans[:, 0] * means).tolist()
        return tuple(
            Stretch(drive, element, time + before, energy, powers, slow)
            for element, before, energy, powers, slow in zip(
                self.course.elements, [0.0, *passed], self.starts.tolist(), self.powers, slowness))

    def reversals(self) -> list[float]:
        """
        Find where the power in the gearbox reverses, the shaft passing the synchronous speed.

        Returns
        -------
        list[float]
            Shaft angles [rad], without those at joints that are no cuts. At a joint the speed is
            known to twice the order of the Gauss points; elsewhere a first estimate is given.

        """
        drive = self.course.drive
        synchronous = drive.motor.synchronous_speed / drive.gearbox.ratio
        above = self.speeds - synchronous
        dense = (above @ spread(above.shape[1] - 2, _DENSE).T).ravel()
        clear = np.flatnonzero(np.abs(dense) > _NO_SLIP * synchronous)
        up = dense[clear] > 0.0
        found = []
        for k in np.flatnonzero(up[1:] != up[:-1]).tolist():
            low, high = int(clear[k]), int(clear[k + 1])
            (row, place), (end_row, end_place) = divmod(low, _DENSE), divmod(high, _DENSE)
            q_low, q_high = self._dense_angle(low), self._dense_angle(high)
            angle = q_low + (q_high - q_low) * dense[low] / (dense[low] - dense[high])
            if row != end_row or place == 0 or end_place == _DENSE - 1:
                element, side = self.course.elements[end_row], 0
                if row == end_row and place > 0:
                    side = -1
                joint = element.end if side else element.start
                better = joint - above[end_row, side] / self._rise(end_row, side, synchronous)
                angle = better if q_low <= better <= q_high else angle
                if joint not in self.course.cuts and abs(angle - joint) <= _PLACED:
                    continue
            found.append(float(angle))
        return found

    def _dense_angle(self, index: int) -> float:
        row, place = divmod(index, _DENSE)
        ends = self.course.elements[row]
        return ends.start + (ends.end - ends.start) * place / (_DENSE - 1)

    def _rise(self, row: int, side: int, synchronous: float) -> float:
        """Give dw/dq at the end of an element where the motor gives no torque [1/s]."""
        inertia, centripetal, force, damping = (
            float(term[row, side]) for term in self.course.terms)
        torque = force + damping * synchronous - centripetal * synchronous ** 2
        return torque / (inertia * synchronous)

    def rough(self) -> list[float]:
        """
        Find elements for which the Gauss points are too few.

        Returns
        -------
        list[float]
            The shaft angles in their middle [rad].

        """
        tails = np.abs(self.powers @ tail(self.powers.shape[1])).max(axis=1)
        rough = self.course.spans[:, 0] * tails > _ROUGH * self.energies.min(axis=1)
        return [0.5 * (element.start + element.end)
                for element, halve in zip(self.course.elements, rough) if halve]

    def next_cuts(self, first: float) -> list[float]:
        """
        Foresee where the power reverses from another energy on.

        Parameters
        ----------
        first : float
            Kinetic energy at the beginning [J].

        Returns
        -------
        list[float]
            Shaft angles [rad].

        """
        course, found = self.course, []
        synchronous = course.drive.motor.synchronous_speed / course.drive.gearbox.ratio
        for cut in course.cuts:
            row = int(np.searchsorted(course.angles[:, 0], cut))
            faster = self.shares[row] * (first - self.starts[0]) / (
                course.terms.inertia[row, 0] * synchronous)
            moved = -faster / self._rise(row, 0, synchronous)
            found.append(cut + float(np.clip(moved, -_FARTHEST, _FARTHEST)))
        return sorted(found)

    def guess(self, course: Course, first: float) -> Array:
        """
        Continue to another first energy or other elements, linearly from the nearest point.

        Parameters
        ----------
        course : Course
            The course wanted.
        first : float
            Kinetic energy at its beginning [J].

        Returns
        -------
        ndarray, shape (n, points)
            Kinetic energies at its Gauss points [J].

        """
        known, wanted = self.course.angles[:, 1:-1].ravel(), course.angles[:, 1:-1]
        near = np.searchsorted(0.5 * (known[1:] + known[:-1]), wanted)
        energies = self.energies.ravel()[near]
        guess: Array = (
            energies + self.powers.ravel()[near] * (wanted - known[near])
            + self.inner_shares.ravel()[near] * (first - self.starts[0]))
        return np.maximum(guess, _LEAST_SHARE * energies)


def settle(course: Course, guess: Array, first: float | None,
           rescue: Callable[[Course], Array] | None = None) -> Passage | None:
    """
    Find the motion over a course, cut where the power in the gearbox reverses.

    Parameters
    ----------
    course : Course
        The course, with cuts where they are expected.
    guess : ndarray, shape (n, points)
        Kinetic energies at its Gauss points [J].
    first : float or None
        Kinetic energy at the beginning [J]; None for a motion that closes.
    rescue : Callable[[Course], ndarray], optional
        Gives a better guess where the search fails with the first.

    Returns
    -------
    Passage or None
        The motion; None where the search does not come to an end.

    Notes
    -----
    Q has a kink where the motor's torque changes its sign. The course is cut there, and solved
    again until the cuts stand; each time their digits double. Then elements for which the Gauss
    points are too few are halved.

    """
    found = None
    for _ in range(_REFINEMENTS):
        found = solve(course, guess, first)
        if found is None and rescue is not None:
            found = solve(course, rescue(course), first)
        if found is None:
            break
        cuts = found.reversals() if course.drive.gearbox.efficiency < 1.0 else []
        if len(cuts) != len(course.cuts) or any(
                abs(cut - before) > _PLACED for cut, before in zip(cuts, course.cuts)):
            course = course.cut_at(cuts)
        elif rough := found.rough():
            course = (course.uncut or course).split_at(rough).cut_at(cuts)
        else:
            break
        guess = found.guess(course, float(found.starts[0]))
    return found


def solve(course: Course, guess: Array, first: float | None) -> Passage | None:
    """
    Solve dE/dq = Q(q, w(E)) over all elements at once.

    Parameters
    ----------
    course : Course
        The course.
    guess : ndarray, shape (n, points)
        Kinetic energies at the Gauss points to begin the search with [J].
    first : float or None
        Kinetic energy at the beginning [J]; None asks for that with which the course ends as it
        began.

    Returns
    -------
    Passage or None
        The motion; None where the shaft stops on the way or the search comes to no end.

    Notes
    -----
    With the energy E = J w²/2 as unknown, the equation of motion is of first order in the shaft
    angle. It is collocated at the Gauss points of all elements and solved by Newton's method. In
    each step the unknowns of an element follow from the change of the energy at its beginning,
    so only a chain of scalars passes from element to element.

    """
    inertia, _, force, damping = (term[:, 1:-1] for term in course.terms)
    rule, sides = gauss_rule(guess.shape[1]), np.ones((*guess.shape, 2))
    weights, matrix = course.spans * rule.weights, course.spans[:, :, None] * rule.matrix
    eye = np.eye(guess.shape[1])
    energies, highest = guess, _RUNAWAY * guess.max()
    start = float(guess[0, 0]) if first is None else first
    for _ in range(_STEPS):
        omega = np.sqrt(2.0 * energies / inertia)
        torque, slope = course.drive.motor_line(omega)
        powers = force + damping * omega + torque
        slopes = (damping + slope) / (inertia * omega)
        if not np.isfinite(slopes).all() or energies.max() > highest:
            return None
        starts = np.cumsum(np.concatenate([[start], (weights * powers).sum(axis=1)]))
        sides[:, :, 1] = starts[:-1, None] - energies + course.spans * (powers @ rule.matrix.T)
        answers = np.linalg.solve(eye - matrix * slopes[:, None, :], sides)
        gains = (weights * slopes)[:, None, :] @ answers
        shares, shifts = _chain(gains[:, 0].tolist())
        moved = 0.0
        if first is None:
            moved = float((starts[-1] + shifts[-1] - start) / (1.0 - shares[-1]))
        inner = answers[:, :, 0] * shares[:-1, None]
        change = answers[:, :, 1] + answers[:, :, 0] * shifts[:-1, None] + inner * moved
        relative = change / energies
        falling = max(-float(relative.min()), -moved / start)
        if max(falling, float(relative.max())) < _LINEAR:
            starts = starts + shifts + shares * moved
            if not starts.min() > 0.0:
                return None
            return Passage(course, starts, energies + change, powers + slopes * change, slopes,
                           shares, inner)
        # never below a tenth of the energy there is: the speed must stay positive
        part = min(1.0, 0.9 / falling) if falling > 0.0 else 1.0
        energies, start = energies + part * change, start + part * moved
    return None


def _chain(gains: list[list[float]]) -> tuple[Array, Array]:
    """Pass x -> x + factor x + shift on from link to link, and give what 1 and 0 become."""
    share, shift = 1.0, 0.0
    links = [(share, shift)]
    for factor, more in gains:
        share, shift = share + factor * share, shift + factor * shift + more
        links.append((share, shift))
    shares, shifts = np.array(links).T
    return shares, shifts
