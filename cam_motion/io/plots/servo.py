# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A servo drive over one cycle: its torque within the motor's limits, and its following error."""

from __future__ import annotations

from cam_motion.drive.servo_cycle import ServoCycle
from cam_motion.io.plots.style import COLOURS, figure_text, GREY, new_figure, styled
from matplotlib.figure import Figure


def following_figure(name: str, cycle: ServoCycle, unit: str) -> Figure:
    """
    Draw torque and following error of a servo drive over time.

    Parameters
    ----------
    name : str
        Name of the drive.
    cycle : ServoCycle
        One cycle of it.
    unit : str
        Unit of its axis.

    Returns
    -------
    Figure
        Two panels over the time in the cycle [s].

    """
    motor = cycle.tally.motor
    with styled():
        figure = new_figure(4.8)
        upper, lower = figure.subplots(2, 1, sharex=True)
        limit = motor.peak_torque(cycle.motor_velocity)
        for sense, text in ((1.0, 'peak torque at the speed of the moment'), (-1.0, None)):
            upper.plot(cycle.time, sense * limit, color=GREY, linewidth=1.2, label=text)
        upper.plot(cycle.time, cycle.motor_torque, color=COLOURS[0], label='motor torque')
        upper.set_ylabel('torque C [N m]')
        upper.set_title(
            f'{name}: following error up to {figure_text(cycle.tally.peak_error)} {unit}', pad=22)
        upper.legend(loc='lower right', bbox_to_anchor=(1.0, 0.98), ncols=2)
        lower.axhline(0.0, color='#444444', linewidth=0.8)
        lower.plot(cycle.time, cycle.following_error, color=COLOURS[1])
        lower.set_ylabel(f'following error [{unit}]')
        lower.set_xlabel('time in the cycle [s]')
        lower.set_xlim(0.0, float(cycle.time[-1]))
        for panel in (upper, lower):
            panel.margins(y=0.1)
        figure.align_ylabels((upper, lower))
    return figure
