# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The motion of a cam drive over time, step by step: the slow solver that checks the fast one."""

from __future__ import annotations

from typing import Any, NamedTuple

from cam_motion.drive.cam_drive import CamDrive, Element
from cam_motion.drive.start_up import StallError
from cam_motion.motion.piece import Array
from cam_motion.units import TURN
import numpy as np


class TimeHistory(NamedTuple):
    """Times [s], unwrapped angles [rad] and speeds [rad/s] of the cam shaft, shape (n,) each."""

    t: Array
    q: Array
    omega: Array


def step_in_time(drive: CamDrive, duration: float, omega: float = 0.0, rtol: float = 1e-11,
                 ) -> TimeHistory:
    """
    Integrate J dw/dt + C w² = Q from q = 0, one element of the shaft angle after the other.

    Parameters
    ----------
    drive : CamDrive
        The drive.
    duration : float
        How long [s].
    omega : float
        Speed at the start [rad/s].
    rtol : float
        Relative tolerance.

    Returns
    -------
    TimeHistory
        The steps of the integrator; elements begin and end on one.

    Raises
    ------
    StallError
        When the shaft comes to a stop.

    Notes
    -----
    Runge-Kutta of order 8 (DOP853). Stopping at the end of each element keeps its order, which
    a step of the load would spoil. The kink where the power in the gearbox changes its direction
    is left to the control of the step size.

    """
    from scipy.integrate import solve_ivp
    t, q = 0.0, 0.0
    steps = [(np.array([t]), np.array([q]), np.array([omega]))]
    index, turn = 0, 0.0
    while t < duration:
        element = drive.elements[index]

        def rates(_: float, state: Array, element: Element = element, turn: float = turn,
                  ) -> list[float]:
            at = drive.follower(element, np.array([state[0] - turn]))
            alpha = drive.acceleration(at, state[1:2])
            return [float(state[1]), float(alpha[0])]

        def over(_: float, state: Array, end: float = element.end + turn) -> float:
            return float(state[0]) - end

        def stalls(_: float, state: Array) -> float:
            return float(state[1])

        over.terminal, over.direction = True, 1.0  # type: ignore[attr-defined]
        stalls.terminal, stalls.direction = True, -1.0  # type: ignore[attr-defined]
        options: dict[str, Any] = {'method': 'DOP853', 'rtol': rtol, 'atol': rtol}
        done = solve_ivp(rates, (t, duration), [q, omega], events=(over, stalls), **options)
        if done.status == 1 and done.t_events[1].size:
            raise StallError(f'the shaft comes to a stop after {float(done.t[-1]):.4g} s at '
                             f'{float(done.y[0, -1]):.4g} rad: the motor cannot carry the load')
        if done.status == 1:
            # the event comes from the interpolant, which is of lower order than the steps
            done = solve_ivp(rates, (t, float(done.t[-1])), [q, omega], **options)
            t, q, omega = float(done.t[-1]), *map(float, done.y[:, -1])
            rest = (element.end + turn - q) / omega
            alpha = rates(t, np.array([q, omega]))[1]
            done.t[-1], done.y[:, -1] = t + rest, (element.end + turn, omega + alpha * rest)
        steps.append((done.t[1:], done.y[0, 1:], done.y[1, 1:]))
        t, q, omega = float(done.t[-1]), *map(float, done.y[:, -1])
        if t >= duration:
            break
        index += 1
        if index == len(drive.elements):
            index, turn = 0, turn + TURN
            q = turn
    return TimeHistory(*(np.concatenate(column) for column in zip(*steps)))
