# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A sweep over designs of the cam drive, beside time stepping by scipy design by design."""

from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
import multiprocessing
from pathlib import Path
from time import perf_counter

from benchmarks.row import best_of, Row
from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.gearbox import Gearbox
from cam_motion.drive.motor import KlossMotor
from cam_motion.drive.sweep import Designs, sweep
from cam_motion.drive.time_stepping import step_in_time
from cam_motion.io.config import load_machine
from cam_motion.units import RPM
import numpy as np

_MACHINE = Path(__file__).parent.parent / 'config' / 'cam_press_drive.yaml'
_COUNT = 16384  # designs: four tasks
_PEERS = 3  # designs stepped in time
_SETTLED = 3.0  # s, as the document runs it
_RTOL = 1e-8
_WORKERS = 2


def _designs(drive: CamDrive) -> Designs:
    """Draw motors, ratios and flywheels around those of the document."""
    draw = np.random.default_rng(4)
    made = []
    for _ in range(_COUNT // 16):
        torque = float(np.exp(draw.uniform(np.log(8.0), np.log(80.0))))
        motor = KlossMotor(1500.0 * RPM, torque, draw.uniform(0.15, 0.4), 1e-4 * torque)
        gearbox = Gearbox(draw.uniform(3.0, 3.7), draw.choice([0.85, 0.9, 0.95]), 0.004)
        made.append(replace(drive, motor=motor, gearbox=gearbox))
    few = Designs.of(made)
    many = few[np.tile(np.arange(len(few)), _COUNT // len(few))]
    return replace(many, flywheel=draw.uniform(0.0, 0.2, _COUNT))


def sweep_rows() -> list[Row]:
    """
    Measure the sweep on one core, on two, and the stepping of single designs.

    Returns
    -------
    list[Row]
        The rows.

    """
    drive = load_machine(_MACHINE).cam_drives['press_drive'].drive
    designs = _designs(drive)
    task = drive.profile, drive.parts, drive.nominal_speed, designs
    alone = best_of(lambda: sweep(*task), 2)
    context = multiprocessing.get_context('spawn')
    with ProcessPoolExecutor(_WORKERS, mp_context=context) as executor:
        sweep(*task[:3], designs[:_WORKERS], executor, chunk=1)  # starts the workers
        together = best_of(lambda: sweep(*task, executor), 2)
    start = perf_counter()
    for k in range(_PEERS):
        peer = designs.drive(k, *task[:3])
        step_in_time(peer, _SETTLED, drive.nominal_speed, rtol=_RTOL)
    stepping = (perf_counter() - start) / _PEERS
    return [
        Row('document 004: sweep over designs', f'{_COUNT / alone:.0f} designs/s per core',
            f'{1.0 / stepping:.1f} designs/s (solve_ivp until settled)',
            f'{stepping * _COUNT / alone:.0f} × faster', '≥ 5000 designs/s per core'),
        Row(f'the same on {_WORKERS} cores', f'{_COUNT / together:.0f} designs/s',
            f'{_COUNT / alone:.0f} designs/s on one', f'{alone / together:.2f} × faster',
            'linear in cores'),
    ]
