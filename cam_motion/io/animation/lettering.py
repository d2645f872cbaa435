# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Texts that move or change, drawn once and stamped onto frame after frame."""

from __future__ import annotations

from functools import lru_cache
import re
from typing import Any

from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.colors import to_rgb
from matplotlib.font_manager import FontProperties
import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]
"""Red, green and blue of a frame, shape (height, width, 3)."""

_FAMILY = 'DejaVu Sans'
_MARGIN = 2
_RENDERER: Any = RendererAgg  # it has no types


def stamp(picture: Picture, text: str, place: tuple[float, float], size: float, dpi: float,
          align: str = 'left', colour: str = '#000000') -> None:
    """
    Write a text onto a frame.

    matplotlib lays out and rasters every text of every frame anew, which would take more time
    than all the rest of a frame.

    Parameters
    ----------
    picture : ndarray of uint8, shape (height, width, 3)
        The frame, changed in place.
    text : str
        The text.
    place : tuple[float, float]
        Its end, or middle, across; and the middle of its letters up from the bottom [px].
    size : float
        Size of its letters [pt].
    dpi : float
        Pixels per inch.
    align : str
        What stands at the place: ``left``, ``center`` or ``right``.
    colour : str
        Its colour.

    """
    # the figures of a font are equally wide, so a number may be set figure by figure
    masks = [_mask(part, size, dpi) for part in re.findall(r'[0-9.−]|[^0-9.−]+', text)]
    width = sum(advance for _, advance in masks)
    x = round(place[0] - {'left': 0.0, 'center': 0.5, 'right': 1.0}[align] * width)
    middle = picture.shape[0] - round(place[1])
    ink = 255.0 * np.array(to_rgb(colour))
    for mask, advance in masks:
        _blend(picture, mask, x - _MARGIN, middle - mask.shape[0] // 2, ink)
        x += advance


@lru_cache(maxsize=4096)
def _mask(text: str, size: float, dpi: float) -> tuple[NDArray[np.float32], int]:
    """Draw a text: how much of each pixel it covers, and how far it goes."""
    font = FontProperties(family=_FAMILY, size=size)
    probe = _RENDERER(1, 1, dpi)
    # between bars, so that blanks at the ends count
    wide, bars = (probe.get_text_width_height_descent(each, font, False)[0]
                  for each in (f'|{text}|', '||'))
    height = probe.get_text_width_height_descent('0', font, False)[1]
    tall = 2 * round(0.9 * height) + 1
    advance = round(wide - bars)
    renderer = _RENDERER(advance + 2 * _MARGIN, tall, dpi)
    graphics = renderer.new_gc()
    renderer.draw_text(graphics, _MARGIN, round(0.5 * (tall + height)), text, font, 0.0)
    cover = np.asarray(renderer.buffer_rgba())[:, :, 3].astype(np.float32) / 255.0
    return cover, advance


def _blend(picture: Picture, mask: NDArray[np.float32], left: int, top: int,
           ink: NDArray[np.float64]) -> None:
    """Lay colour over a part of a picture where a mask says so; what is outside is cut off."""
    x, y = max(left, 0), max(top, 0)
    part = picture[y:top + mask.shape[0], x:left + mask.shape[1]]
    cover = mask[y - top:y - top + part.shape[0], x - left:x - left + part.shape[1], None]
    part += (cover * (ink - part)).round().astype(np.int16).astype(np.uint8)
