# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``check``: problems, peaks per segment, highest speed and what holds it back."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence

from cam_motion.cli.options import add_config, add_json, add_speed
from cam_motion.cli.terminal import console, number, print_json, print_problems, row, speed, table
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.config import read_sections
from cam_motion.io.contour import disc_text
from cam_motion.io.linkage_data import range_text
from cam_motion.io.summary import AxisSummary, bound_text, check_sections, CheckSummary, SLACK
from cam_motion.io.summary_data import check_as_data
from cam_motion.motion.continuity import Continuity, Joint
from cam_motion.motion.limits import QUANTITIES
from cam_motion.units import DEGREE, rate_text, RPM

_DERIVATIVES = (*QUANTITIES, 'snap', '5th derivative', '6th derivative')


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = (
        'Check a machine file: every problem at once, the peaks of each segment at '
        'the set speed, the continuity class of each joint, and the highest speed '
        'within the limits of every axis. Exit code 2 if there is any problem.')
    parser.epilog = (
        'Class Ck: all derivatives up to order k run through. C0: the velocity steps, '
        'which no cam may; C1: the acceleration does; C2: the jerk.')
    add_config(parser)
    add_speed(parser)
    add_json(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Check a machine file and print what was found.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0 where all is well, 2 where there is a problem.

    """
    try:
        check = check_sections(read_sections(arguments.config), arguments.speed_cpm)
    except ConfigurationError as error:
        check = CheckSummary(error.problems, None, {})
    if arguments.json:
        print_json(check_as_data(check))
    else:
        _print(check, arguments.config)
    return 2 if check.problems else 0


def _print(check: CheckSummary, source: str) -> None:
    out = console()
    for axis in check.axes.values():
        _print_axis(axis, check.speed_cpm or 0.0)
    for name, cams in check.stepping.items():
        _print_joints(name, cams, check.units.get(name, 'unit'), check.speed_cpm or 0.0)
    if check.axes:
        line = check.line_bound
        if line is None:
            out.print('highest speed not limited: no axis has limits that bind')
        else:
            name, bound = line
            unit = check.axes[name].axis.unit
            out.print(f'highest speed {speed(bound.omega)} cycles/min, '
                      f'held back by {name}, {bound_text(bound, unit)}', style='bold')
    if check.margins:
        _print_margins(check)
    for name, each in check.interlocks.items():
        out.print(f'interlock {name}: kept, {each.verdict.text}')
    for name, disc in check.cam_discs.items():
        out.print(f'cam disc {name}: {disc_text(disc)}')
    for name, settings in check.linkages.items():
        for variable in settings.linkage.inputs:
            out.print(f'linkage {name}, {range_text(settings, variable)}')
    _print_warnings(check.warnings)
    if check.problems:
        out.file.flush()
        print_problems(check.problems, source)
    else:
        count = len(check.warnings)
        out.print(f'no problems in {source}' + (
            f', {count} warning{"s" * (count > 1)}' if count else ''))


def _print_warnings(warnings: Sequence[Problem]) -> None:
    # joints with one way out share it: the two ends of a segment, mostly
    ways: dict[tuple[str, str], list[str]] = {}
    for each in warnings:
        ways.setdefault((each.path, each.hint), []).append(each.rule)
    for (path, hint), rules in ways.items():
        for rule in rules:
            console().print(f'warning: {path}: {rule}', style='yellow')
        if hint:
            console().print(f'  {hint}')


def _print_axis(summary: AxisSummary, speed_cpm: float) -> None:
    axis, bound = summary.axis, summary.bound
    caption = 'no limit binds'
    if bound is not None:
        caption = (f'up to {speed(bound.omega)} cycles/min; '
                   f'limited by {bound_text(bound, axis.unit)}')
    advance = axis.profile.advance
    gain = f', advances {number(advance)} {axis.unit} per cycle' if advance else ''
    out = table(
        f'{axis.name} at {number(speed_cpm)} cycles/min{gain}', [
            ('segment', 'left'), ('law', 'left'), ('from\ndeg', 'right'), ('to\ndeg', 'right'),
            (f'lift\n{axis.unit}', 'right'),
            *((f'{name}\n{rate_text(axis.unit, order)}', 'right')
              for order, name in enumerate(QUANTITIES[1:], start=1)),
        ], caption)
    limits = [axis.limits.of_order(order) for order in (1, 2, 3)]
    for segment in summary.segments:
        figures = [number(segment.start_deg), number(segment.end_deg)]
        if segment.law != 'dwell':
            figures += [number(segment.lift), *map(_figure, segment.physical, limits)]
        else:
            figures += [''] * 4
        row(out, segment.name, segment.law, *figures,
            style='dim' if segment.law == 'dwell' else None)
    if any(limits):
        out.add_section()
        row(out, 'limit', '', '', '', '', *('' if x is None else number(x) for x in limits))
    console().print(out)
    _print_joints(axis.name, summary.continuity, axis.unit, speed_cpm)
    verdict = 'runs' if summary.runs_at(speed_cpm * RPM) else 'does not run'
    console().print(f'{axis.name} {verdict} at {number(speed_cpm)} cycles/min\n')


def _print_joints(axis: str, cams: Mapping[str, Continuity], unit: str, speed_cpm: float) -> None:
    omega = speed_cpm * RPM
    for cam, continuity in cams.items():
        weakest = continuity.weakest
        what = 'nothing steps' if weakest.order is None else (
            f'the {_DERIVATIVES[weakest.order]} steps, '
            f'first at {number(weakest.at / DEGREE)} deg')
        out = table(
            f'{axis if len(cams) == 1 else f"{axis}, {cam}"}: class {continuity.label}, {what}', [
                ('joint', 'left'), ('at\ndeg', 'right'), ('class', 'left'), ('steps', 'left'),
                ('by', 'right'), (f'at {number(speed_cpm)}\ncycles/min', 'right'),
                ('inside the\nsegment', 'left')])
        for each in continuity.joints:
            joint, inside = each.joint, each.inside
            row(out, f'{each.before.name} | {each.after.name}', number(joint.at / DEGREE),
                joint.label, *_step(joint, unit, omega),
                '' if inside is None else f'{inside.label} at {number(inside.at / DEGREE)}',
                style='bold red' if joint.continuity < 1 else None)
        console().print(out)


def _step(joint: Joint, unit: str, omega: float) -> tuple[str, str, str]:
    """Say what steps at a joint and by how much, per rad and at the set speed."""
    if joint.order is None:
        return '', '', ''
    return (_DERIVATIVES[joint.order],
            f'{number(joint.step, 4)} {rate_text(unit, joint.order, "rad")}',
            f'{number(joint.step_at(omega), 4)} {rate_text(unit, joint.order)}')


def _print_margins(check: CheckSummary) -> None:
    out = table("left of the motors' limits", [
        ('drive', 'left'), ('peak torque\nN m', 'right'), ('RMS torque\nN m', 'right'),
        ('speed\nrpm', 'right')])
    for name, left in check.margins.items():
        figures = (left.peak_torque_margin, left.rms_torque_margin, left.speed_margin / RPM)
        row(out, name, *(('! ' if figure < 0.0 else '') + number(figure) for figure in figures))
    console().print(out)


def _figure(value: float, limit: float | None) -> str:
    """Write a peak, marked where it exceeds its limit."""
    broken = limit is not None and abs(value) > limit * (1.0 + SLACK)
    return ('! ' if broken else '') + number(value)
