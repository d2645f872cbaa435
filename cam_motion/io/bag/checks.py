# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a writer refuses, and how it says so."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from cam_motion.io.bag.error import BagError
from cam_motion.io.bag.metadata import quote
from cam_motion.io.bag.summary import NEVER_NS

#: Longest time between two flushes [s]: what a kill may cost.
FLUSH_INTERVAL_MAX = 1.0

#: Kinds of storage, and the ends of their files' names.
SUFFIXES = {'mcap': '.mcap', 'sqlite3': '.db3'}


def check_arguments(
    path: Path, storage: str, compression: str | None, flush_interval: float | None
) -> None:
    """
    Refuse arguments of a writer that break their rules.

    Parameters
    ----------
    path : Path
        The bag, for the message.
    storage, compression, flush_interval
        As given to `BagWriter`; the interval in s.

    Raises
    ------
    BagError
        If one breaks its rule.

    """
    if storage not in SUFFIXES:
        raise BagError(f'{path}: storage {storage!r}: must be one of {sorted(SUFFIXES)}')
    if compression not in (None, 'zstd') or (compression and storage != 'mcap'):
        raise BagError(
            f'{path}: compression {compression!r} with {storage}: '
            "must be None, or 'zstd' with mcap"
        )
    if flush_interval is not None and not 0.0 < flush_interval <= FLUSH_INTERVAL_MAX:
        raise BagError(
            f'{path}: flush_interval {flush_interval!r} s: must be above 0 and at most '
            f'{FLUSH_INTERVAL_MAX} s, the time that a kill may cost'
        )


def make_directory(path: Path) -> None:
    """
    Make the directory of a bag.

    Parameters
    ----------
    path : Path
        The directory; its parents are made too.

    Raises
    ------
    BagError
        If it exists, whatever it holds, or cannot be made.

    """
    try:
        path.mkdir(parents=True)
    except FileExistsError as error:
        raise BagError(
            f'{path}: exists already, and a bag is never overwritten '
            '(choose another directory or remove this one)'
        ) from error
    except OSError as error:
        raise BagError(f'{path}: cannot be made: {error.strerror}') from error


def check_custom_data(custom_data: Mapping[str, str] | None, path: Path) -> dict[str, str]:
    """
    Check that the user's entries are texts.

    Parameters
    ----------
    custom_data : mapping of str to str or None
        The entries.
    path : Path
        The bag, for the message.

    Returns
    -------
    dict of str to str
        A copy.

    Raises
    ------
    BagError
        If a key or a value is no text or cannot be stored.

    """
    entries = dict(custom_data or {})
    for key, value in entries.items():
        if not isinstance(key, str) or not isinstance(value, str):
            raise BagError(
                f'{path}: custom_data[{key!r}] = {value!r}: keys and values must be texts '
                '(write numbers as str(...))'
            )
        try:
            quote(key)
            quote(value)
        except BagError as error:
            raise BagError(f'{path}: custom_data[{key!r}]: {error}') from error
    return entries


def refusal(
    path: Path, handle: int, timestamp_ns: int, error: Exception
) -> BagError:
    """
    Say what is wrong with a message.

    Parameters
    ----------
    path : Path
        The bag.
    handle, timestamp_ns : int
        What was to be written.
    error : Exception
        What the storage said.

    Returns
    -------
    BagError
        To be raised.

    """
    if isinstance(error, KeyError):
        return BagError(f'{path}: no topic has the handle {handle!r} (see add_topic)')
    return BagError(
        f'{path}: message for handle {handle} at {timestamp_ns!r} ns: times must be integers '
        f'within 0 ... {NEVER_NS} ns, data bytes of at least one byte ({error})'
    )
