# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a bag tells of its topics and of itself."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, cast

from cam_motion.io.bag.error import BagError
from cam_motion.io.bag.qos import QosProfile
from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinitionFormat, Qos
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError


@dataclass(frozen=True)
class TopicInfo:
    """
    What a bag tells of a topic.

    Attributes
    ----------
    type_name : str
        Such as ``sensor_msgs/msg/JointState``.
    count : int
        Number of messages.
    qos_profiles : tuple of QosProfile
        Profiles offered by its publishers.
    type_hash : str
        RIHS01 hash; empty if the bag has none.
    definition : str
        Definition text with dependencies; empty if the bag has none.
    encoding : str
        Of the definition: ``ros2msg`` or ``ros2idl``.

    """

    type_name: str
    count: int
    qos_profiles: tuple[QosProfile, ...] = ()
    type_hash: str = ''
    definition: str = ''
    encoding: str = 'ros2msg'


def convert_profiles(profiles: Iterable[Qos]) -> tuple[QosProfile, ...]:
    """
    Convert profiles of rosbags.

    Parameters
    ----------
    profiles : iterable of Qos
        Profiles of rosbags.

    Returns
    -------
    tuple of QosProfile
        The same.

    """
    return tuple(
        QosProfile(
            history=x.history.name.lower(),
            depth=x.depth,
            reliability=x.reliability.name.lower(),
            durability=x.durability.name.lower(),
            deadline=x.deadline.sec * 10**9 + x.deadline.nsec,
            lifespan=x.lifespan.sec * 10**9 + x.lifespan.nsec,
            liveliness=x.liveliness.name.lower(),
            liveliness_lease_duration=x.liveliness_lease_duration.sec * 10**9
            + x.liveliness_lease_duration.nsec,
            avoid_ros_namespace_conventions=x.avoid_ros_namespace_conventions,
        )
        for x in profiles
    )


def convert_connection(connection: Connection, before: TopicInfo | None) -> TopicInfo:
    """
    Convert a connection of rosbags.

    Parameters
    ----------
    connection : Connection
        A connection of rosbags.
    before : TopicInfo or None
        What other connections told of the same topic.

    Returns
    -------
    TopicInfo
        The topic, all its messages counted.

    """
    extension = cast(ConnectionExtRosbag2, connection.ext)
    text, encoding = '', 'ros2msg'
    if connection.msgdef.format != MessageDefinitionFormat.NONE:
        text = connection.msgdef.data
        if connection.msgdef.format == MessageDefinitionFormat.IDL:
            encoding = 'ros2idl'
    return TopicInfo(
        type_name=connection.msgtype,
        count=connection.msgcount + (before.count if before else 0),
        qos_profiles=convert_profiles(extension.offered_qos_profiles),
        type_hash=connection.digest,
        definition=text,
        encoding=encoding,
    )


def parse_yaml(text: str) -> Any:
    """
    Parse YAML.

    Parameters
    ----------
    text : str
        The text.

    Returns
    -------
    Any
        What it holds.

    Raises
    ------
    BagError
        If it is no YAML.

    """
    try:
        return YAML(typ='safe').load(text)
    except YAMLError as error:
        raise BagError(f'metadata is no YAML: {error}') from error


def custom_data_in(text: str) -> dict[str, str]:
    """
    Take the user's entries out of the metadata in a storage file.

    Parameters
    ----------
    text : str
        YAML; empty if there is none.

    Returns
    -------
    dict of str to str
        The entries; none if the text is not understood.

    """
    try:
        metadata = parse_yaml(text)
    except BagError:
        return {}
    entries = metadata.get('custom_data') if isinstance(metadata, dict) else None
    return {str(key): str(value) for key, value in (entries or {}).items()}


def type_hashes_in(text: str) -> dict[str, str]:
    """
    Take the type hashes out of the metadata in a storage file.

    Parameters
    ----------
    text : str
        YAML; empty if there is none.

    Returns
    -------
    dict of str to str
        Hash per topic; none if the text is not understood.

    """
    try:
        topics = [x['topic_metadata'] for x in parse_yaml(text)['topics_with_message_count']]
        return {str(x['name']): str(x.get('type_description_hash', '')) for x in topics}
    except (BagError, LookupError, TypeError, AttributeError):
        return {}
