# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a running drive cannot do, in words, from the figures of its diagnostics."""

from __future__ import annotations

from collections.abc import Mapping

from cam_motion.cli.terminal import number
from cam_motion.cli.watch import Snapshot
from cam_motion.io.machine import Machine

_TOO_WARM = 100.0  # per cent of the continuous torque


def overloads(machine: Machine, seen: Snapshot) -> dict[str, str]:
    """
    Say which drives of a line have come to a limit since it was started.

    Parameters
    ----------
    machine : Machine
        The machine.
    seen : Snapshot
        The snapshot.

    Returns
    -------
    dict[str, str]
        What has happened, by drive; nothing of those that do what they shall.

    """
    found = {}
    for name, health in seen.drive_health.items():
        unit = ''
        if name in machine.drives:
            unit = machine.diagram.axes[machine.drives[name].axis].unit
        said = _said(health, unit)
        if said:
            found[name] = ', '.join(said)
    return found


def _said(health: Mapping[str, str], unit: str) -> list[str]:
    said = []
    if _figure(health, 'saturations') > 0.0:
        said.append(f'saturated for {number(_figure(health, "saturated_s"))} s, up to '
                    f'{number(_figure(health, "peak_following_error"))} {unit} off its set motion')
    if (load := _figure(health, 'thermal_load_pct')) > _TOO_WARM:
        said.append(f'motor too warm: {number(load)} % of its continuous torque')
    if (dropped := _figure(health, 'dropped_s')) > 0.0:
        said.append(f'{number(dropped)} s not simulated, as it came too late')
    if (stops := _figure(health, 'stops_under_power')) > 0.0:
        said.append(f'stops under power: {number(stops)}')
    return said + ([health['reason']] if 'reason' in health else [])


def _figure(health: Mapping[str, str], key: str) -> float:
    try:
        return float(health.get(key, 0.0))
    except ValueError:
        return 0.0
