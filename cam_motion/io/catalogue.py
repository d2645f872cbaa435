# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Catalogues of motors and gearboxes: read, checked as a whole, every figure with its source."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from cam_motion.drive.sizing import GearboxChoice
from cam_motion.drive.sizing_forward import MotorChoice
from cam_motion.drive.sizing_inverse import ServoChoice
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.catalogue_entries import ENTRIES, make_entry
from cam_motion.io.config import parse_yaml

_ABOUT = ('title', 'publisher', 'url', 'year', 'note')


@dataclass(frozen=True)
class Catalogue:
    """
    What there is to choose from.

    Attributes
    ----------
    motors : tuple[MotorChoice, ...]
        Induction motors.
    servos : tuple[ServoChoice, ...]
        Servo motors.
    gearboxes : tuple[GearboxChoice, ...]
        Gearboxes, one per ratio.

    """

    motors: tuple[MotorChoice, ...] = ()
    servos: tuple[ServoChoice, ...] = ()
    gearboxes: tuple[GearboxChoice, ...] = ()


def own_catalogue() -> tuple[Path, ...]:
    """
    List the catalogue that comes with the package.

    Returns
    -------
    tuple[Path, ...]
        Its files.

    """
    folder = Path(str(resources.files('cam_motion'))) / 'catalogue'
    return tuple(sorted(folder.glob('*.yaml')))


def load_catalogue(paths: Sequence[str | Path] = ()) -> Catalogue:
    """
    Read a catalogue from one file or several.

    Parameters
    ----------
    paths : Sequence[str | Path]
        The files; none takes the catalogue that comes with the package.

    Returns
    -------
    Catalogue
        Everything that they hold.

    Raises
    ------
    ConfigurationError
        With every problem of every file, paths starting with the section.

    """
    problems: list[Problem] = []
    found: dict[str, dict[str, Any]] = {section: {} for section in ENTRIES}
    for path in paths or own_catalogue():
        try:
            tree = parse_yaml(Path(path).read_text(encoding='utf-8'), str(path))
        except (OSError, UnicodeDecodeError) as error:
            reason = getattr(error, 'strerror', None) or str(error)
            problems.append(Problem(str(path), None, f'cannot be read: {reason}',
                                    'give the path of a catalogue'))
            continue
        except ConfigurationError as error:
            problems += error.problems
            continue
        problems += _read(tree, str(path), found)
    if problems:
        raise ConfigurationError(problems)
    return Catalogue(
        tuple(found['induction_motors'].values()), tuple(found['servo_motors'].values()),
        tuple(one for choices in found['gearboxes'].values() for one in choices))


def _read(tree: Any, path: str, found: dict[str, dict[str, Any]]) -> list[Problem]:
    """Add the entries of one file to those found before."""
    known = ('sources', *ENTRIES)
    if not isinstance(tree, Mapping) or not any(section in tree for section in ENTRIES):
        return [Problem(path, tree if isinstance(tree, str) else None, 'is no catalogue',
                        'a catalogue has sources: and at least one of ' + ', '.join(ENTRIES))]
    problems = [Problem(str(key), '', 'no such section in a catalogue',
                        'known are: ' + ', '.join(known)) for key in tree if key not in known]
    sources, wrong = _sources(tree.get('sources'))
    problems += wrong
    for section in ENTRIES:
        entries = tree.get(section, {})
        if not isinstance(entries, Mapping):
            problems.append(Problem(section, entries, 'must hold entries by name'))
            continue
        for name, given in entries.items():
            where = f'{section}.{name}'
            if str(name) in found[section]:
                problems.append(Problem(where, name, 'stands in the catalogue twice',
                                        'keep one of them, or give it another name'))
            try:
                found[section][str(name)] = make_entry(
                    section, str(name), given, sources)
            except ConfigurationError as error:
                problems += [problem.below(where) for problem in error.problems]
    return problems


def _sources(given: Any) -> tuple[dict[str, str], list[Problem]]:
    """Write every source as one line."""
    if not isinstance(given, Mapping):
        return {}, [Problem('sources', given, 'must hold the publications by key',
                            'no figure without a source: give title, publisher and url')]
    sources, problems = {}, []
    for key, about in given.items():
        title = about.get('title') if isinstance(about, Mapping) else None
        if not isinstance(title, str) or not title.strip():
            problems.append(Problem(f'sources.{key}.title', title,
                                    'every source needs a title, a text'))
            title = ''
        elif unknown := [name for name in about if name not in _ABOUT]:
            problems += [Problem(f'sources.{key}.{name}', about[name], 'no such key of a source',
                                 'known are: ' + ', '.join(_ABOUT)) for name in unknown]
        else:
            title = '; '.join(str(about[name]) for name in _ABOUT[:-1] if name in about)
        sources[str(key)] = title
    return sources, problems
