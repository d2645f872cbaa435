# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""What goes in and out: configurations, bags, pictures and reports."""
