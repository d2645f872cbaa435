# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The nodes beside rclpy's default executor and beside bare messages."""

import json
import os
from pathlib import Path
import subprocess
import sys
from tempfile import TemporaryDirectory

from benchmarks.row import Row
from cam_motion.nodes.executor import CHOICE

_AXES = 8
_RATE_HZ = 1000.0
_GOAL = '≤ 50 % of a core, p99 ≤ 1 ms, no tick lost'


def node_rows(seconds: float) -> list[Row]:
    """
    Measure a line of eight axes at 1 kHz, and one axis on its own.

    Parameters
    ----------
    seconds : float
        Length of each run [s].

    Returns
    -------
    list[Row]
        The rows.

    """
    ours = _run('line_child', 'events', 'calls', str(_AXES), str(_RATE_HZ), str(seconds))
    wake = _run('wake_child', 'events', str(_RATE_HZ), str(seconds))
    same = _run('line_child', 'default', 'calls', str(_AXES), str(_RATE_HZ), str(seconds))
    topics = _run('line_child', 'default', 'topics', '1', '500.0', str(seconds))
    mine, bare = (_run('axis_child', kind) for kind in ('axis', 'bare'))
    return [
        Row(f'line: shaft + {_AXES} axes at {_RATE_HZ:g} Hz, one process', _line_text(ours),
            f'{_line_text(same)} (the same on the default executor); a bare loop at '
            f'{_RATE_HZ:g} Hz wakes up {wake["p99_ms"]:.2f} ms late (p99)',
            f'{same["cpu_pct"] / ours["cpu_pct"]:.1f} × less CPU', _GOAL),
        Row('beside it: shaft + 1 axis at 500 Hz over topics', '–',
            f'{_line_text(topics)} (default executor)', '–', '–'),
        Row('one axis, one tick', f'{mine["us"]:.1f} µs',
            f'{bare["us"]:.1f} µs (bare take + publish)',
            f'{mine["us"] / bare["us"]:.2f} × its cost', '≤ 1.5 × its cost'),
    ]


def _line_text(result: dict[str, float]) -> str:
    return (f'{result["cpu_pct"]:.0f} % of a core; p99 {result["begun_p99_ms"]:.2f} ms after the '
            f'shaft\'s point, {result["due_p99_ms"]:.2f} ms after its scheduled instant; '
            f'{result["missed"]:.0f} of {result["ticks"] + result["missed"]:.0f} ticks lost')


def _run(child: str, *arguments: str) -> dict[str, float]:
    """Run a measurement in a process and a ROS domain of its own."""
    with TemporaryDirectory() as folder:
        environment = {
            **os.environ, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_LOG_DIR': folder,
            CHOICE: arguments[0] if arguments[0] == 'default' else 'events',
        }
        done = subprocess.run(
            [sys.executable, '-m', f'benchmarks.{child}', *arguments], check=True, text=True,
            stdout=subprocess.PIPE, env=environment, timeout=120,
            cwd=Path(__file__).parent.parent)
    return json.loads(done.stdout.splitlines()[-1])
