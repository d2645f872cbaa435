# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Starting a node as a process: asked to stop, it goes quietly from its first moment on."""

from __future__ import annotations

from functools import partial
from importlib import import_module
import os
import signal
import sys


def _leave(*_: object) -> None:
    # Nothing has begun that would have to be ended. An exception might end up in whatever is
    # being imported, which could take it for a fault of its own.
    os._exit(0)


def start(node: str) -> int:
    """
    Import a node and run it; the imports take most of a second.

    Parameters
    ----------
    node : str
        Name of the executable.

    Returns
    -------
    int
        Exit code.

    """
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _leave)
    code: int = import_module(f'cam_motion.nodes.{node}').main()
    return code


bag_recorder = partial(start, 'bag_recorder')
cam_axis = partial(start, 'cam_axis')
drive_sim = partial(start, 'drive_sim')
line = partial(start, 'line')
linkage_state = partial(start, 'linkage_state')
master_shaft = partial(start, 'master_shaft')


if __name__ == '__main__':
    sys.exit(start(sys.argv.pop(1)))
