# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Storage files of a bag, each behind the same few methods."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from pathlib import Path
import shutil
import sqlite3
from typing import Protocol
from urllib.parse import quote

from cam_motion.io.bag.cut_mcap import CutMcap, is_cut
from cam_motion.io.bag.error import BagError
from cam_motion.io.bag.mcap_records import METADATA_NAME
from cam_motion.io.bag.topic_info import (
    convert_connection,
    convert_profiles,
    custom_data_in,
    TopicInfo,
    type_hashes_in,
)
from mcap.reader import make_reader
from rosbags.rosbag2 import Reader
from rosbags.rosbag2.metadata import parse_qos

Entry = tuple[str, int, bytes]


class Source(Protocol):
    """
    One storage file, or one directory.

    Attributes
    ----------
    topics : dict of str to TopicInfo
        Its topics.
    custom_data : dict of str to str
        The user's entries found in it.

    """

    topics: dict[str, TopicInfo]
    custom_data: dict[str, str]

    def messages(self, topics: Collection[str]) -> Iterator[Entry]:
        """Yield topic, time [ns] and bytes of each message on these topics."""

    def close(self) -> None:
        """Close the file."""


class WholeSource:
    """
    A storage file or a directory that rosbags reads; messages come in the order of time.

    Parameters
    ----------
    path : Path
        The file or directory.

    Raises
    ------
    BagError
        If it cannot be read.

    """

    def __init__(self, path: Path) -> None:
        """Open the file."""
        self._path = path
        try:
            self._reader = Reader(path)
            self._reader.open()
        except Exception as error:  # rosbags lets through whatever a damaged file causes
            raise BagError(f'{path}: cannot be read as a bag: {error}') from error
        metadata = _stored_metadata(path)
        hashes = type_hashes_in(metadata)  # of an mcap file, rosbags gives none
        self.topics: dict[str, TopicInfo] = {}
        for connection in self._reader.connections:
            name = connection.topic
            info = convert_connection(connection, self.topics.get(name))
            self.topics[name] = replace(info, type_hash=info.type_hash or hashes.get(name, ''))
        self.custom_data = custom_data_in(metadata)

    def messages(self, topics: Collection[str]) -> Iterator[Entry]:
        """Yield topic, time [ns] and bytes of each message on these topics."""
        wanted = [x for x in self._reader.connections if x.topic in topics]
        if not wanted:
            return
        try:
            for connection, time_ns, data in self._reader.messages(wanted):
                yield connection.topic, time_ns, bytes(data)
        except Exception as error:  # as above
            raise BagError(f'{self._path}: damaged: {error}') from error

    def close(self) -> None:
        """Close the file."""
        self._reader.close()


class CutSource:
    """
    A cut MCAP file; messages come in the order of the file.

    Parameters
    ----------
    path : Path
        The file.

    """

    def __init__(self, path: Path) -> None:
        """Read the file once."""
        self._file = CutMcap(path)
        self.topics: dict[str, TopicInfo] = {}
        for channel in self._file.channels.values():
            schema = self._file.schemas.get(channel.schema_id)
            before = self.topics.get(channel.topic)
            self.topics[channel.topic] = TopicInfo(
                type_name=schema.name if schema else '',
                count=self._file.counts[channel.id] + (before.count if before else 0),
                qos_profiles=convert_profiles(
                    parse_qos(channel.metadata.get('offered_qos_profiles', ''))
                ),
                type_hash=channel.metadata.get('topic_type_hash', ''),
                definition=schema.data.decode() if schema else '',
                encoding=schema.encoding if schema else '',
            )
        self.custom_data = custom_data_in(self._file.metadata)

    def messages(self, topics: Collection[str]) -> Iterator[Entry]:
        """Yield topic, time [ns] and bytes of each message on these topics."""
        names = {x.id: x.topic for x in self._file.channels.values() if x.topic in topics}
        for message in self._file.messages(names):
            yield names[message.channel], message.time_ns, message.data

    def close(self) -> None:
        """Do nothing: the file is open only while it is read."""


def open_file(path: Path, scratch: Path) -> tuple[Source, bool]:
    """
    Open one storage file.

    Parameters
    ----------
    path : Path
        An ``.mcap`` or ``.db3`` file.
    scratch : Path
        Directory for a copy, if the file must be repaired first; never in place.

    Returns
    -------
    tuple of (Source, bool)
        The file, and whether it is incomplete: cut, or left within a commit.

    Raises
    ------
    BagError
        If it cannot be read.

    """
    if not path.is_file():
        raise BagError(f'{path}: no such file (was the bag moved without it?)')
    if path.suffix == '.mcap':
        if is_cut(path):
            return CutSource(path), True
        return WholeSource(path), False
    beside = [path.with_name(path.name + suffix) for suffix in ('-journal', '-wal')]
    beside = [file for file in beside if file.is_file() and file.stat().st_size]
    if not beside:
        return WholeSource(path), False
    # rosbags reads the file alone; SQLite settles a copy of it with what its recorder left.
    scratch.mkdir(exist_ok=True)
    for file in (path, *beside):
        shutil.copy(file, scratch)
    copy = scratch / path.name
    try:
        database = sqlite3.connect(copy)
        database.execute('PRAGMA journal_mode = DELETE')
        database.execute('SELECT count(*) FROM topics').fetchone()
        database.close()
    except sqlite3.Error as error:
        raise BagError(f'{path}: cannot be repaired: {error}') from error
    return WholeSource(copy), True


def _stored_metadata(path: Path) -> str:
    """Find the copy of metadata.yaml within a storage file; empty if there is none."""
    if path.suffix == '.mcap':
        with path.open('rb') as file:
            for record in make_reader(file).iter_metadata():
                if record.name == METADATA_NAME:
                    return record.metadata.get('serialized_metadata', '')
    elif path.suffix == '.db3':
        database = sqlite3.connect(f'file:{quote(str(path))}?mode=ro&immutable=1', uri=True)
        try:
            row = database.execute('SELECT metadata FROM metadata ORDER BY id DESC').fetchone()
        except sqlite3.Error:  # schemas before version 3 have no such table
            return ''
        finally:
            database.close()
        return str(row[0]) if row else ''
    return ''
