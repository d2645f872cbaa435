# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Measure everything and print one table: ours, the alternative, the ratio, the goal."""

import argparse
import json
import sys

from benchmarks.drive import drive_rows
from benchmarks.motion import motion_rows
from benchmarks.nodes import node_rows
from benchmarks.row import Row
from benchmarks.sweep import sweep_rows
from rich.console import Console
from rich.table import Table

_WIDTH = 118  # of a file or pipe, which has none of its own


def main() -> None:
    """Run the benchmarks that the command line names."""
    parser = argparse.ArgumentParser(prog='python -m benchmarks', description=__doc__)
    parser.add_argument('--json', action='store_true', help='print the rows as JSON')
    parser.add_argument('--only', choices=('motion', 'drive', 'sweep', 'nodes'),
                        help='run one family only')
    parser.add_argument('--seconds', type=float, default=10.0, help='length of each node run [s]')
    options = parser.parse_args()
    rows: list[Row] = []
    for name, measure in (('motion', motion_rows), ('drive', drive_rows), ('sweep', sweep_rows),
                          ('nodes', lambda: node_rows(options.seconds))):
        if options.only in (None, name):
            rows += measure()
    if options.json:
        print(json.dumps([row._asdict() for row in rows], indent=2))
        return
    table = Table(title='cam_motion beside the usual alternatives, one run on this machine')
    for name in ('what', 'cam_motion', 'beside it', 'ratio', 'goal'):
        table.add_column(name, justify='left' if name in ('what', 'goal') else 'right',
                         overflow='fold')
    for row in rows:
        table.add_row(row.what, row.ours, row.peer, row.ratio, row.goal)
    Console(width=None if sys.stdout.isatty() else _WIDTH).print(table)


if __name__ == '__main__':
    main()
