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
from functools import partial
import math
from typing import Any

from cam_motion.errors import ConfigurationError
from cam_motion.io.axis import names_in
from cam_motion.io.axis_parameters import SHAFT
from cam_motion.io.machine import build_master
from cam_motion.io.parameters import MASTER_SHAFT, ParameterSpec
from cam_motion.io.tracks import track_table
from cam_motion.nodes import diagnostics
from cam_motion.nodes.axes_beside import AxesBeside, reckon, Reckoning
from cam_motion.nodes.encoder_input import EncoderInput
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.parameters import section_of, values_of
from cam_motion.nodes.qos import LATCHED, SETPOINTS
from cam_motion.nodes.runner import run
from cam_motion.nodes.shaft_ticker import Listener, ShaftTicker
from cam_motion.runtime.shaft import Shaft, ShaftError, ShaftMode
from cam_motion.runtime.shaft_motion import ShaftState
from cam_motion.units import RPM
from rclpy.parameter import Parameter
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, Trigger

_SLACK = 1.001  # of the speed allowed: a measured one fluctuates
_STOP_WITHIN = 3.0  # an ordinary stop that takes longer gives way to the quick stop [s]


def sections_beside() -> dict[str, dict[str, Any]]:
    """
    Read the parameters of the axes of the line from the parameter files of this process.

    Returns
    -------
    dict[str, dict[str, Any]]
        Parameters by name of the axis and flat name; of axes that stand in a file only.

    """
    try:
        names = names_in(section_of('line'), 'axes')
        return {name: section for name in names if (section := section_of(name))}
    except ConfigurationError:
        return {}  # ROS has read the file as it could; the offline check says what is wrong


class MasterShaft(ManagedNode):
    """
    Publishes the angle, speed and acceleration of the virtual shaft at every tick.

    Parameters
    ----------
    name : str
        Name of the node.
    own_process : bool
        Whether the axes say over topics how fast they allow the shaft to run; else the owner of
        the process calls `obey`.
    **options : Any
        Further arguments of `rclpy.node.Node`.

    """

    LIVE = frozenset({'speed_cpm'})

    def __init__(self, name: str = 'master_shaft', own_process: bool = True, **options: Any,
                 ) -> None:
        """Declare the parameters."""
        super().__init__(name, **options)
        self._own_process = own_process
        self.listeners: list[Listener] = []
        """Called with every tick: axes of the same process, which need no topic."""
        self.sections: Callable[[], Mapping[str, Mapping[str, Any]]] = sections_beside
        """Gives the parameters of all axes of the line, by name."""
        self._ticker: ShaftTicker | None = None

    @property
    def table(self) -> tuple[ParameterSpec, ...]:
        """List the parameters, which depend on the tracks that the shaft has."""
        return (*MASTER_SHAFT, *track_table(values_of(self), of_axis=False))

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
        self._start_delay = checked['start_delay'] if checked['run_at_start'] else None
        self._run_at: float | None = None  # when the shaft is to start on its own
        self._now = 0.0  # time of the last tick: commands take effect behind it
        self._allowed: dict[str, float] = {}  # highest speed by axis [rad/s]
        self._ticker = ShaftTicker(self, checked, self.listeners, self._tick, settings.tracks)
        self._encoder = EncoderInput(self, checked, self._ticker) if (
            checked['encoder.topic']) else None
        self.make_subscription(
            Float64, '~/speed_cpm', self._on_speed, SETPOINTS)
        sections = self.sections()
        wanted = checked['obey'] or list(sections)
        reckoning = reckon(sections, wanted)
        self._axes = AxesBeside(self, sections, wanted, self._on_reckoned) if sections else None
        self._on_reckoned(reckoning)
        for axis in wanted if self._own_process else ():
            if axis in reckoning.cascaded:
                continue
            self.make_subscription(Float64, f'{axis}/max_speed_cpm', partial(
                lambda message, axis: self.obey(axis, message.data * RPM), axis=axis), LATCHED)
        self.make_service(SetBool, '~/run', self._on_run)
        for name, done in (('stop_at_cycle_end', 'stops at the end of a cycle'),
                           ('quick_stop', 'stops quickly'), ('reset', 'is ready to run')):
            self.make_service(Trigger, f'~/{name}', self._command(name, done))

    def _on_reckoned(self, reckoning: Reckoning) -> None:
        """Reckon with axes as they are now."""
        self._reckoning = reckoning
        self._shaft.make_room(self._now, reckoning.room)
        for name, omega in reckoning.cascaded.items():
            # the way to another coupling is planned for the speed allowed before it, at most
            most = math.inf if reckoning.final else self._allowed.get(name, math.inf)
            self.obey(name, min(omega, most))

    def obey(self, axis: str, omega: float) -> None:
        """
        Run no faster than an axis allows, from now on.

        Parameters
        ----------
        axis : str
            Its name.
        omega : float
            Highest speed of the shaft [rad/s]; infinite where the axis has no limit.

        """
        if self._ticker is None or not omega >= 0.0:
            return
        self._allowed[axis] = omega
        was = self._shaft.target
        self._shaft.allow(self._now, min(self._allowed.values()))
        if self._encoder is None and abs(self._shaft.speed) > self._shaft.allowed and (
                self._shaft.target != was):
            self.get_logger().warning(
                f'{self._slowest} holds the shaft back to {self._shaft.allowed / RPM:.5g} '
                f'cycles/min; it is set to {self._shaft.speed / RPM:.5g}')

    def _excess(self, omega: float) -> str:
        """Say by how much a shaft that cannot be slowed down is too fast; empty if it is not."""
        if abs(omega) <= self._shaft.allowed * _SLACK:
            return ''
        return (f'the encoder turns the shaft at {abs(omega) / RPM:.4g} cycles/min, '
                f'{self._slowest} keeps its limits up to {self._shaft.allowed / RPM:.4g}')

    @property
    def _slowest(self) -> str:
        """Name the axis that holds the shaft back, and what of it."""
        axis = min(self._allowed, key=lambda axis: self._allowed[axis])
        return self._reckoning.culprit(axis, self._allowed[axis])

    def cleanup(self) -> None:
        """Drop topics, services and the timer."""
        super().cleanup()
        if self._ticker is not None:
            self._ticker.close()
            self._ticker = None

    def activate(self) -> None:
        """Begin to tick; the shaft stands for a moment so that everything finds each other."""
        quick = self._shaft.mode(self._now) is ShaftMode.QUICK_STOPPED
        if self._start_delay is not None and not quick:
            self._run_at = self._now + self._start_delay
        self._ticker.start()
        self.set_state(self._shaft.mode(self._now).value)

    def deactivate(self) -> None:
        """Cease to tick; a shaft that still turns is brought to a hold point where it is."""
        self._ticker.pause()
        state = self._shaft_now
        if state.omega:
            self.get_logger().warning(
                f'deactivated while turning at {state.omega / RPM:.1f} cycles/min')
            self._ticker.hold(state.phi)
        self._shaft = self._shaft.at_rest(state.phi)
        if self._encoder is not None:
            self._encoder.reset()

    @property
    def _shaft_now(self) -> ShaftState:
        """Give the shaft at the last tick."""
        return self._shaft.state(self._now) if self._encoder is None else self._encoder.state

    def begin_stop(self) -> None:
        """Ramp down, by the quick stop if the ordinary one would take too long."""
        if not self.active:
            return
        if self._encoder is not None:
            self._encoder.release(self._now, 'asked to end')
            return
        self._run_at = None
        self._shaft.stop(self._now)
        if self._shaft.settled_at - self._now > _STOP_WITHIN:
            self._shaft.quick_stop(self._now)

    @property
    def stopped(self) -> bool:
        """Whether the shaft stands, and has said so."""
        if self._encoder is not None:
            return not self.active or self._encoder.stands
        return not self.active or self._shaft.state(self._now).omega == 0.0

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the shaft is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics.

        """
        if self._ticker is None:
            return diagnostics.OK, {}
        phi, omega, _ = self._shaft_now
        if self._encoder is not None:
            values = self._ticker.health(phi, omega) | self._encoder.health()
            if excess := self._excess(omega):
                values.setdefault('reason', excess)
            bad = self._encoder.jumps or self._ticker.tracks.misses
            return (diagnostics.ERROR if 'reason' in values else
                    diagnostics.WARN if bad else diagnostics.OK), values
        values = self._ticker.health(phi, omega) | {'set_speed_cpm': self._shaft.speed / RPM}
        if math.isfinite(self._shaft.allowed):
            values |= {'allowed_speed_cpm': self._shaft.allowed / RPM}
        if abs(self._shaft.speed) > self._shaft.allowed:
            values |= {'held_back_by': self._slowest}
        if self.count_publishers(SHAFT) > 1:
            values |= {'reason': 'another node publishes the shaft too'}
            return diagnostics.ERROR, values
        bad = values['missed_ticks'] or self._ticker.tracks.misses
        return diagnostics.WARN if bad else diagnostics.OK, values

    def take_changes(self, changes: Mapping[str, Any]) -> str:
        """
        Take over a new set speed.

        Parameters
        ----------
        changes : Mapping[str, Any]
            ``speed_cpm`` alone [cycles/min].

        Returns
        -------
        str
            Empty.

        """
        self._set_speed(changes['speed_cpm'])
        return ''

    def _tick(self, time_ns: int) -> None:
        t = time_ns * 1e-9
        if self._axes is not None:
            self._axes.tick(t)
        if self._encoder is not None:
            self._now = t
            state = self._encoder.tick(t)
            if state is not None:
                self._ticker.publish(time_ns, *state)
                if excess := self._excess(state.omega):
                    self.get_logger().error(excess, throttle_duration_sec=5.0)
            self.set_state(self._encoder.text)
            return
        if self._run_at is not None and t >= self._run_at:
            self._run_at = None
            self._shaft.run(t)
        self._now = t
        self._ticker.publish(time_ns, *self._shaft.state(t))
        self.set_state(self._shaft.mode(t).value)

    def _set_speed(self, speed_cpm: float) -> bool:
        try:
            self._shaft.set_speed(self._now, speed_cpm * RPM)
        except ShaftError as error:
            self.get_logger().error(f'speed_cpm: {error}')
            return False
        return True

    def _on_speed(self, message: Float64) -> None:
        """Take over a set speed, and let the parameter say so."""
        if self._set_speed(message.data) and self.get_parameter('speed_cpm').value != message.data:
            self.own_change = True
            try:
                self.set_parameters([Parameter('speed_cpm', value=message.data)])
            finally:
                self.own_change = False

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
            if self._encoder is not None:
                if name != 'reset' or not self._encoder.stands:
                    response.message = 'the shaft follows its encoder: it takes no commands' if (
                        name != 'reset') else 'the shaft is still turning'
                    return response
                self._encoder.reset()
                response.success, response.message = True, 'the shaft waits for its encoder'
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
