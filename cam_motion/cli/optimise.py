# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``optimise``: the best law for a movement, before and after, to paste."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import replace
import math
from pathlib import Path
from typing import Any

from cam_motion.cli.options import add_json, finite_number
from cam_motion.cli.terminal import (
    console,
    number,
    print_files,
    print_json,
    progress,
    row,
    save_figure,
    table,
)
from cam_motion.errors import CamMotionError, ConfigurationError, Problem
from cam_motion.io.config import read_sections, section_yaml, segment_yaml
from cam_motion.io.optimise import (
    free_movement,
    Movement,
    optimise,
    Optimised,
    optimised_as_data,
    SPLINE,
    Wish,
)
from cam_motion.io.optimise_machine import movement_of, with_law
from cam_motion.motion.limits import Limits, QUANTITIES
from cam_motion.motion.optimal import OBJECTIVES
from cam_motion.motion.optimal_spline import INTERVALS
from cam_motion.motion.optimal_stages import FAMILIES
from cam_motion.units import DEGREE, rate_text, RPM

_LONG = 16  # letters of a name in the heading of a column
_RATES = QUANTITIES[1:]


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = (
        'Find the law that makes a peak, an RMS value or a torque of a movement '
        'least within limits: a spline by linear and quadratic programming, or the '
        'stage lengths of a family of laws by a global search. With a machine file '
        'the limits, the neighbours and the drive of the axis count; without one '
        'the movement is --lift over --span-deg between two dwells.')
    parser.epilog = (
        'GOAL: ' + ', '.join(OBJECTIVES) + '; several with weights as '
        'rms_acceleration=1,peak_jerk=0.5, each in relation to the polynomial 3-4-5.')
    parser.add_argument('config', metavar='CONFIG', nargs='?',
                        help='machine file: a ROS 2 parameter file in YAML')
    parser.add_argument('segment', metavar='AXIS.SEGMENT', nargs='?',
                        help='what to optimise; AXIS.CAM.SEGMENT for an axis of several cams')
    parser.add_argument('--minimise', metavar='GOAL', type=_weights,
                        default={'rms_acceleration': 1.0},
                        help='what to make least (default: rms_acceleration)')
    parser.add_argument('--law', choices=(SPLINE, *FAMILIES), default=SPLINE,
                        help='where to look (default: %(default)s)')
    parser.add_argument('--continuity', type=int, choices=(1, 2, 3), default=None,
                        help='class Ck with which it meets its neighbours (default: 2; 1 for '
                             'trapezoidal_velocity)')
    for name in _RATES:
        parser.add_argument(f'--max-{name}', type=finite_number, metavar='X',
                            help=f'limit on the {name} instead of that of the axis [unit/s...]')
    parser.add_argument('--ignore-limits', action='store_true',
                        help='do not take the limits of the axis')
    parser.add_argument('--intervals', type=int, metavar='N', default=INTERVALS,
                        help='intervals of the spline; a sinusoidal stage is no shorter than '
                             'one (default: %(default)s)')
    parser.add_argument('--degree', type=int, metavar='P',
                        help='degree of the spline (default: what the goal asks for)')
    parser.add_argument('--lift', type=finite_number, metavar='X',
                        help='without a file: change of position (default: 1)')
    parser.add_argument('--span-deg', type=finite_number, metavar='X',
                        help='without a file: span of the shaft [deg] (default: 360)')
    parser.add_argument('--speed-cpm', type=finite_number, metavar='X',
                        help='shaft speed instead of the configured one [cycles/min] (without a '
                             'file: 60, so that all is per second)')
    parser.add_argument('-o', '--output', metavar='FILE', type=Path,
                        help='write the section of the axis with the law found, or, without a '
                             'machine file, the segment')
    parser.add_argument('--picture', metavar='FILE', type=Path,
                        help='draw before and after; the suffix tells the format')
    add_json(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Optimise and print.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0; errors are raised.

    """
    sections, movement = _movement(arguments)
    continuity = arguments.continuity
    if continuity is None:
        continuity = 2 if arguments.law == SPLINE or FAMILIES[arguments.law].smooth else 1
    wish = Wish(arguments.minimise, arguments.law, continuity, arguments.intervals,
                arguments.degree)
    with progress() as bar:
        task = bar.add_task('optimising', total=None)
        found = optimise(movement, wish, lambda done, total: bar.update(
            task, completed=done, total=total))
    name = movement.name.rpartition('.')[2]
    law = found.parameters
    values = {'law': law.pop('law'), 'end_deg': movement.span / DEGREE, 'lift': movement.lift,
              **law}
    text = ''
    if sections:
        axis, own = with_law(sections, found)
        below = movement.name.removeprefix(f'{axis}.') + '.'
        values = {key.removeprefix(below): value for key, value in own.items()
                  if key.startswith(below)}
        text = section_yaml(axis, own, [f'{name} of {axis}: least {_goal(wish.weights)}'])
    files = _write(arguments, found, text or segment_yaml(name, values))
    if arguments.json:
        print_json({**optimised_as_data(found), 'yaml': segment_yaml(name, values),
                    'files': [str(file) for file in files]})
        return 0
    _print(found)
    console().print(f'to paste:\n\n{segment_yaml(name, values)}', soft_wrap=True)
    print_files(files)
    return 0


def _movement(arguments: argparse.Namespace) -> tuple[dict[str, Any], Movement]:
    given = [getattr(arguments, f'max_{name}') for name in _RATES]
    if arguments.config is None:
        return {}, free_movement(
            1.0 if arguments.lift is None else arguments.lift,
            360.0 if arguments.span_deg is None else arguments.span_deg,
            60.0 if arguments.speed_cpm is None else arguments.speed_cpm, Limits(*given))
    problems = [Problem(f'--{name.replace("_", "-")}', value, 'is for a movement without a file')
                for name in ('lift', 'span_deg')
                if (value := getattr(arguments, name)) is not None]
    if arguments.segment is None:
        problems.append(Problem('AXIS.SEGMENT', None, 'a machine file needs a segment to '
                                'optimise', 'write feeder.feed behind it'))
    if problems:
        raise ConfigurationError(problems)
    if arguments.output is not None and arguments.output.exists() and (
            arguments.output.samefile(arguments.config)):
        raise ConfigurationError([Problem(
            '--output', str(arguments.output), 'must not be the machine file itself',
            'its comments and other sections would be lost')])
    sections = read_sections(arguments.config)
    movement = movement_of(sections, arguments.segment, arguments.speed_cpm)
    own = [None if arguments.ignore_limits else movement.limits.of_order(order)
           for order in (1, 2, 3)]
    return sections, replace(movement, limits=Limits(*(
        old if new is None else new for old, new in zip(own, given))))


def _write(arguments: argparse.Namespace, found: Optimised, text: str) -> list[Path]:
    files = []
    if arguments.output is not None:
        try:
            arguments.output.parent.mkdir(parents=True, exist_ok=True)
            arguments.output.write_text(text, encoding='utf-8')
        except OSError as error:
            raise CamMotionError(
                f'{arguments.output}: cannot be written: {error.strerror or error}') from error
        files.append(arguments.output)
    if arguments.picture is not None:
        from cam_motion.io.plots import FORMATS, optimal_figure
        if arguments.picture.suffix[1:] not in FORMATS:
            raise ConfigurationError([Problem(
                '--picture', str(arguments.picture), 'must end in .' + ', .'.join(FORMATS))])
        movement = found.movement
        files.append(save_figure(optimal_figure(
            movement.name, (movement.law, movement.before), (found.law.name, found.law.curve),
            [math.copysign(movement.scale(order), movement.lift) for order in range(4)],
            movement.unit,
            [movement.limits.of_order(order) for order in (1, 2, 3)]), arguments.picture))
    return files


def _broken(name: str) -> str:
    """Break a long name, so that two of them fit beside each other in 80 columns."""
    return name if len(name) <= _LONG else name.replace('_', '_\n')


def _print(found: Optimised) -> None:
    movement, before, after = found.movement, found.before, found.after
    limits = [movement.limits.of_order(order) for order in (1, 2, 3)]
    out = table(
        f'{movement.name}: {number(movement.lift)} {movement.unit} in '
        f'{number(movement.span / DEGREE)} deg at {number(movement.omega / RPM)} cycles/min, '
        f'least {_goal(found.wish.weights)}', [
            ('', 'left'), (f'before\n{_broken(movement.law)}', 'right'),
            (f'after\n{_broken(found.law.name)}', 'right'), ('change', 'right'),
            ('limit', 'right'), ('', 'left')])
    torques = [(f'{kind} motor torque', f'{kind.lower()}_torque', 1.0, None, 'N m')
               for kind in ('Peak', 'RMS') if f'{kind.lower()}_torque' in after]
    lines = [
        ('Cv', 'peak_velocity', 1.0, None, ''), ('Ca', 'peak_acceleration', 1.0, None, ''),
        ('Cj', 'peak_jerk', 1.0, None, ''),
        ('RMS acceleration', 'rms_acceleration', 1.0, None, ''),
        ('RMS jerk', 'rms_jerk', 1.0, None, ''),
        *((f'peak {name}', f'peak_{name}', movement.scale(order), limits[order - 1],
           rate_text(movement.unit, order)) for order, name in enumerate(_RATES, 1)),
        ('RMS acceleration', 'rms_acceleration', movement.scale(2), None,
         rate_text(movement.unit, 2)), *torques]
    for place, (label, name, scale, limit, unit) in enumerate(lines):
        if place == 5:
            out.add_section()
        row(out, label, number(before[name] * scale), number(after[name] * scale),
            _change(before[name], after[name]), '' if limit is None else number(limit), unit,
            style='bold' if name in found.wish.weights else None)
    if len(found.wish.weights) > 1:
        out.add_section()
        row(out, 'weighted sum', *map(number, found.objectives), _change(*found.objectives),
            '', '', style='bold')
    console().print(out)


def _change(before: float, after: float) -> str:
    if math.isinf(before) or math.isinf(after) or not before:
        return ''
    return f'{100.0 * (after / before - 1.0):+.2f} %'


def _goal(weights: Mapping[str, float]) -> str:
    names = {name: name.replace('_', ' ').replace('rms', 'RMS') for name in weights}
    if len(weights) == 1:
        return next(iter(names.values()))
    return ' + '.join(f'{number(weight)} {names[name]}' for name, weight in weights.items())


def _weights(text: str) -> dict[str, float]:
    found: dict[str, float] = {}
    for part in text.split(','):
        name, given, weight = part.strip().partition('=')
        if name not in OBJECTIVES or name in found:
            raise argparse.ArgumentTypeError(
                f'{name!r}: must be one of {", ".join(OBJECTIVES)}, each once')
        found[name] = finite_number(weight) if given else 1.0
        if found[name] <= 0.0:
            raise argparse.ArgumentTypeError(f'{part!r}: a weight must be above 0')
    return found
