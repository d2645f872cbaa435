# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Quality of service of a recorded topic, as rosbag2 keeps it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

#: Duration that means 'for ever' [ns]; rosbag2 writes it as 9223372036 s, 854775807 ns.
INFINITE_NS = 2**63 - 1

_DURATIONS = ('deadline', 'lifespan', 'liveliness_lease_duration')


@dataclass(frozen=True)
class QosProfile:
    """
    One offered profile of a topic; fields and words are those of rosbag2's metadata.

    Attributes
    ----------
    history : str
        ``keep_last``, ``keep_all``, ``system_default`` or ``unknown``.
    depth : int
        Number of samples kept with ``keep_last``.
    reliability : str
        ``reliable``, ``best_effort``, ``system_default`` or ``unknown``.
    durability : str
        ``volatile``, ``transient_local``, ``system_default`` or ``unknown``.
    deadline, lifespan, liveliness_lease_duration : int
        Durations [ns]; `INFINITE_NS` where none is set.
    liveliness : str
        ``automatic``, ``manual_by_topic``, ``system_default`` or ``unknown``.
    avoid_ros_namespace_conventions : bool
        True if the topic name goes to the middleware without the ROS prefix.

    """

    history: str = 'keep_last'
    depth: int = 10
    reliability: str = 'reliable'
    durability: str = 'volatile'
    deadline: int = INFINITE_NS
    lifespan: int = INFINITE_NS
    liveliness: str = 'automatic'
    liveliness_lease_duration: int = INFINITE_NS
    avoid_ros_namespace_conventions: bool = False

    @classmethod
    def from_ros(cls, profile: Any) -> QosProfile:
        """
        Copy a profile of rclpy without importing rclpy.

        Parameters
        ----------
        profile : Any
            An ``rclpy.qos.QoSProfile``, such as ``TopicEndpointInfo.qos_profile``.

        Returns
        -------
        QosProfile
            The same profile; durations in ns, zero (unspecified) becoming `INFINITE_NS`.

        """
        return cls(
            history=profile.history.name.lower(),
            depth=int(profile.depth),
            reliability=profile.reliability.name.lower(),
            durability=profile.durability.name.lower(),
            deadline=profile.deadline.nanoseconds or INFINITE_NS,
            lifespan=profile.lifespan.nanoseconds or INFINITE_NS,
            liveliness=profile.liveliness.name.lower(),
            liveliness_lease_duration=profile.liveliness_lease_duration.nanoseconds or INFINITE_NS,
            avoid_ros_namespace_conventions=bool(profile.avoid_ros_namespace_conventions),
        )

    def yaml_lines(self) -> list[str]:
        """
        Write the profile as an item of a YAML list.

        Returns
        -------
        list of str
            Lines without indentation of the list itself.

        """
        lines = []
        for name in self.__dataclass_fields__:
            value = getattr(self, name)
            if name in _DURATIONS:
                lines.append(f'  {name}:')
                lines.append(f'    sec: {value // 10**9}')
                lines.append(f'    nsec: {value % 10**9}')
            elif isinstance(value, bool):
                lines.append(f'  {name}: {str(value).lower()}')
            else:
                lines.append(f'  {name}: {value}')
        lines[0] = '-' + lines[0][1:]
        return lines


def qos_text(profiles: tuple[QosProfile, ...]) -> str:
    """
    Write profiles as the YAML text that storage files hold.

    Parameters
    ----------
    profiles : tuple of QosProfile
        The profiles; may be empty.

    Returns
    -------
    str
        A YAML list.

    """
    return '\n'.join(line for profile in profiles for line in profile.yaml_lines()) or '[]'
