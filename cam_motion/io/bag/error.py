# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""The error of the bag library."""

from __future__ import annotations

from cam_motion.errors import CamMotionError


class BagError(CamMotionError):
    """A bag cannot be written or read; the message names the file, the rule and a way out."""
