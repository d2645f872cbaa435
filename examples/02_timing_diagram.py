# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A timing diagram: three axes of a cutting machine on one shaft, and how fast it may turn."""

from cam_motion import Axis, CamProfile, Limits, segment, TimingDiagram
from cam_motion.units import RPM

LAW = 'modified_trapezoid'
feeder = CamProfile([segment('feed', 80.0, 0.300, LAW), segment('wait', 360.0)], accumulate=True)
press = CamProfile([
    segment('open', 90.0), segment('press', 135.0, 0.020, LAW), segment('hold', 305.0),
    segment('lift', 350.0, -0.020, LAW), segment('rest', 360.0)])
knife = CamProfile([
    segment('up', 145.0), segment('cut', 225.0, 0.080, LAW), segment('down', 235.0),
    segment('back', 295.0, -0.080, LAW), segment('rest', 360.0)])
machine = TimingDiagram({
    'feeder': Axis('feeder', feeder, 'm', Limits(velocity=10.0, acceleration=400.0)),
    'press': Axis('press', press, 'm', Limits(acceleration=100.0)),
    'knife': Axis('knife', knife, 'm', Limits(velocity=4.0)),
})
omega = 200.0 * RPM
for name, axis in machine.axes.items():
    for peaks in axis.profile.segment_peaks:
        if not peaks.segment.is_dwell:
            print(f'{name:6} {peaks.segment.name:5}: {peaks.velocity.value * omega:+7.3f} m/s, '
                  f'{peaks.acceleration.value * omega**2:+8.2f} m/s²')
held_by, bound = machine.speed_bound()
print(f'highest speed {bound.omega / RPM:.2f} cycles/min: the {bound.quantity} of {held_by}, '
      f'{bound.segment}')
