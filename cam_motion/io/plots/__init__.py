# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Pictures, one concept per file; every function returns a Figure and touches no global state."""

from cam_motion.io.plots.cam_drive import cam_figure, load_figure
from cam_motion.io.plots.cam_drive_motion import orbit_figure, start_up_figure
from cam_motion.io.plots.contour import contour_figure
from cam_motion.io.plots.diagram import timing_diagram
from cam_motion.io.plots.flywheel import flywheel_curve, flywheel_figure
from cam_motion.io.plots.laws import laws_figure
from cam_motion.io.plots.linkage import linkage_figure
from cam_motion.io.plots.motor import motor_figure
from cam_motion.io.plots.optimal import optimal_figure
from cam_motion.io.plots.profile import profile_figure
from cam_motion.io.plots.recorded import recorded_figure, recorded_torque_figure, shaft_figure
from cam_motion.io.plots.servo import following_figure
from cam_motion.io.plots.sizing import sizing_figure
from cam_motion.io.plots.style import FORMATS, save
from cam_motion.io.plots.table import table_figure
from cam_motion.io.plots.torque import torque_curve, torque_figure

__all__ = [
    'FORMATS', 'cam_figure', 'contour_figure', 'flywheel_curve', 'flywheel_figure',
    'following_figure', 'laws_figure', 'linkage_figure', 'load_figure', 'motor_figure',
    'optimal_figure', 'orbit_figure', 'profile_figure', 'recorded_figure',
    'recorded_torque_figure', 'save', 'shaft_figure', 'sizing_figure', 'start_up_figure',
    'table_figure', 'timing_diagram', 'torque_curve', 'torque_figure',
]
