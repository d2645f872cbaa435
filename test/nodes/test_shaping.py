# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A cam axis with input shaping publishes the shaped curve, and refuses a filter that fails."""

from cam_motion.io.axis import build_axis
from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.wire import pack_point
from cam_motion.runtime.point import Point
from cam_motion.units import RPM
import pytest
from trajectory_msgs.msg import JointTrajectoryPoint

pytestmark = [pytest.mark.ros, pytest.mark.timeout(90)]

FEEDER = {
    'cycle': 'accumulate', 'segments': ['feed', 'wait'], 'feed.law': 'modified_trapezoid',
    'feed.end_deg': 80.0, 'feed.lift': 0.3, 'wait.end_deg': 360.0,
}
SHAPED = {**FEEDER, 'shaping.kind': 'zvd', 'shaping.frequency_hz': 4.0, 'shaping.damping': 0.02,
          'shaping.speed_cpm': 60.0}
OMEGA = 60.0 * RPM


def test_the_axis_publishes_the_shaped_curve(world):
    node = world.make(CamAxis, SHAPED)
    node.trigger_configure()
    node.trigger_activate()
    assert node.active
    setpoints = world.points('cam_axis/setpoint')
    publisher = world.speaker(JointTrajectoryPoint, 'shaft')
    assert world.spin_until(lambda: node._setpoints.get_subscription_count() == 1)
    angles = [0.021 * k for k in range(290)]
    for k, phi in enumerate(angles):
        publisher.publish(pack_point(phi, OMEGA, 0.0, 0, k))
        assert world.spin_until(lambda k=k: len(setpoints) > k)
    made = node.axis.profile.filter
    plain = build_axis('feeder', FEEDER).profile
    for setpoint, phi in zip(setpoints, angles):
        delayed = [plain.sample(phi - time * OMEGA) for time in made.times]
        y, slope, bend = (sum(a * copy[n] for a, copy in zip(made.amplitudes, delayed))
                          for n in range(3))
        assert setpoint[:3] == pytest.approx(
            Point(y, slope * OMEGA, bend * OMEGA ** 2, 0, 0)[:3], abs=1e-9)
    assert setpoints[-1].position == pytest.approx(0.3)
    moved = [setpoint.velocity for setpoint, phi in zip(setpoints, angles) if phi > 1.4]
    assert max(moved) > 0.1  # in the dwell behind its segment


@pytest.mark.parametrize('wrong, path, way', [
    ({'shaping.kind': 'polydyne'}, 'shaping.kind', 'polynomial_4567'),
    ({'shaping.frequency_hz': -4.0}, 'shaping.frequency_hz', 'at least 0.001'),
    ({'shaping.speed_cmp': 60.0}, 'shaping.speed_cmp', 'did you mean shaping.speed_cpm?'),
])
def test_a_filter_that_fails_is_refused_with_path_and_way_out(world, wrong, path, way):
    node = world.make(CamAxis, {**SHAPED, **wrong})
    node.trigger_configure()
    assert world.state('cam_axis') == 'unconfigured'
    assert [problem.path for problem in node.problems] == [path]
    assert way in str(node.problems[0])
