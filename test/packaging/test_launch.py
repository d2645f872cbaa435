# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The launch file must start exactly the nodes a machine file lists."""

import importlib.util
import json
from pathlib import Path
import sys
from types import SimpleNamespace

import pytest
import yaml

pytestmark = pytest.mark.timeout(60)

MACHINE = {
    'line': {'ros__parameters': {'master': 'shaft', 'axes': ['a', 'b'], 'drives': ['a_drive']}},
    'shaft': {'ros__parameters': {'speed_cpm': 60.0}},
    'a': {'ros__parameters': {'unit': 'm'}},
}


class Recorded:
    """An action or a substitution of launch that remembers what it was made of."""

    def __init__(self, *arguments, **options):
        self.arguments, self.options = arguments, options

    def perform(self, context):
        return context[self.arguments[0]]


@pytest.fixture
def launch_file(root, monkeypatch):
    """Import the launch file, launch itself replaced by stand-ins."""
    stand_in(monkeypatch)
    return loaded(root / 'launch' / 'cutting_machine.launch.py')


def stand_in(monkeypatch):
    """Put stand-ins in the place of launch."""
    for name in ('launch', 'launch.actions', 'launch.launch_description_sources',
                 'launch.substitutions', 'launch_ros', 'launch_ros.actions',
                 'launch_ros.parameter_descriptions'):
        monkeypatch.setitem(sys.modules, name, SimpleNamespace(
            DeclareLaunchArgument=Recorded, IncludeLaunchDescription=Recorded,
            LaunchConfiguration=Recorded, LaunchContext=Recorded, LaunchDescription=Recorded,
            Node=Recorded, OpaqueFunction=Recorded,
            ParameterValue=lambda value, value_type: value_type(value),
            PythonLaunchDescriptionSource=Path, Shutdown=Recorded))


def loaded(path):
    """Import a launch file."""
    spec = importlib.util.spec_from_file_location(path.name.replace('.', '_'), path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def start(launch_file, tmp_path):
    """Return a function that gives the options of every node started."""
    config = tmp_path / 'machine.yaml'
    config.write_text(yaml.safe_dump(MACHINE))

    def nodes(**given):
        context = {'config': str(config), 'namespace': '', 'record': '', **given}
        return [node.options for node in launch_file.machine_nodes(context)]

    return nodes


def test_the_default_machine_is_the_installed_one(launch_file, root):
    assert launch_file.CONFIG == root / 'config' / 'cutting_machine.yaml'
    assert launch_file.CONFIG.is_file()


def test_the_arguments_are_config_namespace_and_record(launch_file):
    actions = launch_file.generate_launch_description().arguments[0]
    names = [action.arguments[0] for action in actions if action.arguments]
    assert names == ['config', 'namespace', 'record']


def test_every_listed_node_is_started_and_the_master_last(start):
    nodes = [(node['executable'], node['name']) for node in start()]
    assert nodes == [('drive_sim', 'a_drive'), ('cam_axis', 'a'), ('cam_axis', 'b'),
                     ('master_shaft', 'shaft')]


def test_a_drive_that_turns_the_shaft_stands_in_the_place_of_the_master(start, root):
    nodes = [(node['executable'], node['name'])
             for node in start(config=str(root / 'config' / 'cam_press_drive.yaml'))]
    assert nodes == [('cam_axis', 'follower'), ('drive_sim', 'press_drive')]


def test_the_linkages_of_the_umbrella_are_started_too(start, root):
    nodes = [(node['executable'], node['name'])
             for node in start(config=str(root / 'config' / 'umbrella.yaml'))]
    assert nodes == [('linkage_state', 'umbrella'), ('cam_axis', 'slider'), ('cam_axis', 'crank'),
                     ('master_shaft', 'master_shaft')]


def test_a_recorder_comes_with_a_directory_only(start):
    recorder = start(record='bag')[0]
    assert recorder['name'] == recorder['executable'] == 'bag_recorder'
    assert recorder['parameters'][1]['output'] == 'bag'
    assert recorder['parameters'][1]['machine'] == recorder['parameters'][0]
    assert 'bag_recorder' not in [node['name'] for node in start()]


def test_the_nodes_read_the_machine_file_itself(start, tmp_path):
    assert {node['parameters'][0] for node in start()} == {str(tmp_path / 'machine.yaml')}


def test_a_namespace_moves_the_nodes_and_their_parameters(start):
    nodes = start(namespace='/cell/1')
    assert {node['namespace'] for node in nodes} == {'cell/1'}
    moved = Path(nodes[0]['parameters'][0])
    try:
        sections = yaml.safe_load(moved.read_text())
    finally:
        moved.unlink()
    assert sections == {f'/cell/1/{name}': section for name, section in MACHINE.items()}


@pytest.mark.parametrize('text', ['', 'line: {ros__parameters: {axes: []}}', '- 1'])
def test_a_file_without_a_line_is_refused_by_name(start, tmp_path, text):
    (tmp_path / 'other.yaml').write_text(text)
    with pytest.raises(RuntimeError, match='other.yaml: line.ros__parameters'):
        start(config=str(tmp_path / 'other.yaml'))


@pytest.fixture
def umbrella(root, monkeypatch):
    """Import the launch file of the umbrella."""
    stand_in(monkeypatch)
    return loaded(root / 'launch' / 'umbrella.launch.py')


def test_the_umbrella_is_the_same_line_with_viewers_on_demand(umbrella, root):
    actions = umbrella.generate_launch_description().arguments[0]
    line, = (each for each in actions if 'launch_arguments' in each.options)
    assert line.arguments[0] == root / 'launch' / 'cutting_machine.launch.py'
    assert [name for name, _ in line.options['launch_arguments']] == [
        'config', 'namespace', 'record']
    given = {'config': str(umbrella.CONFIG), 'linkage': 'umbrella', 'namespace': '/l1',
             'urdf': 'false', 'rviz': 'false'}
    assert umbrella.viewers(given) == []
    frames, rviz = (each.options for each in umbrella.viewers(
        {**given, 'urdf': 'true', 'rviz': 'true'}))
    assert {frames['namespace'], rviz['namespace']} == {'l1'}
    assert frames['remappings'] == [('joint_states', 'umbrella/joint_states')]
    assert 'name="theta2"' in frames['parameters'][0]['robot_description']
    alone, = umbrella.viewers({**given, 'rviz': 'true'})
    assert [Path(each['arguments'][1]).name for each in (rviz, alone.options)] == [
        'umbrella_urdf.rviz', 'umbrella.rviz']
    with pytest.raises(RuntimeError, match='inputs'):
        umbrella.urdf_of(str(umbrella.CONFIG), 'no_such_linkage')


@pytest.mark.parametrize('name, models', [('umbrella', []),
                                          ('umbrella_urdf', ['RobotModel', 'TF'])])
def test_rviz_shows_the_topics_of_the_umbrella_without_editing(root, name, models):
    view = yaml.safe_load((root / 'launch' / f'{name}.rviz').read_text())['Visualization Manager']
    shown = {each['Class'].split('/')[-1]: each for each in view['Displays']}
    assert list(shown) == ['Grid', 'MarkerArray', *models]
    assert all(each['Enabled'] and each['Value'] for each in shown.values())
    assert shown['MarkerArray']['Topic']['Value'] == 'umbrella/markers'
    # bars are drawn once: as markers, or as the URDF
    assert shown['MarkerArray']['Namespaces']['links'] == (not models)
    if models:
        assert shown['RobotModel']['Description Topic']['Value'] == 'robot_description'
    assert view['Global Options']['Fixed Frame'] == 'world'


def test_what_foxglove_shows_are_the_topics_of_the_umbrella(root):
    layout = json.loads((root / 'launch' / 'umbrella.foxglove.json').read_text())
    panels = layout['configById']
    assert panels['3D!umbrella']['topics'] == {'/umbrella/markers': {'visible': True}}

    def placed(part):
        return [part] if isinstance(part, str) else placed(part['first']) + placed(part['second'])
    assert set(placed(layout['layout'])) == set(panels)
