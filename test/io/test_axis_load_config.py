# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The parts of a load on drives that follow an axis: in a configuration, in the offline verbs."""

from pathlib import Path

from cam_motion.drive.load import Lever, Process, Spring, TranslatingMass
from cam_motion.errors import ConfigurationError
from cam_motion.io.advice import advise
from cam_motion.io.advice_questions import questions
from cam_motion.io.catalogue import load_catalogue
from cam_motion.io.config import load_machine, read_sections
from cam_motion.io.machine import build_drive, build_machine
from cam_motion.io.optimise_machine import movement_of
from cam_motion.io.plots.torque import torque_curve
from cam_motion.io.servo_parameters import follower_table, SERVO_DRIVE
from cam_motion.io.simulation import simulate
from cam_motion.io.sizing import Options, size
from cam_motion.units import DEGREE, TURN
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

PRESS = Path(__file__).resolve().parents[2] / 'config' / 'press_axis.yaml'
PARTS = {
    'load': ['sp', 'cut'], 'sp.type': 'spring', 'sp.stiffness': 1000.0, 'cut.type': 'process',
    'cut.force': 500.0, 'cut.window_deg': [40.0, 60.0]}
FEEDER = {'cycle': 'return', 'segments': ['feed', 'back'], 'feed.law': 'modified_sine',
          'feed.end_deg': 80.0, 'feed.lift': 0.3, 'back.law': 'modified_sine',
          'back.end_deg': 360.0, 'back.lift': -0.3}
DRIVE = {'axis': 'feeder', 'radius': 0.134, 'load_inertia': 1.0}
ROUNDING = 1e-12


@pytest.fixture(scope='module')
def machine():
    return load_machine(PRESS)


def problems_of(build, *given):
    with pytest.raises(ConfigurationError) as error:
        build(*given)
    return {problem.path: str(problem) for problem in error.value.problems}


@pytest.mark.parametrize('mode', ['follow', 'servo'])
def test_the_parts_are_those_of_a_cam_drive(mode):
    motor = {'motor.inertia': 1e-3, 'motor.rated_rpm': 3000.0, 'motor.max_rpm': 5000.0,
             'motor.rated_torque': 16.0, 'motor.peak_torque': 50.0}
    built = build_drive('drive', {**DRIVE, **PARTS, **motor, 'mode': mode})
    assert built.parts == {'sp': Spring(1000.0),
                           'cut': Process(500.0, 0.0, (40.0 * DEGREE, 60.0 * DEGREE))}
    assert built.drive.parts == tuple(built.parts.values())
    names = [spec.name for spec in follower_table({**PARTS, 'mode': mode})]
    assert names[-3:] == ['cut.force', 'cut.moment', 'cut.window_deg']
    assert (names[:len(SERVO_DRIVE)] == [s.name for s in SERVO_DRIVE]) is (mode == 'servo')


def test_every_problem_of_the_parts_is_said_with_its_place():
    given = {**DRIVE, **PARTS, 'load': ['sp', 'cut', 'cut', 'radius', 'none'],
             'sp.stiffness': -1.0, 'sp.stifness': 2.0, 'cut.window_deg': [60.0, 40.0],
             'none.type': 'rope'}
    found = problems_of(build_drive, 'drive', given)
    assert {'load', 'sp.stiffness', 'sp.stifness', 'cut.window_deg', 'none.type'} <= set(found)
    assert 'at least 0' in found['sp.stiffness']
    assert 'inertia, mass, spring' in found['none.type']


def test_a_part_that_is_described_but_not_listed_is_said_to_be_so():
    found = problems_of(build_drive, 'drive', {**DRIVE, 'sp.type': 'spring'})
    assert 'load does not name it' in found['sp']


def test_a_lever_must_reach_its_slider_all_the_way():
    lever = {'load': ['arm'], 'arm.type': 'lever', 'arm.inertia': 0.1, 'arm.arm': 0.19,
             'arm.height': 0.1}
    found = problems_of(build_machine, {'feeder': FEEDER, 'drive': {**DRIVE, **lever}})
    assert 'within the arm' in found['drive.arm.height']
    longer = build_machine({'feeder': FEEDER, 'drive': {**DRIVE, **lever, 'arm.arm': 0.25}})
    assert longer.drives['drive'].parts == {'arm': Lever(0.1, 0.25, 0.1, 0.0, (0.0, TURN))}


def test_a_load_is_looked_at_over_the_motion_that_couplings_make():
    """A lever that reaches the cam's stroke does not reach twice as far."""
    lever = {'load': ['arm'], 'arm.type': 'lever', 'arm.inertia': 0.1, 'arm.arm': 0.25,
             'arm.height': 0.1}
    sections = {'feeder': FEEDER, 'drive': {**DRIVE, **lever}}
    build_machine(sections)
    doubled = {**sections, 'feeder': {**FEEDER, 'scale': 2.0}}
    assert 'within the arm' in problems_of(build_machine, doubled)['drive.arm.height']


@pytest.mark.parametrize(('coupling', 'why'), [
    ({'ratio': 0.5}, 'a cam turns by 0.5 turns meanwhile'), ({'ratio': 1.5}, '1.5 turns')])
def test_a_load_over_what_is_no_turn_of_the_shaft_is_refused(coupling, why):
    sections = {'feeder': {**FEEDER, **coupling}, 'drive': {**DRIVE, **PARTS}}
    assert why in problems_of(build_machine, sections)['drive.axis']
    build_machine({**sections, 'drive': DRIVE})  # without parts nothing depends on the place


def test_the_press_axis_costs_what_cut_and_friction_take(machine):
    found = simulate(machine)['press_drive']
    curve = machine.diagram.axes['press'].profile.curve
    cut = 3000.0 * -float(curve(250.0 * DEGREE) - curve(160.0 * DEGREE))
    assert cut == pytest.approx(59.5, rel=0.01)
    # 60 N over 160 mm, some more by viscous friction, and a tenth in the screw
    assert cut + 9.6 < found['motor_work_per_cycle'] < (cut + 9.6) / 0.6
    # the servo drive does it with the same torque, which it holds for a period of its loop
    live = found['servo']
    assert live['peak_torque'] == pytest.approx(found['peak_torque'], rel=1e-4)
    assert live['motor_work_per_cycle'] == pytest.approx(found['motor_work_per_cycle'], rel=1e-3)
    assert live['saturated_s_per_cycle'] == 0.0
    # a stall of the ram, as its comment says
    sections = dict(read_sections(PRESS))
    sections['press_drive'] = {**sections['press_drive'], 'cut.force': -13000.0}
    assert simulate(build_machine(sections))['press_drive']['servo']['peak_following_error'] > 0.01


def test_the_press_axis_is_sized_by_the_same_load(machine):
    sized = size(machine, load_catalogue(), Options(ratios=(1.0,)))['press_drive'].sizing
    own = next(one for one in (*sized.ranked, *sized.rejected)
               if one.motor == one.gearbox == 'as configured')
    found = simulate(machine)['press_drive']
    for key in ('peak_torque', 'rms_torque', 'motor_work_per_cycle', 'inertia_ratio'):
        assert own.figures[key] == pytest.approx(found[key], rel=1e-9)


def test_the_picture_shows_the_steps_of_the_cut_as_steps(machine):
    settings = machine.drives['press_drive']
    curve = torque_curve(settings, machine.diagram.axes['press'], machine.master.speed)
    steps = np.abs(np.diff(curve.torque))
    sharp = curve.phi[1:][steps > 5.0] / DEGREE
    assert sharp == pytest.approx([160.0, 250.0], abs=1e-6)
    assert steps.max() == pytest.approx(
        3000.0 * settings.drive.radius / settings.drive.efficiency, rel=0.2)


def test_advice_by_torque_counts_the_parts(machine):
    sections = read_sections(PRESS)
    question = next(q for q in questions(sections) if q.name == 'press.press')
    now = next(each.candidate for each in advise(question, 'rms_torque').ranking
               if each.candidate.configured)
    found = simulate(machine)['press_drive']
    assert now.figures['rms_torque'] == pytest.approx(found['rms_torque'], rel=ROUNDING)


def test_a_law_is_optimised_by_torque_only_under_a_load_that_is_the_same_everywhere():
    sections = dict(read_sections(PRESS))
    assert movement_of(sections, 'press.close').load is None
    even = {key: value for key, value in sections['press_drive'].items()
            if key.partition('.')[0] not in ('springs', 'cut', 'guides')}
    sections['press_drive'] = {**even, 'load': ['ram']}
    load = movement_of(sections, 'press.close').load
    drive = build_machine(sections).drives['press_drive'].drive
    assert drive.parts == (TranslatingMass(40.0),)
    state = drive.follow(0.0, -1.0, -5.0)  # downwards, faster and faster
    movement = movement_of(sections, 'press.close')
    assert float(load.torque(5.0 / movement.scale(2))) == pytest.approx(-state.motor_torque)
