# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A film as a page of its own: drawn by the browser, without anything from elsewhere."""

from __future__ import annotations

from html import escape
from importlib.resources import files
import json
from pathlib import Path
from typing import Any

from cam_motion.io.animation.drawing import Arrows, Label, Shape
from cam_motion.io.animation.film import Film, Panel
import numpy as np

_DIGITS = 6  # significant ones of every number: a millionth of the drawing, so nobody sees it


def write_page(film: Film, path: Path) -> None:
    """
    Write a film as one HTML file.

    Parameters
    ----------
    film : Film
        The film.
    path : Path
        The file.

    """
    text = files('cam_motion.io.animation').joinpath('page.html').read_text(encoding='utf-8')
    data = json.dumps(film_as_data(film), ensure_ascii=False, separators=(',', ':'),
                      allow_nan=False)
    # nothing in the data can end the script that holds it
    data = data.replace('<', '\\u003c')
    head, rest = text.split('{{title}}')
    middle, foot = rest.split('{{film}}')
    path.write_text(head + escape(film.title) + middle + data + foot, encoding='utf-8')


def film_as_data(film: Film) -> dict[str, Any]:
    """
    Turn a film into plain data.

    Parameters
    ----------
    film : Film
        The film.

    Returns
    -------
    dict[str, Any]
        What the page draws: points as [x, y, x, y, ...], per frame where they change.

    """
    drawing = film.drawing
    # most curves go over the same places: each such series is written once
    series = {id(curve.x): curve.x for panel in film.panels for curve in panel.curves}
    return {
        'title': film.title, 'note': film.note, 'fps': film.fps, 'frames': len(film),
        'captions': list(film.captions), 'across': film.across, 'span': _numbers(film.span),
        'cursor': _numbers(film.cursor), 'ticks': _numbers(film.ticks),
        'box': _numbers(drawing.box), 'unit': drawing.unit,
        'shapes': [_shape(shape) for shape in drawing.shapes],
        'arrows': [_arrows(arrows) for arrows in drawing.arrows],
        'labels': [_label(label) for label in drawing.labels],
        'panels': [_panel(panel, list(series)) for panel in film.panels],
        'series': [_numbers(each) for each in series.values()],
    }


def _shape(shape: Shape) -> dict[str, Any]:
    data: dict[str, Any] = {'colour': shape.colour, 'width': shape.width}
    if shape.points.ndim == 2:
        data['frames'] = [_points(points) for points in shape.points]
    else:
        data['points'] = _points(shape.points)
    if shape.turn is not None:
        data['turn'] = _numbers(np.degrees(shape.turn))
    if shape.shift is not None:
        data['shift'] = [_points(np.array([each])) for each in shape.shift]
    return data | {'fill': shape.fill, 'dashed': shape.dashed, 'joints': shape.joints}


def _arrows(arrows: Arrows) -> dict[str, Any]:
    return {'names': list(arrows.names), 'scale': arrows.scale, 'unit': arrows.unit,
            'colour': arrows.colour, 'key': arrows.key,
            'feet': [_points(each) for each in arrows.feet],
            'vectors': [_points(each) for each in arrows.vectors]}


def _label(label: Label) -> dict[str, Any]:
    places, offsets = (
        [_points(np.array([each])) for each in np.atleast_1d(np.asarray(values))]
        for values in (label.place, label.offset))
    return {'text': label.text, 'texts': list(label.texts), 'align': label.align,
            'colour': label.colour, 'places': places, 'offsets': offsets}


def _panel(panel: Panel, series: list[int]) -> dict[str, Any]:
    return {'label': panel.label, 'limits': _numbers(panel.limits), 'decimals': panel.decimals,
            'spans': [_numbers(span) for span in panel.spans],
            'curves': [{'name': curve.name, 'colour': curve.colour, 'x': series.index(id(curve.x)),
                        'y': _numbers(curve.y), 'at': _numbers(curve.at)}
                       for curve in panel.curves]}


def _points(points: Any) -> list[float]:
    return _numbers(np.column_stack([np.real(points), np.imag(points)]).ravel())


def _numbers(values: Any) -> list[float]:
    # + 0.0: no minus before a zero
    return [float(f'{value:.{_DIGITS}g}') + 0.0 for value in np.asarray(values).tolist()]
