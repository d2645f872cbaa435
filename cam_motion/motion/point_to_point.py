# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A motion law used in time: from one position to another within a given duration."""

from __future__ import annotations

import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.laws import MotionLaw
from cam_motion.motion.piece import Array
import numpy as np
from numpy.typing import ArrayLike


class PointToPoint:
    """
    A movement of given duration, start and displacement (document 002: T, S0, dS).

    Before it begins and after it has ended the position stands at its ends.

    Parameters
    ----------
    law : MotionLaw
        The motion law.
    duration : float
        Duration T [s]; positive.
    start : float
        Position S0 before the movement.
    displacement : float
        Change of position dS.

    Raises
    ------
    ConfigurationError
        When the duration is not positive or a number is not finite.

    """

    def __init__(self, law: MotionLaw, duration: float, start: float = 0.0,
                 displacement: float = 1.0) -> None:
        """Scale the law to the movement."""
        given = {'duration': duration, 'start': start, 'displacement': displacement}
        problems = [Problem(key, value, 'must be a finite number')
                    for key, value in given.items() if not math.isfinite(value)]
        if not problems and duration <= 0.0:
            problems = [Problem('duration', duration, 'must be above 0 s')]
        if problems:
            raise ConfigurationError(problems)
        self.law = law
        self.duration = duration
        self.start = start
        self.displacement = displacement
        self.curve = law.curve.scaled(0.0, duration, displacement, start)

    def __call__(self, t: ArrayLike, order: int = 0) -> Array:
        """
        Evaluate the movement or one of its derivatives.

        Parameters
        ----------
        t : array_like, any shape
            Time since the movement began [s].
        order : int
            Order of the derivative.

        Returns
        -------
        ndarray, shape of t
            Values, in the unit of the position per s^order.

        """
        times = np.asarray(t, dtype=float)
        values = self.curve.evaluate(np.clip(times, 0.0, self.duration), order)
        if order > 0:
            values = np.where((times < 0.0) | (times > self.duration), 0.0, values)
        return values
