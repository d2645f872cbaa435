# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A linkage with what a machine file says of it, checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from cam_motion.io.axis import Values
from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.linkage import Linkage


@dataclass(frozen=True)
class LinkageInputs:
    """
    What the inputs of a linkage do at one moment.

    Attributes
    ----------
    values, rates, accelerations : Mapping[str, float]
        Inputs and their derivatives by time [m, rad]; those left out stand at the start.

    """

    values: Mapping[str, float] = field(default_factory=dict)
    rates: Mapping[str, float] = field(default_factory=dict)
    accelerations: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class LinkageCase:
    """
    A motion to look at: all inputs at constant rates.

    Attributes
    ----------
    name : str
        Its name.
    inputs : LinkageInputs
        Where it begins, and the rates.
    duration : float
        How long it takes [s].

    """

    name: str
    inputs: LinkageInputs
    duration: float


@dataclass(frozen=True)
class InputDrive:
    """
    What an axis makes of an input: offset + factor · position of the axis.

    Attributes
    ----------
    axis : str
        Name of the axis.
    factor : float
        Change of the input per unit of the axis: the radius of a spool, else 1.
    offset : float
        The input where the axis is at zero [m, rad]: with a spool the start, else 0.

    """

    axis: str
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class LinkageSettings:
    """
    A linkage with what a machine file says of it.

    Attributes
    ----------
    name : str
        Name of its section.
    assembly : Assembly
        The linkage on the branch of its start.
    spools : Mapping[str, float]
        Radius of the spool that winds an input, by input [m].
    cases : Mapping[str, LinkageCase]
        Motions to look at.
    values : Mapping[str, Any]
        Every parameter of the section itself, checked.
    drives : Mapping[str, InputDrive]
        The axes that drive inputs, by input; other inputs stay at the start.
    forces : Mapping[str, complex]
        Forces on points that the inputs hold, x + j y, by point [N].
    torques : Mapping[str, float]
        Loads along variables that the inputs hold: torques on angles [N m], forces along lengths
        [N].

    """

    name: str
    assembly: Assembly
    spools: Mapping[str, float]
    cases: Mapping[str, LinkageCase]
    values: Values = field(default_factory=dict)
    drives: Mapping[str, InputDrive] = field(default_factory=dict)
    forces: Mapping[str, complex] = field(default_factory=dict)
    torques: Mapping[str, float] = field(default_factory=dict)

    @property
    def linkage(self) -> Linkage:
        """Give the linkage itself."""
        return self.assembly.linkage

    @property
    def loaded(self) -> bool:
        """Tell whether the inputs have loads to hold."""
        return bool(self.forces or self.torques)

    @property
    def axes(self) -> tuple[str, ...]:
        """List the axes that drive inputs, each once."""
        return tuple(dict.fromkeys(drive.axis for drive in self.drives.values()))
