# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The ticks of a node that turns the shaft: when they are due, and what each publishes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from cam_motion.io.axis_parameters import SHAFT
from cam_motion.io.tracks import TrackSettings
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.qos import BURST, SETPOINTS
from cam_motion.nodes.track_output import TrackOutput
from cam_motion.nodes.wire import JointStateCodec, pack_point
from cam_motion.runtime.point import Point
from cam_motion.runtime.ticks import NANOSECONDS, TickSchedule
from cam_motion.units import RPM, TURN
from rclpy.timer import Timer
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectoryPoint

_SIM_TIME_CATCH_UP = 1.0  # /clock may come in coarse steps: its ticks are all carried out [s]

Listener = Callable[[Point], None]


class ShaftTicker:
    """
    Calls for every tick of a fixed grid, and publishes shaft points and joint states.

    Parameters
    ----------
    node : ManagedNode
        The node that turns the shaft.
    values : Mapping[str, Any]
        Its parameters, among them those of `SHAFT_TICKS`, checked.
    listeners : Sequence[Callable[[Point], None]]
        Called with every point: axes of the same process, which need no topic.
    tick : Callable[[int], None]
        Called with the time of each tick that is due, on the machine's time base [ns]; to
        `publish` it.
    tracks : Mapping[str, TrackSettings]
        Cam tracks of the shaft by name.
    waits : bool
        Whether that time base stands still over ticks that are given up, so that a shaft which
        is integrated, and which has not turned meanwhile, goes on from where it was. Else it
        goes on with the clock, as befits a shaft that is known at any time.

    Attributes
    ----------
    schedule : TickSchedule
        Which ticks are due, came late, were missed.
    count : int
        Ticks published.
    last_ns : int
        Time of the last one [ns].
    tracks : TrackOutput
        The cam tracks.
    given_up : int
        Ticks over which the time base has stood still.

    """

    def __init__(self, node: ManagedNode, values: Mapping[str, Any],
                 listeners: Sequence[Listener], tick: Callable[[int], None],
                 tracks: Mapping[str, TrackSettings], waits: bool = False) -> None:
        """Make the topics and a timer that does not run yet."""
        self._node = node
        self._tick = tick
        self._waits = waits
        self._listeners = listeners
        catch_up = values['max_catch_up']
        self.schedule = (
            TickSchedule(values['rate_hz'], max(catch_up, _SIM_TIME_CATCH_UP)) if node.sim_time
            else TickSchedule(values['rate_hz'], catch_up, BURST))
        self.count = 0
        self.last_ns = 0
        self.given_up = 0
        self._epoch_ns: int | None = None  # node time at which the machine's time base began
        hz = values['joint_states_hz']
        self._ticks_per_state = max(1, round(values['rate_hz'] / hz)) if hz else 0
        self._codec = JointStateCodec([node.get_name()], with_effort=False)
        self.points = node.make_publisher(JointTrajectoryPoint, SHAFT, SETPOINTS)
        self.joint_states = node.make_publisher(JointState, 'joint_states', SETPOINTS)
        self.tracks = TrackOutput(node, tracks)
        self._timer: Timer = node.create_timer(
            1.0 / values['rate_hz'], self._on_timer, clock=node.tick_clock, autostart=False)

    def start(self) -> None:
        """Begin to tick, or go on: the next clock reading is when the next tick is due."""
        self.schedule.resume()
        self._epoch_ns = None
        self._timer.reset()

    def pause(self) -> None:
        """Cease to tick."""
        self._timer.cancel()
        self.tracks.release()

    def close(self) -> None:
        """Give the timer back."""
        self._node.destroy_timer(self._timer)

    def publish(self, time_ns: int, phi: float, omega: float, alpha: float) -> None:
        """
        Publish a tick.

        Parameters
        ----------
        time_ns : int
            Its scheduled time [ns].
        phi, omega, alpha : float
            Angle [rad], speed [rad/s] and acceleration [rad/s²] of the shaft.

        """
        self.last_ns = time_ns
        self.tracks.answer(self._emit(phi, omega, alpha))
        if self._ticks_per_state and self.count % self._ticks_per_state == 0:
            self.joint_states.publish(self._codec.pack(self.stamp(time_ns), (phi,), (omega,)))
        self.count += 1

    def hold(self, phi: float) -> None:
        """
        Publish that the shaft stands, at the time of the last tick.

        Parameters
        ----------
        phi : float
            Where it stands [rad].

        """
        self._emit(phi, 0.0, 0.0)

    @property
    def begun(self) -> bool:
        """Tell whether the first tick has come, so that stamps have a meaning."""
        return self._epoch_ns is not None

    def stamp(self, time_ns: int) -> int:
        """
        Give the stamp of a tick.

        Parameters
        ----------
        time_ns : int
            Its scheduled time, while ticking [ns].

        Returns
        -------
        int
            The same instant in the node's time [ns].

        """
        return (self._epoch_ns or 0) + time_ns

    def health(self, phi: float, omega: float) -> dict[str, Any]:
        """
        Give the figures of the diagnostics that all nodes share that turn the shaft.

        Parameters
        ----------
        phi, omega : float
            Angle [rad] and speed [rad/s] of the shaft.

        Returns
        -------
        dict[str, Any]
            Figures by name.

        """
        schedule = self.schedule
        return {
            'speed_cpm': omega / RPM, 'angle_deg': phi % TURN / TURN * 360.0,
            'cycles': int(phi // TURN), 'ticks': self.count, 'missed_ticks': schedule.missed,
            'late_ticks': schedule.late, 'worst_lateness_us': 1e-3 * schedule.worst_ns,
            'clock_restarts': schedule.restarts,
        } | self.tracks.health()

    def _on_timer(self) -> None:
        node, schedule = self._node, self.schedule
        now_ns = node.tick_clock.now().nanoseconds
        if self._epoch_ns is None:
            # the timer's own grid, not this wake-up, says when tick 0 was due
            overdue = int(schedule.period_ns) - self._timer.time_until_next_call()
            now_ns -= overdue
            self._epoch_ns = (node.get_clock().now().nanoseconds - overdue
                              - self._time_ns(schedule.next_tick))
        restarts, expected = schedule.restarts, schedule.next_tick
        due = schedule.due(now_ns)
        if schedule.restarts != restarts:
            # the clock has started over: stamps go with it, the time base goes on
            self._epoch_ns = (node.get_clock().now().nanoseconds
                              - self._time_ns(due.start))
        if self._waits and due.start > expected:
            self._epoch_ns += schedule.time_ns(due.start) - schedule.time_ns(expected)
            self.given_up += due.start - expected
        for tick in due:
            self._tick(self._time_ns(tick))

    def _time_ns(self, tick: int) -> int:
        """Give the time of a tick on the machine's time base."""
        return self.schedule.time_ns(tick - self.given_up)

    def _emit(self, phi: float, omega: float, alpha: float) -> Point:
        point = Point(phi, omega, alpha, *divmod(self.last_ns, NANOSECONDS))
        self.points.publish(pack_point(*point))
        for listener in self._listeners:
            listener(point)
        return point
