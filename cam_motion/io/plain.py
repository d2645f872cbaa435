# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Plain data: whatever a result holds, written as strictly valid JSON."""

from __future__ import annotations

from collections.abc import Mapping
import json
import math
from typing import Any


def finite(value: float) -> float | None:
    """
    Give a number as JSON can hold it.

    Parameters
    ----------
    value : float
        The number, in any unit.

    Returns
    -------
    float | None
        The number; None where it is infinite or undefined.

    """
    return float(value) if math.isfinite(value) else None


def plain(value: Any) -> Any:
    """
    Reduce a value that a user gave to what JSON knows.

    Parameters
    ----------
    value : Any
        Anything that YAML can yield, dates and non-finite numbers included.

    Returns
    -------
    Any
        None, bool, int, finite float, str, list or dict; what is none of these becomes a text.

    """
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return str(value)


def to_json(data: Any) -> str:
    """
    Write plain data as JSON.

    Parameters
    ----------
    data : Any
        Plain data, without infinite or undefined numbers.

    Returns
    -------
    str
        JSON, indented by two, in Unicode.

    Raises
    ------
    ValueError
        When a number is not finite: such a token would not be JSON.

    """
    return json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False)
