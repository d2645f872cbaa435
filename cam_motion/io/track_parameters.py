# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The parameters of cam tracks and of the look-ahead for ros2_control, as tables."""

from __future__ import annotations

from cam_motion.io.parameters import ParameterSpec

_COMPENSATION = ('By how long switching {} is put off; negative: brought forward, to make up for '
                 'the dead time of what is switched.')

TRACK = (
    ParameterSpec('on_deg', 'double_list', [],
                  'Shaft angles at which the track is switched on, moving forwards.', 'deg'),
    ParameterSpec('off_deg', 'double_list', [],
                  'Where each of them is switched off; before its on_deg: in the next cycle.',
                  'deg'),
    ParameterSpec('duration', 'double', None,
                  'Instead of off_deg: how long the track stays on.', 's', above=0.0,
                  most=3600.0),
    ParameterSpec('direction', 'string', 'both', 'Direction of motion in which it is switched on.',
                  choices=('both', 'positive', 'negative')),
    ParameterSpec('on_compensation', 'double', 0.0, _COMPENSATION.format('on'), 's', least=-10.0,
                  most=10.0),
    ParameterSpec('off_compensation', 'double', 0.0, _COMPENSATION.format('off'), 's',
                  least=-10.0, most=10.0),
    ParameterSpec('hysteresis_deg', 'double', 0.0,
                  'Motion back and forth by no more than this switches nothing.', 'deg',
                  least=0.0),
)
"""A track over the angle of the shaft."""

AXIS_TRACK = (
    ParameterSpec('source', 'string', 'shaft',
                  'What the track is over: the angle of the shaft, or the position of the axis.',
                  choices=('shaft', 'position')),
    *TRACK,
    ParameterSpec('on_at', 'double_list', [], 'For source: position, instead of on_deg.',
                  'unit'),
    ParameterSpec('off_at', 'double_list', [], 'For source: position, instead of off_deg.',
                  'unit'),
    ParameterSpec('hysteresis', 'double', 0.0,
                  'For source: position, instead of hysteresis_deg.', 'unit', least=0.0),
    ParameterSpec('modulo', 'double', None,
                  'For source: position: after which the places repeat, such as the stroke of an '
                  'axis that accumulates.', 'unit', above=0.0),
)
"""A track of an axis, over the shaft or over the position of the axis."""

TRAJECTORY = (
    ParameterSpec('trajectory.rate_hz', 'double', 0.0,
                  'Messages on ~/trajectory per second, for ros2_control; 0: none.', 'Hz',
                  least=0.0, most=1000.0),
    ParameterSpec('trajectory.points', 'integer', 5,
                  'Points ahead in each of them, one every 1/rate_hz. Further points are where '
                  'segments meet, and in a stop by stop_acceleration and stop_jerk behind them, '
                  'which takes place if no further message comes.', least=2, most=1000),
    ParameterSpec('trajectory.joint', 'string', '',
                  'Name of the joint there; empty: that of the axis.'),
    ParameterSpec('trajectory.effort', 'bool', False,
                  'Whether points carry the effort that the drive of the axis takes, where it is '
                  'of the same process; for controllers that claim the effort interface: others '
                  'refuse it.'),
)
"""The look-ahead of an axis."""
