# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The cam tracks of a node: outputs that it switches as its shaft or its axis moves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cam_motion.io.tracks import TrackSettings
from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.qos import LATCHED
from cam_motion.runtime.cam_switch import CamSwitch
from cam_motion.runtime.point import Point
from cam_motion.runtime.ticks import NANOSECONDS
from cam_motion.runtime.time_relation import TimeRelation
from rclpy.publisher import Publisher
from rclpy.timer import Timer
from std_msgs.msg import Bool

_LOOKS_EVERY = 0.01  # while a duration goes on: for its end, should no tick come [s]


class _Output:
    """One track: its switch, its topic, and what has been told there."""

    def __init__(self, settings: TrackSettings, publisher: Publisher) -> None:
        """Have told nothing yet."""
        self.publisher = publisher
        self.told: bool | None = None
        self.take(settings)

    def take(self, settings: TrackSettings, count: int = 0, unseen: int = 0) -> None:
        """Switch by these settings from now on, and go on counting."""
        self.settings = settings
        self.over_position = settings.over_position
        self.switch = CamSwitch(settings.track)
        self.switch.count, self.switch.unseen = count, unseen
        self.answer = self.switch.answer

    def tell(self, on: bool) -> None:
        """Publish the state."""
        self.told = on
        self.publisher.publish(Bool(data=on))


class TrackOutput:
    """
    Publishes each track of a node whenever it is switched, latched.

    Ticks switch. A duration ends on time all the same when no more of them come, because the
    shaft is lost or stands silent: what it opened must not stay open.

    Parameters
    ----------
    node : ManagedNode
        The node, as it is being configured.
    tracks : Mapping[str, TrackSettings]
        Its tracks by name.

    """

    def __init__(self, node: ManagedNode, tracks: Mapping[str, TrackSettings]) -> None:
        """Make a topic for each."""
        self._outputs = {
            name: _Output(settings, node.make_publisher(Bool, f'~/{name}', LATCHED))
            for name, settings in tracks.items()}
        self._node = node
        self._last_time = 0.0
        self._heard = 0  # when the last tick came, by the clock of the timer [ns]
        self._stamp = 0  # and when it was due: those of a shaft brought to rest come late [ns]
        self._relation = TimeRelation()
        self._timer: Timer | None = None  # from the first duration on
        self._looking = False

    def answer(self, shaft: Point, setpoint: Point | None = None) -> None:
        """
        Switch for a tick.

        Parameters
        ----------
        shaft : Point
            Angle, speed and acceleration of the shaft.
        setpoint : Point, optional
            Position, velocity and acceleration of the axis, where the node is one.

        """
        if not self._outputs:
            return
        phi, omega, alpha, sec, nanosec = shaft
        time = sec + 1e-9 * nanosec
        if time < self._last_time:
            self._forget()  # the time base has begun anew
        self._last_time = time
        if self._looking:
            self._note(time)
        for output in self._outputs.values():
            if output.over_position and setpoint is not None:
                on = output.answer(time, *setpoint[:3])
            else:
                on = output.answer(time, phi, omega, alpha)
            if on is not output.told:
                output.tell(on)
                if output.switch.is_timed and not self._looking:
                    self._look()

    def _look(self) -> None:
        """Begin to look for the end of a duration."""
        self._looking, self._relation = True, TimeRelation()
        self._note(self._last_time)
        if self._timer is None:
            self._timer = self._node.create_timer(
                _LOOKS_EVERY, self._expire, clock=self._node.tick_clock)
        else:
            self._timer.reset()

    def _note(self, time: float) -> None:
        self._heard = self._node.tick_clock.now().nanoseconds
        self._stamp = self._relation.stamp(round(time * NANOSECONDS), self._heard)

    def _expire(self) -> None:
        now = self._node.tick_clock.now().nanoseconds
        timed = [output for output in self._outputs.values() if output.switch.is_timed]
        if now - self._heard > _LOOKS_EVERY * NANOSECONDS:  # else ticks see to it
            time = self._last_time + (now - self._stamp) / NANOSECONDS
            for output in timed:
                if not output.switch.expire(time):
                    output.tell(False)
        if not timed and self._timer is not None:
            self._timer.cancel()
            self._looking = False

    def _forget(self) -> None:
        for output in self._outputs.values():
            output.switch.reset()

    def take(self, tracks: Mapping[str, TrackSettings]) -> None:
        """
        Switch by other settings from now on.

        Parameters
        ----------
        tracks : Mapping[str, TrackSettings]
            Tracks of the same names.

        """
        for name, settings in tracks.items():
            output = self._outputs[name]
            if settings != output.settings:
                output.take(settings, output.switch.count, output.switch.unseen)

    def release(self) -> None:
        """Switch everything off: the node ceases to work."""
        self._forget()
        timer, self._timer, self._looking = self._timer, None, False
        if timer is not None:
            self._node.destroy_timer(timer)
        for output in self._outputs.values():
            if output.told:
                output.tell(False)

    @property
    def misses(self) -> bool:
        """Whether a window has been too short to be seen."""
        return any(output.switch.unseen for output in self._outputs.values())

    def health(self) -> dict[str, Any]:
        """
        Give the figures of the diagnostics.

        Returns
        -------
        dict[str, Any]
            For each track whether it is on, how often it has been switched on, and how often
            its window lay between two ticks.

        """
        values: dict[str, Any] = {}
        for name, output in self._outputs.items():
            switch = output.switch
            values |= {f'{name}.on': switch.on, f'{name}.count': switch.count,
                       f'{name}.unseen': switch.unseen}
        return values
