# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``format``: change the format of a running line, on all axes at once or on none."""

from __future__ import annotations

import argparse
from typing import Any, TYPE_CHECKING

from cam_motion.cli.child import require_ros
from cam_motion.cli.options import add_config, add_json, finite_number
from cam_motion.cli.terminal import console, number, print_json, row, table
from cam_motion.io.config import read_sections
from cam_motion.io.format_change import FormatError, FormatPlan, plan_format
from cam_motion.io.machine import build_machine, ShaftDrive
from cam_motion.io.plain import finite
from cam_motion.io.summary import turning_drive, with_speed
from cam_motion.units import DEGREE, RPM, TURN

if TYPE_CHECKING:
    from cam_motion.io.axis import Values
    from cam_motion.io.machine import Machine
    from cam_motion.nodes.format_client import FormatClient


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = (
        'Check the machine file of a new format against limits and interlocks at the '
        'present speed, let every axis of the running line check its part, and let '
        'all of them go over to it at the same shaft angle. Exit code 1 if any of '
        'this is refused: then nothing has changed.')
    add_config(parser)
    parser.add_argument('--at-deg', type=finite_number, metavar='X',
                        help='shaft angle at which to begin [deg] (default: where it is gentlest)')
    parser.add_argument('--namespace', default='', metavar='NS', help='namespace of the line')
    parser.add_argument('--dry', action='store_true',
                        help='let everything be checked, and change nothing')
    add_json(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Change the format of a running line.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0 when it has been changed, or would be; 1 when it was refused.

    Raises
    ------
    ConfigurationError
        When the machine file cannot be used.
    FormatError
        When there is no line, or the change is refused.

    """
    sections = read_sections(arguments.config)
    build_machine(sections)
    require_ros()
    from cam_motion.nodes.format_client import FormatClient
    with FormatClient(arguments.namespace) as client:
        plan, machine = _planned(client, sections, arguments)
        outcome = 'nothing to change: the line has this format'
        start = None
        if plan.axes:
            client.stage(plan)
            try:
                start = None if arguments.dry else client.take_over(plan)
            except BaseException:
                client.revoke(plan)
                raise
            if start is None:
                client.drop(plan)
            outcome = 'all axes would change' if start is None else _wait(client, plan, start)
    if arguments.json:
        print_json(_as_data(plan, start, outcome))
    else:
        _print(plan, machine, start, outcome)
    return 0


def _planned(client: FormatClient, sections: dict[str, Values], arguments: argparse.Namespace,
             ) -> tuple[FormatPlan, Machine]:
    """Look at the running line, and check and plan the change at its present speed."""
    machine = build_machine(sections)
    found = client.find(list(machine.diagram.axes))
    if not found:
        raise FormatError('no axis is running here: start the line first'
                          + (f' (looked in {arguments.namespace})' if arguments.namespace else ''))
    shaft = client.shaft()
    speed = shaft.velocity
    if not isinstance(machine.master, ShaftDrive) and (shaft.acceleration or not speed):
        # it stands or is on its way: what counts is the fastest that it may come to
        speed = max(speed, (client.set_speed(machine.master.name) or 0.0) * RPM, key=abs)
    if not turning_drive(sections) and speed:
        machine = build_machine(with_speed(sections, speed / RPM))
    at = None if arguments.at_deg is None else arguments.at_deg % 360.0 * DEGREE
    running = {axis: client.parameters(axis) for axis in found}
    return plan_format(machine, sections, running, speed, at, client.standing), machine


def _wait(client: FormatClient, plan: FormatPlan, start: float) -> str:
    """Wait for the change; a Ctrl-C meanwhile calls it off, if it has not begun."""
    try:
        if client.wait(plan, start):
            return 'changed'
    except KeyboardInterrupt:
        client.revoke(plan)
        raise
    return 'the shaft stands: the axes change when it turns'


def _print(plan: FormatPlan, machine: Machine, start: float | None, outcome: str) -> None:
    out = console()
    if plan.axes:
        made = table('new format', [
            ('axis', 'left'), ('parameter', 'left'), ('before', 'right'), ('after', 'right')])
        for name, change in plan.axes.items():
            for key, (before, after) in change.differences.items():
                row(made, name, key, _text(before), _text(after))
        out.print(made)
        for name, change in plan.axes.items():
            if change.plan is not None:
                out.print(f'{name}: {change.plan.text(machine.diagram.axes[name].unit)}')
            else:
                out.print(f'{name}: stands, and has the new format when it engages')
        for name, verdict in plan.verdicts.items():
            out.print(f'interlock {name}: kept on the way, {verdict.text}')
    where = ''
    if start is not None:
        at, cycle = plan.at / DEGREE, round((start - plan.at) / TURN)
        where = f' at {at:.6g} deg of cycle {cycle}, over {plan.span / DEGREE:.4g} deg'
    out.print(f'{outcome}{where}', style='bold')


def _text(value: Any) -> str:
    if isinstance(value, float):
        return number(value)
    return '' if value is None else str(value)


def _as_data(plan: FormatPlan, start: float | None, outcome: str) -> dict[str, Any]:
    def planned(name: str) -> dict[str, Any] | None:
        found = plan.axes[name].plan
        return None if found is None else {
            'peak_velocity': found.peaks.velocity, 'peak_acceleration': found.peaks.acceleration,
            'max_speed_cpm': finite(found.highest_speed / RPM)}
    return {
        'outcome': outcome, 'at_deg': plan.at / DEGREE, 'span_deg': plan.span / DEGREE,
        'start_deg': None if start is None else start / DEGREE, 'speed_cpm': plan.speed / RPM,
        'axes': {name: {
            'differences': {key: list(pair) for key, pair in change.differences.items()},
            'transition': planned(name)} for name, change in plan.axes.items()},
        'interlocks': {name: verdict.text for name, verdict in plan.verdicts.items()},
    }
