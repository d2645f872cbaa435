# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Rotary knife and flying shear: in the zone their velocity is the web's, and all is C2."""

from pathlib import Path

from cam_motion.io.config import parse_sections, read_sections
from cam_motion.io.machine import build_machine
from cam_motion.io.summary import check_sections
from cam_motion.motion.continuity import continuity_of
from cam_motion.units import DEGREE, RPM, TURN
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config'
SAME = 1e-12  # of the web's velocity
ZONES = {'rotary_knife': ('knife', 144.0, 216.0), 'flying_shear': ('carriage', 72.0, 144.0)}


@pytest.fixture(params=ZONES, scope='module')
def machine(request):
    """Give the profiles of the web and of what runs with it, and the zone [rad]."""
    axis, low, high = ZONES[request.param]
    axes = build_machine(read_sections(CONFIG / f'{request.param}.yaml')).diagram.axes
    return axes['web'].profile, axes[axis].profile, low * DEGREE, high * DEGREE


def test_in_the_zone_the_velocity_is_the_web_s(machine):
    web, axis, low, high = machine
    inside = np.linspace(low, high, 1001)
    speed = web.advance / TURN
    assert web(inside, 1) == pytest.approx(speed, rel=SAME)
    assert axis(inside, 1) == pytest.approx(speed, rel=SAME)
    assert axis(inside[1:-1], 2) == pytest.approx(0.0, abs=SAME)
    # whatever the shaft does: the velocity in time is y' omega, the acceleration y' alpha
    for phi in inside[1:-1:100].tolist():
        ours, theirs = axis.at_speed(phi, 5.0, -40.0), web.at_speed(phi, 5.0, -40.0)
        assert ours[1:] == pytest.approx(theirs[1:], rel=SAME, abs=SAME)
    # so what lies between blade and web does not move
    gap = axis(inside) - web(inside)
    assert np.ptp(gap) <= SAME


def test_outside_the_zone_it_is_not(machine):
    web, axis, low, high = machine
    speed = web.advance / TURN
    for phi in (low - 10.0 * DEGREE, high + 10.0 * DEGREE):
        assert abs(float(axis(phi, 1)) / speed - 1.0) > 1e-3


def test_every_joint_is_c2_over_the_end_of_the_cycle_too(machine):
    for profile in machine[:2]:
        found = continuity_of(profile)
        assert all(each.joint.continuity >= 2 for each in found.joints)
        assert found.weakest.continuity >= 2


def test_the_drum_turns_once_per_sheet_and_never_stands_or_reverses():
    knife = build_machine(read_sections(CONFIG / 'rotary_knife.yaml')).diagram.axes['knife']
    assert knife.profile.advance == pytest.approx(0.5, abs=1e-15)
    assert knife.profile.curve.extremes(1)[0].value > 0.0
    # it is slowest while it cuts: the sheet is shorter than the drum's circumference
    slowest = knife.profile.curve.extremes(1)[0]
    assert slowest.value == pytest.approx(0.4 / TURN, rel=1e-9)


@pytest.mark.parametrize('length', [0.3, 0.4, 0.5, 0.7, 0.9])
def test_another_format_keeps_the_zone(length):
    text = (CONFIG / 'rotary_knife.yaml').read_text()
    cut, rest = length / 5.0, (0.5 - length / 5.0) / 2.0
    for old, new in (('lift: 0.400', length), ('lift: 0.080', cut), ('lift: 0.210', rest)):
        assert old in text
        text = text.replace(old, f'lift: {new!r}')
    axes = build_machine(parse_sections(text)).diagram.axes
    inside = np.linspace(144.0, 216.0, 101) * DEGREE
    assert axes['knife'].profile(inside, 1) == pytest.approx(length / TURN, rel=SAME)
    assert axes['knife'].profile.advance == pytest.approx(0.5, abs=1e-15)
    assert continuity_of(axes['knife'].profile).weakest.continuity >= 2
    turned = axes['knife'].profile.curve.peak(1).value
    assert (turned > length / TURN * (1.0 + 1e-9)) == (length < 0.5)


def test_the_carriage_comes_back_and_its_blade_is_up_outside_the_zone():
    machine = build_machine(read_sections(CONFIG / 'flying_shear.yaml'))
    carriage, blade = (machine.diagram.axes[name].profile for name in ('carriage', 'blade'))
    assert carriage.advance == 0.0
    assert float(carriage(0.0)) == 0.0
    assert float(carriage(144.0 * DEGREE) - carriage(72.0 * DEGREE)) == pytest.approx(
        0.24, abs=1e-15)
    outside = np.concatenate([np.linspace(0.0, 72.0, 100), np.linspace(144.0, 360.0, 300)[:-1]])
    assert np.all(np.abs(blade(outside * DEGREE)) <= 1e-15)
    assert all(each.verdict.kept for each in machine.interlocks.values())
    assert set(machine.interlocks) == {'not_before', 'not_after'}


@pytest.mark.parametrize(('name', 'speed_cpm'), [('rotary_knife', 120.0), ('flying_shear', 60.0)])
def test_both_run_at_their_set_speed_with_room_left(name, speed_cpm):
    check = check_sections(read_sections(CONFIG / f'{name}.yaml'))
    assert check.problems == ()
    assert check.speed_cpm == speed_cpm
    assert check.runs_at_set_speed
    assert check.line_bound[1].omega > 1.2 * speed_cpm * RPM
