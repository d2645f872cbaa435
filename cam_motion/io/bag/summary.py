# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a bag holds: the one table behind metadata.yaml and the storage file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from cam_motion.io.bag.qos import QosProfile

#: What rosbag2 writes as the start of a bag without messages [ns].
NEVER_NS = 2**63 - 1


@dataclass
class Topic:
    """
    A recorded topic.

    Attributes
    ----------
    handle : int
        Number of the topic in the storage file, from 1.
    name : str
        Topic name.
    type_name : str
        Such as ``sensor_msgs/msg/JointState``.
    definition, encoding, type_hash : str
        Definition text with dependencies, its encoding (``ros2msg``), RIHS01 hash.
    qos_profiles : tuple of QosProfile
        Offered profiles, one per publisher.
    count : int
        Messages in the storage file, buffered ones not counted.

    """

    handle: int
    name: str
    type_name: str
    definition: str
    encoding: str
    type_hash: str
    qos_profiles: tuple[QosProfile, ...] = ()
    count: int = 0


@dataclass
class Summary:
    """
    What metadata.yaml tells of a bag; the storage keeps it true to the file.

    Attributes
    ----------
    storage : str
        ``mcap`` or ``sqlite3``.
    file_name : str
        Name of the storage file.
    topics : list of Topic
        All topics.
    start_ns, end_ns : int
        Time of the earliest and of the latest message [ns]; no messages: `NEVER_NS` and 0.
    custom_data : dict of str to str
        The user's own entries.

    """

    storage: str
    file_name: str
    topics: list[Topic] = field(default_factory=list)
    start_ns: int = NEVER_NS
    end_ns: int = 0
    custom_data: dict[str, str] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """Messages in the storage file, buffered ones not counted."""
        return sum(topic.count for topic in self.topics)

    def cover(self, start_ns: int, end_ns: int) -> None:
        """
        Widen the time span of the bag.

        Parameters
        ----------
        start_ns, end_ns : int
            Time of the earliest and of the latest message added [ns].

        """
        self.start_ns = min(self.start_ns, start_ns)
        self.end_ns = max(self.end_ns, end_ns)


def find_topic(topics: Sequence[Topic], name: str) -> Topic | None:
    """
    Look a topic up by its name.

    Parameters
    ----------
    topics : sequence of Topic
        Where to look.
    name : str
        Topic name.

    Returns
    -------
    Topic or None
        None if there is no such topic.

    """
    return next((topic for topic in topics if topic.name == name), None)
