# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A sweep on a cluster: a scheduler and two worker processes of dask.distributed, here."""

from dataclasses import replace
import os

from cam_motion.drive.sweep import Designs, sweep, sweep_orbits
from cam_motion.units import RPM
import numpy as np
import pytest

distributed = pytest.importorskip('distributed')

pytestmark = pytest.mark.timeout(60)

NOMINAL = 400.0 * RPM


@pytest.fixture(scope='module')
def client():
    """Start the cluster on this host only, and end it again."""
    with (distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True,
                                   host='127.0.0.1', dashboard_address=None) as cluster,
          distributed.Client(cluster, timeout='20s') as connected):
        connected.wait_for_workers(2, timeout=30)
        yield connected


@pytest.fixture(scope='module')
def designs(press):
    """Make 120 motors from too weak to too strong."""
    torques = np.geomspace(3.0, 80.0, 120)
    return replace(Designs.of([press()] * torques.size), breakdown_torque=torques)


def test_a_cluster_makes_no_difference_to_any_bit(client, press_profile, press_parts, designs):
    here = sweep_orbits(press_profile, press_parts, NOMINAL, designs)
    heard = []
    there = sweep(press_profile, press_parts, NOMINAL, designs, client.get_executor(), chunk=20,
                  tell=lambda done, total: heard.append((done, total)))
    assert 0 < np.count_nonzero(here.found) < len(designs)
    for ours, theirs in zip(here, there):
        np.testing.assert_array_equal(ours, theirs)
    assert sorted(heard) == [(done, 120) for done in range(20, 121, 20)]


def test_the_workers_are_two_processes_of_their_own(client):
    assert len({os.getpid(), *client.run(os.getpid).values()}) == 3


def test_what_fails_on_the_cluster_reaches_the_caller(client, press_profile, designs):
    with pytest.raises(AttributeError, match='edges'):
        sweep(press_profile, ('no part at all',), NOMINAL, designs, client.get_executor(),
              chunk=40)
