# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A shaft that follows an encoder: the master's part when something real turns the machine."""

from __future__ import annotations

from collections.abc import Mapping
import math
from typing import Any

from cam_motion.nodes.managed_node import ManagedNode
from cam_motion.nodes.shaft_ticker import ShaftTicker
from cam_motion.runtime.encoder import JumpGate, SmoothShaft, TrackingFilter, Unwrapping
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft_motion import ShaftMotion, ShaftState
from cam_motion.units import DEGREE, TURN
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState

_SAMPLES = 10  # after which the filter is trusted
_ASTRAY = 5  # measurements in a row that cannot be: the encoder has lost its angle


class EncoderInput:
    """
    Gives the shaft at every tick as an encoder measures it.

    Parameters
    ----------
    node : ManagedNode
        The node that turns the shaft.
    values : Mapping[str, Any]
        Its parameters, checked.
    ticker : ShaftTicker
        Its ticks: they relate the stamps of the encoder to the machine's time base.

    Attributes
    ----------
    text : str
        What it does: ``waiting``, ``following``, ``stopping`` or ``stopped``. It stops when the
        encoder falls silent, or has jumped: the machine has not, so that neither the old angle
        nor the new one is to be trusted until it is reset.
    reason : str
        Why it has stopped.
    samples, refused : int
        Measurements taken, and messages without a finite angle of the joint.

    """

    def __init__(self, node: ManagedNode, values: Mapping[str, Any], ticker: ShaftTicker) -> None:
        """Listen to the encoder."""
        self._node = node
        self._ticker = ticker
        self._joint = values['encoder.joint']
        self._unwrap = Unwrapping(values['encoder.ratio'], values['encoder.offset_deg'] * DEGREE,
                                  values['encoder.wraps'])
        self._bandwidth = values['encoder.bandwidth'] * TURN
        self._dead_time = values['encoder.dead_time']
        self._timeout = values['encoder.timeout']
        self._limits = RampLimits(values['quick_stop_acceleration'], values['quick_stop_jerk'])
        self.samples = self.refused = 0
        self._gate = JumpGate()
        self.reset()
        node.make_subscription(JointState, values['encoder.topic'], self._on_sample,
                               qos_profile_sensor_data)

    def reset(self) -> None:
        """Wait for the encoder anew."""
        self._filter = TrackingFilter(self._bandwidth)
        jumps, self._gate = self._gate.refused, JumpGate()
        self._gate.refused = jumps
        self._smooth: SmoothShaft | None = None
        self._ramp: ShaftMotion | None = None
        self._heard = 0
        self._last = 0.0  # time of the last tick [s]
        self.state = ShaftState(0.0, 0.0, 0.0)
        """The shaft at the last tick."""
        self.text, self.reason = 'waiting', ''

    def release(self, t: float, reason: str) -> None:
        """
        Come to rest on its own.

        Parameters
        ----------
        t : float
            Time of the last tick [s].
        reason : str
            Why.

        """
        if self._ramp is None and self._smooth is not None:
            self._ramp = ShaftMotion(t, self._smooth.state).ramped(t, 0.0, self._limits)
            self.text, self.reason = 'stopping', reason

    def tick(self, t: float) -> ShaftState | None:
        """
        Give the shaft at a tick.

        Parameters
        ----------
        t : float
            Time of the tick [s].

        Returns
        -------
        ShaftState | None
            Where it is; None before the encoder has been heard long enough.

        """
        if self._ramp is not None:
            self.state = self._ramp.state(t)
            if self.state.omega == 0.0 == self.state.alpha:
                self.text = 'stopped'
            return self.state
        if self._heard < _SAMPLES:
            return None
        if self._gate.astray >= _ASTRAY:
            text = f'the encoder has jumped by {self._gate.jump / DEGREE:.4g} deg'
            self._node.get_logger().error(f'{text}: stopping')
            self.release(self._last, text)
            return self.tick(t)
        if t - self._filter.time > self._timeout:
            self._node.get_logger().error(
                f'the encoder has been silent for {t - self._filter.time:.3g} s: stopping')
            self.release(self._last, 'the encoder has fallen silent')
            return self.tick(t)
        target = self._filter.at(t + self._dead_time)
        if self._smooth is None:
            self._smooth = SmoothShaft(2.0 * self._bandwidth)
            self._smooth.state = target._replace(alpha=0.0)
            self.text = 'following'
        elif t > self._last:
            # ticks may have been missed: what counts is the time since the last one
            self._smooth.follow(target, t - self._last)
        self._last = t
        self.state = self._smooth.state
        return self.state

    @property
    def stands(self) -> bool:
        """Tell whether the shaft stands, or has never been known."""
        if self._ramp is None:
            return self._smooth is None
        return self.text == 'stopped'

    @property
    def jumps(self) -> int:
        """Count the measurements that were left out because no shaft can have come there."""
        return self._gate.refused

    def health(self) -> dict[str, Any]:
        """
        Give the figures of the diagnostics.

        Returns
        -------
        dict[str, Any]
            Figures by name.

        """
        values: dict[str, Any] = {'encoder_samples': self.samples, 'encoder_refused': self.refused,
                                  'encoder_jumps': self.jumps}
        return values | ({'reason': self.reason} if self.reason else {})

    def _on_sample(self, message: JointState) -> None:
        if not self._ticker.begun:
            return
        index = 0
        if self._joint:
            index = list(message.name).index(self._joint) if self._joint in message.name else -1
        if not 0 <= index < len(message.position) or not math.isfinite(message.position[index]):
            self.refused += 1
            return
        stamp = message.header.stamp
        stamp_ns = stamp.sec * 10**9 + stamp.nanosec or self._node.get_clock().now().nanoseconds
        t = (stamp_ns - self._ticker.stamp(0)) * 1e-9
        phi, state = self._unwrap(message.position[index]), self._filter.state
        trusted = self._heard >= _SAMPLES and state is not None
        if not self._gate.admits(t, phi, state.omega if trusted else None):
            self._node.get_logger().error(
                f'the encoder jumps by {self._gate.jump / DEGREE:.4g} deg: left out',
                throttle_duration_sec=1.0)
            return
        self._filter.update(t, phi)
        self.samples += 1
        self._heard += 1
