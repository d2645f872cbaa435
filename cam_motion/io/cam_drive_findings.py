# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What the user of a cam drive ought to know though nothing is wrong with the file itself."""

from __future__ import annotations

from collections.abc import Iterator

from cam_motion.drive.orbit import find_orbit, NoOrbitError, Orbit
from cam_motion.drive.shaft_load import ShaftLoad
from cam_motion.drive.sizing_forward import Wishes
from cam_motion.drive.start_up import StartUp
from cam_motion.io.cam_drive_config import CamDriveSettings
from cam_motion.motion.piecewise import Peak
from cam_motion.units import DEGREE, RPM, TURN
import numpy as np


def findings(settings: CamDriveSettings) -> tuple[str, ...]:
    """
    Look whether a drive starts from any angle, reaches its speed and keeps its follower on.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.

    Returns
    -------
    tuple[str, ...]
        One sentence for each thing to mind, with its figures and a way out.

    """
    try:
        orbit = find_orbit(settings.drive)
    except NoOrbitError as error:
        return (*_at_rest(settings), str(error))
    return motion_findings(settings, orbit)


def motion_findings(settings: CamDriveSettings, orbit: Orbit) -> tuple[str, ...]:
    """
    Look at a drive whose periodic motion is known.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.
    orbit : Orbit
        Its periodic motion.

    Returns
    -------
    tuple[str, ...]
        As `findings`.

    """
    return (*_at_rest(settings), *_speed(settings, orbit),
            *_contact(orbit.least_contact(settings.base), 'periodic motion'))


def start_up_findings(settings: CamDriveSettings, orbit: Orbit, run: StartUp, settled: bool,
                      ) -> tuple[str, ...]:
    """
    Look at the start-up of a drive.

    Parameters
    ----------
    settings : CamDriveSettings
        The drive.
    orbit : Orbit
        Its periodic motion.
    run : StartUp
        Its start-up.
    settled : bool
        Whether it has been followed until it is the periodic motion.

    Returns
    -------
    tuple[str, ...]
        As `findings`, but nothing that is said of the periodic motion already.

    """
    found = []
    if not settled:
        found.append(
            f'the start-up is not over within {run.duration:.3g} s: what is said of it holds for '
            'this time only; a smaller flywheel, a stronger motor or a larger ratio shortens it')
    if orbit.least_contact(settings.base).value >= 0.0:
        found += _contact(run.least_contact(settings.base), 'the start-up')
    return tuple(found)


def _at_rest(settings: CamDriveSettings) -> Iterator[str]:
    drive = settings.drive
    torque = float(drive.motor_torque(np.zeros(1))[0])
    if torque <= (peak := ShaftLoad(drive).static_peak):
        yield (f'the motor does not start from every angle: at rest it gives {torque:.4g} N m at '
               f'the cam shaft, and the static load takes up to {peak:.4g} N m; take a stronger '
               'motor or a larger ratio')


def _speed(settings: CamDriveSettings, orbit: Orbit) -> Iterator[str]:
    drive, mean = settings.drive, TURN / orbit.period
    off = 100.0 * (mean / drive.nominal_speed - 1.0)
    if abs(off) > Wishes().speed_tolerance_pct:
        ratio = drive.gearbox.ratio
        yield (f'the cam shaft turns at {mean / RPM:.4g} rpm on average, {off:+.1f} % off the '
               f'nominal {drive.nominal_speed / RPM:.4g} rpm; without load it would turn at '
               f'{drive.motor.synchronous_speed / ratio / RPM:.4g} rpm: a ratio of about '
               f'{ratio * mean / drive.nominal_speed:.4g} instead of {ratio:.4g} would make the '
               'nominal speed, if the motor can')


def _contact(least: Peak, when: str) -> Iterator[str]:
    if least.value < 0.0:
        yield (f'the follower lifts off its cam: the contact force falls to {least.value:.4g} N '
               f'at {least.at % TURN / DEGREE:.1f} deg in {when}, and the figures, which take it '
               'to stay on, do not hold; take a stiffer spring, more preload or a lower speed')
