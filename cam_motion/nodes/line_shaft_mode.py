# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A drive that turns the shaft which all axes follow: motor, gearbox, flywheel, cam load."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from cam_motion.drive.live_shaft import LiveShaft, LiveState
from cam_motion.drive.shaft_torque import Command
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.axis import build_axis
from cam_motion.io.axis_parameters import SHAFT
from cam_motion.io.cam_drive_config import build_cam_drive, cam_on_shaft
from cam_motion.io.cam_drive_parameters import cam_drive_table
from cam_motion.io.parameters import ParameterSpec
from cam_motion.motion.profile import CamProfile
from cam_motion.nodes import diagnostics
from cam_motion.nodes.drive_mode import DriveMode
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.parameters import section_of
from cam_motion.nodes.qos import SETPOINTS
from cam_motion.nodes.shaft_ticker import ShaftTicker
from cam_motion.nodes.wire import JointStateCodec
from cam_motion.runtime.ticks import NANOSECONDS
from cam_motion.units import DEGREE, RPM, TURN
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger

JOINTS = ('motor', 'load', 'shaft')

_Callback = Callable[[Any, Any], Any]


class LineShaftMode(DriveMode):
    """Turns the shaft by its own equation of motion; a brake holds and stops it."""

    TURNS_SHAFT = True

    def __init__(self, node: ManagedNode, own_process: bool) -> None:
        """Know no drive yet."""
        super().__init__(node, own_process)
        self._ticker: ShaftTicker | None = None

    @classmethod
    def table(cls, given: Mapping[str, Any]) -> tuple[ParameterSpec, ...]:
        """List the parameters of a cam drive and its parts; see `DriveMode.table`."""
        return cam_drive_table(given)

    def configure(self, values: Mapping[str, Any]) -> None:
        """
        Build the drive with the cam of its axis; make topics and services.

        Parameters
        ----------
        values : Mapping[str, Any]
            All parameters by flat name.

        """
        name, axis = self.node.get_name(), values.get('axis')
        profiles = {}
        if isinstance(axis, str):
            profiles[axis] = self._profile_of(axis, str(values.get('machine', '')))
        settings = build_cam_drive(name, values, profiles)
        checked = settings.values
        self.axis = settings.axis
        self._nominal = settings.drive.nominal_speed
        self._ratio = settings.drive.gearbox.ratio
        self._live = LiveShaft(
            settings.drive, round(checked['substep'] * NANOSECONDS), settings.brake_torque)
        self._last: LiveState = self._live.state(0)
        self._now_ns = 0  # time of the last tick: commands take effect behind it
        self._start_delay = checked['start_delay'] if checked['run_at_start'] else None
        self._run_at_ns: int | None = None  # when the motor is to be switched on on its own
        self._quick = False  # stopped quickly, and not reset since
        self._peak_torque = 0.0
        self._stops = 0  # with the motor on, as far as they have been looked at
        self._stopped_at: float | None = None  # the last since it was switched on [rad]
        self._codec = JointStateCodec(JOINTS, with_effort=True)
        node = self.node
        self._ticker = ShaftTicker(
            node, checked, self.listeners, self._tick, settings.tracks, waits=True)
        self._states = node.make_publisher(JointState, '~/drive_state', SETPOINTS)
        node.make_service(SetBool, '~/run', self._when_active(
            lambda request: self._run() if request.data else self._switch_off()))
        node.make_service(Trigger, '~/quick_stop', self._when_active(
            lambda _: self._quick_stop()))
        node.make_service(Trigger, '~/reset', self._when_active(lambda _: self._reset()))

    def _profile_of(self, axis: str, machine: str) -> CamProfile:
        """Compile the cam of the axis: from the same process, else from the machine file."""
        given = section_of(axis, machine) if self.section is None else self.section(axis)
        if not given:
            raise ConfigurationError([Problem(
                'axis', axis, 'a drive that turns the shaft needs the cam of its axis, and there '
                'is no section of that name',
                'give the machine file, by --params-file or by the parameter machine')])
        try:
            found = build_axis(axis, given)
        except ConfigurationError as error:
            if self.section is None:
                raise ConfigurationError(
                    problem.below(axis) for problem in error.problems) from None
            raise ConfigurationError([Problem(
                'axis', axis, 'its cam cannot be used', 'see what that axis says')]) from None
        return cam_on_shaft(found)

    def cleanup(self) -> None:
        """Give the timer back."""
        if self._ticker is not None:
            self._ticker.close()
            self._ticker = None

    def activate(self) -> None:
        """Begin to tick; the shaft stands for a moment so that everything finds each other."""
        if self._start_delay is not None and not self._quick:
            self._run_at_ns = self._now_ns + round(self._start_delay * NANOSECONDS)
        self._ticker.start()
        self._tell_state()

    def deactivate(self) -> None:
        """Cease to tick; a shaft that still turns is brought to a hold point where it is."""
        self._ticker.pause()
        self._run_at_ns = None
        self._live.arrest(self._now_ns)
        if self._last.omega:
            self.node.get_logger().warning(
                f'deactivated while turning at {self._last.omega / RPM:.1f} rpm')
            self._ticker.hold(self._last.phi)
        self._last = self._live.state(self._now_ns)

    def begin_stop(self) -> None:
        """Switch the motor off and apply the brake."""
        if self.node.active:
            self._run_at_ns = None
            self._live.tell(self._now_ns, Command.BRAKE)

    @property
    def stopped(self) -> bool:
        """Whether the shaft stands, and has said so."""
        return not self.node.active or self._last.omega == 0.0 == self._last.alpha

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the drive is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics: an error where another node publishes the
            shaft too, a warning where ticks were missed, or the motor does not get the load
            round.

        """
        if self._ticker is None:
            return diagnostics.OK, {}
        last = self._last
        values = self._ticker.health(last.phi, last.omega) | {
            'nominal_speed_cpm': self._nominal / RPM,
            'dropped_s': self._ticker.given_up / self._ticker.schedule.rate,
            'motor_torque': last.motor_torque, 'brake_torque': last.brake_torque,
            'motor_speed_rpm': self._ratio * last.omega / RPM,
            'peak_motor_torque': self._peak_torque, 'stops_under_power': self._live.stops,
        }
        if self.node.count_publishers(SHAFT) > 1:
            values |= {'reason': 'another node publishes the shaft too'}
            return diagnostics.ERROR, values
        bad = values['missed_ticks'] or self._stalls or self._ticker.tracks.misses
        return diagnostics.WARN if bad else diagnostics.OK, values

    @property
    def _stalls(self) -> bool:
        """Whether the motor is on, but has not got the shaft round since that last stopped."""
        return (self._live.command is Command.RUN and self._stopped_at is not None
                and self._last.phi < self._stopped_at + TURN)

    def _tick(self, time_ns: int) -> None:
        if self._run_at_ns is not None and time_ns >= self._run_at_ns:
            # when it was due, not when it was found to be: the motion is that of any other rate
            self._switch_on(max(self._run_at_ns, self._now_ns))
            self._run_at_ns = None
        self._now_ns = time_ns
        self._last = last = self._live.state(time_ns)
        if self._live.stops != self._stops:
            if not self._stalls:  # said once, not each time that it swings back
                self.node.get_logger().warning(
                    f'the motor does not get the load round: it stalls at '
                    f'{last.phi % TURN / DEGREE:.1f} deg')
            self._stops, self._stopped_at = self._live.stops, last.phi
        self._peak_torque = max(self._peak_torque, abs(last.motor_torque))
        self._ticker.publish(time_ns, last.phi, last.omega, last.alpha)
        ratio = self._ratio
        self._states.publish(self._codec.pack(
            self._ticker.stamp(time_ns), (ratio * last.phi, last.phi, last.phi),
            (ratio * last.omega, last.omega, last.omega),
            (last.motor_torque, last.load_torque, last.shaft_torque)))
        self._tell_state()

    def _tell_state(self) -> None:
        stands = self._live.standing
        if self._live.command is Command.RUN:
            text = 'stalled' if self._stalls else 'running'
        elif self._live.command is Command.COAST:
            text = 'stopped' if stands else 'coasting'
        elif self._quick:
            text = 'quick_stopped' if stands else 'quick_stopping'
        else:
            text = 'stopped' if stands else 'stopping'
        self.node.set_state(text)

    def _when_active(self, command: Callable[[Any], tuple[bool, str]]) -> _Callback:
        """Make a service callback from a command, which says whether it is obeyed, and why."""
        def callback(request: Any, response: Any) -> Any:
            if self.node.active:
                self._run_at_ns = None
                response.success, response.message = command(request)
                self._tell_state()
            else:
                response.success, response.message = False, 'the node is not active'
            return response
        return callback

    def _run(self) -> tuple[bool, str]:
        if self._quick:
            return False, ('the shaft has been stopped quickly: reset it before the motor is '
                           'switched on again')
        if self._live.command is not Command.RUN:
            self._switch_on(self._now_ns)
        return True, 'the motor is on'

    def _switch_on(self, time_ns: int) -> None:
        self._stopped_at = None
        self._live.tell(time_ns, Command.RUN)

    def _switch_off(self) -> tuple[bool, str]:
        if self._live.command is Command.RUN:
            self._live.tell(self._now_ns, Command.COAST)
        return True, 'the motor is off'

    def _quick_stop(self) -> tuple[bool, str]:
        self._quick = True
        self._live.tell(self._now_ns, Command.BRAKE)
        return True, 'the motor is off, and the brake stops the shaft'

    def _reset(self) -> tuple[bool, str]:
        if self._quick and not self._live.standing:
            return False, 'the shaft is still turning: reset it when it stands'
        self._quick = False
        return True, 'the shaft is ready to run; its brake holds it until then'
