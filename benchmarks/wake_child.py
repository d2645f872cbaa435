# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A bare loop that only sleeps until its next tick: how late this machine wakes a process."""

import json
import sys
import time

from benchmarks.row import percentile_99


def main() -> None:
    """Sleep and print the lateness as JSON."""
    _, rate_hz, seconds = sys.argv[1:]
    period_ns = round(1e9 / float(rate_hz))
    due, lateness = time.monotonic_ns(), []
    for _ in range(int(float(rate_hz) * float(seconds))):
        due += period_ns
        left = due - time.monotonic_ns()
        if left > 0:
            time.sleep(1e-9 * left)
        lateness.append(time.monotonic_ns() - due)
    print(json.dumps({'p99_ms': 1e-6 * percentile_99(lateness)}))


if __name__ == '__main__':
    main()
