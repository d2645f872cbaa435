# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The contour of a cam disc as a table of points, in CSV."""

from __future__ import annotations

import csv
from pathlib import Path

from cam_motion.errors import CamMotionError
from cam_motion.io.cam_disc_config import CamDiscSettings
from cam_motion.mechanism.cam_outline import Outline, outline
from cam_motion.units import DEGREE, MM
import numpy as np

COLUMNS = ('shaft_angle_deg', 'x_mm', 'y_mm', 'normal_x', 'normal_y', 'radius_of_curvature_mm',
           'centre_x_mm', 'centre_y_mm', 'pressure_angle_deg')
"""Columns: point, outward normal and signed radius of the contour, and the roller's centre."""

_ROUNDING = 1e-12  # mm, of a contour


def write_csv(settings: CamDiscSettings, path: Path, tolerance: float | None = None) -> Outline:
    """
    Write the contour as points within a tolerance, chord by chord.

    Parameters
    ----------
    settings : CamDiscSettings
        The disc.
    path : Path
        The file; its directory is made.
    tolerance : float | None
        Largest distance of the contour from the polyline [m]; None takes that of the disc.

    Returns
    -------
    Outline
        The polyline written, with its largest distance from the exact contour.

    Raises
    ------
    ConfigurationError
        When the contour is undercut.
    CamMotionError
        When the file cannot be written.

    """
    disc = settings.disc
    line = outline(disc, settings.tolerance if tolerance is None else tolerance)
    q = line.angles[:-1]
    found = disc.contact(q)
    normal = disc.on_disc(found.normal, q)
    centre = disc.pitch(q)
    columns = (q / DEGREE, line.points[:-1].real / MM, line.points[:-1].imag / MM, normal.real,
               normal.imag, disc.contour_radius(q) / MM, centre.real / MM, centre.imag / MM,
               found.pressure / DEGREE)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open('w', newline='', encoding='utf-8') as file:
            file.write(f'# cam disc {settings.name}: closed contour, {q.size} points, on the disc '
                       f'(x, y as in the machine at shaft angle 0)\n# chords at most '
                       f'{line.deviation / MM:.9g} mm off the exact contour\n')
            writer = csv.writer(file, lineterminator='\n')
            writer.writerow(COLUMNS)
            writer.writerows([f'{value:.12g}' if abs(value) > _ROUNDING else '0' for value in row]
                             for row in np.transpose(columns))
    except OSError as error:
        raise CamMotionError(f'{path}: cannot be written: {error.strerror or error}') from error
    return line
