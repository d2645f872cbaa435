# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The errors of cam_motion: every one says the place, the value, the rule and a way out."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any


@dataclass(frozen=True)
class Problem:
    """
    One thing that is wrong in what a user gave.

    Attributes
    ----------
    path : str
        Where it stands, dotted as in the configuration (``feeder.feed.end_deg``).
    value : Any
        The value found there; None if the value is missing.
    rule : str
        The rule that it breaks.
    hint : str
        A way out.

    """

    path: str
    value: Any
    rule: str
    hint: str = ''

    def below(self, parent: str) -> Problem:
        """
        Give the same problem with its path placed below a parent.

        Parameters
        ----------
        parent : str
            Dotted path of the parent; may be empty.

        Returns
        -------
        Problem
            The same problem, its path starting with ``parent``.

        """
        if not parent:
            return self
        return replace(self, path=f'{parent}.{self.path}' if self.path else parent)

    def __str__(self) -> str:
        """Write the problem as one sentence for people."""
        text = f'{self.path}: {"missing" if self.value is None else repr(self.value)}; {self.rule}'
        return f'{text} ({self.hint})' if self.hint else text


class CamMotionError(Exception):
    """Base of all errors that cam_motion raises on purpose."""


class ConfigurationError(CamMotionError):
    """
    Something a user gave cannot be used; all problems found are listed at once.

    Parameters
    ----------
    problems : Iterable[Problem]
        Everything that is wrong, in the order of the configuration.

    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        """Keep the problems and write them as the message."""
        self.problems = tuple(problems)
        super().__init__('\n'.join(str(problem) for problem in self.problems))


class DomainError(CamMotionError, ValueError):
    """An argument lies outside the range in which the curve is defined."""
