# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Cam discs in a machine file: what is read, what is refused, and what is written."""

import csv
from pathlib import Path

from cam_motion.errors import CamMotionError, ConfigurationError
from cam_motion.io.cam_disc_config import build_cam_discs
from cam_motion.io.config import parse_sections, read_sections
from cam_motion.io.contour import check_discs, contour_figures, disc_problems
from cam_motion.io.contour_csv import COLUMNS, write_csv
from cam_motion.io.contour_data import figures_as_data
from cam_motion.io.contour_dxf import write_dxf
from cam_motion.io.plain import to_json
from cam_motion.io.plots import contour_figure
from cam_motion.io.summary import check_sections
from cam_motion.mechanism.cam_flat import TranslatingFlat
from cam_motion.mechanism.cam_pose import follower_pose
from cam_motion.mechanism.cam_roller import SwingingRoller, TranslatingRoller
from cam_motion.units import DEGREE, MM, RPM, TURN
import ezdxf
from ezdxf import units
from ezdxf.math import bulge_center, bulge_radius
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config'
DISCS, PROBLEMS = build_cam_discs(read_sections(CONFIG / 'cam_disc.yaml'))
WRITTEN = 1e-9  # mm, of a number in a file

CAM = """
push:
  ros__parameters:
    unit: UNIT
    segments: [out, back, wait]
    out: {law: cycloidal, end_deg: 120.0, lift: 0.02}
    back: {law: cycloidal, end_deg: 240.0, lift: -0.02}
    wait: {end_deg: 360.0}
disc:
  ros__parameters:
    type: cam_disc
    profile: push
"""


def problems_of(disc, unit='m'):
    """Give the problems of a disc described by further lines, by path."""
    text = CAM.replace('UNIT', unit) + ''.join(f'    {line}\n' for line in disc.split('\n'))
    found, problems = build_cam_discs(parse_sections(text))
    problems += [each.below(name) for name, disc in found.items() for each in disc_problems(disc)]
    return {problem.path: problem for problem in problems}


def test_the_example_is_sound_and_has_every_follower():
    assert PROBLEMS == []
    assert [settings.kind for settings in DISCS.values()] == [
        'translating_roller', 'translating_flat', 'swinging_roller', 'swinging_flat',
        'translating_roller']
    assert all(disc_problems(settings) == [] for settings in DISCS.values())
    assert DISCS['valve_cam'].disc.follower == TranslatingFlat(0.03, 0.002)
    assert DISCS['gripper_cam'].disc.follower == SwingingRoller(0.05, 0.015, 0.12, 0.13)
    assert DISCS['tucker_cam'].disc.sense == -1 and DISCS['feeder_cam'].groove
    assert DISCS['valve_cam'].speed == pytest.approx(1500.0 * RPM)
    assert DISCS['press_cam'].speed == pytest.approx(400.0 * RPM)  # of the master shaft


def test_a_drive_that_turns_a_shaft_has_a_disc():
    discs, problems = build_cam_discs(read_sections(CONFIG / 'cam_press_drive.yaml'))
    settings = discs['press_drive']
    assert problems == [] and list(discs) == ['press_drive']
    assert settings.disc.follower == TranslatingRoller(0.04, 0.012)
    assert settings.orbit is not None and settings.speed == pytest.approx(400.0 * RPM)
    figures = contour_figures(settings)
    alone = contour_figures(DISCS['press_cam'])
    assert figures.force.least.value == pytest.approx(alone.force.least.value, rel=1e-12)
    assert figures.force.orbit_least.value == pytest.approx(
        settings.orbit.least_contact(settings.drive.base).value, rel=1e-7)


def test_a_disc_may_name_the_drive_that_turns_it():
    text = (CONFIG / 'cam_press_drive.yaml').read_text() + """
press_cam:
  ros__parameters:
    type: cam_disc
    profile: follower
    drive: press_drive
    offset: 0.004
    limits: {pressure_angle_deg: 25.0}
"""
    discs, problems = build_cam_discs(parse_sections(text))
    assert problems == [] and list(discs) == ['press_cam']
    assert discs['press_cam'].disc.follower == TranslatingRoller(0.04, 0.012, 0.004)
    wrong = text.replace('offset: 0.004', 'base_radius: 0.05\n    load: [x]\n    x: {type: mass, '
                         'mass: 1.0}')
    _, problems = build_cam_discs(parse_sections(wrong))
    assert {problem.path for problem in problems} == {'press_cam.base_radius', 'press_cam.load'}
    assert 'must be that of the drive press_drive: 0.04 m' in str(problems)


@pytest.mark.parametrize(('disc', 'unit', 'path', 'said'), [
    ('base_radius: 0.05', 'm', 'roller_radius', 'a translating_roller follower needs it'),
    ('roller_radius: 0.01', 'm', 'base_radius', 'needs it'),
    ('follower: translating_flat\nbase_radius: 0.05\nroller_radius: 0.01', 'm', 'roller_radius',
     'belongs to translating_roller and swinging_roller only'),
    ('follower: translating_flat\nbase_radius: 0.05\ngroove: true', 'm', 'groove', 'a roller'),
    ('follower: swinging_flat\nbase_radius: 0.05\npivot_distance: 0.2', 'm', 'profile',
     'needs an axis with unit rad: this one has m'),
    ('base_radius: 0.05\nroller_radius: 0.01', 'rad', 'profile', 'needs an axis with unit m'),
    ('follower: swinging_roller\nbase_radius: 0.05\nroller_radius: 0.01\narm_length: 0.2', 'rad',
     'pivot_distance', 'a swinging_roller follower needs it'),
    ('base_radius: -0.05\nroller_radius: 0.01', 'm', 'base_radius', 'above 0'),
    ('base_radius: 0.05\nroller_radius: 0.01\ndirection: left', 'm', 'direction',
     'counterclockwise, clockwise'),
    ('base_radius: 0.05\nroller_radius: 0.01\nroler: 1', 'm', 'roler', 'no such parameter'),
    ('base_radius: 0.05\nroller_radius: 0.01\noffset: 0.08', 'm', 'offset', 'closer'),
    ('base_radius: 0.05\nroller_radius: 0.01\nlimits: {pressure_angle_deg: 10.0}', 'm',
     'limits.pressure_angle_deg', 'the pressure angle on the way outwards reaches 15.38'),
    ('base_radius: 0.05\nroller_radius: 0.01\nlimits: {return_pressure_angle_deg: 10.0}', 'm',
     'limits.pressure_angle_deg', 'goes with'),
    ('base_radius: 0.01\nroller_radius: 0.0\nlimits: {cutter_radius: 0.05}', 'm',
     'limits.cutter_radius', 'the contour has a hollow with a radius'),
    ('follower: translating_flat\nbase_radius: 0.005', 'm', 'base_radius',
     "base radius + s + s'' must be above 0"),
    ('base_radius: 0.05\nroller_radius: 0.01\nload: [m]\nm: {type: mass, mass: 1.0}\n'
     'speed_rpm: 900.0', 'm', 'limits.contact_force', 'the follower lifts off'),
    ('base_radius: 0.05\nroller_radius: 0.01\nload: [m]\nm: {type: mas, mass: 1.0}', 'm', 'm.type',
     'must be one of mass, spring'),
    ('base_radius: 0.05\nroller_radius: 0.01\nload: [m]\nm: {type: [mass]}', 'm', 'm.type',
     'must be one of mass, spring'),
    ('base_radius: 0.05\nroller_radius: 0.01\nload: [m]\nm: {type: friction, viscous: 1.0e200}',
     'm', 'load', 'must not take more than 1e+15 N'),
    ('base_radius: 0.05\nroller_radius: 0.01\nload: [offset]', 'm', 'load', 'name of its own'),
    ('base_radius: 0.05\nroller_radius: 0.01\ndrive: push', 'm', 'drive', 'mode line_shaft'),
    ('base_radius: 0.05\nroller_radius: 0.01\nkeyway: {width: 0.004, depth: 0.002}', 'm',
     'bore_radius', 'a keyway needs it'),
    ('base_radius: 0.05\nroller_radius: 0.01\nbore_radius: 0.01\nkeyway: {width: 0.03, '
     'depth: 0.002}', 'm', 'keyway.width', 'less than the bore'),
])
def test_what_makes_no_disc_is_refused_with_its_path(disc, unit, path, said):
    problems = problems_of(disc, unit)
    assert f'disc.{path}' in problems
    assert said in str(problems[f'disc.{path}'])


def test_an_axis_that_is_none_or_advances_is_refused():
    sound = CAM.replace('UNIT', 'm') + '    base_radius: 0.05\n    roller_radius: 0.01\n'
    _, problems = build_cam_discs(parse_sections(sound.replace('profile: push', 'profile: pull')))
    assert 'must be the name of an axis' in str(problems[0]) and 'push' in problems[0].hint
    belt = sound.replace('lift: -0.02', 'lift: 0.02').replace(
        'unit: m', 'unit: m\n    cycle: accumulate')
    _, problems = build_cam_discs(parse_sections(belt))
    assert 'must return' in str(problems[0])
    _, problems = build_cam_discs(parse_sections(sound.replace('cycloidal', 'cyclodial')))
    assert 'must be sound itself' in str(problems[0])


def test_the_check_of_a_machine_finds_what_is_wrong_with_its_discs():
    text = (CONFIG / 'cam_disc.yaml').read_text()
    assert check_sections(parse_sections(text)).problems == ()
    small = text.replace('base_radius: 0.040', 'base_radius: 0.020').replace(
        'stiffness: 9000.0', 'stiffness: 900.0')
    check = check_sections(parse_sections(small))
    assert [problem.path for problem in check.problems] == [
        'press_cam.limits.pressure_angle_deg', 'valve_cam.limits.contact_force']
    assert list(check.cam_discs) == list(DISCS)
    # what helps is said, and helps
    said = float(check.problems[0].hint.split('at least ')[1].split()[0])
    stiff = float(check.problems[1].hint.split('with ')[1].split()[0])
    _, problems = check_discs(parse_sections(text.replace(
        'base_radius: 0.040', f'base_radius: {said}').replace(
        'stiffness: 9000.0', f'stiffness: {stiff}')))
    assert problems == []


@pytest.mark.parametrize('name', DISCS)
def test_figures_are_plain_data(name):
    data = figures_as_data(DISCS[name], contour_figures(DISCS[name]))
    assert '"axis"' in to_json(data)
    assert ('face' in data) == DISCS[name].disc.follower.is_flat
    if name == 'press_cam':
        assert data['pressure_angle_deg']['greatest'] == pytest.approx(25.2545724, abs=1e-6)
        assert data['contact_force']['lift_off_rpm'] == pytest.approx(752.831403, abs=1e-5)


@pytest.mark.parametrize('name', DISCS)
def test_the_points_in_a_csv_are_on_the_contour(name, tmp_path):
    settings = DISCS[name]
    line = write_csv(settings, tmp_path / 'deep' / 'cam.csv', 1e-5)
    text = (tmp_path / 'deep' / 'cam.csv').read_text()
    assert f'{line.deviation / MM:.9g} mm off' in text and line.deviation <= 1e-5
    rows = list(csv.DictReader(row for row in text.splitlines() if not row.startswith('#')))
    assert tuple(rows[0]) == COLUMNS and len(rows) == line.angles.size - 1
    columns = {name: np.array([float(row[name]) for row in rows]) for name in COLUMNS}
    q = columns['shaft_angle_deg'] * DEGREE
    exact = settings.disc.contour(q) / MM
    assert columns['x_mm'] == pytest.approx(exact.real, abs=WRITTEN)
    assert columns['y_mm'] == pytest.approx(exact.imag, abs=WRITTEN)
    assert columns['radius_of_curvature_mm'] == pytest.approx(
        settings.disc.contour_radius(q) / MM, rel=1e-6)
    # a cutter as large as the roller goes along its centre
    away = np.hypot(columns['centre_x_mm'] - columns['x_mm'],
                    columns['centre_y_mm'] - columns['y_mm'])
    if not settings.disc.follower.is_flat:
        assert away == pytest.approx(settings.disc.follower.roller_radius / MM, rel=1e-9)


def spline_points(entity, parameters):
    """Evaluate a spline as ezdxf does."""
    return np.array([complex(p.x, p.y) for p in entity.construction_tool().points(parameters)])


@pytest.mark.parametrize('name', DISCS)
def test_a_drawing_read_back_is_the_contour(name, tmp_path):
    settings = DISCS[name]
    disc = settings.disc
    drawing = write_dxf(settings, tmp_path / 'cam.dxf', 1e-5, at=1.0)
    document = ezdxf.readfile(tmp_path / 'cam.dxf')
    assert not document.audit().errors
    assert document.units == units.MM and document.header['$INSUNITS'] == 4
    space = document.modelspace()
    line, = space.query('LWPOLYLINE[layer=="CONTOUR_POLYLINE"]')
    points = np.array([complex(x, y) for x, y in line.get_points('xy')])
    assert line.closed and points.size == drawing.polyline.angles.size - 1
    assert points == pytest.approx(disc.contour(drawing.polyline.angles[:-1]) / MM, abs=WRITTEN)
    curve, = space.query('SPLINE[layer=="CONTOUR_SPLINE"]')
    q = np.linspace(0.0, TURN, 2001)[:-1]
    off = np.abs(spline_points(curve, q) - disc.contour(q) / MM)
    tangent = disc.on_disc(disc.contact(q).tangent, q)
    across = np.abs((np.conj(tangent) * (spline_points(curve, q) - disc.contour(q) / MM)).imag
                    / np.abs(tangent))
    assert curve.dxf.degree == 3 and np.max(off) < 0.1
    assert np.max(across) <= drawing.spline.deviation / MM * 1.01 <= 1e-2 * 1.01
    circle, = space.query('CIRCLE[layer=="BASE_CIRCLE"]')
    assert circle.dxf.radius == pytest.approx(disc.base_radius / MM)
    # the follower at another shaft angle, turned back onto the disc, touches the contour there
    touch, = space.query('POINT[layer=="FOLLOWER"]')
    assert complex(*touch.dxf.location.vec2) == pytest.approx(
        complex(disc.contour(1.0)) / MM, abs=WRITTEN)
    rollers = space.query('CIRCLE[layer=="FOLLOWER"]')
    assert len(rollers) == (not disc.follower.is_flat)
    for roller in rollers:
        centre = complex(disc.pitch(1.0)) / MM
        assert complex(*roller.dxf.center.vec2) == pytest.approx(centre, abs=WRITTEN)
    flanks = space.query('LWPOLYLINE[layer=="OUTER_FLANK_POLYLINE"]')
    assert len(flanks) == settings.groove
    properties = dict(document.header.custom_vars)
    assert float(properties['largest deviation [mm]']) == pytest.approx(
        drawing.deviation / MM, rel=1e-6)


def test_bore_and_keyway_are_one_closed_line(tmp_path):
    settings = DISCS['press_cam']
    write_dxf(settings, tmp_path / 'cam.dxf', 1e-4)
    bore, = ezdxf.readfile(tmp_path / 'cam.dxf').modelspace().query('*[layer=="BORE"]')
    assert bore.dxftype() == 'LWPOLYLINE' and bore.closed
    points = bore.get_points('xyb')
    (*first, bulge), (*second, _), *corners = points
    assert bulge_radius(first, second, bulge) == pytest.approx(12.5)
    assert bulge_center(first, second, bulge).magnitude == pytest.approx(0.0, abs=WRITTEN)
    assert abs(bulge) > 1.0  # the long way round
    # the keyway is 8 wide, 3.3 deep from the bore, and at 90 deg
    assert sorted(x for x, _, _ in corners) == pytest.approx([-4.0, 4.0])
    assert [y for _, y, _ in corners] == pytest.approx([15.8, 15.8])


def test_a_bore_that_cuts_the_contour_is_refused(tmp_path):
    text = (CONFIG / 'cam_disc.yaml').read_text().replace(
        'bore_radius: 0.0125', 'bore_radius: 0.038')
    settings = build_cam_discs(parse_sections(text))[0]['press_cam']
    with pytest.raises(ConfigurationError, match='bore and keyway reach 0.041'):
        write_dxf(settings, tmp_path / 'cam.dxf')
    assert [problem.path for problem in disc_problems(settings)] == ['bore_radius']


@pytest.mark.parametrize('write', [write_csv, write_dxf])
def test_a_file_that_cannot_be_written_is_said(write, tmp_path):
    (tmp_path / 'file').write_text('')
    with pytest.raises(CamMotionError, match='cannot be written'):
        write(DISCS['press_cam'], tmp_path / 'file' / 'cam.x', 1e-4)


@pytest.mark.parametrize('name', DISCS)
def test_the_picture_shows_what_is_computed(name):
    settings = DISCS[name]
    disc = settings.disc
    figure = contour_figure(settings, 2.0)
    drawn, *panels = figure.axes
    assert len(panels) == 2 + (disc.pressure_angles[0].value != disc.pressure_angles[1].value) + (
        settings.force is not None)
    pose = follower_pose(disc, 2.0)
    dots = [line.get_xydata()[0] for line in drawn.lines if line.get_marker() == 'o']
    assert any(dot == pytest.approx([pose.contact.real / MM, pose.contact.imag / MM])
               for dot in dots)
    outline = drawn.patches[1 if settings.groove else 0].get_xy()
    nearest = np.min(np.abs(outline[:, 0] + 1j * outline[:, 1] - pose.contact / MM))
    assert nearest < 1.0
    assert figure.axes[-1].get_xlabel() == 'shaft angle φ [deg]'
