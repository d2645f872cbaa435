# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""At run time: an axis engages, changes its cam, and is left alone by its shaft; never a jump."""

from dataclasses import replace

from cam_motion import CamProfile, Limits, segment
from cam_motion.runtime.follower import Follower
from cam_motion.runtime.follower_settings import FollowerSettings, FollowerState
from cam_motion.runtime.layout import Coupling, Layout
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft
from cam_motion.units import DEGREE, RPM

press = CamProfile([
    segment('wait', end_deg=90.0), segment('down', end_deg=180.0, lift=0.05, law='cycloidal'),
    segment('up', end_deg=360.0, lift=-0.05, law='modified_trapezoid')])
layout = Layout({'press': press}, {'press': Coupling()}, active=('press',))
axis = Follower(layout, FollowerSettings(Limits(velocity=2.0, acceleration=60.0)), engaged=False)
shaft = Shaft(120.0 * RPM, RampLimits(30.0, 300.0), RampLimits(150.0, 3000.0))
shaft.run(0.0)

points, tick = [], 0.002


def turn(seconds):
    """Turn the shaft on, tick by tick."""
    for _ in range(round(seconds / tick)):
        points.append(axis.answer(*shaft.state(len(points) * tick)))


turn(1.05)
print('engages', axis.engage().text('m'))
turn(1.2)
shifted = replace(axis.layout, couplings={'press': Coupling(phase=30.0 * DEGREE, scale=0.8)})
print('changes', axis.change(shifted).text('m'))
turn(1.12)
print(axis.state.value)

axis.coast()                                # no shaft point comes any more: it stops on its curve
shaft.quick_stop(len(points) * tick)
turn(0.3)
axis.hold(FollowerState.HELD, 'the shaft has fallen silent')
print(axis.state.value, f'at {points[-1][0]:.6f} m')
shaft.reset(len(points) * tick)
shaft.run(len(points) * tick)
turn(1.0)                                   # the shaft is back, the axis waits to be reset
print('resumes', axis.reset().text('m'))
turn(1.0)
print(axis.state.value)

steps = [max(abs(b[order] - a[order]) for a, b in zip(points, points[1:])) / tick
         for order in (0, 1)]
print(f'from tick to tick: at most {steps[0]:.4f} m/s and {steps[1]:.3f} m/s²')
