# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Velocities, accelerations and forces of a linkage at a position, exactly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.mechanism.assembly import Assembly
from cam_motion.mechanism.linkage import Linkage
from cam_motion.mechanism.pose import Pose
from cam_motion.motion.piece import Array
import numpy as np


@dataclass(frozen=True)
class PointMotion:
    """
    The motion of a point, x + j y.

    Attributes
    ----------
    position, velocity, acceleration : complex
        Position [m], velocity [m/s], acceleration [m/s²].

    """

    position: complex
    velocity: complex
    acceleration: complex


@dataclass(frozen=True)
class LinkageMotion:
    """
    A position with its velocity and acceleration.

    Attributes
    ----------
    pose : Pose
        The position.
    position, velocity, acceleration : Mapping[str, float]
        Every variable and its derivatives by time [m, rad].
    points : Mapping[str, PointMotion]
        Every point.
    transmission : Mapping[str, float]
        Every transmission angle, from 0 (no force is passed on) to a right angle [rad].

    """

    pose: Pose
    position: Mapping[str, float]
    velocity: Mapping[str, float]
    acceleration: Mapping[str, float]
    points: Mapping[str, PointMotion]
    transmission: Mapping[str, float]


def move(assembly: Assembly, pose: Pose, rates: Mapping[str, float],
         accelerations: Mapping[str, float] | None = None) -> LinkageMotion:
    """
    Give velocity and acceleration of everything at a position.

    The loops' derivatives are linear in the unknown rates, J q̇ = -J_u u̇, and so are the second
    ones, J q̈ = -J_u ü - (centripetal and Coriolis parts).

    Parameters
    ----------
    assembly : Assembly
        The linkage on its branch.
    pose : Pose
        A position of it.
    rates : Mapping[str, float]
        Rates of the inputs [m/s, rad/s]; 0 for those left out.
    accelerations : Mapping[str, float], optional
        Second derivatives of the inputs [m/s², rad/s²]; 0 for those left out.

    Returns
    -------
    LinkageMotion
        The motion.

    Raises
    ------
    ConfigurationError
        When a rate is given for what is no input.

    """
    linkage, equations, z = assembly.linkage, assembly.equations, pose.values
    given = accelerations or {}
    _check_inputs(linkage, rates, '_dot')
    _check_inputs(linkage, given, '_ddot')
    by_inputs, by_unknowns = assembly.jacobian(pose)
    count = len(linkage.inputs)
    rate, acceleration = np.zeros_like(z), np.zeros_like(z)
    rate[:count] = [rates.get(name, 0.0) for name in linkage.inputs]
    rate[count:] = np.linalg.solve(by_unknowns, -(by_inputs @ rate[:count]))
    acceleration[:count] = [given.get(name, 0.0) for name in linkage.inputs]
    bend = equations.bend(z, rate)
    closing = equations.loops @ bend
    acceleration[count:] = np.linalg.solve(
        by_unknowns, -(by_inputs @ acceleration[:count])
        - np.concatenate([closing.real, closing.imag]))
    vectors, slopes = equations.vectors(z), equations.slopes(z)
    motions = (equations.points @ vectors, equations.points @ (slopes @ rate),
               equations.points @ (slopes @ acceleration + bend))
    values, rates_found, accelerations_found = (  # + 0.0: no minus before a zero
        dict(zip(linkage.variables, map(float, each + 0.0))) for each in (z, rate, acceleration))
    return LinkageMotion(
        pose, values, rates_found, accelerations_found,
        {point.name: PointMotion(*(complex(each[k]) for each in motions))
         for k, point in enumerate(linkage.points)},
        {each.name: _acute(complex(equations.along(each.first) @ vectors),
                           complex(equations.along(each.second) @ vectors))
         for each in linkage.transmissions})


def sweep(assembly: Assembly, inputs: Mapping[str, Array],
          rates: Mapping[str, Array | float]) -> list[LinkageMotion]:
    """
    Go through many positions, each from the one before.

    Parameters
    ----------
    assembly : Assembly
        The linkage on its branch.
    inputs : Mapping[str, ndarray], shape (k,) each
        Inputs [m, rad]; those left out stay as at the start.
    rates : Mapping[str, ndarray | float], shape (k,) or one for all
        Rates of the inputs [m/s, rad/s].

    Returns
    -------
    list[LinkageMotion]
        The motions.

    Raises
    ------
    ConfigurationError
        When the first position is out of range.
    SingularError
        When a singular position is in the way.

    """
    series: Sequence[dict[str, float]] = [
        dict(zip(inputs, map(float, row))) for row in zip(*inputs.values())]
    spread = {name: np.broadcast_to(rate, (len(series),)) for name, rate in rates.items()}
    found, pose = [], None
    for k, each in enumerate(series):
        pose = assembly.at(each) if pose is None else assembly.follow(pose, each)
        found.append(move(assembly, pose, {name: float(rate[k]) for name, rate in spread.items()}))
    return found


def holding_efforts(assembly: Assembly, pose: Pose, forces: Mapping[str, complex],
                    torques: Mapping[str, float] | None = None) -> dict[str, float]:
    """
    Find what the inputs must exert to hold loads, by virtual work.

    Without friction, inertia and weight: for any motion the power of the inputs and that of the
    loads add up to zero.

    Parameters
    ----------
    assembly : Assembly
        The linkage on its branch.
    pose : Pose
        A position of it.
    forces : Mapping[str, complex]
        Forces on points, x + j y [N].
    torques : Mapping[str, float], optional
        Efforts that act on variables: torques on angles [N m], forces along lengths [N].

    Returns
    -------
    dict[str, float]
        Effort at each input: torque at an angle [N m], force along a length [N].

    Raises
    ------
    ConfigurationError
        When a load acts on what the linkage does not have.

    """
    linkage, torques = assembly.linkage, torques or {}
    names = [point.name for point in linkage.points]
    problems = [Problem(name, force, 'must be a point of the linkage', 'known are: '
                        + ', '.join(names)) for name, force in forces.items() if name not in names]
    problems += [Problem(name, torque, 'must be a variable of the linkage', 'known are: '
                         + ', '.join(linkage.variables))
                 for name, torque in torques.items() if name not in linkage.variables]
    if problems:
        raise ConfigurationError(problems)
    by_inputs, by_unknowns = assembly.jacobian(pose)
    # how all variables follow each input
    gain = np.concatenate([np.eye(len(linkage.inputs)), -np.linalg.solve(by_unknowns, by_inputs)])
    moved = assembly.equations.points @ (assembly.equations.slopes(pose.values) @ gain)
    loads = np.array([forces.get(name, 0.0) for name in names], dtype=np.complex128)
    turned = np.array([torques.get(name, 0.0) for name in linkage.variables])
    efforts = -(np.real(np.conj(loads) @ moved) + turned @ gain)
    return dict(zip(linkage.inputs, map(float, efforts)))


def _check_inputs(linkage: Linkage, given: Mapping[str, float], suffix: str) -> None:
    problems = [
        Problem(f'{name}{suffix}', value, 'is no input of the linkage',
                'known are: ' + ', '.join(linkage.inputs))
        for name, value in given.items() if name not in linkage.inputs]
    problems += [Problem(f'{name}{suffix}', value, 'must be a finite number')
                 for name, value in given.items() if not np.isfinite(value)]
    if problems:
        raise ConfigurationError(problems)


def _acute(first: complex, second: complex) -> float:
    """Give the angle between two lines."""
    product = first.conjugate() * second
    return float(np.arctan2(abs(product.imag), abs(product.real)))
