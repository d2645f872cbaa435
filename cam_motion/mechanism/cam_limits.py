# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What a disc cam may do: its limits, the smallest base circle within them, the best offset."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
import math
from typing import Any, NamedTuple

from cam_motion.drive.load import Follower
from cam_motion.errors import ConfigurationError, Problem
from cam_motion.mechanism.cam_disc import CamDisc
from cam_motion.mechanism.cam_extremes import split_turn
from cam_motion.mechanism.cam_follower import Contact, reach_of
from cam_motion.units import DEGREE
import numpy as np

_COARSE = 41  # points per stretch of the search, before what it finds is refined
_NUDGE = 1e-14  # share of a radius by which rounding is left behind
_CLOSE = 1e-9  # share of a radius where no cam is found on the other side

UNDERCUT, RADIUS, HOLLOW = 'undercut', 'radius_of_curvature', 'cutter_radius'
OUTWARDS, INWARDS = 'pressure_angle', 'return_pressure_angle'
GROOVE, GEOMETRY = 'groove', 'geometry'
"""What can bind a base circle: a limit by its name, or that the follower could not move."""


@dataclass(frozen=True)
class CamLimits:
    """
    The limits of a disc cam; None where there is none.

    Attributes
    ----------
    pressure_angle : float | None
        Largest pressure angle while the disc drives the follower outwards [rad].
    return_pressure_angle : float | None
        The same while it comes back [rad].
    radius_of_curvature : float | None
        Least radius of curvature of the contour where it bulges [m].
    cutter_radius : float | None
        Radius of the cutter or grinding wheel that must fit into every hollow [m].
    groove : bool
        Whether the roller runs in a groove, whose other flank must not be undercut either.

    Raises
    ------
    ConfigurationError
        When a limit is out of range.

    References
    ----------
    VDI 2142 part 1 (1994) and R. L. Norton, Cam Design and Manufacturing Handbook (2nd ed. 2009):
    pressure angle up to 30 deg for a translating follower (up to 45 deg for a swinging one), and
    a path of the roller's centre that bends with 1.5 to 2 times the roller's radius at least.

    """

    pressure_angle: float | None = None
    return_pressure_angle: float | None = None
    radius_of_curvature: float | None = None
    cutter_radius: float | None = None
    groove: bool = False

    def __post_init__(self) -> None:
        """Refuse limits out of range."""
        problems = [
            Problem(name, value, 'must be above 0 and below 90 deg')
            for name in (OUTWARDS, INWARDS)
            if (value := getattr(self, name)) is not None and not 0.0 < value < 0.5 * math.pi]
        problems += [
            Problem(name, value, 'must be a finite number of at least 0')
            for name in (RADIUS, HOLLOW)
            if (value := getattr(self, name)) is not None and not 0.0 <= value < math.inf]
        if problems:
            raise ConfigurationError(problems)


class Margin(NamedTuple):
    """How much is left of a limit [rad, m], by name, and at which shaft angle [rad]."""

    name: str
    left: float
    at: float


class BaseCircle(NamedTuple):
    """A smallest base circle: its radius [m], what binds it, and at which shaft angle [rad]."""

    radius: float
    binding: str
    at: float


def margins(disc: CamDisc, limits: CamLimits) -> tuple[Margin, ...]:
    """
    Measure what a disc leaves of its limits.

    Parameters
    ----------
    disc : CamDisc
        The disc.
    limits : CamLimits
        The limits.

    Returns
    -------
    tuple[Margin, ...]
        The margins, negative where a limit is broken; undercutting is the first of them, and is
        broken at 0 already.

    """
    roller, least = disc.follower.roller_radius, disc.least_contour_radius
    found = [Margin(UNDERCUT, least.value, least.at)]
    if limits.radius_of_curvature is not None:
        found.append(Margin(RADIUS, least.value - limits.radius_of_curvature, least.at))
    hollow = disc.hollow_contour_radius
    if limits.cutter_radius is not None and hollow is not None:
        found.append(Margin(HOLLOW, -hollow.value - limits.cutter_radius, hollow.at))
    if limits.groove and hollow is not None:
        found.append(Margin(GROOVE, -hollow.value - 2.0 * roller, hollow.at))
    back, out = disc.pressure_angles
    if limits.pressure_angle is not None:
        found.append(Margin(OUTWARDS, limits.pressure_angle - out.value, out.at))
    if limits.return_pressure_angle is not None:
        found.append(Margin(INWARDS, limits.return_pressure_angle + back.value, back.at))
    return tuple(found)


def smallest_base_circle(disc: CamDisc, limits: CamLimits) -> BaseCircle:
    """
    Find the smallest base circle on which a cam keeps its limits.

    Parameters
    ----------
    disc : CamDisc
        The cam; its own base radius does not matter.
    limits : CamLimits
        The limits.

    Returns
    -------
    BaseCircle
        The base radius to rounding, on the side where the limits are kept. So they are with all
        larger ones that were looked at, up to where a swinging follower comes to the end of its
        reach.

    Raises
    ------
    ConfigurationError
        When there is none, with the limit that is hardest to keep.

    """
    radii = disc.follower.base_radii(disc.profile)
    at = disc.motion(np.concatenate([
        np.linspace(e.start, e.end, _COARSE)[:-1] for e in split_turn(disc.profile)]))
    rough = [_rough_margin(disc, limits, at, float(radius)) for radius in radii]
    sound = [k for k, left in enumerate(rough) if left > 0.0]
    while sound:
        last = sound[-1]
        if _left(disc, limits, float(radii[last])) > 0.0:
            break
        sound.pop()
    if not sound:
        raise ConfigurationError([_none_problem(disc, limits, radii, rough)])
    good = last
    while good > 0 and rough[good - 1] > 0.0:
        good -= 1
    # a point between those of the rough look may break a limit that they keep
    while _left(disc, limits, float(radii[good])) <= 0.0:
        good += 1
    bad = 0.0 if good == 0 else float(radii[good - 1])
    radius = _boundary(disc, limits, bad, float(radii[good]))
    binding = min(margins(_on(disc, radius), limits), key=lambda margin: margin.left)
    if binding.left > 1e-6 * max(radius, disc.follower.roller_radius):
        binding = Margin(GEOMETRY, 0.0, reach_of(disc.profile)[0].at)
    return BaseCircle(radius, binding.name, binding.at)


def limit_problems(disc: CamDisc, limits: CamLimits) -> list[Problem]:
    """
    Say which limits a disc breaks, and what would help.

    Parameters
    ----------
    disc : CamDisc
        The disc.
    limits : CamLimits
        Its limits.

    Returns
    -------
    list[Problem]
        One for each broken limit, with the shaft angle, and the smallest base radius with which
        all are kept.

    """
    broken = [margin for margin in margins(disc, limits)
              if margin.left < 0.0 or (margin.name == UNDERCUT and margin.left == 0.0)]
    if not broken:
        return []
    if broken[0].name == UNDERCUT:  # the least radius is then broken as well
        broken = [margin for margin in broken if margin.name != RADIUS]
    try:
        circle = smallest_base_circle(disc, limits)
        way_out = f'take a base_radius of at least {round_up(circle.radius):.10g} m'
    except ConfigurationError as error:
        way_out = error.problems[0].rule
    return [_problem(disc, limits, margin, way_out) for margin in broken]


def round_up(value: float, digits: int = 6) -> float:
    """
    Round a positive number up, so that it can be taken as printed.

    Parameters
    ----------
    value : float
        The number.
    digits : int
        Significant digits that stay.

    Returns
    -------
    float
        The number or a little more.

    """
    if value <= 0.0:
        return value
    unit = 10.0 ** (math.floor(math.log10(value)) + 1 - digits)
    return math.ceil(value / unit) * unit


def _problem(disc: CamDisc, limits: CamLimits, margin: Margin, way_out: str) -> Problem:
    name, where = margin.name, f'at {margin.at / DEGREE:.6g} deg'
    if name in (OUTWARDS, INWARDS):
        limit = getattr(limits, name) / DEGREE
        way = 'outwards' if name == OUTWARDS else 'back'
        return Problem(
            f'limits.{name}_deg', round(limit, 12), 'the pressure angle on the way '
            f'{way} reaches {limit - margin.left / DEGREE:.6g} deg {where}', way_out)
    least = disc.least_contour_radius.value
    if name == RADIUS:
        return Problem(f'limits.{name}', limits.radius_of_curvature, 'the contour bends with a '
                       f'radius of {least:.6g} m {where}', way_out)
    if name == HOLLOW:
        hollow = -margin.left - (limits.cutter_radius or 0.0)
        return Problem(f'limits.{name}', limits.cutter_radius, 'the contour has a hollow with a '
                       f'radius of {-hollow:.6g} m {where}', f'{way_out}, or a smaller cutter')
    roller = disc.follower.roller_radius
    if name == GROOVE:
        return Problem(
            'roller_radius', roller, 'the roller undercuts the outer flank of its groove '
            f"{where}: there its centre's path is hollow with a radius of "
            f'{margin.left + roller:.6g} m', f'{way_out}, or a smaller roller')
    if disc.follower.is_flat:
        rule = ("base radius + s + s'' must be above 0" if not disc.follower.swings else
                'the radius of curvature of the contour must be above 0')
        return Problem('base_radius', disc.base_radius, 'the flat face undercuts the contour: '
                       f'{rule}, it is {least:.6g} m {where}', way_out)
    kind = 'makes the contour pointed' if least == 0.0 else 'undercuts the contour'
    return Problem(
        'roller_radius', roller, f"the roller {kind} {where}: there its centre's path bends "
        f'with a radius of {least + roller:.6g} m', f'{way_out}, or a smaller roller')


def _none_problem(disc: CamDisc, limits: CamLimits, radii: Any, rough: list[float]) -> Problem:
    """Say that no base circle will do, and how near the best one comes."""
    if not rough or max(rough) == -math.inf:
        return Problem('base_radius', disc.base_radius, 'no base radius lets this follower carry '
                       'out this profile', 'a smaller stroke, or longer segments')
    best = float(radii[int(np.argmax(rough))])
    hardest = min(margins(_on(disc, best), limits), key=lambda margin: margin.left)
    return Problem(
        'base_radius', disc.base_radius, 'no base radius keeps these limits: '
        f'{hardest.name} is the hardest, broken even with {best:.6g} m at '
        f'{hardest.at / DEGREE:.6g} deg', 'a longer segment, a smaller stroke, or another arm or '
        'pivot')


def _on(disc: CamDisc, radius: float) -> CamDisc:
    """Give the cam on another base circle."""
    follower: Any = disc.follower  # every follower is a dataclass
    return CamDisc(disc.profile, replace(follower, base_radius=radius), disc.sense)


def _left(disc: CamDisc, limits: CamLimits, radius: float) -> float:
    """Give the least margin on a base circle, -inf where the follower cannot move."""
    try:
        return min(margin.left for margin in margins(_on(disc, radius), limits))
    except ConfigurationError:
        return -math.inf


def _rough_margin(disc: CamDisc, limits: CamLimits, at: Follower, radius: float) -> float:
    """Give about the same, from points."""
    try:
        cam = _on(disc, radius)
    except ConfigurationError:
        return -math.inf
    return min(_rough_margins(cam, limits, cam.contact_at(at)))


def _rough_margins(cam: CamDisc, limits: CamLimits, found: Contact) -> Iterator[float]:
    roller = cam.follower.roller_radius
    angle = np.arctan2(radius := cam.base_radius * found.bend, found.span)
    tight, loose = float(np.max(angle)), float(np.min(angle))
    least = cam.base_radius / math.tan(tight) - roller if tight > 0.0 else math.inf
    yield least
    yield least - (limits.radius_of_curvature or 0.0)
    if not cam.follower.is_flat and np.min(radius) < 0.0:
        hollow = roller - cam.base_radius / math.tan(loose)
        yield hollow - (limits.cutter_radius or 0.0)
        if limits.groove:
            yield hollow - 2.0 * roller
    if limits.pressure_angle is not None:
        yield limits.pressure_angle - float(np.max(found.pressure))
    if limits.return_pressure_angle is not None:
        yield limits.return_pressure_angle + float(np.min(found.pressure))


def _boundary(disc: CamDisc, limits: CamLimits, bad: float, good: float) -> float:
    """Find where the least margin passes 0, and stay where it is above."""
    def left(radius: float) -> float:
        return _left(disc, limits, radius)

    at_bad = left(bad) if bad > 0.0 else -math.inf
    if at_bad > 0.0:
        return bad
    least = _CLOSE * good
    while at_bad == -math.inf and good - bad > least:  # until both ends are cams
        middle = 0.5 * (bad + good)
        found = left(middle)
        if found > 0.0:
            good = middle
        else:
            bad, at_bad = middle, found
    if at_bad == -math.inf:
        return good
    from scipy.optimize import brentq
    radius = float(brentq(left, bad, good, xtol=1e-300, rtol=9e-16))
    while left(radius) <= 0.0:
        radius *= 1.0 + _NUDGE
    return radius
