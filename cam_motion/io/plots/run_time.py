# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What an axis did in a recorded run: its motion over time, with the states it went through."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from cam_motion.io.plots.style import COLOURS, GREY, new_figure, styled
from cam_motion.io.recording import Recording
from cam_motion.motion.diagram import Axis
from cam_motion.units import rate_text
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
import numpy as np

_SHADES = {
    'disengaged': '#DDDDDD', 'waiting': '#F3E9C6', 'engaging': '#CDE7D8', 'changing': '#CFE0F3',
    'disengaging': '#EFD9E8', 'stopping_on_curve': '#F6D2C2', 'held': '#E9B9A6',
    'fault': '#E89A9A',
}
"""Background of each state but `in_sync`, which has none."""

_MOST_POINTS = 6000


def run_time_figure(recording: Recording, names: Sequence[str] | None = None) -> Figure:
    """
    Draw what axes did over time, the states they told behind it.

    Parameters
    ----------
    recording : Recording
        The run.
    names : Sequence[str], optional
        The axes; None takes those that were ever in another state than `in_sync`, or all.

    Returns
    -------
    Figure
        One row per axis with position and acceleration, below them the speed of the shaft; limits
        of the acceleration are dashed.

    """
    chosen = list(names) if names is not None else (
        [name for name in recording.setpoints if _shaded(recording, name)]
        or list(recording.setpoints))
    zero = int(recording.shaft.stamps_ns[0])
    with styled():
        figure = new_figure(1.7 + 2.1 * len(chosen))
        panels = figure.subplots(len(chosen) + 1, 2, sharex=True, squeeze=False)
        seen: list[str] = []
        for place, name in enumerate(chosen):
            axis, colour = recording.machine.diagram.axes[name], COLOURS[place % len(COLOURS)]
            for order, panel in ((0, panels[place, 0]), (2, panels[place, 1])):
                _draw(panel, recording, axis, order, colour, zero)
                seen += _shade(panel, recording, name, zero)
            panels[place, 0].set_ylabel(f'{name}\ny [{axis.unit}]')
            panels[place, 1].set_ylabel(f'ÿ [{rate_text(axis.unit, 2)}]')
        shaft = recording.shaft
        t = (shaft.stamps_ns - zero) * 1e-9
        panels[-1, 0].plot(t, shaft.velocity, color=GREY, linewidth=1.2)
        panels[-1, 0].set_ylabel('shaft\nω [rad/s]')
        panels[-1, 1].plot(t, shaft.acceleration, color=GREY, linewidth=1.2)
        panels[-1, 1].set_ylabel('α [rad/s²]')
        for panel in panels[-1]:
            panel.set_xlabel('time since the first shaft point [s]')
        figure.suptitle(f'Recorded run {recording.path.name}', x=0.01, ha='left',
                        fontweight='bold', fontsize=11.0)
        if states := list(dict.fromkeys(seen)):
            figure.legend(handles=[Patch(color=_SHADES[state], label=state) for state in states],
                          loc='outside lower left', ncols=len(states))
        figure.align_ylabels(panels[:, 0])
    return figure


def _shaded(recording: Recording, name: str) -> bool:
    return any(state in _SHADES for _, state in recording.states.get(name, ())[1:])


def _draw(panel: Axes, recording: Recording, axis: Axis, order: int, colour: str,
          zero: int) -> None:
    track = recording.setpoints[axis.name]
    if track is None or not len(track):
        return
    every = 1 + len(track) // _MOST_POINTS
    t = (track.stamps_ns[::every] - zero) * 1e-9
    values = (track.position, track.velocity, track.acceleration)[order][::every]
    panel.plot(t, values, color=colour, linewidth=1.2)
    limit = axis.limits.of_order(order) if order else None
    if limit is not None and limit < 2.0 * np.max(np.abs(values)):
        for sign in (1.0, -1.0):
            panel.axhline(sign * limit, color=GREY, linewidth=0.9, linestyle=(0, (5, 3)))


def _shade(panel: Axes, recording: Recording, name: str, zero: int) -> list[str]:
    """Shade the states behind a panel; give their names."""
    told = [*recording.states.get(name, ()), (int(recording.shaft.stamps_ns[-1]), '')]
    seen = []
    for (begin, state), (end, _) in pairwise(told):
        if state in _SHADES and end > zero:
            panel.axvspan(max(0.0, (begin - zero) * 1e-9), (end - zero) * 1e-9,
                          color=_SHADES[state], linewidth=0.0, zorder=0)
            seen.append(state)
    return seen
