# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
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
