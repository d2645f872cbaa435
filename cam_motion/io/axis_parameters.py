# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The parameters of an axis: its cams, their couplings, its transitions and limits."""

from __future__ import annotations

from cam_motion.io.parameters import AUTOSTART, ParameterSpec, REQUIRED, TRACKS
from cam_motion.io.shaping_parameters import SHAPING
from cam_motion.io.track_parameters import TRAJECTORY

SHAFT = 'shaft'
"""What an axis follows that follows no other axis: the name of the shaft's topic."""

CAM = (
    ParameterSpec('cycle', 'string', 'return',
                  'Whether the cam comes back in each cycle or accumulates its stroke.',
                  choices=('return', 'accumulate')),
    ParameterSpec('segments', 'string_list', REQUIRED, 'Names of the segments, in order.'),
    ParameterSpec('ratio', 'double', 1.0,
                  'Turns of the cam per turn of the shaft; over another axis, radians of the cam '
                  'per unit of that axis (6.283185307 for one turn per unit). Negative turns it '
                  'backwards.'),
    ParameterSpec('phase_deg', 'double', 0.0, 'Angle of the cam at shaft angle 0.', 'deg'),
    ParameterSpec('scale', 'double', 1.0, 'What the lifts are multiplied by.'),
    ParameterSpec('offset', 'double', 0.0, 'What is added to the position.', 'unit'),
)
"""What makes up one cam and its coupling."""

TRANSITIONS = {
    'engage': 'engaging', 'disengage': 'disengaging', 'change': 'a change of cams, phase, scale '
    'or offset', 'resume': 'the way back after a stop',
}


def _timing(name: str, meaning: str) -> tuple[ParameterSpec, ...]:
    if name == 'resume':
        begins = ('When the way back after a stop begins: now, to catch up with the shaft, or at '
                  'the angle at which the axis was held, when the shaft has come round.')
        choices: tuple[str, ...] = ('now', 'angle')
    else:
        begins = (f'When {meaning} begins: now, at a shaft angle, at the end of the cycle of the '
                  'cam (of all cams together, where several are in use), or as soon as it fits '
                  'within the limits.')
        choices = ('now', 'angle', 'cycle_end', 'soonest')
    angle = () if name == 'resume' else (
        ParameterSpec(f'{name}.angle_deg', 'double', 0.0,
                      f'That angle, for {name}.at: angle; over another axis, angle of the cam but '
                      'for its phase.', 'deg', least=0.0, most=360.0),)
    return (
        ParameterSpec(f'{name}.at', 'string', 'now', begins, choices=choices), *angle,
        ParameterSpec(f'{name}.span_deg', 'double', 90.0,
                      'Shaft angle over which it goes, if the limits allow; over another axis, '
                      'angle of the cam.', 'deg', least=1.0, most=3600.0),
        ParameterSpec(f'{name}.longest_deg', 'double', 1440.0,
                      'Up to which it is lengthened if they do not.', 'deg', least=1.0,
                      most=36000.0),
    )


CAM_AXIS = (
    ParameterSpec('unit', 'string', 'm', 'Unit of the position.'),
    ParameterSpec('follows', 'string', SHAFT,
                  'What the axis follows: the shaft, or the setpoints of the axis of that name.'),
    *CAM,
    ParameterSpec('cams', 'string_list', [],
                  'Names of several cams; each has segments and a coupling below its name.'),
    ParameterSpec('active', 'string_list', [],
                  'Which of these are in use, added up; empty: the first.'),
    ParameterSpec('limits.velocity', 'double', None, 'Largest velocity of the axis.', 'unit/s',
                  above=0.0),
    ParameterSpec('limits.acceleration', 'double', None, 'Largest acceleration of the axis.',
                  'unit/s²', above=0.0),
    ParameterSpec('limits.jerk', 'double', None, 'Largest jerk of the axis.', 'unit/s³',
                  above=0.0),
    ParameterSpec('limits.lowest', 'double', None,
                  'Lowest position; not for an axis that accumulates, which leaves any range.',
                  'unit'),
    ParameterSpec('limits.highest', 'double', None, 'Highest position, likewise.', 'unit'),
    ParameterSpec('shaft_acceleration', 'double', 30.0,
                  'Acceleration of the shaft that every transition leaves room for; over another '
                  'axis, of the cam.', 'rad/s²', least=0.0),
    ParameterSpec('shaft_jerk', 'double', 300.0, 'Jerk of the shaft likewise.', 'rad/s³',
                  least=0.0),
    ParameterSpec('engage_at_start', 'bool', True,
                  'Whether the axis is on its curve from the first shaft point on; else it '
                  'stands until it is engaged.'),
    ParameterSpec('start_position', 'double', 0.0, 'Where it stands until then.', 'unit'),
    ParameterSpec('engage.master', 'string', 'absolute',
                  'relative: engaging starts the cam at its beginning, wherever the shaft is.',
                  choices=('absolute', 'relative')),
    ParameterSpec('engage.slave', 'string', 'absolute',
                  'relative: engaging adds the cam to the position at which the axis stands.',
                  choices=('absolute', 'relative')),
    ParameterSpec('disengage.position', 'double', None,
                  'Where the axis is to stand when disengaged, for one that accumulates whole '
                  'strokes further; none: where it gets to.', 'unit'),
    *(spec for name, meaning in TRANSITIONS.items() for spec in _timing(name, meaning)),
    ParameterSpec('dead_time', 'double', 0.0,
                  'By how much the axis runs ahead of the shaft, to make up for what its drive '
                  'lags behind.', 's', least=-1.0, most=1.0),
    ParameterSpec('master_timeout', 'double', 0.5,
                  'After this long without a shaft point the axis stops on its curve; after '
                  'twice as long without a setpoint of another axis that it follows, which by '
                  'then has begun to bring itself to rest.', 's',
                  above=0.0, most=60.0),
    ParameterSpec('stop_acceleration', 'double', 150.0,
                  'Deceleration of the shaft by which the axis stops on its own curve when it '
                  'must stop while the shaft goes on, or the shaft has fallen silent; the same '
                  'for all axes that are to stop together. An axis that follows another one '
                  'stops within 2 stop_acceleration / stop_jerk, whatever the unit of that one.',
                  'rad/s²', above=0.0),
    ParameterSpec('stop_jerk', 'double', 3000.0, 'Jerk of that stop.', 'rad/s³', above=0.0),
    *SHAPING,
    TRACKS,
    *TRAJECTORY,
    AUTOSTART,
)

SEGMENT = (
    ParameterSpec('law', 'string', 'dwell', 'Name of the motion law.'),
    ParameterSpec('end_deg', 'double', REQUIRED,
                  'Shaft angle at which the segment ends; the last one ends at 360.', 'deg'),
    ParameterSpec('lift', 'double', 0.0, 'Change of position over the segment.', 'unit'),
)

_COUPLING = ('ratio', 'phase_deg', 'scale', 'offset')


def is_coupling(name: str) -> bool:
    """
    Tell the parameters of an axis that may change while it runs.

    Parameters
    ----------
    name : str
        Name of a parameter of an axis.

    Returns
    -------
    bool
        Whether it belongs to a coupling, a transition or the limits.

    """
    head, _, rest = name.partition('.')
    return (head in ('active', 'limits', 'shaft_acceleration', 'shaft_jerk', *_COUPLING)
            or head in TRANSITIONS or rest in _COUPLING)
