# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The bag reader on bags of other recorders, whole, cut and damaged; topics as arrays."""

from __future__ import annotations

from pathlib import Path
import struct

from cam_motion.io.bag import BagError, BagReader, BagWriter, read_joint_states, read_points
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
import numpy as np
import pytest
from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.typesys import get_typestore, Stores

pytestmark = pytest.mark.timeout(60)

POINT = 'trajectory_msgs/msg/JointTrajectoryPoint'
STATE = 'sensor_msgs/msg/JointState'
STORE = get_typestore(Stores.ROS2_JAZZY)

Duration = STORE.types['builtin_interfaces/msg/Duration']
Time = STORE.types['builtin_interfaces/msg/Time']
Header = STORE.types['std_msgs/msg/Header']
JointState = STORE.types[STATE]
JointTrajectoryPoint = STORE.types[POINT]


def point(position, velocity=(), acceleration=(), effort=(), time_ns=0) -> bytes:
    """Serialise a point."""
    arrays = [np.array(x, dtype=np.float64) for x in (position, velocity, acceleration, effort)]
    message = JointTrajectoryPoint(*arrays, Duration(time_ns // 10**9, time_ns % 10**9))
    return bytes(STORE.serialize_cdr(message, POINT))


def state(names, position, velocity=(), effort=(), stamp_ns=0) -> bytes:
    """Serialise a joint state."""
    header = Header(Time(stamp_ns // 10**9, stamp_ns % 10**9), 'world')
    arrays = [np.array(x, dtype=np.float64) for x in (position, velocity, effort)]
    return bytes(STORE.serialize_cdr(JointState(header, list(names), *arrays), STATE))


def write_by_rosbags(path, storage, mode=CompressionMode.NONE, count=300, version=9):
    """Write a bag by the writer of rosbags."""
    forever = QosTime(9223372036, 854775807)
    qos = Qos(
        QosHistory.KEEP_LAST,
        7,
        QosReliability.BEST_EFFORT,
        QosDurability.TRANSIENT_LOCAL,
        forever,
        QosTime(1, 5),
        QosLiveliness.AUTOMATIC,
        forever,
        False,
    )
    writer = RosbagsWriter(path, version=version, storage_plugin=storage)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    writer.set_custom_data('machine', 'line: 1\n')
    expected = []
    with writer:
        connections = [
            writer.add_connection(topic, POINT, typestore=STORE, offered_qos_profiles=[qos])
            for topic in ('/a', '/b')
        ]
        for number in range(count):
            connection = connections[number % 2]
            writer.write(connection, number, point([number]))
            expected.append((connection.topic, number, point([number])))
    return expected


@pytest.mark.parametrize(
    ('storage', 'mode'),
    [
        (StoragePlugin.MCAP, CompressionMode.NONE),
        (StoragePlugin.MCAP, CompressionMode.STORAGE),
        (StoragePlugin.SQLITE3, CompressionMode.NONE),
        (StoragePlugin.SQLITE3, CompressionMode.FILE),
        (StoragePlugin.SQLITE3, CompressionMode.MESSAGE),
    ],
)
@pytest.mark.parametrize('version', [8, 9])
def test_bags_of_rosbags_are_read(tmp_path, storage, mode, version):
    path = tmp_path / 'bag'
    expected = write_by_rosbags(path, storage, mode, version=version)
    with BagReader(path) as reader:
        assert not reader.incomplete
        assert list(reader.messages()) == expected
        assert list(reader.messages('/b')) == expected[1::2]
        assert list(reader.messages(['/a'])) == expected[::2]
        assert reader.custom_data == {'machine': 'line: 1\n'}
        topic = reader.topics['/a']
        assert (topic.type_name, topic.count) == (POINT, 150)
        (qos,) = topic.qos_profiles
        assert (qos.depth, qos.reliability, qos.durability, qos.lifespan) == (
            7,
            'best_effort',
            'transient_local',
            1_000_000_005,
        )
        assert reader.decode(POINT, expected[3][2]).positions == [3.0]
        with pytest.raises(BagError, match=r'no topic /c \(there are: /a, /b\)'):
            reader.messages('/c')
    if mode in (CompressionMode.NONE, CompressionMode.STORAGE):
        (file,) = (x for x in path.iterdir() if x.suffix in ('.mcap', '.db3'))
        with BagReader(file) as reader:
            assert list(reader.messages()) == expected
            assert reader.custom_data == {'machine': 'line: 1\n'}
        (path / 'metadata.yaml').unlink()  # what a killed recorder never wrote
        with BagReader(path) as reader:
            assert reader.incomplete
            assert list(reader.messages()) == expected


@pytest.mark.parametrize('compression', list(CompressionType))
@pytest.mark.parametrize('chunks', [True, False])
def test_cut_mcap_is_read_up_to_the_cut(tmp_path, compression, chunks):
    file = tmp_path / 'cut.mcap'
    with file.open('wb') as stream:
        writer = McapWriter(
            stream, chunk_size=4000, compression=compression, use_chunking=chunks
        )
        writer.start('ros2', 'test')
        text, _ = STORE.generate_msgdef(POINT, ros_version=2)
        schema = writer.register_schema(POINT, 'ros2msg', text.encode())
        channel = writer.register_channel('/a', 'cdr', schema)
        for number in range(500):
            writer.add_message(channel, number, point([number]), number)
        writer.finish()
    whole = file.read_bytes()
    before = 0
    for size in (8, 9, 40, 500, 1000, *range(2000, len(whole), 997), len(whole) - 1):
        file.write_bytes(whole[:size])
        with BagReader(file) as reader:
            assert reader.incomplete
            entries = list(reader.messages())
            assert entries == [('/a', number, point([number])) for number in range(len(entries))]
            assert len(entries) >= before
            assert sum(topic.count for topic in reader.topics.values()) == len(entries)
            if entries:
                assert reader.decode(POINT, entries[0][2]).positions == [0.0]
                assert len(read_points(reader, '/a').stamps_ns) == len(entries)
        before = len(entries)
        if compression == CompressionType.NONE:
            assert len(entries) >= (size - 5000) / 130  # also the whole part of a cut chunk
    assert before == 500


def test_our_bag_is_read_from_its_cut_file(tmp_path):
    with BagWriter(tmp_path / 'bag', custom_data={'machine': 'text'}) as writer:
        handle = writer.add_topic('/a', POINT)
        for number in range(1000):
            writer.write(handle, number, point([number]))
            if number % 100 == 0:
                writer.flush()
    file = tmp_path / 'bag' / 'bag_0.mcap'
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    with BagReader(tmp_path / 'bag') as reader:
        assert reader.incomplete
        assert reader.custom_data == {'machine': 'text'}
        times = [time_ns for _, time_ns, _ in reader.messages()]
        assert times == list(range(len(times)))
        assert 300 < len(times) == reader.topics['/a'].count < 700


@pytest.mark.parametrize(
    ('make', 'text'),
    [
        (lambda path: None, 'does not exist'),
        (lambda path: path.mkdir(), 'neither metadata.yaml nor'),
        (lambda path: path.write_text('x'), 'neither .mcap nor .db3'),
    ],
)
def test_what_is_no_bag_is_refused(tmp_path, make, text):
    make(tmp_path / 'bag')
    with pytest.raises(BagError, match=text):
        BagReader(tmp_path / 'bag')


@pytest.mark.parametrize('name', ['x.mcap', 'x.db3'])
@pytest.mark.parametrize('content', [b'', b'text', bytes(10_000)])
def test_files_of_other_kinds_are_refused(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BagError, match=name.replace('.', r'\.')):
        BagReader(tmp_path / name)


@pytest.mark.parametrize(
    'text', ['', '[]', 'a: b', 'rosbag2_bagfile_information: 1', '\t:{', '\xff']
)
def test_broken_metadata_is_refused(tmp_path, text):
    write_by_rosbags(tmp_path / 'bag', StoragePlugin.MCAP)
    (tmp_path / 'bag' / 'metadata.yaml').write_text(text, 'latin-1')
    with pytest.raises(BagError, match=r'metadata\.yaml: not understood'):
        BagReader(tmp_path / 'bag')


def test_missing_storage_file_is_named(tmp_path):
    write_by_rosbags(tmp_path / 'bag', StoragePlugin.MCAP)
    (tmp_path / 'bag' / 'bag.mcap').rename(tmp_path / 'bag.mcap')
    with pytest.raises(BagError, match=r'bag\.mcap: no such file'):
        BagReader(tmp_path / 'bag')


def test_bag_of_several_files(tmp_path):
    path = tmp_path / 'bag'
    first = write_by_rosbags(path, StoragePlugin.MCAP)
    second = write_by_rosbags(tmp_path / 'more', StoragePlugin.MCAP, count=100)
    (tmp_path / 'more' / 'more.mcap').rename(path / 'more.mcap')
    file = path / 'metadata.yaml'
    text = file.read_text()
    file.write_text(text.replace('relative_file_paths:', 'relative_file_paths:\n  - more.mcap'))
    with BagReader(path) as reader:
        entries = list(reader.messages())
        assert len(entries) == len(first) + len(second) == 400
        assert reader.topics['/a'].count == 200


def record(path: Path, topic: str, type_name: str, messages: list[bytes]) -> BagReader:
    """Write messages to a bag and open it."""
    with BagWriter(path) as writer:
        handle = writer.add_topic(topic, type_name)
        for number, message in enumerate(messages):
            writer.write(handle, 1000 + number, message)
    return BagReader(path)


def test_point_of_one_joint_is_64_bytes():
    raw = point([1.5], [2.5], [3.5], (), 7_000_000_009)
    assert raw == struct.pack(
        '<4sI4xdI4xdI4xdIiI', b'\0\1\0\0', 1, 1.5, 1, 2.5, 1, 3.5, 0, 7, 9
    )


@pytest.mark.parametrize('dof', [1, 2, 3])
@pytest.mark.parametrize('effort', [False, True])
@pytest.mark.parametrize('odd_one', [False, True])
def test_points_as_arrays(tmp_path, dof, effort, odd_one):
    generator = np.random.default_rng(1)
    values = generator.normal(size=(4, 50, dof))
    times = generator.integers(0, 2**40, size=50)
    raws = [
        point(p, v, a, e if effort else (), int(t))
        for p, v, a, e, t in zip(*values, times, strict=True)
    ]
    expected = [x.copy() for x in values]
    if not effort:
        expected[3][:] = np.nan
    if odd_one:  # sequences on a big-endian machine, read one by one
        message = STORE.deserialize_cdr(raws[7], POINT)
        raws[7] = bytes(STORE.serialize_cdr(message, POINT, little_endian=False))
        assert raws[7][:2] == b'\0\0'
    with record(tmp_path / 'bag', '/p', POINT, raws) as reader:
        series = read_points(reader, '/p')
    np.testing.assert_array_equal(series.positions, expected[0])
    np.testing.assert_array_equal(series.velocities, expected[1])
    np.testing.assert_array_equal(series.accelerations, expected[2])
    np.testing.assert_array_equal(series.efforts, expected[3])
    np.testing.assert_array_equal(series.time_from_start_s, times * 1e-9)
    np.testing.assert_array_equal(series.stamps_ns, np.arange(1000, 1050))


def test_points_without_derivatives_are_nan(tmp_path):
    with record(tmp_path / 'bag', '/p', POINT, [point([1.0, 2.0]), point([3.0, 4.0])]) as reader:
        series = read_points(reader, '/p')
    assert series.positions.tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert series.velocities.shape == (2, 2)
    assert np.isnan(series.velocities).all()


@pytest.mark.parametrize('messages', [[point([1.0]), point([1.0, 2.0])], [point([1], [1, 2])]])
def test_changing_number_of_joints_is_refused(tmp_path, messages):
    with record(tmp_path / 'bag', '/p', POINT, messages) as reader:
        with pytest.raises(BagError, match=r'/p: .*joints'):
            read_points(reader, '/p')


def test_arrays_of_an_empty_or_foreign_topic(tmp_path):
    with record(tmp_path / 'a', '/p', POINT, []) as reader:
        series = read_points(reader, '/p')
        assert series.positions.shape == (0, 0)
        assert series.stamps_ns.shape == (0,)
        with pytest.raises(BagError, match=f'/p: is of type {POINT}, not {STATE}'):
            read_joint_states(reader, '/p')
        with pytest.raises(BagError, match='no topic /q'):
            read_points(reader, '/q')
    with record(tmp_path / 'b', '/s', STATE, []) as reader:
        states = read_joint_states(reader, '/s')
        assert states.names == ()
        assert states.positions.shape == (0, 0)


@pytest.mark.parametrize('effort', [False, True])
@pytest.mark.parametrize('names', [('motor', 'load'), ('x',), ('a', 'bb', 'cccc')])
def test_joint_states_as_arrays(tmp_path, names, effort):
    generator = np.random.default_rng(2)
    values = generator.normal(size=(3, 40, len(names)))
    stamps = generator.integers(0, 2**60, size=40)
    raws = [
        state(names, p, v, e if effort else (), int(t))
        for p, v, e, t in zip(*values, stamps, strict=True)
    ]
    with record(tmp_path / 'bag', '/s', STATE, raws) as reader:
        series = read_joint_states(reader, '/s')
    assert series.names == names
    np.testing.assert_array_equal(series.positions, values[0])
    np.testing.assert_array_equal(series.velocities, values[1])
    np.testing.assert_array_equal(
        series.efforts, values[2] if effort else np.full_like(values[2], np.nan)
    )
    np.testing.assert_array_equal(series.header_stamps_ns, stamps)
    np.testing.assert_array_equal(series.stamps_ns, np.arange(1000, 1040))


def test_joints_that_change_their_names_are_refused(tmp_path):
    messages = [state(['a', 'b'], [1, 2]), state(['b', 'a'], [1, 2])]
    with record(tmp_path / 'bag', '/s', STATE, messages) as reader:
        with pytest.raises(BagError, match='names change'):
            read_joint_states(reader, '/s')
