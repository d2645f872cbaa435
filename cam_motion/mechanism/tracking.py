# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A linkage that follows its inputs tick by tick, each tick at a bounded cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cam_motion.errors import Problem
from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.pose import (
    Pose,
    Range,
    range_problem,
    SingularError,
    together_problem,
    whole_turns,
)
from cam_motion.motion.piece import Array
import numpy as np

_STEPS = 4  # certified steps for one tick; from tick to tick one is enough
_AGAIN = 100  # ticks after a refusal until the same is tried again


class Tracker:
    """
    Follows the inputs of a linkage on its branch, and stops before singular positions.

    What one tick may cost is bounded: inputs that are far away are reached over several ticks,
    always by certified steps, so that no way leads to another branch.

    Parameters
    ----------
    assembly : Assembly
        The linkage on the branch of its start.

    Attributes
    ----------
    pose : Pose
        The last position that was asked for and reached; at first the start.
    refusal : SingularError | None
        Why the last inputs could not be reached; None while nothing is in the way.

    """

    def __init__(self, assembly: Assembly) -> None:
        """Begin at the start."""
        self.assembly = assembly
        self.pose = assembly.start
        self.refusal: SingularError | None = None
        self._foothold = self._reached = assembly.stand(assembly.start)
        self._ranges: dict[str, Range] = {}
        self._waited, self._outside = 0, False

    def prepare(self) -> None:
        """Find how far each input goes, so that a refusal costs no time."""
        for name in self.assembly.linkage.inputs:
            if name not in self._ranges:
                self._ranges[name] = self.assembly.range_of(name)

    def unwind(self, inputs: Sequence[float]) -> None:
        """
        Turn cranks that turn all the way round by whole turns, to where their inputs are.

        An axis that has been running counts its turns; to go through them all would take for ever.

        Parameters
        ----------
        inputs : Sequence[float]
            All inputs, in the order of the linkage [m, rad].

        """
        self.prepare()
        z = self._reached.z.copy()
        for k, (name, value) in enumerate(zip(self.assembly.linkage.inputs, inputs)):
            z[k] += whole_turns(self.assembly.linkage, name, value - z[k], self._ranges[name])
        self._foothold = self._reached = self._reached._replace(z=z)

    def follow(self, inputs: Sequence[float]) -> Pose | None:
        """
        Go towards inputs as far as one tick allows.

        Parameters
        ----------
        inputs : Sequence[float]
            All inputs, in the order of the linkage [m, rad].

        Returns
        -------
        Pose | None
            The position there; None while it is still on its way, or refused.

        """
        target = np.array(inputs)
        rests = self._foothold is self._reached
        if rests and self.refusal is not None and not self._worth_a_try(target):
            return None
        try:
            for _ in range(_STEPS):
                self._foothold = self.assembly.step(self._foothold, target)
                if self._foothold.reaches(target):
                    self._reached, self.refusal = self._foothold, None
                    self.pose = self.assembly.pose(self._foothold)
                    return self.pose
        except SingularError as error:
            self.refusal = error
            self.prepare()
            self._waited, self._outside = 0, not self._within(target)
            self._foothold = self._reached
        return None

    def gain(self) -> Array:
        """
        Give how the unknowns follow the inputs at the last position.

        Returns
        -------
        ndarray, shape (u, inputs)
            Derivatives of the unknowns by the inputs, in their units.

        """
        count, units = len(self.assembly.linkage.inputs), self.assembly.equations.units
        gain: Array = self._reached.gain * units[count:, None] / units[:count]
        return gain

    def rates(self, speeds: Sequence[float]) -> Array:
        """
        Give the rates of all variables at the last position.

        Parameters
        ----------
        speeds : Sequence[float]
            Rates of the inputs [m/s, rad/s].

        Returns
        -------
        ndarray, shape (n,)
            Rates, inputs first [m/s, rad/s].

        """
        given = np.array(speeds)
        return np.concatenate([given, self.gain() @ given])

    def problems(self, inputs: Sequence[float]) -> list[Problem]:
        """
        Say which inputs are out of range, by name and with the range.

        Parameters
        ----------
        inputs : Sequence[float]
            All inputs that were refused [m, rad].

        Returns
        -------
        list[Problem]
            The problems; empty where nothing was refused.

        """
        if self.refusal is None:
            return []
        self.prepare()
        names, start = self.assembly.linkage.inputs, self.assembly.start
        given = dict(zip(names, inputs))
        found = [range_problem(start, name, value, self._ranges[name])
                 for name, value in given.items()]
        moved = sum(value != start[name] for name, value in given.items())
        # how far an input goes may depend on the others, and to find that out would take time
        now = f'; now {self.refusal}' if moved > 1 else ''
        return [replace(problem, rule=problem.rule + now) for problem in found if problem] or [
            together_problem(given, f'on the straight way there {self.refusal}')]

    def _worth_a_try(self, target: Array) -> bool:
        """Tell whether inputs may be reached although others before them were not."""
        self._waited += 1
        if self._waited >= _AGAIN:
            return True
        # what was refused within all ranges is refused because of several inputs together
        return self._outside and self._within(target)

    def _within(self, target: Array) -> bool:
        return all(self._ranges[name].low < value < self._ranges[name].high
                   for name, value in zip(self.assembly.linkage.inputs, target.tolist()))
