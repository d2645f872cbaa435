# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Sizing the drives of a machine from a catalogue: candidates, results, and both as data."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
import math
from typing import Any, NamedTuple

from cam_motion.drive.gearbox import Gearbox
from cam_motion.drive.motor import InductionMotor, KlossMotor
from cam_motion.drive.sizing import Candidate, GearboxChoice, OBJECTIVES, rank, Sizing
from cam_motion.drive.sizing_flywheel import smallest_flywheel, SmallestFlywheel
from cam_motion.drive.sizing_forward import (
    drive_of,
    MotorChoice,
    Pair,
    size_line_shaft,
    Wishes,
)
from cam_motion.drive.sizing_inverse import FollowerLoad, ServoChoice, size_follower
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.cam_drive_config import CamDriveSettings
from cam_motion.io.catalogue import Catalogue
from cam_motion.io.machine import DriveSettings, Machine
from cam_motion.io.plain import finite
from cam_motion.io.turn import turn_profile
import numpy as np

CONFIGURED = 'as configured'
"""Name of the motor and gearbox that the machine file describes."""

OTHER_RATIO = 'other ratio'
"""Name of that gearbox with another ratio than its own."""

INERTIA_RATIO = 10.0
"""Largest ratio of inertias if none is wished: a rule of thumb, as makers of servos give it."""

_SAME = 1e-6  # ratios that differ by this share only are the same, rounded
_BEYOND = 0.05  # ratios are tried from those for rated to those for synchronous speed, and beyond
_BETWEEN = 9  # of them
_DOWN_TO = 0.1  # of the largest ratio that the speed of a servo motor allows
_SPREAD = 12  # ratios from there up
_FLYWHEELS = (0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 3.0, 4.0)  # times the configured one
_WITHOUT = 10.0  # times the largest rotor, where no flywheel is configured

Tell = Callable[[str, int, int], None]


class Options(NamedTuple):
    """
    What is wanted of a sizing.

    The objective, a key of one of `OBJECTIVES`; ratios of gearboxes [-] and flywheels [kg m²]
    to be tried, none for a choice around what is configured; what cam drives have to keep; the
    largest ratio of inertias of the others [-].
    """

    objective: str = 'power'
    ratios: tuple[float, ...] = ()
    flywheels: tuple[float, ...] = ()
    wishes: Wishes = Wishes()
    inertia_ratio: float = INERTIA_RATIO


@dataclass(frozen=True)
class SizedDrive:
    """
    A drive and everything that was tried for it.

    Attributes
    ----------
    name : str
        The drive.
    sizing : Sizing
        The candidates.
    sources : dict[str, str]
        Where the figures of motors and gearboxes are from, by name.
    flywheel : SmallestFlywheel | None
        The smallest flywheel for the wanted fluctuation; None for a drive without one.
    flywheel_for : tuple[str, str, float] | None
        Motor, gearbox and ratio that it belongs to.

    """

    name: str
    sizing: Sizing
    sources: dict[str, str]
    flywheel: SmallestFlywheel | None = None
    flywheel_for: tuple[str, str, float] | None = None


def size(machine: Machine, catalogue: Catalogue, options: Options,
         names: Sequence[str] = (), executor: Executor | None = None,
         tell: Tell = lambda name, done, total: None) -> dict[str, SizedDrive]:
    """
    Size drives of a machine.

    Parameters
    ----------
    machine : Machine
        The machine; its axes turn at the set speed.
    catalogue : Catalogue
        Motors and gearboxes.
    options : Options
        What is wanted.
    names : Sequence[str]
        The drives; none takes all.
    executor : concurrent.futures.Executor, optional
        Shares the work between processes or hosts.
    tell : Callable[[str, int, int], None]
        Told the drive, and how many of how many candidates are done.

    Returns
    -------
    dict[str, SizedDrive]
        Results by drive.

    Raises
    ------
    ConfigurationError
        When a drive is not there, or the objective or the catalogue does not fit it.

    """
    every = {**machine.drives, **machine.cam_drives}
    chosen = list(names) or list(every)
    problems = [Problem('--drive', name, 'must be a drive of the machine',
                        'known are: ' + ', '.join(every)) for name in chosen if name not in every]
    for name in chosen:
        method = 'forward' if name in machine.cam_drives else 'inverse'
        if name in every and options.objective not in OBJECTIVES[method]:
            problems.append(Problem(
                '--objective', options.objective, f'must be an objective for {name}, which is '
                f'sized by {method} dynamics', 'known are: ' + ', '.join(OBJECTIVES[method])))
        kind = 'induction_motors' if method == 'forward' else 'servo_motors'
        if name in every and not (catalogue.motors if method == 'forward' else catalogue.servos):
            problems.append(Problem(
                kind, None, f'the catalogue holds none, and {name} needs one',
                'add some, or size the other drives with --drive'))
    if problems:
        raise ConfigurationError(problems)
    results = {}
    for name in chosen:
        def told(done: int, total: int, name: str = name) -> None:
            tell(name, done, total)
        if name in machine.cam_drives:
            results[name] = _size_cam_drive(
                machine.cam_drives[name], catalogue, options, executor, told)
        else:
            results[name] = _size_drive(
                machine, machine.drives[name], catalogue, options, told)
    return results


def _size_drive(machine: Machine, settings: DriveSettings, catalogue: Catalogue,
                options: Options, tell: Callable[[int, int], None]) -> SizedDrive:
    drive, motor = settings.drive, settings.motor
    # where the motor is known, what else is on its shaft stays there
    coupling = 0.0 if motor is None else drive.motor_inertia - motor.inertia
    profile = turn_profile(machine.diagram.axes[settings.axis], settings.name)
    load = FollowerLoad(drive, profile, machine.master.speed, coupling)
    own = Gearbox(drive.gear_ratio, drive.efficiency)
    servos = catalogue.servos if motor is None else (
        ServoChoice(CONFIGURED, motor, float(motor.continuous(motor.rated_speed))
                    * motor.rated_speed), *catalogue.servos)
    pairs: list[tuple[ServoChoice, GearboxChoice]] = []
    for servo in servos:
        largest = servo.motor.max_speed / load.peak_speed if load.peak_speed else own.ratio
        ratios = [own.ratio, *largest * np.geomspace(_DOWN_TO, 1.0, _SPREAD)]
        pairs += [(servo, box) for box in _gearboxes(catalogue, own, ratios, options.ratios)]
    candidates = size_follower(load, pairs, options.inertia_ratio, tell)
    return SizedDrive(settings.name, rank('inverse', options.objective, candidates),
                      _sources(pairs))


def _size_cam_drive(settings: CamDriveSettings, catalogue: Catalogue, options: Options,
                    executor: Executor | None, tell: Callable[[int, int], None]) -> SizedDrive:
    drive = settings.drive
    pairs: list[Pair] = []
    for choice in (*_own_motor(settings), *catalogue.motors):
        speeds = np.linspace((1.0 - _BEYOND) * choice.rated_speed,
                             (1.0 + _BEYOND) * choice.motor.synchronous_speed, _BETWEEN)
        ratios = [drive.gearbox.ratio, *speeds / drive.nominal_speed]
        pairs += [(choice, box) for box in
                  _gearboxes(catalogue, drive.gearbox, ratios, options.ratios)]
    base = drive.flywheel or _WITHOUT * max(one.motor.inertia for one in catalogue.motors)
    flywheels = options.flywheels or tuple(base * share for share in _FLYWHEELS)
    candidates = size_line_shaft(drive, pairs, flywheels, options.wishes, executor, tell)
    sizing = rank('forward', options.objective, candidates)
    pair = _for_flywheel(sizing, pairs)
    chosen = drive if pair is None else drive_of(drive, pair, drive.flywheel)
    return SizedDrive(
        settings.name, sizing, _sources(pairs),
        smallest_flywheel(chosen, options.wishes.fluctuation_pct),
        (CONFIGURED, CONFIGURED, drive.gearbox.ratio) if pair is None else
        (pair[0].name, pair[1].name, pair[1].gearbox.ratio))


def _own_motor(settings: CamDriveSettings) -> Iterator[MotorChoice]:
    """Give the motor of the machine file, unless it has no torque at its rated speed."""
    motor, speed = settings.drive.motor, settings.rated_speed
    torque = settings.values['motor.rated_torque'] or float(motor.torque(speed))
    if torque > 0.0 and isinstance(motor, InductionMotor | KlossMotor):
        yield MotorChoice(CONFIGURED, motor, torque * speed, torque, speed)


def _gearboxes(catalogue: Catalogue, own: Gearbox, ratios: Sequence[float],
               wanted: Sequence[float]) -> list[GearboxChoice]:
    """
    Give the machine's own gearbox with each ratio, and those of the catalogue.

    The file knows one torque for its own, which holds for good and for a moment, as in a
    simulation; it goes with the gearbox whatever the ratio.
    """
    torque, speed = (math.inf if limit is None else limit
                     for limit in (own.rated_torque, own.max_speed))
    free = sorted(wanted or ratios)
    different = [ratio for k, ratio in enumerate(free)
                 if k == 0 or ratio > free[k - 1] * (1.0 + _SAME)]
    return [
        *(GearboxChoice(
            CONFIGURED if math.isclose(ratio, own.ratio, rel_tol=_SAME) else OTHER_RATIO,
            replace(own, ratio=float(ratio)), rated_torque=torque, peak_torque=torque,
            max_speed=speed) for ratio in different),
        *(box for box in catalogue.gearboxes if not wanted or any(
            math.isclose(box.gearbox.ratio, ratio, rel_tol=_SAME) for ratio in wanted)),
    ]


def _for_flywheel(sizing: Sizing, pairs: Sequence[Pair]) -> Pair | None:
    """Choose the pair that needs a flywheel: the best, or the best but for the fluctuation."""
    best = OBJECTIVES['forward'][sizing.objective].key
    only = [one for one in sizing.rejected if {c.rule for c in one.broken} == {'fluctuation'}]
    one = next(iter((*sizing.ranked, *sorted(only, key=best))), None)
    return None if one is None else next(
        pair for pair in pairs if (pair[0].name, pair[1].name, pair[1].gearbox.ratio)
        == (one.motor, one.gearbox, one.ratio))


def _sources(pairs: Sequence[tuple[MotorChoice | ServoChoice, GearboxChoice]]) -> dict[str, str]:
    found = {one.name: one.source for pair in pairs for one in pair}
    return {name: source for name, source in found.items() if source}


def sizing_as_data(sized: SizedDrive) -> dict[str, Any]:
    """
    Write a sizing as plain data.

    Parameters
    ----------
    sized : SizedDrive
        The drive.

    Returns
    -------
    dict[str, Any]
        See doc/json.md for the keys.

    """
    sizing, smallest = sized.sizing, sized.flywheel
    data: dict[str, Any] = {
        'method': sizing.method, 'objective': sizing.objective,
        'objective_text': OBJECTIVES[sizing.method][sizing.objective].text,
        'candidates': len(sizing.ranked) + len(sizing.rejected),
        'ranked': [_candidate_as_data(one) for one in sizing.ranked],
        'rejected': [_candidate_as_data(one) for one in sizing.rejected],
        'rejections': sizing.rejections, 'smallest_flywheel': None,
    }
    if smallest is not None and sized.flywheel_for is not None:
        names = dict(zip(('motor', 'gearbox', 'ratio'), sized.flywheel_for))
        data['smallest_flywheel'] = {**names, **smallest._asdict()}
    used = {name for one in sizing.ranked + sizing.rejected for name in (one.motor, one.gearbox)}
    data['sources'] = {name: text for name, text in sized.sources.items() if name in used}
    return data


def _candidate_as_data(one: Candidate) -> dict[str, Any]:
    data: dict[str, Any] = {
        'motor': one.motor, 'gearbox': one.gearbox, 'ratio': one.ratio,
        'flywheel': one.flywheel, 'rated_power_kw': one.rated_power / 1e3,
        **{name: finite(value) for name, value in one.figures.items()},
        'margins': {check.rule: finite(check.margin_pct) for check in one.checks},
        'least_margin_pct': finite(one.least_margin_pct),
    }
    if one.broken:
        data['broke'] = [{
            'rule': check.rule, 'value': finite(check.value), 'bound': finite(check.bound),
            'unit': check.unit, 'by_pct': finite(check.by_pct) if check.by_pct else None,
        } for check in one.broken]
    return data
