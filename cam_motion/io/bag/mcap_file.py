# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
An MCAP file that is whole after every step, however the process ends.

While the recording runs the file is longer than its data. A *filler*, a record of a private
opcode that every reader skips, covers the free room (a hole on the disk), and two *slots* at the
top of that room hold the summary in turn::

    header  chunks ...  filler(                  slot  slot  ) data end  footer  magic
                        ^ data_end                           ^ end - END_SIZE

An update writes the new chunk into the free room behind the filler's head, and the new summary
into the slot that is not in use; no reader can see either. Two writes then make them valid: the
9 bytes at ``data_end`` turn the filler's head into the head of the chunk (for who reads from the
start), and the 50 bytes at the end turn the footer to the other slot (for who reads from the
end). Both lie within one page, which the kernel never leaves half written, neither when the
process is killed nor when the disk is full. Larger writes carry no such promise.

A slot keeps the chunk indexes it has, so that an update costs the same after hours: only the
indexes since the slot's last turn are added. When the room is used up, the end block is written
again further up: one write within one page again, with a hole below it. Closing writes the usual
MCAP tail (summary with offsets and checksum) behind the last chunk, and cuts the file there.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from cam_motion.io.bag.error import BagError
from cam_motion.io.bag.mcap_records import (
    DATA_END_SIZE,
    end_block,
    END_SIZE,
    FILLER,
    filler,
    HEAD,
    metadata_index,
    tail,
)
from cam_motion.io.bag.raw_file import RawFile
from mcap.opcode import Opcode

_PAGE = 4096

# The least and the usual most of free room to add at once [B].
_ROOM_MIN = 256 * 1024
_ROOM_MAX = 16 * 1024 * 1024


@dataclass
class _Slot:
    """A place for the summary: its offset [B], and how much of the body it holds [B]."""

    start: int
    valid: int = 0


class McapFile:
    """
    The file: where what stands, and in which order it is written.

    Parameters
    ----------
    path : Path
        The file; must not exist.
    head : bytes
        Magic and header record.
    statistics, metadata : bytes
        The first statistics and metadata record, see `update`.
    sync : bool
        True to wait for the disk before and after each decisive write.

    Attributes
    ----------
    data_end : int
        Offset behind the last chunk and its indexes [B].

    Raises
    ------
    BagError
        If the file exists or cannot be written.

    """

    def __init__(
        self, path: Path, head: bytes, statistics: bytes, metadata: bytes, sync: bool
    ) -> None:
        """Create the file, valid and empty."""
        self.data_end = 0
        self._end = 0
        self._capacity = 0
        self._schemas = self._channels = b''
        self._body = bytearray()
        self._statistics = statistics
        self._metadata = metadata
        self._active = self._spare = _Slot(0)
        self._file = RawFile(path, sync)
        try:
            self._file.write(0, head)
            self.data_end = len(head)
            self._move_up(0, self._summary_size(statistics, metadata))
        except BagError:
            self._file.close()
            raise

    def set_topics(self, schemas: bytes, channels: bytes) -> None:
        """
        Replace the summary's schemas and channels; they are written with the next update.

        Parameters
        ----------
        schemas, channels : bytes
            All records of their kind.

        """
        self._body[: len(self._schemas) + len(self._channels)] = schemas + channels
        self._schemas, self._channels = schemas, channels
        self._active.valid = self._spare.valid = 0

    def update(self, data: bytes, index: bytes, statistics: bytes, metadata: bytes) -> None:
        """
        Add a chunk and make it valid together with a new summary.

        Parameters
        ----------
        data : bytes
            The chunk and its message indexes; may be empty.
        index : bytes
            Its chunk index record; may be empty.
        statistics, metadata : bytes
            The records of these kinds, true after the update.

        Raises
        ------
        BagError
            If the disk is full or fails; the file then still holds what it held before.

        """
        if (self.data_end + len(data)) % _PAGE > _PAGE - HEAD.size:
            # The next head must not cross a page. One byte long, as mcap's own reader takes
            # the empty content of a record for the end of the file.
            data += HEAD.pack(FILLER, 1) + bytes(1)
        size = self._summary_size(statistics, metadata) + len(index)
        self._make_room(len(data), size)
        before = len(self._body)
        self._body += index
        try:
            data_end = self.data_end + len(data)
            if data:
                rest = filler(data_end, self._end - END_SIZE)
                self._file.write(self.data_end + HEAD.size, memoryview(data)[HEAD.size:], rest)
            self._write_slot(self._spare, statistics, metadata, self._end)
            self._file.settle()
            if data:
                self._file.write(self.data_end, data[: HEAD.size])
            self._turn_to(self._spare, self._end)
        except BagError:
            del self._body[before:]
            raise
        self.data_end = data_end
        self._statistics, self._metadata = statistics, metadata
        self._active, self._spare = self._spare, self._active

    def close(self) -> None:
        """
        Write the usual tail behind the last chunk, and cut the file there.

        Raises
        ------
        BagError
            If the disk is full or fails; the file then stays as the last update left it.

        """
        try:
            last = self._tail()
            self._make_room(len(last), self._capacity // 2)
            self._file.write(self.data_end + HEAD.size, memoryview(last)[HEAD.size:])
            self._file.settle()
            self._file.write(self.data_end, last[: HEAD.size])
            self._file.cut(self.data_end + len(last))
            self._file.settle()
        finally:
            self._file.close()

    def _tail(self) -> bytes:
        """Write the tail of the finished file."""
        topics = len(self._schemas) + len(self._channels)
        groups = (
            (Opcode.SCHEMA, self._schemas),
            (Opcode.CHANNEL, self._channels),
            (Opcode.CHUNK_INDEX, bytes(self._body[topics:])),
            (Opcode.STATISTICS, self._statistics),
        )
        return tail(self.data_end, self._metadata, groups)

    def _summary_size(self, statistics: bytes, metadata: bytes) -> int:
        """Give the room that a summary takes in its slot [B]."""
        return len(self._body) + len(statistics) + 2 * HEAD.size + len(metadata) + 64

    def _make_room(self, data_size: int, summary_size: int) -> None:
        """Move the end block up if the free room is too small for what is coming [B]."""
        floor = min(self._active.start, self._spare.start)
        full = self.data_end + data_size + HEAD.size > floor
        if full or summary_size > self._capacity:
            self._move_up(data_size, summary_size)

    def _move_up(self, data_size: int, summary_size: int) -> None:
        """Write slots and end block again, further up; the file keeps what it tells."""
        capacity = _page_up(max(2 * summary_size, self._capacity))
        # In step with the file's size and with the summary, which is written twice here.
        room = max(_ROOM_MIN, min(_ROOM_MAX, self.data_end // 2), 4 * capacity)
        low = max(_page_up(self.data_end + data_size + HEAD.size + room), self._end)
        end = _page_up(low + 2 * capacity + END_SIZE)
        slots = _Slot(low), _Slot(low + capacity)
        if self._end:
            # The file grows by one write of END_SIZE bytes, so the summary it shows must lie
            # below the present end. Who reads from the start goes on to find the old end.
            self._write_slot(self._spare, self._statistics, self._metadata, end)
            self._file.settle()
            self._turn_to(self._spare, end)
        self._file.write(self.data_end, filler(self.data_end, end - END_SIZE))
        self._write_slot(slots[0], self._statistics, self._metadata, end)
        self._file.settle()
        self._turn_to(slots[0], end)
        self._end, self._capacity = end, capacity
        self._active, self._spare = slots

    def _write_slot(self, slot: _Slot, statistics: bytes, metadata: bytes, end: int) -> None:
        """Bring a slot that no reader sees up to date, for a file that ends at `end`."""
        valid, slot.valid = slot.valid, 0  # unknown if the write fails
        place = slot.start + len(self._body) + len(statistics)
        # The metadata record stands inside the filler: it belongs to no summary, but the index
        # may point anywhere.
        size = len(metadata_index(0, 0))
        index = metadata_index(place + size + HEAD.size, len(metadata))
        rest = filler(place + size, end - END_SIZE + DATA_END_SIZE)
        self._file.write(slot.start + valid, self._body[valid:], statistics, index, rest, metadata)
        slot.valid = len(self._body)

    def _turn_to(self, slot: _Slot, end: int) -> None:
        """Let a file that ends at `end` show a slot."""
        self._file.write(end - END_SIZE, end_block(slot.start))
        self._file.settle()


def _page_up(size: int) -> int:
    """Round a size up to whole pages [B]."""
    return -(-size // _PAGE) * _PAGE
