# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""Motion laws, one file per family; importing this package registers them all."""

from cam_motion.motion.laws import harmonic, modified, polynomial, trapezoidal
from cam_motion.motion.laws.law import Coefficients, LAWS, LawType, make_law, MotionLaw, register
from cam_motion.motion.laws.parameters import LawParameter

__all__ = [
    'Coefficients', 'LAWS', 'LawParameter', 'LawType', 'MotionLaw', 'harmonic', 'make_law',
    'modified', 'polynomial', 'register', 'trapezoidal',
]
