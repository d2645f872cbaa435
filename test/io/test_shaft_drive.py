# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A machine whose shaft a drive turns: who is master, which speed counts, what is refused."""

from dataclasses import replace
from pathlib import Path

from cam_motion.drive.orbit import find_orbit
from cam_motion.errors import ConfigurationError
from cam_motion.io.cam_drive_parameters import CAM_DRIVE, cam_drive_table
from cam_motion.io.config import load_machine, parse_sections, read_sections
from cam_motion.io.machine import build_machine, ShaftDrive
from cam_motion.io.plots.motor import recorded_motor_figure
from cam_motion.io.summary import check_sections, with_speed
from cam_motion.units import RPM
import numpy as np
import pytest

CONFIG = Path(__file__).resolve().parents[2] / 'config'
PRESS = CONFIG / 'cam_press_drive.yaml'


def problems_of(text):
    """Give the problems of a machine file by path."""
    with pytest.raises(ConfigurationError) as refused:
        build_machine(parse_sections(text))
    return {problem.path: problem for problem in refused.value.problems}


def edited(*replacements):
    """Give the text of the press with some of it replaced."""
    text = PRESS.read_text(encoding='utf-8')
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def test_the_drive_is_the_master():
    machine = load_machine(PRESS)
    assert isinstance(machine.master, ShaftDrive)
    assert (machine.master.name, machine.master.speed) == ('press_drive', 400.0 * RPM)
    assert machine.drive_names == ('press_drive',)
    assert machine.master.values['rate_hz'] == 500.0


def test_the_brake_takes_the_breakdown_torque_unless_told_otherwise():
    drive = load_machine(PRESS).cam_drives['press_drive']
    assert drive.brake_torque == 27.27
    text = edited(('    flywheel:', '    brake: {torque: 12.5}\n    flywheel:'))
    drive = build_machine(parse_sections(text)).cam_drives['press_drive']
    assert drive.brake_torque == 12.5


def test_a_master_shaft_beside_it_is_refused():
    problems = problems_of(
        PRESS.read_text(encoding='utf-8') + 'master_shaft: {ros__parameters: {rate_hz: 100.0}}')
    assert list(problems) == ['master_shaft']
    assert 'press_drive turns the shaft' in str(problems['master_shaft'])


def test_two_drives_that_turn_the_shaft_are_refused():
    text = PRESS.read_text(encoding='utf-8')
    second = text[text.index('press_drive:\n'):].replace('press_drive:', 'other_drive:')
    text = text.replace('drives: [press_drive]', 'drives: [press_drive, other_drive]') + second
    assert list(problems_of(text)) == ['line.drives']


def test_the_limits_hold_at_the_greatest_speed_of_the_periodic_motion():
    machine = load_machine(PRESS)
    drive = machine.cam_drives['press_drive'].drive
    top = find_orbit(drive).speeds[1]
    assert machine.master.top_speed == pytest.approx(top, rel=1e-12)
    peak = max(abs(peak.value) for peak in drive.profile.curve.extremes(1))
    assert top > 1.05 * machine.master.speed
    for share, kept in ((1.001, True), (0.999, False)):
        text = edited(('    unit: m\n', '    unit: m\n    limits: {velocity: '
                       f'{share * peak * top!r}}}\n'))
        if kept:
            build_machine(parse_sections(text))
        else:
            assert list(problems_of(text)) == ['follower.limits.velocity']


def test_a_drive_that_cannot_turn_its_load_is_a_machine_all_the_same():
    text = edited(('breakdown_torque: 27.27', 'breakdown_torque: 1.0'))
    machine = build_machine(parse_sections(text))
    assert machine.master.top_speed == machine.master.speed


def test_a_check_is_at_the_nominal_speed_or_at_the_one_given():
    sections = read_sections(PRESS)
    assert check_sections(sections).speed_cpm == 400.0
    given = check_sections(sections, 200.0)
    assert given.problems == ()
    velocities = [check.axes['follower'].segments[0].physical[0]
                  for check in (check_sections(sections), given)]
    assert velocities[0] == pytest.approx(2.0 * velocities[1])


def test_no_setting_gives_it_another_speed():
    with pytest.raises(ConfigurationError, match='its motor and its load make the speed'):
        with_speed(read_sections(PRESS), 300.0)


def test_every_part_of_the_load_has_its_parameters_below_its_name():
    table = cam_drive_table(read_sections(PRESS)['press_drive'])
    names = [spec.name for spec in table]
    assert len(names) == len(set(names))
    assert {'slider.mass', 'slider.gravity', 'lever.window_deg', 'spring.preload'} <= set(names)
    assert table[:len(CAM_DRIVE)] == CAM_DRIVE
    assert [replace(s, name='type') for s in cam_drive_table({'load': ['x']})[len(CAM_DRIVE):]
            ] == [replace(table[-1], **vars(next(s for s in table if s.name == 'cam.type')) | {
                'name': 'type'})]


@pytest.mark.parametrize('coupling', [
    'ratio: 2.0', 'phase_deg: 10.0', 'scale: 0.5', 'offset: 0.1'])
def test_a_cam_sits_on_the_shaft_it_loads(coupling):
    problems = problems_of(edited(('    unit: m\n', f'    unit: m\n    {coupling}\n')))
    assert list(problems) == ['press_drive.axis']


def test_the_picture_of_a_recorded_run_shows_motor_and_states():
    drive = load_machine(PRESS).cam_drives['press_drive']
    speed = np.linspace(0.0, 158.0, 50)
    torque = np.where(speed < 100.0, drive.drive.motor.torque(speed), -27.27)
    figure = recorded_motor_figure(drive, speed, torque)
    curve, dots = figure.axes[0].lines[-2:]
    assert len(dots.get_xdata()) == 50
    assert list(dots.get_xdata()) == pytest.approx(list(speed / RPM))
    assert max(curve.get_ydata()) == pytest.approx(27.27, rel=1e-3)
    assert max(curve.get_xdata()) > max(dots.get_xdata())


@pytest.mark.parametrize('load', ['[cam, cam]', '[cam, motor]'])
def test_names_of_parts_are_their_own(load):
    assert 'press_drive.load' in problems_of(edited(('[cam, slider, spring, lever]', load)))
