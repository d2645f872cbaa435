# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""What moves the axes: gears, inertias, resistances, and the torque and speed they cost."""
