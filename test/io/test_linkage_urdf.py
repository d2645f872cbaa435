# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The URDF of a linkage: a tree whose joints are the joint states, its frames where points are."""

import math
from pathlib import Path
from xml.etree import ElementTree as Xml

from cam_motion.io.config import read_sections
from cam_motion.io.linkage_config import build_linkage
from cam_motion.io.linkage_urdf import linkage_urdf
from cam_motion.mechanism.joints import LinkageJoints
from cam_motion.mechanism.linkage_motion import move
from cam_motion.mechanism.outline import Outline
from cam_motion.mechanism.tracking import Tracker
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

CONFIGS = Path(__file__).resolve().parents[2] / 'config'
NAMES = ('umbrella', 'four_bar', 'slider_crank')
# a pantograph: two links turn as one with each of two others, and one input moves two slides
PANTOGRAPH = {
    'type': 'linkage', 'inputs': ['s'], 's.start': 0.5, 'unknowns': ['a', 'b'],
    'a.start_deg': 53.0, 'b.start_deg': -53.0, 'bodies': ['left', 'right'],
    'left.angle': 'a', 'right.angle': 'b', 'vectors': ['up', 'down', 'slide', 'apart'],
    'up.length': 0.4, 'up.body': 'left', 'down.length': 0.4, 'down.body': 'right',
    'slide.variable': 's', 'apart.length': 0.2, 'apart.turn_deg': 90.0,
    'loops': ['ring'], 'ring.path': ['up', 'down', '-slide'],
    'points': ['O', 'P', 'Q', 'U', 'V', 'W'], 'P.from': 'O', 'P.path': ['up'],
    'Q.from': 'P', 'Q.path': ['down'], 'U.from': 'O', 'U.path': ['apart'],
    'V.from': 'U', 'V.path': ['down'], 'W.from': 'U', 'W.path': ['slide'],
}


@pytest.fixture(params=[*NAMES, 'pantograph'])
def settings(request):
    """Read a linkage."""
    if request.param == 'pantograph':
        return build_linkage('pantograph', PANTOGRAPH)
    return build_linkage(request.param, read_sections(
        CONFIGS / f'{request.param}.yaml')[request.param])


def numbers(element, key, default='0 0 0'):
    """Read a list of numbers."""
    text = default if element is None else element.get(key, default)
    return np.array([float(part) for part in text.split()])


def frames(robot, values):
    """Find where all links are, as x + j y and an angle, from the values of the joints."""
    joints = {joint.find('child').get('link'): joint for joint in robot.iter('joint')}
    names = [link.get('name') for link in robot.iter('link')]
    root, = set(names) - set(joints)
    found = {root: (0.0, 0.0)}
    while len(found) < len(names):
        before = len(found)
        for child, joint in joints.items():
            parent = joint.find('parent').get('link')
            if child in found or parent not in found:
                continue
            place, angle = found[parent]
            turn = complex(math.cos(angle), math.sin(angle))
            x, y, z = numbers(joint.find('origin'), 'xyz')
            assert z == 0.0 and not numbers(joint.find('origin'), 'rpy').any()
            place, kind = place + turn * complex(x, y), joint.get('type')
            if kind == 'prismatic':
                along = numbers(joint.find('axis'), 'xyz')
                assert np.hypot(*along[:2]) == pytest.approx(1.0, abs=1e-12)
                place += turn * complex(*along[:2]) * values[joint.get('name')]
            elif kind == 'continuous':
                assert list(numbers(joint.find('axis'), 'xyz')) == [0.0, 0.0, 1.0]
                angle += values[joint.get('name')]
            found[child] = (place, angle)
        assert len(found) > before, 'not one tree'
    return found


def test_the_frames_are_where_the_solver_has_the_points(settings):
    robot = Xml.fromstring(linkage_urdf(settings).encode())
    links = [link.get('name') for link in robot.iter('link')]
    moved = [j.get('name') for j in robot.iter('joint') if j.get('type') != 'fixed']
    assert len(set(links)) == len(links) and len(set(moved)) == len(moved)
    assert not list(robot.iter('mimic'))
    assembly = settings.assembly
    joints = LinkageJoints(assembly, Outline(assembly), {})
    assert len(set(joints.names)) == len(joints.names)
    assert set(moved) <= set(joints.names)
    tracker = Tracker(assembly)
    for shift in (0.0, 0.05, -0.1, 0.2):
        inputs = [assembly.start[name] + shift for name in assembly.linkage.inputs]
        while tracker.follow(inputs) is None:
            assert tracker.refusal is None
        still = np.zeros(len(tracker.pose.values))
        positions, _, _ = joints.at(tracker.pose.values, still, tracker.gain())
        found = frames(robot, dict(zip(joints.names, positions)))
        points = move(assembly, tracker.pose, {}).points
        assert set(points) <= set(found)
        for name, point in points.items():
            assert found[name][0] == pytest.approx(point.position, abs=1e-11)
        for body in assembly.linkage.bodies:
            assert found[body.name][1] == pytest.approx(tracker.pose[body.angle], abs=1e-12)


def test_every_visual_can_be_drawn_and_limits_are_given(settings):
    robot = Xml.fromstring(linkage_urdf(settings).encode())
    shapes = [next(iter(geometry)) for geometry in robot.iter('geometry')]
    assert len(shapes) >= len(settings.linkage.bodies)
    for shape in shapes:
        key = {'box': 'size', 'sphere': 'radius'}[shape.tag]
        assert numbers(shape, key).min() > 0.0
    for joint in robot.iter('joint'):
        if joint.get('type') == 'prismatic':
            limit = joint.find('limit')
            assert float(limit.get('lower')) < float(limit.get('upper'))
            assert float(limit.get('effort')) > 0.0 < float(limit.get('velocity'))


def limits(robot):
    """Read the limits of the slides, by joint."""
    return {joint.get('name'): (float(joint.find('limit').get('lower')),
                                float(joint.find('limit').get('upper')))
            for joint in robot.iter('joint') if joint.find('limit') is not None}


def test_limits_of_inputs_are_their_ranges():
    settings = build_linkage('umbrella', read_sections(CONFIGS / 'umbrella.yaml')['umbrella'])
    found = limits(Xml.fromstring(linkage_urdf(settings).encode()))
    assert found['h1'] == pytest.approx((0.2, 2.2), abs=1e-7)
    assert found['h2'] == pytest.approx((math.sqrt(0.08), math.sqrt(2.24)), abs=1e-7)


def test_an_input_that_nothing_stops_has_wide_limits():
    free = {**PANTOGRAPH, 'inputs': ['s', 'free'], 'free.start': 0.1,
            'vectors': [*PANTOGRAPH['vectors'], 'beside'], 'beside.variable': 'free',
            'points': [*PANTOGRAPH['points'], 'X'], 'X.path': ['beside']}
    found = limits(Xml.fromstring(linkage_urdf(build_linkage('free', free)).encode()))
    low, high = found['free']
    assert low < -10.0 and high > 10.0
    assert found['s'] == pytest.approx((0.0, 0.8), abs=1e-5)


def test_no_slide_leaves_its_limits(settings):
    found = limits(Xml.fromstring(linkage_urdf(settings).encode()))
    assembly = settings.assembly
    joints = LinkageJoints(assembly, Outline(assembly), {})
    start, size = assembly.start, assembly.equations.size
    ranges = {name: assembly.range_of(name) for name in assembly.linkage.inputs}
    for share in np.linspace(0.02, 0.98, 13):
        pose = assembly.at({
            name: start[name] + math.tau * share if math.isinf(each.high) else
            each.low + share * (each.high - each.low) for name, each in ranges.items()})
        still, gain = np.zeros(len(pose.values)), np.zeros((
            len(assembly.linkage.unknowns), len(assembly.linkage.inputs)))
        positions, _, _ = joints.at(pose.values, still, gain)
        for name, value in zip(joints.names, positions):
            low, high = found.get(name, (-math.inf, math.inf))
            assert low <= value <= high and (name not in found or high - low < 30.0 * size)


def test_what_moves_by_the_same_variable_has_a_joint_of_its_own():
    settings = build_linkage('pantograph', PANTOGRAPH)
    outline = Outline(settings.assembly)
    assert [piece.name for piece in outline.pieces] == ['frame', 'left', 'right', 'right_2']
    joints = LinkageJoints(settings.assembly, outline, {})
    positions, velocities, _ = joints.at(
        settings.assembly.start.values, np.array([0.1, 0.2, 0.3]), np.zeros((2, 1)))
    by_name = {name: pair for name, *pair in zip(joints.names, positions, velocities)}
    assert by_name['right_2_joint'] == by_name['b']
    assert settings.assembly.start['b'] == by_name['b'][0]
