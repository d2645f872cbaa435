# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""One cam: rise and return between dwells, its position and its exact peaks."""

from cam_motion import CamProfile, segment
from cam_motion.units import DEGREE

cam = CamProfile([
    segment('low', end_deg=60.0),
    segment('rise', end_deg=120.0, lift=20.0, law='cycloidal'),
    segment('high', end_deg=180.0),
    segment('fall', end_deg=240.0, lift=-20.0, law='modified_trapezoid'),
    segment('rest', end_deg=360.0),
])
for at_deg in (75.0, 90.0, 150.0, 210.0, 240.0):
    y, velocity, acceleration, jerk = cam.sample(at_deg * DEGREE)
    print(f'at {at_deg:5.1f} deg: {y:13.10f} deg')
for peaks in cam.segment_peaks:
    if not peaks.segment.is_dwell:
        print(f'{peaks.segment.name}: velocity {peaks.velocity.value * DEGREE:+.6f} deg/deg, '
              f'acceleration {peaks.acceleration.value * DEGREE:+.6f} rad/rad² '
              f'at {peaks.acceleration.at / DEGREE:.1f} deg')
