# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Read a bag of rosbag2, also one whose recorder did not finish it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
import shutil
import tempfile
from types import TracebackType
from typing import Any

from cam_motion.io.bag.definitions import build_store, jazzy
from cam_motion.io.bag.error import BagError
from cam_motion.io.bag.metadata import FILE_NAME
from cam_motion.io.bag.source import Entry, open_file, Source, WholeSource
from cam_motion.io.bag.topic_info import parse_yaml, TopicInfo
from rosbags.serde import SerdeError
from rosbags.typesys.store import Typestore

_SUFFIXES = ('.mcap', '.db3')


class BagReader:
    """
    Read any rosbag2 bag, or a lone storage file.

    Parameters
    ----------
    path : Path or str
        Directory of the bag, or an ``.mcap`` or ``.db3`` file.

    Attributes
    ----------
    path : Path
        The same.
    topics : dict of str to TopicInfo
        Its topics, with true counts, whatever metadata.yaml says.
    custom_data : dict of str to str
        The user's entries.
    incomplete : bool
        True if the recorder was cut off, so that messages may be missing at the end: a storage
        file without its end or within a commit, or a directory without metadata.yaml.

    Raises
    ------
    BagError
        If there is no bag, or it cannot be read.

    """

    def __init__(self, path: Path | str) -> None:
        """Open the bag."""
        self.path = Path(path)
        self.topics: dict[str, TopicInfo] = {}
        self.custom_data: dict[str, str] = {}
        self.incomplete = False
        self._sources: list[Source] = []
        self._store: Typestore | None = None
        self._scratch = Path(tempfile.gettempdir())
        if not self.path.exists():
            raise BagError(f'{self.path}: does not exist (is the name right?)')
        self._scratch = Path(tempfile.mkdtemp(prefix='cam_motion_bag_'))
        try:
            if self.path.is_dir():
                self._open_directory()
            else:
                self._open_files([self.path])
        except BaseException:
            self.close()
            raise

    def messages(self, topics: Iterable[str] | str | None = None) -> Iterator[Entry]:
        """
        Read messages.

        Parameters
        ----------
        topics : iterable of str, str or None
            Topics wanted; None for all.

        Yields
        ------
        tuple of (str, int, bytes)
            Topic, time of reception [ns], serialised message; in the order of time within each
            storage file, of a cut one in the order of the file.

        Raises
        ------
        BagError
            If a topic is not in the bag, or the bag is damaged.

        """
        names = [topics] if isinstance(topics, str) else topics
        wanted = set(self.topics) if names is None else set(names)
        if missing := sorted(wanted - set(self.topics)):
            raise BagError(
                f'{self.path}: no topic {", ".join(missing)} (there are: '
                f'{", ".join(sorted(self.topics)) or "none"})'
            )
        return (entry for source in self._sources for entry in source.messages(wanted))

    def decode(self, type_name: str, raw: bytes) -> Any:
        """
        Decode one message.

        Parameters
        ----------
        type_name : str
            Its type.
        raw : bytes
            The message, serialised.

        Returns
        -------
        Any
            A message object of rosbags, fields as attributes.

        Raises
        ------
        BagError
            If the type is unknown, or the bytes do not fit it.

        """
        if self._store is None:
            self._store = build_store(
                {
                    x.type_name: (x.encoding, x.definition)
                    for x in self.topics.values()
                    if x.definition
                }
            )
        # Old bags hold no definitions.
        store = self._store if type_name in self._store.fielddefs else jazzy()
        if type_name not in store.fielddefs:
            raise BagError(f'{self.path}: {type_name}: the bag has no definition of it')
        try:
            return store.deserialize_cdr(raw, type_name)
        except SerdeError as error:
            raise BagError(f'{self.path}: {type_name}: not decodable: {error}') from error

    def close(self) -> None:
        """Close all files; further calls do nothing."""
        while self._sources:
            self._sources.pop().close()
        shutil.rmtree(self._scratch, ignore_errors=True)

    def __enter__(self) -> BagReader:
        """Give the reader itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Close all files."""
        self.close()

    def _open_directory(self) -> None:
        """Open what metadata.yaml names, or without it what is there."""
        file = self.path / FILE_NAME
        if not file.is_file():
            found = sorted(x for x in self.path.iterdir() if x.suffix in _SUFFIXES)
            if not found:
                raise BagError(f'{self.path}: no bag: neither {FILE_NAME} nor a storage file')
            self._open_files(found)
            self.incomplete = True
            return
        try:
            information = parse_yaml(file.read_text('utf-8'))['rosbag2_bagfile_information']
            names = [Path(name).name for name in information['relative_file_paths']]
            custom_data = information.get('custom_data') or {}
            compression = (information.get('compression_mode') or 'none').lower()
        except (BagError, OSError, LookupError, TypeError, AttributeError, ValueError) as error:
            raise BagError(f'{file}: not understood: {error!r}') from error
        if compression != 'none':
            # Whole files or single messages are compressed: only rosbags knows how.
            self._add(WholeSource(self.path))
        else:
            # One by one, as metadata.yaml may lag behind them by a flush.
            self._open_files([self.path / name for name in names])
        self.custom_data.update({str(key): str(value) for key, value in custom_data.items()})

    def _open_files(self, files: list[Path]) -> None:
        """Open storage files."""
        for file in files:
            if file.suffix not in _SUFFIXES:
                raise BagError(f'{file}: neither .mcap nor .db3 (nor a directory)')
            source, incomplete = open_file(file, self._scratch)
            self.incomplete |= incomplete
            self._add(source)

    def _add(self, source: Source) -> None:
        """Take over a storage file."""
        self._sources.append(source)
        self.custom_data.update(source.custom_data)
        for name, info in source.topics.items():
            before = self.topics.get(name)
            self.topics[name] = replace(info, count=info.count + (before.count if before else 0))
