# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The shaft as a node follows it: its points, its silence, and coming to rest without it."""

from __future__ import annotations

from collections.abc import Callable
from itertools import islice
from time import monotonic

from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.qos import BURST
from cam_motion.nodes.wire import unpack_point
from cam_motion.runtime.coasting import Coasting, stop_of_axis
from cam_motion.runtime.follower_settings import FollowerState
from cam_motion.runtime.plausibility import AxisPlausibility
from cam_motion.runtime.point import Point
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.watchdog import ShaftWatch
from rclpy.timer import Timer

_LOOKS = 4  # for a silent shaft, within its timeout
_PATIENCE = 2.0  # times as long with another axis: it may be about to bring itself to rest


class ShaftInput:
    """
    Hands the points of the shaft on, and turns it on to rest when it is lost.

    Parameters
    ----------
    node : ManagedNode
        The node that follows.
    name : str
        Name of what it follows, for messages.
    timeout : float
        How long the shaft may be silent [s].
    limits : RampLimits
        Limits of the ramp by which it comes to rest when it is lost.
    follow : Callable[[Point], None]
        Takes each point.
    change : Callable[[FollowerState, str], None]
        Told STOPPING_ON_CURVE when the points to come are its own, and HELD or FAULT, with the
        reason, when they have come to rest.
    of_axis : bool
        Whether what it follows is another axis, with a unit of its own.

    Attributes
    ----------
    watch : ShaftWatch
        What is known of the shaft.
    answered, refused : int
        Points of the shaft that were handed on, and messages that were none.
    worst : float
        Longest time that handing one on has taken [s].

    """

    def __init__(self, node: ManagedNode, name: str, timeout: float, limits: RampLimits,
                 follow: Callable[[Point], None],
                 change: Callable[[FollowerState, str], None], of_axis: bool = False) -> None:
        """Know no shaft yet."""
        self._of_axis = of_axis
        self._node = node
        self._name = name
        self._limits = limits
        self._follow = follow
        self._change = change
        self.watch = (ShaftWatch(_PATIENCE * timeout, AxisPlausibility()) if of_axis
                      else ShaftWatch(timeout))
        self.answered = self.refused = 0
        self.worst = 0.0
        self._coasting: Coasting | None = None
        self._suspect: Point | None = None  # the last point of a shaft that seems to be silent
        self._timers: list[Timer] = []
        self._simulated = False

    def start(self) -> None:
        """Begin to look for the shaft."""
        self._simulated = self._node.sim_time
        self.watch.forget()
        self._add_timer(self.watch.timeout / _LOOKS, self._look)

    def stop(self) -> None:
        """Cease to."""
        while self._timers:
            self._node.destroy_timer(self._timers.pop())
        self._coasting = None

    @property
    def coasting(self) -> bool:
        """Whether the shaft is being brought to rest here."""
        return self._coasting is not None

    @property
    def age(self) -> float:
        """Time since the last point of the shaft arrived [s]."""
        return self.watch.age(self._now())

    def take(self, point: Point) -> None:
        """
        Take a point of the shaft.

        Parameters
        ----------
        point : Point
            Angle, speed and acceleration.

        """
        if self._coasting is not None:
            return
        if not self.watch.note(point, self._now()):
            self._node.get_logger().error(
                f'{self._name}: {self.watch.reason}: left out', throttle_duration_sec=1.0)
            return
        begun = monotonic()
        self._follow(point)
        took = monotonic() - begun
        if took > self.worst:
            self.worst = took
        self.answered += 1

    def take_bytes(self, data: bytes) -> None:
        """
        Take a message of the shaft, if the node is active.

        Parameters
        ----------
        data : bytes
            The serialised message.

        """
        if not self._node.active:
            return
        point = unpack_point(data)
        if point is not None:
            self.take(point)
            return
        self.refused += 1
        self._node.get_logger().warning(
            f'{self._name}: a point without exactly one finite position, velocity and '
            'acceleration was left out', throttle_duration_sec=1.0)

    def begin_stop(self) -> None:
        """Wait for the shaft to come to rest; if it goes on, come to rest without it."""
        self.watch.begin_stop(self._node.steady_now())

    @property
    def stopped(self) -> bool:
        """Whether the shaft stands, here at least."""
        if self._coasting is not None:
            return self._coasting.over
        if self.watch.at_rest:
            return True
        if self.watch.goes_on(self._node.steady_now()):
            self._coast('the axis was asked to end while the shaft went on', FollowerState.HELD)
        return False

    def _now(self) -> float:
        """Read the clock by which silence is measured [s]: a simulation may be paused."""
        if self._simulated:
            return self._node.tick_clock.now().nanoseconds * 1e-9
        return monotonic()

    def _add_timer(self, period: float, work: Callable[[], None]) -> None:
        self._timers.append(self._node.create_timer(period, work, clock=self._node.tick_clock))

    def _look(self) -> None:
        watch = self.watch
        if self._coasting is not None or not watch.lost(self._now()):
            self._suspect = None
        elif self._suspect is not watch.last:
            # points may be waiting, if it is this process that was late: look once more
            self._suspect = watch.last
        elif watch.astray:
            self._coast(watch.reason, FollowerState.FAULT)
        else:
            self._coast(f'{self._name} has been silent for {self.age:.3g} s', FollowerState.HELD)

    def _coast(self, reason: str, state: FollowerState) -> None:
        watch = self.watch
        if watch.last is None:
            return
        self._node.get_logger().error(f'{reason}: stopping on the curve')
        limits = stop_of_axis(watch.last, self._limits) if self._of_axis else self._limits
        self._coasting = Coasting(watch.last, watch.period, self._now() - self.age, limits,
                                  reason, state)
        self._change(FollowerState.STOPPING_ON_CURVE, reason)
        self._add_timer(watch.period, self._go_on)

    def _go_on(self) -> None:
        coasting = self._coasting
        if coasting is None:
            return
        for point in islice(coasting.due(self._now()), BURST):
            self._follow(point)
        if coasting.over:
            self._node.destroy_timer(self._timers.pop())
            self._coasting = None
            self.watch.forget()
            self._change(coasting.state, coasting.reason)
