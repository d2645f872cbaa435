# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The whole machine in one process: shaft, axes, drives and linkages on one executor."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from cam_motion.errors import ConfigurationError
from cam_motion.io.interlocks import line_values
from cam_motion.io.machine import build_machine
from cam_motion.io.parameters import LINE
from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.drive_sim import DriveSim
from cam_motion.nodes.linkage_state import LinkageState
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.master_shaft import MasterShaft
from cam_motion.nodes.parameters import section_of, values_of
from cam_motion.nodes.runner import run
from cam_motion.nodes.staging import own_values


class Line(ManagedNode):
    """
    Names the parts of the machine, and checks that they fit together.

    Parameters
    ----------
    name : str
        Name of the node.
    **options : Any
        Further arguments of `rclpy.node.Node`.

    """

    TABLE = LINE

    def __init__(self, name: str = 'line', **options: Any) -> None:
        """Declare the parameters."""
        super().__init__(name, **options)
        self.parts: list[ManagedNode] = []

    def configure(self, values: dict[str, Any]) -> None:
        """
        Check the machine as a whole.

        Parameters
        ----------
        values : dict[str, Any]
            All parameters by flat name.

        Raises
        ------
        ConfigurationError
            When the axes do not keep their limits at the set speed, or names do not fit.

        """
        sections = {part.get_name(): own_values(values_of(part)) for part in self.parts}
        if values['master'] not in sections and (beside := section_of(values['master'])):
            sections[values['master']] = beside  # a master that a drive has displaced
        # said by the parts themselves: only what concerns the machine as a whole is left
        known = {
            f'{part.get_name()}.{problem.path}' for part in self.parts for problem in part.problems
        }
        try:
            build_machine({**sections, 'line': values})
        except ConfigurationError as error:
            whole = [
                problem for problem in error.problems if problem.path not in known]
            if whole:
                raise ConfigurationError(whole) from None

    def activate(self) -> None:
        """Say that the line is up."""
        self.set_state('active')

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the line is, as the worst of its parts.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level, and the state of every part.

        """
        level = max(part.health()[0] for part in self.parts) if self.parts else b'\0'
        return level, {part.get_name(): part.state_text for part in self.parts}


def make_line(**options: Any) -> list[ManagedNode]:
    """
    Make all nodes of the machine that the parameters describe.

    Shaft points reach the axes, and setpoints the drives and linkages, by a call within the
    process; all of them are published as well.

    Parameters
    ----------
    **options : Any
        Arguments of `rclpy.node.Node` for every node, such as ``context``.

    Returns
    -------
    list[ManagedNode]
        Master shaft, axes, drives, linkages, and the line itself; a drive that turns the shaft
        stands in the place of the master.

    Raises
    ------
    ConfigurationError
        When the names of the parts cannot be used.

    """
    line = Line(**options)
    names, problems = line_values(values_of(line))
    if problems:
        line.destroy_node()
        raise ConfigurationError(problem.below('line') for problem in problems)
    axes = {name: CamAxis(name, own_process=False, **options) for name in names['axes']}
    drives = [DriveSim(name, own_process=False, **options) for name in names['drives']]
    turning = [drive for drive in drives if drive.kind.TURNS_SHAFT]
    master: MasterShaft | DriveSim = (
        turning[0] if turning else MasterShaft(names['master'], own_process=False, **options))
    if isinstance(master, MasterShaft):
        master.sections = lambda: {
            name: own_values(values_of(node)) for name, node in axes.items()}
    # a load that acts in a window of the shaft angle: the shaft is heard before the setpoints
    master.listeners += [drive.note_shaft for drive in drives
                         if drive is not master and values_of(drive).get('load')]
    for axis in axes.values():
        source = axes.get(values_of(axis).get('follows', ''), master)
        source.listeners.append(axis.answer)
        if isinstance(source, CamAxis):
            axis.source = partial(getattr, source, 'outputs')
        elif isinstance(master, MasterShaft):
            axis.bound_listeners.append(partial(master.obey, axis.get_name()))
    for drive in drives:
        drive.section = lambda name: own_values(values_of(axes[name])) if name in axes else {}
        followed = axes.get(values_of(drive).get('axis', ''))
        if followed is not None:
            followed.listeners.append(drive.answer)
            if not drive.kind.TURNS_SHAFT:
                followed.drive = partial(values_of, drive)
    linkages = [LinkageState(name, own_process=False, **options) for name in names['linkages']]
    for name, axis in axes.items():
        axis.listeners += [partial(linkage.answer, name) for linkage in linkages]
    line.parts = [master, *axes.values(), *(drive for drive in drives if drive is not master),
                  *linkages]
    return [*line.parts, line]


def main(argv: list[str] | None = None) -> int:
    """
    Run the machine as a process.

    Parameters
    ----------
    argv : list[str], optional
        Command line; None takes that of the process.

    Returns
    -------
    int
        Exit code.

    """
    return run(make_line, argv)
