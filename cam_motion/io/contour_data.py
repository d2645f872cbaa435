# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The figures of a cam disc as plain data, for JSON and for people."""

from __future__ import annotations

from typing import Any

from cam_motion.io.cam_disc_config import CamDiscSettings
from cam_motion.io.contour import ContourFigures
from cam_motion.io.plain import finite
from cam_motion.mechanism.cam_limits import BaseCircle, GEOMETRY
from cam_motion.motion.piecewise import Peak
from cam_motion.units import DEGREE, MM, RPM

_POINT = 1e-9  # m: a base circle of less than that is a point


def disc_as_data(settings: CamDiscSettings) -> dict[str, Any]:
    """
    Turn the same into plain data.

    Parameters
    ----------
    settings : CamDiscSettings
        The disc.

    Returns
    -------
    dict[str, Any]
        What ``cam_motion check --json`` prints of each disc.

    """
    disc, force = settings.disc, settings.force
    back, out = (peak.value / DEGREE for peak in disc.pressure_angles)
    lift_off = None if force is None or settings.groove else force.lift_off
    return {'axis': settings.axis, 'pressure_angles_deg': [back, out],
            'least_radius': disc.least_contour_radius.value, 'undercuts': disc.undercuts,
            'lift_off_rpm': None if lift_off is None else lift_off.value / RPM}


def figures_as_data(settings: CamDiscSettings, figures: ContourFigures) -> dict[str, Any]:
    """
    Turn the figures of a cam disc into plain data.

    Parameters
    ----------
    settings : CamDiscSettings
        The disc.
    figures : ContourFigures
        Its figures.

    Returns
    -------
    dict[str, Any]
        What ``cam_motion contour --json`` prints of each disc; shaft and pressure angles in
        degrees, the rest in SI.

    """
    disc = settings.disc
    back, out = figures.pressure_angles
    data: dict[str, Any] = {
        'axis': settings.axis, 'follower': settings.kind,
        'direction': 'counterclockwise' if disc.sense > 0 else 'clockwise',
        'base_radius': disc.base_radius,
        'roller_radius': None if disc.follower.is_flat else disc.follower.roller_radius,
        'farthest': disc.farthest,
        'pressure_angle_deg': {
            'greatest': out.value / DEGREE, 'at_deg': out.at / DEGREE,
            'least': back.value / DEGREE, 'least_at_deg': back.at / DEGREE},
        'least_radius': _peak(figures.least_radius),
        'hollow_radius': _peak(figures.hollow_radius),
        'undercuts': disc.undercuts,
        'smallest_base_radius': _circle_as_data(figures.smallest_base),
        'best_offset': None if figures.offset is None else {
            'offset': figures.offset.offset, 'base_radius': figures.offset.base_radius},
    }
    pivot = disc.follower.pivot
    if pivot is not None:
        data['bearing_clearance'] = abs(pivot) - disc.farthest
    if figures.face is not None:
        low, high = figures.face
        data['face'] = {'from': low.value, 'to': high.value, 'width': high.value - low.value}
    force = figures.force
    if force is not None:
        lift_off = force.lift_off
        data['contact_force'] = {
            'speed_rpm': settings.speed / RPM, 'least': _peak(force.least),
            'greatest': _peak(force.greatest),
            'lift_off_rpm': None if lift_off is None else lift_off.value / RPM,
            'lift_off_at_deg': None if lift_off is None else lift_off.at / DEGREE,
            'stiffness_needed': _need(force.stiffness), 'preload_needed': _need(force.preload),
            'least_on_orbit': _peak(force.orbit_least),
            'greatest_on_orbit': _peak(force.orbit_greatest)}
    return data


def smallest_text(circle: BaseCircle | None) -> str:
    """
    Say how small the base circle may be, and what limits it.

    Parameters
    ----------
    circle : BaseCircle | None
        The smallest circle; None where none keeps the limits.

    Returns
    -------
    str
        Its radius, the limit and the shaft angle.

    """
    if circle is None:
        return 'none keeps the limits'
    if _unlimited(circle):
        return 'not limited'
    binding = 'no limit binds it' if circle.binding == GEOMETRY else (
        f'{circle.binding} at {circle.at / DEGREE:.6g} deg')
    return f'{circle.radius / MM:.8g} mm ({binding})'


def needed(peak: Peak) -> Peak | None:
    """
    Tell what a spring needs, if anything.

    Parameters
    ----------
    peak : Peak
        The stiffness or preload with which just the least contact force is left.

    Returns
    -------
    Peak | None
        The same; None where that is met without any.

    """
    return peak if peak.value > 0.0 else None


def _unlimited(circle: BaseCircle) -> bool:
    return circle.binding == GEOMETRY and circle.radius <= _POINT


def _circle_as_data(circle: BaseCircle | None) -> dict[str, Any] | None:
    if circle is None:
        return None
    free = _unlimited(circle)
    return {'value': 0.0 if free else circle.radius, 'binding': circle.binding,
            'at_deg': None if free else circle.at / DEGREE}


def _need(peak: Peak | None) -> dict[str, float | None] | None:
    """Write what a spring needs: 0 at no angle where it needs nothing."""
    return _peak(peak) if peak is None or needed(peak) else {'value': 0.0, 'at_deg': None}


def _peak(peak: Peak | None) -> dict[str, float | None] | None:
    return None if peak is None else {
        'value': finite(peak.value), 'at_deg': peak.at / DEGREE}
