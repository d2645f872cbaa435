# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Parameters of motion laws and the checks on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cam_motion.errors import ConfigurationError, Problem

# Fractions written with seven digits or more, as 0.1428571 seven times, are meant to sum to one;
# what rounding in the seventh digit cannot explain is a mistake.
SUM_TOLERANCE = 1e-6
# A stage as short as this is what rounding leaves of a stage that is not there.
SHORTEST_STAGE = 1e-12
ANY_NUMBER = -1
"""Count of a list that may hold any number of values."""
LARGEST_VALUE = 1e12
"""Largest magnitude of a boundary value; what is larger is a mistake."""


@dataclass(frozen=True)
class LawParameter:
    """
    One parameter of a law: a number, mostly a fraction of the span, or several of them.

    Attributes
    ----------
    name : str
        Key in the configuration.
    default : float | tuple[float, ...] | None
        Value when left out; None lets the law derive it from the others.
    rule : str
        What is allowed, for people.
    count : int
        0 for a single number, `ANY_NUMBER` for a list of any length, else how many numbers the
        list holds.
    least, most : float
        The range of each number.

    """

    name: str
    default: float | tuple[float, ...] | None
    rule: str
    count: int = 0
    least: float = 0.0
    most: float = 1.0

    def check(self, value: Any) -> float | tuple[float, ...] | None:
        """
        Check a given value.

        Parameters
        ----------
        value : Any
            What the user gave; None if nothing.

        Returns
        -------
        float | tuple[float, ...] | None
            The value cleaned, or the default.

        Raises
        ------
        ConfigurationError
            When it is not a number (or that many numbers) within the range.

        """
        if value is None:
            return self.default
        numbers = [value] if self.count == 0 else value
        if isinstance(numbers, str) or not isinstance(numbers, Sequence) or (
            self.count > 0 and len(numbers) != self.count
        ):
            raise self.problem(value)
        for number in numbers:
            if isinstance(number, bool) or not isinstance(number, (int, float)) or not (
                self.least <= number <= self.most
            ):
                raise self.problem(value)
        cleaned = tuple(float(number) for number in numbers)
        return cleaned if self.count else cleaned[0]

    def problem(self, value: Any, hint: str = '') -> ConfigurationError:
        """
        Say that a value breaks the rule.

        Parameters
        ----------
        value : Any
            The value.
        hint : str
            A way out.

        Returns
        -------
        ConfigurationError
            To be raised.

        """
        return ConfigurationError([Problem(self.name, value, self.rule, hint)])
