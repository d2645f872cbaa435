# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Serialised messages that differ in nothing but their numbers, decoded all at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

# Header of little-endian CDR; all counts and offsets below are behind it.
_LITTLE_ENDIAN = b'\x00\x01'
_HEADER = 4


class Layout:
    """
    Walk over the fields of one serialised message; note where its numbers stand.

    Parameters
    ----------
    raw : bytes
        The message, little-endian CDR with its header.

    Attributes
    ----------
    place : int
        End of the fields walked over [B behind the header].
    sequences : list of (int, int)
        Offset [B] and count of each float64 sequence.
    stamp : int
        Offset of the time [B].

    """

    def __init__(self, raw: bytes) -> None:
        """Start behind the header."""
        self._raw = raw
        self.place = 0
        self.sequences: list[tuple[int, int]] = []
        self.stamp = 0

    def _count(self) -> int:
        """Read the count before a sequence or a text."""
        self.place += -self.place % 4
        start = _HEADER + self.place
        self.place += 4
        return int.from_bytes(self._raw[start:start + 4], 'little')

    def time(self) -> None:
        """Step over seconds and nanoseconds."""
        self.place += -self.place % 4
        self.stamp = _HEADER + self.place
        self.place += 8

    def text(self) -> None:
        """Step over a text."""
        self.place += self._count()

    def texts(self) -> None:
        """Step over a sequence of texts."""
        # Not more than there are bytes: a damaged count must not keep us here.
        for _ in range(min(self._count(), len(self._raw))):
            self.text()

    def floats(self) -> None:
        """Step over a sequence of float64."""
        count = self._count()
        if count:
            self.place += -self.place % 8
        self.sequences.append((_HEADER + self.place, count))
        self.place += 8 * count


def walk_point(raw: bytes) -> Layout:
    """
    Walk over a JointTrajectoryPoint.

    Parameters
    ----------
    raw : bytes
        The message, serialised.

    Returns
    -------
    Layout
        Where its numbers stand.

    """
    layout = Layout(raw)
    for _ in range(4):
        layout.floats()
    layout.time()
    return layout


def walk_joint_state(raw: bytes) -> Layout:
    """
    Walk over a JointState.

    Parameters
    ----------
    raw : bytes
        The message, serialised.

    Returns
    -------
    Layout
        Where its numbers stand.

    """
    layout = Layout(raw)
    layout.time()
    layout.text()
    layout.texts()
    for _ in range(3):
        layout.floats()
    return layout


def read_uniform(raws: Sequence[bytes], walk: Callable[[bytes], Layout]) -> list[Any] | None:
    """
    Decode messages that differ in nothing but their numbers, all at once.

    Parameters
    ----------
    raws : sequence of bytes
        n messages of one type, serialised.
    walk : callable
        Walks over a message of this type.

    Returns
    -------
    list of ndarray or None
        The float sequences, shapes (n, count), then the time [ns], shape (n,); None if some
        messages are made otherwise than the first.

    """
    if not raws or raws[0][:2] != _LITTLE_ENDIAN:
        return None
    size = len(raws[0])
    layout = walk(raws[0])
    end = _HEADER + layout.place
    # Fast DDS rounds the size of a message up to whole words.
    if not end <= size < end + 4 or any(len(raw) != size for raw in raws):
        return None
    table = np.frombuffer(b''.join(raws), dtype=np.uint8).reshape(len(raws), size)
    fixed = np.ones(size, dtype=bool)
    fixed[layout.stamp:layout.stamp + 8] = False
    fixed[end:] = False
    for start, count in layout.sequences:
        fixed[start:start + 8 * count] = False
    # Padding may hold anything, but in practice is the same throughout.
    if (table[:, fixed] != table[0, fixed]).any():
        return None
    fields: list[Any] = [
        np.ascontiguousarray(table[:, start:start + 8 * count]).view('<f8').astype(np.float64)
        if count
        else np.empty((len(raws), 0))
        for start, count in layout.sequences
    ]
    stamp = np.ascontiguousarray(table[:, layout.stamp:layout.stamp + 8])
    seconds = stamp[:, :4].copy().view('<i4')[:, 0].astype(np.int64)
    fields.append(seconds * 10**9 + stamp[:, 4:].copy().view('<u4')[:, 0].astype(np.int64))
    return fields
