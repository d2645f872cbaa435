# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What is read off the periodic motions of many designs: power reversals, speeds, torques."""

from __future__ import annotations

from functools import reduce
from typing import NamedTuple

from cam_motion.drive.batch_contact import least_follower_force
from cam_motion.drive.batch_orbit import horner, Motions
from cam_motion.drive.cells import Flags, LoadTable, NODES, Numbers, POINTS, RULE, transform, weigh
from cam_motion.drive.collocation import gauss_rule
from cam_motion.drive.designs import Shafts
from cam_motion.drive.orbit import Orbit
from cam_motion.motion.piece import Array
import numpy as np

_ROOT_STEPS = 4
_HALVINGS = 60
_FLAT = 1e-5  # share of the energy per radian; a slower crossing is a dwell at idle speed
_GAPS: Array = np.diff(NODES)
_FINE = gauss_rule(2 * POINTS)
_INTEGRALS: Array = (np.linalg.inv(np.vander(NODES, increasing=True))
                     / np.arange(1.0, NODES.size + 1.0)[:, None])


class Figures(NamedTuple):
    """
    Figures of periodic motions, arrays of shape (n,).

    Speed of the cam shaft at q = 0, least and greatest [rad/s]; duration of a revolution [s];
    work, and work while the motor drives [J], RMS over time and greatest magnitude of the torque
    [N m], all at the motor shaft; least force that presses the follower on the cam [N]; by how
    much a disturbance of the energy is multiplied in a revolution [-].
    """

    start_speed: Array
    min_speed: Array
    max_speed: Array
    period: Array
    motor_work: Array
    drawn_work: Array
    rms_motor_torque: Array
    peak_motor_torque: Array
    least_follower_force: Array
    multiplier: Array


def reversals(motions: Motions) -> tuple[Numbers, Array]:
    """
    Find where the motors' torques change their sign.

    Parameters
    ----------
    motions : Motions
        Where to look.

    Returns
    -------
    tuple[ndarray, ndarray]
        How many there are, shape (n,), and the shaft angles [rad], one design after the other,
        rising for each; places right at the ends of cells may lie on either side.

    """
    over = _over_idle(motions)
    lossy = motions.shafts.driving < motions.shafts.driven
    steep = np.abs(np.diff(over, axis=0)) > _FLAT * motions.at_nodes.energy[:-1] * (
        motions.cells.span * _GAPS[:, None, None])
    (_, cell, design), x = _crossings(motions, over, steep & lossy)
    start, span = (np.broadcast_to(x, over.shape[1:])[cell, design]
                   for x in (motions.cells.start, motions.cells.span))
    angles = start + span * x
    order = np.lexsort((angles, design))
    return np.bincount(design, minlength=lossy.size), angles[order]


def _over_idle(motions: Motions) -> Array:
    """Give E - J w0²/2 at the nodes: below 0 where the motors drive, above where they do not."""
    energy, inertia, _, _ = motions.at_nodes
    over = energy - 0.5 * inertia * motions.shafts.idle_speed ** 2
    over[0, 1:] = over[-1, :-1] = 0.5 * (over[0, 1:] + over[-1, :-1])
    return over


def _crossings(motions: Motions, over: Array, among: Flags | bool,
               ) -> tuple[tuple[Numbers, ...], Array]:
    """
    Find between which nodes, and where in the cells, the motors' torques change their sign.

    The torque is zero at the idle speed w0, and E - J w0²/2 with it. Between the nodes that is
    Hermite's cubic through its values and its slopes Q - C w0².
    """
    shafts, cells = motions.shafts, motions.cells
    above = over > 0.0
    place = np.nonzero((above[:-1] != above[1:]) & among)
    node, cell, design = place
    after = (node + 1, cell, design)
    slope = motions.at_nodes.power - cells.centripetal * shafts.idle_speed ** 2
    gap = np.broadcast_to(cells.span, over.shape[1:])[cell, design] * _GAPS[node]
    x = _root(over[place], over[after], gap * slope[place], gap * slope[after])
    return place, NODES[node] + _GAPS[node] * x


def _driving(motions: Motions, torque: Array) -> Array:
    """
    Integrate the torques of the motors, given at the nodes, over the angle where they drive.

    In each cell it is the integral up to its end, if the motor drives there, plus that up to
    each place where it ceases to and less that up to each where it begins to.
    """
    cells, over = motions.cells, _over_idle(motions)
    whole = cells.span * weigh(RULE.weights, torque[1:-1])
    drawn = np.where(over[-1] > 0.0, 0.0, whole)
    (node, cell, design), x = _crossings(motions, over, True)
    terms = transform(_INTEGRALS, torque[:, cell, design])
    passed = np.broadcast_to(cells.span, whole.shape)[cell, design] * x * horner(terms, x)
    ceases = over[node + 1, cell, design] > 0.0
    np.add.at(drawn, (cell, design), np.where(ceases, passed, -passed))
    found: Array = reduce(np.add, drawn)
    return found


def _root(low: Array, high: Array, low_slope: Array, high_slope: Array) -> Array:
    """Find the roots of Hermite's cubics between values of opposite sign, from 0 to 1."""
    square, cube = _hermite(low, high, low_slope, high_slope)
    t = low / (low - high)
    for _ in range(_ROOT_STEPS):
        value = low + t * (low_slope + t * (square + t * cube))
        slope = low_slope + t * (2.0 * square + 3.0 * t * cube)
        t = np.clip(t - np.divide(value, slope, out=np.zeros_like(t), where=slope != 0.0),
                    0.0, 1.0)
    return t


def _hermite(low: Array, high: Array, low_slope: Array, high_slope: Array) -> tuple[Array, Array]:
    """Give the coefficients of t² and t³."""
    rise = high - low
    return 3.0 * rise - 2.0 * low_slope - high_slope, low_slope + high_slope - 2.0 * rise


def figures(motions: Motions, table: LoadTable) -> Figures:
    """
    Take the figures.

    Parameters
    ----------
    motions : Motions
        The periodic motions.
    table : LoadTable
        Their load.

    Returns
    -------
    Figures
        One set for each design.

    """
    shafts, cells = motions.shafts, motions.cells
    energy, inertia, power, slope = motions.at_nodes
    square = 2.0 * energy / inertia
    slowest, fastest = np.sqrt(_extremes(
        motions, table, square, 2.0 * (power - cells.centripetal * square) / inertia))
    omega = np.sqrt(square)
    torque = shafts.motor(omega)[0]
    inner, slowness = torque[1:-1], 1.0 / omega[1:-1]
    period, work, heat, exponent = (
        reduce(np.add, cells.span * weigh(RULE.weights, values))
        for values in (slowness, inner, inner * inner * slowness, slope[1:-1]))
    peak = np.maximum(np.max(np.abs(torque), axis=(0, 1)), _peak(shafts, slowest, fastest))
    return Figures(omega[0, 0], slowest, fastest, period, shafts.ratio * work,
                   shafts.ratio * _driving(motions, torque), np.sqrt(heat / period), peak,
                   least_follower_force(motions, table), np.exp(exponent))


def figures_of(orbit: Orbit, shaft: Shafts) -> Figures:
    """
    Take the same figures from the exact solver.

    Parameters
    ----------
    orbit : Orbit
        The periodic motion.
    shaft : Shafts
        Its one design.

    Returns
    -------
    Figures
        Arrays of one number.

    """
    slowest, fastest = orbit.speeds
    start, heat = 0.0, 0.0
    for stretch in orbit.stretches:
        x = np.append(0.0, _FINE.points)
        omega = stretch.omega(stretch.element.start + stretch.span * x)
        start = start or float(omega[0])
        torque = shaft.motor(omega)[0]
        heat += stretch.span * float(_FINE.weights @ (torque ** 2 / omega)[1:])
    peak = _peak(shaft, np.array([slowest]), np.array([fastest]))
    return Figures(*np.array([
        start, slowest, fastest, orbit.period, orbit.motor_work, orbit.drawn_work,
        (heat / orbit.period) ** 0.5, peak[0], orbit.least_follower_force,
        orbit.multiplier])[:, None])


def _extremes(motions: Motions, table: LoadTable, square: Array, slope: Array,
              ) -> tuple[Array, Array]:
    """
    Find the least and the greatest w² from its values and slopes at the nodes.

    Between two nodes with slopes of opposite sign Hermite's cubic says where; the value there is
    that of the collocation polynomial.
    """
    cells = motions.cells
    place = np.nonzero(slope[:-1] * slope[1:] < 0.0)
    node, cell, design = place
    after = (node + 1, cell, design)
    start, span = (np.broadcast_to(x, square.shape[1:])[cell, design]
                   for x in (cells.start, cells.span))
    element = np.broadcast_to(cells.element, square.shape[1:])[cell, design]
    gap = span * _GAPS[node]
    low, high = gap * slope[place], gap * slope[after]
    quadratic, cubic = _hermite(square[place], square[after], low, high)
    # the root with a rising slope for a minimum, that with a falling one for a maximum
    bend = np.sqrt(quadratic * quadratic - 3.0 * cubic * low)
    x = NODES[node] - _GAPS[node] * low / (quadratic + np.where(low < 0.0, bend, -bend))
    energy = motions.first[cell, design] + x * horner(motions.polynomials[:, cell, design], x)
    inertia = table.terms_in(element, start + span * x)[0] + motions.shafts.inertia[design]
    found = 2.0 * energy / inertia
    least, greatest = np.min(square, axis=(0, 1)), np.max(square, axis=(0, 1))
    np.minimum.at(least, design, found)
    np.maximum.at(greatest, design, found)
    return least, greatest


def _peak(shafts: Shafts, slowest: Array, fastest: Array) -> Array:
    """Find the greatest torque between two speeds: at one of them, or at a breakdown between."""
    torques = [np.abs(shafts.motor(speed)[0]) for speed in (slowest, fastest)]
    slips = [1.0 - speed / shafts.idle_speed for speed in (slowest, fastest)]
    passed = (slips[1] < shafts.breakdown_slip) & (shafts.breakdown_slip < slips[0])
    peak = np.maximum(*torques)
    peak[passed] = np.maximum(peak, shafts.breakdown_torque)[passed]
    generates = shafts.motor(fastest)[1] < 0.0
    generates &= slips[1] < 0.0
    if generates.any():
        some = shafts.take(generates)
        low, high = some.idle_speed, fastest[generates]
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            rises = some.motor(middle)[1] > 0.0
            low, high = np.where(rises, middle, low), np.where(rises, high, middle)
        peak[generates] = np.maximum(peak[generates], np.abs(some.motor(low)[0]))
    return peak
