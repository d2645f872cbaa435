# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a node says of its health, once a second on /diagnostics."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

TOPIC = '/diagnostics'
PERIOD = 1.0
"""Time from report to report [s]."""

OK = DiagnosticStatus.OK
WARN = DiagnosticStatus.WARN
ERROR = DiagnosticStatus.ERROR


def report(stamp: Any, name: str, hardware_id: str, level: bytes, message: str,
           values: Mapping[str, Any]) -> DiagnosticArray:
    """
    Write a report.

    Parameters
    ----------
    stamp : builtin_interfaces.msg.Time
        When.
    name : str
        Name of the node.
    hardware_id : str
        What it stands for, such as the axis.
    level : bytes
        `OK`, `WARN` or `ERROR`.
    message : str
        The state in a few words.
    values : Mapping[str, Any]
        Figures by name.

    Returns
    -------
    DiagnosticArray
        With one status.

    """
    status = DiagnosticStatus(
        level=level, name=name, hardware_id=hardware_id, message=message,
        values=[KeyValue(key=key, value=_text(value)) for key, value in values.items()])
    array = DiagnosticArray(status=[status])
    array.header.stamp = stamp
    return array


def _text(value: Any) -> str:
    return f'{value:.9g}' if isinstance(value, float) else str(value)
