# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The entries of a catalogue: what each kind holds, how it is checked, what it becomes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
import math
from typing import Any

from cam_motion.drive.gearbox import Gearbox
from cam_motion.drive.servo_motor import ServoMotor, TorqueLimit
from cam_motion.drive.sizing import GearboxChoice
from cam_motion.drive.sizing_forward import MotorChoice
from cam_motion.drive.sizing_inverse import ServoChoice
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.induction_motor import induction_motor
from cam_motion.io.parameters import check_values, ParameterSpec, REQUIRED
from cam_motion.units import RPM

Values = dict[str, Any]


def _number(name: str, meaning: str, unit: str = '', default: Any = REQUIRED,
            above: float | None = 0.0, least: float | None = None, most: float | None = None,
            ) -> ParameterSpec:
    return ParameterSpec(name, 'double', default, meaning, unit, above, least, most)


def _numbers(name: str, meaning: str, unit: str = '', default: Any = None,
             above: float | None = 0.0, least: float | None = None) -> ParameterSpec:
    return ParameterSpec(name, 'double_list', default, meaning, unit, above, least)


_SOURCE = ParameterSpec('source', 'string', REQUIRED,
                        'Key below sources: of the publication that prints the figures.')
_COMMON = (
    _SOURCE,
    _number('rated_kw', 'Rated power; from rated torque and speed where left out.', 'kW', None),
    _number('rated_rpm', 'Rated speed.', 'rpm'),
    _number('rated_torque', 'Torque for good, at rated speed.', 'N m'),
    _number('inertia', 'Inertia of the rotor.', 'kg m²'),
    _number('mass', 'Mass.', 'kg', None),
)

ENTRIES: dict[str, tuple[ParameterSpec, ...]] = {
    'induction_motors': (
        *_COMMON,
        _number('synchronous_rpm', 'Speed at zero slip.', 'rpm'),
        _number('breakdown_torque', 'Largest torque.', 'N m'),
        _number('starting_torque', 'Torque at rest, to which the curve is bent; that of the curve '
                'where left out.', 'N m', None),
        _number('breakdown_slip', 'Slip at breakdown.', '', None, most=1.0),
        _number('a', "Constant of document 004's torque curve.", '', None),
        _number('b', "Constant of document 004's torque curve.", '', None, above=None),
    ),
    'servo_motors': (
        *_COMMON,
        _number('standstill_torque', 'Torque for good, at rest; rated_torque where left out.',
                'N m', None),
        _number('peak_torque', 'Largest torque.', 'N m'),
        _number('corner_rpm', 'Speed up to which the peak torque is held; rated_rpm where left '
                'out.', 'rpm', None),
        _number('max_rpm', 'Largest speed.', 'rpm'),
        _number('torque_constant', 'Torque per current.', 'N m/A', None),
    ),
    'gearboxes': (
        _SOURCE,
        _numbers('ratios', 'Turns of the motor per turn of the load shaft.', '', REQUIRED),
        _number('efficiency', 'Share of the power that passes.', most=1.0),
        _numbers('inertia', 'Inertia on the motor shaft.', 'kg m²', above=None, least=0.0),
        _numbers('rated_torque', 'Torque at the output for good.', 'N m'),
        _numbers('peak_torque', 'Torque at the output for a moment.', 'N m'),
        _number('peak_cycles_per_hour', 'How often an hour the peak torque may come.', '1/h',
                None),
        _numbers('rated_rpm', 'Speed of the motor shaft for good.', 'rpm'),
        _numbers('max_rpm', 'Largest speed of the motor shaft.', 'rpm'),
    ),
}
"""What an entry of each section holds."""

_PER_RATIO = ('inertia', 'rated_torque', 'peak_torque', 'rated_rpm', 'max_rpm')
_CURVES = ('peak_curve', 'continuous_curve')


def make_entry(section: str, name: str, given: Any, sources: Mapping[str, str]) -> Any:
    """
    Check one entry and make what it describes.

    Parameters
    ----------
    section : str
        A key of `ENTRIES`.
    name : str
        Name of the entry.
    given : Any
        What the file holds there.
    sources : Mapping[str, str]
        The publications of the file, as text, by key.

    Returns
    -------
    MotorChoice | ServoChoice | list[GearboxChoice]
        The motor; or the gearbox, once per ratio.

    Raises
    ------
    ConfigurationError
        With every problem, paths relative to the entry.

    """
    return _MAKERS[section](name, _checked(section, given, sources))


def _checked(section: str, given: Any, sources: Mapping[str, str]) -> Values:
    """Check one entry; its source becomes that source's text."""
    if not isinstance(given, Mapping):
        raise ConfigurationError([Problem('', given, 'must hold figures by name')])
    curves = {name: given[name] for name in _CURVES if name in given}
    plain = {str(name): value for name, value in given.items() if name not in curves}
    problems: list[Problem] = []
    if section == 'gearboxes':
        ratios = plain.get('ratios')
        count = len(ratios) if isinstance(ratios, list) else 1
        if not count:
            problems.append(Problem('ratios', ratios, 'a gearbox needs at least one ratio'))
        for name in _PER_RATIO if count else ():
            value = plain.get(name)
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                plain[name] = [value] * count
            elif isinstance(value, list) and len(value) != count:
                problems.append(Problem(name, value, 'must be one figure, or one per ratio: '
                                        f'there are {count} ratios'))
    values, wrong = check_values(ENTRIES[section], plain)
    problems += wrong
    if curves and section != 'servo_motors':
        problems += [Problem(name, '', 'only servo motors have curves') for name in curves]
    source = values['source']
    if source is not None and source not in sources:
        problems.append(Problem('source', source, 'must be a key below sources:',
                                'known are: ' + ', '.join(sources)))
    if problems:
        raise ConfigurationError(problems)
    return {**values, 'source': sources[source], **curves}


def _power(values: Values) -> float:
    """Give the rated power [W]."""
    if values['rated_kw'] is not None:
        return 1e3 * float(values['rated_kw'])
    return float(values['rated_torque'] * values['rated_rpm'] * RPM)


def _motor(name: str, values: Values) -> MotorChoice:
    return MotorChoice(name, induction_motor(values), _power(values), values['rated_torque'],
                       values['rated_rpm'] * RPM, values['source'])


def _servo(name: str, values: Values) -> ServoChoice:
    power, source = _power(values), values['source']
    top, rated = values['max_rpm'] * RPM, values['rated_rpm'] * RPM
    if any(curve in values for curve in _CURVES):
        peak, continuous = (_curve(curve, values.get(curve)) for curve in _CURVES)
        motor = ServoMotor(peak, continuous, values['inertia'], top, rated,
                           values['torque_constant'])
        return ServoChoice(name, motor, power, source)
    at_rest, corner = values['standstill_torque'], values['corner_rpm']
    motor = ServoMotor.from_plate(
        standstill_torque=values['rated_torque'] if at_rest is None else at_rest,
        rated_torque=values['rated_torque'], rated_speed=rated,
        peak_torque=values['peak_torque'], max_speed=top, inertia=values['inertia'],
        corner_speed=None if corner is None else corner * RPM,
        torque_constant=values['torque_constant'])
    return ServoChoice(name, motor, power, source)


def _curve(name: str, points: Any) -> TorqueLimit:
    numbers = isinstance(points, list) and all(
        isinstance(point, list) and len(point) == 2 and all(
            isinstance(x, (int, float)) and not isinstance(x, bool) for x in point)
        for point in points)
    if not numbers or not points:
        raise ConfigurationError([Problem(
            name, points, 'must be a list of points [rpm, N m]',
            'give peak_curve and continuous_curve both')])
    try:
        return TorqueLimit(*zip(*((rpm * RPM, torque) for rpm, torque in points)))
    except ConfigurationError as error:
        raise ConfigurationError(problem.below(name) for problem in error.problems) from error


def _gearbox(name: str, values: Values) -> list[GearboxChoice]:
    count = len(values['ratios'])
    inertia, rated, peak, rated_rpm, max_rpm = (
        [None] * count if values[key] is None else values[key] for key in _PER_RATIO)
    often = values['peak_cycles_per_hour']
    return [
        GearboxChoice(
            name, Gearbox(ratio, values['efficiency'], (inertia[k] or 0.0) * ratio * ratio),
            _known(rated[k]), _known(peak[k]), math.inf if often is None else often / 3600.0,
            _known(rated_rpm[k]) * RPM, _known(max_rpm[k]) * RPM, values['source'])
        for k, ratio in enumerate(values['ratios'])
    ]


def _known(value: float | None) -> float:
    return math.inf if value is None else value


_MAKERS: dict[str, Callable[[str, Values], Any]] = {
    'induction_motors': _motor, 'servo_motors': _servo, 'gearboxes': _gearbox}
