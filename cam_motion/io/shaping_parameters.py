# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The parameters of input shaping: what swings behind an axis, and the filter over its cams."""

from __future__ import annotations

from cam_motion.io.parameters import ParameterSpec
from cam_motion.motion.shaping import KINDS, TOLERANCE

NO_FILTER = 'none'
"""Kind of a filter that is none: what swings is only known, and advised upon."""

SHAPING = (
    ParameterSpec('shaping.kind', 'string', None,
                  'Filter over the cams of the axis, after which what swings behind it is at '
                  'rest: delayed copies (zv, zvd, zvdd, ei, each less sensitive and longer than '
                  'the one before), or the dynamically compensated cam (polydyne).',
                  choices=(NO_FILTER, *KINDS)),
    ParameterSpec('shaping.speed_cpm', 'double', None,
                  'Speed of the cam at which the filter is exact: that of the shaft times the '
                  'ratio.', 'cycles/min', above=0.0, most=1e6),
    ParameterSpec('shaping.frequency_hz', 'double', None,
                  'Undamped natural frequency of what swings.', 'Hz', least=1e-3, most=1e5),
    ParameterSpec('shaping.damping', 'double', 0.0, 'Its damping ratio.', least=0.0, most=0.9),
    ParameterSpec('shaping.container_width', 'double', None,
                  'In the place of the frequency: inner width, in the direction in which it '
                  'moves, of an open box with liquid.', 'm', least=1e-4, most=1e3),
    ParameterSpec('shaping.container_radius', 'double', None,
                  'Or the inner radius of an upright cylinder with liquid.', 'm', least=1e-4,
                  most=1e3),
    ParameterSpec('shaping.fill_height', 'double', None, 'Height of the liquid.', 'm', least=1e-4,
                  most=1e3),
    ParameterSpec('shaping.fit', 'bool', False,
                  'Whether each movement is shortened by the length of the filter, so that it '
                  'ends where its segment does; else it ends later by that.'),
    ParameterSpec('shaping.tolerance', 'double', TOLERANCE,
                  'ei: share of the vibration that may be left at its frequency.',
                  above=0.0, most=0.5),
)
"""What an axis with a load that swings has; nothing of it for one without."""
