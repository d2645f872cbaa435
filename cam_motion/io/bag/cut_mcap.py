# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Read an MCAP file that its recorder did not finish: all that stands before the cut."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from io import BytesIO
from pathlib import Path
import struct
from typing import BinaryIO, NamedTuple

from cam_motion.io.bag.error import BagError
from cam_motion.io.bag.mcap_records import HEAD, MAGIC, METADATA_NAME
import lz4.frame
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, Schema
import zstandard

_CHUNK_HEAD = struct.Struct('<QQQII')
_MESSAGE_HEAD = struct.Struct('<HIQQ')


class Message(NamedTuple):
    """A message: its channel, its time [ns], its bytes."""

    channel: int
    time_ns: int
    data: bytes


def is_cut(path: Path) -> bool:
    """
    Tell whether an MCAP file lacks its end.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    bool
        True if it does.

    Raises
    ------
    BagError
        If it is no MCAP file at all.

    """
    with path.open('rb') as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise BagError(f'{path}: no MCAP file: it starts otherwise (is it another format?)')
        size = file.seek(0, 2)
        file.seek(max(len(MAGIC), size - len(MAGIC)))
        return file.read() != MAGIC


class CutMcap:
    """
    The readable part of a cut file.

    Parameters
    ----------
    path : Path
        The file.

    Attributes
    ----------
    schemas, channels : dict
        Records by their number.
    counts : Counter of int
        Messages per channel.
    metadata : str
        The last metadata of rosbag2 in the file; empty if there is none.

    """

    def __init__(self, path: Path) -> None:
        """Read the file once for what it holds."""
        self._path = path
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self.counts: Counter[int] = Counter()
        self.metadata = ''
        for message in self._scan():
            self.counts[message.channel] += 1

    def messages(self, channels: Collection[int]) -> Iterator[Message]:
        """
        Read messages in the order of the file.

        Parameters
        ----------
        channels : collection of int
            Numbers of the channels wanted.

        Yields
        ------
        Message
            Each message up to the cut.

        """
        return (message for message in self._scan() if message.channel in channels)

    def _scan(self) -> Iterator[Message]:
        """Read all records up to the cut; keep the describing ones, yield the messages."""
        with self._path.open('rb') as file:
            file.seek(len(MAGIC))
            for opcode, content in _records(file):
                if opcode == Opcode.CHUNK:
                    for inner_opcode, inner in _records(BytesIO(_unpack(content))):
                        yield from self._take(inner_opcode, inner)
                    continue
                if opcode == Opcode.DATA_END:
                    return
                yield from self._take(opcode, content)

    def _take(self, opcode: int, content: bytes) -> Iterator[Message]:
        """Keep or yield one record."""
        if opcode == Opcode.MESSAGE and len(content) >= _MESSAGE_HEAD.size:
            channel, _, time_ns, _ = _MESSAGE_HEAD.unpack_from(content)
            if channel in self.channels:
                yield Message(channel, time_ns, content[_MESSAGE_HEAD.size:])
            return
        stream = ReadDataStream(BytesIO(content))
        try:
            if opcode == Opcode.SCHEMA:
                schema = Schema.read(stream)
                self.schemas[schema.id] = schema
            elif opcode == Opcode.CHANNEL:
                channel_record = Channel.read(stream)
                self.channels[channel_record.id] = channel_record
            elif opcode == Opcode.METADATA:
                metadata = Metadata.read(stream)
                if metadata.name == METADATA_NAME:
                    self.metadata = metadata.metadata.get('serialized_metadata', '')
        except (McapError, ValueError, struct.error) as error:
            raise BagError(f'{self._path}: damaged within a record: {error}') from error


def _records(file: BinaryIO) -> Iterator[tuple[int, bytes]]:
    """Read whole records; of a chunk that is cut, what there is."""
    while len(head := file.read(HEAD.size)) == HEAD.size:
        opcode, length = HEAD.unpack(head)
        # Not at once: the length of a damaged record may be anything.
        content = file.read(min(length, 2**40))
        if len(content) < length and opcode != Opcode.CHUNK:
            return
        yield opcode, content


def _unpack(content: bytes) -> bytes:
    """Decompress the records of a chunk, as far as it goes."""
    if len(content) < _CHUNK_HEAD.size:
        return b''
    *_, name_size = _CHUNK_HEAD.unpack_from(content)
    start = _CHUNK_HEAD.size + name_size
    compression = content[_CHUNK_HEAD.size:start]
    stored = content[start + 8:]
    try:
        if compression == b'zstd':
            return zstandard.ZstdDecompressor().decompressobj().decompress(stored)
        if compression == b'lz4':
            unpacked: bytes = lz4.frame.LZ4FrameDecompressor().decompress(stored)
            return unpacked
    except (zstandard.ZstdError, RuntimeError, EOFError):
        return b''
    return stored if not compression else b''
