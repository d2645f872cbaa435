# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The one who asks all axes of a line for a new format, and tells them when to take it over."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
import json
import math
import time
from typing import Any

from cam_motion.io.axis import Values
from cam_motion.io.format_change import FormatError, FormatPlan
from cam_motion.nodes.qos import LATCHED, SETPOINTS
from cam_motion.nodes.staging import BUSY, own_values, TAKE_OVER
from cam_motion.nodes.wire import unpack_point
from cam_motion.runtime.point import Point
from cam_motion.units import DEGREE
from rcl_interfaces.srv import GetParameters, ListParameters, SetParametersAtomically
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Float64, String
from trajectory_msgs.msg import JointTrajectoryPoint

FOUND_WITHIN = 10.0
"""Time for the nodes of a running line to be found [s]."""

_ANSWER_WITHIN = 5.0  # time for a node to answer [s]
_LOOKED_AT_WITHIN = 20.0  # time for an axis to look at a format [s]
_LOOK_AGAIN = 0.05
_IN_TIME = 0.5  # how long before the change the last word must be given [s]
_SETTLE = 0.5  # time for axes that nobody expects to be found [s]
_SILENT = 'does not answer'
_STANDING = ('disengaged', 'held', 'fault')
_GRACE = 10.0  # beyond what the shaft needs, for a change to be over [s]


class FormatClient:
    """
    Talks to the axes of a running line; to be used as a context.

    Parameters
    ----------
    namespace : str
        Where the line is.

    """

    def __init__(self, namespace: str = '') -> None:
        """Join the ROS graph."""
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node(
            'cam_motion_format', context=self._context, namespace=namespace or None,
            use_global_arguments=False, enable_rosout=False, start_parameter_services=False)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._last: Point | None = None
        self._states: dict[str, str] = {}
        self._scheduled: dict[str, float] = {}
        self._node.create_subscription(
            JointTrajectoryPoint, 'shaft', self._on_shaft, SETPOINTS, raw=True)
        self._orders = self._node.create_publisher(Float64, TAKE_OVER, SETPOINTS)

    def _on_shaft(self, data: bytes) -> None:
        self._last = unpack_point(data) or self._last

    def _until(self, condition: Callable[[], bool], within: float) -> bool:
        deadline = time.monotonic() + within
        while not condition():
            left = deadline - time.monotonic()
            if left <= 0.0:
                return False
            self._executor.spin_once(timeout_sec=min(0.05, left))
        return True

    def _ask(self, kind: Any, axis: str, service: str, **fields: Any) -> Any:
        """Call a service of an axis; None where it does not answer."""
        client = self._node.create_client(kind, f'{axis}/{service}')
        try:
            if not self._until(client.service_is_ready, _ANSWER_WITHIN):
                return None
            future = client.call_async(kind.Request(**fields))
            return future.result() if self._until(future.done, _ANSWER_WITHIN) else None
        finally:
            self._node.destroy_client(client)

    # Looking

    def find(self, wanted: list[str]) -> list[str]:
        """
        Find the axes of the running line, and listen to them.

        Parameters
        ----------
        wanted : list[str]
            Axes that there should be.

        Returns
        -------
        list[str]
            Those that there are.

        """
        prefix = self._node.get_namespace().rstrip('/') + '/'

        def found() -> list[str]:
            names = (name.removeprefix(prefix).removesuffix(f'/{TAKE_OVER}')
                     for name, _ in self._node.get_topic_names_and_types()
                     if name.startswith(prefix) and name.endswith(f'/{TAKE_OVER}'))
            return [name for name in names if name and '/' not in name
                    and self._node.count_publishers(f'{name}/{TAKE_OVER}')]
        self._until(lambda: set(wanted) <= set(found()), FOUND_WITHIN)
        self._until(lambda: False, _SETTLE)
        axes = sorted(found(), key=lambda name: (name not in wanted, name))
        for axis in axes:
            self._node.create_subscription(
                String, f'{axis}/state',
                lambda message, axis=axis: self._states.update({axis: message.data}), LATCHED)
            self._node.create_subscription(
                Float64, f'{axis}/{TAKE_OVER}',
                lambda message, axis=axis: self._scheduled.update({axis: message.data}), LATCHED)
        self._until(lambda: all(
            axis in self._states and axis in self._scheduled for axis in axes), _ANSWER_WITHIN)
        return axes

    def parameters(self, axis: str) -> Values:
        """
        Read the parameters of an axis.

        Parameters
        ----------
        axis : str
            Its name.

        Returns
        -------
        Mapping[str, Any]
            Those of the axis itself, by flat name.

        Raises
        ------
        FormatError
            When it does not answer.

        """
        listed = self._ask(ListParameters, axis, 'list_parameters')
        names = [] if listed is None else [
            name for name in listed.result.names if not name.startswith('qos_overrides.')]
        answer = self._ask(GetParameters, axis, 'get_parameters', names=names) if names else None
        if answer is None:
            raise FormatError(f'{axis} does not answer: nothing has changed')
        values = {name: _plain(parameter_value_to_python(value))
                  for name, value in zip(names, answer.values)}
        return own_values({name: value for name, value in values.items()
                           if value is not None and name not in (
                               'use_sim_time', 'start_type_description_service')})

    @property
    def standing(self) -> list[str]:
        """List the axes that stand, and will move only when they engage."""
        return [axis for axis, state in self._states.items() if state in _STANDING]

    def shaft(self) -> Point:
        """
        Wait for a point of the shaft.

        Returns
        -------
        Point
            The newest.

        Raises
        ------
        FormatError
            When none comes.

        """
        self._last = None
        if not self._until(lambda: self._last is not None, _ANSWER_WITHIN) or self._last is None:
            raise FormatError('no shaft is heard: is the line running?')
        return self._last

    def set_speed(self, master: str) -> float | None:
        """
        Read the set speed of a master shaft.

        Parameters
        ----------
        master : str
            Its name.

        Returns
        -------
        float | None
            The speed [cycles/min]; None where it does not say.

        """
        answer = self._ask(GetParameters, master, 'get_parameters', names=['speed_cpm'])
        return parameter_value_to_python(answer.values[0]) if answer and answer.values else None

    # Changing

    def stage(self, plan: FormatPlan) -> None:
        """
        Let every axis check its part and keep it ready; all of them or none.

        Parameters
        ----------
        plan : FormatPlan
            The change.

        Raises
        ------
        FormatError
            When an axis refuses or does not answer; says which and why. Nothing is staged then.

        """
        refusals, kept = [], []
        for axis, change in plan.axes.items():
            reason = self._set(axis, {
                'staged': json.dumps(dict(change.given)), 'staged_at_deg': plan.at / DEGREE,
                'staged_span_deg': plan.span / DEGREE})
            if reason:
                refusals.append(f'{axis}: {reason}')
            if not reason or reason == _SILENT:
                kept.append(axis)
        if refusals:
            self._drop(kept)
            raise FormatError('refused, nothing has changed: ' + '; '.join(refusals))

    def drop(self, plan: FormatPlan) -> None:
        """
        Let every axis forget what it has staged.

        Parameters
        ----------
        plan : FormatPlan
            The change.

        """
        self._drop(plan.axes)

    def _drop(self, axes: Iterable[str]) -> None:
        for axis in axes:
            self._set(axis, {'staged': '', 'staged_at_deg': 0.0, 'staged_span_deg': 0.0})

    def _set(self, axis: str, values: Mapping[str, Any]) -> str:
        deadline = time.monotonic() + _LOOKED_AT_WITHIN
        while True:
            answer = self._ask(
                SetParametersAtomically, axis, 'set_parameters_atomically', parameters=[
                    Parameter(name, value=value).to_parameter_msg()
                    for name, value in values.items()])
            if answer is None:
                return _SILENT
            if answer.result.reason != BUSY or time.monotonic() > deadline:
                return '' if answer.result.successful else answer.result.reason or 'refuses'
            self._until(lambda: False, _LOOK_AGAIN)

    def take_over(self, plan: FormatPlan) -> float:
        """
        Ask all axes whether they are ready for a shaft angle, and tell them to change there.

        Parameters
        ----------
        plan : FormatPlan
            The change, staged on every axis.

        Returns
        -------
        float
            The shaft angle, unwrapped [rad].

        Raises
        ------
        FormatError
            When an axis does not answer in time; no axis changes then.

        """
        if not self._until(lambda: self._listening(plan), _ANSWER_WITHIN):
            raise FormatError(f'not all axes listen to {TAKE_OVER}: nothing has changed')
        shaft = self.shaft()
        start = plan.start(shaft.position, shaft.velocity)
        self._orders.publish(Float64(data=start))
        self._until(lambda: not self._silent(plan, start) or self._left(plan, start) < _IN_TIME,
                    _ANSWER_WITHIN)
        if silent := self._silent(plan, start):
            raise FormatError(f'{", ".join(silent)} did not answer in time: the change is called '
                              'off, nothing has changed')
        if self._left(plan, start) < _IN_TIME:
            raise FormatError('the axes answered too late for the angle: the change is called '
                              'off, nothing has changed')
        self._orders.publish(Float64(data=start))
        return start

    def _silent(self, plan: FormatPlan, start: float) -> list[str]:
        return [axis for axis in plan.axes if self._scheduled.get(axis) != start]

    def _left(self, plan: FormatPlan, start: float) -> float:
        """Time until the shaft is there, by the newest point heard of it [s]."""
        if self._last is None:
            return math.inf
        speed = max(abs(self._last.velocity), plan.speed, 0.1)
        return plan.sense * (start - self._last.position) / speed

    def revoke(self, plan: FormatPlan) -> None:
        """
        Call the change off on all axes; what has begun goes on.

        Parameters
        ----------
        plan : FormatPlan
            The change.

        """
        self._orders.publish(Float64(data=math.nan))
        self._until(lambda: all(math.isnan(self._scheduled.get(axis, math.nan))
                                for axis in plan.axes), _ANSWER_WITHIN)
        self.drop(plan)

    def _listening(self, plan: FormatPlan) -> bool:
        readers = self._node.get_subscriptions_info_by_topic(
            self._node.resolve_topic_name(TAKE_OVER))
        return set(plan.axes) <= {reader.node_name for reader in readers} and (
            self._orders.get_subscription_count() >= len(readers))

    def wait(self, plan: FormatPlan, start: float) -> bool:
        """
        Wait until all axes have changed.

        Parameters
        ----------
        plan : FormatPlan
            The change.
        start : float
            Shaft angle at which it begins [rad].

        Returns
        -------
        bool
            Whether they have; False when the shaft stands before they could.

        Raises
        ------
        FormatError
            When it takes too long.

        """
        end = start + plan.sense * plan.span

        def over() -> bool:
            return (self._last is not None and plan.sense * (self._last.position - end) > 0.0
                    and all(math.isnan(self._scheduled.get(axis, math.nan))
                            and self._states.get(axis) in ('in_sync', *_STANDING)
                            for axis in plan.axes))
        shaft = self.shaft()
        deadline = time.monotonic() + _GRACE
        while shaft.velocity or shaft.acceleration:
            left = max(0.0, plan.sense * (end - shaft.position))
            if left:
                deadline = time.monotonic() + _GRACE
            if self._until(over, min(1.0, 0.2 + left / max(abs(shaft.velocity), 0.1))):
                return True
            if time.monotonic() > deadline:
                states = ', '.join(f'{axis} {self._states.get(axis)}' for axis in plan.axes)
                raise FormatError(f'the shaft is past the change, but not all axes are: {states}')
            shaft = self.shaft()
        return over()

    def close(self) -> None:
        """Leave the ROS graph."""
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    def __enter__(self) -> FormatClient:
        """Give the client itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the ROS graph."""
        self.close()


def _plain(value: Any) -> Any:
    return list(value) if hasattr(value, 'tolist') else value
