# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""The executor: rclpy's events executor where it exists, else the default one."""

from __future__ import annotations

import os

from rclpy.context import Context
from rclpy.executors import Executor, SingleThreadedExecutor

CHOICE = 'CAM_MOTION_EXECUTOR'
"""Environment variable: ``default`` takes rclpy's default executor, to compare or to fall back."""


def make_executor(context: Context | None = None) -> Executor:
    """
    Make the executor that all nodes of the process share.

    Parameters
    ----------
    context : Context, optional
        The context of the nodes; None for the global one.

    Returns
    -------
    Executor
        To be driven by ``spin_once`` with a timeout: plain ``spin`` of the events executor
        ignores signals in some builds.

    """
    if os.environ.get(CHOICE) != 'default':
        try:
            from rclpy.experimental import EventsExecutor
            return EventsExecutor(context=context)
        except ImportError:
            pass  # rclpy before 7.1.4
    return SingleThreadedExecutor(context=context)
