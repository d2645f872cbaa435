# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
The door through which every process enters and leaves.

Asked to stop, a process goes quietly from its first moment on, and once its work is done nothing
can spoil its exit code any more.
"""

from __future__ import annotations

from contextlib import suppress
from functools import partial
from importlib import import_module
import os
import signal
import sys
from typing import NoReturn

_STAY = ('line', 'record')
"""Verbs of the command line that go on until they are asked to stop."""


def _leave_quietly(*_: object) -> None:
    # Nothing has begun that would have to be ended. An exception might end up in whatever is
    # being imported, which could take it for a fault of its own.
    os._exit(0)


def obey_signals() -> None:
    """End the process with exit code 0 on SIGINT and SIGTERM, until it has something to end."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _leave_quietly)


def leave(code: int) -> NoReturn:
    """
    End the process, now that its work is done.

    Interpreter and libraries are not torn down piece by piece: threads of DDS may outlive the last
    node by a moment, and would meet what is being destroyed.

    Parameters
    ----------
    code : int
        Exit code.

    """
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # nobody reads it any more, or it is closed
            stream.flush()
    os._exit(code)


def start(node: str) -> NoReturn:
    """
    Import a node and run it; the imports take most of a second.

    Parameters
    ----------
    node : str
        Name of the executable.

    """
    obey_signals()
    leave(import_module(f'cam_motion.nodes.{node}').main())


def command_line() -> NoReturn:
    """Carry out the command line of the process."""
    if sys.argv[1:2] and sys.argv[1] in _STAY:
        obey_signals()
    from cam_motion.cli import main
    leave(main())


bag_recorder = partial(start, 'bag_recorder')
cam_axis = partial(start, 'cam_axis')
drive_sim = partial(start, 'drive_sim')
line = partial(start, 'line')
linkage_state = partial(start, 'linkage_state')
master_shaft = partial(start, 'master_shaft')


if __name__ == '__main__':
    start(sys.argv.pop(1))
