# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What the master shaft knows of the axes beside it, kept as they are while they change."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Future
import math
from typing import Any, NamedTuple

from cam_motion.io.axis_limits import axes_of, CascadedAxis, ramp_room
from cam_motion.io.parameters import is_of_every_node
from cam_motion.motion.limits import SpeedBound
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.staging import in_background, own_values
from cam_motion.runtime.ramp_room import RampRoom
from cam_motion.units import DEGREE
from rcl_interfaces.msg import ParameterEvent
from rclpy.parameter import parameter_value_to_python
from rclpy.qos import qos_profile_parameter_events
import scipy.interpolate  # noqa: F401 (for laws of changed axes: not beside a running tick)

_LIMITS = 'limits.'
_SAME = 1e-6  # a speed this near, as a share, has been reckoned from the same cam
_QUIET = 0.05  # changes that follow each other more closely are reckoned with together [s]


class Reckoning(NamedTuple):
    """
    What the limits of all axes mean for the shaft.

    The ``room`` for its ramps, and the highest speed by axis in cascade [rad/s]: such an axis
    knows what it follows only. These are ``final`` unless some axis is still on its way to
    another coupling. The ``bounds`` by axis say what holds the shaft back, and where.
    """

    room: RampRoom
    cascaded: dict[str, float]
    final: bool = True
    bounds: Mapping[str, SpeedBound | None] = {}

    def culprit(self, axis: str, omega: float) -> str:
        """
        Say what of an axis holds the shaft back.

        Parameters
        ----------
        axis : str
            Its name.
        omega : float
            The highest speed that it allows [rad/s].

        Returns
        -------
        str
            Its name, with segment, quantity and angle of the cam where they are known; a speed
            that is not that of its cams is that of a transition, or of an axis not known here.

        """
        bound = self.bounds.get(axis)
        if bound is None or not math.isclose(bound.omega, omega, rel_tol=_SAME):
            return axis
        where = '' if math.isnan(bound.at) else f' at {bound.at / DEGREE:.4g} deg'
        return f'{axis} ({bound.segment}{where}: {bound.quantity})'


def reckon(sections: Mapping[str, Mapping[str, Any]], names: Iterable[str]) -> Reckoning:
    """
    Find out what the limits of axes mean for the shaft.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of all axes, by name.
    names : Iterable[str]
        The axes that count.

    Returns
    -------
    Reckoning
        The room and the speeds.

    """
    known = axes_of(sections)
    axes = {name: known[name] for name in names if name in known}
    bounds = {name: axis.speed_bound for name, axis in axes.items()}
    return Reckoning(ramp_room(axes.values()), {
        name: math.inf if (bound := bounds[name]) is None else bound.omega
        for name, axis in axes.items() if isinstance(axis, CascadedAxis)}, bounds=bounds)


class AxesBeside:
    """
    The axes of the line, whose parameters may change while they run, in whatever process.

    Parameters
    ----------
    node : ManagedNode
        Node of the master shaft, as it is being configured.
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of all axes, by name.
    names : Iterable[str]
        The axes that count.
    adopt : Callable[[Reckoning], None]
        Called when they mean something else for the shaft.

    """

    def __init__(self, node: ManagedNode, sections: Mapping[str, Mapping[str, Any]],
                 names: Iterable[str], adopt: Callable[[Reckoning], None]) -> None:
        """Listen to changes."""
        self._sections = {name: dict(section) for name, section in sections.items()}
        self._names, self._adopt = tuple(names), adopt
        prefix = node.get_namespace().rstrip('/') + '/'
        self._paths = {prefix + name: name for name in sections}
        self._changed, self._due = False, math.inf
        self._final = True  # whether nothing but limits has changed
        self._answer: Future[Reckoning] | None = None
        node.make_subscription(ParameterEvent, '/parameter_events', self._on_event,
                               qos_profile_parameter_events)

    def _on_event(self, event: ParameterEvent) -> None:
        section = self._sections.get(self._paths.get(event.node, ''))
        if section is None:
            return
        before = dict(section)
        for name, value in own_values({
                each.name: parameter_value_to_python(each.value)
                for each in (*event.new_parameters, *event.changed_parameters)}).items():
            if value is not None and not is_of_every_node(name):
                section[name] = value.tolist() if hasattr(value, 'tolist') else value
        for each in event.deleted_parameters:
            section.pop(each.name, None)
        changed = [name for name in {**before, **section} if before.get(name) != section.get(name)]
        self._changed |= bool(changed)
        self._final &= all(name.startswith(_LIMITS) for name in changed)

    def tick(self, t: float) -> None:
        """
        Reckon anew after a change, beside the ticks.

        Parameters
        ----------
        t : float
            Time [s].

        """
        if self._changed:
            self._changed, self._due = False, t + _QUIET
        if self._answer is not None:
            if self._answer.done():
                answer, self._answer = self._answer, None
                self._adopt(answer.result()._replace(final=self._final))
                self._final |= not self._changed and math.isinf(self._due)
        elif t >= self._due:
            self._due = math.inf
            sections = {name: dict(section) for name, section in self._sections.items()}
            self._answer = in_background(lambda: reckon(sections, self._names))
