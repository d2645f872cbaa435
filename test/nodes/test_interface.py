# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The interface that README shows is the one the nodes have."""

from pathlib import Path

from cam_motion.io.config import read_sections
from cam_motion.io.interface import INTERFACE
from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.drive_sim import DriveSim
from cam_motion.nodes.linkage_state import LinkageState
from cam_motion.nodes.master_shaft import MasterShaft
import pytest

pytestmark = [pytest.mark.timeout(120), pytest.mark.ros]

TRACK = {'tracks': ['track'], 'track.on_deg': [10.0], 'track.off_deg': [20.0]}
AXIS = {'segments': ['rest'], 'rest.end_deg': 360.0, 'trajectory.rate_hz': 50.0, **TRACK}
CUT = {'load': ['cut'], 'cut.type': 'process', 'cut.force': 5.0, 'cut.window_deg': [10.0, 20.0]}
CONFIGS = Path(__file__).resolve().parents[2] / 'config'
PRESS = read_sections(CONFIGS / 'cam_press_drive.yaml')
FOUR_BAR = {**read_sections(CONFIGS / 'four_bar.yaml')['four_bar'], 'theta2.axis': 'cam_axis'}
NODES = {
    'master_shaft': (MasterShaft, {'obey': ['cam_axis'], **TRACK}), 'cam_axis': (CamAxis, AXIS),
    'drive_sim': (DriveSim, {'axis': 'cam_axis', **CUT}),
    'linkage_state': (LinkageState, FOUR_BAR),
}
# What ROS gives to every lifecycle node
_OF_ROS = ('parameter', 'transition', 'get_state', 'change_state', 'get_available', 'rosout',
           'type_description', 'get_type_description', 'logger_level')


def of_ours(names_and_types):
    return {(name, types[0]) for name, types in names_and_types
            if not any(word in name for word in _OF_ROS)}


@pytest.mark.parametrize('executable', NODES)
def test_a_node_has_the_topics_and_services_of_the_table_and_no_others(world, executable):
    factory, given = NODES[executable]
    node = world.make(factory, given, **{'name': executable})
    node.trigger_configure()
    rows = [row for row in INTERFACE if row.node in (executable, 'all')]
    wanted = {kind: {
        (row.name.replace('~', f'/{executable}').replace('<axis>', '/cam_axis').replace(
            '<track>', 'track')
         if row.name[0] in '~<' else '/' + row.name.lstrip('/'), row.type_name)
        for row in rows if row.kind == kind} for kind in ('publishes', 'subscribes', 'serves')}

    def found():
        ask = world.probe
        return {
            'publishes': of_ours(ask.get_publisher_names_and_types_by_node(executable, '/')),
            'subscribes': of_ours(ask.get_subscriber_names_and_types_by_node(executable, '/')),
            'serves': of_ours(ask.get_service_names_and_types_by_node(executable, '/')),
        }

    assert world.spin_until(lambda: found() == wanted), (found(), wanted)


def test_a_drive_that_turns_the_shaft_has_what_the_table_says_of_its_mode(world):
    node = world.make(DriveSim, {**PRESS['press_drive'], **TRACK}, name='drive_sim')
    node.section = PRESS.get
    node.trigger_configure()
    rows = [row for row in INTERFACE if row.node in ('drive_sim: line_shaft', 'drive_sim', 'all')
            and row.kind != 'subscribes']
    wanted = {(row.kind, row.name.replace('~', '/drive_sim').replace('<track>', 'track')
               if row.name[0] == '~' else '/' + row.name.lstrip('/'), row.type_name)
              for row in rows}

    def found():
        ask = world.probe
        return {(kind, *each) for kind, ask in (
            ('publishes', ask.get_publisher_names_and_types_by_node),
            ('subscribes', ask.get_subscriber_names_and_types_by_node),
            ('serves', ask.get_service_names_and_types_by_node))
            for each in of_ours(ask('drive_sim', '/'))}

    assert world.spin_until(lambda: found() == wanted), (found(), wanted)
