# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A cam disc as a machine file describes it, every problem at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
import math
from typing import Any, NamedTuple

from cam_motion.drive.load import Part, Spring
from cam_motion.drive.orbit import find_orbit, NoOrbitError, Orbit
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io import cam_disc_parameters as tables
from cam_motion.io.axis import build_axis, split_below, Values
from cam_motion.io.cam_disc_load import FAST, is_bearable, LARGEST_FORCE, load_part
from cam_motion.io.cam_drive_config import build_cam_drive, cam_on_shaft, CamDriveSettings
from cam_motion.io.cam_drive_parameters import part_names
from cam_motion.io.line_parts import LINE_SHAFT
from cam_motion.io.load_config import lever_problems
from cam_motion.io.parameters import check_values, MASTER_SHAFT
from cam_motion.mechanism.cam_disc import CamDisc, CLOCKWISE, COUNTERCLOCKWISE
from cam_motion.mechanism.cam_flat import SwingingFlat, TranslatingFlat
from cam_motion.mechanism.cam_follower import CamFollower
from cam_motion.mechanism.cam_force import ContactForce
from cam_motion.mechanism.cam_limits import CamLimits
from cam_motion.mechanism.cam_roller import SwingingRoller, TranslatingRoller
from cam_motion.motion.profile import CamProfile
from cam_motion.units import DEGREE, RPM

# what each kind of follower has besides the base radius, and whether it must be given
_FIGURES: dict[str, tuple[type, dict[str, bool]]] = {
    'translating_roller': (TranslatingRoller, {'roller_radius': True, 'offset': False}),
    'translating_flat': (TranslatingFlat, {'offset': False}),
    'swinging_roller': (SwingingRoller, {'roller_radius': True, 'arm_length': True,
                                         'pivot_distance': True}),
    'swinging_flat': (SwingingFlat, {'pivot_distance': True, 'face_offset': False}),
}
_OF_SOME = {name: [kind for kind, (_, names) in _FIGURES.items() if name in names]
            for _, figures in _FIGURES.values() for name in figures}


class Keyway(NamedTuple):
    """A keyway in the bore of a disc: width and depth [m], and its angle on the disc [rad]."""

    width: float
    depth: float
    angle: float


@dataclass(frozen=True)
class CamDiscSettings:
    """
    A cam disc with what a machine file says of it.

    Attributes
    ----------
    name, axis : str
        Names of its section and of the axis whose motion it makes.
    disc : CamDisc
        The disc.
    limits : CamLimits
        Its limits.
    least_force : float
        Contact force that must be left [N].
    parts : tuple[Part, ...]
        What loads the follower.
    speed : float
        Speed of the shaft for the contact force [rad/s].
    drive : CamDriveSettings | None
        The drive that turns it, where there is one.
    tolerance : float
        Largest distance of an exported contour from the exact one [m].
    bore_radius : float | None
        Radius of the bore [m].
    keyway : Keyway | None
        The keyway in the bore.

    """

    name: str
    axis: str
    disc: CamDisc
    limits: CamLimits
    least_force: float
    parts: tuple[Part, ...]
    speed: float
    drive: CamDriveSettings | None
    tolerance: float
    bore_radius: float | None = None
    keyway: Keyway | None = None

    @property
    def groove(self) -> bool:
        """Whether the roller runs in a groove, which holds it from both sides."""
        return self.limits.groove

    @property
    def kind(self) -> str:
        """Name the kind of the follower as the machine file does."""
        return next(kind for kind, (made, _) in _FIGURES.items()
                    if isinstance(self.disc.follower, made))

    @property
    def spring(self) -> Spring | None:
        """Give the spring on the follower, where there is exactly one."""
        springs = [part for part in self.parts if isinstance(part, Spring)]
        return springs[0] if len(springs) == 1 else None

    @cached_property
    def force(self) -> ContactForce | None:
        """Give the contact force; None where nothing loads the follower."""
        return ContactForce(self.disc, self.parts) if self.parts else None

    @cached_property
    def orbit(self) -> Orbit | None:
        """Find the periodic motion of the drive; None where there is none."""
        if self.drive is None:
            return None
        try:
            return find_orbit(self.drive.drive)
        except NoOrbitError:
            return None


def disc_names(sections: Mapping[str, Values]) -> list[str]:
    """
    Find the sections that describe a cam disc.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.

    Returns
    -------
    list[str]
        Names of the sections with ``type: cam_disc``.

    """
    return [name for name, values in sections.items() if values.get('type') == tables.TYPE]


def build_cam_discs(sections: Mapping[str, Values],
                    ) -> tuple[dict[str, CamDiscSettings], list[Problem]]:
    """
    Check all cam discs of a machine file.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.

    Returns
    -------
    tuple[dict[str, CamDiscSettings], list[Problem]]
        Those that can be built: the sections with ``type: cam_disc``, then the discs of all
        drives that turn a shaft and are not named by one of these, with an in-line roller.
        Whatever keeps the others from being built; broken limits are another question.

    """
    found: dict[str, CamDiscSettings] = {}
    problems: list[Problem] = []
    for name in disc_names(sections):
        try:
            found[name] = _build_disc(name, sections[name], sections)
        except ConfigurationError as error:
            problems += [problem.below(name) for problem in error.problems]
    taken = {sections[name].get('drive') for name in disc_names(sections)}
    for name, values in sections.items():
        if values.get('mode') == LINE_SHAFT and name not in taken:
            try:
                found[name] = _disc_of(name, sections)
            except ConfigurationError:
                continue  # what is wrong with a drive, its own check says
    return found, problems


def _build_disc(name: str, given: Values, sections: Mapping[str, Values]) -> CamDiscSettings:
    parts_named = part_names(given)
    taken = {spec.name.partition('.')[0] for spec in tables.CAM_DISC}
    problems = [Problem('load', part, 'every part has a name of its own, which is no parameter')
                for part in parts_named if part in taken]
    own, below = split_below(given, set(parts_named) - taken)
    values, wrong = check_values(tables.CAM_DISC, own)
    problems += wrong
    drive = _named_drive(values, sections, problems)
    if drive is not None:
        problems += _take_from(drive, values)
    profile, unit = _profile(values['profile'], sections, problems)
    swings = values['follower'] in tables.SWINGING
    if profile is not None and unit != (wanted := 'rad' if swings else 'm'):
        problems.append(Problem(
            'profile', values['profile'], f'a {values["follower"]} follower needs an axis with '
            f'unit {wanted}: this one has {unit}', 'another follower, or another axis'))
    follower = _follower(values, problems)
    limits = _limits(values, problems)
    parts: list[Part] = []
    for part in below:
        try:
            parts.append(load_part(below[part], swings))
        except ConfigurationError as error:
            problems += [problem.below(part) for problem in error.problems]
    if profile is not None and len(parts) == len(below):
        problems += lever_problems(dict(zip(below, parts)), profile)
    keyway = _keyway(values, problems)
    if problems or profile is None or follower is None or limits is None:
        raise ConfigurationError(problems)
    sense = COUNTERCLOCKWISE if values['direction'] == 'counterclockwise' else CLOCKWISE
    disc = CamDisc(profile, follower, sense)
    if parts and not is_bearable(ContactForce(disc, parts)):
        raise ConfigurationError([Problem(
            'load', list(below), f'must not take more than {LARGEST_FORCE:g} N to move at '
            f'{FAST:g} rad/s', 'smaller figures')])
    return CamDiscSettings(
        name, values['profile'], disc, limits,
        values['limits.contact_force'] or 0.0,
        tuple(drive.drive.parts) if drive is not None else tuple(parts),
        _speed(values, drive, sections), drive, values['tolerance'], values['bore_radius'], keyway)


def _disc_of(name: str, sections: Mapping[str, Values]) -> CamDiscSettings:
    """Make the disc of a drive that turns a shaft."""
    drive = _drive(name, sections)
    follower = TranslatingRoller(drive.base_radius, drive.roller_radius)
    return CamDiscSettings(
        name, drive.axis, CamDisc(drive.drive.profile, follower), CamLimits(), 0.0,
        tuple(drive.drive.parts), drive.drive.nominal_speed, drive,
        float(next(spec.default for spec in tables.CAM_DISC if spec.name == 'tolerance')))


def _drive(name: str, sections: Mapping[str, Values]) -> CamDriveSettings:
    given = sections[name]
    axis = build_axis(str(given.get('axis')), sections.get(str(given.get('axis')), {}))
    return build_cam_drive(name, given, {axis.name: cam_on_shaft(axis)})


def _named_drive(values: Values, sections: Mapping[str, Values], problems: list[Problem],
                 ) -> CamDriveSettings | None:
    name = values['drive']
    if not name:
        return None
    if sections.get(name, {}).get('mode') != LINE_SHAFT:
        problems.append(Problem('drive', name, f'must be a drive with mode {LINE_SHAFT}'))
        return None
    try:
        return _drive(name, sections)
    except ConfigurationError:
        problems.append(Problem('drive', name, 'must be sound itself', 'see its own problems'))
        return None


def _take_from(drive: CamDriveSettings, values: dict[str, Any]) -> list[Problem]:
    """Take the radii from the drive, and compare those that are given with them."""
    problems = []
    rule = f'must be that of the drive {drive.name}'
    if values['profile'] not in (None, drive.axis):
        problems.append(Problem('profile', values['profile'], f'{rule}: {drive.axis}'))
    if values['load']:
        problems.append(Problem('load', values['load'], f'{drive.name} has a load already',
                                'leave it out'))
    if values['follower'] in tables.SWINGING:
        problems.append(Problem('follower', values['follower'], f'{drive.name} moves a follower '
                                'that travels', 'leave the drive out'))
    names = ('base_radius', *(['roller_radius'] if values['follower'] in tables.ROLLERS else []))
    for name in names:
        theirs = getattr(drive, name)
        if values[name] not in (None, theirs):
            problems.append(Problem(name, values[name], f'{rule}: {theirs:g} m', 'leave it out'))
        values[name] = theirs
    return problems


def _profile(name: str | None, sections: Mapping[str, Values], problems: list[Problem],
             ) -> tuple[CamProfile | None, str]:
    if name is None:
        return None, ''
    given = sections.get(name, {})
    if 'segments' not in given and 'cams' not in given:
        problems.append(Problem(
            'profile', name, 'must be the name of an axis', 'known are: ' + ', '.join(
                each for each, values in sections.items() if 'segments' in values)))
        return None, ''
    try:
        axis = build_axis(name, given)
    except ConfigurationError:
        problems.append(Problem('profile', name, 'must be sound itself', 'see its own problems'))
        return None, ''
    if axis.profile.advance:
        problems.append(Problem('profile', name, 'the motion of a disc cam must return: it '
                                f'advances by {axis.profile.advance:g} in each cycle',
                                'an axis with cycle: return'))
        return None, ''
    return axis.profile, axis.unit


def _follower(values: Values, problems: list[Problem]) -> CamFollower | None:
    """Build the follower; what it has, and what belongs to others only."""
    kind = values['follower']
    made, figures = _FIGURES[kind]
    wrong = [Problem(name, values[name], f'belongs to {" and ".join(kinds)} only', 'leave it out')
             for name, kinds in _OF_SOME.items()
             if values[name] is not None and kind not in kinds]
    if values['groove'] and kind not in tables.ROLLERS:
        wrong.append(Problem('groove', True, 'only a roller runs in a groove', 'leave it out'))
    wrong += [Problem(name, None, f'a {kind} follower needs it')
              for name in ('base_radius', *(n for n, must in figures.items() if must))
              if values[name] is None and name not in {problem.path for problem in problems}]
    problems += wrong
    if wrong or any(values[n] is None for n in ('base_radius', *(
            n for n, must in figures.items() if must))):
        return None
    follower: CamFollower = made(base_radius=values['base_radius'], **{
        name: values[name] for name in figures if values[name] is not None})
    return follower


def _limits(values: Values, problems: list[Problem]) -> CamLimits | None:
    out, back = (values[f'limits.{name}pressure_angle_deg'] for name in ('', 'return_'))
    if back is not None and out is None:
        problems.append(Problem('limits.pressure_angle_deg', None, 'goes with '
                                'limits.return_pressure_angle_deg'))
        return None
    out = None if out is None else out * DEGREE
    return CamLimits(out, out if back is None else back * DEGREE,
                     values['limits.radius_of_curvature'], values['limits.cutter_radius'],
                     values['groove'])


def _keyway(values: Values, problems: list[Problem]) -> Keyway | None:
    width, depth = values['keyway.width'], values['keyway.depth']
    if width is None and depth is None:
        return None
    bore = values['bore_radius']
    problems += [Problem(name, None, 'a keyway needs it') for name, value in (
        ('bore_radius', bore), ('keyway.width', width), ('keyway.depth', depth)) if value is None]
    if None in (bore, width, depth):
        return None
    if width >= 2.0 * bore:
        problems.append(Problem('keyway.width', width, 'must be less than the bore, '
                                f'{2.0 * bore:g} m'))
    return Keyway(width, depth, math.remainder(values['keyway.angle_deg'] * DEGREE, math.tau))


def _speed(values: Values, drive: CamDriveSettings | None, sections: Mapping[str, Values],
           ) -> float:
    """Find the speed of the shaft: given, of the drive, of the master [rad/s]."""
    if values['speed_rpm'] is not None:
        return float(values['speed_rpm']) * RPM
    if drive is not None:
        return drive.drive.nominal_speed
    for given in sections.values():
        if given.get('mode') == LINE_SHAFT and isinstance(given.get('nominal_rpm'), (int, float)):
            return float(given['nominal_rpm']) * RPM
    masters = [given for given in sections.values() if 'speed_cpm' in given]
    checked, _ = check_values(MASTER_SHAFT, masters[0] if masters else {})
    return abs(float(checked['speed_cpm'])) * RPM
