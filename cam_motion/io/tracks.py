# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Cam tracks as a configuration describes them, every problem at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
import math
import re
from typing import Any

from cam_motion.errors import Problem
from cam_motion.io.format_parameters import STAGED
from cam_motion.io.interface import INTERFACE
from cam_motion.io.parameters import check_values, ParameterSpec
from cam_motion.io.track_parameters import AXIS_TRACK, TRACK
from cam_motion.runtime.cam_switch import CamTrack, Direction
from cam_motion.units import DEGREE, TURN

SHAFT, POSITION = 'shaft', 'position'

_NAME = re.compile(r'[A-Za-z][A-Za-z0-9_]*')
_TAKEN = {'transition_event', *(spec.name for spec in STAGED), *(
    end.name.removeprefix('~/') for end in INTERFACE if end.name.startswith('~/'))}
_OVER_SHAFT = ('on_deg', 'off_deg', 'hysteresis_deg')
_OVER_POSITION = ('on_at', 'off_at', 'hysteresis', 'modulo')


@dataclass(frozen=True)
class TrackSettings:
    """
    A track of a node.

    Attributes
    ----------
    track : CamTrack
        When it is on.
    over_position : bool
        Whether over the position of the axis; else over the angle of the shaft.

    """

    track: CamTrack
    over_position: bool = False


def track_names(given: Mapping[str, Any]) -> list[str]:
    """
    Read the names of the tracks of a node.

    Parameters
    ----------
    given : Mapping[str, Any]
        What the node has been given, by flat name.

    Returns
    -------
    list[str]
        Those that can be names, each once; what else is wrong with the list its check says.

    """
    names = given.get('tracks')
    listed = names if isinstance(names, (list, tuple)) else []
    return list(dict.fromkeys(name for name in listed if isinstance(name, str)))


def track_table(given: Mapping[str, Any], of_axis: bool) -> tuple[ParameterSpec, ...]:
    """
    List the parameters of the tracks of a node.

    Parameters
    ----------
    given : Mapping[str, Any]
        What the node has been given, by flat name.
    of_axis : bool
        Whether the node is an axis, whose tracks can be over its position.

    Returns
    -------
    tuple[ParameterSpec, ...]
        The table, each name below that of its track.

    """
    return tuple(replace(spec, name=f'{track}.{spec.name}') for track in track_names(given)
                 for spec in (AXIS_TRACK if of_axis else TRACK))


def take_tracks(given: Mapping[str, Any], table: Iterable[ParameterSpec],
                others: Iterable[str] = (), of_axis: bool = False,
                ) -> tuple[dict[str, Any], dict[str, TrackSettings], list[Problem]]:
    """
    Build the tracks of a node.

    Parameters
    ----------
    given : Mapping[str, Any]
        What the node has been given, by flat name.
    table : Iterable[ParameterSpec]
        Its other parameters, whose names no track can have.
    others : Iterable[str]
        Further names that are taken, such as those of segments.
    of_axis : bool
        Whether the node is an axis, whose tracks can be over its position.

    Returns
    -------
    tuple[dict[str, Any], dict[str, TrackSettings], list[Problem]]
        What has been given beside the tracks, the tracks by name, and everything that is wrong.

    """
    rest = dict(given)
    taken = {*others, *(spec.name.partition('.')[0] for spec in table), *_TAKEN}
    tracks: dict[str, TrackSettings] = {}
    problems: list[Problem] = []
    for name in track_names(given):
        if name in taken or not _NAME.fullmatch(name) or list(given['tracks']).count(name) > 1:
            problems.append(Problem(
                'tracks', name, 'every track has a name of its own, of letters, digits and '
                'underscores, that is no parameter, segment, cam or topic of the node'))
            if name in taken:
                continue
        below = {key.partition('.')[2]: rest.pop(key) for key in given
                 if key.startswith(f'{name}.')}
        track, wrong = _build_track(below, of_axis)
        problems += [problem.below(name) for problem in wrong]
        if track is not None:
            tracks[name] = track
    return rest, tracks, problems


def _build_track(given: Mapping[str, Any], of_axis: bool,
                 ) -> tuple[TrackSettings | None, list[Problem]]:
    values, problems = check_values(AXIS_TRACK if of_axis else TRACK, given)
    over_position = values.get('source') == POSITION
    keys, unit = (_OVER_POSITION[:3], 1.0) if over_position else (_OVER_SHAFT, DEGREE)
    period = 360.0 if not over_position else values['modulo'] or math.inf
    other = SHAFT if over_position else POSITION
    problems += [  # a node is given the defaults as well, which say nothing
        Problem(key, values[key], f'goes with source: {other}',
                f'write source: {other}, or leave it out')
        for key in (_OVER_SHAFT if over_position else _OVER_POSITION) if values.get(key)]
    if not problems:
        problems = _window_problems(values, keys, period)
    if problems:
        return None, problems
    on, off, hysteresis = (values[key] for key in keys)
    return TrackSettings(CamTrack(
        on=[unit * x for x in on], off=[unit * x for x in off],
        period=period if over_position else TURN, duration=values['duration'],
        direction=Direction(values['direction']),
        on_compensation=values['on_compensation'], off_compensation=values['off_compensation'],
        hysteresis=unit * hysteresis), over_position), []


def _window_problems(values: Mapping[str, Any], keys: tuple[str, ...], period: float,
                     ) -> list[Problem]:
    """Check that the windows are windows, and apart from each other by more than hysteresis."""
    on_key, off_key, hysteresis_key = keys
    on, off, hysteresis = (values[key] for key in keys)
    problems = []
    if not on:
        problems.append(Problem(on_key, on, 'a track needs at least one place to switch on'))
    cyclic = not math.isinf(period)
    if cyclic:
        problems += [
            Problem(key, x, f'must lie from 0 to {period:g}') for key, places in (
                (on_key, on), (off_key, off)) for x in places if not 0.0 <= x <= period]
    if values['duration'] is not None:
        if off:
            problems.append(Problem(
                off_key, off, 'a track that is on for a duration has no place to switch off',
                'leave one of the two out'))
        if values['off_compensation']:
            problems.append(Problem(
                'off_compensation', values['off_compensation'],
                'a track that is on for a duration is switched off by that alone',
                'take it into the duration'))
        windows = [(x, x) for x in on]
    else:
        if len(off) != len(on):
            problems.append(Problem(
                off_key, off, f'needs as many places as {on_key}, {len(on)}',
                'or give a duration'))
        windows = list(zip(on, off))
        problems += [
            Problem(off_key, last, f'must lie behind its place in {on_key}, {first:g}')
            for first, last in windows if last == first or (
                last < first and (not cyclic or last + period == first))]
    if problems:
        return problems
    windows = sorted((first, last if last >= first else last + period)
                     for first, last in windows)
    ends = [*windows, (windows[0][0] + period, math.inf)]
    for (first, last), (following, _) in zip(windows, ends[1:]):
        if last > following or first == following:
            problems.append(Problem(
                on_key, following if following < period else following - period,
                f'lies in the window from {first:g} to {last:g}',
                'join the two, or make a second track'))
        elif hysteresis > min(following - last if last < following else math.inf,
                              last - first if last > first else math.inf):
            problems.append(Problem(
                hysteresis_key, hysteresis, 'must be less than every window and every gap '
                f'between them, as behind {first:g}', 'smaller'))
    return problems
