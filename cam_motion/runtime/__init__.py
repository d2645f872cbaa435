# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""The machine in motion, free of ROS: everything here takes time as an argument."""
