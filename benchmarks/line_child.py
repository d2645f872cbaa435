# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A line of several axes in a process of its own, measured from within."""

from collections.abc import Callable
from functools import partial
import gc
import json
import resource
import sys
import time

from benchmarks.row import percentile_99
from cam_motion.nodes.cam_axis import CamAxis
from cam_motion.nodes.executor import make_executor
from cam_motion.nodes.master_shaft import MasterShaft
from cam_motion.nodes.runner import start
from cam_motion.runtime.point import Point
import rclpy
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions

_CAM = {
    'segments': ['cut', 'dwell', 'back', 'rest'],
    'cut.law': 'modified_trapezoid', 'cut.end_deg': 120.0, 'cut.lift': 0.08,
    'dwell.end_deg': 180.0,
    'back.law': 'modified_trapezoid', 'back.end_deg': 300.0, 'back.lift': -0.08,
    'rest.end_deg': 360.0,
}
_WARM_UP = 2.0  # seconds until discovery and the first ramp are over
_RECOVERY = 0.5  # and until the ticks that the collector has held up are made good or given up


def main() -> None:
    """Run and print CPU share, latencies and lost ticks as JSON."""
    _, link, axes, rate_hz, seconds = sys.argv[1:]
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    master = MasterShaft(parameter_overrides=_overrides(
        {'rate_hz': float(rate_hz), 'speed_cpm': 200.0}))
    by_call = link == 'calls'
    nodes = [CamAxis(f'axis{number}', own_process=not by_call,
                     parameter_overrides=_overrides(_CAM)) for number in range(int(axes))]
    if by_call:
        master.listeners += [node.answer for node in nodes]
    latencies: list[int] = []

    def note(setpoint: Point) -> None:
        # from the scheduled instant of the tick to the last setpoint handed to DDS
        due = master._ticker.schedule._zero_ns + setpoint.sec * 1_000_000_000 + setpoint.nanosec
        latencies.append(time.monotonic_ns() - due)

    nodes[-1].listeners.append(note)
    bouts: list[int] = []  # from the moment a tick is begun on to its last setpoint

    def timed(tick: Callable[[int], None], time_ns: int) -> None:
        began = time.monotonic_ns()
        tick(time_ns)
        bouts.append(time.monotonic_ns() - began)

    executor = make_executor()
    for node in (master, *nodes):
        executor.add_node(node)
    start([master, *nodes])
    _spin(executor, _WARM_UP)
    gc.collect()
    gc.freeze()  # as the runner of the nodes does
    _spin(executor, _RECOVERY)
    latencies.clear()
    master._ticker._tick = partial(timed, master._ticker._tick)
    schedule = master._ticker.schedule
    missed, used, began = schedule.missed, _cpu(), time.monotonic()
    _spin(executor, float(seconds))
    wall = time.monotonic() - began
    print(json.dumps({
        'cpu_pct': 100.0 * (_cpu() - used) / wall,
        'due_p99_ms': 1e-6 * percentile_99(latencies),
        'begun_p99_ms': 1e-6 * percentile_99(bouts),
        'ticks': len(latencies),
        # what the last axis has not answered counts as lost too
        'missed': max(schedule.missed - missed, round(wall * float(rate_hz)) - len(latencies) - 1,
                      0),
    }))
    executor.shutdown()
    for node in (master, *nodes):
        node.destroy_node()
    rclpy.try_shutdown()


def _overrides(values: dict[str, object]) -> list[Parameter]:
    return [Parameter(name, value=value) for name, value in values.items()]


def _spin(executor, seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.1)


def _cpu() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


if __name__ == '__main__':
    main()
