# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Why document 004's definitions and the motion itself give different figures, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

_WINDOWED = {
    'fluctuation_pct': 'fluctuation', 'stability_pct': 'stability',
    'running_cost_pct': 'running cost'}
_SEEN = 1e-3  # [%]: smaller differences do not show
_SAME = 1e-3  # share of a force or a time that counts as a difference
_DURATION = 3.0  # of the document's simulation [s]


def why_they_differ(result: Mapping[str, Any]) -> str:
    """
    Say of every figure of a cam drive that has two values why it has.

    Parameters
    ----------
    result : Mapping[str, Any]
        The results of the drive, with the metrics of the document.

    Returns
    -------
    str
        A few sentences.

    """
    said = [*_window(result), *_contact(result), *_times(result)]
    if not said:
        return 'Both sets of definitions agree here.'
    return ' '.join(["The document's definitions and the motion itself differ.",
                     *(text[0].upper() + text[1:] for text in said)])


def _window(result: Mapping[str, Any]) -> Iterator[str]:
    """Explain what the document reads off its window, from one third of its time on."""
    orbit, document = result['orbit'], result['document']
    names = [name for name in _WINDOWED if abs(document[name] - orbit[name]) > _SEEN]
    if not names:
        return
    theirs = _listed(f'the {_WINDOWED[name]} {document[name]:.3f} %' for name in names)
    ours = _listed(f'{orbit[name]:.3f} %' for name in names)
    one = len(names) == 1
    driven = orbit['drawn_work_per_cycle'] > orbit['motor_work_per_cycle'] * (1.0 + 1e-9)
    losses = (', by a scheme that multiplies by the efficiency also where the load drives the '
              'motor' if driven else '')
    yield (f'{theirs} {"is" if one else "are"} read from one third of the time on, which still '
           f'holds the end of the start-up{losses}; the periodic motion has {ours}.')


def _contact(result: Mapping[str, Any]) -> Iterator[str]:
    force, least = (result[part]['min_contact_force'] for part in ('document', 'orbit'))
    start = result['start_up']['min_contact_force']
    if abs(force - least) <= _SAME * abs(least):
        return
    if start < least and abs(force - start) < abs(force - least):
        yield (f'the least contact force {force:.1f} N belongs to the start-up; in periodic '
               f'motion it is {least:.1f} N.')
    else:
        yield (f'the least contact force is {force:.1f} N in the steps of the document, '
               f'{start:.1f} N in the start-up and {least:.1f} N in periodic motion.')


def _times(result: Mapping[str, Any]) -> Iterator[str]:
    start, theirs = result['start_up'], result['document']['steady_state_time_s']
    first, settled, followed = (
        start[name] for name in ('first_crossing_s', 'settled_s', 'followed_s'))
    if first is None:
        yield f'the nominal speed is not reached within {followed:.4g} s.'
    elif theirs is None:
        yield (f'the nominal speed is first reached at {first:.4f} s, when the {_DURATION:g} s '
               'of the document are over.')
    elif abs(theirs - first) > _SAME * first:
        yield (f'the nominal speed is first reached at {first:.4f} s, in the steps of the '
               f'document at {theirs:.4f} s.')
    if settled is None:
        yield f'the drive has not settled within {followed:.4g} s.'
    elif first is not None and settled > first:
        yield (f'the nominal speed is first reached at {first:.4f} s, but lost again until '
               f'{settled:.4f} s.')
    elif first is not None and settled < first and theirs is None:
        yield f'the drive has settled at {settled:.4f} s.'


def _listed(texts: Iterator[str]) -> str:
    *most, last = texts
    return f'{", ".join(most)} and {last}' if most else last
