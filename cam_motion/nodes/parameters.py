# Copyright 2026 The cam_motion authors
# SPDX-License-Identifier: Apache-2.0
"""ROS parameters declared from the table that also validates them offline."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node

from cam_motion.io.parameters import is_of_every_node, ParameterSpec, REQUIRED

_LARGEST = 1.7976931348623157e308


def declare(node: Node, table: Iterable[ParameterSpec]) -> None:
    """
    Declare the parameters of a table on a node, keeping what was given.

    The node must have been made with ``automatically_declare_parameters_from_overrides``, so
    that everything given is known, names that the table does not know included. Values of a
    wrong type stay as they were given, for the validation to report all problems at once.

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
