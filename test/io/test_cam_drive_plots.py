# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Pictures of cam drives: what the axes say, and that the data are the solvers' figures."""

from dataclasses import replace
import math
from pathlib import Path

from cam_motion.drive.load import Friction, RotatingInertia, Spring
from cam_motion.drive.orbit import find_orbit
from cam_motion.drive.start_up import start_up
from cam_motion.io.config import load_machine
from cam_motion.io.plots import (
    cam_figure,
    flywheel_curve,
    flywheel_figure,
    load_figure,
    motor_figure,
    orbit_figure,
    save,
    start_up_figure,
)
from cam_motion.io.plots.cam_drive import part_names
from cam_motion.io.plots.flywheel import FlywheelCurve
from cam_motion.io.simulation import orbit_figures, start_up_figures
from cam_motion.mechanism.cam_disc import CamDisc
from cam_motion.mechanism.cam_roller import TranslatingRoller
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from cam_motion.units import DEGREE, RPM, TURN
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config'
PRESS = load_machine(CONFIG / 'cam_press_drive.yaml').cam_drives['press_drive']
ORBIT = find_orbit(PRESS.drive)
RUN = start_up(PRESS.drive, 1.5)
CAM = CamDisc(PRESS.drive.profile, TranslatingRoller(PRESS.base_radius, PRESS.roller_radius))


def texts(axes):
    """Give the texts written into axes, one string."""
    return '\n'.join(text.get_text() for text in axes.texts)


def labels(figure):
    """Give the labels up and across, lines joined."""
    return ([axes.get_ylabel().replace('\n', ' ') for axes in figure.axes],
            [axes.get_xlabel() for axes in figure.axes])


def line(axes, label):
    """Give the data of the line of a label."""
    return next(found.get_data() for found in axes.lines if found.get_label() == label)


def marks(axes):
    """Give the points marked in axes."""
    return [(drawn.get_xdata()[0], drawn.get_ydata()[0]) for drawn in axes.lines
            if drawn.get_marker() == 'o' and len(drawn.get_xdata()) == 1]


def test_cam_shows_motion_pressure_angle_and_radius_in_si_units():
    up, across = labels(figure := cam_figure(PRESS))
    assert up == ['s [m]', 's′ [m/rad]', 's″ [m/rad²]', 'pressure angle α [deg]',
                  'radius of the contour ρ [m]']
    assert across == [''] * 4 + ['shaft angle φ [deg]']
    q = np.radians(figure.axes[0].lines[0].get_xdata())
    # the profile itself takes the right-hand value at steps: leave the joints out
    inner = np.min(np.abs(q[:, None] - [0.0, 150.0 * DEGREE, TURN]), axis=1) > 1e-6
    for order, row in enumerate(figure.axes[:3]):
        assert row.lines[0].get_ydata()[inner] == pytest.approx(
            PRESS.drive.profile(q[inner], order), abs=1e-12)
    assert np.radians(figure.axes[3].lines[0].get_ydata()[inner]) == pytest.approx(
        CAM.pressure_angle(q[inner]), abs=1e-12)
    assert figure.axes[4].lines[0].get_ydata()[inner] == pytest.approx(
        CAM.contour_radius(q[inner]), rel=1e-9)


def test_extremes_of_the_cam_are_those_of_the_mechanism():
    figure = cam_figure(PRESS)
    greatest, least = CAM.max_pressure_angle, CAM.least_contour_radius
    assert marks(figure.axes[3]) == [
        pytest.approx((greatest.at / DEGREE, greatest.value / DEGREE))]
    # document 004 b): 25.3 deg
    assert texts(figure.axes[3]).startswith('25.255°')
    assert marks(figure.axes[4]) == [pytest.approx((least.at / DEGREE, least.value))]
    assert 'radius of the roller 0.012 m' in texts(figure.axes[4])


def test_a_step_of_the_acceleration_is_drawn_from_both_sides():
    figure = cam_figure(PRESS)
    angles, bend = figure.axes[2].lines[0].get_data()
    sides = bend[np.flatnonzero(np.abs(angles - 150.0) < 1e-9)]
    # H/2 (pi / beta)² of the simple harmonic rise and return
    assert sides == pytest.approx([-0.03 * (math.pi / (150.0 * DEGREE)) ** 2,
                                   -0.03 * (math.pi / (210.0 * DEGREE)) ** 2])


def test_a_pointed_follower_has_no_roller_to_draw():
    said = texts(cam_figure(replace(PRESS, roller_radius=0.0)).axes[4])
    assert (said.startswith('least'), 'roller' in said) == (True, False)


def test_an_undercut_is_said():
    profile = CamProfile([segment('up', 25.0, 0.06, 'cycloidal'),
                          segment('down', 360.0, -0.06, 'cycloidal')])
    steep = replace(PRESS, drive=replace(PRESS.drive, profile=profile))
    row = cam_figure(steep).axes[4]
    assert 'undercut' in texts(row)
    assert np.all(np.isfinite(row.get_ylim()))


def test_load_shows_inertias_and_forces_by_part_without_the_motor():
    figure = load_figure(PRESS)
    up, across = labels(figure)
    assert up == ['inertia J [kg m²]', 'centripetal inertia C = ½ dJ/dφ [kg m²]',
                  'generalised forces Q [N m]']
    assert across[-1] == 'shaft angle φ [deg]'
    angles, inertia = figure.axes[0].lines[0].get_data()
    slope = figure.axes[1].lines[0].get_ydata()
    assert inertia[[0, -1]] == pytest.approx([0.02, 0.02])  # the cam alone: nothing else moves
    # C = ½ dJ/dq: integrated it gives J back, to the trapezoidal rule
    gained = 2.0 * np.trapezoid(slope[angles <= 75.0], np.radians(angles[angles <= 75.0]))
    assert gained == pytest.approx(inertia[angles <= 75.0][-1] - 0.02, rel=1e-4)
    forces = figure.axes[2]
    named = {found.get_label() for found in forces.lines if found.get_label()[0] != '_'}
    assert named == {'weight', 'spring', 'moment of the lever', 'sum'}
    total = sum(line(forces, name)[1] for name in named - {'sum'})
    assert line(forces, 'sum')[1] == pytest.approx(total, abs=1e-12)
    spring = line(forces, 'spring')[1]
    s, s1 = (PRESS.drive.profile(np.radians(angles), order) for order in (0, 1))
    assert spring == pytest.approx(-20000.0 * (s + 0.01) * s1, abs=1e-9)


def test_the_moment_of_a_lever_steps_where_its_window_ends():
    lever = replace(PRESS.drive.parts[3], window=(0.0, 90.0 * DEGREE))
    drive = replace(PRESS.drive, parts=[*PRESS.drive.parts[:3], lever])
    figure = load_figure(replace(PRESS, drive=drive))
    angles, moment = line(figure.axes[2], 'moment of the lever')
    before, after = moment[np.abs(angles - 90.0) < 1e-9]
    assert (before < -30.0, after) == (True, 0.0)
    assert 90.0 in figure.axes[2].get_xticks()


def test_parts_of_a_kind_are_numbered():
    parts = [Spring(1.0), RotatingInertia(1.0), Spring(2.0), Friction(1.0)]
    assert part_names(parts) == ['spring 1', 'inertia', 'spring 2', 'friction']


def test_motor_is_drawn_from_turning_backwards_to_overspeed_with_the_periodic_motion():
    figure = motor_figure(PRESS, ORBIT)
    whole, near = figure.axes
    assert whole.get_xlabel() == near.get_xlabel() == 'motor speed n [rpm]'
    assert whole.get_ylabel() == 'torque at the motor shaft T [N m]'
    motor = PRESS.drive.motor
    rpm, torque = line(whole, 'motor')
    assert (rpm[0] < 0.0, rpm[-1] > 1500.0) == (True, True)
    assert torque == pytest.approx(motor.torque(rpm * RPM))
    assert '27.27 N m, 1027.5 rpm' in texts(whole)
    rpm, torque = line(near, 'motor in periodic motion')
    assert rpm[[0, -1]] * RPM == pytest.approx(
        [PRESS.drive.gearbox.ratio * speed for speed in ORBIT.speeds])
    loop_rpm, taken = line(near, 'load, (C ω² − Q)/i, round the revolution')
    assert (loop_rpm[0], taken[0]) == pytest.approx((loop_rpm[-1], taken[-1]))  # it closes
    assert loop_rpm.min() == pytest.approx(rpm.min(), rel=1e-6)


def test_start_up_marks_what_simulate_prints():
    figure = start_up_figure(PRESS, ORBIT, RUN)
    upper, lower = figure.axes
    assert (upper.get_ylabel(), lower.get_ylabel().replace('\n', ' '), lower.get_xlabel()) == (
        'speed n [rpm]', 'contact force F [N]', 'time t [s]')
    printed = start_up_figures(PRESS, ORBIT, RUN)
    assert marks(upper) == [
        pytest.approx((printed['first_crossing_s'], 400.0)),
        pytest.approx((printed['settled_s'], 400.0), rel=1e-4)]
    assert 'periodic motion, 401.0 to 424.1 rpm' in str(
        [text.get_text() for text in upper.get_legend().get_texts()])
    t, _, omega = RUN.history
    assert upper.lines[1].get_data() == (pytest.approx(t), pytest.approx(omega / RPM))
    times, force = lower.lines[1].get_data()
    assert times == pytest.approx(t)
    assert marks(lower) == [pytest.approx((times[force.argmin()], force.min()))]
    # document 004: 514.2 N; between the points drawn the least is refined
    assert force.min() == pytest.approx(printed['min_contact_force'], rel=1e-4)
    assert texts(lower) == 'least 514.19 N'


def test_orbit_shows_one_revolution_that_closes_and_balances():
    figure = orbit_figure(PRESS, ORBIT)
    speed, torques, contact = figure.axes
    assert labels(figure)[0] == ['speed n [rpm]', 'torques at the cam shaft [N m]',
                                 'contact force F [N]']
    angles, rpm = speed.lines[0].get_data()
    assert angles[[0, -1]] == pytest.approx([0.0, 360.0])
    assert rpm[0] == pytest.approx(rpm[-1], rel=1e-9)
    printed = orbit_figures(PRESS, ORBIT)
    assert [y for _, y in marks(speed)] == pytest.approx(
        [printed['min_speed_rpm'], printed['max_speed_rpm']], rel=1e-6)
    motor, load, inertia, centripetal = (
        line(torques, name)[1] for name in ('motor', 'load Q', 'J dω/dt', 'C ω²'))
    assert motor + load == pytest.approx(inertia + centripetal, abs=1e-9)
    assert contact.lines[0].get_ydata().min() == pytest.approx(
        printed['min_contact_force'], rel=1e-5)


@pytest.fixture(scope='module')
def curve():
    """Give the trade-off of the press drive; it takes seconds."""
    return flywheel_curve(PRESS)


def test_flywheel_curve_goes_through_the_configured_drive(curve):
    own = int(np.argmin(np.abs(curve.inertia - 0.06)))
    assert (curve.inertia[0], curve.inertia[own], curve.inertia[-1]) == pytest.approx(
        (0.0, 0.06, 0.24))
    printed = orbit_figures(PRESS, ORBIT)
    assert curve.fluctuation_pct[own] == pytest.approx(printed['fluctuation_pct'])
    assert curve.contact_force[own] == pytest.approx(printed['min_contact_force'])
    assert np.all(np.diff(curve.fluctuation_pct) < 0.0)
    # facts of document 004: around 20 % without a flywheel
    assert 15.0 < curve.fluctuation_pct[0] < 22.0
    start = int(np.argmin(np.abs(curve.start_inertia - 0.06)))
    settled = start_up_figures(PRESS, ORBIT, RUN)
    assert curve.settled[start] == pytest.approx(settled['settled_s'])
    assert curve.start_contact_force[start] == pytest.approx(settled['min_contact_force'])


def test_flywheel_figure_shows_the_curve_and_marks_the_configured_one(curve):
    figure = flywheel_figure(PRESS, curve)
    up, across = labels(figure)
    assert up == ['fluctuation [%]', 'start-up: settled after [s]', 'least contact force [N]']
    assert across[-1] == 'inertia of the flywheel on the motor shaft J [kg m²]'
    assert figure.axes[0].lines[0].get_data() == (
        pytest.approx(curve.inertia), pytest.approx(curve.fluctuation_pct))
    assert marks(figure.axes[0]) == [pytest.approx((0.06, 5.767567), rel=1e-6)]


def test_flywheels_without_periodic_motion_are_shaded():
    x = np.linspace(0.0, 0.24, 5)
    gap = np.array([np.nan, np.nan, 3.0, 2.0, 1.0])
    figure = flywheel_figure(PRESS, FlywheelCurve(x, gap, gap, x, gap, gap))
    assert 'no periodic motion' in texts(figure.axes[0])


def test_pictures_are_the_same_file_each_time(tmp_path):
    first, second = (
        save(load_figure(PRESS), tmp_path / name).read_bytes() for name in ('a.svg', 'b.svg'))
    assert first == second
    assert first.startswith(b'<?xml')
