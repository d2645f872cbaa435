# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The display of a running line: a table that lives on a terminal, plain lines elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic
from types import TracebackType

from cam_motion.cli.overload import overloads
from cam_motion.cli.terminal import console, number, row, table
from cam_motion.cli.watch import Snapshot
from cam_motion.io.machine import Machine
from cam_motion.units import rate_text
from rich.console import Group
from rich.live import Live
from rich.text import Text

REFRESH = 0.2
"""Time between two looks [s]."""

_ORDINARY = 'in_sync'  # a state not worth a word on a plain line
_FOLLOWS = 'following'  # of a linkage likewise
_WORKS = (_FOLLOWS, 'running')  # of a drive
_LINE_EVERY = 1.0  # plain lines come slower [s]


class Display:
    """
    Shows snapshots; to be used as a context.

    Parameters
    ----------
    machine : Machine
        The machine.
    title : str
        What is running.
    quiet : bool
        Whether to show nothing.

    """

    def __init__(self, machine: Machine, title: str, quiet: bool = False) -> None:
        """Find out where the output goes."""
        self._machine = machine
        self._title = title
        self._quiet = quiet
        self._console = console()
        self._live: Live | None = None
        self._next_line = 0.0
        self._waiting = ''
        if self._console.is_terminal and not quiet:
            self._live = Live(console=self._console, auto_refresh=False, transient=False)

    @property
    def printer(self) -> Callable[[str], None] | None:
        """Print a line above the table; None where lines may go straight to standard error."""
        return None if self._live is None else self._print_above

    def _print_above(self, line: str) -> None:
        if self._live is not None:
            self._live.console.print(Text.from_ansi(line))

    def show(self, seen: Snapshot, note: str = '') -> None:
        """
        Show a snapshot.

        Parameters
        ----------
        seen : Snapshot
            The snapshot.
        note : str
            What the line is about to do.

        """
        if self._live is not None:
            self._live.update(render(self._machine, seen, self._title, note), refresh=True)
        elif not self._quiet:
            self._show_plainly(seen, note)

    def _show_plainly(self, seen: Snapshot, note: str) -> None:
        """Print a line now and then, but what is waited for only once."""
        if seen.time is None:
            waiting = note or 'waiting for the shaft'
            if waiting != self._waiting:
                print(waiting, flush=True)
            self._waiting = waiting
        elif monotonic() >= self._next_line:
            self._next_line = monotonic() + _LINE_EVERY
            print(plain_line(self._machine, seen) + (f'  {note}' if note else ''), flush=True)

    def __enter__(self) -> Display:
        """Begin to live."""
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 traceback: TracebackType | None) -> None:
        """Leave the last table standing."""
        if self._live is not None:
            self._live.stop()


def render(machine: Machine, seen: Snapshot, title: str, note: str = '') -> Group:
    """
    Build the table of a snapshot.

    Parameters
    ----------
    machine : Machine
        The machine.
    seen : Snapshot
        The snapshot.
    title : str
        What is running.
    note : str
        What the line is about to do.

    Returns
    -------
    Group
        For rich to print.

    """
    made = table(f'{title}  {note}'.rstrip(), [
        ('', 'left'), ('now', 'right'), ('', 'left'), ('now', 'right'), ('', 'left'),
        ('', 'left')])
    if seen.time is None:
        row(made, machine.master.name, 'waiting', '', '', '', '')
    else:
        row(made, machine.master.name, f'{seen.speed_cpm:.1f}', 'cycles/min',
            f'{seen.angle_deg:.1f}', 'deg', '')
        row(made, '', str(seen.cycles), 'cycles', f'{seen.time:.1f}', 's', '')
    for name, motion in seen.axes.items():
        unit = machine.diagram.axes[name].unit
        row(made, name, *_pair(motion, unit, rate_text(unit, 1), 4), seen.states.get(name, ''))
    for name, effort in seen.drives.items():
        row(made, name, *_pair(effort, 'N m', 'rpm', 1), seen.states.get(name, ''))
    held = [Text(f'{name}: {text}', style='bold red')
            for name, text in overloads(machine, seen).items()]
    for name in machine.linkages:
        state, _, reason = seen.states.get(name, 'waiting').partition(':')
        row(made, name, '', '', '', '', state)
        held += [Text(f'{name}:{reason}')] if reason else []
    return Group(made, *held, Text(_health_text(seen)))


def _pair(values: tuple[float, float] | None, first: str, second: str, places: int,
          ) -> tuple[str, str, str, str]:
    if values is None:
        return '-', first, '-', second
    # adding zero turns -0.0 into 0.0
    texts = [f'{round(value, places) + 0.0:.{places}f}' for value in values]
    return texts[0], first, texts[1], second


def _health_text(seen: Snapshot) -> str:
    missed, late = seen.health.get('missed_ticks', '-'), seen.health.get('late_ticks', '-')
    text = f'ticks missed {missed}, late {late}'
    if 'held_back_by' in seen.health:
        text += f', held back by {seen.health["held_back_by"]}'
    return text


def plain_line(machine: Machine, seen: Snapshot) -> str:
    """
    Write a snapshot as one line.

    Parameters
    ----------
    machine : Machine
        The machine.
    seen : Snapshot
        The snapshot.

    Returns
    -------
    str
        Time, shaft, axes, drives and what they cannot do, linkages that do not follow, ticks
        missed.

    """
    parts = [
        f'{seen.time or 0.0:7.2f} s', f'{number(round(seen.speed_cpm, 1))} cycles/min',
        f'cycle {seen.cycles} at {seen.angle_deg:5.1f} deg',
    ]
    for name, motion in seen.axes.items():
        unit = machine.diagram.axes[name].unit
        state = seen.states.get(name, _ORDINARY)
        parts.append(' '.join((name, *_pair(motion, unit, rate_text(unit, 1), 4),
                               *([state] if state != _ORDINARY else []))))
    beyond = overloads(machine, seen)
    for name, effort in seen.drives.items():
        state = seen.states.get(name, _FOLLOWS)
        parts.append(' '.join((name, *_pair(effort, 'N m', 'rpm', 1),
                               *([state] if state not in _WORKS else []),
                               *([f'({beyond[name]})'] if name in beyond else []))))
    parts += [f'{name} {state}' for name in machine.linkages
              if (state := seen.states.get(name, 'waiting')) != _FOLLOWS]
    return '  '.join((*parts, _health_text(seen)))
