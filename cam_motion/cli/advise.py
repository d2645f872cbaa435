# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``advise``: which motion law, and which filter, a movement should have."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
import re

from cam_motion.cli.options import add_json, add_speed, finite_number
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
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io import advice as advising
from cam_motion.io.advice import Advice
from cam_motion.io.advice_data import advice_as_data
from cam_motion.io.advice_movement import movement, Question
from cam_motion.io.advice_questions import questions
from cam_motion.io.config import read_sections
from cam_motion.io.filter_advice import (
    advise_filters,
    delay_deg,
    FilterFigures,
    filters_as_data,
)
from cam_motion.io.parameters import check_values
from cam_motion.io.shaping import load_of, load_problems
from cam_motion.io.shaping_parameters import SHAPING
from cam_motion.io.summary import turning_drive, with_speed
from cam_motion.motion.advice import BALANCED, Candidate, CRITERIA
from cam_motion.motion.laws import Boundary, LAWS
from cam_motion.motion.laws.fitted import told_to
from cam_motion.motion.shaped_profile import ShapedProfile
from cam_motion.motion.shaping_effect import ERRORS, Load
from cam_motion.motion.spline import EndState
from cam_motion.units import rate_text, RPM, TURN

_WHAT_SWINGS = ('frequency_hz', 'damping', 'container_width', 'container_radius', 'fill_height')
_WIDE = 170  # columns needed for figures and reasons side by side
_ENDS = {end.value.replace(' ', '_'): end for end in Boundary}


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = (
        'Rank the motion laws for movements of a machine file, or for one given by '
        '--lift, --span-deg and --speed-cpm: peaks, RMS, torque and energy of the '
        'drive that follows the axis over its whole cycle, and the vibration left '
        'where something swings, with a reason for each law. What swings is told by '
        '--frequency-hz, by a container with liquid, or by shaping in the file; then '
        'filters are compared too.')
    parser.add_argument('config', metavar='CONFIG', nargs='?',
                        help='machine file; without one, describe the movement')
    parser.add_argument('movements', metavar='AXIS[.SEGMENT]', nargs='*',
                        help='movements to advise upon (default: all)')
    alone = parser.add_argument_group('a movement on its own')
    for name, meaning in (('lift', 'what it moves by'), ('span-deg', 'over which angle [deg]')):
        alone.add_argument(f'--{name}', type=finite_number, metavar='X', help=meaning)
    alone.add_argument('--unit', default='m', help='its unit (default: m)')
    for name in ('start', 'end'):
        alone.add_argument(f'--{name}', choices=sorted(_ENDS),
                           help=f'what it joins at its {name} (default: what the two below say, '
                                'else rest)')
        for order, what in enumerate(('velocity', 'acceleration'), start=1):
            alone.add_argument(f'--{name}-{what}', type=finite_number, metavar='X',
                               help=f'{what} of its neighbour there [unit/s{"²" * (order - 1)}]')
    add_speed(parser)
    swings = parser.add_argument_group('what swings behind the axis')
    for name, meaning in (
            ('frequency-hz', 'its natural frequency'), ('damping', 'its damping ratio'),
            ('container-width', 'or: inner width of a box with liquid [m]'),
            ('container-radius', 'or: inner radius of a cylinder with liquid [m]'),
            ('fill-height', 'height of the liquid [m]')):
        swings.add_argument(f'--{name}', type=finite_number, metavar='X', help=meaning)
    parser.add_argument('--by', choices=CRITERIA, default=BALANCED,
                        help='what counts (default: balanced, the geometric mean of velocity, '
                             'acceleration or peak torque, jerk, power, and RMS acceleration or '
                             'torque)')
    parser.add_argument('--allow-steps', action='store_true',
                        help='rank laws whose acceleration steps with the others')
    parser.add_argument('-o', '--output', metavar='DIR', type=Path,
                        help='draw the best laws, and the filters, into this directory')
    add_json(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Advise and print.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0.

    Raises
    ------
    ConfigurationError
        When the movement or the machine file cannot be used.

    """
    asked = _questions(arguments)
    found: list[tuple[Advice, str, list[FilterFigures]]] = []
    with progress() as bar:
        for question in bar.track(asked, description='trying laws'):
            advice = advising.advise(question, arguments.by, arguments.allow_steps)
            taken = _law_taken(advice)
            filters = [] if taken is None else advise_filters(question, taken.law)
            found.append((advice, '' if taken is None else taken.law.name, filters))
    files = [] if arguments.output is None else _draw(found, arguments.output)
    if arguments.json:
        written = {} if arguments.output is None else {'files': [str(file) for file in files]}
        print_json({'movements': [
            {**advice_as_data(advice), 'filters_over': law,
             'filters': filters_as_data(advice.question, filters)}
            for advice, law, filters in found], **written})
        return 0
    for advice, law, filters in found:
        _print(advice)
        if filters:
            _print_filters(advice.question, law, filters)
    print_files(files)
    return 0


def _questions(arguments: argparse.Namespace) -> list[Question]:
    load, problems = _load(arguments)
    alone = {'--lift': arguments.lift, '--span-deg': arguments.span_deg}
    at_ends = {f'--{name}': getattr(arguments, name.replace('-', '_')) for name in (
        'start', 'start-velocity', 'start-acceleration', 'end', 'end-velocity',
        'end-acceleration')}
    if arguments.config is not None:
        alone |= at_ends
        problems += [Problem(name, value, 'describes a movement on its own',
                             'leave it out, or the machine file')
                     for name, value in alone.items() if value is not None]
        if problems:
            raise ConfigurationError(problems)
        sections = read_sections(arguments.config)
        if arguments.speed_cpm is not None and not turning_drive(sections):
            sections = with_speed(sections, arguments.speed_cpm)
        return questions(sections, arguments.movements, load)
    alone['--speed-cpm'] = arguments.speed_cpm
    problems += [
        Problem(name, value, 'must be given for a movement on its own, not zero',
                'or give a machine file') for name, value in alone.items() if not value]
    problems += [
        Problem(name, value, 'must be above 0' + (f' and at most {most:g}' if most else ''))
        for name, most in (('--span-deg', 360.0), ('--speed-cpm', None))
        if (value := alone[name]) and not 0.0 < value <= (most or value)]
    if problems:
        raise ConfigurationError(problems)
    states = [EndState(*(at_ends[f'--{name}-{what}'] or 0.0
                         for what in ('velocity', 'acceleration'))) for name in ('start', 'end')]
    kinds = [Boundary.of(*state, 1.0, 1.0) if at_ends[f'--{name}'] is None
             else _ENDS[at_ends[f'--{name}']] for name, state in zip(('start', 'end'), states)]
    return [movement(
        arguments.lift, arguments.span_deg, arguments.speed_cpm, (kinds[0], kinds[1]), load,
        arguments.unit, *states)]


def _load(arguments: argparse.Namespace) -> tuple[Load | None, list[Problem]]:
    """Read what swings from the options; None where they say nothing, or nothing usable."""
    given = {f'shaping.{name}': value for name in _WHAT_SWINGS
             if (value := getattr(arguments, name)) is not None}
    if not given:
        return None, []
    values, problems = check_values(SHAPING, given)
    problems += [] if problems else load_problems(values)
    if problems:
        return None, [
            Problem('--' + each.path.removeprefix('shaping.').replace('_', '-'), each.value,
                    each.rule, each.hint) for each in problems]
    return load_of(values), []


def _law_taken(advice: Advice) -> Candidate | None:
    """Choose the law over which filters are compared: the configured one, else the best."""
    listed = [each.candidate for each in (*advice.ranking, *advice.stepping)]
    return next((each for each in listed if each.configured), listed[0] if listed else None)


def _print(advice: Advice) -> None:
    question, unit = advice.question, advice.question.unit
    known: Mapping[str, float] = next(
        (each.candidate.figures for each in (*advice.ranking, *advice.stepping)), {})
    columns = [(f'{name}\n{rate_text(unit, order)}', f'peak_{name}')
               for order, name in enumerate(('velocity', 'acceleration', 'jerk'), start=1)]
    columns += [('RMS acc.\n' + rate_text(unit, 2), 'rms_acceleration')] if (
        'rms_torque' not in known) else []
    columns += [(heading, name) for heading, name in (
        (f'left\n{unit}', 'residual'), ('peak torque\nN m', 'peak_torque'),
        ('RMS torque\nN m', 'rms_torque'), ('energy\nJ', 'energy')) if name in known]
    screen = console()
    # a narrow terminal gets the reasons as a list of their own
    wide = screen.width >= _WIDE
    heading = f'by {advice.by}' + (' (1: the best in everything)' * (advice.by == BALANCED))
    out = table(
        f'{question.name}: {number(question.lift)} {unit} over '
        f'{number(question.end_deg - question.start_deg)} deg, {number(question.duration, 4)} s '
        f'at {number(question.shaft_speed / RPM)} cycles/min, from {question.ends[0].value} to '
        f'{question.ends[1].value}', [
            ('', 'right'), ('law', 'left'), *((heading, 'right') for heading, _ in columns),
            *([(heading, 'full')] if wide else [])], _caption(advice) if wide else '')
    reasons = table('', [('', 'right'), ('law', 'left'), (heading, 'full')], _caption(advice))
    for places in (advice.ranking, advice.stepping):
        for place, each in enumerate(places, start=1):
            found, ranked = each.candidate, places is advice.ranking
            head = (str(place) if ranked else '', found.law.name + ' *' * found.configured)
            score = f'{number(each.score, 4)}  ' * (ranked and advice.by == BALANCED)
            same = f'; the same as {", ".join(found.same_as)}' if found.same_as else ''
            parameters = '' if found.configured else told_to(found.law)
            told = f'; with {parameters}' if parameters else ''
            figures = [number(found.figures[key], 4) for _, key in columns]
            why = score + each.reason + told + same
            row(out, *head, *figures, *([why] if wide else []))
            row(reasons, *head, why)
        out.add_section()
        reasons.add_section()
    screen.print(out)
    if not wide:
        screen.print(reasons)
    # laws that cannot be taken for one reason share a line
    refusals: dict[str, list[str]] = {}
    for refused in advice.refused:
        refusals.setdefault(refused.refusal, []).append(
            refused.law.name + ' (now)' * refused.configured)
    for text, names in refusals.items():
        screen.print(f'not {", ".join(names)}: {text}')
    screen.print()


def _caption(advice: Advice) -> str:
    said = ['Per cents: against the least among the numbered laws. * the law it has now.']
    if beside := advice.question.names_beside:
        said.append(f'The figures cover {", ".join(beside)} as well: shape and peaks there follow '
                    'from this law.')
    if advice.stepping:
        said.append('Without a number: the acceleration steps at an end, or within.')
    tunable = [each.candidate.law.name for each in advice.ranking[:3]
               if LAWS[each.candidate.law.name].parameters]
    if tunable:
        said.append('At its defaults, and may be tuned (cam_motion optimise): '
                    f'{", ".join(tunable)}.')
    return '\n'.join(said)


def _print_filters(question: Question, law: str, filters: list[FilterFigures]) -> None:
    load, unit = question.load, question.unit
    assert load is not None
    fit = isinstance(question.profile, ShapedProfile) and question.profile.fit
    what = 'height of the wave at the wall' if load.factor != 1.0 else 'deviation of the load'
    out = table(
        f'{question.name} with {law}: filters for {number(load.frequency / TURN, 4)} Hz, '
        f'damping {load.damping:g}', [
            ('filter', 'left'), ('takes\ndeg', 'right'), (f'largest\n{unit}', 'right'),
            (f'repeated\n{unit}', 'right'), (f'left\n{unit}', 'right'),
            *((f'{error * 100.0:+.0f} %\n{unit}', 'right') for error in ERRORS),
            ('vel.\n' + rate_text(unit, 1), 'right'),
            ('acc.\n' + rate_text(unit, 2), 'right')],
        f'Largest {what} during the movement, from rest and with the cycle repeated; what is\n'
        'left afterwards, also where the frequency is that much higher than assumed. ' + (
            'The movement\nis made shorter by what the filter takes, and ends in time.' if fit else
            'The movement\nends later by what the filter takes.'))
    for each in filters:
        if each.refusal:
            continue
        left = (each.residual, *each.residuals.values())
        row(out, each.kind,
            number(delay_deg(question, each.delay), 3), number(each.peak_deviation, 3),
            number(each.repeated_peak, 3),
            *(number(value if value > 1e-12 * abs(question.lift) else 0.0, 3) for value in left),
            number(each.peak_velocity, 3), number(each.peak_acceleration, 3))
    console().print(out)
    for each in filters:
        if each.refusal:
            console().print(f'not {each.kind}: {each.refusal}')
    console().print()


def _draw(found: list[tuple[Advice, str, list[FilterFigures]]], output: Path) -> list[Path]:
    from cam_motion.io.plots.advice import advice_figure, filter_figure
    files = []
    for advice, law, filters in found:
        name = re.sub(r'\W', '_', advice.question.name)
        if advice.ranking or advice.stepping:
            files.append(save_figure(advice_figure(advice), output / f'advice_{name}.png'))
        if filters:
            files.append(save_figure(
                filter_figure(advice.question, law, filters), output / f'filters_{name}.png'))
    return files
