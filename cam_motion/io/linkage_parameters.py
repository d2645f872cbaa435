# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The parameters of a linkage as tables."""

from __future__ import annotations

from cam_motion.io.parameters import AUTOSTART, ParameterSpec, REQUIRED

TYPE = 'linkage'
"""Value of ``type`` that makes a section the description of a linkage."""

LINKAGE = (
    ParameterSpec('type', 'string', REQUIRED, 'That the section describes a linkage.',
                  choices=(TYPE,)),
    ParameterSpec('inputs', 'string_list', REQUIRED, 'Names of the variables that are given.'),
    ParameterSpec('unknowns', 'string_list', REQUIRED,
                  'Names of the variables that the loops determine, two for each loop.'),
    ParameterSpec('bodies', 'string_list', REQUIRED, 'Names of the bodies that turn.'),
    ParameterSpec('vectors', 'string_list', REQUIRED,
                  'Names of the distances on bodies, from joint to joint.'),
    ParameterSpec('loops', 'string_list', REQUIRED, 'Names of the closed ways.'),
    ParameterSpec('points', 'string_list', [], 'Names of the points of interest.'),
    ParameterSpec('transmissions', 'string_list', [], 'Names of the transmission angles.'),
    ParameterSpec('loads', 'string_list', [],
                  'Names of the forces and torques that the inputs hold.'),
    ParameterSpec('motions', 'string_list', [], 'Names of the motions to draw.'),
    ParameterSpec('joint_states_hz', 'double', 0.0,
                  'How often the joint states are published; 0: at every tick.', 'Hz', least=0.0,
                  most=5000.0),
    ParameterSpec('markers_hz', 'double', 30.0,
                  'How often the markers are published; 0: at every tick.', 'Hz', least=0.0,
                  most=5000.0),
    ParameterSpec('frame_id', 'string', 'world', 'Frame of the markers and root of the URDF.'),
    ParameterSpec('velocity_scale', 'double', 0.2,
                  'Length of a velocity arrow per m/s; 0: no arrows.', 's', least=0.0, most=1e3),
    AUTOSTART,
)

_UNKNOWN = (
    ParameterSpec('start', 'double', None,
                  'Value that names the branch, of an unknown roughly.', 'm, rad', least=-1e6,
                  most=1e6),
    ParameterSpec('start_deg', 'double', None, 'The same of an angle.', 'deg', least=-36000.0,
                  most=36000.0),
)

_INPUT = (
    *_UNKNOWN,
    ParameterSpec('axis', 'string', None,
                  'The axis whose position it is, or that turns the crank of its spool; none: it '
                  'stays at the start.'),
    ParameterSpec('spool_radius', 'double', None,
                  'Radius of the spool that lets out a length from the start on, turned by a '
                  'crank.', 'm', above=0.0, most=1e3),
)

MOTION = (
    ParameterSpec('duration', 'double', REQUIRED, 'How long it takes.', 's', above=0.0,
                  most=3600.0),
)

PARTS: dict[str, tuple[ParameterSpec, ...]] = {
    'inputs': _INPUT,
    'unknowns': _UNKNOWN,
    'bodies': (
        ParameterSpec('angle', 'string', REQUIRED, 'The variable that is its angle.'),
    ),
    'vectors': (
        ParameterSpec('length', 'double', None, 'Its length where that is fixed.', 'm', least=1e-6,
                      most=1e6),
        ParameterSpec('variable', 'string', None, 'The variable that is its length: a slide.'),
        ParameterSpec('body', 'string', 'frame', 'The body that it turns with.'),
        ParameterSpec('turn_deg', 'double', 0.0, 'Its direction on the body.', 'deg',
                      least=-360.0, most=360.0),
    ),
    'loops': (
        ParameterSpec('path', 'string_list', REQUIRED,
                      'Vectors that sum to zero, a - before those passed backwards.'),
    ),
    'points': (
        ParameterSpec('from', 'string', '', 'The point before it; empty for the origin.'),
        ParameterSpec('path', 'string_list', [], 'Vectors from there to the point.'),
    ),
    'transmissions': tuple(
        ParameterSpec(end, 'string_list', REQUIRED, 'Vectors whose sum is one direction.')
        for end in ('first', 'second')),
    'loads': (
        ParameterSpec('point', 'string', None, 'The point that a force acts on.'),
        ParameterSpec('force_x', 'double', None, 'Its part along x.', 'N'),
        ParameterSpec('force_y', 'double', None, 'Its part along y.', 'N'),
        ParameterSpec('variable', 'string', None,
                      'The angle that a torque acts on, or the length that a force acts along.'),
        ParameterSpec('torque', 'double', None, 'The torque, counterclockwise.', 'N m'),
        ParameterSpec('force', 'double', None, 'The force, the way the length grows.', 'N'),
    ),
    'motions': MOTION,
}
"""What stands below the names in each list."""
