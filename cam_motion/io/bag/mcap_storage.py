# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Messages to chunks of an MCAP file."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from pathlib import Path
import struct
import zlib

from cam_motion.io.bag.mcap_file import McapFile
from cam_motion.io.bag.mcap_records import MAGIC, message_index, metadata_record, record_bytes
from cam_motion.io.bag.metadata import render
from cam_motion.io.bag.qos import qos_text
from cam_motion.io.bag.summary import Summary, Topic
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, ChunkIndex, Header, Schema, Statistics
import zstandard

# Opcode, length, channel, sequence, log time, publish time. Packed here, not by mcap's Message:
# this runs for every message. Unsigned times, so that a negative one is refused.
_pack_message = struct.Struct('<BQHIQQ').pack
_MESSAGE = int(Opcode.MESSAGE)
_MESSAGE_SIZE = 2 + 4 + 8 + 8


class McapStorage:
    """
    Collect messages, and add them to the file as one chunk per flush.

    Parameters
    ----------
    path : Path
        The file; must not exist.
    summary : Summary
        What the bag holds; kept true to the file.
    compression : str or None
        ``zstd`` or None.
    sync : bool
        True to wait for the disk.

    Raises
    ------
    BagError
        If the file exists or cannot be written.

    """

    def __init__(self, path: Path, summary: Summary, compression: str | None, sync: bool) -> None:
        """Create the file."""
        self._summary = summary
        self._buffer = bytearray()
        self._indexes: dict[int, array[int]] = {}
        self._schemas: dict[str, Schema] = {}
        self._channels: list[Channel] = []
        self._chunks = 0
        self._dirty = False
        self._compress: Callable[[bytes], bytes] | None = None
        if compression == 'zstd':
            self._compress = zstandard.ZstdCompressor(level=1).compress
        head = MAGIC + record_bytes(Header('ros2', 'cam_motion'))
        statistics, metadata = self._statistics(), metadata_record(render(summary))
        self._file = McapFile(path, head, statistics, metadata, sync)

    @property
    def pending(self) -> int:
        """Messages that wait for the next flush."""
        return sum(len(index) for index in self._indexes.values()) // 2

    @property
    def size(self) -> int:
        """Bytes of the file in use."""
        return self._file.data_end

    def add_topic(self, topic: Topic) -> None:
        """
        Add a topic; it reaches the file with the next flush.

        Parameters
        ----------
        topic : Topic
            The topic.

        """
        schema = self._schemas.get(topic.type_name)
        if schema is None:
            schema = Schema(
                id=len(self._schemas) + 1,
                data=topic.definition.encode(),
                encoding=topic.encoding,
                name=topic.type_name,
            )
            self._schemas[topic.type_name] = schema
            self._buffer += record_bytes(schema)
        channel = Channel(
            id=topic.handle,
            topic=topic.name,
            message_encoding='cdr',
            metadata={
                'offered_qos_profiles': qos_text(topic.qos_profiles),
                'topic_type_hash': topic.type_hash,
            },
            schema_id=schema.id,
        )
        self._channels.append(channel)
        self._buffer += record_bytes(channel)
        self._indexes[topic.handle] = array('q')
        self._file.set_topics(
            record_bytes(*self._schemas.values()), record_bytes(*self._channels)
        )
        self._dirty = True

    def write(self, handle: int, timestamp_ns: int, publish_time_ns: int, data: bytes) -> int:
        """
        Keep one message for the next flush.

        Parameters
        ----------
        handle : int
            The topic.
        timestamp_ns, publish_time_ns : int
            Times [ns], from 0 to 2**63 - 1.
        data : bytes
            The serialised message.

        Returns
        -------
        int
            Bytes that wait for the next flush.

        Raises
        ------
        KeyError, OverflowError, TypeError, ValueError, struct.error
            If the topic is unknown, or a value is none of the above; nothing is kept then.

        """
        if not data:
            raise ValueError('the message is empty')  # mcap's reader would stop at it
        record = (
            _pack_message(
                _MESSAGE, len(data) + _MESSAGE_SIZE, handle, 0, timestamp_ns, publish_time_ns
            )
            + data
        )
        buffer = self._buffer
        index = self._indexes[handle]
        index.append(timestamp_ns)
        index.append(len(buffer))
        buffer += record
        return len(buffer)

    def flush(self) -> str | None:
        """
        Add what waits to the file.

        Returns
        -------
        str or None
            The metadata as written; None if there was nothing to write.

        Raises
        ------
        BagError
            If the disk is full or fails; the messages then wait on.

        """
        indexes = {handle: index for handle, index in self._indexes.items() if index}
        if not indexes and not self._dirty:
            return None
        summary = self._summary
        span = summary.start_ns, summary.end_ns
        chunk = index = b''
        if indexes:
            times = [(min(x[::2]), max(x[::2])) for x in indexes.values()]
            start, end = min(x[0] for x in times), max(x[1] for x in times)
            chunk, index = self._chunk(indexes, start, end)
            summary.cover(start, end)
        self._count(indexes, 1)
        try:
            text = render(summary)
            self._file.update(chunk, index, self._statistics(), metadata_record(text))
        except BaseException:
            self._count(indexes, -1)
            summary.start_ns, summary.end_ns = span
            raise
        if indexes:
            self._buffer.clear()
            for used in indexes.values():
                del used[:]
        self._dirty = False
        return text

    def touch(self) -> None:
        """Let the next flush write the metadata even without messages."""
        self._dirty = True

    def close(self) -> None:
        """
        Finish the file; what waits is lost unless flushed before.

        Raises
        ------
        BagError
            If the disk is full or fails; the file then stays as the last flush left it.

        """
        self._file.close()

    def _count(self, indexes: dict[int, array[int]], sign: int) -> None:
        """Add the chunk with these indexes to the counts, or take it off again."""
        self._chunks += sign * bool(indexes)
        for topic in self._summary.topics:
            topic.count += sign * (len(indexes.get(topic.handle, ())) // 2)

    def _chunk(
        self, indexes: dict[int, array[int]], start_ns: int, end_ns: int
    ) -> tuple[bytes, bytes]:
        """Write what waits as a chunk with its message indexes, and its chunk index."""
        records = bytes(self._buffer)
        stored = self._compress(records) if self._compress else records
        compression = 'zstd' if self._compress else ''
        chunk = record_bytes(
            Chunk(compression, stored, end_ns, start_ns, zlib.crc32(records), len(records))
        )
        offset = self._file.data_end
        parts = [chunk]
        offsets = {}
        place = offset + len(chunk)
        for handle, index in indexes.items():
            # Not by mcap's MessageIndex, which takes 1.5 µs per message.
            part = message_index(handle, index)
            parts.append(part)
            offsets[handle] = place
            place += len(part)
        chunk_index = ChunkIndex(
            chunk_length=len(chunk),
            chunk_start_offset=offset,
            compression=compression,
            compressed_size=len(stored),
            message_end_time=end_ns,
            message_index_length=place - offset - len(chunk),
            message_index_offsets=offsets,
            message_start_time=start_ns,
            uncompressed_size=len(records),
        )
        return b''.join(parts), record_bytes(chunk_index)

    def _statistics(self) -> bytes:
        """Write the statistics record."""
        summary = self._summary
        return record_bytes(
            Statistics(
                attachment_count=0,
                channel_count=len(self._channels),
                channel_message_counts={x.handle: x.count for x in summary.topics if x.count},
                chunk_count=self._chunks,
                message_count=summary.count,
                message_end_time=summary.end_ns,
                message_start_time=summary.start_ns if summary.count else 0,
                metadata_count=1,
                schema_count=len(self._schemas),
            )
        )
