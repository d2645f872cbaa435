# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A film as an MP4, by ffmpeg."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
import shutil
import subprocess
import tempfile

from cam_motion.errors import CamMotionError, ConfigurationError, Problem
from cam_motion.io.animation.stage import Stage


def find_ffmpeg() -> str:
    """
    Find ffmpeg on this machine, or the one that the package imageio-ffmpeg brings along.

    Returns
    -------
    str
        Path of the program.

    Raises
    ------
    ConfigurationError
        When there is none.

    """
    if found := shutil.which('ffmpeg'):
        return found
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
        return str(get_ffmpeg_exe())
    except (ImportError, RuntimeError) as error:
        raise ConfigurationError([Problem(
            '--output', '.mp4', 'needs the program ffmpeg, and this machine has none',
            "install ffmpeg, or `pip install 'cam_motion[mp4]'`, or write .gif or .html")]) \
            from error


def write_mp4(stage: Stage, frames: Iterable[int], path: Path) -> None:
    """
    Write a film as an MP4 that every player and browser shows (H.264, 4:2:0).

    Parameters
    ----------
    stage : Stage
        The film, and how it is drawn.
    frames : Iterable[int]
        Numbers of the frames.
    path : Path
        The file.

    Raises
    ------
    ConfigurationError
        When there is no ffmpeg.
    CamMotionError
        When ffmpeg fails.

    """
    width, height = stage.size
    command = [
        find_ffmpeg(), '-y', '-loglevel', 'error', '-f', 'rawvideo', '-pix_fmt', 'rgb24',
        '-s', f'{width}x{height}', '-r', f'{stage.film.fps:g}', '-i', '-',
        # 4:2:0 needs even sides; players find the index at the front
        '-vf', 'pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white', '-c:v', 'libx264', '-crf', '20',
        '-pix_fmt', 'yuv420p', '-movflags', '+faststart', '-f', 'mp4', str(path)]
    with tempfile.TemporaryFile() as said:
        # in a session of its own: Ctrl-C is for us, who end it below
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
                                   stderr=said, start_new_session=True)
        assert process.stdin is not None
        try:
            with suppress(BrokenPipeError), process.stdin as pipe:  # it may give up, and says why
                for k in frames:
                    pipe.write(stage.frame(k).tobytes())
            process.wait()
        finally:
            process.kill()
            process.wait()
        if process.returncode:
            said.seek(0)
            reason = said.read().decode(errors='replace').strip() or process.returncode
            raise CamMotionError(f'{path}: ffmpeg failed: {reason}')
