# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Which nodes make up a line: named by its section, or guessed where a file has none."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from cam_motion.errors import Problem
from cam_motion.io.axis import Values
from cam_motion.io.linkage_config import linkage_names

LINE_SHAFT = 'line_shaft'
"""Mode of a drive that turns a cam shaft, against one that follows an axis."""


def shaft_drives(sections: Mapping[str, Values], drives: Iterable[str]) -> list[str]:
    """
    Find the drives that turn the shaft themselves.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.
    drives : Iterable[str]
        Names of the drives of the line.

    Returns
    -------
    list[str]
        Names; more than one make no machine.

    """
    return [name for name in dict.fromkeys(drives)
            if sections.get(name, {}).get('mode') == LINE_SHAFT]


def rival_problems(sections: Mapping[str, Values], master: str, turning: list[str],
                   ) -> list[Problem]:
    """
    Find whatever would turn the shaft beside the drive that does.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.
    master : str
        Name of the master shaft.
    turning : list[str]
        Names of the drives that turn the shaft.

    Returns
    -------
    list[Problem]
        What is wrong.

    """
    problems = []
    if len(turning) > 1:
        problems.append(Problem(
            'line.drives', turning, f'one drive with mode {LINE_SHAFT} turns the shaft, no more',
            'let the others follow an axis, or make a line of each'))
    if turning and master in sections and master not in turning:
        problems.append(Problem(
            master, 'a master shaft', f'{turning[0]} turns the shaft: nothing else may',
            'leave this section out, or give the drive another mode'))
    return problems


def guess_line(sections: Mapping[str, Values]) -> Values:
    """
    Make up the section of the line where a file has none, from what the others hold.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.

    Returns
    -------
    Mapping[str, Any]
        Names of the axes (sections with segments), drives (with an axis), linkages that axes
        drive, and of the master.

    """
    masters = [name for name, values in sections.items() if 'speed_cpm' in values]
    return {
        'master': masters[0] if masters else 'master_shaft',
        'axes': [name for name, values in sections.items() if 'segments' in values],
        'drives': [name for name, values in sections.items()
                   if 'axis' in values and 'segments' not in values],
        'linkages': [name for name in linkage_names(sections)
                     if any(key.endswith('.axis') for key in sections[name])],
    }
