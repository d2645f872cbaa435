# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""One axis fed as fast as it answers, beside a node that takes and publishes the same message."""

import json
import sys
import time

from benchmarks.line_child import _CAM
from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.executor import make_executor
from cam_motion.nodes.qos import SETPOINTS
from cam_motion.nodes.runner import start
from cam_motion.nodes.wire import pack_point
import rclpy
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from rclpy.signals import SignalHandlerOptions
from trajectory_msgs.msg import JointTrajectoryPoint

_BURST = 10  # what the axis' own queue holds
_BURSTS = 300


def main() -> None:
    """Feed bursts, wait for each to be answered, and print the time per message as JSON."""
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    executor = make_executor()
    answered = 0
    if sys.argv[1] == 'axis':
        node = CamAxis('axis', parameter_overrides=[
            Parameter(name, value=value) for name, value in _CAM.items()])

        def note(_: object) -> None:
            nonlocal answered
            answered += 1

        node.listeners.append(note)
        executor.add_node(node)
        start([node])
    else:
        node = rclpy.create_node('bare')
        publisher = node.create_publisher(JointTrajectoryPoint, 'axis/setpoint', SETPOINTS)

        def pass_on(message: JointTrajectoryPoint) -> None:
            nonlocal answered
            publisher.publish(message)
            answered += 1

        node.create_subscription(JointTrajectoryPoint, 'shaft', pass_on, SETPOINTS)
        executor.add_node(node)
    feeder = rclpy.create_node('feeder')
    shaft = feeder.create_publisher(JointTrajectoryPoint, 'shaft', QoSProfile(depth=100))
    end = time.monotonic() + 20.0
    while shaft.get_subscription_count() == 0 and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    best = float('inf')
    for number in range(_BURSTS):
        for step in range(_BURST):
            shaft.publish(pack_point(0.01 * (number + step), 20.0, 0.0, number, step))
        time.sleep(0.001)  # the middleware's own thread is done
        wanted = answered + _BURST
        began = time.perf_counter()
        while answered < wanted and time.monotonic() < end + 60.0:
            executor.spin_once(timeout_sec=0.05)
        best = min(best, (time.perf_counter() - began) / _BURST)
    print(json.dumps({'us': 1e6 * best, 'answered': answered}))
    executor.shutdown()
    node.destroy_node()
    feeder.destroy_node()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
