# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Pieces of an MCAP file that mcap's own writer keeps to itself."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
import struct
import sys
from typing import Any
import zlib

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import DataEnd, Footer, McapRecord, Metadata, MetadataIndex, SummaryOffset

MAGIC = b'\x89MCAP0\r\n'

#: Opcodes from 0x80 on are free for applications; readers skip those they do not know.
FILLER = 0x80

#: Name under which rosbag2 looks for its metadata in the file.
METADATA_NAME = 'rosbag2'

#: Opcode and length of any record.
HEAD = struct.Struct('<BQ')

_INDEX_HEAD = struct.Struct('<BQHI')

DATA_END_SIZE = HEAD.size + 4
_FOOTER_SIZE = HEAD.size + 20

#: Size of data end, footer and magic together [B].
END_SIZE = DATA_END_SIZE + _FOOTER_SIZE + len(MAGIC)


def record_bytes(*records: McapRecord) -> bytes:
    """
    Write records one after the other.

    Parameters
    ----------
    records : McapRecord
        The records.

    Returns
    -------
    bytes
        What stands in the file.

    """
    builder: Any = RecordBuilder()  # its end() has no annotation
    for record in records:
        record.write(builder)
    result: bytes = builder.end()
    return result


def filler(start: int, stop: int) -> bytes:
    """
    Write the head of a filler.

    Parameters
    ----------
    start, stop : int
        The stretch of the file it covers, its head included [B].

    Returns
    -------
    bytes
        `HEAD.size` bytes.

    """
    return HEAD.pack(FILLER, stop - start - HEAD.size)


def end_block(summary_start: int) -> bytes:
    """
    Write data end, footer and magic.

    Parameters
    ----------
    summary_start : int
        Offset of the summary [B].

    Returns
    -------
    bytes
        `END_SIZE` bytes.

    """
    return record_bytes(DataEnd(0), Footer(summary_start, 0, 0)) + MAGIC


def metadata_index(offset: int, size: int) -> bytes:
    """
    Write the index of the metadata record.

    Parameters
    ----------
    offset, size : int
        Where the record stands, and its size [B].

    Returns
    -------
    bytes
        Always of the same length.

    """
    return record_bytes(MetadataIndex(offset, size, METADATA_NAME))


def tail(offset: int, metadata: bytes, groups: Sequence[tuple[Opcode, bytes]]) -> bytes:
    """
    Write what follows the last chunk of a finished file.

    Parameters
    ----------
    offset : int
        Where the tail is to stand [B].
    metadata : bytes
        The metadata record.
    groups : sequence of (Opcode, bytes)
        The records of the summary by kind, the metadata index left out.

    Returns
    -------
    bytes
        Metadata, data end, summary, summary offsets, footer with checksum, magic.

    """
    start = place = offset + len(metadata) + DATA_END_SIZE
    groups = [*groups, (Opcode.METADATA_INDEX, metadata_index(offset, len(metadata)))]
    offsets = []
    for opcode, records in groups:
        if records:
            offsets.append(SummaryOffset(opcode, place, len(records)))
        place += len(records)
    summary = b''.join(records for _, records in groups) + record_bytes(*offsets)
    # The checksum covers the footer too, as far as the checksum itself.
    footer = record_bytes(Footer(start, place, 0))[:-4]
    footer += zlib.crc32(footer, zlib.crc32(summary)).to_bytes(4, 'little')
    return metadata + record_bytes(DataEnd(0)) + summary + footer + MAGIC


def metadata_record(text: str) -> bytes:
    """
    Write the record in which rosbag2 keeps its metadata.

    Parameters
    ----------
    text : str
        What metadata.yaml holds, without its outermost key.

    Returns
    -------
    bytes
        The record.

    """
    return record_bytes(Metadata(METADATA_NAME, {'serialized_metadata': text}))


def message_index(channel: int, index: array[int]) -> bytes:
    """
    Write a message index record; mcap's own takes 1.5 us per message.

    Parameters
    ----------
    channel : int
        Number of the channel.
    index : array of int64
        Time [ns] and offset within the chunk [B] of each message in turn.

    Returns
    -------
    bytes
        The record.

    """
    if sys.byteorder == 'big':
        index = index[:]
        index.byteswap()
    pairs = index.tobytes()
    return _INDEX_HEAD.pack(Opcode.MESSAGE_INDEX, 6 + len(pairs), channel, len(pairs)) + pairs
