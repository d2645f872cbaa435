# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A file written at given places, its errors told as ours."""

from __future__ import annotations

import os
from pathlib import Path

from cam_motion.io.bag.error import BagError


class RawFile:
    """
    A new file without any buffer in this process.

    Parameters
    ----------
    path : Path
        The file; must not exist.
    sync : bool
        True to make `settle` wait for the disk.

    Raises
    ------
    BagError
        If the file exists or cannot be made.

    """

    def __init__(self, path: Path, sync: bool) -> None:
        """Create the file."""
        self._path = path
        self._sync = sync
        try:
            self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o644)
        except OSError as error:
            raise self._error('cannot be created', error) from error

    def write(self, offset: int, *parts: bytes | bytearray | memoryview) -> None:
        """
        Write all parts, one behind the other.

        Parameters
        ----------
        offset : int
            Where the first is to stand [B].
        parts : bytes-like
            What to write.

        Raises
        ------
        BagError
            If the disk is full or fails.

        """
        rest = memoryview(b''.join(parts))
        try:
            while rest:
                written = os.pwrite(self._descriptor, rest, offset)
                rest, offset = rest[written:], offset + written
        except OSError as error:
            raise self._error('cannot be written', error) from error

    def settle(self) -> None:
        """
        Wait for the disk, if asked to: what follows makes what precedes valid.

        Raises
        ------
        BagError
            If the disk fails.

        """
        if not self._sync:
            return
        try:
            os.fdatasync(self._descriptor)
        except OSError as error:
            raise self._error('cannot be synced', error) from error

    def cut(self, size: int) -> None:
        """
        Shorten the file.

        Parameters
        ----------
        size : int
            What is to remain [B].

        Raises
        ------
        BagError
            If the disk fails.

        """
        try:
            os.ftruncate(self._descriptor, size)
        except OSError as error:
            raise self._error('cannot be cut', error) from error

    def close(self) -> None:
        """Close the file."""
        os.close(self._descriptor)

    def _error(self, what: str, error: OSError) -> BagError:
        """Say what failed, and what it means for the bag."""
        return BagError(
            f'{self._path}: {what}: {error.strerror} (the bag is whole up to the last flush)'
        )
