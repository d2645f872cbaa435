# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Child processes that run nodes: started, watched, and brought to a clean end in bounded time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
import importlib.util
import json
import os
from pathlib import Path
import signal
import subprocess
import sys
import threading

from cam_motion.errors import CamMotionError

START_WITHIN = 20.0
"""Time a node may take from its start to its first message [s]."""

STOP_WITHIN = 10.0
"""Time a node has to come to rest before it is killed [s]."""

Printer = Callable[[str], None]


def require_ros() -> None:
    """
    Make sure that nodes can run here.

    Raises
    ------
    CamMotionError
        When rclpy is missing; says how to get it.

    """
    if importlib.util.find_spec('rclpy') is None:
        raise CamMotionError(
            'this verb runs ROS 2 nodes, and rclpy is missing: source a ROS 2 Jazzy installation, '
            'or build .venv with `make` and use .venv/bin/cam_motion')


class Child:
    """
    A node process in a session of its own: a Ctrl-C in the terminal is ours to pass on.

    Parameters
    ----------
    module : str
        Module to run.
    arguments : Sequence[str]
        Its arguments.
    show : Callable[[str], None] | None
        Takes each line that it prints; None lets it print on our standard error.
    name : str
        What it is called in messages.

    """

    def __init__(self, module: str, arguments: Sequence[str], show: Printer | None = None,
                 name: str = '') -> None:
        """Start the process."""
        self.name = name or module
        self.killed = False
        self._process = subprocess.Popen(
            [sys.executable, '-m', module, *arguments],
            stdin=subprocess.DEVNULL, start_new_session=True,
            stdout=subprocess.PIPE if show else sys.stderr,
            stderr=subprocess.STDOUT if show else None,
            text=True, errors='replace', env={**os.environ, 'PYTHONUNBUFFERED': '1'})
        self._reader: threading.Thread | None = None
        if show:
            self._reader = threading.Thread(target=self._pass_on, args=(show,), daemon=True)
            self._reader.start()

    def _pass_on(self, show: Printer) -> None:
        assert self._process.stdout is not None  # opened as a pipe above
        for line in self._process.stdout:
            show(line.rstrip())

    @property
    def ended(self) -> bool:
        """Whether the process has ended."""
        return self._process.poll() is not None

    @property
    def code(self) -> int:
        """Exit code; 1 while it runs, or when it was killed or died of a signal."""
        found = self._process.poll()
        return 1 if self.killed or found is None or found < 0 else found

    def ask_to_stop(self) -> None:
        """Ask the process to come to rest and end."""
        if not self.ended:
            self._process.send_signal(signal.SIGINT)

    def end(self, within: float = STOP_WITHIN) -> int:
        """
        Wait for the end, and enforce it when it does not come.

        Parameters
        ----------
        within : float
            How long to wait [s].

        Returns
        -------
        int
            Exit code; 1 when it had to be killed.

        """
        try:
            self._process.wait(within)
        except subprocess.TimeoutExpired:
            self.killed = True
            self._process.kill()
            self._process.wait()
            print(f'cam_motion: {self.name} did not stop within {within:g} s and was killed',
                  file=sys.stderr)
        died_of = -(self._process.returncode or 0)
        if died_of > 0 and not self.killed:
            print(f'cam_motion: {self.name} was ended by signal {died_of} '
                  f'({signal.strsignal(died_of)})',
                  file=sys.stderr)
        if self._reader is not None:
            self._reader.join(1.0)
            if not self._reader.is_alive():  # a grandchild could hold the pipe open
                self._process.stdout.close()  # type: ignore[union-attr]
        return self.code


def node(name: str, arguments: Sequence[str], show: Printer | None = None) -> Child:
    """
    Start a node.

    Parameters
    ----------
    name : str
        Its executable.
    arguments : Sequence[str]
        Its arguments.
    show : Callable[[str], None] | None
        Takes each line that it prints; None lets it print on our standard error.

    Returns
    -------
    Child
        The process.

    """
    return Child('cam_motion.start', [name, *arguments], show, name)


def recorder(config: str, output: Path, storage: str, show: Printer | None = None) -> Child:
    """
    Start a recorder.

    Parameters
    ----------
    config : str
        Machine file.
    output : Path
        Directory of the bag; must not exist.
    storage : str
        ``mcap`` or ``sqlite3``.
    show : Callable[[str], None] | None
        Takes each line that it prints.

    Returns
    -------
    Child
        The process.

    """
    # JSON is YAML: so quoted, a directory named 007 stays a text
    return node('bag_recorder', [
        '--ros-args', '-r', '__node:=bag_recorder', '--params-file', config,
        '-p', f'output:={json.dumps(str(output))}', '-p', f'storage:={json.dumps(storage)}',
    ], show)


@contextmanager
def stop_signals() -> Iterator[threading.Event]:
    """
    Turn SIGINT, SIGTERM and SIGHUP into an event.

    Yields
    ------
    threading.Event
        Set when one has arrived; further ones change nothing.

    """
    asked = threading.Event()
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = {number: signal.signal(number, lambda *_: asked.set()) for number in numbers}
    try:
        yield asked
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
