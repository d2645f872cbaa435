# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A live axis: a master shaft and one cam axis run as ROS 2 nodes, over DDS."""

import time

from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.executor import make_executor
from cam_motion.nodes.master_shaft import MasterShaft
from cam_motion.nodes.runner import bring_to_rest, start
import rclpy
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from trajectory_msgs.msg import JointTrajectoryPoint

rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
shaft = MasterShaft(parameter_overrides=[
    Parameter('speed_cpm', value=200.0), Parameter('rate_hz', value=100.0)])
knife = CamAxis('knife', parameter_overrides=[
    Parameter('segments', value=['cut', 'back', 'rest']),
    Parameter('cut.law', value='modified_trapezoid'),
    Parameter('cut.end_deg', value=80.0), Parameter('cut.lift', value=0.080),
    Parameter('back.law', value='modified_trapezoid'),
    Parameter('back.end_deg', value=140.0), Parameter('back.lift', value=-0.080),
    Parameter('rest.end_deg', value=360.0)])

ticks, setpoints = {}, {}
listener = rclpy.create_node('listener')
for topic, seen in (('shaft', ticks), ('knife/setpoint', setpoints)):
    listener.create_subscription(
        JointTrajectoryPoint, topic, lambda point, seen=seen: seen.setdefault(
            (point.time_from_start.sec, point.time_from_start.nanosec), point), 100)

executor = make_executor()
for node in (shaft, knife, listener):
    executor.add_node(node)
start([shaft, knife])                      # configure and activate, as `ros2 run` does
end = time.monotonic() + 2.0
while time.monotonic() < end:
    executor.spin_once(timeout_sec=0.1)
bring_to_rest(executor, [shaft, knife])    # ramp down, then hold
for _ in range(50):
    executor.spin_once(timeout_sec=0.01)

worst = max(
    abs(setpoints[stamp].velocities[0]
        - knife.axis.profile.at_speed(
            tick.positions[0], tick.velocities[0], tick.accelerations[0])[1])
    for stamp, tick in ticks.items())
last = setpoints[max(setpoints)]
print('every tick answered:', set(ticks) == set(setpoints))
print(f'worst deviation of a velocity from the exact curve: {worst:.1e} m/s')
print(f'at rest at the end: {last.velocities[0]} m/s, {last.accelerations[0]} m/s²')

executor.shutdown()
for node in (shaft, knife, listener):
    node.destroy_node()
rclpy.try_shutdown()
