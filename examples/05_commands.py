# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Commands to a live line, recorded: what the axes did, drawn with their states."""

from pathlib import Path
import shutil
import time

from cam_motion.io.plots.run_time import run_time_figure
from cam_motion.io.plots.style import save
from cam_motion.io.recording import read_recording
from cam_motion.nodes.bag_recorder import BagRecorder
from cam_motion.nodes.executor import make_executor
from cam_motion.nodes.line import make_line
from cam_motion.nodes.runner import bring_to_rest, start
from rcl_interfaces.srv import SetParametersAtomically
import rclpy
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from std_srvs.srv import SetBool

MACHINE = Path(__file__).parent.parent / 'config' / 'cutting_machine.yaml'
OUT = Path('out')

shutil.rmtree(OUT / 'commands', ignore_errors=True)
OUT.mkdir(exist_ok=True)
changes = ['master_shaft:speed_cpm:=60.0', 'knife:engage.at:=angle', 'knife:disengage.at:=angle',
           'knife:engage.angle_deg:=160.0', 'knife:disengage.angle_deg:=160.0',
           'press:change.at:=angle', 'press:change.angle_deg:=100.0']
rclpy.init(args=['--ros-args', '--params-file', str(MACHINE),
                 *(word for change in changes for word in ('-p', change))],
           signal_handler_options=SignalHandlerOptions.NO)
recorder = BagRecorder(parameter_overrides=[
    Parameter('output', value=str(OUT / 'commands')), Parameter('machine', value=str(MACHINE))])
nodes = make_line()
user = rclpy.create_node('user')
executor = make_executor()
for node in (recorder, *nodes, user):
    executor.add_node(node)


def wait(seconds):
    """Let the line run on."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)


def call(kind, service, **fields):
    """Call a service as any node does, and print the answer."""
    client = user.create_client(kind, service)
    while not client.service_is_ready():
        executor.spin_once(timeout_sec=0.05)
    future = client.call_async(kind.Request(**fields))
    while not future.done():
        executor.spin_once(timeout_sec=0.05)
    answer = future.result()
    if kind is SetBool:
        print(answer.message)
    else:
        print('refused: ' + answer.result.reason if not answer.result.successful else 'changes')


def change(axis, **values):
    """Set parameters of an axis together."""
    call(SetParametersAtomically, f'{axis}/set_parameters_atomically', parameters=[
        Parameter(name, value=value).to_parameter_msg() for name, value in values.items()])


start([recorder, *nodes])
wait(3.0)
call(SetBool, 'knife/engage', data=False)
change('press', phase_deg=15.0, scale=0.8)
wait(2.2)
call(SetBool, 'knife/engage', data=True)
change('press', scale=40.0)
wait(2.5)
nodes[0].trigger_deactivate()       # the master ceases to turn the shaft: all stop on their curves
wait(1.0)
bring_to_rest(executor, nodes)
wait(0.5)
bring_to_rest(executor, [recorder])
executor.shutdown()
for node in (recorder, *nodes, user):
    node.destroy_node()
rclpy.try_shutdown()

recording = read_recording(OUT / 'commands')
save(run_time_figure(recording, ['press', 'knife']), OUT / 'commands.png')
states = [text for _, text in recording.states['knife']]
print('states of the knife:', ', '.join(states[states.index('in_sync'):]))
