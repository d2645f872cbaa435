# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What an axis does in one turn of the shaft, and what that costs its drive."""

from cam_motion.drive.cycle import cycle_figures
from cam_motion.drive.inverse import FollowerDrive
from cam_motion.errors import ConfigurationError
from cam_motion.io.axis import build_axis
from cam_motion.io.summary import check_sections
from cam_motion.io.turn import repeats, turn_profile
from cam_motion.units import TURN
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

PRESS = {
    'segments': ['wait', 'down', 'up'], 'wait.end_deg': 60.0,
    'down.law': 'cycloidal', 'down.end_deg': 180.0, 'down.lift': 0.05,
    'up.law': 'modified_trapezoid', 'up.end_deg': 360.0, 'up.lift': -0.05,
}
TWO = {
    'cams': ['base', 'extra'], 'active': ['base', 'extra'],
    **{f'base.{key}': value for key, value in PRESS.items()},
    'extra.segments': ['go'], 'extra.go.law': 'constant_velocity', 'extra.go.end_deg': 360.0,
    'extra.go.lift': 0.1, 'extra.cycle': 'accumulate',
}
RATIOS = st.sampled_from([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
PHASES = st.floats(-400.0, 400.0)


@given(RATIOS, PHASES, st.floats(-3.0, 3.0), st.floats(-1.0, 1.0))
def test_the_turn_is_what_the_coupling_makes_of_the_cam(ratio, phase, scale, offset):
    axis = build_axis('press', {
        **PRESS, 'ratio': ratio, 'phase_deg': phase, 'scale': scale or 1.0, 'offset': offset})
    check_turn(axis)


@given(RATIOS, PHASES)
def test_cams_that_are_added_up_are_one_cam_of_the_turn(ratio, phase):
    check_turn(build_axis('press', {**TWO, 'base.ratio': ratio, 'base.phase_deg': phase}))


def check_turn(axis):
    made, motion = turn_profile(axis), axis.layout.motion
    phi = np.random.default_rng(7).uniform(0.0, TURN, 200)
    for order, exact in enumerate(motion(phi)[:3]):
        assert made(phi, order) == pytest.approx(exact, abs=1e-9 * (1.0 + np.abs(exact).max()))
    assert made.advance == pytest.approx(axis.layout.advance, abs=1e-12)
    assert made.sample(1.0)[:3] == pytest.approx(motion.sample(1.0)[:3], abs=1e-9)


def test_a_drive_pays_for_the_scale_and_the_ratio_of_its_axis():
    """Torque of an inertia goes with scale times ratio squared, speed with scale times ratio."""
    drive = FollowerDrive(radius=0.05, load_inertia=0.2)
    once = cycle_figures(drive, turn_profile(build_axis('press', PRESS)), 10.0)
    coupled = build_axis('press', {**PRESS, 'scale': 2.0, 'ratio': 3.0, 'phase_deg': 77.0})
    found = cycle_figures(drive, turn_profile(coupled), 10.0)
    assert found.peak_torque == pytest.approx(18.0 * once.peak_torque, rel=1e-9)
    assert found.rms_torque == pytest.approx(18.0 * once.rms_torque, rel=1e-9)
    assert found.peak_speed == pytest.approx(6.0 * once.peak_speed, rel=1e-9)


@pytest.mark.parametrize(('coupling', 'why'), [
    ({'ratio': 0.5}, 'a cam turns by 0.5 turns'), ({'follows': 'leader'}, 'follows leader')])
def test_what_does_not_repeat_after_a_turn_is_no_figure_of_a_drive(coupling, why):
    axis = build_axis('press', {**PRESS, **coupling})
    assert not repeats(axis)
    with pytest.raises(ConfigurationError) as refused:
        turn_profile(axis, 'motor')
    problem, = refused.value.problems
    assert problem.path == 'motor.axis' and why in problem.rule and 'live' in problem.hint
    leader = {**PRESS}
    sections = {
        'line': {'master': 'shaft', 'axes': ['press', 'leader'], 'drives': ['motor']},
        'shaft': {'speed_cpm': 20.0}, 'press': {**PRESS, **coupling}, 'leader': leader,
        'motor': {'axis': 'press', 'radius': 0.05, 'load_inertia': 0.2}}
    check = check_sections(sections)
    assert check.problems == ()
    assert [(each.path, why in each.rule) for each in check.warnings] == [('motor.axis', True)]
