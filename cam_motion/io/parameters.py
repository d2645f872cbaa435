# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
The parameters of every node as one table.

The table drives the declaration of ROS parameters and their descriptors, the validation (the
same offline and in the nodes), and the tables in README.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
import sys
from typing import Any

from cam_motion.errors import Problem

_KINDS: dict[str, tuple[type, ...]] = {
    'double': (float, int), 'integer': (int,), 'bool': (bool,), 'string': (str,),
}
_LARGEST = sys.float_info.max  # comparing, unlike isfinite, bears whole numbers of any length
REQUIRED = object()
"""Default of a parameter that must be given."""


@dataclass(frozen=True)
class ParameterSpec:
    """
    One parameter: its type, default, unit, range and meaning.

    Attributes
    ----------
    name : str
        Name; dots separate levels.
    kind : str
        ``double``, ``integer``, ``bool``, ``string`` or one of these with ``_list`` behind.
    default : Any
        Value when left out; `REQUIRED` when it must be given, None when it may be absent.
    meaning : str
        One sentence.
    unit : str
        Unit of the value; empty where it has none.
    above, least, most : float | None
        Exclusive lower, inclusive lower and inclusive upper bound.
    choices : tuple[str, ...]
        Allowed values of a string, all if empty.

    """

    name: str
    kind: str
    default: Any
    meaning: str
    unit: str = ''
    above: float | None = None
    least: float | None = None
    most: float | None = None
    choices: tuple[str, ...] = ()

    @property
    def rule(self) -> str:
        """Say in words what is allowed."""
        nouns = {'double': 'a finite number', 'integer': 'a whole number', 'bool': 'true or false',
                 'string': 'a text'}
        base = self.kind.removesuffix('_list')
        text = f'must be {nouns[base]}'
        if self.kind.endswith('_list'):
            text = f'must be a list, each item {nouns[base]}'
        if self.choices:
            text = 'must be one of ' + ', '.join(self.choices)
        bounds = [f'{word} {value:g}' for word, value in (
            ('above', self.above), ('at least', self.least), ('at most', self.most),
        ) if value is not None]
        if bounds:
            text += ', ' + ' and '.join(bounds)
        return text + (f' [{self.unit}]' if self.unit else '')

    def check(self, value: Any) -> Problem | None:
        """
        Check one given value.

        Parameters
        ----------
        value : Any
            The value; never None.

        Returns
        -------
        Problem | None
            What is wrong with it, or None.

        """
        items = [value]
        if self.kind.endswith('_list'):
            if isinstance(value, (str, Mapping)) or not isinstance(value, Sequence):
                return Problem(self.name, value, self.rule, f'write [{value}]')
            items = list(value)
        if all(self._fits(item) for item in items):
            return None
        return Problem(self.name, value, self.rule, self._hint())

    def _fits(self, item: Any) -> bool:
        base = self.kind.removesuffix('_list')
        kinds: Any = _KINDS[base]  # keeps the checker from narrowing the item to object
        if not isinstance(item, kinds) or (base != 'bool' and isinstance(item, bool)):
            return False
        if self.choices and item not in self.choices:
            return False
        if base not in ('double', 'integer'):
            return True
        return (
            abs(item) <= _LARGEST
            and (self.above is None or item > self.above)
            and (self.least is None or item >= self.least)
            and (self.most is None or item <= self.most)
        )

    def _hint(self) -> str:
        if self.default in (None, REQUIRED) or self.default == []:
            return ''
        return f'the default is {self.default}'

    def cleaned(self, value: Any) -> Any:
        """
        Give the value in the parameter's own type.

        Parameters
        ----------
        value : Any
            A value that has passed `check`.

        Returns
        -------
        Any
            Whole numbers as floats where a double is meant, lists as lists.

        """
        if self.kind == 'double':
            return float(value)
        if self.kind == 'double_list':
            return [float(item) for item in value]
        return list(value) if self.kind.endswith('_list') else value


AUTOSTART = ParameterSpec(
    'autostart', 'bool', True, 'Whether the node configures and activates itself.')

TRACKS = ParameterSpec(
    'tracks', 'string_list', [],
    'Names of cam tracks, outputs that are on over a part of the cycle; each has a section below '
    'its name, and a topic ~/<name>.')

SHAFT_TICKS = (
    ParameterSpec('rate_hz', 'double', 500.0, 'Shaft points published per second.', 'Hz',
                  least=1.0, most=5000.0),
    ParameterSpec('run_at_start', 'bool', True, 'Whether the shaft starts to turn when active.'),
    ParameterSpec('start_delay', 'double', 0.5,
                  'How long the shaft stands before it starts on its own, so that all nodes '
                  'have found each other.', 's', least=0.0, most=60.0),
    ParameterSpec('max_catch_up', 'double', 0.05,
                  'How late a tick is still carried out; later ones count as missed.', 's',
                  least=0.0, most=10.0),
    ParameterSpec('joint_states_hz', 'double', 50.0,
                  'Rate of joint_states for viewers; 0 switches it off.', 'Hz',
                  least=0.0, most=1000.0),
    TRACKS,
)
"""What every node has that turns the shaft."""

MASTER_SHAFT = (
    ParameterSpec('speed_cpm', 'double', 60.0, 'Set speed; negative turns backwards.',
                  'cycles/min'),
    *SHAFT_TICKS,
    ParameterSpec('obey', 'string_list', [],
                  'Axes whose max_speed_cpm the shaft does not exceed; empty: all of the line.'),
    ParameterSpec('encoder.topic', 'string', '',
                  'Topic of an encoder (sensor_msgs/JointState) that the shaft follows; empty: '
                  'the shaft is virtual.'),
    ParameterSpec('encoder.joint', 'string', '', 'Name of its joint; empty: the first.'),
    ParameterSpec('encoder.ratio', 'double', 1.0, 'Turns of the shaft per turn of the encoder.'),
    ParameterSpec('encoder.offset_deg', 'double', 0.0,
                  'Angle of the shaft where the encoder is at zero.', 'deg'),
    ParameterSpec('encoder.wraps', 'bool', True,
                  'Whether the encoder starts over after each turn.'),
    ParameterSpec('encoder.bandwidth', 'double', 10.0,
                  'Bandwidth of the filter that finds speed and acceleration.', 'Hz',
                  above=0.0, most=1000.0),
    ParameterSpec('encoder.dead_time', 'double', 0.0,
                  'By how much the shaft is extrapolated, to make up for the way of the '
                  'measurement.', 's', least=0.0, most=1.0),
    ParameterSpec('encoder.timeout', 'double', 0.2,
                  'After this long without a measurement the shaft comes to rest.', 's',
                  above=0.0, most=60.0),
    ParameterSpec('acceleration', 'double', 30.0, 'Largest acceleration of speed ramps.',
                  'rad/s²', above=0.0),
    ParameterSpec('jerk', 'double', 300.0, 'Largest jerk of speed ramps.', 'rad/s³', above=0.0),
    ParameterSpec('quick_stop_acceleration', 'double', 150.0,
                  'Largest deceleration of the quick stop.', 'rad/s²', above=0.0),
    ParameterSpec('quick_stop_jerk', 'double', 3000.0, 'Largest jerk of the quick stop.',
                  'rad/s³', above=0.0),
    AUTOSTART,
)

DRIVE_SIM = (
    ParameterSpec('mode', 'string', 'follow',
                  'What the drive does: follow the setpoints of an axis exactly, follow them as '
                  'a servo drive can, or turn the shaft itself.',
                  choices=('follow', 'servo', 'line_shaft')),
    ParameterSpec('axis', 'string', REQUIRED, 'Name of the axis whose setpoints it follows.'),
    ParameterSpec('radius', 'double', 1.0,
                  'Travel of the axis per radian of the load shaft (roller radius); '
                  '1 for an axis in radians.', 'unit/rad', above=0.0),
    ParameterSpec('gear_ratio', 'double', 1.0,
                  'Turns of the motor per turn of the load shaft.', above=0.0),
    ParameterSpec('efficiency', 'double', 1.0, 'Efficiency of the gearbox.', above=0.0, most=1.0),
    ParameterSpec('motor_inertia', 'double', 0.0, 'Inertia on the motor shaft.', 'kg m²',
                  least=0.0),
    ParameterSpec('load_inertia', 'double', 0.0, 'Inertia on the load shaft.', 'kg m²',
                  least=0.0),
    ParameterSpec('resistance_force', 'double', 0.0,
                  'Force against the travel of the axis.', 'N', least=0.0),
    ParameterSpec('resistance', 'string', 'in_motion',
                  'Whether the resistance acts against the motion only, or always (a pull '
                  'against the positive direction, also in the dwell).',
                  choices=('in_motion', 'always')),
    AUTOSTART,
)

BAG_RECORDER = (
    ParameterSpec('output', 'string', 'cam_motion_bag', 'Directory of the bag; must not exist.'),
    ParameterSpec('storage', 'string', 'mcap', 'Storage of the bag.',
                  choices=('mcap', 'sqlite3')),
    ParameterSpec('topics', 'string_list', [],
                  'Topics to record; empty records every topic of the line.'),
    ParameterSpec('flush_interval', 'double', 0.5,
                  'Time after which a killed recorder has lost nothing older.', 's',
                  above=0.0, most=1.0),
    ParameterSpec('machine', 'string', '',
                  'Machine file to store in the bag; empty takes that of --params-file.'),
    AUTOSTART,
)

LINE = (
    ParameterSpec('master', 'string', 'master_shaft', 'Name of the master shaft.'),
    ParameterSpec('axes', 'string_list', [], 'Names of the axes.'),
    ParameterSpec('drives', 'string_list', [], 'Names of the drives.'),
    ParameterSpec('linkages', 'string_list', [], 'Names of the linkages that axes drive.'),
    ParameterSpec('interlocks', 'string_list', [],
                  'Names of the interlocks; what each of them is stands below its name.'),
    AUTOSTART,
)

_OF_EVERY_NODE = ('use_sim_time', 'start_type_description_service')


def is_of_every_node(name: str) -> bool:
    """
    Tell the parameters that ROS itself gives to every node.

    Parameters
    ----------
    name : str
        Name of a parameter.

    Returns
    -------
    bool
        Whether it is one of ROS' own.

    """
    return name in _OF_EVERY_NODE or name.startswith('qos_overrides.')


def check_values(
    table: Iterable[ParameterSpec], given: Mapping[str, Any]
) -> tuple[dict[str, Any], list[Problem]]:
    """
    Check given values against a table and fill in the defaults.

    Parameters
    ----------
    table : Iterable[ParameterSpec]
        The parameters allowed.
    given : Mapping[str, Any]
        Values by flat name.

    Returns
    -------
    tuple[dict[str, Any], list[Problem]]
        A usable value for every parameter (the default where something is wrong), and
        everything that is wrong, unknown names included.

    """
    specs = {spec.name: spec for spec in table}
    values: dict[str, Any] = {}
    problems: list[Problem] = []
    for name, spec in specs.items():
        default = None if spec.default is REQUIRED else spec.default
        value = given.get(name)
        problem = None
        if value is None:
            value = default
            if spec.default is REQUIRED:
                problem = Problem(name, None, spec.rule, spec.meaning.rstrip('.'))
        elif (problem := spec.check(value)) is not None:
            value = default
        values[name] = value if value is None else spec.cleaned(value)
        problems += [problem] if problem else []
    problems += [
        Problem(name, value, 'no such parameter here', _nearest(name, specs))
        for name, value in given.items() if name not in specs and not is_of_every_node(name)
    ]
    return values, problems


def _nearest(name: str, known: Iterable[str]) -> str:
    from difflib import get_close_matches
    close = get_close_matches(name, list(known), n=1)
    return f'did you mean {close[0]}?' if close else 'known are: ' + ', '.join(known)
