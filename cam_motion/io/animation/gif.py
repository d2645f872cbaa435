# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A film as a GIF."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from cam_motion.io.animation.lettering import Picture
from cam_motion.io.animation.stage import Stage
import numpy as np
from PIL import Image

FASTEST_FPS = 50.0
"""Frames per second that viewers still show: they slow down below 0.02 s a frame."""

_SAMPLES = 5  # frames whose colours become the palette
_COLOURS = 255  # of 256: the one left over stands for what stays as it was in the frame before
_ALIKE = 0xF8F8F8


def write_gif(stage: Stage, frames: Iterable[int], path: Path) -> None:
    """
    Write a film as a GIF that begins anew at its end.

    Parameters
    ----------
    stage : Stage
        The film, and how it is drawn.
    frames : Iterable[int]
        Numbers of the frames.
    path : Path
        The file.

    """
    # one palette for all frames: colours do not flicker, and what stands costs nothing
    count = len(stage.film)
    sample = np.concatenate([
        stage.frame(int(k)) for k in np.linspace(0, count - 1, _SAMPLES).round()])
    palette = _palette(sample)

    def pictures() -> Iterable[Image.Image]:
        for k in frames:
            yield Image.fromarray(stage.frame(k)).quantize(
                palette=palette, dither=Image.Dither.NONE)

    every = iter(pictures())
    first = next(every)
    # frames last whole hundredths of a second: rounded so that their sum is right
    ends = np.rint(np.arange(count + 1) * 100.0 / stage.film.fps)
    with path.open('w+b') as file:
        first.save(file, format='GIF', save_all=True, append_images=every, loop=0, disposal=1,
                   duration=[int(each) for each in 10 * np.diff(ends)])


def _palette(picture: Picture) -> Image.Image:
    """Choose the most frequent colours as they are, so that white stays white."""
    packed = picture.astype(np.uint32) @ np.array([65536, 256, 1], dtype=np.uint32)
    colours, counts = np.unique(packed, return_counts=True)
    ranked = colours[np.argsort(-counts, kind='stable')]
    # colours are looked up without their last bits: of those alike, the most frequent
    _, first = np.unique(ranked & _ALIKE, return_index=True)
    chosen = ranked[np.sort(first)[:_COLOURS]]
    palette = Image.new('P', (1, 1))
    palette.putpalette(chosen[:, None].astype('>u4').view(np.uint8)[:, 1:].tobytes())
    return palette
