# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""
What all tests share: ROS domains, how many random examples are tried, and from which seed.

With ``CI=true`` the examples are always the same ones. ``CAM_MOTION_EXAMPLES=2000`` tries that
many of each family instead, and gives each test so much more time.
"""

from contextlib import contextmanager
import fcntl
import itertools
import os
from pathlib import Path
import tempfile

from hypothesis import HealthCheck, settings
import pytest

USUAL_EXAMPLES = 40
EXAMPLES = int(os.environ.get('CAM_MOTION_EXAMPLES', USUAL_EXAMPLES))

# A loaded machine may be slow to draw or to run one example; pytest-timeout watches the whole.
_SHARED = settings(max_examples=EXAMPLES, deadline=None,
                   suppress_health_check=[HealthCheck.too_slow])
settings.register_profile('random', _SHARED)
settings.register_profile('seeded', _SHARED, derandomize=True, database=None, print_blob=True)
settings.load_profile('seeded' if os.environ.get('CI', '').lower() in ('1', 'true') else 'random')


def pytest_collection_modifyitems(items):
    """Give tests more time where more examples are asked for."""
    more = EXAMPLES / USUAL_EXAMPLES
    for item in items:
        marker = item.get_closest_marker('timeout')
        if more > 1.0 and marker and marker.args:
            item.add_marker(pytest.mark.timeout(more * marker.args[0]), append=False)


DOMAINS = (*range(1, 101), *range(215, 231))  # whose ports no system hands out on its own
_counter = itertools.count()


@contextmanager
def _reserved_domain():
    first = os.getpid() * 7 + next(_counter)
    for offset in range(len(DOMAINS)):
        number = DOMAINS[(first + offset) % len(DOMAINS)]
        path = Path(tempfile.gettempdir()) / f'cam_motion_domain_{os.getuid()}_{number}'
        with open(path, 'w') as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                continue
            yield number
            return
    pytest.fail('no ROS domain is free')


@pytest.fixture(scope='session')
def reserved_domain():
    """Give a context that reserves a ROS domain no other test uses meanwhile, in any process."""
    return _reserved_domain


@pytest.fixture
def domain(reserved_domain):
    """Reserve a ROS domain for one test."""
    with reserved_domain() as number:
        yield number
