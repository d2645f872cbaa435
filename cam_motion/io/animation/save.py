# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Films as files: the suffix says the kind, and nothing half-written is left behind."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
import tempfile

from cam_motion.errors import CamMotionError, ConfigurationError, Problem
from cam_motion.io.animation.film import Film
from cam_motion.io.animation.gif import FASTEST_FPS, write_gif
from cam_motion.io.animation.mp4 import find_ffmpeg, write_mp4
from cam_motion.io.animation.page import write_page
from cam_motion.io.animation.stage import Stage

FORMATS = ('.gif', '.mp4', '.html')
"""Suffixes of films."""

_MOST_BYTES = 1e9  # of all pictures of a GIF, which are in memory until it is written

Track = Callable[[range], Iterable[int]]
"""Goes through the numbers of the frames and tells how far it is."""


@dataclass(frozen=True)
class Look:
    """
    How large a film is drawn.

    Attributes
    ----------
    size : tuple[int, int], optional
        Width and height [px].
    dpi : float, optional
        Pixels per inch, which scale lines and texts; as the size wants it if left out.

    """

    size: tuple[int, int] | None = None
    dpi: float | None = None


def output_problems(path: Path, fps: float, look: Look) -> list[Problem]:
    """
    Find what is wrong with a wish for a file, before any frame is drawn.

    Parameters
    ----------
    path : Path
        The file.
    fps : float
        Frames per second.
    look : Look
        How large it shall be drawn.

    Returns
    -------
    list[Problem]
        All problems.

    """
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        return [Problem('--output', str(path), 'the suffix says the kind of the film',
                        'end it with ' + ', '.join(FORMATS[:-1]) + f' or {FORMATS[-1]}')]
    problems = []
    if path.is_dir():
        problems.append(Problem('--output', str(path), 'is a directory', 'name a file'))
    if suffix == '.gif' and fps > FASTEST_FPS:
        problems.append(Problem('--fps', fps, f'viewers show at most {FASTEST_FPS:g} frames of a '
                                'GIF per second', 'take less, or write .mp4 or .html'))
    if suffix == '.html':
        problems += [Problem(option, value, 'a page is drawn as large as its window, without '
                             'pixels', 'leave it out')
                     for option, value in (('--size', look.size), ('--dpi', look.dpi)) if value]
    if suffix == '.mp4':
        try:
            find_ffmpeg()
        except CamMotionError as error:
            problems += getattr(error, 'problems', [])
    return problems


def save_film(film: Film, path: Path, look: Look = Look(), track: Track = iter) -> Path:
    """
    Write a film to a file; its suffix tells the kind.

    Parameters
    ----------
    film : Film
        The film.
    path : Path
        The file; its directory is made.
    look : Look
        How large it is drawn.
    track : callable
        Goes through the numbers of the frames and tells how far it is.

    Returns
    -------
    Path
        The file written. Where anything interrupts it, whatever was there before stays.

    Raises
    ------
    ConfigurationError
        When a GIF would take too much memory.
    CamMotionError
        When it cannot be written.

    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix='.animate_', dir=path.parent) as folder:
            part = Path(folder) / path.name
            suffix = path.suffix.lower()
            if suffix == '.html':
                write_page(film, part)
            else:
                stage = Stage(film, look.size, look.dpi)
                _check_memory(stage, suffix)
                write = write_gif if suffix == '.gif' else write_mp4
                write(stage, track(range(len(film))), part)
            part.replace(path)
    except OSError as error:
        raise CamMotionError(f'{path}: cannot be written: {error.strerror or error}') from error
    return path


def _check_memory(stage: Stage, suffix: str) -> None:
    width, height = stage.size
    most = int(_MOST_BYTES / (width * height))
    if suffix == '.gif' and len(stage.film) > most:
        raise ConfigurationError([Problem(
            '--output', suffix, f'{len(stage.film)} frames of {width}x{height} px are too many '
            f'for a GIF: the most are {most}',
            'write .mp4 or .html, or choose another --size, --fps or --seconds')])
