# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
Launch a machine, every node as a process of its own.

The nodes are those the configuration lists under `line`, so any machine file will do:
`ros2 launch cam_motion cutting_machine.launch.py config:=my_machine.yaml record:=my_bag`.
"""

from pathlib import Path
import tempfile

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
import yaml

CONFIG = Path(__file__).parent.parent / 'config' / 'cutting_machine.yaml'


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments and leave the nodes to the configuration."""
    return LaunchDescription([
        DeclareLaunchArgument(
            'config', default_value=str(CONFIG), description='The machine: a parameter file.'),
        DeclareLaunchArgument(
            'namespace', default_value='', description='Namespace of the whole line.'),
        DeclareLaunchArgument(
            'record', default_value='', description='Bag directory to record to; empty: none.'),
        OpaqueFunction(function=machine_nodes),
    ])


def machine_nodes(context: LaunchContext) -> list[Node]:
    """Make the nodes of the machine, what turns the shaft last, so that it finds the others."""
    config = Path(LaunchConfiguration('config').perform(context)).expanduser()
    namespace = LaunchConfiguration('namespace').perform(context).strip('/')
    record = LaunchConfiguration('record').perform(context)

    machine = yaml.safe_load(config.read_text(encoding='utf-8'))
    try:
        line = machine['line']['ros__parameters']
        axes, drives = line['axes'], line.get('drives', [])
        linkages = line.get('linkages', [])
        # a drive that turns the shaft is the master
        turning = [name for name in drives if machine.get(name, {}).get(
            'ros__parameters', {}).get('mode') == 'line_shaft']
        executable, master = (
            ('drive_sim', turning[0]) if turning else ('master_shaft', line['master']))
    except (KeyError, TypeError, AttributeError) as error:
        raise RuntimeError(
            f'{config}: line.ros__parameters must list the axes, and the master unless a drive '
            'turns the shaft') from error
    parameters = in_namespace(machine, namespace) if namespace else config

    def node(executable: str, name: str, given: dict | None = None, **options: object) -> Node:
        return Node(
            package='cam_motion', executable=executable, name=name, namespace=namespace,
            parameters=[str(parameters), *([given] if given else [])], output='screen',
            **options)

    nodes = []
    if record:
        # As text, whatever the names look like in YAML.
        bag = {'output': ParameterValue(record, value_type=str),
               'machine': ParameterValue(str(config), value_type=str)}
        nodes += [node('bag_recorder', 'bag_recorder', bag)]
    nodes += [node('drive_sim', name) for name in drives if name != master]
    nodes += [node('linkage_state', name) for name in linkages]
    # The line is whole or it is not: it ends with the first axis, or with the master.
    nodes += [node('cam_axis', name, on_exit=Shutdown()) for name in axes]
    nodes += [node(executable, master, on_exit=Shutdown())]
    return nodes


def in_namespace(machine: dict[str, object], namespace: str) -> Path:
    """Write the machine again under full node names, as a parameter file matches by them."""
    moved = {f'/{namespace}/{name.strip("/")}': section for name, section in machine.items()}
    with tempfile.NamedTemporaryFile(
            'w', prefix='cam_motion_', suffix='.yaml', delete=False, encoding='utf-8') as file:
        yaml.safe_dump(moved, file, sort_keys=False)
    return Path(file.name)
