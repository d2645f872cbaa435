# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The tables of the verb ``size``: the best candidates, and why the others are none."""

from __future__ import annotations

import math

from cam_motion.cli.terminal import console, number, row, table
from cam_motion.drive.sizing import Candidate, Check, OBJECTIVES, RULES
from cam_motion.drive.sizing_flywheel import SmallestFlywheel
from cam_motion.io.sizing import CONFIGURED, Options, OTHER_RATIO, SizedDrive

_COLUMNS = {
    'inverse': (
        ('peak_torque', 'peak\nN m'), ('rms_torque', 'RMS\nN m'), ('peak_speed_rpm', 'peak\nrpm'),
        ('inertia_ratio', 'inertia\nratio')),
    'forward': (
        ('mean_speed_rpm', 'mean\nrpm'), ('fluctuation_pct', 'fluct.\n%'),
        ('rms_motor_torque', 'RMS\nN m'), ('stability_pct', 'stab.\n%'),
        ('motor_work_per_cycle', 'work\nJ')),
}
_NARROW = 100  # columns; below, the figures of second rank are left out
_SECOND = ('rms_motor_torque', 'stability_pct', 'motor_work_per_cycle')
_METHODS = {'inverse': 'inverse dynamics', 'forward': 'periodic motion'}


def print_sizing(sized: SizedDrive, options: Options, top: float, everything: bool) -> None:
    """
    Print what was found for a drive.

    Parameters
    ----------
    sized : SizedDrive
        The drive.
    options : Options
        What was wanted.
    top : float
        How many of the ranked candidates are shown at most.
    everything : bool
        Whether the rejected candidates are shown one by one.

    """
    sizing, out = sized.sizing, console()
    total = len(sizing.ranked) + len(sizing.rejected)
    best = OBJECTIVES[sizing.method][sizing.objective].text
    out.print(f'{sized.name}: {total} candidates by {_METHODS[sizing.method]}, '
              f'{len(sizing.ranked)} keep every rule', style='bold')
    if sizing.ranked:
        shown = sizing.ranked[:int(min(top, len(sizing.ranked)))]
        _print_ranked(sized, shown, f'{len(shown)} of {len(sizing.ranked)}, ranked by: {best}')
        for name in dict.fromkeys((shown[0].motor, shown[0].gearbox)):
            if name in sized.sources:
                out.print(f'{name}: {sized.sources[name]}', style='dim')
    if sizing.rejected:
        _print_rejections(sized)
        _print_nearest(sized)
    if everything and sizing.rejected:
        _print_rejected(sized)
    if sized.flywheel is not None and sized.flywheel_for is not None:
        out.print(flywheel_text(sized.flywheel, sized.flywheel_for))


def _choice(one: Candidate, short: bool = False) -> str:
    own = one.gearbox in (CONFIGURED, OTHER_RATIO)
    box = '' if own and short else f', gearbox {one.gearbox}'
    wheel = '' if one.flywheel is None else f', flywheel {number(one.flywheel, 4)} kg m²'
    return f'{one.motor}{box}, ratio {number(one.ratio)}{wheel}'


def _print_ranked(sized: SizedDrive, shown: tuple[Candidate, ...], title: str) -> None:
    sizing = sized.sizing
    out, forward = console(), sizing.method == 'forward'
    narrow = forward and out.width < _NARROW
    columns = [column for column in _COLUMNS[sizing.method]
               if not narrow or column[0] not in _SECOND]
    made = table(title, [
        ('motor', 'left'), ('kW', 'right'), ('gearbox', 'left'), ('ratio', 'right'),
        *((('flywheel\nkg m²', 'right'),) if forward else ()),
        *((heading, 'right') for _, heading in columns), ('margin\n%', 'right')],
        'margin: to the rule kept most narrowly')
    for one in shown:
        row(made, one.motor, number(one.rated_power / 1e3, 4), one.gearbox, number(one.ratio, 5),
            *((number(one.flywheel or 0.0, 4),) if forward else ()),
            *(number(one.figures[name], 4) for name, _ in columns),
            number(one.least_margin_pct, 3))
    out.print(made)


def _print_rejections(sized: SizedDrive) -> None:
    sizing = sized.sizing
    made = table(f'{len(sizing.rejected)} rejected', [
        ('rule', 'left'), ('what it compares', 'full'), ('broken by', 'right'),
        ('least miss', 'right')], 'a candidate may break several rules')
    for rule, count in sizing.rejections.items():
        misses = [check for one in sizing.rejected for check in one.broken if check.rule == rule]
        least = min(misses, key=lambda check: check.by_pct)
        row(made, rule, RULES[rule], str(count), _by(least))
    console().print(made)


def _by(check: Check) -> str:
    if check.failed or not math.isfinite(check.by_pct):
        return '–'
    return f'{number(check.by_pct, 3)} %'


def reason(check: Check) -> str:
    """
    Say which rule is broken, and by how much.

    Parameters
    ----------
    check : Check
        A broken rule.

    Returns
    -------
    str
        Rule, value, bound and share.

    """
    unit = f' {check.unit}' if check.unit else ''
    if check.failed:
        return (f'{check.rule}: none; the motor gives up to {number(check.value, 4)}{unit} at the '
                f'cam shaft, the load takes up to {number(check.bound, 4)}{unit}')
    if check.rule == 'contact':
        return f'contact: {number(check.value, 4)}{unit} on the cam: the follower lifts off'
    word = 'at least' if check.at_least else 'at most'
    return (f'{check.rule}: {number(check.value, 4)}{unit}, {word} '
            f'{number(check.bound, 4)}{unit} allowed: off by {number(check.by_pct, 3)} %')


def _print_nearest(sized: SizedDrive) -> None:
    sizing, out = sized.sizing, console()
    one = sizing.rejected[0]
    if sizing.ranked:
        out.print('nearest miss:', _choice(one))
    else:
        rule, count = next(iter(sizing.rejections.items()))
        out.print(f'Nothing fits: {rule} rejects the most, {count} of {len(sizing.rejected)}. '
                  f'The nearest miss: {_choice(one)}', style='bold')
    for check in one.broken:
        out.print('  ' + reason(check))


def _print_rejected(sized: SizedDrive) -> None:
    made = table('rejected, the nearest miss first', [('candidate', 'full'), ('why', 'full')])
    for one in sized.sizing.rejected:
        row(made, _choice(one, short=True), '\n'.join(reason(check) for check in one.broken))
    console().print(made)


def flywheel_text(found: SmallestFlywheel, choice: tuple[str, str, float]) -> str:
    """
    Say what the search for the smallest flywheel found.

    Parameters
    ----------
    found : SmallestFlywheel
        What it found.
    choice : tuple[str, str, float]
        Motor, gearbox and ratio.

    Returns
    -------
    str
        One sentence.

    """
    motor, gearbox, ratio = choice
    drive = ('the configured drive' if motor == gearbox == CONFIGURED else
             f'{motor}, gearbox {gearbox}, ratio {number(ratio)}')
    wanted = f'a fluctuation of {number(found.wanted_pct)} %'
    if found.flywheel is None:
        reached = ('there is no periodic motion' if found.with_largest_pct is None else
                   f'{number(found.with_largest_pct, 4)} % remain')
        return (f'smallest flywheel for {wanted}: none up to {number(found.largest)} kg m²; '
                f'{reached} ({drive})')
    if found.flywheel == 0.0:
        return (f'{wanted} needs no flywheel: {number(found.fluctuation_pct or 0.0, 4)} % '
                f'without one ({drive})')
    without = ('no periodic motion' if found.without_pct is None else
               f'{number(found.without_pct, 4)} %')
    return (f'smallest flywheel for {wanted}: {number(found.flywheel)} kg m² ({drive}; '
            f'{without} without)')
