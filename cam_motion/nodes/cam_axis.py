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
from typing import Any

from cam_motion.errors import ConfigurationError
from cam_motion.io.axis import ANYWHERE, axis_table, build_axis, CoupledAxis, Reach
from cam_motion.io.axis_limits import axes_of, reach_of
from cam_motion.io.axis_parameters import is_coupling, SHAFT
from cam_motion.io.format_parameters import STAGED
from cam_motion.io.parameters import ParameterSpec
from cam_motion.motion.limits import SpeedBound
from cam_motion.nodes import diagnostics
from cam_motion.nodes.axis_outputs import AxisOutputs, DriveValues
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.parameters import section_of, values_of
from cam_motion.nodes.qos import LATCHED, SETPOINTS
from cam_motion.nodes.runner import run
from cam_motion.nodes.shaft_input import ShaftInput
from cam_motion.nodes.staging import is_staged, own_values, Staging
from cam_motion.nodes.warm_up import warm_up_planning
from cam_motion.nodes.wire import pack_point
from cam_motion.runtime.dead_time import DeadTime
from cam_motion.runtime.follower_settings import FollowerState
from cam_motion.runtime.format_change import FormatFollower
from cam_motion.runtime.planning import Plan, TransitionError
from cam_motion.runtime.point import Point
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft_motion import ShaftState
from cam_motion.units import RPM
from rclpy.publisher import Publisher
import scipy.interpolate  # noqa: F401 (for laws of later formats: not in the middle of a tick)
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, Trigger
from trajectory_msgs.msg import JointTrajectoryPoint

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
        self.source: Callable[[], AxisOutputs] | None = None
        """Gives the outputs of the axis that is followed, where it is of the same process."""
        self.drive: DriveValues | None = None
        """Gives the parameters of the drive of the axis, where it is of the same process."""
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
        self._reach = _reach_beside(values)
        self.axis: CoupledAxis = build_axis(self.get_name(), own_values(values), self._reach)
        settings = self.axis.values
        self._follower = FormatFollower(
            self.axis.layout, self.axis.settings, settings['engage_at_start'])
        warm_up_planning(self.axis.layout)
        lead = settings['dead_time']
        self._dead_time = DeadTime(lead) if lead else None
        self._shaft = ShaftInput(
            self, self.followed, settings['master_timeout'],
            RampLimits(settings['stop_acceleration'], settings['stop_jerk']),
            self._follow, self._on_shaft_lost, of_axis=settings['follows'] != SHAFT)
        self._last: Point | None = None  # the last setpoint
        self._told: FollowerState | None = None  # the state that has been published
        self._told_revision = 0  # and what else of the follower has been told with it
        self._bound = math.nan  # highest speed of the shaft as published [rad/s]
        self._setpoints = self.make_publisher(JointTrajectoryPoint, '~/setpoint', SETPOINTS)
        self._max_speed = self.make_publisher(Float64, '~/max_speed_cpm', LATCHED)
        self.outputs = AxisOutputs(
            self, self.axis, lambda: self._follower.course, self.drive, self.source)
        self._staging = Staging(self, self.axis, self._follower, self._adopt)
        self.make_service(SetBool, '~/engage', self._on_engage)
        self.make_service(Trigger, '~/reset', self._on_reset)
        if self._own_process:
            self.make_subscription(
                JointTrajectoryPoint, self.followed, self._shaft.take_bytes, SETPOINTS, raw=True)

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
        self._shaft.start()
        self._tell()
        self._staging.tell()

    def deactivate(self) -> None:
        """Leave a hold setpoint behind: the last position, no velocity, no acceleration."""
        self._shaft.stop()
        if self._last is not None:
            self._emit(self._last._replace(velocity=0.0, acceleration=0.0))
            # activated again it is to stand there, not to be where the shaft has got to meanwhile
            self._follower.hold(
                FollowerState.HELD, 'it was deactivated: reset it', in_place=True)
        self.outputs.hold(self._last)
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
        if self.active:
            self._shaft.take(point)

    def _follow(self, point: Point) -> None:
        phi, omega, alpha, sec, nanosec = point
        if self._dead_time is not None:
            phi, omega, alpha = self._dead_time.ahead(
                sec + 1e-9 * nanosec, ShaftState(phi, omega, alpha))
        follower = self._follower
        position, velocity, acceleration = follower.answer(phi, omega, alpha)
        setpoint = Point(position, velocity, acceleration, sec, nanosec)
        self._emit(setpoint)
        if self.outputs.wanted:
            self.outputs.answer(point, setpoint)
        if follower.state is not self._told or follower.revision != self._told_revision:
            self._tell()
            if text := follower.reason or follower.waits_for:
                self.get_logger().warning(f'{self.get_name()} is {follower.state.value}: {text}')

    def _emit(self, setpoint: Point) -> None:
        self._last = setpoint
        self._setpoints.publish(pack_point(*setpoint))
        for listener in self.listeners:
            listener(setpoint)

    def _tell(self) -> None:
        """Publish the state, and the highest speed of the shaft if it has changed."""
        self._told, self._told_revision = self._follower.state, self._follower.revision
        self.set_state(self._told.value)
        bound = self._speed_bound
        omega = math.inf if bound is None else bound.omega
        if omega != self._bound:
            self._bound = omega
            self._max_speed.publish(Float64(data=omega / RPM))
            for listener in self.bound_listeners:
                listener(omega)

    @property
    def _speed_bound(self) -> SpeedBound | None:
        """Give the bound of the shaft; an axis that follows another one knows none."""
        return self._follower.speed_bound if self.axis.values['follows'] == SHAFT else None

    def _adopt(self, axis: CoupledAxis | None) -> None:
        """Be another axis from now on, if one is given, and say what that allows."""
        if axis is not None:
            self.axis = axis
            self.outputs.take(axis)
        if self.active:
            self._tell()

    # Stopping without the shaft

    def begin_stop(self) -> None:
        """Follow a shaft that comes to rest; else stop on the axis' own curve."""
        if self.active:
            self._shaft.begin_stop()

    @property
    def stopped(self) -> bool:
        """Whether the axis stands."""
        return not self.active or self._shaft.stopped

    def _on_shaft_lost(self, state: FollowerState, reason: str) -> None:
        if state is FollowerState.STOPPING_ON_CURVE:
            self._follower.coast()
        else:
            self._follower.hold(state, reason)
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
        if not self.active or self._shaft.coasting:
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
        self._staging.drop('the axis has been given a command')
        response.success = True
        response.message = f'{self.get_name()} ' + (
            self._follower.waits_for or done if plan is None
            else f'{planned} {plan.text(self.axis.unit)}')
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
            axis = build_axis(self.get_name(), {
                k: v for k, v in given.items() if v is not None}, self._reach)
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
        self._staging.drop('other parameters of the axis have been set')
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
        last, shaft, follower = self._last, self._shaft, self._follower
        watch = shaft.watch
        values: dict[str, Any] = {
            'setpoints': shaft.answered, 'refused_points': shaft.refused,
            'points_of_another_shaft': watch.refused, 'missed_ticks': watch.missed,
            'worst_answer_us': 1e6 * shaft.worst,
            **self.outputs.health()}
        if last is not None:
            values |= {'position': last.position, 'velocity': last.velocity,
                       'acceleration': last.acceleration, 'unit': self.axis.unit,
                       'shaft_age_s': shaft.age}
        bound = self._speed_bound
        if bound is not None:
            values |= {'max_speed_cpm': bound.omega / RPM,
                       'held_back_by': f'{bound.segment}: {bound.quantity}'}
        excess = follower.excess if bound is not None else ''
        reason = follower.reason or excess or follower.waits_for
        if reason:
            values['reason'] = reason
        if follower.state in (FollowerState.HELD, FollowerState.FAULT) or watch.reason or excess:
            return diagnostics.ERROR, values
        bad = shaft.refused or self.outputs.misses or reason
        return diagnostics.WARN if bad else diagnostics.OK, values


def _reach_beside(values: Mapping[str, Any]) -> Reach:
    """Find where the axis that is followed stays, if a parameter file of the process says it."""
    follows = values.get('follows', SHAFT)
    section = {} if follows == SHAFT else section_of(follows)
    axis = axes_of({follows: section}).get(follows) if section else None
    return ANYWHERE if axis is None else reach_of(axis)


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
