# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a machine's drives do, as data: cycles of drives that follow, motion of those that turn."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.cycle import cycle_figures
from cam_motion.drive.document_004 import document_metrics
from cam_motion.drive.gearbox import Gearbox
from cam_motion.drive.orbit import find_orbit, NoOrbitError, Orbit
from cam_motion.drive.servo_cycle import limit_figures, servo_cycle, ServoCycle
from cam_motion.drive.shaft_load import ShaftLoad
from cam_motion.drive.start_up import StallError, start_up, StartUp
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.cam_drive_config import CamDriveSettings
from cam_motion.io.cam_drive_findings import motion_findings, start_up_findings
from cam_motion.io.machine import DriveSettings, Machine
from cam_motion.io.summary_data import margins_as_data
from cam_motion.io.turn import turn_profile
from cam_motion.runtime.ticks import NANOSECONDS
from cam_motion.units import DEGREE, RPM, TURN
import numpy as np

START_UP = 3.0
"""How long a start-up is followed at least, as the document does [s]."""

LONGEST_START_UP = 60.0
"""How long at most, where it is not over before [s]."""

_BAND = 1e-3  # below the least speed of the orbit by this share the start-up is not over

Progress = Callable[[str], None]


def simulate(machine: Machine, document: bool = True, tell: Progress = lambda _: None,
             ) -> dict[str, dict[str, Any]]:
    """
    Simulate every drive of a machine.

    Parameters
    ----------
    machine : Machine
        The machine; its axes turn at the set speed.
    document : bool
        Whether the metrics by document 004's own definitions and Euler scheme are computed
        too, which takes a few seconds.
    tell : Callable[[str], None]
        Told what is being computed.

    Returns
    -------
    dict[str, dict[str, Any]]
        Results by drive; see doc/json.md for the keys.

    Raises
    ------
    NoOrbitError, StallError
        When a motor cannot carry its load.
    ConfigurationError
        When a drive follows an axis, and the set speed is 0.

    """
    results: dict[str, dict[str, Any]] = {}
    for name, settings in machine.drives.items():
        tell(f'{name}: one cycle' if settings.servo is None else f'{name}: until cycles repeat')
        results[name] = _cycle(machine, settings)
    for name, cam_drive in machine.cam_drives.items():
        try:
            tell(f'{name}: periodic motion')
            orbit = find_orbit(cam_drive.drive)
            found = motion_findings(cam_drive, orbit)
            tell(f'{name}: start-up')
            run = start_up_until_settled(cam_drive.drive, orbit)
        except (NoOrbitError, StallError) as error:
            raise type(error)(f'{name}: {error}') from error
        results[name] = {
            'orbit': orbit_figures(cam_drive, orbit),
            'start_up': start_up_figures(cam_drive, orbit, run),
            'warnings': [*found, *start_up_findings(
                cam_drive, orbit, run, is_settled(orbit, run))]}
        if document:
            tell(f"{name}: the document's own scheme")
            results[name]['document'] = _document(cam_drive)
    return results


def _cycle(machine: Machine, settings: DriveSettings) -> dict[str, Any]:
    if machine.master.speed == 0.0:
        raise ConfigurationError([Problem(
            f'{machine.master.name}.speed_cpm', 0.0, 'there is no cycle without a speed',
            'give the speed at which the drives are to be simulated')])
    profile = turn_profile(machine.diagram.axes[settings.axis], settings.name)
    figures = cycle_figures(settings.drive, profile, machine.master.speed)
    found: dict[str, Any] = {
        'peak_torque': figures.peak_torque, 'rms_torque': figures.rms_torque,
        'peak_speed_rpm': figures.peak_speed / RPM,
        'regenerated_energy_per_cycle': figures.regenerated_energy,
        'motor_work_per_cycle': figures.motor_energy, 'inertia_ratio': figures.inertia_ratio,
    }
    motor = settings.motor
    if motor is not None:
        limits = limit_figures(settings.drive, motor, profile, machine.master.speed)
        found |= margins_as_data(limits)
        if motor.torque_constant is not None:
            found |= {'peak_current': motor.current(figures.peak_torque),
                      'rms_current': motor.current(figures.rms_torque)}
    cycle = live_cycle(machine, settings)
    if cycle is not None:
        tally = cycle.tally
        found['servo'] = {
            'peak_following_error': tally.peak_error, 'rms_following_error': tally.rms_error,
            'saturated_s_per_cycle': tally.saturated_ns / NANOSECONDS,
            'saturations_per_cycle': tally.saturations, 'catches_up': cycle.catches_up,
            'peak_torque': tally.peak_torque, 'rms_torque': tally.rms_torque,
            'peak_speed_rpm': tally.peak_speed / RPM,
            'regenerated_energy_per_cycle': tally.regenerated_energy,
            'motor_work_per_cycle': tally.motor_work}
    return found


def live_cycle(machine: Machine, settings: DriveSettings) -> ServoCycle | None:
    """
    Drive an axis in cycles at the set speed, with setpoints at the rate of the shaft.

    Parameters
    ----------
    machine : Machine
        The machine.
    settings : DriveSettings
        The drive.

    Returns
    -------
    ServoCycle | None
        The cycle; None for a drive that is no servo drive.

    """
    if settings.servo is None:
        return None
    return servo_cycle(
        settings.servo.axis(settings.drive), turn_profile(machine.diagram.axes[settings.axis]),
        machine.master.speed, machine.master.values['rate_hz'])


def orbit_figures(settings: CamDriveSettings, orbit: Orbit) -> dict[str, Any]:
    """
    Give the figures of a periodic motion.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.
    orbit : Orbit
        Its periodic motion.

    Returns
    -------
    dict[str, Any]
        See doc/json.md for the keys.

    """
    low, high = orbit.speeds
    contact = orbit.least_contact(settings.base)
    drive = settings.drive
    ratio, motor = drive.gearbox.ratio, drive.motor
    breakdown = motor.synchronous_speed * (1.0 - motor.breakdown_slip)
    working = motor.synchronous_speed - breakdown
    return {
        'fluctuation_pct': 100.0 * (high - low) / drive.nominal_speed,
        'stability_pct': 100.0 * (ratio * low - breakdown) / working,
        'running_cost_pct':
            100.0 * abs(0.5 * (low + high) * ratio - settings.rated_speed) / working,
        'period_s': orbit.period, 'min_speed_rpm': low / RPM, 'max_speed_rpm': high / RPM,
        'mean_speed_rpm': TURN / orbit.period / RPM,
        'min_contact_force': contact.value, 'min_contact_force_deg': contact.at % TURN / DEGREE,
        'motor_work_per_cycle': orbit.motor_work, 'drawn_work_per_cycle': orbit.drawn_work,
        'peak_gearbox_torque': orbit.peak_gearbox_torque,
        **_gearbox_margins(drive.gearbox, orbit.peak_gearbox_torque, high),
    }


def _gearbox_margins(gearbox: Gearbox, torque: float, speed: float) -> dict[str, float]:
    """Give what is left to the limits of a gearbox, where they are known."""
    margins = {}
    if gearbox.rated_torque is not None:
        margins['gearbox_torque_margin'] = gearbox.rated_torque - torque
    if gearbox.max_speed is not None:
        margins['gearbox_speed_margin_rpm'] = (gearbox.max_speed - gearbox.ratio * speed) / RPM
    return margins


def is_settled(orbit: Orbit, run: StartUp) -> bool:
    """
    Tell whether a start-up has become the periodic motion.

    Parameters
    ----------
    orbit : Orbit
        The periodic motion.
    run : StartUp
        The start-up.

    Returns
    -------
    bool
        Whether the speed at the beginning of its last revolution is that of the periodic motion
        to a thousandth.

    """
    begins = [stretch for stretch in run.stretches if stretch.element.start == 0.0]
    # of the energy, so twice the share of the speed
    return bool(begins) and abs(begins[-1].energy / orbit.start_energy - 1.0) < 2.0 * _BAND


def start_up_until_settled(drive: CamDrive, orbit: Orbit) -> StartUp:
    """
    Follow a start-up until it is the periodic motion, for 3 s at least and 60 s at most.

    Parameters
    ----------
    drive : CamDrive
        The drive.
    orbit : Orbit
        Its periodic motion.

    Returns
    -------
    StartUp
        The start-up.

    Raises
    ------
    StallError
        When the motor does not start, or stalls.

    """
    duration = START_UP
    run = start_up(drive, duration)
    while not is_settled(orbit, run) and duration < LONGEST_START_UP:
        duration = min(2.0 * duration, LONGEST_START_UP)
        run = start_up(drive, duration)
    return run


def start_up_figures(settings: CamDriveSettings, orbit: Orbit, run: StartUp) -> dict[str, Any]:
    """
    Give the figures of a start-up.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.
    orbit : Orbit
        Its periodic motion.
    run : StartUp
        Its start-up.

    Returns
    -------
    dict[str, Any]
        See doc/json.md for the keys.

    """
    drive, contact = settings.drive, run.least_contact(settings.base)
    first = run.crossings(drive.nominal_speed)
    # settled: up for the last time through the nominal speed, or through the least speed of
    # the periodic motion where that dips below
    band = min(drive.nominal_speed, orbit.speeds[0] * (1.0 - _BAND))
    through = run.crossings(band)
    return {
        'first_crossing_s': first[0] if first else None,
        'settled_s': through[-1] if through and is_settled(orbit, run) else None,
        'followed_s': run.duration,
        'min_contact_force': contact.value, 'min_contact_force_deg': contact.at % TURN / DEGREE,
        'start_torque': float(drive.motor_torque(np.zeros(1))[0]),
        'static_load_peak': ShaftLoad(drive).static_peak,
    }


def _document(settings: CamDriveSettings) -> dict[str, Any]:
    metrics = document_metrics(
        settings.drive, settings.base, rated_speed=settings.rated_speed)
    return {name: getattr(metrics, name) for name in (
        'steady_state_time_s', 'stability_pct', 'fluctuation_pct', 'running_cost_pct',
        'min_contact_force', 'max_pressure_angle_deg', 'max_torque_estimate')}
