# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a report says of recorded joint states: closed loops, or by how much they are not."""

from cam_motion.io.bag import JointStateSeries
from cam_motion.io.linkage_report import linkage_report
from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.linkage_motion import move
from cam_motion.mechanism.umbrella import Umbrella
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ASSEMBLY = Assembly(Umbrella().linkage())
NAMES = ASSEMBLY.linkage.variables


def series(positions, velocities, names=NAMES):
    """Make joint states."""
    times = np.arange(len(positions), dtype=np.int64)
    return JointStateSeries(tuple(names), np.array(positions), np.array(velocities),
                            np.full(np.shape(positions), np.nan), times, times)


def rows(count=5):
    """Solve a few positions and their velocities."""
    motions = [move(ASSEMBLY, ASSEMBLY.at({'h1': 1.0 + 0.1 * k}), {'h1': 0.3, 'h2': -0.1})
               for k in range(count)]
    return ([[m.position[name] for name in NAMES] for m in motions],
            [[m.velocity[name] for name in NAMES] for m in motions])


def test_joint_states_of_the_solver_are_sound():
    found = linkage_report(ASSEMBLY, series(*rows()))
    assert found.sound and found.states == 5
    assert found.gap < 1e-14 and found.slip < 1e-14
    assert found.travel == {'h1': (1.0, 1.4), 'h2': (0.8, 0.8)}


@pytest.mark.parametrize('which', [0, 1])
def test_a_wrong_angle_and_a_wrong_velocity_are_found(which):
    both = rows()
    both[which][3][2] += 1e-6
    found = linkage_report(ASSEMBLY, series(*both))
    assert not found.sound
    assert max(found.gap, found.slip) == pytest.approx(1e-6, rel=0.2)


def test_without_states_or_names_there_are_no_figures():
    assert linkage_report(ASSEMBLY, series(np.zeros((0, 6)), np.zeros((0, 6)))).states == 0
    found = linkage_report(ASSEMBLY, series(*rows(), names=[*NAMES[:-1], 'other']))
    assert (found.states, found.travel, found.sound) == (5, {}, True)
