# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``size``: motors, gear ratios and flywheels from a catalogue, ranked and explained."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
import math
from multiprocessing import get_context
from pathlib import Path
import re
from typing import Any

from cam_motion.cli.options import add_config, add_json, finite_number
from cam_motion.cli.size_tables import print_sizing
from cam_motion.cli.terminal import console, print_files, print_json, progress, save_figure
from cam_motion.drive.sizing import OBJECTIVES
from cam_motion.drive.sizing_forward import Wishes
from cam_motion.io.catalogue import load_catalogue
from cam_motion.io.config import load_machine
from cam_motion.io.plain import plain
from cam_motion.io.sizing import INERTIA_RATIO, Options, size, SizedDrive, sizing_as_data
import numpy as np

_MOST_STEPS = 10000
_TOP = 10


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    wishes = Wishes()
    parser.description = (
        'Try every motor, gear ratio and flywheel of a catalogue: servo motors by '
        'inverse dynamics for drives that follow an axis, induction motors by their '
        'periodic motion for drives that turn a cam shaft. Ranks what keeps every '
        'rule, and says for the rest which rules they break and by how much.')
    parser.epilog = (
        'LIST: 3,3.5,4 or 3:4:11 (from, to, how many). Exit code 1 when a drive has no '
        'candidate that keeps every rule.')
    add_config(parser)
    parser.add_argument('--drive', metavar='NAME', action='append', default=[],
                        help='size this drive only; may be repeated')
    parser.add_argument('--catalogue', metavar='FILE', type=Path, action='append', default=[],
                        help='catalogue instead of the one that comes along; may be repeated')
    parser.add_argument('--ratios', metavar='LIST', type=_ratios, default=(),
                        help='gear ratios to try [turns of the motor per turn of the load]')
    parser.add_argument('--flywheels', metavar='LIST', type=_flywheels, default=(),
                        help='flywheels to try [kg m²]')
    parser.add_argument('--objective', default='power',
                        choices=sorted({name for known in OBJECTIVES.values() for name in known}),
                        help='by what to rank (default: %(default)s)')
    for name, default, text in (
            ('fluctuation', wishes.fluctuation_pct, 'largest speed fluctuation of a cam shaft'),
            ('speed-tolerance', wishes.speed_tolerance_pct,
             'largest deviation of its mean speed from the nominal one'),
            ('start-margin', wishes.start_margin_pct,
             'how far the torque at rest must exceed the static load'),
            ('stability', wishes.stability_pct, 'least stability of its motor')):
        parser.add_argument(f'--{name}', metavar='PCT', type=_share, default=default,
                            help=f'{text} (default: %(default)g %%)')
    parser.add_argument('--inertia-ratio', metavar='X', type=_positive, default=INERTIA_RATIO,
                        help="largest ratio of the load's inertia to the rotor's, for servo "
                             'motors (default: %(default)g, a rule of thumb)')
    parser.add_argument('--top', metavar='N', type=_count, default=_TOP,
                        help='show the best N (default: %(default)s)')
    parser.add_argument('--all', action='store_true',
                        help='show every candidate, the rejected ones with their reasons')
    parser.add_argument('--workers', metavar='N', type=_count, default=1,
                        help='share the periodic motions between N processes')
    parser.add_argument('-o', '--output', metavar='DIR', type=Path,
                        help='draw a picture per drive into this directory')
    add_json(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Size and print.

    Parameters
    ----------
    arguments : argparse.Namespace
        Parsed arguments.

    Returns
    -------
    int
        0 where every drive has a candidate that keeps every rule, else 1.

    """
    machine = load_machine(arguments.config)
    catalogue = load_catalogue(arguments.catalogue)
    options = Options(
        arguments.objective, arguments.ratios, arguments.flywheels,
        Wishes(arguments.fluctuation, arguments.speed_tolerance, arguments.start_margin,
               arguments.stability), arguments.inertia_ratio)
    with _executor(arguments.workers) as executor, progress() as bar:
        tasks: dict[str, Any] = {}

        def tell(name: str, done: int, total: int) -> None:
            if name not in tasks:
                tasks[name] = bar.add_task(f'sizing {name}', total=total)
            bar.update(tasks[name], completed=done)
        results = size(machine, catalogue, options, arguments.drive, executor, tell)
    files = _pictures(results, options, arguments.output)
    fits = all(sized.sizing.ranked for sized in results.values())
    if arguments.json:
        data = {name: sizing_as_data(sized) for name, sized in results.items()}
        # a machine with one drive answers without its name, as in the other verbs
        first = next(iter(data.values())) if len(data) == 1 else {}
        written = {} if arguments.output is None else {'files': [str(file) for file in files]}
        print_json(plain({**first, 'drives': data, **written}))
        return 0 if fits else 1
    if not results:
        console().print('the machine has no drives')
    for sized in results.values():
        print_sizing(sized, options, math.inf if arguments.all else arguments.top, arguments.all)
    print_files(files)
    return 0 if fits else 1


@contextmanager
def _executor(workers: int) -> Iterator[Executor | None]:
    if workers == 1:
        yield None
        return
    # no plain fork: the progress bar has a thread, whose locks a child would inherit
    with ProcessPoolExecutor(workers, get_context('forkserver')) as pool:
        yield pool


def _pictures(results: dict[str, SizedDrive], options: Options, folder: Path | None,
              ) -> list[Path]:
    if folder is None:
        return []
    from cam_motion.io.plots import sizing_figure
    return [
        save_figure(sizing_figure(sized, options),
                    folder / ('size_' + re.sub(r'\W', '_', name) + '.png'))
        for name, sized in results.items()
    ]


def _numbers(text: str, least: float, above: bool) -> tuple[float, ...]:
    parts = text.split(':')
    if len(parts) == 3:
        low, high, count = finite_number(parts[0]), finite_number(parts[1]), _count(parts[2])
        if count > _MOST_STEPS:
            raise argparse.ArgumentTypeError(f'{text!r}: at most {_MOST_STEPS} numbers')
        numbers: Sequence[float] = np.linspace(low, high, count).tolist()
    else:
        numbers = [finite_number(part) for part in text.split(',')]
    if any(x < least or (above and x == least) for x in numbers):
        word = 'above' if above else 'at least'
        raise argparse.ArgumentTypeError(f'{text!r}: every number must be {word} {least:g}')
    return tuple(numbers)


def _ratios(text: str) -> tuple[float, ...]:
    return _numbers(text, 0.0, True)


def _flywheels(text: str) -> tuple[float, ...]:
    return _numbers(text, 0.0, False)


def _positive(text: str) -> float:
    value = finite_number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f'{text!r}: must be above 0')
    return value


def _share(text: str) -> float:
    value = finite_number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f'{text!r}: must be above 0 %')
    return value


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f'{text!r}: must be a whole number above 0')
    return int(text)
