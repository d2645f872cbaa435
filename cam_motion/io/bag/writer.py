# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Write a bag that can be read at any moment."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
import struct
from time import monotonic
from types import TracebackType
from typing import Literal

from cam_motion.io.bag.checks import (
    check_arguments,
    check_custom_data,
    make_directory,
    refusal,
    SUFFIXES,
)
from cam_motion.io.bag.definitions import describe
from cam_motion.io.bag.error import BagError
from cam_motion.io.bag.mcap_storage import McapStorage
from cam_motion.io.bag.metadata import render, sync_directory, write_atomically
from cam_motion.io.bag.qos import QosProfile
from cam_motion.io.bag.sqlite_storage import SqliteStorage
from cam_motion.io.bag.summary import find_topic, Summary, Topic

# Flush earlier than by time, to keep memory and chunks small [B].
_PENDING_MAX = 8 * 1024 * 1024

_LAST_CHANNEL = 2**16 - 1


class BagWriter:
    """
    Write a rosbag2 bag; after every flush its directory is a complete, valid bag.

    A process that is killed loses what it wrote since the last flush, nothing else. Not safe
    for use by several threads at once.

    Parameters
    ----------
    path : Path or str
        Directory of the bag; must not exist, its parents are made.
    storage : {'mcap', 'sqlite3'}
        Kind of the storage file.
    compression : {None, 'zstd'}
        Compression of the chunks of an mcap file.
    flush_interval : float or None
        Time after which a write also flushes [s], above 0 up to 1.0; None to leave it to the
        caller. Messages that arrive before a silence wait for `flush_if_due`.
    custom_data : mapping of str to str or None
        Entries of the user, kept in metadata.yaml.
    sync : bool
        True to wait for the disk at each flush, against power loss; slow.

    Raises
    ------
    BagError
        If the directory exists or cannot be made, or an argument breaks its rule.

    """

    def __init__(
        self,
        path: Path | str,
        *,
        storage: Literal['mcap', 'sqlite3'] = 'mcap',
        compression: Literal['zstd'] | None = None,
        flush_interval: float | None = 0.5,
        custom_data: Mapping[str, str] | None = None,
        sync: bool = False,
    ) -> None:
        """Create the bag, valid and empty."""
        self.path = Path(path).absolute()
        self._sync = sync
        self._closed = False
        check_arguments(self.path, storage, compression, flush_interval)
        entries = check_custom_data(custom_data, self.path)
        make_directory(self.path)
        file = self.path / f'{self.path.name}_0{SUFFIXES[storage]}'
        self._summary = Summary(storage, file.name, custom_data=entries)
        self._storage: McapStorage | SqliteStorage
        if storage == 'mcap':
            self._storage = McapStorage(file, self._summary, compression, sync)
        else:
            self._storage = SqliteStorage(file, self._summary, sync)
        self._interval = float('inf') if flush_interval is None else flush_interval
        self._due = monotonic() + self._interval
        write_atomically(self.path, render(self._summary), sync)
        if sync:
            sync_directory(self.path.parent)

    @property
    def message_count(self) -> int:
        """Messages written so far, those that wait for the next flush included."""
        return self._summary.count + self._storage.pending

    @property
    def bytes_written(self) -> int:
        """Bytes of the storage file in use."""
        return self._storage.size

    @property
    def topics(self) -> dict[str, int]:
        """Count the messages in the file per topic name, those that wait not included."""
        return {topic.name: topic.count for topic in self._summary.topics}

    def add_topic(
        self,
        name: str,
        type_name: str,
        qos_profiles: Iterable[QosProfile] = (),
        *,
        definition: str | None = None,
        type_hash: str | None = None,
    ) -> int:
        """
        Add a topic.

        Parameters
        ----------
        name : str
            Topic name, such as ``/feeder/setpoint``.
        type_name : str
            Such as ``trajectory_msgs/msg/JointTrajectoryPoint``.
        qos_profiles : iterable of QosProfile
            Profiles offered by its publishers.
        definition : str or None
            Definition text with dependencies, for types that Jazzy does not bring.
        type_hash : str or None
            RIHS01 hash; None to compute it.

        Returns
        -------
        int
            Handle for `write`.

        Raises
        ------
        BagError
            If the topic is there already, or the type is unknown and not defined.

        """
        self._check_open()
        if not name or find_topic(self._summary.topics, name):
            raise BagError(
                f'{self.path}: topic {name!r}: names must not be empty nor occur twice '
                '(keep the handle of the first add_topic)'
            )
        handle = len(self._summary.topics) + 1
        if handle > _LAST_CHANNEL:
            raise BagError(f'{self.path}: topic {name!r}: a bag holds {_LAST_CHANNEL} topics')
        text, encoding, found_hash = describe(type_name, definition, type_hash)
        profiles = tuple(qos_profiles)
        topic = Topic(handle, name, type_name, text, encoding, found_hash, profiles)
        self._storage.add_topic(topic)
        self._summary.topics.append(topic)
        return handle

    def write(
        self, handle: int, timestamp_ns: int, data: bytes, publish_time_ns: int | None = None
    ) -> None:
        """
        Write one message, and flush if it is time.

        Parameters
        ----------
        handle : int
            What `add_topic` gave.
        timestamp_ns : int
            Time of reception [ns since the epoch of the clock in use].
        data : bytes
            The message, serialised (CDR with its header).
        publish_time_ns : int or None
            Time of publication [ns]; None for the time of reception. Kept by mcap only.

        Raises
        ------
        BagError
            If the handle is unknown, a time is out of range, the message is empty, or the file
            cannot be written (its messages then wait for the next flush).

        """
        try:
            pending = self._storage.write(
                handle,
                timestamp_ns,
                timestamp_ns if publish_time_ns is None else publish_time_ns,
                data,
            )
        except (KeyError, OverflowError, TypeError, ValueError, struct.error) as error:
            raise refusal(self.path, handle, timestamp_ns, error) from error
        if monotonic() >= self._due or pending > _PENDING_MAX:
            self.flush()

    def flush_if_due(self) -> bool:
        """
        Flush if the flush interval has passed; to be called now and then during silences.

        Returns
        -------
        bool
            True if it flushed.

        Raises
        ------
        BagError
            If the file cannot be written.

        """
        if monotonic() < self._due:
            return False
        self.flush()
        return True

    def flush(self) -> None:
        """
        Make all messages so far safe and readable.

        Raises
        ------
        BagError
            If a file cannot be written; the bag stays valid as of the last flush, and the
            messages wait for the next one.

        """
        self._check_open()
        # First, so that a full disk is not tried again with every single message.
        self._due = monotonic() + self._interval
        text = self._storage.flush()
        if text is not None:
            write_atomically(self.path, text, self._sync)

    def set_custom_data(self, key: str, value: str) -> None:
        """
        Set an entry of the user; it reaches the bag with the next flush.

        Parameters
        ----------
        key, value : str
            The entry.

        Raises
        ------
        BagError
            If one is no text.

        """
        self._summary.custom_data.update(check_custom_data({key: value}, self.path))
        self._storage.touch()

    def close(self) -> None:
        """
        Flush and finish the bag; further calls do nothing.

        Raises
        ------
        BagError
            If a file cannot be written; the bag stays valid as of the last flush.

        """
        if self._closed:
            return
        try:
            self.flush()
        finally:
            self._closed = True
            self._due = 0.0  # lets a late write reach flush, which refuses
            self._storage.close()

    def __enter__(self) -> BagWriter:
        """Give the writer itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Close the bag, also after an error: what was recorded is kept."""
        self.close()

    def _check_open(self) -> None:
        """Refuse work after close."""
        if self._closed:
            raise BagError(f'{self.path}: closed already (write before close)')
