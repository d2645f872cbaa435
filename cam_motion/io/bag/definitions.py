# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Definition texts and hashes of message types."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from cam_motion.io.bag.error import BagError
from rosbags.typesys import (
    get_types_from_idl,
    get_types_from_msg,
    get_typestore,
    Stores,
    TypesysError,
)
from rosbags.typesys.store import Typestore

_IDL_SEPARATOR = '=' * 80 + '\n'


@lru_cache(maxsize=1)
def jazzy() -> Typestore:
    """
    Load the message types that come with ROS 2 Jazzy.

    Returns
    -------
    Typestore
        The types; shared, so do not register any.

    """
    return get_typestore(Stores.ROS2_JAZZY)


def describe(
    type_name: str, definition: str | None = None, type_hash: str | None = None
) -> tuple[str, str, str]:
    """
    Find what a bag keeps of a message type.

    Parameters
    ----------
    type_name : str
        Such as ``sensor_msgs/msg/JointState``.
    definition : str or None
        Definition text with all dependencies, for types that Jazzy does not bring.
    type_hash : str or None
        RIHS01 hash; None to compute it.

    Returns
    -------
    tuple of str
        Definition, its encoding (``ros2msg`` or ``ros2idl``), and hash.

    Raises
    ------
    BagError
        If the type is unknown and no usable definition is given.

    """
    if definition is None:
        if type_name not in jazzy().fielddefs:
            raise BagError(
                f'{type_name}: not a message type of ROS 2 Jazzy '
                '(give its definition text with dependencies as definition=...)'
            )
        text, _ = jazzy().generate_msgdef(type_name, ros_version=2)
        return text, 'ros2msg', type_hash or jazzy().hash_rihs01(type_name)
    encoding = 'ros2idl' if definition.startswith(_IDL_SEPARATOR + 'IDL: ') else 'ros2msg'
    if type_hash is None:
        store = build_store({type_name: (encoding, definition)})
        try:
            type_hash = store.hash_rihs01(type_name)
        except KeyError as error:
            raise BagError(
                f'{type_name}: its definition is not usable: it lacks that of {error}'
            ) from error
    return definition, encoding, type_hash


def build_store(definitions: Mapping[str, tuple[str, str]]) -> Typestore:
    """
    Load message types from definition texts.

    Parameters
    ----------
    definitions : mapping of str to (str, str)
        Encoding (``ros2msg`` or ``ros2idl``) and text with dependencies, per type name.

    Returns
    -------
    Typestore
        These types and those they depend on.

    Raises
    ------
    BagError
        If a text cannot be understood or two contradict each other.

    """
    store = get_typestore(Stores.EMPTY)
    for type_name, (encoding, text) in definitions.items():
        try:
            if encoding == 'ros2msg':
                types = get_types_from_msg(text, type_name)
            else:
                types = {}
                for part in text.split(_IDL_SEPARATOR):
                    # Each part of a bag's text starts with the name of its file.
                    body = part.partition('\n')[2] if part.startswith('IDL: ') else part
                    if body.strip():
                        types.update(get_types_from_idl(body))
            store.register(types)
            if type_name not in store.fielddefs:
                raise TypesysError('the text defines other types')
        except TypesysError as error:
            raise BagError(f'{type_name}: its definition is not usable: {error}') from error
    return store
