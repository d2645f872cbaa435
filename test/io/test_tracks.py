# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Cam tracks in a configuration: what is built, and what is refused with which words."""

import math
from pathlib import Path

from cam_motion.errors import ConfigurationError
from cam_motion.io.axis import axis_table, build_axis
from cam_motion.io.config import load_machine, parse_sections, read_sections
from cam_motion.io.machine import build_machine, build_master
from cam_motion.io.tracks import track_table
from cam_motion.runtime.cam_switch import Direction
from cam_motion.units import DEGREE, TURN
import pytest

AXIS = {'segments': ['rest'], 'rest.end_deg': 360.0}
GLUE = {'tracks': ['glue'], 'glue.on_deg': [90.0], 'glue.off_deg': [180.0]}


def problems(build, **given):
    with pytest.raises(ConfigurationError) as caught:
        build('node', {key.replace('__', '.'): value for key, value in given.items()})
    return {problem.path: problem for problem in caught.value.problems}


def of_axis(**given):
    return problems(build_axis, **AXIS, **given)


def test_a_track_over_the_shaft():
    settings = build_master('master', {
        **GLUE, 'glue.direction': 'negative', 'glue.on_compensation': -0.02,
        'glue.off_compensation': 0.01, 'glue.hysteresis_deg': 2.0}).tracks['glue']
    track = settings.track
    assert track.on == pytest.approx([90 * DEGREE]) and track.off == pytest.approx([math.pi])
    assert (track.period, track.duration, track.direction) == (TURN, None, Direction.NEGATIVE)
    assert (track.on_compensation, track.off_compensation) == (-0.02, 0.01)
    assert track.hysteresis == pytest.approx(2 * DEGREE) and not settings.over_position


def test_a_track_over_the_position_of_an_axis():
    settings = build_axis('axis', {
        **AXIS, 'tracks': ['glue'], 'glue.source': 'position', 'glue.on_at': [0.1],
        'glue.off_at': [0.2], 'glue.hysteresis': 0.01, 'glue.modulo': 0.3}).tracks['glue']
    track = settings.track
    assert settings.over_position
    assert (track.on, track.off, track.hysteresis, track.period) == ([0.1], [0.2], 0.01, 0.3)


def test_an_axis_without_modulo_has_places_that_do_not_repeat():
    axis = build_axis('axis', {
        **AXIS, 'tracks': ['glue'], 'glue.source': 'position', 'glue.on_at': [-2.0],
        'glue.off_at': [7.0]})
    assert math.isinf(axis.tracks['glue'].track.period)


def test_several_cams_and_a_track():
    axis = build_axis('axis', {
        'cams': ['one'], 'one.segments': ['rest'], 'one.rest.end_deg': 360.0, **GLUE})
    assert list(axis.tracks) == ['glue']


def test_the_tables_have_the_parameters_of_every_track():
    names = [spec.name for spec in axis_table({**AXIS, 'tracks': ['glue', 'eject']})]
    assert {'glue.on_deg', 'eject.modulo', 'tracks', 'trajectory.rate_hz'} <= set(names)
    assert 'glue.modulo' not in [spec.name for spec in track_table(GLUE, of_axis=False)]


def test_a_machine_file_with_tracks_reads_as_the_nodes_read_it():
    sections = parse_sections(
        'axis:\n  ros__parameters:\n    segments: [rest]\n    rest: {end_deg: 360.0}\n'
        '    tracks: [glue]\n    glue: {source: position, on_at: [0.1], off_at: [0.2]}\n')
    assert build_axis('axis', sections['axis']).tracks['glue'].track.on == [0.1]


def test_tracks_of_master_axis_and_drive_in_a_machine():
    path = Path(__file__).resolve().parents[2] / 'config' / 'cam_press_drive.yaml'
    sections = {name: dict(values) for name, values in read_sections(path).items()}
    drive = next(n for n, v in sections.items() if v.get('mode') == 'line_shaft')
    sections[drive] |= GLUE
    machine = build_machine(sections)
    assert list(machine.master.drive.tracks) == ['glue']
    assert not load_machine(path).master.drive.tracks


@pytest.mark.parametrize('name', ['speed_cpm', 'state', 'quick_stop', 'rest', 'x-1', '1st', '',
                                  'trajectory', 'staged'])
def test_names_that_are_taken_or_no_names(name):
    assert of_axis(tracks=[name])['tracks'].value == name


def test_a_name_that_stands_twice():
    found = of_axis(**{**GLUE, 'tracks': ['glue', 'glue']})
    assert list(found) == ['tracks']


@pytest.mark.parametrize('given, path, words', [
    ({'tracks': 'glue'}, 'tracks', 'list'),
    ({'tracks': ['glue']}, 'glue.on_deg', 'at least one'),
    ({**GLUE, 'glue.off_deg': []}, 'glue.off_deg', 'as many'),
    ({**GLUE, 'glue.on_deg': [400.0]}, 'glue.on_deg', 'from 0 to 360'),
    ({**GLUE, 'glue.off_deg': [90.0]}, 'glue.off_deg', 'behind'),
    ({**GLUE, 'glue.on_deg': [360.0], 'glue.off_deg': [0.0]}, 'glue.off_deg', 'behind'),
    ({**GLUE, 'glue.on_deg': [math.nan]}, 'glue.on_deg', 'finite'),
    ({**GLUE, 'glue.duration': 0.1}, 'glue.off_deg', 'duration'),
    ({**GLUE, 'glue.off_deg': [], 'glue.duration': -1.0}, 'glue.duration', 'above 0'),
    ({**GLUE, 'glue.off_deg': [], 'glue.duration': 1.0, 'glue.off_compensation': 0.1},
     'glue.off_compensation', 'alone'),
    ({**GLUE, 'glue.direction': 'up'}, 'glue.direction', 'one of'),
    ({**GLUE, 'glue.hysteresis_deg': 91.0}, 'glue.hysteresis_deg', 'less than'),
    ({**GLUE, 'glue.on_deg': [90.0, 100.0], 'glue.off_deg': [180.0, 190.0]}, 'glue.on_deg',
     'lies in the window'),
    ({**GLUE, 'glue.on_deg': [10.0, 300.0], 'glue.off_deg': [20.0, 15.0]}, 'glue.on_deg',
     'lies in the window'),
    ({**GLUE, 'glue.offdeg': [1.0]}, 'glue.offdeg', 'no such parameter'),
    ({**GLUE, 'glue.on_at': [1.0]}, 'glue.on_at', 'source: position'),
    ({**GLUE, 'glue.source': 'position'}, 'glue.on_deg', 'source: shaft'),
])
def test_what_is_refused(given, path, words):
    problem = of_axis(**given)[path]
    assert words in f'{problem.rule} {problem.hint}'


def test_a_shaft_has_no_position_to_be_over():
    assert 'glue.source' in problems(build_master, **GLUE, glue__source='position')


def test_all_problems_of_all_tracks_at_once():
    found = of_axis(tracks=['one', 'two'], one__on_deg=[1.0], two__on_deg=[400.0],
                    two__duration=1.0, scale='x')
    assert {'one.off_deg', 'two.on_deg', 'scale'} <= set(found)


@pytest.mark.parametrize('given, path', [
    ({'trajectory.rate_hz': -1.0}, 'trajectory.rate_hz'),
    ({'trajectory.points': 1}, 'trajectory.points'),
    ({'trajectory.joint': 3}, 'trajectory.joint'),
    ({'trajectory.effort': 1}, 'trajectory.effort')])
def test_a_look_ahead_that_cannot_be(given, path):
    assert path in of_axis(**given)
