# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""An electronic-cam axis: answers every shaft point with a setpoint on its motion curve."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
import math
import sys
from typing import Any

from cam_motion.errors import ConfigurationError
from cam_motion.io.axis import axis_table, build_axis, CoupledAxis
from cam_motion.io.format_parameters import STAGED
from cam_motion.io.axis_parameters import is_coupling
from cam_motion.io.parameters import ParameterSpec
from cam_motion.nodes import diagnostics
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.parameters import values_of
from cam_motion.nodes.qos import LATCHED, SETPOINTS
from cam_motion.nodes.runner import run
from cam_motion.nodes.staging import is_staged, own_values, Staging
from cam_motion.nodes.wire import pack_point, unpack_point
from cam_motion.runtime.coasting import Coasting
from cam_motion.runtime.follower_settings import FollowerState
from cam_motion.runtime.format_change import FormatFollower
from cam_motion.runtime.planning import Plan, TransitionError
from cam_motion.runtime.point import Point
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.watchdog import ShaftWatch
from cam_motion.units import RPM
from rclpy.publisher import Publisher
from rclpy.timer import Timer
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, Trigger
from trajectory_msgs.msg import JointTrajectoryPoint

SHAFT = 'shaft'
_LOOKS = 4  # for a silent shaft, within its timeout

Listener = Callable[[Point], None]


class CamAxis(ManagedNode):
    """
    Publishes position, velocity and acceleration of one axis for every shaft point received.

    Parameters
    ----------
    name : str
        Name of the node, which is the name of the axis.
    own_process : bool
        Whether shaft points come over the topic; else the owner of the process hands them over
        by calling `answer`.
    **options : Any
        Further arguments of `rclpy.node.Node`.

    """

    def __init__(self, name: str = 'cam_axis', own_process: bool = True, **options: Any) -> None:
        """Declare the parameters."""
        self.listeners: list[Listener] = []
        """Called with every setpoint: drives and following axes of the same process."""
        self.bound_listeners: list[Callable[[float], None]] = []
        """Called with the highest speed of the shaft [rad/s] whenever it changes."""
        self._own_process = own_process
        self._setpoints: Publisher | None = None
        super().__init__(name, **options)

    @property
    def table(self) -> tuple[ParameterSpec, ...]:
        """List the parameters, which depend on the cams that the axis has."""
        return (*axis_table(values_of(self)), *STAGED)

    def configure(self, values: dict[str, Any]) -> None:
        """
        Compile the cams and create the topics.

        Parameters
        ----------
        values : dict[str, Any]
            All parameters by flat name.

        """
        if 'segments' not in values and 'cams' not in values:
            self.get_logger().info(
                f'no parameters for a node named {self.get_name()}: is that the axis? '
                'Give its name with -r __node:=NAME')
        self.axis: CoupledAxis = build_axis(self.get_name(), own_values(values))
        settings = self.axis.values
        self._follower = FormatFollower(
            self.axis.layout, self.axis.settings, settings['engage_at_start'])
        self._stop_limits = RampLimits(settings['stop_acceleration'], settings['stop_jerk'])
        self._dead_time = settings['dead_time']
        self._watch = ShaftWatch(settings['master_timeout'])
        self._last: Point | None = None  # the last setpoint
        self._told: FollowerState | None = None  # the state that has been published
        self._bound = math.nan  # highest speed of the shaft as published [rad/s]
        self._answered = 0
        self._refused = 0
        self._coasting: Coasting | None = None
        self._own_timers: list[Timer] = []
        self._setpoints = self.make_publisher(JointTrajectoryPoint, '~/setpoint', SETPOINTS)
        self._max_speed = self.make_publisher(Float64, '~/max_speed_cpm', LATCHED)
        self._staging = Staging(self, self.axis, self._follower, self._adopt)
        self.make_service(SetBool, '~/engage', self._on_engage)
        self.make_service(Trigger, '~/reset', self._on_reset)
        if self._own_process:
            self.make_subscription(
                JointTrajectoryPoint, self.followed, self._on_shaft, SETPOINTS, raw=True)

    @property
    def followed(self) -> str:
        """Name the topic that the axis follows."""
        follows = self.axis.values['follows']
        return SHAFT if follows == SHAFT else f'{follows}/setpoint'

    def cleanup(self) -> None:
        """Drop the topics."""
        super().cleanup()
        self._setpoints = None

    def activate(self) -> None:
        """Wait for the shaft."""
        self._watch.forget()
        self._tell()
        self._staging.tell()
        self._own_timers = [self.create_timer(
            self._watch.timeout / _LOOKS, self._look_for_shaft, clock=self.steady_clock)]

    def deactivate(self) -> None:
        """Leave a hold setpoint behind: the last position, no velocity, no acceleration."""
        while self._own_timers:
            self.destroy_timer(self._own_timers.pop())
        self._coasting = None
        if self._last is not None:
            self._emit(self._last._replace(velocity=0.0, acceleration=0.0))
        self._told = None

    # Following

    def answer(self, point: Point) -> None:
        """
        Answer a shaft point with a setpoint.

        Parameters
        ----------
        point : Point
            Angle, speed and acceleration of the shaft.

        """
        if not self.active or self._coasting is not None:
            return
        if not self._watch.note(point, self.steady_now()):
            self.get_logger().error(
                f'{self.followed}: {self._watch.reason}: left out; are there two masters?',
                throttle_duration_sec=1.0)
            return
        self._follow(point)
        self._answered += 1

    def _on_shaft(self, data: bytes) -> None:
        point = unpack_point(data)
        if point is not None:
            self.answer(point)
            return
        self._refused += 1
        self.get_logger().warning(
            f'{self.followed}: a point without exactly one finite position, velocity and '
            'acceleration was left out', throttle_duration_sec=1.0)

    def _follow(self, point: Point) -> None:
        phi, omega, alpha, sec, nanosec = point
        lead = self._dead_time
        if lead:
            phi += lead * (omega + 0.5 * lead * alpha)
            omega += lead * alpha
        follower = self._follower
        position, velocity, acceleration = follower.answer(phi, omega, alpha)
        self._emit(Point(position, velocity, acceleration, sec, nanosec))
        if follower.state is not self._told:
            self._tell()

    def _emit(self, setpoint: Point) -> None:
        self._last = setpoint
        self._setpoints.publish(pack_point(*setpoint))
        for listener in self.listeners:
            listener(setpoint)

    def _tell(self) -> None:
        """Publish the state, and the highest speed of the shaft if it has changed."""
        self._told = self._follower.state
        self.set_state(self._told.value)
        bound = self._follower.speed_bound
        omega = math.inf if bound is None else bound.omega
        if omega != self._bound:
            self._bound = omega
            self._max_speed.publish(Float64(data=omega / RPM))
            for listener in self.bound_listeners:
                listener(omega)

    def _adopt(self, axis: CoupledAxis | None) -> None:
        """Be another axis from now on, if one is given, and say what that allows."""
        self.axis = axis or self.axis
        if self.active:
            self._tell()

    # Stopping without the shaft

    def begin_stop(self) -> None:
        """Follow a shaft that comes to rest; else stop on the axis' own curve."""
        if self.active:
            self._watch.begin_stop(self.steady_now())

    @property
    def stopped(self) -> bool:
        """Whether the axis stands."""
        if not self.active or self._coasting is not None:
            return not self.active or self._coasting.over
        if self._watch.at_rest:
            return True
        if self._watch.goes_on(self.steady_now()):
            self._coast('the axis was asked to end while the shaft went on', FollowerState.HELD)
        return False

    def _look_for_shaft(self) -> None:
        now = self.steady_now()
        watch = self._watch
        if self._coasting is not None or not watch.lost(now):
            return
        if watch.astray:
            self._coast(watch.reason, FollowerState.FAULT)
        else:
            self._coast(f'{self.followed} has been silent for {watch.age(now):.3g} s',
                        FollowerState.HELD)

    def _coast(self, reason: str, state: FollowerState) -> None:
        """Turn the shaft on from its last point to rest, so as to stop on the curve."""
        watch = self._watch
        self.get_logger().error(f'{reason}: stopping on the curve')
        self._coasting = Coasting(
            watch.last, watch.period, self.steady_now() - watch.age(self.steady_now()),
            self._stop_limits, reason, state)
        self._follower.coast()
        self._tell()
        self._own_timers.append(self.create_timer(
            watch.period, self._on_coast, clock=self.steady_clock))

    def _on_coast(self) -> None:
        coasting = self._coasting
        for point in coasting.due(self.steady_now()):
            self._follow(point)
        if coasting.over:
            self.destroy_timer(self._own_timers.pop())
            self._coasting = None
            self._follower.hold(coasting.state, coasting.reason)
            self._watch.forget()
            self._tell()

    # Commands

    def _on_engage(self, request: SetBool.Request, response: SetBool.Response) -> Any:
        if request.data:
            return self._command(response, self._follower.engage, 'engages', 'is on its curve')
        return self._command(response, self._follower.disengage, 'disengages', 'stands')

    def _on_reset(self, request: Trigger.Request, response: Trigger.Response) -> Any:
        return self._command(response, self._follower.reset, 'resumes', 'is ready')

    def _command(self, response: Any, work: Callable[[], Plan | None], planned: str,
                 done: str) -> Any:
        response.success = False
        if not self.active or self._coasting is not None:
            response.message = 'the node is not active' if not self.active else (
                'the axis is stopping on its curve: ask again when it stands')
            return response
        refusal = self._staging.refusal
        if refusal and not (self._staging.waits and work == self._follower.reset):
            response.message = refusal
            return response
        try:
            plan = work()
        except TransitionError as error:
            response.message = str(error)
            return response
        response.success = True
        response.message = f'{self.get_name()} ' + (
            done if plan is None else f'{planned} {plan.text(self.axis.unit)}')
        self.get_logger().info(response.message)
        self._tell()
        return response

    def is_live(self, name: str) -> bool:
        """
        Tell whether a parameter may change while the node is configured.

        Parameters
        ----------
        name : str
            Name of the parameter.

        Returns
        -------
        bool
            Whether it belongs to a coupling, a transition, the limits or a staged format.

        """
        return is_coupling(name) or is_staged(name)

    def take_changes(self, changes: Mapping[str, Any]) -> str:
        """
        Go over to other couplings, cams, limits or transitions, all of them or none.

        Parameters
        ----------
        changes : Mapping[str, Any]
            New values by flat name.

        Returns
        -------
        str
            Why that cannot be; empty when it is under way.

        """
        if any(map(is_staged, changes)):
            return self._staging.stage(changes)
        if refusal := self._staging.refusal:
            return refusal
        given = own_values({**values_of(self), **changes})
        try:
            axis = build_axis(self.get_name(), {k: v for k, v in given.items() if v is not None})
        except ConfigurationError as error:
            return '; '.join(map(str, error.problems))
        follower = self._follower
        before = follower.settings
        follower.settings = axis.settings
        try:
            old = follower.layout
            if (axis.layout.couplings, axis.layout.active) != (old.couplings, old.active):
                new = replace(axis.layout, cams=old.cams)
                plan = follower.change(new)
                if plan is not None:
                    self.get_logger().info(
                        f'{self.get_name()} changes {plan.text(self.axis.unit)}')
        except TransitionError as error:
            follower.settings = before
            return str(error)
        self._adopt(axis)
        return ''

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the axis is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics.

        """
        if self._setpoints is None:
            return diagnostics.OK, {}
        last, watch, follower = self._last, self._watch, self._follower
        values: dict[str, Any] = {
            'setpoints': self._answered, 'refused_points': self._refused,
            'points_of_another_shaft': watch.refused}
        if last is not None:
            values |= {'position': last.position, 'velocity': last.velocity,
                       'acceleration': last.acceleration, 'unit': self.axis.unit,
                       'shaft_age_s': watch.age(self.steady_now())}
        bound = follower.speed_bound
        if bound is not None:
            values |= {'max_speed_cpm': bound.omega / RPM,
                       'held_back_by': f'{bound.segment}: {bound.quantity}'}
        if follower.reason:
            values['reason'] = follower.reason
        if follower.state in (FollowerState.HELD, FollowerState.FAULT) or watch.reason:
            return diagnostics.ERROR, values
        return diagnostics.WARN if self._refused else diagnostics.OK, values


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
    return run(lambda: [CamAxis()], argv)


if __name__ == '__main__':
    sys.exit(main())
