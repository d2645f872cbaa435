# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""What a cam does: exact curves, motion laws, cam profiles and timing diagrams."""
