# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""An axis as a configuration describes it, every problem at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
import math
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io import axis_parameters
from cam_motion.io.parameters import check_values, ParameterSpec
from cam_motion.io.shaping import take_shaping
from cam_motion.io.tracks import take_tracks, track_table, TrackSettings
from cam_motion.motion.continuity import Continuity, program_continuity
from cam_motion.motion.diagram import Axis
from cam_motion.motion.laws import make_law
from cam_motion.motion.laws.with_points import lift_of, SPLINE
from cam_motion.motion.limits import Limits, QUANTITIES, SpeedBound
from cam_motion.motion.profile import CamProfile, program_problems, VelocityStepError
from cam_motion.motion.segment import Segment
from cam_motion.runtime.follower_settings import FollowerSettings
from cam_motion.runtime.layout import Coupling, Layout
from cam_motion.runtime.planning import At, Timing, TransitionError
from cam_motion.runtime.ramp import RampLimits
from cam_motion.units import DEGREE

SHORTEST_DEG = 1e-6
"""Least span of a segment [deg]: with less, nothing is left of an angle but its rounding."""

LARGEST_LIFT = 1e15
"""Largest magnitude of a lift, in the unit of its axis."""

ONLY_CAM = 'cam'
"""Name of the cam of an axis that has no list of cams."""

Values = Mapping[str, Any]
"""Parameters of one node by flat name."""

Reach = tuple[float, float]
"""Lowest and highest position of an axis."""

ANYWHERE: Reach = (-math.inf, math.inf)
"""Reach of an axis that accumulates, or of which nothing is known."""


@dataclass(frozen=True)
class CoupledAxis(Axis):
    """
    An axis with its couplings to the shaft.

    Attributes
    ----------
    layout : Layout
        All its cams and how they are coupled; the `profile` is the first one in use.
    settings : FollowerSettings
        What it may, and how it engages, disengages, changes and resumes.
    values : Mapping[str, Any]
        Every parameter of the axis itself, checked.
    tracks : Mapping[str, TrackSettings]
        Its cam tracks by name.

    """

    layout: Layout = field(kw_only=True)
    settings: FollowerSettings = field(kw_only=True)
    values: Values = field(kw_only=True)
    tracks: Mapping[str, TrackSettings] = field(kw_only=True, default_factory=dict)

    def bound_by(self, limits: Limits) -> SpeedBound | None:
        """
        Find the highest steady shaft speed within given limits, couplings included.

        Parameters
        ----------
        limits : Limits
            The limits.

        Returns
        -------
        SpeedBound | None
            The speed and what holds it there; None where nothing does.

        """
        return self.layout.speed_bound(limits)


def axis_table(given: Values) -> tuple[ParameterSpec, ...]:
    """
    List the parameters of an axis, which depend on the cams it has.

    Parameters
    ----------
    given : Mapping[str, Any]
        Parameters by flat name.

    Returns
    -------
    tuple[ParameterSpec, ...]
        The table; of several cams each has its own part, below its name.

    """
    cams, tracks = names_in(given, 'cams'), track_table(given, of_axis=True)
    if not cams:
        return axis_parameters.CAM_AXIS + tracks
    own = tuple(spec for spec in axis_parameters.CAM_AXIS if spec not in axis_parameters.CAM)
    return own + tracks + tuple(replace(spec, name=f'{cam}.{spec.name}')
                                for cam in dict.fromkeys(cams) for spec in axis_parameters.CAM)


def names_in(given: Values, key: str) -> list[str]:
    """
    Read a list of names, whatever is given in its place.

    Parameters
    ----------
    given : Mapping[str, Any]
        Parameters by flat name.
    key : str
        Name of the list.

    Returns
    -------
    list[str]
        The names; empty where there is no list.

    """
    names = given.get(key)
    return [n for n in names if isinstance(n, str)] if isinstance(names, (list, tuple)) else []


def split_below(given: Values, names: Iterable[str],
                ) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
    """
    Separate what stands below given names from the rest.

    Parameters
    ----------
    given : Mapping[str, Any]
        Parameters by flat name.
    names : Iterable[str]
        The names.

    Returns
    -------
    tuple[dict[str, Any], dict[str, dict[str, Any]]]
        The rest, and what stands below each name.

    """
    own: dict[str, Any] = {}
    below: dict[str, dict[str, Any]] = {name: {} for name in names}
    for key, value in given.items():
        head, _, rest = key.partition('.')
        if rest and head in below:
            below[head][rest] = value
        else:
            own[key] = value
    return own, below


def build_axis(name: str, given: Values, reach: Reach = ANYWHERE) -> CoupledAxis:
    """
    Check the parameters of an axis and compile its cams.

    Parameters
    ----------
    name : str
        Name of the axis.
    given : Mapping[str, Any]
        Parameters by flat name (``feed.end_deg``).
    reach : tuple[float, float]
        Between which places the axis stays that this one follows.

    Returns
    -------
    CoupledAxis
        The axis.

    Raises
    ------
    ConfigurationError
        With every problem, paths relative to the axis.

    """
    names = names_in(given, 'cams')
    given, tracks, problems = take_tracks(
        given, axis_parameters.CAM_AXIS, [*names, *names_in(given, 'segments')], of_axis=True)
    problems += _twice('cams', names) + _taken('cams', names)
    profiles: dict[str, CamProfile] = {}
    couplings: dict[str, Coupling] = {}
    if names:
        own, below = split_below(given, names)
        table = tuple(spec for spec in axis_parameters.CAM_AXIS if spec not in axis_parameters.CAM)
        values, wrong = check_values(table, own)
        problems += wrong
        parts: dict[str, tuple[Values, str]] = {cam: (below[cam], cam) for cam in below}
    else:
        own, below = split_below(given, names_in(given, 'segments'))
        values, wrong = check_values(axis_parameters.CAM_AXIS, own)
        problems += wrong
        parts = {ONLY_CAM: (given, '')}
    for cam, (section, path) in parts.items():
        try:
            profiles[cam], couplings[cam] = _build_cam(section)
        except ConfigurationError as error:
            known = {problem.path for problem in problems}
            problems += [p for problem in error.problems
                         if (p := problem.below(path) if path else problem).path not in known]
    active = tuple(values['active']) or tuple(parts)[:1]
    problems += _twice('active', active) + [
        Problem('active', cam, 'must name cams of this axis', 'known are: ' + ', '.join(parts))
        for cam in active if cam not in parts]
    if values['follows'] == name:
        problems.append(Problem('follows', name, 'an axis cannot follow itself'))
    limits, wrong = _limits(values)
    problems += wrong
    shaping, wrong = take_shaping(values, values['follows'] == axis_parameters.SHAFT)
    problems += [new for new in wrong if new.path not in {problem.path for problem in problems}]
    if shaping is not None and not problems:
        profiles, wrong = shaping.shaped(
            profiles, {cam: each.ratio for cam, each in couplings.items()})
        problems += wrong
    if not problems:
        layout = Layout(profiles, couplings, active)
        try:
            # engaged where it stands, it gets its place between the limits by engaging
            layout.check_range(limits, anywhere=values['engage.slave'] == 'relative' and (
                not values['engage_at_start']))
        except TransitionError as error:
            side = 'lowest' if limits.highest is None else 'highest'
            problems.append(Problem(f'limits.{side}', getattr(limits, side), str(error)))
    if problems:
        raise ConfigurationError(problems)
    return CoupledAxis(name, profiles[active[0]], values['unit'], limits, layout=layout,
                       settings=_settings(values, limits, couplings[active[0]].ratio, reach),
                       values=values, tracks=tracks)


def stepping_cams(given: Values) -> dict[str, Continuity]:
    """
    Find the cams of an axis with which nothing is wrong but that their velocity steps.

    Parameters
    ----------
    given : Mapping[str, Any]
        Parameters of the axis by flat name.

    Returns
    -------
    dict[str, Continuity]
        Their joints, by cam.

    """
    names = names_in(given, 'cams')
    given, _, _ = take_tracks(
        given, axis_parameters.CAM_AXIS, [*names, *names_in(given, 'segments')], of_axis=True)
    found = {}
    for cam, section in (split_below(given, names)[1] if names else {ONLY_CAM: given}).items():
        try:
            _build_cam(section)
        except VelocityStepError as error:
            found[cam] = program_continuity(error.segments)
        except ConfigurationError:
            continue  # whoever builds the axis tells what is wrong
    return found


def _twice(key: str, names: Iterable[str]) -> list[Problem]:
    names = list(names)
    return [Problem(key, name, 'every name stands once')
            for name in dict.fromkeys(names) if names.count(name) > 1]


def _taken(key: str, names: Iterable[str]) -> list[Problem]:
    """Refuse names below which the axis has parameters of its own."""
    own = {spec.name.partition('.')[0] for spec in axis_parameters.CAM_AXIS if '.' in spec.name}
    return [Problem(key, name, 'stands for parameters of the axis itself', 'take another name')
            for name in names if name in own]


def _limits(values: Values) -> tuple[Limits, list[Problem]]:
    try:
        return Limits(*(values[f'limits.{name}'] for name in (
            *QUANTITIES[1:], 'lowest', 'highest'))), []
    except ConfigurationError as error:
        return Limits(), list(error.problems)


def _settings(values: Values, limits: Limits, ratio: float, reach: Reach) -> FollowerSettings:
    on_shaft = values['follows'] == axis_parameters.SHAFT
    # over another axis angles are those of the cam, which turns by the ratio [rad] per its unit
    per = 1.0 if on_shaft else 1.0 / abs(ratio)
    degree = per * DEGREE

    def timing(name: str) -> Timing:
        return Timing(
            At(values[f'{name}.at']), values[f'{name}.span_deg'] * degree,
            values[f'{name}.longest_deg'] * degree, values.get(f'{name}.angle_deg', 0.0) * degree,
            360.0 * degree, 360.0 * degree, reach)
    ramp = RampLimits(values['shaft_acceleration'] * per, values['shaft_jerk'] * per)
    return FollowerSettings(
        limits, ramp,
        timing('engage'), timing('disengage'), timing('change'), timing('resume'),
        master_relative=values['engage.master'] == 'relative',
        slave_relative=values['engage.slave'] == 'relative',
        start_position=values['start_position'], stop_position=values['disengage.position'],
        obeyed=on_shaft)


def _build_cam(given: Values) -> tuple[CamProfile, Coupling]:
    """Compile one cam with its coupling; keys that belong to the axis are passed over."""
    names = names_in(given, 'segments')
    own, below = split_below(given, names)
    of_cam = {spec.name for spec in axis_parameters.CAM}
    known = {spec.name for spec in axis_parameters.CAM_AXIS} - of_cam
    values, problems = check_values(
        axis_parameters.CAM, {key: value for key, value in own.items() if key not in known})
    problems += [
        Problem('segments', name, 'every segment has a name of its own')
        for name in dict.fromkeys(names) if names.count(name) > 1
    ]
    problems += _taken('segments', names)
    if not names and values['segments'] == []:
        problems.append(Problem('segments', [], 'a cam needs at least one segment'))
    if values['ratio'] == 0.0:
        problems.append(Problem('ratio', 0.0, 'must not be zero', 'disengage the axis instead'))
    segments = []
    for segment in names:
        built, wrong = _build_segment(segment, below[segment])
        segments.append(built)
        problems += [problem.below(segment) for problem in wrong]
    problems += _span_problems(segments)
    accumulate = values['cycle'] == 'accumulate'
    if problems and segments:
        # angles and lifts are looked at although a law or another parameter is wrong
        seen = {problem.path for problem in problems}
        problems += [problem for problem in program_problems(tuple(segments), accumulate)
                     if problem.path not in seen]
    if problems or not segments:
        raise ConfigurationError(problems)
    return CamProfile(segments, accumulate), Coupling(
        values['ratio'], values['phase_deg'] * DEGREE, values['scale'], values['offset'])


def _span_problems(segments: list[Segment]) -> list[Problem]:
    """Find segments whose numbers no machine has, and with which the cam would overflow."""
    problems = []
    start = 0.0
    for segment in segments:
        if 0.0 < segment.end_deg - start < SHORTEST_DEG:
            problems.append(Problem(
                f'{segment.name}.end_deg', segment.end_deg, 'a segment must span at least '
                f'{SHORTEST_DEG:g} deg', 'leave the segment out'))
        if math.isfinite(segment.lift) and abs(segment.lift) > LARGEST_LIFT:
            problems.append(Problem(
                f'{segment.name}.lift', segment.lift,
                f'a lift must be at most {LARGEST_LIFT:g}', 'take a larger unit'))
        start = segment.end_deg
    return problems


def _build_segment(name: str, given: Values) -> tuple[Segment, list[Problem]]:
    """Build a segment with a stand-in (NaN, any law) for whatever is wrong, and say what is."""
    fixed = {spec.name for spec in axis_parameters.SEGMENT}
    values, problems = check_values(
        axis_parameters.SEGMENT, {k: v for k, v in given.items() if k in fixed})
    law = make_law('cubic')
    try:
        law = make_law(values['law'], **{k: v for k, v in given.items() if k not in fixed})
    except ConfigurationError as error:
        problems += error.problems
    if law.name == SPLINE and 'lift' not in given and law.parameters['positions']:
        values['lift'] = lift_of(law.parameters)
    elif values['law'] != 'dwell' and 'lift' not in given:
        problems.append(Problem('lift', None, 'a segment with a law needs a lift'))
    wrong = {problem.path for problem in problems}
    end_deg, lift = (
        math.nan if key in wrong else values[key] for key in ('end_deg', 'lift'))
    return Segment(name, law, end_deg, lift), problems
