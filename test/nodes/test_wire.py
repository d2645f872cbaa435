# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The messages of the hot path as bytes: what rclpy would write and read, and never an error."""

import math
import struct

from builtin_interfaces.msg import Duration, Time
from cam_motion.nodes.wire import JointStateCodec, pack_point, unpack_point
from cam_motion.runtime.point import Point
from hypothesis import example, given
from hypothesis import strategies as st
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Header, String
from trajectory_msgs.msg import JointTrajectoryPoint

pytestmark = [pytest.mark.ros, pytest.mark.timeout(60)]

doubles = st.floats(allow_nan=False, allow_infinity=False)
anything = st.floats(allow_nan=True, allow_infinity=True)
seconds = st.integers(-2**31, 2**31 - 1)
nanoseconds = st.integers(0, 999_999_999)
points = st.builds(Point, doubles, doubles, doubles, seconds, nanoseconds)
few_doubles = st.lists(doubles, max_size=3)
names = st.text(st.characters(codec='utf-8', exclude_characters='\0'), max_size=40)
PADDING = (*range(8, 12), *range(24, 28), *range(40, 44))
LENGTH = 64  # of a point without efforts; rclpy may leave some bytes behind it
GIVEN = Point(1.5, -2.25, 1e-300, 7, 123_456_789)


def message_of(point, **changes):
    """Write a point as a message object, with changes."""
    fields = {
        'positions': [point.position], 'velocities': [point.velocity],
        'accelerations': [point.acceleration],
        'time_from_start': Duration(sec=point.sec, nanosec=point.nanosec), **changes}
    return JointTrajectoryPoint(**fields)


def bits(*values):
    """Give numbers as bytes, so that -0.0 is not 0.0."""
    return struct.pack(f'<{len(values)}d', *values)


@given(points)
@example(GIVEN)
@example(Point(-0.0, 5e-324, 1.7976931348623157e308, -2**31, 999_999_999))
def test_a_packed_point_is_what_rclpy_writes(point):
    written = bytearray(serialize_message(message_of(point))[:LENGTH])
    for place in PADDING:
        written[place] = 0
    assert pack_point(*point) == written


@given(points)
def test_rclpy_reads_a_packed_point(point):
    assert deserialize_message(pack_point(*point), JointTrajectoryPoint) == message_of(point)


@given(points)
def test_what_rclpy_writes_is_unpacked_to_the_last_bit(point):
    read = unpack_point(serialize_message(message_of(point)))
    assert bits(*read[:3]) == bits(*point[:3])
    assert read[3:] == point[3:]


@given(points)
def test_the_time_of_a_point_is_its_seconds_and_nanoseconds(point):
    assert point.time == pytest.approx(point.sec + point.nanosec / 1e9, rel=1e-15)


@given(points, st.lists(anything, min_size=1, max_size=3))
def test_a_point_with_efforts_is_read_without_them(point, effort):
    assert unpack_point(serialize_message(message_of(point, effort=effort))) == point


@given(few_doubles, few_doubles, few_doubles, few_doubles)
def test_only_exactly_one_value_each_makes_a_point(positions, velocities, accelerations, effort):
    data = serialize_message(JointTrajectoryPoint(
        positions=positions, velocities=velocities, accelerations=accelerations, effort=effort))
    read = unpack_point(data)
    if len(positions) == len(velocities) == len(accelerations) == 1:
        assert read == Point(positions[0], velocities[0], accelerations[0], 0, 0)
    else:
        assert read is None


@pytest.mark.parametrize('wrong', [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize('field', ['position', 'velocity', 'acceleration'])
@pytest.mark.parametrize('effort', [[], [1.0]])
def test_a_point_that_is_not_finite_is_none(field, wrong, effort):
    point = GIVEN._replace(**{field: wrong})
    assert unpack_point(serialize_message(message_of(point, effort=effort))) is None


@given(points)
def test_a_big_endian_point_is_read_too(point):
    data = bytes((0, 0, 0, 0)) + struct.pack('>I4xdI4xdI4xdIiI', 1, point[0], 1, point[1], 1,
                                             point[2], 0, point[3], point[4])
    assert unpack_point(data) == point


def test_a_big_endian_point_that_is_not_finite_is_none():
    data = bytes((0, 0, 0, 0)) + struct.pack('>I4xdI4xdI4xdIiI', 1, 1.0, 1, math.inf, 1, 1.0,
                                             0, 0, 0)
    assert unpack_point(data) is None


@pytest.mark.parametrize('data', [
    pack_point(*GIVEN), serialize_message(message_of(GIVEN, effort=[1.0]))],
    ids=['plain', 'with effort'])
def test_a_truncated_point_is_none_wherever_it_ends(data):
    assert [n for n in range(len(data)) if unpack_point(data[:n]) is not None] == []


@given(st.binary(max_size=100))
@example(b'')
@example(b'\0\1\0\0')
@example(b'\0\1\0\0' + b'\xff' * 60)  # four thousand million positions
def test_malformed_bytes_never_raise(data):
    read = unpack_point(data)
    assert read is None or all(map(math.isfinite, read[:3]))


@given(st.integers(0, 63), st.integers(0, 255))
def test_a_damaged_byte_never_raises(place, value):
    data = bytearray(pack_point(*GIVEN))
    data[place] = value
    read = unpack_point(bytes(data))
    assert read is None or all(map(math.isfinite, read[:3]))


def test_another_message_type_is_no_point():
    assert unpack_point(serialize_message(String(data='shaft'))) is None


@given(st.data(), st.lists(names, max_size=4), st.booleans(),
       st.integers(0, 2**31 * 10**9 - 1))
@example(None, ['motor', 'load'], True, 1_700_000_000_123_456_789)
@example(None, ['achse_ß', 'x' * 40, ''], False, 0)
def test_rclpy_reads_a_packed_joint_state(data, joints, with_effort, stamp):
    def row():
        exactly = st.lists(anything, min_size=len(joints), max_size=len(joints))
        return data.draw(exactly) if data else [0.5 - k for k in range(len(joints))]
    positions, velocities, efforts = row(), row(), row() if with_effort else []
    packed = JointStateCodec(joints, with_effort).pack(stamp, positions, velocities, efforts)
    header = Header(stamp=Time(sec=stamp // 10**9, nanosec=stamp % 10**9))
    read = deserialize_message(packed, JointState)
    assert (read.header, list(read.name)) == (header, joints)
    assert bits(*read.position, *read.velocity, *read.effort) == bits(
        *positions, *velocities, *efforts)


@pytest.mark.parametrize('rows', [([1.0], [2.0, 3.0]), ([1.0, 2.0, 3.0], [1.0, 2.0])])
def test_a_joint_state_with_a_wrong_count_is_refused(rows):
    with pytest.raises(struct.error):
        JointStateCodec(['motor', 'load'], with_effort=False).pack(0, *rows)
