# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``animate``: a film of a linkage, of a disc cam or of the axes of a machine."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
import re

from cam_motion.cli.options import add_json, add_speed, finite_number, seconds
from cam_motion.cli.terminal import print_files, print_json, progress
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.animation.pace import FPS, pace_problems, Wishes

_LEAST_SIZE, _MOST_SIZE = 200, 4000
_LEAST_DPI, _MOST_DPI = 40.0, 400.0
_MOST_FPS = 120.0


def add_to(parser: argparse.ArgumentParser) -> None:
    """
    Add what the verb takes.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the verb.

    """
    parser.description = (
        'Film a linkage with the velocities of its points, a disc cam that turns '
        'under its follower, or the dial and the axes of a machine, with the curves '
        'beside it: a motion or one cycle of a machine file, or a recorded run.')
    parser.epilog = (
        'Without --linkage, --disc, --axis and --diagram: the first linkage, else the '
        'first disc cam, else all axes. Without --seconds and --speed: in real time if '
        'that takes 5 to 15 s and leaves a second for each cycle, else as near to it as '
        'can be. A GIF has at most 50 frames per second; an MP4 needs ffmpeg.')
    parser.add_argument('source', metavar='CONFIG|BAG',
                        help='machine file, or bag: a directory, .mcap or .db3 file')
    parser.add_argument('-o', '--output', metavar='FILE', type=Path, required=True,
                        help='film to write: .gif, .mp4 or .html')
    parser.add_argument('--linkage', metavar='NAME', help='film this linkage')
    parser.add_argument('--case', metavar='NAME',
                        help='film this of its motions, not the cycle of the line')
    parser.add_argument('--disc', metavar='NAME', help='film this disc cam')
    parser.add_argument('--axis', metavar='NAME', help='film this axis, or the disc of its cam')
    parser.add_argument('--diagram', action='store_true',
                        help='film the timing diagram, whatever else there is')
    parser.add_argument('--fps', metavar='X', type=finite_number, default=FPS,
                        help='frames per second (default: %(default)g)')
    parser.add_argument('--seconds', metavar='X', type=seconds, help='length of the film')
    parser.add_argument('--speed', metavar='X', type=finite_number,
                        help='speed of the film: 0.1 shows everything ten times slower')
    parser.add_argument('--from', metavar='X', type=finite_number, dest='start',
                        help='begin of a recorded run, from its first tick [s]')
    parser.add_argument('--to', metavar='X', type=finite_number, dest='end',
                        help='end of a recorded run [s]')
    parser.add_argument('--config', metavar='CONFIG', type=Path,
                        help='machine file of a bag (default: the one that it carries)')
    add_speed(parser)
    parser.add_argument('--size', metavar='WxH', type=_size,
                        help='width and height of a GIF or MP4 [px] (default: 900x560, higher '
                             'for many axes)')
    parser.add_argument('--dpi', metavar='X', type=finite_number,
                        help='pixels per inch, which scale lines and texts (default: 100 at the '
                             'default size, and in proportion)')
    add_json(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """
    Make the film.

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
        When machine file, bag or options cannot be used.
    CamMotionError
        When the film cannot be written.

    """
    # pictures and bags take their time to load: not before they are needed
    from cam_motion.io.animation.choice import Choice, choose_film
    from cam_motion.io.animation.save import Look, output_problems, save_film
    look = Look(arguments.size, arguments.dpi)
    wishes = Wishes(arguments.fps, arguments.seconds, arguments.speed)
    problems = [*_problems(arguments), *pace_problems(wishes),
                *output_problems(arguments.output, arguments.fps, look)]
    if problems:
        raise ConfigurationError(problems)
    with progress() as bar:
        task = bar.add_task('solving', total=None)
        film = choose_film(
            arguments.source, wishes,
            Choice(arguments.linkage, arguments.disc, arguments.axis, arguments.case,
                   arguments.diagram, arguments.speed_cpm, arguments.start, arguments.end,
                   arguments.config))
        bar.remove_task(task)

        def track(frames: range) -> Iterator[int]:
            yield from bar.track(frames, description='drawing')
        path = save_film(film, arguments.output, look, track)
    if arguments.json:
        print_json({'files': [str(path)], 'title': film.title, 'frames': len(film),
                    'fps': film.fps, 'seconds': len(film) / film.fps, 'pace': film.note})
        return 0
    print(f'{film.title}: {len(film)} frames, {len(film) / film.fps:g} s, {film.note}')
    print_files([path])
    return 0


def _problems(arguments: argparse.Namespace) -> list[Problem]:
    """Find the options that are out of range."""
    ranges = (('--fps', arguments.fps, 1.0, _MOST_FPS), ('--speed', arguments.speed, 1e-6, 1e6),
              ('--dpi', arguments.dpi, _LEAST_DPI, _MOST_DPI))
    problems = [
        Problem(option, value, f'must be from {least:g} to {most:g}')
        for option, value, least, most in ranges
        if value is not None and not least <= value <= most]
    for side in arguments.size or ():
        if not _LEAST_SIZE <= side <= _MOST_SIZE:
            problems.append(Problem('--size', side, f'must be from {_LEAST_SIZE} to '
                                    f'{_MOST_SIZE} pixels'))
    return problems


def _size(text: str) -> tuple[int, int]:
    """Read ``900x560``."""
    found = re.fullmatch(r'(\d{1,6})[x×](\d{1,6})', text)
    if not found:
        raise argparse.ArgumentTypeError(f'{text!r}: write WIDTHxHEIGHT in pixels')
    return int(found[1]), int(found[2])
