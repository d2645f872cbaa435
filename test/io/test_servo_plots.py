# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Pictures of drives with a servo motor: the limits in them, and what the drive really does."""

from pathlib import Path

from cam_motion.cli import main
from cam_motion.drive.servo_cycle import limit_figures
from cam_motion.io.config import load_machine
from cam_motion.io.plots import following_figure, torque_curve, torque_figure
from cam_motion.io.simulation import live_cycle
from cam_motion.units import RPM
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

MACHINE = str(Path(__file__).resolve().parents[2] / 'config' / 'feeding_group_servo.yaml')
PEAK = 'peak torque of the motor'
CONTINUOUS = 'continuous torque; crosses: RMS torque at RMS speed'


@pytest.fixture(scope='module')
def machine():
    return load_machine(MACHINE)


@pytest.fixture(scope='module')
def live(machine):
    return live_cycle(machine, machine.drives['feeder_drive'])


def plane_of(machine, cpm=60.0, **more):
    settings = machine.drives['feeder_drive']
    curve = torque_curve(settings, machine.diagram.axes['feeder'], cpm * RPM)
    return torque_figure('feeder_drive', [curve], motor=settings.motor, **more).axes[0], curve


def lines(plane):
    return {line.get_label(): line for line in plane.lines}


def test_the_limits_are_the_motors_in_all_four_quadrants(machine):
    plane, _ = plane_of(machine)
    motor = machine.drives['feeder_drive'].motor
    for label, limit in ((PEAK, motor.peak), (CONTINUOUS, motor.continuous)):
        rpm, torque = lines(plane)[label].get_data()
        assert np.abs(torque) == pytest.approx(limit(rpm * RPM), rel=1e-12)
        for quadrant in (1.0, -1.0):
            assert {(-5000.0, quadrant), (5000.0, quadrant)} <= {
                (round(n, 6), float(np.sign(c))) for n, c in zip(rpm, torque)}


def test_a_cross_compares_rms_torque_at_rms_speed(machine):
    plane, curve = plane_of(machine)
    cross, = (line for line in plane.lines if line.get_marker() == 'X')
    (rpm,), (torque,) = cross.get_data()
    assert torque == curve.rms_torque
    settings = machine.drives['feeder_drive']
    exact = limit_figures(settings.drive, settings.motor, machine.diagram.axes['feeder'].profile,
                          60.0 * RPM)
    assert rpm * RPM == pytest.approx(exact.rms_speed, rel=1e-4)


def test_without_a_motor_there_are_no_limits(machine):
    settings = machine.drives['feeder_drive']
    curve = torque_curve(settings, machine.diagram.axes['feeder'], 60.0 * RPM)
    plane = torque_figure('feeder_drive', [curve]).axes[0]
    assert not {PEAK, CONTINUOUS} & set(lines(plane))
    assert not [line for line in plane.lines if line.get_marker() == 'X']


@pytest.mark.parametrize('cpm, whole', [(60.0, False), (-120.0, True)])
def test_the_half_in_which_the_motor_does_not_turn_is_left_out(machine, cpm, whole):
    plane, curve = plane_of(machine, cpm)
    left, right = plane.get_xlim()
    assert right > 5000.0
    assert (left < -5000.0) == whole
    assert left < curve.velocity.min() / RPM


def test_what_the_drive_really_does_lies_on_its_setpoints(machine, live):
    plane, _ = plane_of(machine, live=live)
    dots, = (line for line in plane.lines if line.get_marker() == '.')
    assert np.array_equal(dots.get_ydata(), live.motor_torque)
    assert dots.get_label() == 'servo drive, at its setpoints: 0 s of the cycle at a limit'
    assert len(live.time) == 500
    assert np.diff(live.time) == pytest.approx(0.002)


def test_the_following_error_is_drawn_over_the_cycle(live):
    figure = following_figure('feeder_drive', live, 'm')
    upper, lower = figure.axes
    assert np.array_equal(lines(upper)['motor torque'].get_ydata(), live.motor_torque)
    assert np.array_equal(lower.lines[1].get_ydata(), live.following_error)
    assert lower.get_ylabel() == 'following error [m]'
    assert np.max(np.abs(live.following_error)) <= live.tally.peak_error


def test_simulate_draws_and_tells_what_the_drive_leaves(tmp_path, capsys):
    assert main(['simulate', MACHINE, '-o', str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {
        'torque_feeder_drive.png', 'following_feeder_drive.png'}
    said = capsys.readouterr().out
    for text in ('exact motion', 'servo drive', 'peak following error', 'RMS motor current',
                 'least distance from the peak torque', 'catches up within each cycle'):
        assert text in said


def test_check_tells_what_the_drives_leave(capsys):
    assert main(['check', MACHINE]) == 0
    assert 'feeder_drive       7.1409      2.2785  3268.3' in capsys.readouterr().out
    assert main(['check', MACHINE, '--speed-cpm', '100']) == 0
    assert '! -50.855   ! -20.065  2113.8' in capsys.readouterr().out
