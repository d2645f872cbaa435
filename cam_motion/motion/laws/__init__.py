# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Motion laws, one file per family; importing this package registers them all."""

from cam_motion.motion.laws import (
    harmonic,
    modified,
    polynomial,
    scca,
    trapezoidal,
    variants,
    with_coefficients,
    with_conditions,
    with_points,
)
from cam_motion.motion.laws.boundary import Boundary
from cam_motion.motion.laws.law import (
    Coefficients,
    LAWS,
    laws_between,
    LawType,
    make_law,
    Member,
    MotionLaw,
    register,
)
from cam_motion.motion.laws.parameters import LawParameter

__all__ = [
    'Boundary', 'Coefficients', 'LAWS', 'LawParameter', 'LawType', 'Member', 'MotionLaw',
    'harmonic', 'laws_between', 'make_law', 'modified', 'polynomial', 'register', 'scca',
    'trapezoidal', 'variants', 'with_coefficients', 'with_conditions', 'with_points',
]
