# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Messages to an SQLite file with rosbag2's schema, version 4."""

from __future__ import annotations

from operator import index
import os
from pathlib import Path
import sqlite3

from cam_motion.io.bag.error import BagError
from cam_motion.io.bag.metadata import render, VERSION
from cam_motion.io.bag.qos import qos_text
from cam_motion.io.bag.summary import Summary, Topic

# Names and columns are rosbag2's.
_SCHEMA = """
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata(
    id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics(
    id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
    serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL,
    type_description_hash TEXT NOT NULL);
CREATE TABLE message_definitions(
    id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
    encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE messages(
    id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
    data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);
"""


class SqliteStorage:
    """
    Collect messages, and add them to the file in one transaction per flush.

    No write-ahead log: a reader that takes the file for unchanging, as rosbags does, would not
    see what is in the log. The rollback journal instead exists only during a commit; killed just
    then, the process leaves it behind, and any SQLite that may write undoes the half commit.

    Parameters
    ----------
    path : Path
        The file; must not exist.
    summary : Summary
        What the bag holds; kept true to the file.
    sync : bool
        True to wait for the disk at each commit.

    Raises
    ------
    BagError
        If the file exists or cannot be written.

    """

    def __init__(self, path: Path, summary: Summary, sync: bool) -> None:
        """Create the file."""
        self._path = path
        self._summary = summary
        self._topics: dict[int, Topic] = {}
        self._new_topics: list[Topic] = []
        self._types: set[str] = set()
        self._rows: list[tuple[int, int, bytes]] = []
        self._bytes = 0
        self._dirty = False
        if path.exists():
            raise BagError(f'{path}: exists already, and is not overwritten')
        try:
            self._database = sqlite3.connect(path, isolation_level=None)
            self._database.execute('PRAGMA journal_mode = DELETE')
            self._database.execute(f'PRAGMA synchronous = {"FULL" if sync else "OFF"}')
            # No page reaches the file before the commit: 64 MiB of room.
            self._database.execute('PRAGMA cache_size = -65536')
            self._database.executescript(f'BEGIN; {_SCHEMA} COMMIT;')
            self._database.execute(
                'INSERT INTO schema VALUES (4, ?)', (os.environ.get('ROS_DISTRO', 'jazzy'),)
            )
        except sqlite3.Error as error:
            raise BagError(f'{path}: cannot be created: {error}') from error

    @property
    def pending(self) -> int:
        """Messages that wait for the next flush."""
        return len(self._rows)

    @property
    def size(self) -> int:
        """Bytes of the file."""
        return self._path.stat().st_size

    def add_topic(self, topic: Topic) -> None:
        """
        Add a topic; it reaches the file with the next flush.

        Parameters
        ----------
        topic : Topic
            The topic.

        """
        self._topics[topic.handle] = topic
        self._new_topics.append(topic)

    def write(self, handle: int, timestamp_ns: int, publish_time_ns: int, data: bytes) -> int:
        """
        Keep one message for the next flush.

        Parameters
        ----------
        handle : int
            The topic.
        timestamp_ns : int
            Time [ns], from 0 to 2**63 - 1.
        publish_time_ns : int
            Not kept: this version of the schema has no place for it.
        data : bytes
            The serialised message.

        Returns
        -------
        int
            Bytes that wait for the next flush.

        Raises
        ------
        KeyError, OverflowError, TypeError, ValueError
            If the topic is unknown, or a value is none of the above; nothing is kept then.

        """
        self._topics[handle]
        time_ns = index(timestamp_ns)
        if not 0 <= time_ns < 2**63:
            raise OverflowError('the time is out of range')
        if not data:
            raise ValueError('the message is empty')
        # A copy, should the caller use the memory again.
        self._rows.append((handle, time_ns, bytes(memoryview(data))))
        self._bytes += len(data)
        return self._bytes

    def flush(self) -> str | None:
        """
        Commit what waits.

        Returns
        -------
        str or None
            The metadata as written; None if there was nothing to write.

        Raises
        ------
        BagError
            If the disk is full or fails; the messages then wait on.

        """
        if not (self._rows or self._new_topics or self._dirty):
            return None
        summary = self._summary
        span = summary.start_ns, summary.end_ns
        self._count(1)
        if self._rows:
            times = [row[1] for row in self._rows]
            summary.cover(min(times), max(times))
        try:
            text = render(summary)
            self._commit(text)
        except BaseException as error:
            self._count(-1)
            summary.start_ns, summary.end_ns = span
            if self._database.in_transaction:
                self._database.rollback()
            if isinstance(error, sqlite3.Error):
                raise BagError(
                    f'{self._path}: cannot be written: {error} (it is whole up to the last flush)'
                ) from error
            raise
        self._types.update(topic.type_name for topic in self._new_topics)
        self._new_topics.clear()
        self._rows.clear()
        self._bytes = 0
        self._dirty = False
        return text

    def touch(self) -> None:
        """Let the next flush write the metadata even without messages."""
        self._dirty = True

    def close(self) -> None:
        """
        Close the file; what waits is lost unless flushed before.

        Raises
        ------
        BagError
            If the file cannot be closed.

        """
        try:
            self._database.close()
        except sqlite3.Error as error:
            raise BagError(f'{self._path}: cannot be closed: {error}') from error

    def _count(self, sign: int) -> None:
        """Add the waiting messages to the counts, or take them off again."""
        topics = self._topics
        for row in self._rows:
            topics[row[0]].count += sign

    def _commit(self, text: str) -> None:
        """Write topics, messages and metadata in one transaction."""
        execute = self._database.execute
        execute('BEGIN')
        types = set(self._types)
        for topic in self._new_topics:
            execute(
                'INSERT INTO topics VALUES (?, ?, ?, ?, ?, ?)',
                (
                    topic.handle,
                    topic.name,
                    topic.type_name,
                    'cdr',
                    qos_text(topic.qos_profiles),
                    topic.type_hash,
                ),
            )
            if topic.type_name not in types:
                types.add(topic.type_name)
                execute(
                    'INSERT INTO message_definitions (topic_type, encoding, '
                    'encoded_message_definition, type_description_hash) VALUES (?, ?, ?, ?)',
                    (topic.type_name, topic.encoding, topic.definition, topic.type_hash),
                )
        self._database.executemany(
            'INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)', self._rows
        )
        execute('INSERT OR REPLACE INTO metadata VALUES (1, ?, ?)', (VERSION, text))
        execute('COMMIT')
