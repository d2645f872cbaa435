# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What is wrong with a cam table: where, how badly, and the way out."""

from __future__ import annotations

from collections.abc import Iterator
import math

from cam_motion.io.tables.finding import Context, ERROR, Finding, NOTE, WARNING
from cam_motion.io.tables.outliers import Break, breaks_in, second_differences
from cam_motion.io.tables.resolution import rounded_angles, rounded_positions, too_few_points
from cam_motion.io.tables.table import CamTable, LINEAR, RETURN
from cam_motion.motion.piece import Array
from cam_motion.motion.spline import interpolate, NATURAL, PERIODIC
from cam_motion.units import DEGREE, rate_text, TURN
import numpy as np

_STAIRS = 4  # so many velocity steps on straight lines are a staircase
_DIFFERS = 0.02  # share of its peak by which a column may differ from the positions
_MOST_FINDINGS = 8


def lint(table: CamTable, omega: float, unit: str = 'unit') -> list[Finding]:
    """
    Look for whatever is wrong with a table.

    Parameters
    ----------
    table : CamTable
        The table.
    omega : float
        Speed of the shaft at which the harm is told [rad/s].
    unit : str
        Unit of the positions.

    Returns
    -------
    list[Finding]
        Everything found, errors first; nothing for a table that makes a good cam.

    """
    context = Context(table, omega, unit)
    found = _unusable(context)
    if not found:
        found += _ends(context)
        # unequal ends are no corner besides
        last = len(table.angle) - 2 if found else len(table.angle)
        steps = [each for each in breaks_in(table) if each.place < last]
        found += _steps(context, steps)
        if table.velocity is not None:
            found += _columns(context)
        if not steps:
            found += [*too_few_points(context), *rounded_angles(context),
                      *rounded_positions(context)]
    return sorted(found, key=lambda each: (ERROR, WARNING, NOTE).index(each.severity))


def errors_in(table: CamTable, unit: str = 'unit') -> list[Finding]:
    """
    Look for what keeps a table from being a cam at all.

    Parameters
    ----------
    table : CamTable
        The table.
    unit : str
        Unit of the positions.

    Returns
    -------
    list[Finding]
        The errors of `lint`.

    """
    return _unusable(Context(table, 1.0, unit))


def _unusable(context: Context) -> list[Finding]:
    return list(_order(context)) or list(_open(context))


def _order(context: Context) -> Iterator[Finding]:
    """Angles that stand still or fall."""
    table = context.table
    steps = np.diff(table.angle)
    if (steps < 0.0).all():
        yield context.found(
            'falling_angle', ERROR, 1, float(steps[0]) / DEGREE,
            'the angles fall from line to line', 'a cam is read by rising angle',
            'turn the order of the lines round')
        return
    for place in np.flatnonzero(steps <= 0.0)[:_MOST_FINDINGS] + 1:
        before, after = ((table.start + table.angle[n]) / DEGREE for n in (place - 1, place))
        same = before == after
        moved = table.position[place] - table.position[place - 1]
        yield context.found(
            'duplicate_angle' if same else 'falling_angle', ERROR, int(place), after - before,
            f'the angle {after:.6g} deg stands twice, with positions that differ by {moved:.5g} '
            f'{context.unit}' if same else
            f'the angle falls from {before:.6g} to {after:.6g} deg',
            'there is no curve through it: the velocity would be infinite' if same else
            'a cam is read by rising angle',
            f'remove one of the two lines, or --drop {table.lines[place]}' if same
            and place < len(table.angle) - 1 else 'remove one of the two lines' if same else
            'put the lines in order')


def closing_hint(table: CamTable) -> str:
    """
    Say with what a table whose ends differ can be taken over.

    Parameters
    ----------
    table : CamTable
        The table.

    Returns
    -------
    str
        The options: half of the gap goes into closing it, what is above that into smoothing.

    """
    return (f'--repair with more than {abs(table.advance) / 2.0:.3g}, '
            f'{0.6 * abs(table.advance):.2g} for example; --cycle accumulate for a belt')


def _open(context: Context) -> Iterator[Finding]:
    table = context.table
    last = len(table.angle) - 1
    if not table.covers_cycle:
        covered = table.angle[-1] / DEGREE
        counted = table.angle[-1] * table.per_radian
        radians = math.isclose(covered, TURN, rel_tol=1e-3)
        yield context.found(
            'open_cycle', ERROR, last, 360.0 - covered,
            f'the table covers {covered:.6g} of 360 deg', 'the cycle has no end',
            'these are radians: state --angle-unit rad' if radians else
            f'add the missing points; or state --cycle-length {counted:.6g} if that is one cycle')


def _ends(context: Context) -> Iterator[Finding]:
    """Find ends that do not close in position, velocity or acceleration."""
    table = context.table
    last = len(table.angle) - 1
    if table.cycle == RETURN and abs(table.advance) > 1e-9 * table.stroke:
        step = table.angle[-1] - table.angle[-2]
        yield context.found(
            'unequal_ends', WARNING, last, table.advance,
            f'the last position differs from the first by {table.advance:.5g} {context.unit}',
            f'a jump at every cycle: within one step of the table it is a velocity of '
            f'{context.rate(table.advance / step, 1)} and an acceleration of '
            f'{context.rate(table.advance / step**2, 2)}',
            f'make them equal, or {closing_hint(table)}')
        return
    for order, values in enumerate((table.velocity, table.acceleration), start=1):
        if values is None:
            continue
        gap = float(values[0] - values[-1])
        if abs(gap) > 1e-6 * float(np.abs(values).max()):
            name = ('velocity', 'acceleration')[order - 1]
            yield context.found(
                f'unequal_end_{name}', WARNING, last, gap,
                f'the {name} at the end differs from that at the start by {gap:.5g} '
                f'{rate_text(context.unit, order, "rad")}',
                f'a step of {context.rate(gap, order)} at every cycle',
                'make both ends equal, or leave the column out')


def _steps(context: Context, steps: list[Break]) -> Iterator[Finding]:
    table = context.table
    kinks = [each for each in steps if each.kind == 'velocity_step']
    bends = second_differences(table)
    if not bends.values.size:
        return
    straight = np.abs(bends.values) <= 1e-6 * np.abs(bends.values).max() + bends.noise
    flat = np.count_nonzero(~straight) <= 2 * len(kinks) + 2
    if len(kinks) >= _STAIRS and flat:
        worst = max(kinks, key=lambda each: abs(each.amount))
        yield context.found(
            'staircase', WARNING, worst.place, worst.amount,
            f'straight lines with {len(kinks)} corners: the table was made by linear '
            'interpolation of fewer points; the worst corner is a velocity step of '
            f'{worst.amount:.5g} {rate_text(context.unit, 1, "rad")}',
            f'a velocity step of {context.rate(worst.amount, 1)}: within one step of the table '
            f'an acceleration of {context.rate(worst.amount / worst.step, 2)}',
            'use the points it was made of, or --repair with a tolerance of about '
            f'{abs(worst.amount) * worst.reach / 8.0:.2g}')
        steps = [each for each in steps if each.kind != 'velocity_step']
    for each in steps[:_MOST_FINDINGS]:
        yield _step(context, each)
    moving = table.stroke > 0.0 and not kinks
    if table.interpolation == LINEAR and moving:
        amounts = np.abs(bends.values * bends.steps)
        place = int(np.argmax(amounts))
        yield context.found(
            'linear_interpolation', NOTE, int(bends.places[place]), float(amounts[place]),
            'a controller that interpolates linearly makes steps of the velocity of up to '
            f'{amounts[place]:.5g} {rate_text(context.unit, 1, "rad")} of it',
            f'steps of {context.rate(amounts[place], 1)} at the points, acceleration in impulses',
            'import it as a spline (as this program does), or give the controller more points')


def _step(context: Context, each: Break) -> Finding:
    unit, amount, step = context.unit, each.amount, each.step
    if each.kind == 'velocity_step':
        return context.found(
            'velocity_step', WARNING, each.place, amount,
            f'the velocity steps by {amount:.5g} {rate_text(unit, 1, "rad")}',
            f'a step of {context.rate(amount, 1)}: within one step of the table an acceleration '
            f'of {context.rate(amount / step, 2)}',
            'round the corner with further points, or --repair with a tolerance')
    what = 'jump' if each.kind == 'jump' else 'outlier'
    text = (f'the position jumps by {amount:.5g} {unit}' if what == 'jump' else
            f'this position lies {amount:.5g} {unit} beside the curve of its neighbours')
    hint = ('give the movement an angle of its own' if what == 'jump' else
            f'correct the line, or leave it out: --drop {context.table.lines[each.place]}')
    return context.found(
        what, WARNING, each.place, amount, text,
        f'within one step of the table a velocity of {context.rate(amount / step, 1)} and an '
        f'acceleration of {context.rate(amount / step**2, 2)}', hint)


def _spline(table: CamTable, x: Array, y: Array, degree: int) -> tuple[Array, Array]:
    """Give velocity and acceleration at the points of a spline through them."""
    closes = table.covers_cycle and len(x) > 3
    curve = interpolate(x, y, degree, PERIODIC if closes else NATURAL)
    return curve.evaluate(x, 1), curve.evaluate(x, 2)


def _columns(context: Context) -> Iterator[Finding]:
    """Compare columns with the derivatives of the positions."""
    table = context.table
    if len(table.angle) < 6:
        return
    computed = _spline(table, table.angle, table.position, 5)
    for order, given in enumerate((table.velocity, table.acceleration), start=1):
        if given is None:
            continue
        name, own = ('velocity', 'acceleration')[order - 1], computed[order - 1]
        peak = float(np.abs(own).max())
        if peak == 0.0 or np.abs(given - own).max() <= _DIFFERS * order * peak:
            continue
        ratio = float(given @ own / (own @ own))
        place = int(np.argmax(np.abs(given - own)))
        rest = float(np.abs(given - ratio * own).max())
        scale = abs(ratio) > 1e-12 and rest <= 3.0 * _DIFFERS * order * peak * abs(ratio)
        meaning, hint = _scale(ratio, order, table) if scale else ('', 'leave the column out')
        yield context.found(
            f'{name}_contradicts', WARNING, place, float(given[place] - own[place]),
            f'the {name} column is {ratio:.6g} times what the positions give{meaning}' if scale
            else f'the {name} {given[place]:.5g} contradicts the positions, which give '
            f'{own[place]:.5g} {rate_text(context.unit, order, "rad")}',
            f'with it the curve swings between the points; at this one {name} is off by '
            f'{context.rate(given[place] - own[place], order)}', hint)


def _scale(ratio: float, order: int, table: CamTable) -> tuple[str, str]:
    """Name the unit that a wrong factor shows."""
    read_by = table.per_radian if table.per == 'master' else 1.0
    for name, unit in (('per degree', DEGREE), ('per radian', 1.0), ('per cycle', TURN)):
        factor = (read_by * unit) ** order
        if not math.isclose(factor, 1.0, rel_tol=1e-3) and math.isclose(
                ratio, factor, rel_tol=0.03):
            hint = '--per rad' if name == 'per radian' else (
                f'divide it by {factor:.6g}, or leave it out')
            return f': it is {name}', hint
    if math.isclose(ratio, -1.0, rel_tol=0.03):
        return ': its sign is wrong', 'turn its sign, or leave it out'
    return ': a wrong scale', f'divide it by {ratio:.6g}, or leave it out'
