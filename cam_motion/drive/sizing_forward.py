# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Sizing by forward dynamics: motors, gearboxes and flywheels for a drive that turns a cam."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
import math
from typing import Any, NamedTuple

from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.designs import Designs
from cam_motion.drive.motor import InductionMotor, KlossMotor
from cam_motion.drive.shaft_load import ShaftLoad
from cam_motion.drive.sizing import Candidate, Check, GearboxChoice, Progress, silent
from cam_motion.drive.sizing_inverse import gearbox_checks
from cam_motion.drive.sweep import OrbitTable, sweep
from cam_motion.units import RPM, TURN
import numpy as np

_CHUNK = 512  # designs per task: the progress is seen, at a fifth less speed than the fastest

Sweep = Callable[..., OrbitTable]


@dataclass(frozen=True)
class MotorChoice:
    """
    An induction motor that a drive could have.

    Attributes
    ----------
    name : str
        Its name.
    motor : InductionMotor | KlossMotor
        The motor.
    rated_power : float
        Rated power [W].
    rated_torque : float
        Rated torque [N m].
    rated_speed : float
        Rated speed [rad/s].
    source : str
        Where the figures are from.

    """

    name: str
    motor: InductionMotor | KlossMotor
    rated_power: float
    rated_torque: float
    rated_speed: float
    source: str = ''

    @property
    def starting_torque(self) -> float:
        """Give the torque at rest, that of the curve [N m]."""
        return float(self.motor.torque(0.0))


class Wishes(NamedTuple):
    """
    What a drive that turns a cam has to keep, all in per cent.

    The largest fluctuation of the speed and the largest deviation of its mean, both of the
    nominal speed; by how much the torque at rest must exceed the peak of the static load; and the
    least stability: how far the slowest moment keeps off breakdown, of the way from breakdown to
    synchronous speed.
    """

    fluctuation_pct: float = 5.0
    speed_tolerance_pct: float = 5.0
    start_margin_pct: float = 10.0
    stability_pct: float = 25.0


Pair = tuple[MotorChoice, GearboxChoice]


def designs_of(pairs: Sequence[Pair], flywheels: Sequence[float]) -> Designs:
    """
    Combine pairs with flywheels.

    Parameters
    ----------
    pairs : Sequence[tuple[MotorChoice, GearboxChoice]]
        Motors with gearboxes.
    flywheels : Sequence[float]
        Inertias on the motor shaft [kg m²].

    Returns
    -------
    Designs
        Every pair with every flywheel, the flywheel changing first.

    """
    rows = []
    for choice, box in pairs:
        motor, gearbox = choice.motor, box.gearbox
        curve = ((motor.a, motor.b) if isinstance(motor, InductionMotor)
                 else (0.5 / motor.breakdown_slip, 0.0))
        rows += [(
            motor.synchronous_speed, motor.breakdown_torque, motor.breakdown_slip, *curve,
            motor.inertia, gearbox.ratio, gearbox.efficiency, gearbox.inertia, flywheel,
        ) for flywheel in flywheels]
    return Designs(*np.array(rows, dtype=np.float64).reshape(-1, 10).T.copy())


def size_line_shaft(
    drive: CamDrive, pairs: Sequence[Pair], flywheels: Sequence[float], wishes: Wishes,
    executor: Executor | None = None, tell: Progress = silent, find: Sweep = sweep,
) -> list[Candidate]:
    """
    Turn a cam shaft by every pair of motor and gearbox with every flywheel.

    Parameters
    ----------
    drive : CamDrive
        The drive whose load is turned; its nominal speed is what the mean speed has to meet.
    pairs : Sequence[tuple[MotorChoice, GearboxChoice]]
        Motors with gearboxes.
    flywheels : Sequence[float]
        Inertias on the motor shaft [kg m²].
    wishes : Wishes
        What has to be kept.
    executor : concurrent.futures.Executor, optional
        Shares the work between processes or hosts.
    tell : Callable[[int, int], None]
        Told how many are done, of how many.
    find : Callable
        Finds the periodic motions, as `sweep`.

    Returns
    -------
    list[Candidate]
        One per pair and flywheel.

    Notes
    -----
    The torque at the output of the gearbox is taken as that at constant mean speed: what the
    small changes of the speed take from the load's own inertia is left out.

    """
    if not pairs or not flywheels:
        return []
    load = ShaftLoad(drive)
    designs = designs_of(pairs, flywheels)
    tell(0, len(designs))
    table = find(drive.profile, drive.parts, drive.nominal_speed, designs,
                 executor=executor, chunk=_CHUNK, tell=tell)
    found, rows = [], zip(*(np.asarray(column).tolist() for column in table))
    for pair in pairs:
        for flywheel in flywheels:
            orbit = OrbitTable(*next(rows))  # floats where the table has arrays
            found.append(_candidate(drive.nominal_speed, load, pair, flywheel, wishes, orbit))
    return found


def _candidate(nominal: float, load: ShaftLoad, pair: Pair, flywheel: float, wishes: Wishes,
               orbit: OrbitTable) -> Candidate:
    choice, box = pair
    motor, ratio = choice.motor, box.gearbox.ratio
    passed = ratio * box.gearbox.efficiency
    start = Check(
        'starts_from_rest', choice.starting_torque * passed,
        load.static_peak * (1.0 + 0.01 * wishes.start_margin_pct), 'N m', at_least=True)
    figures = {'start_torque': start.value, 'static_load_peak': load.static_peak}
    if not orbit.found:
        checks: tuple[Check, ...] = (
            Check('periodic_motion', motor.breakdown_torque * passed,
                  load.torques(nominal)[0], 'N m', at_least=True, failed=True), start)
        return Candidate(choice.name, box.name, ratio, flywheel, choice.rated_power, figures,
                         checks)
    low, high, period = float(orbit.min_speed), float(orbit.max_speed), float(orbit.period)
    mean = TURN / period
    breakdown = motor.synchronous_speed * (1.0 - motor.breakdown_slip)
    working = motor.synchronous_speed - breakdown
    figures |= {
        'fluctuation_pct': 100.0 * (high - low) / nominal,
        'stability_pct': 100.0 * (ratio * low - breakdown) / working,
        'period_s': period, 'min_speed_rpm': low / RPM, 'max_speed_rpm': high / RPM,
        'mean_speed_rpm': mean / RPM, 'motor_work_per_cycle': float(orbit.motor_work),
        'drawn_work_per_cycle': float(orbit.drawn_work),
        'least_follower_force': float(orbit.least_follower_force),
        'rms_motor_torque': float(orbit.rms_motor_torque),
        'peak_motor_torque': float(orbit.peak_motor_torque),
    }
    limited = math.isfinite(min(box.rated_torque, box.peak_torque))
    torques = load.torques(mean) if limited else (0.0, 0.0)
    checks = (
        start,
        Check('mean_speed', 100.0 * abs(mean / nominal - 1.0), wishes.speed_tolerance_pct, '%'),
        Check('fluctuation', figures['fluctuation_pct'], wishes.fluctuation_pct, '%'),
        Check('contact', figures['least_follower_force'], 0.0, 'N', at_least=True),
        Check('rms_torque', figures['rms_motor_torque'], choice.rated_torque, 'N m'),
        Check('stability', figures['stability_pct'], wishes.stability_pct, '%', at_least=True),
        *gearbox_checks(box, 1.0 / period, torques, (ratio * mean, ratio * high)),
    )
    return Candidate(choice.name, box.name, ratio, flywheel, choice.rated_power, figures, checks)


def drive_of(drive: CamDrive, pair: Pair, flywheel: float) -> CamDrive:
    """
    Give a drive another motor, gearbox and flywheel.

    Parameters
    ----------
    drive : CamDrive
        The drive.
    pair : tuple[MotorChoice, GearboxChoice]
        Motor and gearbox.
    flywheel : float
        Inertia of the flywheel [kg m²].

    Returns
    -------
    CamDrive
        The other drive.

    """
    motor: Any = pair[0].motor
    return replace(drive, motor=motor, gearbox=pair[1].gearbox, flywheel=flywheel)
