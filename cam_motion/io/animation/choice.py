# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Which film a machine file or a bag makes: of a linkage, of a disc cam, or of the axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.animation.axes import axes_film
from cam_motion.io.animation.cam_disc import cam_disc_film
from cam_motion.io.animation.course import Course, cycle_of, recorded_course
from cam_motion.io.animation.film import Film
from cam_motion.io.animation.linkage import case_film, driven_film
from cam_motion.io.animation.pace import Wishes
from cam_motion.io.axis import Values
from cam_motion.io.cam_disc_config import build_cam_discs, CamDiscSettings
from cam_motion.io.config import read_sections
from cam_motion.io.line_parts import guess_line
from cam_motion.io.linkage_config import build_linkages
from cam_motion.io.linkage_settings import LinkageSettings
from cam_motion.io.machine import build_machine, Machine
from cam_motion.io.recording import read_recording
from cam_motion.io.summary import with_speed

BAGS = ('.mcap', '.db3')
"""Suffixes of files that are bags; so is every directory."""


@dataclass(frozen=True)
class Choice:
    """
    What a film shall show, where a machine has more than one thing to show.

    Attributes
    ----------
    linkage, disc, axis : str, optional
        Name of a linkage, of a disc cam, or of an axis.
    case : str, optional
        A motion of the linkage, in the place of what the line does with it.
    diagram : bool
        Whether the timing diagram is wanted whatever else there is.
    speed_cpm : float, optional
        Shaft speed in the place of the configured one [cycles/min].
    start, end : float, optional
        Which part of a recorded run, from its first tick [s].
    config : str or Path, optional
        Machine file in the place of the one that a bag carries.

    """

    linkage: str | None = None
    disc: str | None = None
    axis: str | None = None
    case: str | None = None
    diagram: bool = False
    speed_cpm: float | None = None
    start: float | None = None
    end: float | None = None
    config: str | Path | None = None


def is_bag(source: str | Path) -> bool:
    """
    Tell a bag from a machine file.

    Parameters
    ----------
    source : str or Path
        What the user named.

    Returns
    -------
    bool
        Whether it is a bag.

    """
    path = Path(source)
    return path.is_dir() or path.suffix in BAGS


def choose_film(source: str | Path, wishes: Wishes, choice: Choice) -> Film:
    """
    Make the film of a machine file or of a bag.

    Parameters
    ----------
    source : str or Path
        Machine file, or bag: a directory or a file with a suffix of `BAGS`.
    wishes : Wishes
        How fast it shall go.
    choice : Choice
        What it shall show. Where nothing is said: the first linkage, else the first disc cam,
        else all axes.

    Returns
    -------
    Film
        The film.

    Raises
    ------
    ConfigurationError
        When the file or the choice cannot be used.
    CamMotionError
        When the bag cannot be read.

    """
    return _of_bag(Path(source), wishes, choice) if is_bag(source) else _of_config(
        source, wishes, choice)


def _of_bag(path: Path, wishes: Wishes, choice: Choice) -> Film:
    _refuse({'--case': choice.case, '--speed-cpm': choice.speed_cpm},
            'a recorded run is what it is', 'leave it out, or name a machine file')
    recording = read_recording(path, None if choice.config is None else Path(choice.config))
    machine = recording.machine
    discs, _ = build_cam_discs(recording.sections)
    _check_names(choice, machine.linkages, machine, discs)
    course = recorded_course(recording, wishes, (choice.start, choice.end))
    return _of_course(machine, course, choice, machine.linkages, discs)


def _of_config(path: str | Path, wishes: Wishes, choice: Choice) -> Film:
    _refuse({'--from': choice.start, '--to': choice.end, '--config': choice.config},
            'is for bags', 'leave it out, or name a bag')
    sections: Mapping[str, Values] = read_sections(path)
    if choice.speed_cpm is not None:
        sections = with_speed(sections, choice.speed_cpm)
    linkages, problems = build_linkages(sections)
    machine = build_machine(sections) if not linkages or _has_line(sections) else None
    if problems:
        raise ConfigurationError(problems)
    discs, problems = build_cam_discs(sections)
    if problems:
        raise ConfigurationError(problems)
    _check_names(choice, linkages, machine, discs)
    shown = None if choice.diagram else _linkage(choice, linkages)
    if machine is None or shown is not None and (choice.case is not None or not shown.drives):
        _refuse({'--speed-cpm': choice.speed_cpm}, 'this film shows no shaft', 'leave it out')
        return _of_case(shown or next(iter(linkages.values())), choice.case, wishes)
    return _of_course(machine, cycle_of(machine, wishes), choice, linkages, discs)


def _has_line(sections: Mapping[str, Values]) -> bool:
    return bool(sections.get('line', guess_line(sections)).get('axes'))


def _of_course(machine: Machine, course: Course, choice: Choice,
               linkages: Mapping[str, LinkageSettings], discs: Mapping[str, CamDiscSettings],
               ) -> Film:
    if not choice.diagram:
        shown = _linkage(choice, linkages)
        if shown is not None:
            return driven_film(shown, course)
        disc = next((each for each in discs.values() if choice.disc in (None, each.name)
                     and choice.axis in (None, each.axis) and each.axis in course.axes), None)
        if disc is not None:
            return cam_disc_film(disc, course)
        if choice.disc is not None:
            raise ConfigurationError([Problem(
                '--disc', choice.disc, f'nothing moves its axis {discs[choice.disc].axis} here',
                'let the line have this axis, or record it')])
    return axes_film(machine, course, choice.axis)


def _linkage(choice: Choice, linkages: Mapping[str, LinkageSettings]) -> LinkageSettings | None:
    if choice.linkage is not None:
        return linkages[choice.linkage]
    other = choice.axis is not None or choice.disc is not None
    return None if other else next(iter(linkages.values()), None)


def _of_case(settings: LinkageSettings, case: str | None, wishes: Wishes) -> Film:
    if not settings.cases:
        raise ConfigurationError([Problem(
            f'{settings.name}.motions', None, 'names the motions to film', 'describe one, or let '
            'axes drive the linkage')])
    chosen = next(iter(settings.cases)) if case is None else case
    return case_film(settings, settings.cases[chosen], wishes)


def _check_names(choice: Choice, linkages: Mapping[str, LinkageSettings],
                 machine: Machine | None, discs: Mapping[str, CamDiscSettings]) -> None:
    """Refuse names of what is not there, and two things at once."""
    problems = []
    wanted = {option: name for option, name in (
        ('--linkage', choice.linkage), ('--disc', choice.disc), ('--axis', choice.axis)) if name}
    if len(wanted) > 1:
        problems.append(Problem(' and '.join(wanted), tuple(wanted.values()),
                                'a film shows one thing', 'leave one out'))
    axes = () if machine is None else tuple(machine.diagram.axes)
    problems += _unknown('--linkage', choice.linkage, tuple(linkages), 'a linkage')
    problems += _unknown('--disc', choice.disc, tuple(discs), 'a disc cam')
    problems += _unknown('--axis', choice.axis, axes, 'an axis of the line')
    if choice.diagram and not axes:
        problems.append(Problem('--diagram', True, 'needs a line with axes', 'leave it out'))
    if choice.case is not None and not problems:
        shown = _linkage(choice, linkages)
        problems += _unknown('--case', choice.case, () if shown is None else tuple(shown.cases),
                             'a motion of the linkage')
    if problems:
        raise ConfigurationError(problems)


def _unknown(option: str, name: str | None, known: Sequence[str], what: str) -> list[Problem]:
    if name is None or name in known:
        return []
    return [Problem(option, name, f'must be the name of {what}',
                    'known are: ' + ', '.join(known) if known else 'there is none')]


def _refuse(given: Mapping[str, object], rule: str, hint: str) -> None:
    problems = [Problem(option, value, rule, hint) for option, value in given.items()
                if value is not None]
    if problems:
        raise ConfigurationError(problems)
