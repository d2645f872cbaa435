# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""All positions of a linkage on one branch: how they are reached, and how far inputs go."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import islice, permutations
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.mechanism.closing import closing_problems
from cam_motion.mechanism.continuation import Continuation
from cam_motion.mechanism.linkage import Linkage
from cam_motion.mechanism.pose import (
    Pose,
    Range,
    range_problem,
    SingularError,
    together_problem,
)
from cam_motion.mechanism.singular import Singularity
from cam_motion.units import TURN
import numpy as np

_LARGEST = 1e3  # metres or radians: 159 turns of a crank
_FAR = 10.0  # sums of all lengths; no input of a closed loop goes that far
_ORDERS = 24  # of inputs, one after the other, that are tried: all of up to four inputs


class Assembly(Continuation):
    """
    The branch of a linkage that its start names, and all that can be reached on it.

    Parameters
    ----------
    linkage : Linkage
        The linkage.

    Attributes
    ----------
    start : Pose
        The start, exactly.

    Raises
    ------
    ConfigurationError
        When the start is not near enough to one assembly to name it.

    """

    def __init__(self, linkage: Linkage) -> None:
        """Close the start exactly."""
        super().__init__(linkage)
        rough = np.array([linkage.start[name] for name in linkage.variables])
        start = self.close(rough)
        if start is None:
            raise ConfigurationError(closing_problems(linkage, self.equations, rough))
        self.start = start

    def at(self, inputs: Mapping[str, float]) -> Pose:
        """
        Find the position for given inputs, from the start.

        Parameters
        ----------
        inputs : Mapping[str, float]
            Inputs [m, rad]; those left out stay as at the start.

        Returns
        -------
        Pose
            The position.

        Raises
        ------
        ConfigurationError
            When an input is unknown or out of range; the problem states the range.

        """
        unknown = [Problem(name, value, 'is no input of the linkage', 'known are: '
                           + ', '.join(self.linkage.inputs))
                   for name, value in inputs.items() if name not in self.linkage.inputs]
        unknown += [Problem(name, value, f'must be at most {_LARGEST:g} m or rad in magnitude')
                    for name, value in inputs.items() if not abs(value) <= _LARGEST]
        if unknown:
            raise ConfigurationError(unknown)
        try:
            return self.reach(self.start, inputs)
        except SingularError as error:
            raise ConfigurationError(self.range_problems(
                inputs, error, self.start,
                'neither the straight way nor one input after the other leads there:')) from error

    def reach(self, pose: Pose, inputs: Mapping[str, float]) -> Pose:
        """
        Go from one position to other inputs: straight, else one input after the other.

        What several inputs reach together depends on the way, because each changes how far the
        others go. All ways tried are followed by certified steps.

        Parameters
        ----------
        pose : Pose
            Where to begin.
        inputs : Mapping[str, float]
            Inputs to go to [m, rad]; those left out stay.

        Returns
        -------
        Pose
            The position there, on the same branch.

        Raises
        ------
        SingularError
            When a singular position is in all these ways; the one in the straight way.

        """
        try:
            return self.follow(pose, inputs)
        except SingularError as error:
            blocked = error
        moved = [name for name, value in inputs.items() if value != pose[name]]
        for order in islice(permutations(moved), _ORDERS if len(moved) > 1 else 0):
            reached = pose
            try:
                for name in order:
                    reached = self.follow(reached, {name: inputs[name]})
            except SingularError:
                continue
            return reached
        raise blocked

    def range_of(self, name: str, pose: Pose | None = None) -> Range:
        """
        Find how far one input goes while the others stay.

        Parameters
        ----------
        name : str
            The input.
        pose : Pose, optional
            The position to begin at; None takes the start.

        Returns
        -------
        Range
            Its bounds and what stops it there; an angle that turns through a whole revolution
            is not bounded.

        """
        pose = self.start if pose is None else pose
        far = TURN if name in self.linkage.angles else _FAR * float(
            np.abs(self.equations.vectors(pose.values)).sum())
        bounds: list[tuple[float, Singularity | None]] = []
        for sign in (-1.0, 1.0):
            try:
                self.follow(pose, {name: pose[name] + sign * far})
                bounds.append((sign * math.inf, None))
            except SingularError as error:
                bounds.append((error.pose[name], error.singularity))
        (low, at_low), (high, at_high) = bounds
        return Range(low, high, at_low, at_high)

    def range_problems(self, inputs: Mapping[str, float], error: SingularError, begin: Pose,
                       blocked: str = 'on the straight way there') -> list[Problem]:
        """
        Say which inputs are out of range; where none is alone, what stops them together.

        Parameters
        ----------
        inputs : Mapping[str, float]
            Inputs that cannot be reached [m, rad].
        error : SingularError
            What is in the way.
        begin : Pose
            Where the way began.
        blocked : str
            What was tried, before the words of the error.

        Returns
        -------
        list[Problem]
            The problems, paths the names of the inputs. A range is that with the other inputs as
            they are wanted; where these cannot be reached either, as they are where it begins.

        """
        problems = []
        for name, value in inputs.items():
            others = {other: inputs[other] for other in inputs if other != name}
            try:
                pose = self.reach(begin, others)
            except SingularError:
                pose = begin
            problems.append(range_problem(pose, name, value, self.range_of(name, pose)))
        return [each for each in problems if each] or [
            together_problem(inputs, f'{blocked} {error}')]
