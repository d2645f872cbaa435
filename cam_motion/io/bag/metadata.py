# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The metadata.yaml of a bag, version 9, the format of ROS 2 Jazzy."""

from __future__ import annotations

import json
import os
from pathlib import Path
import re

from cam_motion.io.bag.error import BagError
from cam_motion.io.bag.summary import Summary, Topic

VERSION = 9
FILE_NAME = 'metadata.yaml'

# Printable for JSON, but not for YAML, or folded by it.
_NOT_YAML = re.compile('[\x7f-\x9f\u2028\u2029\ufeff\ufffe\uffff]')


def quote(text: str) -> str:
    """
    Write any text as one line of YAML, exactly.

    Parameters
    ----------
    text : str
        Any text, line breaks and control characters included.

    Returns
    -------
    str
        The text in double quotes.

    Raises
    ------
    BagError
        If the text holds half a surrogate pair, which no file can keep.

    """
    try:
        text.encode()
    except UnicodeEncodeError as error:
        raise BagError(f'{text!r} cannot be stored: not valid Unicode ({error})') from error
    quoted = json.dumps(text, ensure_ascii=False)
    return _NOT_YAML.sub(lambda match: f'\\u{ord(match.group()):04x}', quoted)


def render(summary: Summary) -> str:
    """
    Write the inner part of metadata.yaml; it stands in the storage file as well.

    Parameters
    ----------
    summary : Summary
        What to tell.

    Returns
    -------
    str
        YAML text without the outermost key.

    """
    duration = max(0, summary.end_ns - summary.start_ns) if summary.count else 0
    file_name = quote(summary.file_name)
    lines = [
        f'version: {VERSION}',
        f'storage_identifier: {summary.storage}',
        'duration:',
        f'  nanoseconds: {duration}',
        'starting_time:',
        f'  nanoseconds_since_epoch: {summary.start_ns}',
        f'message_count: {summary.count}',
        'topics_with_message_count:' + ('' if summary.topics else ' []'),
    ]
    for topic in summary.topics:
        lines += _topic_lines(topic)
    lines += [
        'compression_format: ""',
        'compression_mode: ""',
        'relative_file_paths:',
        f'  - {file_name}',
        'files:',
        f'  - path: {file_name}',
        '    starting_time:',
        f'      nanoseconds_since_epoch: {summary.start_ns}',
        '    duration:',
        f'      nanoseconds: {duration}',
        f'    message_count: {summary.count}',
        'custom_data:' + ('' if summary.custom_data else ' ~'),
    ]
    lines += [f'  {quote(key)}: {quote(value)}' for key, value in summary.custom_data.items()]
    lines.append(f'ros_distro: {quote(os.environ.get("ROS_DISTRO", "jazzy"))}')
    return '\n'.join(lines)


def _topic_lines(topic: Topic) -> list[str]:
    """Write one item of topics_with_message_count."""
    profiles = [f'        {x}' for qos in topic.qos_profiles for x in qos.yaml_lines()]
    return [
        '  - topic_metadata:',
        f'      name: {quote(topic.name)}',
        f'      type: {quote(topic.type_name)}',
        '      serialization_format: cdr',
        '      offered_qos_profiles:' + ('' if profiles else ' []'),
        *profiles,
        f'      type_description_hash: {quote(topic.type_hash)}',
        f'    message_count: {topic.count}',
    ]


def write_atomically(directory: Path, inner: str, sync: bool) -> None:
    """
    Replace metadata.yaml in one step: a reader sees the old file or the new one.

    Parameters
    ----------
    directory : Path
        The bag.
    inner : str
        What `render` gave.
    sync : bool
        True to wait until the file is on the disk.

    Raises
    ------
    BagError
        If the file cannot be written.

    """
    text = 'rosbag2_bagfile_information:\n' + ''.join(f'  {x}\n' for x in inner.split('\n'))
    temporary = directory / f'.{FILE_NAME}.tmp'
    try:
        with temporary.open('w', encoding='utf-8') as file:
            file.write(text)
            if sync:
                file.flush()
                os.fsync(file.fileno())
        os.replace(temporary, directory / FILE_NAME)
    except OSError as error:
        raise BagError(
            f'{directory / FILE_NAME}: cannot be written: {error.strerror}'
        ) from error
    if sync:
        sync_directory(directory)


def sync_directory(directory: Path) -> None:
    """
    Wait until the names in a directory are on the disk.

    Parameters
    ----------
    directory : Path
        The directory.

    """
    descriptor = os.open(directory, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
