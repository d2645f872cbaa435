# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""Run the command line as ``python -m cam_motion``."""

import sys

from cam_motion.cli import main

if __name__ == '__main__':
    sys.exit(main())
