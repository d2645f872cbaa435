# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Running nodes as a process: start, spin, stop on a signal, exit codes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
import gc
import signal
import sys
import threading
import time

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.nodes.executor import make_executor
from cam_motion.nodes.managed_node import ManagedNode
import rclpy
from rclpy.duration import Duration
from rclpy.executors import Executor
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.signals import SignalHandlerOptions

EXIT_OK = 0
EXIT_BUG = 1
EXIT_CONFIGURATION = 2

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_STOP_WITHIN = 4.0  # launch sends SIGTERM 5 s after SIGINT
_DELIVER_WITHIN = 1.0
_SPIN = 0.1

Factory = Callable[[], Sequence[ManagedNode]]
"""Makes the nodes of a process; raises `ConfigurationError` when it cannot."""


def run(factory: Factory, argv: Sequence[str] | None = None) -> int:
    """
    Run nodes until the process is asked to stop.

    SIGINT and SIGTERM alike bring the machine to rest within a bounded time, publish the last
    hold setpoints and end the process. Further signals meanwhile change nothing.

    Parameters
    ----------
    factory : Callable[[], Sequence[ManagedNode]]
        Makes the nodes, in the order in which they are started; they stop in that order too.
    argv : Sequence[str], optional
        Command line; None takes that of the process.

    Returns
    -------
    int
        Exit code: 0 asked to stop, 1 a bug, 2 a bad configuration.

    """
    stop = threading.Event()
    for number in _SIGNALS:
        signal.signal(number, lambda *_: stop.set())
    try:
        return _run(factory, argv, stop)
    finally:
        # launch and impatient users send a second signal: it must not spoil the exit code
        for number in _SIGNALS:
            signal.signal(number, signal.SIG_IGN)


def _run(factory: Factory, argv: Sequence[str] | None, stop: threading.Event) -> int:
    try:
        rclpy.init(
            args=None if argv is None else list(argv),
            signal_handler_options=SignalHandlerOptions.NO)
        nodes = list(factory())
    except ConfigurationError as error:
        print_problems(error.problems)
        rclpy.try_shutdown()
        return EXIT_CONFIGURATION
    except Exception as error:  # noqa: B902 (rcl's own errors have no common base)
        if not _is_rcl_refusal(error):
            raise
        print_problems([Problem('--ros-args', None, str(error).split(', at ')[0])])
        rclpy.try_shutdown()
        return EXIT_CONFIGURATION
    executor = make_executor()
    try:
        for node in nodes:
            executor.add_node(node)
        code = start(nodes)
        if code == EXIT_OK:
            # what exists by now lives as long as the process: the collector need not visit it
            gc.collect()
            gc.freeze()
            _spin(executor, stop.is_set, nodes)
            bring_to_rest(executor, nodes)
        if any(node.failed for node in nodes):
            code = EXIT_BUG
        return code
    finally:
        executor.shutdown()
        for node in reversed(nodes):
            node.destroy_node()
        rclpy.try_shutdown()


def start(nodes: Sequence[ManagedNode]) -> int:
    """
    Configure and activate all nodes that are to start on their own.

    Parameters
    ----------
    nodes : Sequence[ManagedNode]
        The nodes; all are configured before the first one is activated.

    Returns
    -------
    int
        Exit code so far.

    """
    own = [node for node in nodes if node.get_parameter('autostart').value]
    results = [node.trigger_configure() for node in own]
    if count := sum(len(node.problems) for node in own):
        print(f'The configuration cannot be used: {_problems(count)}, listed above.',
              file=sys.stderr)
        return EXIT_CONFIGURATION
    if any(result is not TransitionCallbackReturn.SUCCESS for result in results):
        return EXIT_BUG
    # the master is activated last, so that every axis hears its first tick
    for node in reversed(own):
        if node.trigger_activate() is not TransitionCallbackReturn.SUCCESS:
            return EXIT_CONFIGURATION if node.problems else EXIT_BUG
    return EXIT_OK


def _spin(executor: Executor, done: Callable[[], bool], nodes: Sequence[ManagedNode]) -> None:
    """Spin in short turns; a transition that is not allowed now must not end the process."""
    while not done():
        try:
            executor.spin_once(timeout_sec=_SPIN)
        except Exception as error:  # noqa: B902 (rcl's own errors have no common base)
            if not _is_rcl_refusal(error):
                raise
            nodes[0].get_logger().error(str(error).split(', at ')[0])


def bring_to_rest(executor: Executor, nodes: Sequence[ManagedNode]) -> None:
    """
    Let all nodes come to rest, then deactivate them, which publishes their hold setpoints.

    Parameters
    ----------
    executor : Executor
        Spins meanwhile.
    nodes : Sequence[ManagedNode]
        The nodes.

    """
    for node in nodes:
        node.begin_stop()
    deadline = time.monotonic() + _STOP_WITHIN
    _spin(executor, lambda: time.monotonic() > deadline or all(n.stopped for n in nodes), nodes)
    for node in nodes:
        if node.active:
            node.trigger_deactivate()
    # what has been published last must have arrived before its publisher is gone
    deadline = time.monotonic() + _DELIVER_WITHIN
    for publisher in (publisher for node in nodes for publisher in node.publishers):
        left = deadline - time.monotonic()
        if left > 0.0:
            publisher.wait_for_all_acked(Duration(seconds=left))


def print_problems(problems: Sequence[Problem]) -> None:
    """
    Print problems for people, to the standard error.

    Parameters
    ----------
    problems : Sequence[Problem]
        What is wrong.

    """
    print(f'The configuration cannot be used, {_problems(len(problems))}:', file=sys.stderr)
    for problem in problems:
        print(f'  {problem}', file=sys.stderr)


def _problems(count: int) -> str:
    return f'{count} problem{"s" if count > 1 else ""}'


def _is_rcl_refusal(error: Exception) -> bool:
    return type(error).__module__.startswith('rclpy') or type(error).__name__.startswith('RCL')
