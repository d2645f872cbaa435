# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures, one concept per file; every function returns a Figure and touches no global state."""

from cam_motion.io.plots.diagram import timing_diagram
from cam_motion.io.plots.profile import profile_figure
from cam_motion.io.plots.recorded import recorded_figure, recorded_torque_figure, shaft_figure
from cam_motion.io.plots.style import FORMATS, save
from cam_motion.io.plots.torque import torque_curve, torque_figure

__all__ = [
    'FORMATS', 'profile_figure', 'recorded_figure', 'recorded_torque_figure', 'save',
    'shaft_figure', 'timing_diagram', 'torque_curve', 'torque_figure',
]
