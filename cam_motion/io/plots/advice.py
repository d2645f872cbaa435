# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Pictures of advice: the best laws of a movement together, and what filters do to it."""

from __future__ import annotations

from collections.abc import Sequence

from cam_motion.io.advice import Advice
from cam_motion.io.advice_movement import Question
from cam_motion.io.filter_advice import FilterFigures
from cam_motion.io.plots.style import COLOURS, GREY, new_figure, styled
from cam_motion.motion.advice import Candidate
from cam_motion.motion.piece import Array
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.vibration import residual_amplitude
from cam_motion.units import DEGREE, rate_text, RPM, TURN
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

SHOWN = 4
"""Laws that a picture holds at most; with more it is not read any more."""

_POINTS = 120  # per piece
_RATIOS = np.geomspace(0.4, 12.0, 600)
_FLOOR = 1e-4  # of the lift: less vibration than this is not drawn
_SPEEDS = np.linspace(0.4, 1.6, 481)  # of the set speed
_QUANTITIES = ('position', 'velocity', 'acceleration')
_DASHES = ((0, ()), (0, (6, 2)), (0, (3, 1.5)), (0, (1, 1)))


def advice_figure(advice: Advice) -> Figure:
    """
    Draw the best few laws for a movement over each other.

    Parameters
    ----------
    advice : Advice
        The advice.

    Returns
    -------
    Figure
        Position, velocity and acceleration over the angle of the cam, and the vibration left
        over the frequency ratio.

    """
    question = advice.question
    shown = chosen(advice)
    with styled():
        figure = new_figure(6.2)
        panels = figure.subplots(2, 2)
        for order, panel in enumerate(panels.flat[:3]):
            for n, each in enumerate(shown):
                assert each.curve is not None
                angles, values = _with_steps(each.curve, order)
                panel.plot(angles / DEGREE, values * question.speed ** order, color=COLOURS[n],
                           linestyle=_DASHES[n], label=_name(each))
            unit = rate_text(question.unit, order)
            panel.set_ylabel(f'{_QUANTITIES[order]} [{unit}]')
            panel.set_xlabel('angle of the cam [deg]')
            panel.margins(x=0.0)
            if order:
                panel.axhline(0.0, color='#444444', linewidth=0.8, zorder=1)
        _draw_spectrum(panels[1, 1], question, shown)
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc='outside lower center', ncols=SHOWN)
        figure.suptitle(
            f'{question.name}: {question.lift:g} {question.unit} over '
            f'{question.end_deg - question.start_deg:g}° at '
            f'{question.shaft_speed / RPM:g} cycles/min', fontsize=11.0, fontweight='bold')
    return figure


def chosen(advice: Advice) -> list[Candidate]:
    """
    Choose the laws that a picture shows.

    Parameters
    ----------
    advice : Advice
        The advice.

    Returns
    -------
    list[Candidate]
        The best ones, and the configured one if it can be taken.

    """
    listed = [each.candidate for each in (*advice.ranking, *advice.stepping)]
    best = listed[:SHOWN]
    now = [each for each in listed if each.configured and each not in best]
    return best[:SHOWN - len(now)] + now


def _name(each: Candidate) -> str:
    return each.law.name + (' (now)' if each.configured else '')


def _draw_spectrum(panel: Axes, question: Question, shown: Sequence[Candidate]) -> None:
    load = question.load
    damping, factor = (0.0, 1.0) if load is None else (load.damping, load.factor)
    span = (question.end_deg - question.start_deg) * DEGREE
    ratios = _RATIOS
    at = None if load is None else load.frequency / TURN * question.duration
    if at is not None and not ratios[0] <= at <= ratios[-1]:
        ratios = np.geomspace(min(ratios[0], at / 3.0), max(ratios[-1], at * 3.0), len(ratios))
    for n, each in enumerate(shown):
        assert each.curve is not None
        left = residual_amplitude(each.curve, ratios * TURN / span, damping)
        panel.loglog(ratios, np.maximum(factor * left / abs(question.lift), _FLOOR / 10.0),
                     color=COLOURS[n], linestyle=_DASHES[n], linewidth=1.3)
    if at is not None:
        panel.axvline(at, color=GREY, linewidth=1.1)
        panel.annotate(f'{at:.3g}', (at, 1.0), xycoords=panel.get_xaxis_transform(),
                       xytext=(3, -10), textcoords='offset points', color=GREY, fontsize=8.0)
    ticks = [tick for tick in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500)
             if ratios[0] <= tick <= ratios[-1]]
    panel.set_xticks(ticks, [f'{tick:g}' for tick in ticks])
    panel.minorticks_off()
    panel.set_ylim(_FLOOR, 3.0)
    panel.set_xlim(ratios[0], ratios[-1])
    panel.set_xlabel('free periods within the movement, T f [-]')
    panel.set_ylabel('vibration left / lift [-]')


def _with_steps(curve: Piecewise, order: int) -> tuple[Array, Array]:
    """Sample a derivative of a movement, each joint from both sides."""
    derivative = curve.differentiated(order)
    angles = [begin + np.linspace(0.0, piece.length, _POINTS)
              for begin, piece in zip(derivative.breaks, derivative.pieces)]
    values = [piece(at - begin) for begin, piece, at in zip(
        derivative.breaks, derivative.pieces, angles)]
    return np.concatenate(angles), np.concatenate(values)


def filter_figure(question: Question, law: str, filters: Sequence[FilterFigures]) -> Figure:
    """
    Draw what filters do to a movement.

    Parameters
    ----------
    question : Question
        The movement.
    law : str
        Name of its law.
    filters : Sequence[FilterFigures]
        The filters; those that cannot be taken are left out.

    Returns
    -------
    Figure
        Velocity of the axis and deviation of the load over the angle of the cam, and the
        vibration left over speed, as each filter is exact at one speed only.

    """
    load = question.load
    assert load is not None
    shown = [each for each in filters if each.effect is not None]
    scale = abs(question.scale)
    what = 'wave at the wall' if load.factor != 1.0 else 'deviation of the load'
    with styled():
        figure = new_figure(6.6)
        panels = figure.subplot_mosaic([['velocity', 'left'], ['swing', 'left']])
        responses = [each.effect.response(question.speed) for each in shown
                     if each.effect is not None]
        start = responses[0].curve.start
        end = start + 1.15 * (max(each.curve.end for each in responses) - start)
        x = np.linspace(start, end, 1500)
        for n, (each, response) in enumerate(zip(shown, responses)):
            assert each.effect is not None
            colour = GREY if each.kind == 'none' else COLOURS[n - 1]
            angles, values = _with_steps(response.curve, 1)
            panels['velocity'].plot(
                np.append(angles, end) / DEGREE,
                question.scale * np.append(values, 0.0) * question.speed, color=colour,
                label='no filter' if each.kind == 'none' else each.kind)
            panels['swing'].plot(x / DEGREE, scale * load.factor * response(x), color=colour,
                                 linewidth=1.2)
            left = scale * each.effect.residual(_SPEEDS * question.speed)
            panels['left'].semilogy(
                _SPEEDS * question.shaft_speed / RPM,
                np.maximum(left / abs(question.lift), _FLOOR / 10.0), color=colour)
        panels['velocity'].set_ylabel(f'velocity [{rate_text(question.unit, 1)}]')
        panels['swing'].set_ylabel(f'{what} [{question.unit}]')
        panels['swing'].set_xlabel('angle of the cam [deg]')
        panels['left'].set_xlabel('speed [cycles/min]')
        panels['left'].set_ylabel('left after the movement / lift [-]')
        panels['left'].set_ylim(_FLOOR, None)
        panels['left'].axvline(question.shaft_speed / RPM, color=GREY, linewidth=1.1)
        for name in ('velocity', 'swing'):
            panels[name].margins(x=0.0)
            panels[name].axhline(0.0, color='#444444', linewidth=0.8, zorder=1)
        handles, labels = panels['velocity'].get_legend_handles_labels()
        figure.legend(handles, labels, loc='outside lower center', ncols=len(shown))
        figure.suptitle(
            f'{question.name}, {law}: filters for {load.frequency / TURN:.4g} Hz, made for '
            f'{question.shaft_speed / RPM:g} cycles/min', fontsize=11.0, fontweight='bold')
    return figure
