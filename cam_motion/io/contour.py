# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The figures of a cam disc, and what is wrong with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
import math

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.axis import Values
from cam_motion.io.cam_disc_config import build_cam_discs, CamDiscSettings
from cam_motion.mechanism.cam_limits import (
    BaseCircle,
    limit_problems,
    round_up,
    smallest_base_circle,
)
from cam_motion.mechanism.cam_offset import best_offset, OffsetDesign
from cam_motion.mechanism.cam_roller import TranslatingRoller
from cam_motion.motion.piecewise import Peak
from cam_motion.units import DEGREE, RPM


@dataclass(frozen=True)
class ForceFigures:
    """
    The contact force of a cam disc.

    Attributes
    ----------
    least, greatest : Peak
        Extremes at steady speed [N] with their shaft angles [rad].
    lift_off : Peak | None
        Lowest steady speed at which the follower lifts off [rad/s], and where; None: it never
        does.
    stiffness, preload : Peak | None
        What a spring needs at least at this speed, each beside the other one as it is [N/m, m;
        of a follower that swings N m/rad, rad]; None without exactly one spring.
    orbit_least, orbit_greatest : Peak | None
        The extremes in the periodic motion of the drive, where there is one.

    """

    least: Peak
    greatest: Peak
    lift_off: Peak | None
    stiffness: Peak | None = None
    preload: Peak | None = None
    orbit_least: Peak | None = None
    orbit_greatest: Peak | None = None


@dataclass(frozen=True)
class ContourFigures:
    """
    The figures of a cam disc.

    Attributes
    ----------
    pressure_angles : tuple[Peak, Peak]
        Least and greatest [rad].
    least_radius : Peak
        Least radius of curvature of the contour where it bulges [m].
    hollow_radius : Peak | None
        Tightest hollow, below 0 [m]; None without any.
    smallest_base : BaseCircle | None
        Smallest base circle within the limits; None where there is none.
    offset : OffsetDesign | None
        Best offset for the limits of the pressure angle, of a translating roller.
    face : tuple[Peak, Peak] | None
        Ends of the stretch of a flat face that is touched [m].
    force : ForceFigures | None
        The contact force, where something loads the follower.

    """

    pressure_angles: tuple[Peak, Peak]
    least_radius: Peak
    hollow_radius: Peak | None
    smallest_base: BaseCircle | None
    offset: OffsetDesign | None
    face: tuple[Peak, Peak] | None
    force: ForceFigures | None


def contour_figures(settings: CamDiscSettings) -> ContourFigures:
    """
    Gather the figures of a cam disc.

    Parameters
    ----------
    settings : CamDiscSettings
        The disc.

    Returns
    -------
    ContourFigures
        Its figures.

    """
    disc, limits, offset = settings.disc, settings.limits, None
    out, back = limits.pressure_angle, limits.return_pressure_angle
    if isinstance(disc.follower, TranslatingRoller) and out is not None and back is not None:
        offset = best_offset(
            disc.profile, disc.sense, disc.follower.roller_radius, out, back)
    try:
        smallest: BaseCircle | None = smallest_base_circle(disc, limits)
    except ConfigurationError:
        smallest = None
    return ContourFigures(
        disc.pressure_angles, disc.least_contour_radius, disc.hollow_contour_radius, smallest,
        offset, disc.face_range if disc.follower.is_flat else None, _force(settings))


def _force(settings: CamDiscSettings) -> ForceFigures | None:
    force, spring = settings.force, settings.spring
    if force is None:
        return None
    stiffness = preload = on_least = on_greatest = None
    if spring is not None:
        try:
            stiffness = force.stiffness_for(settings.speed, spring.preload, settings.least_force)
        except ConfigurationError:
            stiffness = None  # the spring is slack somewhere
        if spring.stiffness > 0.0:
            preload = force.preload_for(settings.speed, spring.stiffness, settings.least_force)
    if settings.orbit is not None:
        on_least, on_greatest = force.extremes_on(settings.orbit)
    least, greatest = force.extremes(settings.speed)
    return ForceFigures(least, greatest, force.lift_off, stiffness, preload, on_least, on_greatest)


def disc_problems(settings: CamDiscSettings) -> list[Problem]:
    """
    Say what is wrong with a disc that can be built: undercutting, limits, bore, lift-off.

    Parameters
    ----------
    settings : CamDiscSettings
        The disc.

    Returns
    -------
    list[Problem]
        Everything that is wrong, paths relative to its section.

    """
    problems = limit_problems(settings.disc, settings.limits) + bore_problems(settings)
    force, least_force = settings.force, settings.least_force
    if force is None or settings.groove:
        return problems
    if settings.orbit is None:
        least, when = force.extremes(settings.speed)[0], f'{settings.speed / RPM:.6g} rpm'
    else:
        least = force.extremes_on(settings.orbit)[0]
        when = "the drive's periodic motion"
    if least.value < least_force or least.value <= 0.0:
        problems.append(Problem(
            'limits.contact_force', least_force, 'the contact force comes down to '
            f'{least.value:.6g} N at {least.at / DEGREE:.6g} deg, at {when}: '
            + ('the follower lifts off' if least.value <= 0.0 else 'less must not be left'),
            _firmer(settings)))
    return problems


def bore_problems(settings: CamDiscSettings) -> list[Problem]:
    """
    Say whether the bore, or its keyway, cuts through the contour.

    Parameters
    ----------
    settings : CamDiscSettings
        The disc.

    Returns
    -------
    list[Problem]
        The problem, its path relative to the section; empty where there is none.

    """
    bore, key = settings.bore_radius, settings.keyway
    if bore is None:
        return []
    outermost = bore if key is None else math.hypot(bore + key.depth, 0.5 * key.width)
    nearest = settings.disc.nearest
    return [] if outermost < nearest else [Problem(
        'bore_radius', bore, f'bore and keyway reach {outermost:g} m from the shaft, the '
        f'contour comes as near as {nearest:.6g} m', 'a smaller bore, or a larger disc')]


def _firmer(settings: CamDiscSettings) -> str:
    """Say what would hold the follower on the disc."""
    figures, swings = _force(settings), settings.disc.follower.swings
    if figures is None:
        return ''
    ways = []
    if figures.stiffness is not None:
        unit = 'N m/rad' if swings else 'N/m'
        ways.append(f'a spring with {round_up(figures.stiffness.value):.10g} {unit}')
    if figures.preload is not None and figures.preload.value > 0.0:
        value = figures.preload.value / (DEGREE if swings else 1.0)
        ways.append(f'a preload of {round_up(value):.10g} {"deg" if swings else "m"}')
    if figures.lift_off is not None and figures.lift_off.value > 0.0 and not settings.least_force:
        ways.append(f'less than {figures.lift_off.value / RPM:.6g} rpm')
    return ' or '.join(ways) or 'a spring'


def check_discs(sections: Mapping[str, Values],
                ) -> tuple[dict[str, CamDiscSettings], list[Problem]]:
    """
    Check all cam discs of a machine file, their limits included.

    Parameters
    ----------
    sections : Mapping[str, Mapping[str, Any]]
        Parameters of every node.

    Returns
    -------
    tuple[dict[str, CamDiscSettings], list[Problem]]
        Those that can be built, and everything that is wrong with any.

    """
    discs, problems = build_cam_discs(sections)
    for name, settings in discs.items():
        problems += [problem.below(name) for problem in disc_problems(settings)]
    return discs, problems


def disc_text(settings: CamDiscSettings) -> str:
    """
    Say in one line what a disc is like.

    Parameters
    ----------
    settings : CamDiscSettings
        The disc.

    Returns
    -------
    str
        Pressure angle, least radius of curvature and lift-off speed.

    """
    disc, force = settings.disc, settings.force
    back, out = (peak.value / DEGREE for peak in disc.pressure_angles)
    least = disc.least_contour_radius
    text = (f'pressure angle {back:.4g} to {out:.4g} deg, least radius of curvature '
            f'{least.value:.4g} m')
    if force is None or settings.groove or force.lift_off is None:
        return text
    return f'{text}, lift-off at {force.lift_off.value / RPM:.5g} rpm'
