# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A drive's servo motor and control loop as a configuration describes them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
import math
from typing import Any

from cam_motion.drive.inverse import FollowerDrive
from cam_motion.drive.servo_axis import ServoAxis
from cam_motion.drive.servo_loop import ServoLoop
from cam_motion.drive.servo_motor import ServoMotor, TorqueLimit
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.units import RPM, TURN

_NANOSECONDS = 1e9
_NEEDED = ('inertia', 'rated_rpm', 'max_rpm')
_PLATE = ('rated_torque', 'peak_torque', 'standstill_torque', 'corner_rpm')
_CURVES = ('peak_curve_rpm', 'peak_curve_torque', 'continuous_curve_rpm',
           'continuous_curve_torque')
# What a configuration calls the figures of the core, without and with points of the curves.
_PATHS = (
    {'continuous.torques': 'rated_torque', 'peak.torques': 'peak_torque'},
    {'continuous.torques': 'continuous_curve_torque', 'peak.torques': 'peak_curve_torque'})


@dataclass(frozen=True)
class ServoSettings:
    """
    How a servo drive follows its setpoints.

    Attributes
    ----------
    motor : ServoMotor
        The motor.
    loop : ServoLoop
        The gains.
    substep_ns, max_catch_up_ns, stop_time_ns : int
        Period of the loop, the most time integrated at once, and the time of coming to rest
        when no setpoints come [ns].
    setpoint_timeout, thermal_time : float
        After how long that is, and the time constant of the running means [s].

    """

    motor: ServoMotor
    loop: ServoLoop
    substep_ns: int
    max_catch_up_ns: int
    stop_time_ns: int
    setpoint_timeout: float
    thermal_time: float

    def axis(self, drive: FollowerDrive) -> ServoAxis:
        """
        Put the drive together.

        Parameters
        ----------
        drive : FollowerDrive
            Gearbox and load.

        Returns
        -------
        ServoAxis
            At rest.

        """
        return ServoAxis(drive, self.motor, self.loop, self.substep_ns, self.thermal_time)


def build_motor(values: Mapping[str, Any]) -> ServoMotor | None:
    """
    Make the motor of a drive.

    Parameters
    ----------
    values : Mapping[str, Any]
        All parameters of the drive, checked one by one.

    Returns
    -------
    ServoMotor | None
        The motor; None where none is given.

    Raises
    ------
    ConfigurationError
        With every problem, paths relative to the drive.

    """
    given = {name.removeprefix('motor.'): value for name, value in values.items()
             if name.startswith('motor.') and value not in (None, [])}
    if not given:
        return None
    curved = any(name in given for name in _CURVES)
    needed = _NEEDED + (_CURVES if curved else _PLATE[:2])
    problems = [
        Problem(name, None, 'a motor needs this figure',
                'or points of its curves: ' + ', '.join(_CURVES) if name in _PLATE else '')
        for name in needed if name not in given]
    problems += [
        Problem(name, given[name], 'the points of the curves stand in its place',
                'leave this figure out, or the points')
        for name in _PLATE if curved and name in given]
    problems += [
        Problem(name, given[name], f'must be at most max_rpm, {given["max_rpm"]:g}')
        for name in ('rated_rpm', 'corner_rpm')
        if given.get(name, 0.0) > given.get('max_rpm', math.inf)]
    if not problems:
        try:
            return _from_curves(given) if curved else _from_plate(given)
        except ConfigurationError as error:
            problems += [replace(problem, path=_PATHS[curved].get(problem.path, problem.path))
                         for problem in error.problems]
    raise ConfigurationError(problem.below('motor') for problem in problems)


def _from_plate(given: Mapping[str, Any]) -> ServoMotor:
    corner = given.get('corner_rpm')
    return ServoMotor.from_plate(
        standstill_torque=given.get('standstill_torque', given['rated_torque']),
        rated_torque=given['rated_torque'], rated_speed=given['rated_rpm'] * RPM,
        peak_torque=given['peak_torque'], max_speed=given['max_rpm'] * RPM,
        inertia=given['inertia'], corner_speed=None if corner is None else corner * RPM,
        torque_constant=given.get('torque_constant'))


def _from_curves(given: Mapping[str, Any]) -> ServoMotor:
    curves, problems = [], []
    for kind in ('peak', 'continuous'):
        try:
            curves.append(TorqueLimit(
                tuple(rpm * RPM for rpm in given[f'{kind}_curve_rpm']),
                tuple(given[f'{kind}_curve_torque'])))
        except ConfigurationError as error:
            for problem in error.problems:
                name = f'{kind}_curve_{"rpm" if problem.path == "speeds" else "torque"}'
                problems.append(Problem(name, given[name], problem.rule))
    if problems:
        raise ConfigurationError(problems)
    return ServoMotor(
        curves[0], curves[1], given['inertia'], given['max_rpm'] * RPM, given['rated_rpm'] * RPM,
        given.get('torque_constant'))


def build_servo(values: Mapping[str, Any], drive: FollowerDrive, motor: ServoMotor,
                ) -> ServoSettings:
    """
    Make the control loop of a servo drive.

    Parameters
    ----------
    values : Mapping[str, Any]
        All parameters of the drive, checked one by one.
    drive : FollowerDrive
        Gearbox and load, all inertia on the motor shaft included.
    motor : ServoMotor
        The motor.

    Returns
    -------
    ServoSettings
        The settings.

    Raises
    ------
    ConfigurationError
        With every problem, paths relative to the drive.

    """
    inertia = drive.motor_inertia + drive.law(0.0).inertia / drive.gear_ratio ** 2
    if not math.isfinite(inertia):
        raise ConfigurationError([Problem(
            'load', None, 'the gains follow from the inertia at position 0, where it is not '
            'defined', 'keep the slider within the arm of its lever there')])
    loop = ServoLoop.for_bandwidth(
        values['loop.bandwidth_hz'] * TURN, inertia,
        **{name: values[f'loop.{name}'] for name in (
            'position_gain', 'velocity_gain', 'integral_time', 'velocity_feed_forward',
            'torque_feed_forward')})
    substep, most, stop = (
        round(values[name] * _NANOSECONDS)
        for name in ('loop.substep', 'max_catch_up', 'stop_time'))
    settings = ServoSettings(
        motor, loop, substep, most, stop, values['setpoint_timeout'], values['thermal_time'])
    try:
        settings.axis(drive)
    except ConfigurationError as error:
        raise ConfigurationError(problem.below('loop') for problem in error.problems) from error
    return settings
