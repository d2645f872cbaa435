# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Cam tables of other systems: reading, judging, repairing and writing them."""

from cam_motion.io.tables import columns, structured
from cam_motion.io.tables.formats import (
    detect_format,
    FORMATS,
    read_table,
    Samples,
    TableFormat,
    write_text,
    written_formats,
)
from cam_motion.io.tables.table import (
    CamTable,
    CYCLES,
    INTERPOLATIONS,
    RawTable,
    TableOptions,
)

__all__ = [
    'CYCLES', 'CamTable', 'FORMATS', 'INTERPOLATIONS', 'RawTable', 'Samples', 'TableFormat',
    'TableOptions', 'columns', 'detect_format', 'read_table', 'structured', 'write_text',
    'written_formats',
]
