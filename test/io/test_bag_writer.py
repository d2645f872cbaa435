# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The bag writer, read back by rosbags and mcap."""

from __future__ import annotations

from collections import Counter
import errno
import json
import os
from pathlib import Path
import sqlite3
import struct
import sys

from cam_motion.io.bag import BagError, BagReader, BagWriter, QosProfile
from hypothesis import given, HealthCheck, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.records import Message
from mcap.stream_reader import StreamReader
import pytest
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
from ruamel.yaml import YAML

pytestmark = pytest.mark.timeout(60)

POINT = 'trajectory_msgs/msg/JointTrajectoryPoint'
VARIANTS = [('mcap', None), ('mcap', 'zstd'), ('sqlite3', None)]
MANY = int(os.environ.get('CAM_MOTION_TEST_EXAMPLES', '25'))

variants = pytest.mark.parametrize(('storage', 'compression'), VARIANTS)


def point(number: float) -> bytes:
    """Serialise a point of one joint; it carries a number."""
    return struct.pack(
        '<4sI4xdI4xdI4xdIiI', b'\0\1\0\0', 1, number, 1, 2.0, 1, 3.0, 0, int(number), 5
    )


def storage_file(path: Path) -> Path:
    """Find the storage file of a bag."""
    (file,) = (x for x in path.iterdir() if x.suffix in ('.mcap', '.db3'))
    return file


def read_all(path: Path) -> list[tuple[str, int, bytes]]:
    """Read a bag by every library there is; they must agree."""
    with Reader(path) as reader:
        entries = [(x.topic, t, bytes(data)) for x, t, data in reader.messages()]
        assert reader.message_count == len(entries)
        counted = Counter(topic for topic, _, _ in entries)
        assert {x.topic: x.msgcount for x in reader.connections} == {
            x.topic: counted[x.topic] for x in reader.connections
        }
        if entries:
            times = [t for _, t, _ in entries]
            assert (reader.start_time, reader.end_time) == (min(times), max(times) + 1)
    with AnyReader([path]) as any_reader:
        assert [(x.topic, t, d) for x, t, d in any_reader.messages()] == entries
    with BagReader(path) as own:
        assert not own.incomplete
        assert list(own.messages()) == entries
        assert {x: own.topics[x].count for x in own.topics} == {
            x: counted[x] for x in own.topics
        }
    if storage_file(path).suffix == '.mcap':
        ordered = sorted(entries)
        seeking, streaming = read_mcap(storage_file(path))
        assert sorted(seeking) == ordered
        assert sorted(streaming) == ordered
    else:
        database = sqlite3.connect(storage_file(path))
        assert database.execute('PRAGMA integrity_check').fetchone() == ('ok',)
        assert database.execute('SELECT count(*) FROM messages').fetchone() == (len(entries),)
        database.close()
    return entries


def read_mcap(file: Path) -> tuple[list[tuple[str, int, bytes]], list[tuple[str, int, bytes]]]:
    """Read an mcap file by its summary, and from the start, checksums on."""
    with file.open('rb') as stream:
        seeker = make_reader(stream, validate_crcs=True)
        seeking = [(x.topic, m.log_time, m.data) for _, x, m in seeker.iter_messages()]
        (metadata,) = seeker.iter_metadata()
        assert metadata.name == 'rosbag2'
        summary = seeker.get_summary()
        names = {x.id: x.topic for x in summary.channels.values()}
        assert summary.statistics.message_count == len(seeking)
        assert summary.statistics.chunk_count == len(summary.chunk_indexes)
        stream.seek(0)
        records = StreamReader(stream, validate_crcs=True).records
        found = [x for x in records if isinstance(x, Message)]
    return seeking, [(names[x.channel_id], x.log_time, x.data) for x in found]


@variants
def test_bag_is_whole_after_every_flush(tmp_path, storage, compression):
    path = tmp_path / 'bag'
    expected = []
    with BagWriter(path, storage=storage, compression=compression, flush_interval=None) as writer:
        assert read_all(path) == []
        handles = {}
        for number in range(12):
            if number % 4 == 0:  # topics may come late
                topic = f'/axis_{number}/setpoint'
                handles[topic] = writer.add_topic(topic, POINT, [QosProfile(depth=number + 1)])
            for repeat in range(37 * number):
                for topic, handle in handles.items():
                    data = point(repeat)
                    time_ns = 10**18 + len(expected)
                    writer.write(handle, time_ns, data)
                    expected.append((topic, time_ns, data))
            assert writer.message_count == len(expected)
            writer.flush()
            assert writer.message_count == len(expected) == sum(writer.topics.values())
            assert read_all(path) == expected
    assert read_all(path) == expected
    assert sorted(x.name for x in path.iterdir()) == sorted(
        ['metadata.yaml', storage_file(path).name]
    )


@variants
def test_finished_file_has_no_free_room(tmp_path, storage, compression):
    path = tmp_path / 'bag'
    with BagWriter(path, storage=storage, compression=compression) as writer:
        handle = writer.add_topic('/shaft', POINT)
        for number in range(1000):
            writer.write(handle, number, point(number))
    limit = {'mcap': 1000 * 120, 'sqlite3': 1000 * 160}[storage]
    assert storage_file(path).stat().st_size < limit + 20_000
    if storage == 'mcap':
        opcodes = []
        data = storage_file(path).read_bytes()
        place = 8
        while place < len(data) - 8:
            opcode, length = struct.unpack_from('<BQ', data, place)
            opcodes.append(opcode)
            place += 9 + length
        # Header, chunk, index, metadata, data end; summary by kind, offsets; footer.
        assert bytes(opcodes).hex(' ') == (
            '01 06 07 0c 0f 03 04 08 0b 0d 0e 0e 0e 0e 0e 02'
        )


def test_metadata_has_the_fields_of_version_9(tmp_path):
    path = tmp_path / 'bag'
    text = 'line: 1\n  "ü" \\ \x07 \x85 \u2028 \U0001f600: # no comment\n\n'
    profile = QosProfile(
        history='keep_all', durability='transient_local', deadline=1_500_000_000
    )
    with BagWriter(path, custom_data={'machine.yaml': text, '': ''}) as writer:
        handle = writer.add_topic('/shaft', POINT, [profile, QosProfile()])
        writer.add_topic('/silent', 'std_msgs/msg/String')
        writer.write(handle, 5_000, point(1))
        writer.write(handle, 7_500, point(1))
        writer.set_custom_data('later', 'x')
    document = YAML(typ='safe').load((path / 'metadata.yaml').read_text())
    information = document.pop('rosbag2_bagfile_information')
    assert not document
    assert information.pop('custom_data') == {'machine.yaml': text, '': '', 'later': 'x'}
    topics = information.pop('topics_with_message_count')
    start, duration = {'nanoseconds_since_epoch': 5_000}, {'nanoseconds': 2_500}
    assert information == {
        'version': 9,
        'storage_identifier': 'mcap',
        'duration': duration,
        'starting_time': start,
        'message_count': 2,
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': ['bag_0.mcap'],
        'files': [
            {
                'path': 'bag_0.mcap',
                'starting_time': start,
                'duration': duration,
                'message_count': 2,
            }
        ],
        'ros_distro': os.environ.get('ROS_DISTRO', 'jazzy'),
    }
    assert [x['message_count'] for x in topics] == [2, 0]
    topic = topics[0]['topic_metadata']
    infinite = {'sec': 9223372036, 'nsec': 854775807}
    assert topic['offered_qos_profiles'][0] == {
        'history': 'keep_all',
        'depth': 10,
        'reliability': 'reliable',
        'durability': 'transient_local',
        'deadline': {'sec': 1, 'nsec': 500_000_000},
        'lifespan': infinite,
        'liveliness': 'automatic',
        'liveliness_lease_duration': infinite,
        'avoid_ros_namespace_conventions': False,
    }
    assert len(topic['offered_qos_profiles']) == 2
    assert topic['type_description_hash'].startswith('RIHS01_')
    with BagReader(path) as reader:
        assert reader.custom_data == {'machine.yaml': text, '': '', 'later': 'x'}
        assert reader.topics['/shaft'].qos_profiles == (profile, QosProfile())
    for lone in path.glob('*.mcap'):
        with BagReader(lone) as reader:
            assert reader.custom_data['machine.yaml'] == text


@pytest.mark.parametrize(
    'type_name',
    [
        POINT,
        'trajectory_msgs/msg/JointTrajectory',
        'sensor_msgs/msg/JointState',
        'std_msgs/msg/String',
        'std_msgs/msg/Float64',
        'diagnostic_msgs/msg/DiagnosticArray',
        'visualization_msgs/msg/MarkerArray',
        'lifecycle_msgs/msg/TransitionEvent',
        'rcl_interfaces/msg/Log',
        'rcl_interfaces/msg/ParameterEvent',
    ],
)
def test_type_hash_is_that_of_the_message_package(tmp_path, type_name):
    package, _, name = type_name.split('/')
    prefixes = [sys.prefix, *os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)]
    files = [Path(x) / 'share' / package / 'msg' / f'{name}.json' for x in prefixes if x]
    description = next((x for x in files if x.is_file()), None)
    if description is None:
        pytest.skip(f'{package} is not installed')
    entries = json.loads(description.read_text())['type_hashes']
    hashes = {x['type_name']: x['hash_string'] for x in entries}
    with BagWriter(tmp_path / 'bag') as writer:
        writer.add_topic('/topic', type_name)
    with Reader(tmp_path / 'bag') as reader:
        assert reader.connections[0].digest == hashes[type_name]


def test_unknown_types_need_a_definition(tmp_path):
    with BagWriter(tmp_path / 'bag') as writer:
        with pytest.raises(BagError, match='own_msgs/msg/Own.*definition='):
            writer.add_topic('/own', 'own_msgs/msg/Own')
        for text in ('???', 'own_msgs/Missing x'):
            with pytest.raises(BagError, match='own_msgs/msg/Own.*definition is not usable'):
                writer.add_topic('/own', 'own_msgs/msg/Own', definition=text)
        handle = writer.add_topic('/own', 'own_msgs/msg/Own', definition='float64 x\n')
        writer.write(handle, 1, b'\0\1\0\0' + struct.pack('<d', 2.5))
    with BagReader(tmp_path / 'bag') as reader:
        ((_, _, raw),) = reader.messages()
        assert reader.decode('own_msgs/msg/Own', raw).x == 2.5
        assert reader.topics['/own'].type_hash.startswith('RIHS01_')
    read_all(tmp_path / 'bag')


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_bad_messages_leave_no_trace(tmp_path, storage):
    path = tmp_path / 'bag'
    with BagWriter(path, storage=storage) as writer:
        handle = writer.add_topic('/shaft', POINT)
        writer.write(handle, 1, point(1))
        for bad in (
            (handle + 1, 1, b'x'),
            (0, 1, b'x'),
            (-1, 1, b'x'),
            (handle, -1, b'x'),
            (handle, 2**63, b'x'),
            (handle, 1.5, b'x'),
            (handle, None, b'x'),
            (handle, 1, b''),
            (handle, 1, 'text'),
            (handle, 1, None),
            (handle, 1, 17),
        ):
            with pytest.raises(BagError, match='bag: '):
                writer.write(*bad)
        assert writer.message_count == 1
        writer.write(handle, 2, bytearray(point(2)))
        writer.write(handle, 2**63 - 2, memoryview(point(3)))
        with pytest.raises(BagError, match=r'/shaft.*twice'):
            writer.add_topic('/shaft', POINT)
    assert [t for _, t, _ in read_all(path)] == [1, 2, 2**63 - 2]
    with pytest.raises(BagError, match='closed'):
        writer.flush()
    with pytest.raises(BagError, match='closed'):
        writer.write(handle, 3, point(1))
    writer.close()


def test_nothing_is_overwritten(tmp_path):
    with BagWriter(tmp_path / 'a' / 'bag') as writer:
        handle = writer.add_topic('/shaft', POINT)
        writer.write(handle, 1, point(1))
    with pytest.raises(BagError, match=r'a/bag: exists already.*choose another'):
        BagWriter(tmp_path / 'a' / 'bag')
    (tmp_path / 'file').write_text('mine')
    with pytest.raises(BagError, match='file: exists already'):
        BagWriter(tmp_path / 'file')
    with pytest.raises(BagError, match='cannot be made'):
        BagWriter(tmp_path / 'file' / 'bag')
    assert len(read_all(tmp_path / 'a' / 'bag')) == 1
    assert (tmp_path / 'file').read_text() == 'mine'


@pytest.mark.parametrize(
    'arguments',
    [
        {'storage': 'rosbag1'},
        {'compression': 'lz4'},
        {'compression': 'zstd', 'storage': 'sqlite3'},
        {'flush_interval': 0.0},
        {'flush_interval': 1.5},
        {'flush_interval': float('nan')},
        {'custom_data': {'number': 5}},
        {'custom_data': {'half': '\ud800'}},
    ],
)
def test_bad_arguments_make_nothing(tmp_path, arguments):
    with pytest.raises(BagError, match='bag'):
        BagWriter(tmp_path / 'bag', **arguments)
    assert not (tmp_path / 'bag').exists()


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_writes_flush_by_themselves(tmp_path, monkeypatch, storage):
    now = [100.0]
    monkeypatch.setattr('cam_motion.io.bag.writer.monotonic', lambda: now[0])
    path = tmp_path / 'bag'
    with BagWriter(path, storage=storage, flush_interval=0.5) as writer:
        handle = writer.add_topic('/shaft', POINT)
        writer.write(handle, 1, point(1))
        assert writer.topics == {'/shaft': 0}
        now[0] += 0.51
        writer.write(handle, 2, point(2))
        assert writer.topics == {'/shaft': 2}
        assert len(read_all(path)) == 2
        writer.write(handle, 3, point(3))
        assert not writer.flush_if_due()
        now[0] += 0.51
        assert writer.flush_if_due()
        assert len(read_all(path)) == 3
        size = writer.bytes_written
        writer.flush()  # nothing new, nothing written
        assert writer.bytes_written == size
        for number in range(9):  # much at once does not wait for the time
            writer.write(handle, 4 + number, bytes(2**20))
        assert writer.topics['/shaft'] >= 11


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_sync_writes_the_same(tmp_path, storage):
    path = tmp_path / 'bag'
    with BagWriter(path, storage=storage, sync=True) as writer:
        handle = writer.add_topic('/shaft', POINT)
        for number in range(50):
            writer.write(handle, number, point(number))
            writer.flush()
    assert len(read_all(path)) == 50


def test_full_disk_keeps_the_bag_and_the_messages(tmp_path, monkeypatch):
    path = tmp_path / 'bag'
    writer = BagWriter(path, flush_interval=None)
    handle = writer.add_topic('/shaft', POINT)
    writer.write(handle, 1, point(1))
    writer.flush()
    writer.write(handle, 2, point(2))
    true_write = os.pwrite
    left = [0]

    def full_disk(descriptor, data, offset):
        if left[0] == 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        left[0] -= 1
        return true_write(descriptor, data, offset)

    for number in range(4):  # wherever within the flush it happens
        left[0] = number
        with monkeypatch.context() as patch:
            patch.setattr(os, 'pwrite', full_disk)
            with pytest.raises(BagError, match=r'bag_0.mcap: cannot be written: No space'):
                writer.flush()
        assert writer.message_count == 2
        with Reader(path) as reader:
            assert [t for _, t, _ in reader.messages()] == [1]
    writer.write(handle, 3, point(3))
    writer.close()
    assert [t for _, t, _ in read_all(path)] == [1, 2, 3]


def test_sqlite_keeps_messages_it_could_not_commit(tmp_path):
    path = tmp_path / 'bag'
    writer = BagWriter(path, storage='sqlite3', flush_interval=None)
    handle = writer.add_topic('/shaft', POINT)
    writer.write(handle, 1, point(1))
    writer._storage._database.execute('PRAGMA max_page_count = 12')
    for number in range(2000):
        writer.write(handle, 2 + number, point(number))
    with pytest.raises(BagError, match=r'bag_0.db3: cannot be written: .*full'):
        writer.flush()
    assert writer.message_count == 2001
    assert read_all(path) == []
    writer._storage._database.execute('PRAGMA max_page_count = 1000000')
    writer.close()
    assert len(read_all(path)) == 2001


@variants
@settings(
    max_examples=MANY, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    messages=st.lists(
        st.tuples(
            st.integers(0, 3),
            st.integers(0, 2**63 - 2),
            st.binary(min_size=1, max_size=5000),
            st.booleans(),
        ),
        max_size=60,
    ),
)
def test_any_messages_come_back(tmp_path_factory, storage, compression, messages):
    path = tmp_path_factory.mktemp('any') / 'bag'
    expected = []
    with BagWriter(path, storage=storage, compression=compression, flush_interval=None) as writer:
        handles = [writer.add_topic(f'/topic_{x}', POINT) for x in range(4)]
        for topic, time_ns, data, flush in messages:
            writer.write(handles[topic], time_ns, data)
            expected.append((f'/topic_{topic}', time_ns, data))
            if flush:
                writer.flush()
    assert sorted(read_all(path)) == sorted(expected)
