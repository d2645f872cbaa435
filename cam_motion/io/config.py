# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Reading a machine's configuration: a ROS 2 parameter file, read as the nodes read it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
import re
from typing import Any

from cam_motion.errors import ConfigurationError, Problem
from cam_motion.io.axis import Values
from cam_motion.io.machine import build_machine, Machine
import yaml

_HINT = 'a machine file has a key per node, and ros__parameters: below each'
_EVERY_NODE = '/**'
_WIDTH = 74  # the writer folds after the number that crosses it


class _Loader(yaml.SafeLoader):
    """YAML as the ROS parser reads it: 1e-3 is a number, and no key may stand twice."""


_Loader.add_implicit_resolver(
    'tag:yaml.org,2002:float',
    re.compile(r'^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$|^[-+]?\.(inf|Inf|INF)$'
               r'|^\.(nan|NaN|NAN)$'),
    list('-+0123456789.'),
)
# whole numbers before floats, as the pattern above takes both
_Loader.yaml_implicit_resolvers = {
    first: sorted(resolvers, key=lambda pair: pair[0].endswith(':float'))
    for first, resolvers in _Loader.yaml_implicit_resolvers.items()
}


def _mapping_without_duplicates(loader: _Loader, node: yaml.MappingNode) -> dict[Any, Any]:
    keys = [loader.construct_object(key, deep=True) for key, _ in node.value]
    for key, (key_node, _) in zip(keys, node.value):
        if keys.count(key) > 1:
            raise ConfigurationError([Problem(
                str(key), key, f'stands twice (line {key_node.start_mark.line + 1})',
                'keep one of them')])
    return dict(loader.construct_mapping(node, deep=True))


_Loader.add_constructor(
    yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _mapping_without_duplicates)


def read_sections(path: str | Path, any_namespace: bool = True) -> dict[str, Values]:
    """
    Read a ROS 2 parameter file.

    Parameters
    ----------
    path : str | Path
        The file.
    any_namespace : bool
        Whether sections that name a namespace count too.

    Returns
    -------
    dict[str, Mapping[str, Any]]
        Parameters of every node, by node name (namespaces dropped) and flat parameter name.

    Raises
    ------
    ConfigurationError
        When the file cannot be read or is no parameter file.

    """
    try:
        text = Path(path).read_text(encoding='utf-8')
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, 'strerror', None) or str(error)
        raise ConfigurationError([Problem(
            str(path), None, f'cannot be read: {reason}', 'give the path of a machine file'
        )]) from error
    return parse_sections(text, str(path), any_namespace)


def parse_yaml(text: str, source: str) -> Any:
    """
    Parse YAML as the ROS parser reads it, and refuse a key that stands twice.

    Parameters
    ----------
    text : str
        YAML.
    source : str
        What to call it in errors.

    Returns
    -------
    Any
        Mappings, lists, texts and numbers.

    Raises
    ------
    ConfigurationError
        When it is no YAML.

    """
    try:
        return yaml.load(text, Loader=_Loader)  # noqa: S506 (a SafeLoader by inheritance)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        # ValueError: dates such as 2026-13-45 and endless numbers; RecursionError: [[[[...
        mark = getattr(error, 'problem_mark', None)
        place = f'{source}:{mark.line + 1}:{mark.column + 1}' if mark else source
        reason = getattr(error, 'problem', None) or str(error)
        raise ConfigurationError([Problem(place, '', f'is no YAML: {reason}')]) from error


def parse_sections(text: str, source: str = 'configuration', any_namespace: bool = True,
                   ) -> dict[str, Values]:
    """
    Parse the text of a ROS 2 parameter file.

    Parameters
    ----------
    text : str
        YAML.
    source : str
        What to call it in errors.
    any_namespace : bool
        Whether sections that name a namespace count too.

    Returns
    -------
    dict[str, Mapping[str, Any]]
        Parameters of every node, by node name (namespaces dropped) and flat parameter name.

    Raises
    ------
    ConfigurationError
        When it is no YAML or no parameter file.

    """
    tree = parse_yaml(text, source)
    if not isinstance(tree, Mapping) or not tree:
        raise ConfigurationError([Problem(source, tree, 'is no machine file', _HINT)])
    problems: list[Problem] = []
    sections: dict[str, dict[str, Any]] = {}
    shared: dict[str, Any] = {}
    for key, body in tree.items():
        below = body.get('ros__parameters') if isinstance(body, Mapping) else None
        if not isinstance(key, str) or not isinstance(below, Mapping):
            problems.append(Problem(str(key), body, 'is no section of a node', _HINT))
            continue
        extra = [name for name in body if name != 'ros__parameters']
        problems += [Problem(f'{key}.{name}', body[name], 'stands beside ros__parameters',
                             'move it below ros__parameters') for name in extra]
        flat = flatten(below)
        if key == _EVERY_NODE:
            shared = flat
        elif any_namespace or '/' not in key.removeprefix('/'):
            sections.setdefault(key.rsplit('/', 1)[-1], {}).update(flat)
    problems += [
        Problem(f'{name}.{key}', str(value)[:40],
                'a whole number must fit into 64 bits, as in ROS')
        for name, own in (*sections.items(), (_EVERY_NODE, shared)) for key, value in own.items()
        for item in (value if isinstance(value, list) else [value])
        if isinstance(item, int) and not -2 ** 63 <= item < 2 ** 63
    ]
    if problems:
        raise ConfigurationError(problems)
    return {name: {**shared, **own} for name, own in sections.items()}


def flatten(tree: Mapping[Any, Any], prefix: str = '') -> dict[str, Any]:
    """
    Give parameters in levels their flat names.

    Parameters
    ----------
    tree : Mapping[Any, Any]
        Values, and mappings of such.
    prefix : str
        What their names begin with.

    Returns
    -------
    dict[str, Any]
        Values by flat name (``feed.end_deg``).

    """
    flat: dict[str, Any] = {}
    for key, value in tree.items():
        name = f'{prefix}{key}'
        if isinstance(value, Mapping):
            flat.update(flatten(value, name + '.'))
        else:
            flat[name] = value
    return flat


def load_machine(path: str | Path) -> Machine:
    """
    Read, check and build a machine.

    Parameters
    ----------
    path : str | Path
        A ROS 2 parameter file.

    Returns
    -------
    Machine
        The machine.

    Raises
    ------
    ConfigurationError
        With every problem found.

    """
    return build_machine(read_sections(path))


def segment_yaml(name: str, values: Mapping[str, Any]) -> str:
    """
    Write a segment as a machine file has it.

    Parameters
    ----------
    name : str
        Its name.
    values : Mapping[str, Any]
        Its parameters.

    Returns
    -------
    str
        YAML; every number so exact that reading gives it back.

    """
    return str(yaml.safe_dump({name: dict(values)}, default_flow_style=None, sort_keys=False,
                              width=_WIDTH))


def section_yaml(name: str, given: Values, remark: Iterable[str] = ()) -> str:
    """
    Write the section of a node as a machine file has it.

    Parameters
    ----------
    name : str
        Name of the node.
    given : Mapping[str, Any]
        Its parameters by flat name.
    remark : Iterable[str]
        Lines of a comment at the head.

    Returns
    -------
    str
        YAML, itself a machine file.

    """
    tree: dict[str, Any] = {}
    for key, value in given.items():
        *above, last = key.split('.')
        level = tree
        for each in above:
            level = level.setdefault(each, {})
        level[last] = value
    text = yaml.safe_dump({name: {'ros__parameters': tree}}, default_flow_style=None,
                          sort_keys=False, width=_WIDTH)
    return ''.join(f'# {line}\n' for line in remark) + str(text)
