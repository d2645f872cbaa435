# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The parameters of a drive's servo motor and of its control loop, as tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from cam_motion.io.cam_drive_parameters import part_table
from cam_motion.io.parameters import AUTOSTART, DRIVE_SIM, ParameterSpec, REQUIRED

SERVO = 'servo'
"""Mode of a drive that follows its axis as a servo motor under a control loop can."""


def _number(name: str, meaning: str, unit: str, default: Any = None, above: float | None = 0.0,
            least: float | None = None, most: float | None = None) -> ParameterSpec:
    return ParameterSpec(name, 'double', default, meaning, unit, above, least, most)


def _numbers(name: str, meaning: str, unit: str) -> ParameterSpec:
    return ParameterSpec(name, 'double_list', [], meaning, unit, least=0.0)


MOTOR = (
    _number('motor.inertia', 'Inertia of the rotor.', 'kg m²'),
    _number('motor.rated_rpm', 'Rated speed.', 'rpm'),
    _number('motor.max_rpm', 'Largest speed; above it the motor drives no more.', 'rpm'),
    _number('motor.rated_torque', 'Torque for good at rated speed.', 'N m'),
    _number('motor.standstill_torque', 'Torque for good at rest; the rated torque where left out.',
            'N m'),
    _number('motor.peak_torque', 'Largest torque.', 'N m'),
    _number('motor.corner_rpm', 'Speed up to which the peak torque is held, to fall linearly to '
            'the rated torque at the largest speed; the rated speed where left out.', 'rpm'),
    _numbers('motor.peak_curve_rpm', 'Instead of peak_torque and corner_rpm: speeds of points of '
             "the maker's curve, from 0 on.", 'rpm'),
    _numbers('motor.peak_curve_torque', 'Peak torques at these speeds.', 'N m'),
    _numbers('motor.continuous_curve_rpm', 'Instead of rated_torque and standstill_torque: speeds '
             "of points of the maker's curve, from 0 on.", 'rpm'),
    _numbers('motor.continuous_curve_torque', 'Torques for good at these speeds.', 'N m'),
    _number('motor.torque_constant', 'Torque per current, where the current is to be told.',
            'N m/A'),
)
"""The servo motor of a drive."""

LOOP = (
    _number('loop.bandwidth_hz', 'Crossover frequency f of the velocity loop, from which the '
            'gains follow where they are left out.', 'Hz', 50.0),
    _number('loop.position_gain', 'Gain of the position controller; 2πf/4 where left out.',
            '1/s'),
    _number('loop.velocity_gain', 'Gain of the velocity controller at the motor shaft; 2πf times '
            'all inertia where left out.', 'N m s/rad'),
    _number('loop.integral_time', 'Integral time of the velocity controller; 4/(2πf) where left '
            'out.', 's'),
    _number('loop.velocity_feed_forward', 'Share of the set velocity that is fed forward.', '',
            1.0, above=None, least=0.0, most=1.0),
    _number('loop.torque_feed_forward', 'Share of the torque of the set motion, inertia and '
            'resistance, that is fed forward.', '', 1.0, above=None, least=0.0, most=1.0),
    _number('loop.substep', 'Period of the loop and step of the integration, in whole '
            'nanoseconds.', 's', 0.00025, above=None, least=1e-5, most=0.01),
    _number('thermal_time', 'Time constant of the running means of torque and speed that are '
            'compared with the torque for good.', 's', 60.0),
    _number('max_catch_up', 'The most time that is integrated for one setpoint, when others are '
            'missing before it; more is dropped and counted.', 's', 0.05, above=None, least=0.001,
            most=10.0),
    _number('setpoint_timeout', 'After this long without a setpoint the drive brings its axis to '
            'rest.', 's', 0.2, most=60.0),
    _number('stop_time', 'How long coming to rest takes then.', 's', 0.2, above=None, least=0.001,
            most=60.0),
)
"""The control loop of a servo drive, and how it takes its setpoints."""

_MUST = ('motor.inertia', 'motor.rated_rpm', 'motor.max_rpm')


def _with_motor(spec: ParameterSpec) -> ParameterSpec:
    if spec.name == 'motor_inertia':
        return replace(spec, meaning='Inertia on the motor shaft, beside that of the rotor where '
                       'motor.inertia gives it.')
    return spec


_LOAD = ParameterSpec(
    'load', 'string_list', [], 'Names of further parts of the load, which the load shaft moves, '
    'as a cam shaft would, with the axis as its follower.')

FOLLOW_DRIVE = (*map(_with_motor, DRIVE_SIM[:-1]), _LOAD, *MOTOR, AUTOSTART)
"""Parameters of a drive that follows its axis exactly; the motor adds its limits to pictures."""

SERVO_DRIVE = (
    *(replace(spec, default='servo') if spec.name == 'mode' else spec
      for spec in FOLLOW_DRIVE[:-1] if not spec.name.startswith('motor.')),
    *(replace(spec, default=REQUIRED) if spec.name in _MUST else spec for spec in MOTOR),
    *LOOP, AUTOSTART)
"""Parameters of a drive that follows its axis as a servo motor under a control loop can."""


def follower_table(given: Mapping[str, Any]) -> tuple[ParameterSpec, ...]:
    """
    List the parameters of a drive that follows an axis with those of its parts.

    Parameters
    ----------
    given : Mapping[str, Any]
        What the drive has been given, by flat name.

    Returns
    -------
    tuple[ParameterSpec, ...]
        `SERVO_DRIVE` or `FOLLOW_DRIVE` by its mode, and below the names of parts what these have.

    """
    own = SERVO_DRIVE if given.get('mode') == SERVO else FOLLOW_DRIVE
    return (*own, *part_table(given))
