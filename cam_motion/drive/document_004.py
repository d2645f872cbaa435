# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Document 004's own simulation and its own figures, beside the exact ones of this package."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
import math
from typing import NamedTuple

from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.load import Follower
from cam_motion.drive.motor import InductionMotor, KlossMotor
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.motion.piece import Array
from cam_motion.units import DEGREE, TURN
import numpy as np

GRID_POINTS = 401
"""Shaft angles from 0 to one turn, both included, on which the document seeks its maxima."""

_BLOCK = 3000  # steps found together; a dozen rounds are enough for so few
_LEAST_STEPS = 3  # fewer leave nothing in the window from one third on


class DocumentHistory(NamedTuple):
    """
    The document's simulation, one value per step.

    Time [s], unwrapped angle [rad], speed [rad/s] and acceleration [rad/s²] of the cam shaft,
    torque of the motor at the cam shaft, J dw/dt and C w² [N m], contact force [N].
    """

    t: Array
    q: Array
    omega: Array
    alpha: Array
    motor_torque: Array
    inertia_torque: Array
    centripetal_torque: Array
    contact_force: Array


@dataclass(frozen=True)
class DocumentMetrics:
    """
    The document's figures by its own definitions.

    Attributes
    ----------
    steady_state_time_s : float or None
        First time at which the speed is above the nominal one [s]; None if it never is.
    stability_pct : float
        Distance of the least speed from the motor's breakdown speed, as a share of the distance
        of the synchronous speed from it [%].
    fluctuation_pct : float
        Difference of greatest and least speed by the nominal speed [%].
    running_cost_pct : float
        Distance of the mean of both, at the motor, from its rated speed, as the same share [%].
    min_contact_force : float
        Least contact force, the start-up included [N].
    max_pressure_angle_deg : float
        Greatest pressure angle on the grid [deg].
    max_torque_estimate : float
        Greatest torque at the cam shaft on the grid at constant nominal speed [N m].
    history : DocumentHistory
        The simulation.

    """

    steady_state_time_s: float | None
    stability_pct: float
    fluctuation_pct: float
    running_cost_pct: float
    min_contact_force: float
    max_pressure_angle_deg: float
    max_torque_estimate: float
    history: DocumentHistory = field(repr=False, compare=False)


def document_metrics(drive: CamDrive, base: float, step: float = 1e-5, duration: float = 3.0,
                     rated_speed: float | None = None) -> DocumentMetrics:
    """
    Simulate a drive as document 004 does, and take its figures as it does.

    Parameters
    ----------
    drive : CamDrive
        The drive, with an induction motor.
    base : float
        Distance of the roller's centre from the cam shaft at s = 0 [m].
    step : float
        Step of the explicit Euler method [s]. The document lists 1e-4; its printed figures come
        from 1e-5.
    duration : float
        How long, from rest [s].
    rated_speed : float, optional
        Rated speed of the motor, from which the running cost counts [rad/s]; without one it is
        that at the nominal speed of the cam shaft.

    Returns
    -------
    DocumentMetrics
        The figures.

    Raises
    ------
    ConfigurationError
        When the motor has no breakdown slip, the step or the duration is out of range, or the
        step is so long that the method diverges.

    Notes
    -----
    Kept as in the script: the efficiency multiplies even where the load drives the motor; the
    slip is taken from the magnitude of the speed; extremes come from the steps from one third of
    the time on, whether the motion has settled by then or not; the very last step, which the
    script fills with 0/0, counts nowhere. The speeds relate to ratio * nominal speed as the
    motor's rated speed.

    References
    ----------
    E. Dag, ME418 Dynamics of Machinery (Middle East Technical University, 2022), script in the
    appendix (document 004).

    """
    motor = drive.motor
    problems = []
    if not isinstance(motor, InductionMotor | KlossMotor):
        problems.append(Problem(
            'motor', type(motor).__name__, 'must have a synchronous speed and a breakdown slip',
            "document 004's figures are defined for induction motors"))
    if not (math.isfinite(base) and base > 0.0):
        problems.append(Problem('base', base, 'must be a finite number above 0'))
    if not (math.isfinite(step) and step > 0.0):
        problems.append(Problem('step', step, 'must be a finite number above 0'))
    elif not _LEAST_STEPS * step <= duration < math.inf:
        problems.append(Problem(
            'duration', duration, f'must be finite and at least {_LEAST_STEPS} steps long'))
    if problems or not isinstance(motor, InductionMotor | KlossMotor):
        raise ConfigurationError(problems)

    history = _simulate(drive, base, step, duration)
    above = np.flatnonzero(history.omega > drive.nominal_speed)
    # the script counts from 1 and its vectors are one longer: ceil(n/3) to n - 1
    window = history.omega[math.ceil((history.t.size + 1) / 3) - 1:]
    slowest, fastest = float(np.min(window)), float(np.max(window))
    ratio = drive.gearbox.ratio
    rated = ratio * drive.nominal_speed if rated_speed is None else rated_speed
    breakdown = (1.0 - motor.breakdown_slip) * motor.synchronous_speed
    span = motor.synchronous_speed - breakdown
    mean = 0.5 * (slowest + fastest)
    angle, torque = _grid_maxima(drive, base)
    return DocumentMetrics(
        steady_state_time_s=float(history.t[above[0]]) if above.size else None,
        stability_pct=100.0 * (ratio * slowest - breakdown) / span,
        fluctuation_pct=100.0 * (fastest - slowest) / drive.nominal_speed,
        running_cost_pct=100.0 * abs(ratio * mean - rated) / span,
        min_contact_force=float(np.min(history.contact_force)),
        max_pressure_angle_deg=angle / DEGREE,
        max_torque_estimate=torque,
        history=history)


def _follower(drive: CamDrive, q: Array) -> Follower:
    """Place the follower for angles within one turn; at its end from the left."""
    curve = drive.profile.curve
    return Follower(q, curve.evaluate(q), curve.evaluate(q, 1), curve.evaluate(q, 2))


def _motor_torque(drive: CamDrive, omega: Array) -> Array:
    """Give the motor's torque at the cam shaft as the script does, whichever way power flows."""
    box = drive.gearbox
    torque: Array = box.ratio * box.efficiency * drive.motor.torque(box.ratio * np.abs(omega))
    return torque


def _grid_maxima(drive: CamDrive, base: float) -> tuple[float, float]:
    """Find the greatest pressure angle [rad] and torque at constant speed [N m] on the grid."""
    at = _follower(drive, np.linspace(0.0, TURN, GRID_POINTS))
    terms, omega = drive.terms(at), drive.nominal_speed
    torque = terms.centripetal * omega ** 2 - terms.force - terms.damping * omega
    return float(np.max(np.arctan2(at.s1, base + at.s))), float(np.max(torque))


def _simulate(drive: CamDrive, base: float, step: float, duration: float) -> DocumentHistory:
    def acceleration(q: Array, omega: Array) -> Array:
        terms = drive.terms(_follower(drive, np.mod(q, TURN)))
        torque = terms.force + terms.damping * omega + _motor_torque(drive, omega)
        rate: Array = (torque - terms.centripetal * omega ** 2) / terms.inertia
        return rate

    count = math.floor(duration / step + 1e-6)
    t, q, omega = (np.empty(count) for _ in range(3))
    alpha = np.zeros(count)
    end = (0.0, 0.0, 0.0)
    with np.errstate(all='ignore'):
        for first in range(0, count, _BLOCK):
            part = slice(first, min(first + _BLOCK, count))
            q[part], omega[part], alpha[part], end = _block(
                acceleration, end, part.stop - part.start, step)
            if not np.all(finite := np.isfinite(alpha[part])):
                at = step * (first + int(np.argmin(finite)))
                raise ConfigurationError([Problem(
                    'step', step, f'the explicit Euler method diverges within {at:.4g} s',
                    'take a shorter step')])
    t[:] = step * np.arange(count)
    follower = _follower(drive, np.mod(q, TURN))
    terms = drive.terms(follower)
    return DocumentHistory(
        t, q, omega, alpha, _motor_torque(drive, omega), terms.inertia * alpha,
        terms.centripetal * omega ** 2, drive.contact_force(follower, omega, alpha, base))


def _block(acceleration: Callable[[Array, Array], Array], start: tuple[float, float, float],
           count: int, step: float) -> tuple[Array, Array, Array, tuple[float, float, float]]:
    """
    Find a number of explicit Euler steps together.

    All steps are guessed and put through their own formulas until nothing changes. Each step
    depends on earlier ones only, so at least one more of them is final after each round, and
    what stands at the end is what the loop over the steps gives. As one step changes little,
    all are final after a few rounds.
    """
    q0, omega0, alpha0 = start
    alpha = np.full(count, alpha0)
    omega = _steps(omega0, np.full(count, step * alpha0))
    q = _steps(q0, step * omega[:-1])
    for final in range(count + 1):
        alpha = acceleration(q[:-1], omega[:-1])
        before = omega, q
        omega = _steps(omega0, step * alpha)
        q = _steps(q0, step * omega[:-1])
        if np.array_equal(omega, before[0]) and np.array_equal(q, before[1]):
            break
        if final < count and not np.isfinite(alpha[final]):
            break
    return q[:-1], omega[:-1], alpha, (float(q[-1]), float(omega[-1]), float(alpha[-1]))


def _steps(start: float, changes: Array) -> Array:
    """Add changes one after the other, as a loop would."""
    sums: Array = np.cumsum(np.concatenate([[start], changes]))
    return sums
