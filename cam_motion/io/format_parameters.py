# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Parameters of interlocks and of a change of format."""

from __future__ import annotations

from cam_motion.io.axis_parameters import CAM, TRANSITIONS
from cam_motion.io.parameters import ParameterSpec, REQUIRED


def _out_of_rest(end: str) -> tuple[ParameterSpec, ...]:
    return (
        ParameterSpec(f'{end}_above', 'double', None,
                      f'windows: the {end} axis is out of its rest above this position.', 'unit'),
        ParameterSpec(f'{end}_below', 'double', None, 'Or below this one.', 'unit'),
        ParameterSpec(f'{end}_moving', 'bool', False, 'Or while it moves.'),
    )


INTERLOCK = (
    ParameterSpec('kind', 'string', REQUIRED,
                  'windows: both axes are never out of their rest at once; distance: the gap '
                  'offset + first_factor · first + second_factor · second never gets too small.',
                  choices=('windows', 'distance')),
    ParameterSpec('first', 'string', REQUIRED, 'Name of an axis.'),
    ParameterSpec('second', 'string', REQUIRED, 'Name of another axis.'),
    *_out_of_rest('first'), *_out_of_rest('second'),
    ParameterSpec('first_factor', 'double', 1.0,
                  'distance: what the position of the first axis is multiplied by.'),
    ParameterSpec('second_factor', 'double', -1.0, 'The same of the second.'),
    ParameterSpec('offset', 'double', 0.0, 'distance: the gap where both stand at 0.', 'unit'),
    ParameterSpec('least', 'double', None, 'distance: the least gap.', 'unit'),
)
"""What stands below each interlock of a line."""

STAGED = (
    ParameterSpec('staged', 'string', '',
                  'New parameters of the axis as YAML, all of them: checked against the limits, '
                  'and taken over when format_change says; empty: none.'),
    ParameterSpec('staged_at_deg', 'double', 0.0, 'Shaft angle at which they are to be taken '
                  'over.', 'deg', least=0.0, most=360.0),
    ParameterSpec('staged_span_deg', 'double', 0.0,
                  'Shaft angle over which; 0: as short as the limits allow.', 'deg', least=0.0,
                  most=36000.0),
)
"""What an axis has beside its own parameters, and only while it runs."""

_OF_A_FORMAT = (
    *(spec.name for spec in CAM), 'cams', 'active', 'limits', 'shaft_acceleration', 'shaft_jerk',
    'engage_at_start', 'start_position', 'shaping', *TRANSITIONS)


def is_of_a_format(name: str) -> bool:
    """
    Tell the parameters of an axis that belong to a format from those of the machine.

    Parameters
    ----------
    name : str
        Name of a parameter of an axis.

    Returns
    -------
    bool
        Whether a change of format may change it; else it stays what it was at the start.

    """
    return name.partition('.')[0] in _OF_A_FORMAT
