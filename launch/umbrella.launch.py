# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
Launch the umbrella as a line, every node as a process of its own, and look at it.

`ros2 launch cam_motion umbrella.launch.py rviz:=true` shows its markers; with urdf:=true
robot_state_publisher turns the joint states into frames, and RViz shows its URDF (both from their
own ROS packages). Any machine file with a linkage will do: config:=my_machine.yaml
linkage:=my_linkage.
"""

from pathlib import Path

from cam_motion.errors import ConfigurationError
from cam_motion.io.config import read_sections
from cam_motion.io.linkage_config import build_linkage
from cam_motion.io.linkage_urdf import linkage_urdf
from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, OpaqueFunction
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

HERE = Path(__file__).parent
CONFIG = HERE.parent / 'config' / 'umbrella.yaml'
PASSED_ON = ('config', 'namespace', 'record')


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments, start the line, and leave the viewers to the arguments."""
    return LaunchDescription([
        DeclareLaunchArgument(
            'config', default_value=str(CONFIG), description='The machine: a parameter file.'),
        DeclareLaunchArgument(
            'linkage', default_value='umbrella', description='Section of the linkage to show.'),
        DeclareLaunchArgument(
            'namespace', default_value='', description='Namespace of the whole line.'),
        DeclareLaunchArgument(
            'record', default_value='', description='Bag directory to record to; empty: none.'),
        DeclareLaunchArgument(
            'urdf', default_value='false', choices=['true', 'false'],
            description='Whether to run robot_state_publisher.'),
        DeclareLaunchArgument(
            'rviz', default_value='false', choices=['true', 'false'],
            description='Whether to run RViz.'),
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(str(HERE / 'cutting_machine.launch.py')),
            launch_arguments=[(name, LaunchConfiguration(name)) for name in PASSED_ON]),
        OpaqueFunction(function=viewers),
    ])


def viewers(context: LaunchContext) -> list[Node]:
    """Make the nodes that show the linkage."""
    def given(name: str) -> str:
        return LaunchConfiguration(name).perform(context)

    linkage, namespace = given('linkage'), given('namespace').strip('/')
    nodes = []
    if given('urdf') == 'true':
        nodes.append(Node(
            package='robot_state_publisher', executable='robot_state_publisher',
            namespace=namespace, parameters=[{'robot_description': urdf_of(
                given('config'), linkage)}],
            remappings=[('joint_states', f'{linkage}/joint_states')], output='screen'))
    if given('rviz') == 'true':
        view = 'umbrella_urdf.rviz' if given('urdf') == 'true' else 'umbrella.rviz'
        nodes.append(Node(
            package='rviz2', executable='rviz2', namespace=namespace,
            arguments=['-d', str(HERE / view)],
            remappings=[('umbrella/markers', f'{linkage}/markers')], output='screen'))
    return nodes


def urdf_of(config: str, linkage: str) -> str:
    """Write the URDF of a linkage of a machine file."""
    try:
        sections = read_sections(Path(config).expanduser())
        return linkage_urdf(build_linkage(linkage, sections.get(linkage, {})))
    except ConfigurationError as error:
        raise RuntimeError(f'{config}: ' + '; '.join(map(str, error.problems))) from error
