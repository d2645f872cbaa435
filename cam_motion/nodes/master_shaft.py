# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The master shaft: turns the virtual shaft and publishes where it is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
import sys
from typing import Any

from cam_motion.io.machine import build_master
from cam_motion.io.parameters import MASTER_SHAFT
from cam_motion.nodes import diagnostics
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.qos import SETPOINTS
from cam_motion.nodes.runner import run
from cam_motion.nodes.wire import JointStateCodec, pack_point, Point
from cam_motion.runtime.shaft import Shaft, ShaftError, ShaftMode
from cam_motion.runtime.ticks import NANOSECONDS, TickSchedule
from cam_motion.units import RPM, TURN
from rclpy.timer import Timer
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, Trigger
from trajectory_msgs.msg import JointTrajectoryPoint

SHAFT = 'shaft'
_SIM_TIME_CATCH_UP = 1.0  # /clock may come in coarse steps: its ticks are all carried out [s]
_STOP_WITHIN = 3.0  # an ordinary stop that takes longer gives way to the quick stop [s]

Listener = Callable[[Point], None]


class MasterShaft(ManagedNode):
    """
    Publishes the angle, speed and acceleration of the virtual shaft at every tick.

    Parameters
    ----------
    name : str
        Name of the node.
    **options : Any
        Further arguments of `rclpy.node.Node`.

    """

    TABLE = MASTER_SHAFT
    LIVE = frozenset({'speed_cpm'})

    def __init__(self, name: str = 'master_shaft', **options: Any) -> None:
        """Declare the parameters."""
        super().__init__(name, **options)
        self.listeners: list[Listener] = []
        """Called with every tick: axes of the same process, which need no topic."""
        self._timer: Timer | None = None

    def configure(self, values: dict[str, Any]) -> None:
        """
        Build the shaft and its topics and services.

        Parameters
        ----------
        values : dict[str, Any]
            All parameters by flat name.

        """
        settings = build_master(self.get_name(), values)
        checked = settings.values
        self._shaft: Shaft = settings.shaft()
        catch_up = checked['max_catch_up']
        self._schedule = TickSchedule(
            checked['rate_hz'], max(catch_up, _SIM_TIME_CATCH_UP) if self.sim_time else catch_up)
        self._start_delay = checked['start_delay'] if checked['run_at_start'] else None
        self._run_at: float | None = None  # when the shaft is to start on its own
        self._now = 0.0  # time of the last tick: commands take effect behind it
        self._last_ns = 0
        self._ticks = 0
        self._epoch_ns: int | None = None  # node time at which the machine's time base began
        hz = checked['joint_states_hz']
        self._ticks_per_state = max(1, round(checked['rate_hz'] / hz)) if hz else 0
        self._codec = JointStateCodec([self.get_name()], with_effort=False)
        self._points = self.make_publisher(JointTrajectoryPoint, SHAFT, SETPOINTS)
        self._joint_states = self.make_publisher(JointState, 'joint_states', SETPOINTS)
        self.make_subscription(
            Float64, '~/speed_cpm', lambda message: self._set_speed(message.data), SETPOINTS)
        self.make_service(SetBool, '~/run', self._on_run)
        for name, done in (('stop_at_cycle_end', 'stops at the end of a cycle'),
                           ('quick_stop', 'stops quickly'), ('reset', 'is ready to run')):
            self.make_service(Trigger, f'~/{name}', self._command(name, done))
        self._timer = self.create_timer(
            1.0 / checked['rate_hz'], self._on_timer, clock=self.tick_clock, autostart=False)

    def cleanup(self) -> None:
        """Drop topics, services and the timer."""
        super().cleanup()
        if self._timer is not None:
            self.destroy_timer(self._timer)
            self._timer = None

    def activate(self) -> None:
        """Begin to tick; the shaft stands for a moment so that everything finds each other."""
        self._schedule.resume()
        self._epoch_ns = None
        quick = self._shaft.mode(self._now) is ShaftMode.QUICK_STOPPED
        if self._start_delay is not None and not quick:
            self._run_at = self._now + self._start_delay
        self._timer.reset()
        self.set_state(self._shaft.mode(self._now).value)

    def deactivate(self) -> None:
        """Cease to tick; a shaft that still turns is brought to a hold point where it is."""
        self._timer.cancel()
        state = self._shaft.state(self._now)
        if state.omega:
            self.get_logger().warning(
                f'deactivated while turning at {state.omega / RPM:.1f} cycles/min')
            self._emit(Point(state.phi, 0.0, 0.0, *divmod(self._last_ns, NANOSECONDS)))
        self._shaft = self._shaft.at_rest(state.phi)

    def begin_stop(self) -> None:
        """Ramp down, by the quick stop if the ordinary one would take too long."""
        if not self.active:
            return
        self._run_at = None
        self._shaft.stop(self._now)
        if self._shaft.settled_at - self._now > _STOP_WITHIN:
            self._shaft.quick_stop(self._now)

    @property
    def stopped(self) -> bool:
        """Whether the shaft stands, and has said so."""
        return not self.active or self._shaft.state(self._now).omega == 0.0

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the shaft is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics.

        """
        if self._timer is None:
            return diagnostics.OK, {}
        state = self._shaft.state(self._now)
        schedule = self._schedule
        return diagnostics.WARN if schedule.missed else diagnostics.OK, {
            'speed_cpm': state.omega / RPM, 'set_speed_cpm': self._shaft.speed / RPM,
            'angle_deg': state.phi % TURN / TURN * 360.0, 'cycles': int(state.phi // TURN),
            'ticks': self._ticks, 'missed_ticks': schedule.missed,
            'late_ticks': schedule.late, 'worst_lateness_us': 1e-3 * schedule.worst_ns,
            'clock_restarts': schedule.restarts,
        }

    def take_change(self, name: str, value: Any) -> None:
        """
        Take over a new set speed.

        Parameters
        ----------
        name : str
            ``speed_cpm``.
        value : Any
            The speed [cycles/min].

        """
        self._set_speed(value)

    def _on_timer(self) -> None:
        clock = self.tick_clock
        now_ns = clock.now().nanoseconds
        if self._epoch_ns is None:
            # the timer's own grid, not this wake-up, says when tick 0 was due
            overdue = int(self._schedule.period_ns) - self._timer.time_until_next_call()
            now_ns -= overdue
            self._epoch_ns = (self.get_clock().now().nanoseconds - overdue
                              - self._schedule.time_ns(self._schedule.next_tick))
        restarts = self._schedule.restarts
        due = self._schedule.due(now_ns)
        if self._schedule.restarts != restarts:
            # the clock has started over: stamps go with it, the time base goes on
            self._epoch_ns = (self.get_clock().now().nanoseconds
                              - self._schedule.time_ns(due.start))
        for tick in due:
            self._tick(self._schedule.time_ns(tick))

    def _tick(self, time_ns: int) -> None:
        t = time_ns * 1e-9
        if self._run_at is not None and t >= self._run_at:
            self._run_at = None
            self._shaft.run(t)
        self._now = t
        self._last_ns = time_ns
        phi, omega, alpha = self._shaft.state(t)
        sec, nanosec = divmod(time_ns, NANOSECONDS)
        self._emit(Point(phi, omega, alpha, sec, nanosec))
        if self._ticks_per_state and self._ticks % self._ticks_per_state == 0:
            self._joint_states.publish(
                self._codec.pack(self._epoch_ns + time_ns, (phi,), (omega,)))
        self.set_state(self._shaft.mode(t).value)
        self._ticks += 1

    def _emit(self, point: Point) -> None:
        self._points.publish(pack_point(*point))
        for listener in self.listeners:
            listener(point)

    def _set_speed(self, speed_cpm: float) -> None:
        try:
            self._shaft.set_speed(self._now, speed_cpm * RPM)
        except ShaftError as error:
            self.get_logger().error(f'speed_cpm: {error}')

    def _on_run(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        if request.data:
            command = self._command('run', 'runs')
        else:
            command = self._command('stop', 'stops')
        return command(request, response)

    def _command(self, name: str, done: str) -> Callable[..., Any]:
        """Make a service callback from a command of the shaft."""
        def callback(request: Any, response: Any) -> Any:
            response.success = False
            if not self.active:
                response.message = 'the node is not active'
                return response
            self._run_at = None
            try:
                getattr(self._shaft, name)(self._now)
            except ShaftError as error:
                response.message = str(error)
                return response
            mode: ShaftMode = self._shaft.mode(self._now)
            self.set_state(mode.value)
            response.success = True
            response.message = f'the shaft {done}'
            return response
        return callback


def main(argv: list[str] | None = None) -> int:
    """
    Run the node as a process.

    Parameters
    ----------
    argv : list[str], optional
        Command line; None takes that of the process.

    Returns
    -------
    int
        Exit code.

    """
    return run(lambda: [MasterShaft()], argv)


if __name__ == '__main__':
    sys.exit(main())
