# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""One run of a line: its processes, in the order in which they begin and end."""

from __future__ import annotations

import argparse
from pathlib import Path
from threading import Event
from time import monotonic, sleep
from typing import Any

from cam_motion.cli.child import Child, node, recorder, START_WITHIN, STOP_WITHIN
from cam_motion.cli.live import Display, REFRESH
from cam_motion.cli.overload import overloads
from cam_motion.cli.watch import LineWatch, Snapshot
from cam_motion.errors import CamMotionError
from cam_motion.io.machine import Machine
import yaml

# How long the shaft may be kept waiting until the bag receives every stream [s].
_HEARD_WITHIN = 10.0
# Between the end of the line and that of the recorder: what is on its way arrives [s].
_SETTLE = 0.3


class Session:
    """
    One run of a line.

    Parameters
    ----------
    arguments : argparse.Namespace
        Those of the verb ``line``.
    machine : Machine
        The machine, at the speed at which it is to run.
    watch : LineWatch
        Looks at it.
    display : Display
        Shows it.
    asked : Event
        Set when the run is to end.

    """

    def __init__(self, arguments: argparse.Namespace, machine: Machine, watch: LineWatch,
                 display: Display, asked: Event) -> None:
        """Begin with nothing running."""
        self._arguments = arguments
        self._machine = machine
        self._watch = watch
        self._display = display
        self._asked = asked
        self._recorder: Child | None = None
        self._line: Child | None = None
        self._seen = Snapshot()
        self._began = monotonic()

    def begin(self) -> None:
        """
        Start the recorder, then the line, and its shaft when the bag receives every stream.

        Raises
        ------
        CamMotionError
            When the recorder does not begin, or the shaft refuses to run.

        """
        given = self._arguments
        if given.record is not None:
            self._recorder = recorder(
                given.config, given.record, given.storage, self._display.printer)
            self._await_recorder(self._recorder)
        if self._asked.is_set():
            return
        master = self._machine.master
        arguments = ['--ros-args', '--params-file', given.config]
        if given.speed_cpm is not None:
            arguments += ['-p', f'{master.name}:speed_cpm:={given.speed_cpm!r}']
        held_back = self._recorder is not None and master.values['run_at_start']
        if held_back:
            arguments += ['-p', f'{master.name}:run_at_start:=false']
        self._line = node('line', arguments, self._display.printer)
        if held_back:
            self._await_bag(self._line, given.record)
            if not (self._asked.is_set() or self._line.ended):
                self._watch.run_shaft()

    def _await_recorder(self, child: Child) -> None:
        deadline = monotonic() + START_WITHIN
        while self._watch.recorder_state != 'recording':
            if child.ended:
                raise CamMotionError(f'the recorder ended with exit code {child.code} before it '
                                     'began to record')
            if monotonic() > deadline:
                raise CamMotionError(
                    f'the recorder has not begun to record within {START_WITHIN:g} s')
            if self._asked.wait(0.05):
                return

    def _await_bag(self, line: Child, bag: Path) -> None:
        """Wait until every stream reaches the bag: discovery takes its time on a busy machine."""
        machine = self._machine
        wanted = {
            'shaft', *(f'{axis}/setpoint' for axis in machine.diagram.axes),
            *(f'{drive}/drive_state' for drive in machine.drive_names),
            *(f'{linkage}/joint_states' for linkage in machine.linkages),
        }
        deadline = monotonic() + START_WITHIN
        while not (line.ended or self._recorder_lost() or monotonic() > deadline):
            heard = _recorded_topics(bag)
            if wanted <= heard:
                return
            if 'shaft' in heard:
                # whatever is still missing will not come: the report will say so
                deadline = min(deadline, monotonic() + _HEARD_WITHIN)
            self._look('waiting for the recorder')
            if self._asked.wait(REFRESH):
                return

    def go_on(self) -> None:
        """Watch until the time is over, a signal comes, or a process ends."""
        if self._line is None:
            return
        self._began = monotonic()
        limit = self._arguments.seconds
        end = None if limit is None else self._began + START_WITHIN + limit
        heard = False
        while not (self._asked.is_set() or self._line.ended or self._recorder_lost()):
            self._look()
            if not heard and self._seen.time is not None:
                heard, self._began = True, monotonic()
                end = None if limit is None else self._began + limit
            wait = REFRESH if end is None else min(REFRESH, end - monotonic())
            if wait <= 0.0:
                return
            self._asked.wait(wait)

    def _recorder_lost(self) -> bool:
        return self._recorder is not None and self._recorder.ended

    def _look(self, note: str = '') -> None:
        self._seen = self._watch.look()
        self._display.show(self._seen, note)

    def end(self) -> int:
        """Stop the line, then the recorder, so that the last hold setpoints are in the bag."""
        self._lasted = monotonic() - self._began
        lost = self._recorder_lost()
        code = 0
        if self._line is not None:
            code = self._stop(self._line)
        if self._recorder is not None:
            sleep(0.0 if lost else _SETTLE)
            ended = self._stop(self._recorder)
            code = code or ended or int(lost)
        return code

    def _stop(self, child: Child) -> int:
        child.ask_to_stop()
        deadline = monotonic() + STOP_WITHIN
        while not child.ended and monotonic() < deadline:
            self._look('stopping')
            sleep(0.05)
        return child.end(max(0.0, deadline - monotonic()))

    @property
    def overloads(self) -> dict[str, str]:
        """Say which drives have come to a limit, and to which, by name."""
        return overloads(self._machine, self._seen)

    def summary(self, code: int) -> dict[str, Any]:
        """Give what the run came to, as plain data."""
        seen = self._seen

        def counted(key: str) -> int | None:
            text = seen.health.get(key, '')
            return int(text) if text.isdecimal() else None

        return {
            'exit_code': code,
            'seconds': round(self._lasted, 3),
            'bag': None if self._arguments.record is None else str(self._arguments.record),
            'shaft': {'time_s': seen.time, 'cycles': seen.cycles, 'angle_deg': seen.angle_deg},
            # as last reported by the master shaft, once a second
            'ticks': counted('ticks'),
            'missed_ticks': counted('missed_ticks'),
            'late_ticks': counted('late_ticks'),
            'overloads': self.overloads,
        }


def _recorded_topics(bag: Path) -> set[str]:
    """Read which topics have messages in a bag that is being written, without leading slashes."""
    try:
        text = (bag / 'metadata.yaml').read_text(encoding='utf-8')
        topics = yaml.safe_load(text)['rosbag2_bagfile_information']['topics_with_message_count']
        return {
            topic['topic_metadata']['name'].lstrip('/') for topic in topics
            if topic['message_count'] > 0
        }
    except (OSError, yaml.YAMLError, LookupError, TypeError):
        return set()  # not there yet
