# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Bags whose recorder is killed, at any point of its work."""

from __future__ import annotations

import os
from pathlib import Path
import shutil
import signal
import sqlite3
import struct
import subprocess
import sys
import time

from cam_motion.io.bag import BagReader, BagWriter
from mcap.reader import make_reader
from mcap.records import Message
from mcap.stream_reader import StreamReader
import pytest
from rosbags.rosbag2 import Reader

pytestmark = pytest.mark.timeout(120)

POINT = 'trajectory_msgs/msg/JointTrajectoryPoint'
KILLS = int(os.environ.get('CAM_MOTION_TEST_KILLS', '4'))

# Writes as fast as it can, numbers and times every message, and prints how far it is.
RECORDER = """
import struct, sys, time
from cam_motion.io.bag import BagWriter
path, storage = sys.argv[1:3]
tail = bytes(56)
writer = BagWriter(path, storage=storage, flush_interval=0.25)
kind = 'trajectory_msgs/msg/JointTrajectoryPoint'
handles = [writer.add_topic(f'/axis_{x}', kind) for x in range(4)]
print('ready', flush=True)
number = 0
while True:
    for _ in range(20):
        writer.write(handles[number % 4], time.time_ns(), struct.pack('<Q', number) + tail)
        number += 1
    time.sleep(0.001)
"""


def numbers_by_summary(file: Path) -> list[int]:
    """Read the numbers in the messages of an mcap file by its summary."""
    with file.open('rb') as stream:
        reader = make_reader(stream, validate_crcs=True)
        found = [x.data for _, _, x in reader.iter_messages()]
        summary = reader.get_summary()
        # Without a chunk to look up, mcap reads from the start.
        if summary.chunk_indexes:
            assert summary.statistics.message_count == len(found)
        assert len(list(reader.iter_metadata())) == 1
    return [struct.unpack('<Q', x[:8])[0] for x in found]


def numbers_from_the_start(file: Path) -> list[int]:
    """Read the numbers in the messages of an mcap file from its start."""
    with file.open('rb') as stream:
        records = StreamReader(stream, validate_crcs=True).records
        found = [x.data for x in records if isinstance(x, Message)]
    return [struct.unpack('<Q', x[:8])[0] for x in found]


def numbers_by_rosbags(file: Path) -> list[int]:
    """Read the numbers in the messages of a bag or file by rosbags."""
    with Reader(file) as reader:
        return [struct.unpack('<Q', bytes(x[:8]))[0] for _, _, x in reader.messages()]


class Recording:
    """Every write to a file, in its order."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.steps: list[tuple[int, bytes | None]] = []
        self.flushed: list[tuple[int, int]] = []  # after how many steps: messages
        true_write, true_cut = os.pwrite, os.ftruncate

        def write(descriptor: int, data: bytes, offset: int) -> int:
            self.steps.append((offset, bytes(data)))
            return true_write(descriptor, data, offset)

        def cut(descriptor: int, size: int) -> None:
            self.steps.append((size, None))
            true_cut(descriptor, size)

        monkeypatch.setattr(os, 'pwrite', write)
        monkeypatch.setattr(os, 'ftruncate', cut)


@pytest.mark.parametrize('compression', [None, 'zstd'])
def test_mcap_is_whole_after_every_single_write(tmp_path, monkeypatch, compression):
    """Play every write again, page by page, as a kill may leave it; read at each point."""
    monkeypatch.setattr('cam_motion.io.bag.mcap_file._ROOM_MIN', 4096)
    monkeypatch.setattr('cam_motion.io.bag.mcap_file._ROOM_MAX', 8192)
    recording = Recording(monkeypatch)
    count = 0
    custom = {'text': 'x' * 300}
    with BagWriter(
        tmp_path / 'bag', compression=compression, flush_interval=None, custom_data=custom
    ) as writer:
        first = len(recording.steps)
        recording.flushed.append((first, 0))
        handles = []
        for flush in range(60):
            if flush % 12 == 0:
                handles.append(writer.add_topic(f'/topic_{flush}', POINT))
            for _ in range(flush * 7 % 50):
                data = struct.pack('<Q', count) + os.urandom(56)
                writer.write(handles[count % len(handles)], count, data)
                count += 1
            writer.flush()
            recording.flushed.append((len(recording.steps), count))
        recording.flushed.append((10**9, count))
    ends = [x for x in recording.steps if x[1] is None]
    assert len(ends) == 1, 'the file is cut once, at the end'
    grown = sum(1 for _, x in recording.steps if x and x.endswith(b'MCAP0\r\n'))
    assert grown >= 60 + 5, 'the room must have been used up several times'

    file = tmp_path / 'copy.mcap'
    checked = 0
    with file.open('w+b') as copy:
        for step, (offset, data) in enumerate(recording.steps):
            before = max(n for done, n in recording.flushed if done <= max(step, first))
            after = min(n for done, n in recording.flushed if done > step)
            for part_offset, part in pages(offset, data):
                if part is None:
                    copy.truncate(part_offset)
                else:
                    copy.seek(part_offset)
                    copy.write(part)
                copy.flush()
                if step < first - 1:
                    continue  # not yet a bag: no metadata.yaml names the file
                for read in (numbers_by_summary, numbers_from_the_start, numbers_by_rosbags):
                    found = read(file)
                    assert found in (list(range(before)), list(range(after))), (step, read)
                    checked += 1
        assert numbers_by_summary(file) == list(range(count))
    assert checked > 900


def pages(offset: int, data: bytes | None) -> list[tuple[int, bytes | None]]:
    """Divide a write into those of its pages, some pages of a large one taken together."""
    if data is None:
        return [(offset, None)]
    cuts = list(range(-(-(offset + 1) // 4096) * 4096, offset + len(data), 4096))
    if len(cuts) > 3:
        cuts = [cuts[0], cuts[len(cuts) // 2], cuts[-1]]
    places = [offset, *cuts, offset + len(data)]
    return [
        (start, data[start - offset:stop - offset])
        for start, stop in zip(places, places[1:], strict=False)
    ]


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
@pytest.mark.parametrize('attempt', range(KILLS))
def test_killed_recorder_leaves_a_bag(tmp_path, storage, attempt):
    path = tmp_path / 'bag'
    with subprocess.Popen(
        [sys.executable, '-c', RECORDER, str(path), storage], stdout=subprocess.PIPE
    ) as process:
        try:
            assert process.stdout.readline() == b'ready\n'
            time.sleep(0.9 + 0.137 * attempt)
        finally:
            os.kill(process.pid, signal.SIGKILL)
            killed_ns = time.time_ns()
            process.wait()
    assert process.returncode == -signal.SIGKILL
    undo_half_commit(path)
    with Reader(path) as reader:
        entries = [(t, bytes(x)) for _, t, x in reader.messages()]
        # metadata.yaml follows the storage file.
        assert 0 < reader.message_count <= len(entries)
    assert [struct.unpack('<Q', x[:8])[0] for _, x in entries] == list(range(len(entries)))
    assert killed_ns - entries[-1][0] < 1_000_000_000
    with BagReader(path) as own:
        assert [(t, x) for _, t, x in own.messages()] == entries
        assert sum(x.count for x in own.topics.values()) == len(entries)
    for file in path.glob('*.mcap'):
        assert numbers_by_summary(file) == list(range(len(entries)))
        # Killed between the two decisive writes, the file shows the chunk to this one only.
        assert len(numbers_from_the_start(file)) >= len(entries)


def undo_half_commit(path: Path) -> None:
    """Let SQLite undo a commit that the kill hit, which happens in one kill of many."""
    for journal in path.glob('*-journal'):
        with BagReader(path) as reader:
            assert reader.incomplete
        database = sqlite3.connect(str(journal).removesuffix('-journal'))
        database.execute('SELECT count(*) FROM messages').fetchone()
        database.close()


def test_half_commit_is_undone_in_a_copy(tmp_path):
    path = tmp_path / 'bag'
    with BagWriter(path, storage='sqlite3', flush_interval=None) as writer:
        handle = writer.add_topic('/shaft', POINT)
        for number in range(500):
            writer.write(handle, number, struct.pack('<Q', number) + bytes(56))
    # What a kill within a commit leaves: new pages in the file, old ones in the journal.
    file = path / 'bag_0.db3'
    database = sqlite3.connect(file, isolation_level=None)
    database.execute('PRAGMA synchronous = OFF')
    database.execute('PRAGMA cache_size = 5')
    database.execute('BEGIN')
    database.execute('DELETE FROM messages WHERE id > 10')
    left = tmp_path / 'left'
    shutil.copytree(path, left)
    database.rollback()
    database.close()
    assert (left / 'bag_0.db3-journal').stat().st_size > 512
    with BagReader(left) as reader:
        assert reader.incomplete
        found = [struct.unpack('<Q', x[:8])[0] for _, _, x in reader.messages()]
        assert reader.topics['/shaft'].count == 500
    assert found == list(range(500))
    assert (left / 'bag_0.db3-journal').exists(), 'the bag itself must stay as it is'


@pytest.mark.slow
def test_flushes_cost_the_same_after_an_hour(tmp_path):
    """An hour of flushes: the summary grows to a megabyte, the flushes stay small."""
    path = tmp_path / 'bag'
    writer = BagWriter(path, flush_interval=None)
    handles = [writer.add_topic(f'/axis_{x}', POINT) for x in range(9)]
    written = []
    true_write = os.pwrite
    total = 0

    def count(descriptor: int, data: bytes, offset: int) -> int:
        nonlocal total
        total += len(data)
        return true_write(descriptor, data, offset)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, 'pwrite', count)
        for flush in range(7_200):
            for handle in handles:
                writer.write(handle, flush, bytes(64))
            total = 0
            writer.flush()
            written.append(total)
    writer.close()
    written.sort()
    # A chunk with its indexes and both summaries; moves of the end block are few.
    assert written[len(written) // 2] < 16_000
    assert sum(written) / len(written) < 40_000
    with Reader(path) as reader:
        assert reader.message_count == 9 * 7_200
