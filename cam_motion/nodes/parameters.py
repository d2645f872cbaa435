# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""ROS parameters declared from the table that also validates them offline."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
import sys
from typing import Any

from cam_motion.errors import ConfigurationError
from cam_motion.io.config import read_sections
from cam_motion.io.parameters import is_of_every_node, ParameterSpec, REQUIRED
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node

_LARGEST = 1.7976931348623157e308


def machine_files() -> list[str]:
    """
    Find the parameter files of this process.

    Returns
    -------
    list[str]
        What stands behind ``--params-file`` on the command line, in order.

    """
    return [value for flag, value in zip(sys.argv, sys.argv[1:]) if flag == '--params-file']


def section_of(name: str, machine: str = '') -> dict[str, Any]:
    """
    Find the parameters of another node of the machine.

    Parameters
    ----------
    name : str
        Its name, without a namespace.
    machine : str
        Machine file; empty takes those of this process.

    Returns
    -------
    dict[str, Any]
        Parameters by flat name; empty where no file has such a section.

    Raises
    ------
    ConfigurationError
        When a file cannot be used.

    """
    found: dict[str, Any] = {}
    for path in [machine] if machine else machine_files():
        found |= read_sections(path).get(name, {})
    return found


def declare_given(node: Node) -> None:
    """
    Declare whatever a node has been given, known or not.

    rclpy's own ``automatically_declare_parameters_from_overrides`` ends the process over an empty
    list, which has no type in a parameter file; here it counts as not given.

    Parameters
    ----------
    node : Node
        The node.

    """
    for name, parameter in node._parameter_overrides.items():
        if parameter.value is not None and not node.has_parameter(name):
            node.declare_parameter(
                name, parameter.value, ParameterDescriptor(dynamic_typing=parameter.value == []),
                ignore_override=True)


def take_from_any_namespace(node: Node) -> None:
    """
    Give a node in a namespace the parameters of the section that bears its bare name.

    To ROS a section ``feeder`` means the node ``/feeder`` alone. A machine file is meant for
    the line wherever a namespace places it, so its sections apply there too, those that name
    another namespace apart; what ROS has given the node already stands.

    Parameters
    ----------
    node : Node
        The node.

    """
    if node.get_namespace() == '/':
        return
    given: Mapping[str, Any] = {}
    for path in machine_files():
        try:
            sections = read_sections(path, any_namespace=False)
            given = {**given, **sections.get(node.get_name(), {})}
        except ConfigurationError:
            continue  # ROS has read it as it could; the offline check says what is wrong
    for name, value in given.items():
        if value is not None and not node.has_parameter(name):
            node.declare_parameter(
                name, value, ParameterDescriptor(dynamic_typing=value == []),
                ignore_override=True)


def declare(node: Node, table: Iterable[ParameterSpec]) -> None:
    """
    Declare the parameters of a table on a node, keeping what was given.

    Everything given must have been declared before, see `declare_given`, names that the table
    does not know included. Values of a wrong type stay as they were given, for the validation to
    report all problems at once.

    Parameters
    ----------
    node : Node
        The node.
    table : Iterable[ParameterSpec]
        The parameters.

    """
    for spec in table:
        given = node.has_parameter(spec.name)
        value = node.get_parameter(spec.name).value if given else spec.default
        if not given and (value is None or value is REQUIRED):
            continue  # stays absent: ROS has no parameter without a value
        if given:
            if spec.check(value) is not None:
                continue
            node.undeclare_parameter(spec.name)
            value = spec.cleaned(value)
        node.declare_parameter(
            spec.name, value, describe(spec, value), ignore_override=True)


def describe(spec: ParameterSpec, value: Any) -> ParameterDescriptor:
    """
    Make the descriptor that ``ros2 param describe`` shows.

    Parameters
    ----------
    spec : ParameterSpec
        The parameter.
    value : Any
        Its value at first.

    Returns
    -------
    ParameterDescriptor
        Meaning, unit, rule and range.

    """
    descriptor = ParameterDescriptor(
        name=spec.name, additional_constraints=spec.rule,
        description=spec.meaning + (f' Unit: {spec.unit}.' if spec.unit else ''),
        # an empty list has no type of its own in ROS
        dynamic_typing=value == [],
    )
    if spec.kind == 'double' and (spec.least is not None or spec.above is not None):
        low = spec.least if spec.least is not None else spec.above
        high = spec.most if spec.most is not None else _LARGEST
        descriptor.floating_point_range = [FloatingPointRange(from_value=low, to_value=high)]
    return descriptor


def values_of(node: Node) -> dict[str, Any]:
    """
    Read all parameters of a node but those that ROS gives to every node.

    Parameters
    ----------
    node : Node
        The node.

    Returns
    -------
    dict[str, Any]
        Values by flat name; arrays as lists.

    """
    values = {}
    for name, parameter in node.get_parameters_by_prefix('').items():
        value = parameter.value
        if value is not None and not is_of_every_node(name):
            values[name] = list(value) if hasattr(value, 'tolist') else value
    return values
