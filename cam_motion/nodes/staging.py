# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A new format of an axis: staged by a parameter, taken over when all axes are told to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Future
import math
import sys
from threading import Thread
from typing import Any, TypeVar

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.axis import axis_table, build_axis, CoupledAxis
from cam_motion.io.config import flatten, parse_yaml
from cam_motion.io.format_change import check_fixed
from cam_motion.io.format_parameters import STAGED
from cam_motion.io.parameters import REQUIRED
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.parameters import describe, values_of
from cam_motion.nodes.qos import LATCHED, SETPOINTS
from cam_motion.runtime.format_change import Format, FormatFollower
from cam_motion.runtime.planning import TransitionError
from cam_motion.units import DEGREE
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.timer import Timer
from std_msgs.msg import Float64

TAKE_OVER = 'format_change'
"""Topic by which all axes are told when to take over what they have staged."""

_Result = TypeVar('_Result')

BUSY = 'the format is being looked at: set it again in a moment'
"""Reason for which a format is not staged yet while the shaft turns."""

_LAPSES_AFTER = 30.0  # whoever staged a format and has not been heard since is gone [s]
_GIVE_WAY = 0.0005  # how long the thread that answers the shaft may wait for another one [s]
_NOTHING = {spec.name: spec.default for spec in STAGED}


def is_staged(name: str) -> bool:
    """
    Tell the parameters that stage a format.

    Parameters
    ----------
    name : str
        Name of a parameter of an axis.

    Returns
    -------
    bool
        Whether it is one of them.

    """
    return name in _NOTHING


def own_values(values: Mapping[str, Any]) -> dict[str, Any]:
    """
    Leave the parameters that stage a format out.

    Parameters
    ----------
    values : Mapping[str, Any]
        Parameters of an axis node by flat name.

    Returns
    -------
    dict[str, Any]
        Those of the axis itself.

    """
    return {name: value for name, value in values.items() if not is_staged(name)}


class Staging:
    """
    The change of format of one axis.

    An angle told once is a question: the axis answers it by publishing the same. The same angle
    told again is the order. Whoever asks gives it when all axes have answered, so that an axis
    that hangs, or the death of the one who asks, leaves every axis in the format that it has.

    Parameters
    ----------
    node : ManagedNode
        Node of the axis, as it is being configured.
    axis : CoupledAxis
        The axis as it is.
    follower : FormatFollower
        What carries the change out.
    adopt : Callable[[CoupledAxis | None], None]
        Called when the axis is another one, with it, and when its speed bound may have changed.

    Raises
    ------
    ConfigurationError
        When a format is staged already.

    """

    def __init__(self, node: ManagedNode, axis: CoupledAxis, follower: FormatFollower,
                 adopt: Callable[[CoupledAxis | None], None]) -> None:
        """Create the topics."""
        if text := values_of(node).get('staged'):
            raise ConfigurationError([Problem(
                'staged', text, 'a format is staged while the axis runs', 'leave it out')])
        self._node, self._axis, self._follower, self._adopt = node, axis, follower, adopt
        self._staged: tuple[CoupledAxis, Mapping[str, Any], Format] | None = None
        self._promised = math.nan  # shaft angle for which the axis waits to be told once more
        self._timer: Timer | None = None
        self._lapse: Timer | None = None  # until what is staged is dropped
        self._asked: tuple[Any, ...] = ()  # what is being looked at in the background
        self._answer: Future[tuple[CoupledAxis, dict[str, Any]]] | None = None
        follower.on_taken = self._on_taken
        self._told = node.make_publisher(Float64, f'~/{TAKE_OVER}', LATCHED)
        node.make_subscription(Float64, TAKE_OVER, self._on_take_over, SETPOINTS)

    def tell(self) -> None:
        """Publish at which shaft angle the axis will take a format over, or is ready to."""
        waiting = self._follower.scheduled
        start = self._promised
        if waiting is not None:
            start = waiting.start if waiting.plan is None else waiting.plan.blend.start
        self._told.publish(Float64(data=start))

    @property
    def refusal(self) -> str:
        """Say why the axis takes no other command now; empty if it does."""
        if self._follower.scheduled is not None:
            return (f'a change of format is scheduled: send NaN on {TAKE_OVER} to revoke it on '
                    'all axes')
        if math.isfinite(self._promised):
            return ('a change of format is about to be ordered: ask again when it is over, or '
                    f'send NaN on {TAKE_OVER} to call it off')
        return ''

    @property
    def waits(self) -> bool:
        """Whether a format waits for the shaft."""
        return self._follower.scheduled is not None

    def stage(self, changes: Mapping[str, Any]) -> str:
        """
        Check a new format, and keep it if it can be taken over.

        Parameters
        ----------
        changes : Mapping[str, Any]
            Parameters that were set together.

        Returns
        -------
        str
            Why it cannot; empty when it is staged, or dropped.

        """
        foreign = [name for name in changes if not is_staged(name)]
        if foreign:
            return f'{foreign[0]} cannot be set together with a staged format'
        if self._follower.scheduled is not None:
            return self.refusal
        values = {**values_of(self._node), **changes}
        if not values['staged']:
            self._forget()
            return ''
        if not self._node.active:
            return 'the node is not active'
        if self._staged is not None:
            return ("another format is staged already: set the parameter staged to '' to drop it; "
                    f'unless it is ordered it lapses {_LAPSES_AFTER:g} s after it was staged')
        asked = tuple(values[name] for name in _NOTHING)
        if self._answer is None or self._asked != asked:
            self._asked, self._answer = asked, in_background(
                lambda: _built(self._axis, values['staged']))
        if self._follower.turning and not self._answer.done():
            return BUSY  # compiling takes as long as many shaft points
        answer, self._answer = self._answer, None
        try:
            self._staged = self._checked(*answer.result(), values)
        except ConfigurationError as error:
            return '; '.join(map(str, error.problems))
        except TransitionError as error:
            return str(error)
        self._keep()
        return ''

    def drop(self, why: str) -> None:
        """
        Forget a format that is staged and that nobody has asked for.

        The axis has been told something else since, so that what was found out about the way
        there no longer holds. Whoever staged it gets no answer when asking for it, and then no
        axis changes.

        Parameters
        ----------
        why : str
            For the log.

        """
        if self._staged is None or self.waits or self._timer is not None:
            return
        self._node.get_logger().warning(f'the staged format is dropped: {why}')
        self._forget()
        # not now: parameters may just be being set
        self._timer = self._node.create_timer(
            0.0, self._on_settled, clock=self._node.steady_clock)

    def _forget(self) -> None:
        self._staged = None
        self._keep()
        self._withdraw()

    def _keep(self) -> None:
        """Keep what is staged, but not for ever."""
        if self._lapse is not None:
            self._node.destroy_timer(self._lapse)
        self._lapse = None if self._staged is None else self._node.create_timer(
            _LAPSES_AFTER, self._on_lapse, clock=self._node.steady_clock)

    def _on_lapse(self) -> None:
        if self._lapse is not None:
            self._node.destroy_timer(self._lapse)
            self._lapse = None
        self.drop(f'nobody has ordered it within {_LAPSES_AFTER:g} s')

    def _checked(self, axis: CoupledAxis, given: dict[str, Any], values: Mapping[str, Any],
                 ) -> tuple[CoupledAxis, Mapping[str, Any], Format]:
        new = Format(axis.layout, axis.settings, values['staged_at_deg'] * DEGREE,
                     values['staged_span_deg'] * DEGREE)
        plan = self._follower.check_format(new)
        if not new.span:
            span = axis.settings.change.span if plan is None else abs(plan.blend.span)
            new = new._replace(span=span)
        what = 'without moving' if plan is None else plan.text(axis.unit)
        self._node.get_logger().info(f'{axis.name}: a new format is staged, {what}')
        return axis, given, new

    def _on_take_over(self, message: Float64) -> None:
        start = message.data
        if not math.isfinite(start):
            if self._follower.revoke():
                self._node.get_logger().warning('the change of format was revoked')
                self.tell()
                self._adopt(None)
            if self._staged is not None and self._timer is None:
                self._forget()
                self._write(own_values(values_of(self._node)))
            return
        if self._staged is None or self._follower.scheduled is not None:
            return
        if self._promised != start:
            self._promised = start
            self._keep()
            self.tell()
            return
        self._promised = math.nan
        plan = self._follower.schedule(self._staged[2], start)
        if plan is not None and plan.blend.start != start:
            self._node.get_logger().error(
                f'the shaft had passed {start / DEGREE:.6g} deg by '
                f'{abs(plan.blend.start - start) / DEGREE:.4g} deg when the change of format '
                'arrived: it begins at once')
        self.tell()
        self._adopt(None)

    def _withdraw(self) -> None:
        """Promise nothing any more."""
        if math.isfinite(self._promised):
            self._promised = math.nan
            self.tell()

    def _on_taken(self) -> None:
        """Note that the format is in force; the rest can wait until the shaft is answered."""
        if self._staged is not None:
            self._axis = self._staged[0]
            self._adopt(self._axis)
            self._timer = self._node.create_timer(
                0.0, self._on_settled, clock=self._node.steady_clock)

    def _on_settled(self) -> None:
        timer, self._timer = self._timer, None
        if timer is not None:
            self._node.destroy_timer(timer)
        staged, self._staged = self._staged, None
        self._keep()
        if staged is None:
            self._write(own_values(values_of(self._node)))
        else:
            self._write(staged[1])
            if self._node.active:
                self.tell()

    def _write(self, given: Mapping[str, Any]) -> None:
        """Let the parameters of the node say what it does."""
        self._node.own_change = True
        try:
            overwrite(self._node, given)
        finally:
            self._node.own_change = False


def _built(before: CoupledAxis, text: str) -> tuple[CoupledAxis, dict[str, Any]]:
    """Compile a format; everything that takes long, and needs nothing but its arguments."""
    tree = parse_yaml(text, 'staged')
    if not isinstance(tree, Mapping):
        raise ConfigurationError([Problem('staged', tree, 'must be parameters of the axis')])
    given = {name: value for name, value in flatten(tree).items() if value is not None}
    axis = build_axis(before.name, given)
    check_fixed(before, axis)
    axis.layout.speed_bound(axis.limits)  # the cams remember their peaks
    return axis, given


def in_background(work: Callable[[], _Result]) -> Future[_Result]:
    """
    Do something in a thread while this one goes on.

    Parameters
    ----------
    work : Callable[[], Any]
        What is to be done.

    Returns
    -------
    Future
        Its result to come.

    """
    future: Future[_Result] = Future()

    def carry_out() -> None:
        interval = sys.getswitchinterval()
        sys.setswitchinterval(_GIVE_WAY)
        try:
            future.set_result(work())
        except Exception as error:
            future.set_exception(error)
        finally:
            sys.setswitchinterval(interval)
    Thread(target=carry_out, daemon=True).start()
    return future


def overwrite(node: Node, given: Mapping[str, Any]) -> None:
    """
    Give an axis node other parameters; what is not given takes its default or is undeclared.

    Parameters
    ----------
    node : Node
        The node, which must not object.
    given : Mapping[str, Any]
        Parameters of the axis by flat name, checked.

    """
    specs = {spec.name: spec for spec in (*axis_table(given), *STAGED)}
    fresh = {**given, **{
        name: spec.cleaned(value) for name, spec in specs.items()
        if (value := given.get(name, spec.default)) not in (None, REQUIRED)}}
    before = values_of(node)
    for name in before:
        if name not in fresh:
            node.undeclare_parameter(name)
    changed = []
    for name, value in fresh.items():
        old = before.get(name)
        if type(old) is type(value) and value != []:
            if old != value:
                changed.append(Parameter(name, value=value))
            continue
        if old == value:
            continue
        if node.has_parameter(name):
            node.undeclare_parameter(name)
        spec = specs.get(name)
        node.declare_parameter(
            name, value, describe(spec, value) if spec is not None else ParameterDescriptor(
                dynamic_typing=value == []), ignore_override=True)
    if changed:
        node.set_parameters_atomically(changed)
