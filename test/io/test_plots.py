# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Pictures: what the axes say and which data they show, not pixels."""

import math
from pathlib import Path

from cam_motion.io.config import load_machine
from cam_motion.io.plots import profile_figure, save, timing_diagram, torque_curve, torque_figure
from cam_motion.io.plots.style import exact_curve, styled
from cam_motion.motion.diagram import Axis, TimingDiagram
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
import matplotlib
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

OMEGA = 200.0 * 2.0 * math.pi / 60.0
MACHINE = load_machine(Path(__file__).resolve().parents[2] / 'config' / 'cutting_machine.yaml')
FEEDER = MACHINE.diagram.axes['feeder']
STEPPING = Axis('arm', CamProfile([
    segment('up', 120.0, 1.0, 'constant_acceleration'), segment('down', 360.0, -1.0, 'cubic'),
]), 'rad')


def texts(axes):
    """Give the texts written into axes."""
    return [text.get_text() for text in axes.texts]


def ticks(axes):
    """Give the positions and visible labels of the ticks across."""
    labels = [label.get_text() for label in axes.get_xticklabels() if label.get_visible()]
    return list(axes.get_xticks()), labels


def test_timing_diagram_has_a_row_per_axis_with_its_own_angles():
    figure = timing_diagram(MACHINE.diagram)
    rows = figure.axes
    assert [row.get_ylabel() for row in rows] == [
        'feeder\ny [m]', 'press\ny [m]', 'knife\ny [m]']
    assert [row.get_xlabel() for row in rows] == ['', '', 'shaft angle φ [deg]']
    assert ticks(rows[0])[0] == [0, 80, 360]
    assert ticks(rows[1])[0] == [0, 90, 135, 305, 350, 360]
    assert ticks(rows[2])[1] == ['0°', '145°', '225°', '235°', '295°', '360°']
    assert {'close', 'open'} <= set(texts(rows[1]))
    assert 'advances 0.3 m per cycle' in texts(rows[0])
    angles, positions = rows[2].lines[0].get_data()
    knife = MACHINE.diagram.axes['knife'].profile
    assert positions == pytest.approx(knife(np.radians(angles)), abs=1e-12)


def test_crowded_angles_keep_their_ticks_and_lose_the_middle_label():
    crowded = CamProfile([segment('a', 100.0), segment('b', 108.0), segment('c', 116.0),
                          segment('d', 360.0)])
    row = timing_diagram(TimingDiagram({'x': Axis('x', crowded)})).axes[0]
    positions, labels = ticks(row)
    assert positions == [0, 100, 108, 116, 360]
    assert labels == ['0°', '100°', '116°', '360°']


def test_profile_shows_both_scales_and_the_peaks_of_document_001():
    figure = profile_figure(FEEDER, OMEGA)
    rows = figure.axes[:4]
    assert [row.get_ylabel() for row in rows] == [
        'y [m]', 'y′ [m/rad]', 'y″ [m/rad²]', 'y‴ [m/rad³]']
    right = [child.get_ylabel() for row in rows for child in row.child_axes]
    assert right == ['velocity [m/s]', 'acceleration [m/s²]', 'jerk [m/s³]']
    assert '9 m/s' in texts(rows[1])
    assert {'329.95 m/s²', '−329.95 m/s²', 'limit 400 m/s²'} <= set(texts(rows[2]))
    assert '200 cycles/min' in rows[0].get_title(loc='left')


def test_right_hand_scale_is_the_left_one_times_omega_to_the_order():
    figure = profile_figure(FEEDER, OMEGA)
    figure.canvas.draw()
    for order, row in enumerate(figure.axes[1:4], start=1):
        right = row.child_axes[0]
        assert right.get_ylim() == pytest.approx(
            tuple(OMEGA ** order * limit for limit in row.get_ylim()))


def test_a_shaft_that_stands_has_no_physical_scale():
    figure = profile_figure(FEEDER, 0.0)
    assert not any(row.child_axes for row in figure.axes)
    assert any(text.endswith('m/rad²') for text in texts(figure.axes[2]))


def test_infinite_jerk_is_marked_where_the_acceleration_steps():
    jerk = profile_figure(STEPPING, 1.0).axes[3]
    marked = sorted(line.get_xdata()[0] for line in jerk.lines if line.get_marker() in '^v')
    assert marked == pytest.approx([0.0, 60.0, 120.0])
    assert '▲▼ acceleration steps: infinite jerk' in texts(jerk)
    smooth = profile_figure(FEEDER, 1.0).axes[3]
    assert '▲▼ acceleration steps: infinite jerk' not in texts(smooth)


def test_exact_curve_holds_both_values_at_a_step():
    angles, values = exact_curve(STEPPING.profile, 2)
    at_60 = values[np.isclose(angles, 60.0)]
    peak = 4.0 / math.radians(120.0) ** 2
    assert at_60 == pytest.approx([peak, -peak])


def test_torque_over_speed_of_the_feeding_group():
    """Document 001 with tau = 1/2: C_m = (C_r + J_tot dw_r/dt) / 2, w_m = 2 v / R."""
    settings = MACHINE.drives['feeder_drive']
    curve = torque_curve(settings, FEEDER, 0.5 * OMEGA)
    peak = 0.25 * FEEDER.profile.curve.peak(2).value * OMEGA ** 2
    assert curve.torque.max() == pytest.approx(0.5 * (67.0 + 1.164 * peak / 0.134), rel=1e-9)
    assert curve.velocity.max() == pytest.approx(2.0 * 4.5 / 0.134, rel=1e-5)
    plane = torque_figure('feeder_drive', [curve]).axes[0]
    assert (plane.get_xlabel(), plane.get_ylabel()) == ('motor speed n [rpm]',
                                                        'motor torque C [N m]')
    rpm, torque = plane.lines[2].get_data()
    assert rpm.max() == pytest.approx(curve.velocity.max() * 60.0 / (2.0 * math.pi))
    assert np.array_equal(torque, curve.torque)


def test_the_rms_torque_of_a_cycle_is_that_of_its_law():
    """Without resistance the RMS torque is J/2R times the RMS acceleration over the turn."""
    drive = MACHINE.drives['feeder_drive']
    free = type(drive)('d', 'feeder', type(drive.drive)(
        radius=0.134, gear_ratio=2.0, load_inertia=1.164))
    curve = torque_curve(free, FEEDER, OMEGA)
    rms = FEEDER.profile.curve.rms(2) * OMEGA ** 2
    assert curve.rms_torque == pytest.approx(0.5 * 1.164 / 0.134 * rms, rel=1e-4)


def test_pictures_leave_the_settings_of_matplotlib_alone_and_are_reproducible(tmp_path):
    before = dict(matplotlib.rcParams)
    with styled():
        assert matplotlib.rcParams['svg.hashsalt'] == 'cam_motion'
    files = [save(timing_diagram(MACHINE.diagram), tmp_path / str(n) / 'a.svg') for n in (1, 2)]
    assert dict(matplotlib.rcParams) == before
    assert files[0].read_bytes() == files[1].read_bytes()
