# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The life of a node: parameters, guarded transitions, state, diagnostics, a clean end."""

from __future__ import annotations

from collections.abc import Callable, Mapping
import time
import traceback
from typing import Any, ClassVar

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.parameters import is_of_every_node, ParameterSpec
from cam_motion.nodes import diagnostics
from cam_motion.nodes.parameters import declare, declare_given, take_from_any_namespace, values_of
from cam_motion.nodes.qos import LATCHED, overridable
from cam_motion.nodes.warm_up import warm_up_logging
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock, ClockType
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from std_msgs.msg import String

STATE = '~/state'


class ManagedNode(LifecycleNode):
    """
    A lifecycle node whose transitions say why they fail.

    rclpy swallows what a transition callback raises. Subclasses therefore implement
    `configure`, `activate`, `deactivate` and `cleanup`; what these raise is logged in words, and
    a configuration that cannot be used leaves the node unconfigured.

    Parameters
    ----------
    name : str
        Name of the node, unless remapped.
    **options : Any
        Further arguments of `rclpy.node.Node`, such as ``context`` or ``parameter_overrides``.

    """

    TABLE: ClassVar[tuple[ParameterSpec, ...]] = ()
    LIVE: ClassVar[frozenset[str]] = frozenset()
    """Parameters that may change while the node is configured."""

    def __init__(self, name: str, **options: Any) -> None:
        """Declare the parameters; everything else waits for the configuration."""
        super().__init__(name, **options)
        declare_given(self)
        self.problems: tuple[Problem, ...] = ()
        self.failed = False
        self.own_change = False
        """Whether the node itself is setting its parameters, which then are not looked at."""
        self.steady_clock = Clock(clock_type=ClockType.STEADY_TIME)
        self.active = False
        self._configured = False
        self._state_text = ''
        self._made: list[Callable[[], object]] = []  # how to undo what `configure` has made
        take_from_any_namespace(self)
        declare(self, self.table)
        self._state = self.create_publisher(String, STATE, **overridable(LATCHED))
        self._diagnostics = self.create_publisher(DiagnosticArray, diagnostics.TOPIC, 10)
        self._diagnostics_timer = self.create_timer(
            diagnostics.PERIOD, self._report, clock=self.steady_clock)
        self.add_on_set_parameters_callback(self._on_set_parameters)
        self.set_state('unconfigured')

    # What subclasses implement

    def configure(self, values: dict[str, Any]) -> None:
        """
        Build the core from the parameters and create what the node talks through.

        Parameters
        ----------
        values : dict[str, Any]
            All parameters by flat name, as given.

        Raises
        ------
        ConfigurationError
            When they cannot be used.

        """

    def activate(self) -> None:
        """Begin to work."""

    def deactivate(self) -> None:
        """Cease to work, leaving a hold setpoint behind."""

    def cleanup(self) -> None:
        """Drop what `configure` has made, be it only half of it."""
        while self._made:
            self._made.pop()()

    def make_publisher(self, kind: type, topic: str, profile: QoSProfile) -> Publisher:
        """
        Make a publisher that lives until the cleanup.

        Parameters
        ----------
        kind : type
            Message type.
        topic : str
            Name of the topic.
        profile : QoSProfile
            Its policies, which parameters can override.

        Returns
        -------
        Publisher
            The publisher; it publishes while the node is active.

        """
        made = self.create_lifecycle_publisher(kind, topic, **overridable(profile))
        self._made.append(lambda: self.destroy_lifecycle_publisher(made))
        return made

    def make_subscription(self, kind: type, topic: str, callback: Callable[[Any], None],
                          profile: QoSProfile, raw: bool = False) -> None:
        """
        Make a subscription that lives until the cleanup.

        Parameters
        ----------
        kind : type
            Message type.
        topic : str
            Name of the topic.
        callback : Callable[[Any], None]
            Takes each message, or its bytes.
        profile : QoSProfile
            Its policies, which parameters can override.
        raw : bool
            Whether messages come as bytes.

        """
        made = self.create_subscription(
            kind, topic, callback=callback, raw=raw, **overridable(profile))
        self._made.append(lambda: self.destroy_subscription(made))

    def make_service(self, kind: type, name: str, callback: Callable[[Any, Any], Any]) -> None:
        """
        Make a service that lives until the cleanup.

        Parameters
        ----------
        kind : type
            Service type.
        name : str
            Name of the service.
        callback : Callable[[Any, Any], Any]
            Fills in the response.

        """
        made = self.create_service(kind, name, callback)
        self._made.append(lambda: self.destroy_service(made))

    def begin_stop(self) -> None:
        """Begin to come to rest, because the process has been asked to end."""

    @property
    def stopped(self) -> bool:
        """Whether the node has come to rest."""
        return True

    def health(self) -> tuple[bytes, Mapping[str, Any]]:
        """
        Say how the node is.

        Returns
        -------
        tuple[bytes, Mapping[str, Any]]
            Level and figures of the diagnostics.

        """
        return diagnostics.OK, {}

    @property
    def hardware_id(self) -> str:
        """Name what the node stands for in the diagnostics."""
        return self.get_name()

    @property
    def table(self) -> tuple[ParameterSpec, ...]:
        """List the parameters; they are `TABLE` unless they depend on what is given."""
        return self.TABLE

    # What all nodes share

    @property
    def sim_time(self) -> bool:
        """Whether the node lives on /clock."""
        return bool(self.get_parameter('use_sim_time').value)

    @property
    def tick_clock(self) -> Clock:
        """Choose the clock of the ticks: /clock if told so, else one that nobody can set."""
        return self.get_clock() if self.sim_time else self.steady_clock

    def set_state(self, text: str) -> None:
        """
        Publish the state, if it has changed.

        Parameters
        ----------
        text : str
            The state.

        """
        if text != self._state_text:
            self._state_text = text
            self._state.publish(String(data=text))

    @property
    def state_text(self) -> str:
        """Give the state as published."""
        return self._state_text

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Configure; see `configure`."""
        def work() -> None:
            self.problems = ()
            warm_up_logging()
            self.configure(values_of(self))
            self._configured = True
            self.set_state('inactive')
        result = self._guarded('configure', work)
        if result is not TransitionCallbackReturn.SUCCESS:
            self.cleanup()
            return result
        return super().on_configure(state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Activate; see `activate`."""
        super().on_activate(state)
        self.active = True
        result = self._guarded('activate', self.activate)
        self.active = result is TransitionCallbackReturn.SUCCESS
        return result

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Deactivate; see `deactivate`."""
        result = self._guarded('deactivate', self.deactivate)
        self.active = False
        self.set_state('inactive')
        super().on_deactivate(state)
        return result

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Clean up; see `cleanup`."""
        return self._end('cleanup', 'unconfigured')

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Shut down from any state."""
        if self.active:
            self._guarded('deactivate', self.deactivate)
            self.active = False
        return self._end('shutdown', 'finalized')

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Fall back to unconfigured after an error, which has been logged."""
        self.active = False
        return self._end('error', 'unconfigured')

    def _end(self, transition: str, state: str) -> TransitionCallbackReturn:
        result = self._guarded(transition, self.cleanup)
        self._configured = False
        self.set_state(state)
        return result

    def _guarded(self, transition: str, work: Callable[[], None]) -> TransitionCallbackReturn:
        try:
            work()
        except ConfigurationError as error:
            self.problems = error.problems
            for problem in error.problems:
                self.get_logger().error(str(problem.below(self.get_name())))
            return TransitionCallbackReturn.FAILURE
        except Exception:
            self.failed = True
            self.get_logger().error(f'{transition} failed:\n{traceback.format_exc()}')
            return TransitionCallbackReturn.ERROR
        return TransitionCallbackReturn.SUCCESS

    def _on_set_parameters(self, changes: list[Parameter]) -> SetParametersResult:
        """Accept or refuse a change; must never raise, that would end the executor."""
        if self.own_change:
            return SetParametersResult(successful=True)
        specs = {spec.name: spec for spec in self.table}
        for change in changes:
            name, value = change.name, change.value
            if is_of_every_node(name):
                continue
            if self._configured and not self.is_live(name):
                return SetParametersResult(successful=False, reason=(
                    f'{name} can change while the node is unconfigured only: clean it up first'))
            problem = specs[name].check(value) if name in specs and value is not None else None
            reason = str(problem) if problem else self.refuse_change(name, value)
            if reason:
                return SetParametersResult(successful=False, reason=reason)
        live = {change.name: change.value for change in changes
                if self._configured and not is_of_every_node(change.name)}
        try:
            reason = self.take_changes(live) if live else ''
        except Exception:
            self.get_logger().error(f'a change failed:\n{traceback.format_exc()}')
            reason = 'an error of the node, see its log'
        return SetParametersResult(successful=not reason, reason=reason)

    def refuse_change(self, name: str, value: Any) -> str:
        """
        Say why a live parameter cannot take a value.

        Parameters
        ----------
        name : str
            Name of the parameter.
        value : Any
            The value; its type and range have been checked.

        Returns
        -------
        str
            The reason, empty to accept.

        """
        return ''

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
            Whether it is one of `LIVE`.

        """
        return name in self.LIVE

    def take_changes(self, changes: Mapping[str, Any]) -> str:
        """
        Take over live parameters that were set together: all of them or none.

        Parameters
        ----------
        changes : Mapping[str, Any]
            New values by flat name, each checked on its own.

        Returns
        -------
        str
            Why they cannot be taken over; empty when they have been.

        """
        return ''

    def _report(self) -> None:
        level, values = self.health()
        self._diagnostics.publish(diagnostics.report(
            self.get_clock().now().to_msg(), self.get_name(), self.hardware_id, level,
            self._state_text, values))

    @staticmethod
    def steady_now() -> float:
        """
        Read the steady clock.

        Returns
        -------
        float
            Seconds since some fixed instant.

        """
        return time.monotonic()
