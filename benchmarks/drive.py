# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The cam drive of document 004 beside time stepping by scipy and beside the document's Euler."""

from pathlib import Path

from benchmarks.row import best_of, Row
from cam_motion.drive.document_004 import document_metrics
from cam_motion.drive.orbit import find_orbit
from cam_motion.drive.start_up import start_up
from cam_motion.drive.time_stepping import step_in_time
from cam_motion.io.config import load_machine

_MACHINE = Path(__file__).parent.parent / 'config' / 'cam_press_drive.yaml'
_DURATION = 3.0  # s from rest, as the document runs it; the orbit has settled by then to 1e-9
_RTOL = 1e-8


def drive_rows() -> list[Row]:
    """
    Measure start-up and periodic motion.

    Returns
    -------
    list[Row]
        The rows.

    """
    settings = load_machine(_MACHINE).cam_drives['press_drive']
    drive = settings.drive
    ours = best_of(lambda: start_up(drive, _DURATION), 15)
    orbit = best_of(lambda: find_orbit(drive), 15)
    stepping = best_of(lambda: step_in_time(drive, _DURATION, rtol=_RTOL), 2)
    euler = best_of(lambda: document_metrics(drive, settings.base), 1)
    return [
        Row('document 004: 3 s from rest', f'{ours * 1e3:.0f} ms',
            f'{stepping * 1e3:.0f} ms (solve_ivp), {euler * 1e3:.0f} ms (its Euler scheme)',
            f'{stepping / ours:.0f} × faster', '≤ 20 ms'),
        Row('document 004: periodic motion', f'{orbit * 1e3:.1f} ms',
            f'{stepping * 1e3:.0f} ms (solve_ivp until settled)',
            f'{stepping / orbit:.0f} × faster', '≤ 5 ms'),
    ]
