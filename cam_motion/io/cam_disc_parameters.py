# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The parameters of a cam disc and of what loads its follower, as tables."""

from __future__ import annotations

from typing import Any

from cam_motion.io.cam_drive_parameters import PARTS
from cam_motion.io.parameters import ParameterSpec, REQUIRED

TYPE = 'cam_disc'
"""Value of ``type`` that makes a section the description of a cam disc."""

ROLLERS = ('translating_roller', 'swinging_roller')
SWINGING = ('swinging_roller', 'swinging_flat')
FOLLOWERS = ('translating_roller', 'translating_flat', 'swinging_roller', 'swinging_flat')
"""Kinds of followers."""


def _number(name: str, meaning: str, unit: str, default: Any = None, above: float | None = None,
            least: float | None = None, most: float | None = None) -> ParameterSpec:
    return ParameterSpec(name, 'double', default, meaning, unit, above, least, most)


CAM_DISC = (
    ParameterSpec('type', 'string', REQUIRED, 'That the section describes a cam disc.',
                  choices=(TYPE,)),
    ParameterSpec('profile', 'string', REQUIRED, 'Name of the axis whose motion the disc makes; '
                  'its unit is m, or rad for a follower that swings.'),
    ParameterSpec('follower', 'string', 'translating_roller', 'Kind of the follower.',
                  choices=FOLLOWERS),
    ParameterSpec('direction', 'string', 'counterclockwise',
                  'How the disc turns, with the follower above it; the bearing of one that swings '
                  'is to the right.', choices=('counterclockwise', 'clockwise')),
    _number('base_radius', 'Base radius of the disc; left out it is that of the drive.', 'm',
            above=0.0, most=1e3),
    _number('roller_radius', 'Radius of the roller, 0 for a knife edge; left out it is that of '
            'the drive.', 'm', least=0.0, most=1e3),
    _number('offset', 'Distance of the line of travel from the shaft, positive to the right.',
            'm', least=-1e3, most=1e3),
    _number('arm_length', 'Distance of the roller from the bearing of a follower that swings.',
            'm', above=0.0, most=1e3),
    _number('pivot_distance', 'Distance of that bearing from the shaft.', 'm', above=0.0,
            most=1e3),
    _number('face_offset', 'Distance of a flat face from its bearing, towards the disc.', 'm',
            least=-1e3, most=1e3),
    ParameterSpec('groove', 'bool', False,
                  'Whether the roller runs in a groove, which holds it from both sides.'),
    ParameterSpec('load', 'string_list', [], 'Names of the parts that load the follower.'),
    ParameterSpec('drive', 'string', '', 'Drive with mode line_shaft that turns the disc: its '
                  'load loads the follower, and its periodic motion counts.'),
    _number('speed_rpm', 'Speed of the shaft for the contact force; left out it is that of the '
            'line.', 'rpm', above=0.0, most=1e6),
    _number('limits.pressure_angle_deg', 'Largest pressure angle.', 'deg', above=0.0, most=89.9),
    _number('limits.return_pressure_angle_deg', 'The same on the way back, where it differs.',
            'deg', above=0.0, most=89.9),
    _number('limits.radius_of_curvature',
            'Least radius of curvature of the contour where it bulges.', 'm', least=0.0, most=1e3),
    _number('limits.cutter_radius', 'Radius of the cutter that must fit into every hollow.', 'm',
            least=0.0, most=1e3),
    _number('limits.contact_force', 'Contact force that must be left.', 'N', least=0.0,
            most=1e9),
    _number('tolerance', 'Largest distance of an exported contour from the exact one.', 'm',
            2e-6, least=1e-9, most=1e-2),
    _number('bore_radius', 'Radius of the bore for the shaft.', 'm', above=0.0, most=1e3),
    _number('keyway.width', 'Width of the keyway in the bore.', 'm', above=0.0, most=1e3),
    _number('keyway.depth', 'Depth of the keyway, from the bore.', 'm', above=0.0, most=1e3),
    _number('keyway.angle_deg', 'Where the keyway is on the disc, counterclockwise from the right '
            'at shaft angle 0.', 'deg', 90.0),
)
"""Parameters of a cam disc; the parts of its load have theirs below their names."""

_KIND = ParameterSpec('type', 'string', REQUIRED, 'Kind of the part.',
                      choices=('inertia', 'spring', 'friction', 'process'))
_SWING = {
    'inertia': (_number('inertia', 'Inertia of the follower about its bearing.', 'kg m²',
                        REQUIRED, least=0.0),
                _number('weight_moment', 'Moment of its weight towards the disc.', 'N m', 0.0)),
    'spring': (_number('stiffness', 'Stiffness about the bearing.', 'N m/rad', REQUIRED,
                       least=0.0),
               _number('preload_deg', 'Turn of the spring at zero.', 'deg', 0.0)),
    'friction': (_number('viscous', 'Viscous friction.', 'N m s/rad', 0.0, least=0.0),
                 _number('coulomb', 'Coulomb friction.', 'N m', 0.0, least=0.0)),
    'process': (_number('moment', 'Moment against the follower on its way outwards.', 'N m', 0.0),
                next(spec for spec in PARTS['process'] if spec.name == 'window_deg')),
}

SWING_PARTS: dict[str, tuple[ParameterSpec, ...]] = {
    kind: (_KIND, *table) for kind, table in _SWING.items()}
"""Parameters of the parts that load a follower that swings, by their type."""

TRAVEL_PARTS = {kind: table for kind, table in PARTS.items() if kind != 'inertia'}
"""Parameters of the parts that load a follower that travels, by their type."""
