# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The motion core beside scipy's PPoly."""

from benchmarks.row import best_of, Row
from cam_motion import CamProfile, segment
from cam_motion.units import TURN
import numpy as np
from scipy.interpolate import PPoly

_CALLS = 20_000
_POINTS = 1_000_000


def motion_rows() -> list[Row]:
    """
    Measure scalar and vectorised evaluation.

    Returns
    -------
    list[Row]
        The rows.

    """
    cam = CamProfile([
        segment('wait', 145.0), segment('cut', 225.0, 0.080, 'modified_trapezoid'),
        segment('dwell', 235.0), segment('back', 295.0, -0.080, 'modified_trapezoid'),
        segment('rest', 360.0)])
    # the same joints with a cubic in each: scipy has no sinusoids
    breaks = np.array(cam.curve.breaks)
    values = np.array([cam.curve(breaks[:-1], order) for order in range(4)])
    spline = PPoly(values[::-1] / np.array([6.0, 2.0, 1.0, 1.0])[:, None], breaks)
    return [_scalar(cam, spline), _vectorised(cam, spline)]


def _scalar(cam: CamProfile, spline: PPoly) -> Row:
    sample = cam.sample
    angles = np.random.default_rng(1).uniform(0.0, TURN, _CALLS).tolist()

    def ours() -> None:
        for phi in angles:
            sample(phi)

    def peer() -> None:
        for phi in angles[:_CALLS // 10]:
            spline(phi), spline(phi, 1), spline(phi, 2), spline(phi, 3)

    mine, other = best_of(ours) / _CALLS, best_of(peer) / (_CALLS // 10)
    return Row('profile.sample: y, y′, y″, y‴ of one angle', f'{mine * 1e6:.2f} µs',
               f'{other * 1e6:.1f} µs (4 PPoly calls)', f'{other / mine:.0f} × faster',
               '≤ 1 µs, ≥ 20 × faster')


def _vectorised(cam: CamProfile, spline: PPoly) -> Row:
    angles = np.sort(np.random.default_rng(2).uniform(0.0, TURN, _POINTS))
    mine = best_of(lambda: [cam(angles, order) for order in range(3)], 5)
    other = best_of(lambda: [spline(angles, order) for order in range(3)], 5)
    points = 3 * _POINTS * 1e-6
    return Row('profile(φ): p, v, a over 10⁶ sorted angles',
               f'{points / mine:.0f} M values/s', f'{points / other:.0f} M values/s (PPoly)',
               f'{other / mine:.1f} × faster', 'faster')
