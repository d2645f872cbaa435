# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``simulate``: what the drives of a machine do and what it costs them."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
import re
from typing import Any, TYPE_CHECKING

from cam_motion.cli.differences import why_they_differ
from cam_motion.cli.options import add_config, add_json
from cam_motion.cli.terminal import (
    console,
    number,
    print_files,
    print_json,
    row,
    save_figure,
    table,
)
from cam_motion.io.cam_drive_config import CamDriveSettings
from cam_motion.io.config import load_machine
from cam_motion.io.machine import Machine
from cam_motion.io.plain import plain
from cam_motion.io.simulation import live_cycle, simulate, start_up_until_settled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LABELS = {
    'peak_torque': ('peak motor torque', 'N m'), 'rms_torque': ('RMS motor torque', 'N m'),
    'peak_speed_rpm': ('peak motor speed', 'rpm'),
    'regenerated_energy_per_cycle': ('energy fed back per cycle', 'J'),
    'motor_work_per_cycle': ('work of the motor per cycle', 'J'),
    'drawn_work_per_cycle': ('work drawn while it drives', 'J'),
    'inertia_ratio': ('inertia of the load to that of the motor', ''),
    'peak_torque_margin': ('least distance from the peak torque', 'N m'),
    'rms_torque_margin': ('distance of the RMS from the continuous torque', 'N m'),
    'speed_margin_rpm': ('distance from the largest speed', 'rpm'),
    'mean_speed_rpm': ('mean speed', 'rpm'), 'rms_speed_rpm': ('RMS motor speed', 'rpm'),
    'peak_current': ('peak motor current', 'A'),
    'rms_current': ('RMS motor current', 'A'),
    'peak_following_error': ('peak following error', 'unit'),
    'rms_following_error': ('RMS following error', 'unit'),
    'saturated_s_per_cycle': ('at a limit, per cycle', 's'),
    'saturations_per_cycle': ('limits reached, per cycle', ''),
    'catches_up': ('catches up within each cycle', ''),
    'fluctuation_pct': ('speed fluctuation', '%'), 'stability_pct': ('stability', '%'),
    'running_cost_pct': ('running cost', '%'), 'period_s': ('period', 's'),
    'min_speed_rpm': ('least speed', 'rpm'), 'max_speed_rpm': ('greatest speed', 'rpm'),
    'min_contact_force': ('least contact force', 'N'),
    'min_contact_force_deg': ('at shaft angle', 'deg'),
    'peak_gearbox_torque': ('peak torque behind the gearbox', 'N m'),
    'gearbox_torque_margin': ('distance from its rated torque', 'N m'),
    'gearbox_speed_margin_rpm': ('distance from its largest speed', 'rpm'),
    'first_crossing_s': ('nominal speed first reached', 's'),
    'settled_s': ('settled: it stays above', 's'),
    'followed_s': ('followed for', 's'),
    'start_torque': ('torque at rest, at the cam shaft', 'N m'),
    'static_load_peak': ('peak of the static load', 'N m'),
    'steady_state_time_s': ('nominal speed first reached', 's'),
    'max_pressure_angle_deg': ('greatest pressure angle', 'deg'),
    'max_torque_estimate': ('torque at constant speed', 'N m'),
}
_PARTS = {'exact': 'exact motion', 'orbit': 'periodic motion', 'start_up': 'start-up from rest',
          'document': "document's definitions", 'servo': 'servo drive'}


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = (
        'Torque, speed and energy of every drive that follows an axis, at the set '
        'speed; periodic motion and start-up of every drive that turns a cam shaft, '
        'and the metrics of document 004 by its own definitions.')
    add_config(parser)
    parser.add_argument('-o', '--output', metavar='DIR', type=Path,
                        help='draw pictures of the drives into this directory')
    parser.add_argument('--no-document', action='store_true',
                        help="leave out the document's own Euler scheme, which takes seconds")
    add_json(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Simulate and print.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0; errors are raised.

    """
    machine = load_machine(arguments.config)
    messages = console(stderr=True)
    if messages.is_terminal and not arguments.json:
        with messages.status('') as status:
            results, files = _simulate(machine, arguments, status.update)
    else:
        results, files = _simulate(machine, arguments, lambda _: None)
    if arguments.json:
        # a machine with one drive, as most that are sized, answers without its name
        first = next(iter(results.values()), {})
        written = {} if arguments.output is None else {'files': [str(file) for file in files]}
        print_json(plain({**first, 'drives': results, **written}))
        return 0
    if not results:
        console().print('the machine has no drives')
    units = {name: machine.diagram.axes[drive.axis].unit
             for name, drive in machine.drives.items()}
    for name, result in results.items():
        _print(name, _columns(result), units.get(name, ''))
    print_files(files)
    return 0


def _simulate(machine: Machine, arguments: argparse.Namespace, tell: Callable[[str], None],
              ) -> tuple[dict[str, dict[str, Any]], list[Path]]:
    results = simulate(machine, not arguments.no_document, tell)
    files = []
    if arguments.output is not None:
        for name, draw in _pictures(machine):
            tell(f'drawing {name}')
            file = re.sub(r'\W', '_', name) + '.png'
            files.append(save_figure(draw(), arguments.output / file))
    return results, files


def _pictures(machine: Machine) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """Give the pictures of all drives: name of the file and how to draw it."""
    from cam_motion.drive.orbit import find_orbit
    from cam_motion.io import plots
    for name, follower in machine.drives.items():
        curve = plots.torque_curve(
            follower, machine.diagram.axes[follower.axis], machine.master.speed)
        live = live_cycle(machine, follower)
        yield f'torque_{name}', partial(
            plots.torque_figure, name, [curve], motor=follower.motor, live=live)
        if live is not None:
            unit = machine.diagram.axes[follower.axis].unit
            yield f'following_{name}', partial(plots.following_figure, name, live, unit)
    for name, drive in machine.cam_drives.items():
        orbit = find_orbit(drive.drive)
        run = start_up_until_settled(drive.drive, orbit)
        yield f'cam_{name}', partial(plots.cam_figure, drive)
        yield f'load_{name}', partial(plots.load_figure, drive)
        yield f'motor_{name}', partial(plots.motor_figure, drive, orbit)
        yield f'start_up_{name}', partial(plots.start_up_figure, drive, orbit, run)
        yield f'orbit_{name}', partial(plots.orbit_figure, drive, orbit)
        yield f'flywheel_{name}', partial(_flywheel, drive)


def _flywheel(drive: CamDriveSettings) -> Figure:
    from cam_motion.io.plots import flywheel_curve, flywheel_figure
    return flywheel_figure(drive, flywheel_curve(drive))


def _columns(result: dict[str, Any]) -> dict[str, Any]:
    """Put the exact cycle of a servo drive beside what it really does."""
    if 'servo' not in result:
        return result
    exact = {key: value for key, value in result.items() if key != 'servo'}
    return {'exact': exact, 'servo': result['servo']}


def _print(name: str, result: dict[str, Any], unit: str) -> None:
    parts = [key for key in _PARTS if key in result]
    if not parts:
        shown = table(name, [('one cycle', 'left'), ('', 'right'), ('', 'left')])
        for key, value in result.items():
            row(shown, _LABELS[key][0], _text(value), _LABELS[key][1])
        console().print(shown)
        return
    shown = table(name, [('', 'left'), *((_PARTS[part], 'right') for part in parts),
                         ('', 'left')])
    # the document calls one figure by another name: what means the same shares a row
    by_label = [{_LABELS[key]: value for key, value in result[part].items()} for part in parts]
    for label in dict.fromkeys(label for column in by_label for label in column):
        row(shown, label[0],
            *(_text(column[label]) if label in column else '' for column in by_label),
            unit if label[1] == 'unit' else label[1])
    console().print(shown)
    if 'document' in parts:
        console().print(why_they_differ(result))
    for warning in result.get('warnings', ()):
        console().print(f'warning: {warning}', style='bold yellow')


def _text(value: float | bool | None) -> str:
    if isinstance(value, bool):
        return 'yes' if value else 'no'
    return '–' if value is None else number(value, 6)
